"""A sweep of any size into a file: tiles are computed while the ones before are written.

Memory is bounded: a tile is computed, one waits, and one is written and encoded meanwhile. That is
four tiles, of 32 MiB for each output that has the most axes, whatever the size of the sweep.
"""

from __future__ import annotations

import itertools
import time
from collections import deque
from collections.abc import Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.layout import Tile
from vibrafeed.core.dataset.regimes import is_valid
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.labels import Sample, coordinates_of, sample_of
from vibrafeed.core.plan.pieces import carry_out, run_cost
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plan.tiles import Tiled
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.sweep.cells import attributes_of, compute, label
from vibrafeed.core.sweep.verify import verified
from vibrafeed.core.watch import Watch

AHEAD = 1  # tiles that wait to be written while one is written


class Target(Protocol):
    """A file or store under way, into which the tiles of a sweep are written.

    Attributes
    ----------
    seconds : float
        Time that an earlier run has spent on the tiles that are there [s].
    """

    seconds: float

    @property
    def missing(self) -> Iterator[int]:
        """The indices of the tiles that are not written, in order."""

    def write(self, index: int, arrays: Mapping[str, NDArray[Any]], seconds: float) -> None:
        """Write a tile in the units of files; `seconds` is the cost of all so far."""

    def finish(self, price: Mapping[str, float]) -> None:
        """Finish the result and make it visible."""


def outline_table(sweep: Prepared, watch: Watch | None = None) -> Table:
    """Return the table of a sweep's result without the values of its arrays, to begin a file.

    Shapes, types and attributes are those of the finished result, but for its cost, which is not
    known yet; the sweep may be larger than the memory. The cells to verify are evaluated and
    verified here; `watch` may stop that.
    """
    corner = sweep.within(dict.fromkeys(sweep.grid.axes, (0, 1))).unverified()
    first = carry_out(corner, compute, label)
    tiled, shape = Tiled(sweep), sweep.grid.shape

    def values_at(sample: Sample) -> dict[str, Array]:
        """Return the outputs at sampled cells."""
        return tiled.at(sample.positions, sample.count)

    variables = {
        name: replace(
            variable,
            values=np.broadcast_to(variable.values, [shape[dim] for dim in variable.dims]),
        )
        for name, variable in first.variables.items()
    }
    attributes = {**attributes_of(sweep), **verified(sweep, values_at, watch or Watch())}
    unknown = dict.fromkeys(run_cost(0, 0.0), 0.0)
    return Table(coordinates_of(sweep.plan, sweep.grid), variables, attributes, unknown)


@dataclass
class Passed:
    """Statistics of the tiles that were computed.

    Attributes
    ----------
    ends : dict of str to tuple of float
        The least and largest finite and valid value of each output.
    regimes : dict of str to dict of str to int
        Number of cells in each regime, by the name of the verdict and of the regime.
    cells : int
        Points of all tiles.
    """

    ends: dict[str, tuple[float, float]] = field(default_factory=dict)
    regimes: dict[str, dict[str, int]] = field(default_factory=dict)
    cells: int = 0

    def add(
        self, tile: Tile, arrays: Mapping[str, NDArray[Any]], sweep: Prepared, tiled: Tiled
    ) -> None:
        """Add a tile to the statistics of a sweep: cells, extremes and counts of regimes.

        `arrays` has the outputs and verdicts of the tile, arrays over its cells. Values that are
        not finite, or not valid by their verdict, are left out of the extremes. `tiled` computes
        what an output and its verdict need of each other where they lie on other axes.
        """
        self.cells += tile.cells
        plan = sweep.plan
        for name, values in arrays.items():
            judge = plan.verdict_on(name)
            if name in plan.verdict_names:
                continue
            if judge is None or not judge.doubts:
                self._extend(name, values)
            elif {*sweep.dims[judge.name]} <= {*tile.field.dims}:
                self._extend(name, values[_mask(judge.name, tile, arrays, sweep, tiled)])
        for verdict in plan.verdicts:
            if verdict.name not in arrays:
                continue
            regimes = arrays[verdict.name]
            counts = self.regimes.setdefault(verdict.name, {})
            for regime in verdict.regimes:
                found = int(np.count_nonzero(regimes == REGIMES[regime].value))
                counts[regime] = counts.get(regime, 0) + found
            for name in verdict.outputs if verdict.doubts else ():
                if sweep.dims[name] and not {*tile.field.dims} <= {*sweep.dims[name]}:
                    for values in _valid_parts(name, tile, is_valid(regimes), sweep, tiled):
                        self._extend(name, values)

    def _extend(self, name: str, values: NDArray[Any]) -> None:
        """Let the extremes of an output reach the finite ones of further values."""
        if not values.size:
            return
        least, largest = values.min(), values.max()
        if not (np.isfinite(least) and np.isfinite(largest)):
            finite = values[np.isfinite(values)]
            if not finite.size:
                return
            least, largest = finite.min(), finite.max()
        before = self.ends.get(name, (least, largest))
        self.ends[name] = float(min(least, before[0])), float(max(largest, before[1]))


