"""Random cells of a result evaluated again, to 50 digits: what `verify` in a study asks for.

It tells what floats, grids and files do to the equations. Equations that are wrong in themselves
give the same to any number of digits; that is for the tests of each scene.
"""

from __future__ import annotations

import math
import random
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array
from core.quantities import QUANTITIES
from core.sweep.grid import Grid, axis_values
from core.sweep.plan import Plan
from core.sweep.prepare import Prepared

BOUND = 8
"""Largest error of an output in ulps over its condition number; the tests hold every output of
the scenes below to it, at random, extreme and threshold points."""

BOUNDED = (
    "rectangle-isolated",
    "rectangle-on-plane",
    "rectangle-on-track",
    "cylinder-isolated",
    "cylinder-on-plane",
    "cylinder-rolling",
)
AGAINST = "the same equations with 50 digits"
PIECE = 8  # cells whose condition numbers are computed at a time

Places = Mapping[str, NDArray[np.int64]]


def accuracy(scene: str) -> str:
    """Return the error that closed forms of a scene are known to keep, in words."""
    if scene not in BOUNDED:
        return "rounding of 64-bit floats; how much it amounts to, the study's key verify tells"
    return (
        f"rounding: at most {BOUND} ulp times the condition number, which is the sum of "
        "|x dF/dx| over |F| for the parameters, and at least 1"
    )


def chosen_places(prepared: Prepared) -> tuple[Places, int]:
    """Return the position on each axis of the cells to verify, and their number.

    They are all different, and the same for equal studies.
    """
    grid, asked = prepared.grid, prepared.study.verify or 0
    chosen = random.Random(prepared.study.key()).sample(range(grid.cells), min(asked, grid.cells))
    places: dict[str, NDArray[np.int64]] = {}
    left = np.array(sorted(chosen), dtype=np.int64)
    for name, size in reversed(grid.shape.items()):
        left, places[name] = np.divmod(left, size)
    return places, len(chosen)


def at_places(
    values: NDArray[np.generic], dims: Collection[str], places: Places, count: int
) -> Array:
    """Return an array over some axes of the grid at chosen cells, shape (count,)."""
    chosen = values[tuple(places[name] for name in dims)]
    return np.broadcast_to(np.asarray(chosen, dtype=np.float64), count)


def place_in_words(grid: Grid, places: Places, cell: int) -> str:
    """Return where a chosen cell lies, such as ``at frequency 50 Hz, beta 30 degree``."""
    parts = []
    for name, axis in grid.axes.items():
        k = int(places[name][cell])
        unit = QUANTITIES[name].unit if name in QUANTITIES else "1"
        value = float(axis_values(axis, k, k + 1)[0])
        parts.append(f"{name} {value:.12g}" + ("" if unit == "1" else f" {unit}"))
    return f"at {', '.join(parts)}" if parts else "at the only cell"


@dataclass(frozen=True)
class Value:
    """The worst value among the verified cells of one output.

    Attributes
    ----------
    name : str
        The output.
    cell : int
        Which of the cells.
    error : float
        SI units.
    ulps, kappa : float
        The error in units in the last place of the exact value, and the condition number.
    """

    name: str
    cell: int
    error: float
    ulps: float
    kappa: float

    @property
    def conditioned(self) -> float:
        """The error in ulps over the condition number."""
        return self.ulps / self.kappa if math.isfinite(self.ulps) else math.inf


@dataclass(frozen=True)
class Rounding:
    """What rounding did to the outputs of some cells.

    Attributes
    ----------
    worst : Value or None
        The output and cell of largest error over the condition number; None if none is judged.
    left_of_zero : float
        Largest absolute value of what is 0 by law, SI units; such values have no relative error.
    not_known : tuple of str
        Outputs that an equation rounds on its way, so that their 50 digits are not known.
    """

    worst: Value | None
    left_of_zero: float
    not_known: tuple[str, ...]

    def in_words(self, where: str) -> str:
        """Return one sentence; `where` is the place of the worst."""
        if self.worst is None:
            text = "no value that is not 0 is known to 50 digits"
        else:
            one = self.worst
            kept = "within" if one.conditioned <= BOUND else "BEYOND"
            unit = QUANTITIES[one.name].unit.replace("degree", "rad")
            text = (
                f"{one.name} {where}: error {one.error:.2g}{'' if unit == '1' else f' {unit}'}, "
                f"{one.ulps:.3g} ulp, {one.conditioned:.2g} ulp over the condition number "
                f"{one.kappa:.3g}, {kept} the bound of {BOUND}"
            )
        if self.left_of_zero:
            text += f"; of values that are 0, {self.left_of_zero:.2g} is left at most"
        if self.not_known:
            text += f"; not known to 50 digits: {', '.join(self.not_known)}"
        return text


