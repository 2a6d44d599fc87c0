"""Evaluation of a plan on a grid by numpy, block by block: the readable reference.

Each quantity is computed on its own small grid and once only: an equation runs at the level of the
innermost sliced axis that it depends on. Blocks keep the working set in the processor's cache and
the memory bounded.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import Known, Plan, regimes, run
from vibrafeed.core.scenes import Equation

BLOCK_CELLS = 32_768  # 256 KiB an array: a handful of them stay in a second-level cache

Progress = Callable[[float], object]
Results = Mapping[str, NDArray[Any]]


@dataclass(frozen=True)
class _Level:
    """One sliced axis: its name, position, step, and the equations that become computable."""

    axis: str
    position: int
    step: int
    equations: tuple[Equation, ...]


def evaluate_in_blocks(
    plan: Plan,
    grid: Grid,
    results: Results,
    *,
    block_cells: int = BLOCK_CELLS,
    progress: Progress | None = None,
) -> None:
    """Compute a plan on a grid block by block with numpy, and write the outputs into `results`.

    Parameters
    ----------
    results : mapping of str to ndarray
        An array for each output and verdict, over the axes that it depends on; filled in SI units.
    block_cells : int
        About the number of cells of a block: few enough that arrays stay in the processor's cache.
    progress : callable, optional
        Called after each block with its share of the grid.
    """
    depends = plan.depends_on(grid.axes)
    used = grid.dims(set().union(*(depends[name] for name in (*plan.outputs, *plan.verdict_names))))
    sliced = _sliced_axes(used, grid, block_cells)
    step = max(1, block_cells // grid.size(used[len(sliced) :]))
    levels = _levels(plan, grid, depends, sliced, step)
    known: Known = {name: value for name, value in grid.si().items() if name in plan.parameters}
    known.update({name: np.asarray(value) for name, value in plan.defaults.items()})
    at_start = [e for e in plan.equations if not depends[e.gives] & set(sliced)]
    writer = _Writer(plan, grid, depends, results, progress)
    _descend(levels, 0, run(at_start, known), {}, writer)


def _sliced_axes(used: tuple[str, ...], grid: Grid, block_cells: int) -> tuple[str, ...]:
    """Return the leading axes to loop over, so that the cells of the other axes fit one block.

    `used` are the axes that any output depends on, in the order of the grid; `block_cells` is the
    most cells that are computed at once, so that their arrays stay in the processor's cache.
    """
    for count in range(len(used)):
        if grid.size(used[count:]) <= block_cells:
            return used[:count]
    return used


def _levels(
    plan: Plan,
    grid: Grid,
    depends: Mapping[str, frozenset[str]],
    sliced: tuple[str, ...],
    last_step: int,
) -> list[_Level]:
    """Return the loops over the axes of a grid that are cut, each with the equations to run in it.

    An equation runs at the innermost cut axis on which it depends, no deeper, so that it is not
    repeated. A loop has the axis, its position in the grid, the values of a slice and the equations
    of the `plan`. `grid` has the axes.

    Parameters
    ----------
    depends : mapping of str to frozenset of str
        The axes on which each quantity depends.
    sliced : tuple of str
        The axes to cut, outermost first.
    last_step : int
        Values of the last of them that are taken at a time; the others go value by value.
    """
    positions = {name: position for position, name in enumerate(grid.axes)}
    levels = []
    for number, axis in enumerate(sliced):
        later = set(sliced[number + 1 :])
        equations = tuple(
            equation
            for equation in plan.equations
            if axis in depends[equation.gives] and not depends[equation.gives] & later
        )
        step = 1 if later else last_step
        levels.append(_Level(axis, positions[axis], step, equations))
    return levels


def _descend(
    levels: list[_Level], depth: int, known: Known, where: dict[str, slice], writer: _Writer
) -> None:
    """Compute the cells of a grid block by block: loop over one axis and, inside, over the others.

    Equations that do not depend on inner axes are computed outside of these loops, once.

    Parameters
    ----------
    levels : list of _Level
        The axes that are cut, outermost first, with the equations to run inside each.
    depth : int
        The number of the level to loop over; after the last one the block is written.
    known : mapping of str to ndarray
        The quantities computed so far.
    where : dict of str to slice
        The slice of each axis outside.
    writer : _Writer
        Takes the results of a block.
    """
    if depth == len(levels):
        writer.write(known, where)
        return
    level = levels[depth]
    values = known.get(level.axis)
    size = writer.grid.shape[level.axis]
    for start in range(0, size, level.step):
        piece = slice(start, min(start + level.step, size))
        inner = dict(known)
        if values is not None:
            inner[level.axis] = values.take(range(piece.start, piece.stop), axis=level.position)
        _descend(
            levels, depth + 1, run(level.equations, inner), {**where, level.axis: piece}, writer
        )


class _Writer:
    """Writes the outputs of blocks into the arrays of the results, and reports progress."""

    def __init__(
        self,
        plan: Plan,
        grid: Grid,
        depends: Mapping[str, frozenset[str]],
        results: Results,
        progress: Progress | None,
    ):
        """Write the outputs of a plan into result arrays, and report progress."""
        self.plan, self.grid, self.results, self.progress = plan, grid, results, progress
        self.dims = {name: grid.dims(depends[name]) for name in results}
        self.positions = {name: position for position, name in enumerate(grid.axes)}
        self.all_dims = grid.dims(set().union(*self.dims.values()))

    def write(self, known: Known, where: Mapping[str, slice]) -> None:
        """Write the outputs and regimes of a block of cells into the results, and report progress.

        `known` has the quantities of the block by name, SI units; `where` has its slice on each
        axis that is cut.
        """
        for name in self.plan.outputs:
            self._put(name, known[name], where)
        for name, flags in regimes(self.plan, known).items():
            self._put(name, flags, where)
        if self.progress is not None:
            done = [
                where[axis].stop - where[axis].start if axis in where else self.grid.shape[axis]
                for axis in self.all_dims
            ]
            self.progress(math.prod(done) / self.grid.size(self.all_dims))

    def _put(
        self, name: str, block: NDArray[np.float64] | NDArray[np.int8], where: Mapping[str, slice]
    ) -> None:
        """Write one array of a block of cells into its region of the result.

        Parameters
        ----------
        name : str
            The output, or the verdict.
        block : ndarray
            Its values: a scalar, or an array with every axis of the grid, of size 1 where the
            output does not depend on it.
        where : mapping of str to slice
            The cells of the block on each axis that is cut; on other axes they are all.
        """
        dims = self.dims[name]
        region = tuple(where.get(axis, slice(None)) for axis in dims)
        if block.ndim:
            # The block has every axis of the grid; those that it does not depend on have size 1.
            dropped = tuple(p for axis, p in self.positions.items() if axis not in dims)
            block = block.squeeze(axis=dropped)
        self.results[name][region] = block