def _mask(
    judge: str, tile: Tile, arrays: Mapping[str, NDArray[Any]], sweep: Prepared, tiled: Tiled
) -> NDArray[np.bool_]:
    """Return the cells of a tile that are valid by a verdict, which has no axis besides its own."""
    shape = tuple(stop - start for start, stop in tile.box)
    if judge in arrays:
        return is_valid(arrays[judge])
    dims = sweep.dims[judge]
    valid = is_valid(tiled.part(judge, {dim: tile.where[dim] for dim in dims}))
    own = [length if d in dims else 1 for d, length in zip(tile.field.dims, shape, strict=True)]
    return np.broadcast_to(valid.reshape(own), shape)


def _valid_parts(
    name: str, tile: Tile, valid: NDArray[np.bool_], sweep: Prepared, tiled: Tiled
) -> Iterator[NDArray[Any]]:
    """Yield the values of an output that are valid somewhere in a tile of its verdict.

    The verdict has axes that the output has not; `valid` is over the tile. Along axes that only the
    output has it is computed one place after another, so that memory is that of a tile.
    """
    dims = sweep.dims[name]
    mask = valid.any(axis=tuple(k for k, d in enumerate(tile.field.dims) if d not in dims))
    others = [dim for dim in dims if dim not in tile.field.dims]
    for place in itertools.product(*(range(sweep.grid.shape[dim]) for dim in others)):
        box = dict(zip(others, ((k, k + 1) for k in place), strict=True))
        values = tiled.part(name, {dim: box.get(dim) or tile.where[dim] for dim in dims})
        yield values.reshape(mask.shape)[mask]


def stream(sweep: Prepared, target: Target, watch: Watch | None = None) -> tuple[Passed, bool]:
    """Compute the missing tiles of a sweep's result and write them to a file or store.

    A tile is a piece of all arrays that fits the memory; the sweep may be larger.

    Parameters
    ----------
    sweep : Prepared
        A sweep whose cells are evaluated one by one.
    target : Target
        The file or store; it is finished if all of its tiles are there.
    watch : Watch, optional
        Takes the progress, and may stop it between two tiles.

    Returns
    -------
    passed : Passed
        Extremes, counts of regimes and number of the cells that were computed now.
    whole : bool
        True if all tiles are there.
    """
    watch, tiled, passed = watch or Watch(), Tiled(sweep), Passed()
    expected = _Expected(sweep, tiled)
    missing = deque(target.missing)
    to_do = sum(tiled.tiles[index].cells for index in missing)
    watch.advance(1 - to_do / max(1, tiled.tiles.cells))
    started = time.perf_counter()

    def spent() -> float:
        """Return the cost so far [s]."""
        return target.seconds + time.perf_counter() - started

    def deliver(index: int, tile: Tile, arrays: Mapping[str, NDArray[Any]], cost: float) -> None:
        """Check a tile against verified cells, write it and count it.

        `cost` is the time that all tiles have taken so far [s].
        """
        expected.check(tile, arrays)
        target.write(index, arrays, cost)
        passed.add(tile, arrays, sweep, tiled)
        watch.advance(tile.cells / tiled.tiles.cells)

    with ThreadPoolExecutor(1, thread_name_prefix="writer") as writer:
        waiting: deque[Future[None]] = deque()
        try:
            while missing and not watch.stopped():
                index = missing.popleft()
                tile = tiled.tiles[index]
                waiting.append(writer.submit(deliver, index, tile, tiled.values(tile), spent()))
                while len(waiting) > AHEAD:
                    waiting.popleft().result()
            while waiting:
                waiting.popleft().result()
        except BaseException:
            writer.shutdown(cancel_futures=True)
            raise
    if missing:
        return passed, False
    target.finish(run_cost(sweep.cells, spent()))
    return passed, True


class _Expected:
    """The outputs at the cells that are verified: what passes must be what was verified."""

    def __init__(self, sweep: Prepared, tiled: Tiled):
        """Evaluate the sampled cells one by one, if the sweep is to be verified."""
        self._sweep = sweep
        self._sample: Sample | None = None
        if sweep.study.verify is not None:
            self._sample = sample_of(sweep, {})
            self._values = tiled.at(self._sample.positions, self._sample.count)

    def check(self, tile: Tile, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Raise `VibrafeedError` if a tile differs from a verified value of one of its cells.

        The cells that are verified were computed one by one; `arrays` has the values of the tile,
        in the units of files.
        """
        if self._sample is None:
            return
        positions = [self._sample.positions[dim] for dim in tile.field.dims]
        inside = np.ones(self._sample.count, dtype=np.bool_)
        for place, (start, stop) in zip(positions, tile.box, strict=True):
            inside &= (place >= start) & (place < stop)
        at = tuple(
            place[inside] - start for place, (start, _) in zip(positions, tile.box, strict=True)
        )
        for name in set(arrays) - {*self._sweep.plan.verdict_names}:
            known = self._sweep.in_files(name, self._values[name][inside])
            if not np.array_equal(arrays[name][at], known, equal_nan=True):
                raise VibrafeedError(
                    f"a check failed: {name} of a tile of cells differs from the same cells "
                    "computed one by one"
                )