def rounding_of(plan: Plan, cells: Mapping[str, Array], got: Mapping[str, Array]) -> Rounding:
    """Return what rounding did to outputs of a plan.

    Parameters
    ----------
    plan : Plan
        Closed forms.
    cells : mapping of str to ndarray, shape (n,)
        The parameters, SI units.
    got : mapping of str to ndarray, shape (n,)
        The outputs as they were computed, SI units.
    """
    from core.sweep.precise import VANISHES, exact_values  # mpmath, for those who verify

    exact = exact_values(plan, cells, partial=True)
    worst: Value | None = None
    zero = 0.0
    for name in got:
        if name not in exact:
            continue
        for value, number in zip(exact[name], got[name], strict=True):
            if abs(value) < VANISHES:
                zero = max(zero, abs(float(number)) if np.isfinite(number) else math.inf)
        found = _worst(plan, name, cells, exact[name], got[name])
        if found and (worst is None or found.conditioned > worst.conditioned):
            worst = found
    return Rounding(worst, zero, tuple(name for name in got if name not in exact))


def _worst(
    plan: Plan,
    name: str,
    cells: Mapping[str, Array],
    exact: NDArray[np.object_],
    got: Array,
) -> Value | None:
    """Return the cell of largest error over the condition number; None if all are 0.

    Condition numbers take long: they are computed from the largest error in ulps downwards, until
    no cell that is left can be worse.
    """
    from core.sweep.precise import CONTEXT, errors_of, sensitivities

    plan = plan.only(name)
    nothing = np.full(len(exact), CONTEXT.zero)
    ulps = errors_of(got, exact, nothing, np.float64).ulps
    order = [int(cell) for cell in np.argsort(-ulps, kind="stable") if not np.isnan(ulps[cell])]
    worst: Value | None = None
    for start in range(0, len(order), PIECE):
        if worst is not None and ulps[order[start]] <= worst.conditioned:
            break
        piece = order[start : start + PIECE]
        here = {key: cells[key][piece] for key in plan.parameters}
        moved = np.broadcast_to(sensitivities(plan, here)[name], len(piece))
        errors = errors_of(got[piece], exact[piece], moved, np.float64)
        for k, cell in enumerate(piece):
            kappa = errors.condition[k]
            value, number = exact[cell], float(got[cell])
            error = 0.0
            if errors.ulps[k]:
                error = float(abs(CONTEXT.mpf(number) - value))
            one = Value(
                name, cell, error, float(errors.ulps[k]), 1.0 if np.isnan(kappa) else float(kappa)
            )
            if worst is None or one.conditioned > worst.conditioned:
                worst = one
    return worst


def verified(prepared: Prepared, arrays: Mapping[str, NDArray[np.generic]]) -> dict[str, str | int]:
    """Return what verifying a sweep found, as attributes of its result; nothing if not asked for.

    Parameters
    ----------
    prepared : Prepared
        The sweep.
    arrays : mapping of str to ndarray
        What was computed, SI units.
    """
    if prepared.study.verify is None:
        return {}
    plan = prepared.plan
    places, count = chosen_places(prepared)
    cells = prepared.grid.at(places, count, plan.parameters)
    got = {
        name: at_places(arrays[name], prepared.dims[name], places, count) for name in plan.outputs
    }
    found = rounding_of(plan, cells, got)
    where = "" if found.worst is None else place_in_words(prepared.grid, places, found.worst.cell)
    return {
        "verified_cells": count,
        "verified_against": AGAINST,
        "verified_worst": found.in_words(where),
    }
