"""Random cells of a result evaluated again, to 50 digits: what `verify` in a study asks for.

It tells what floats, grids and files do to the equations. Equations that are wrong in themselves
give the same to any number of digits; that is for the tests of each scene.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plan.sample import Sample, sample_of
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.scenes import Scene
from vibrafeed.core.watch import Watch

AGAINST = "the same equations with 50 digits"
PIECE = 8  # cells that are verified before a stop is looked for
MAX_SECONDS_OF_A_PIECE = 1.0  # a piece that would take longer is one cell


def accuracy(scene: Scene) -> str:
    """Return the known accuracy of a scene's closed forms in words.

    It is an attribute of results: the largest error by rounding, if a bound is known.
    """
    if scene.rounding_bound is None:
        return "rounding of 64-bit floats; how much it amounts to, the study's key verify says"
    return (
        f"rounding: at most {scene.rounding_bound} ulp times the condition number, which is the "
        "sum of |x dF/dx| over |F| for the parameters, and at least 1"
    )


@dataclass(frozen=True)
class Value:
    """The worst value among the verified cells of one output.

    Attributes
    ----------
    name : str
        The output.
    cell : int
        Number of the cell among the verified ones.
    error : float
        Absolute error, SI units.
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
    """The effect of rounding on the outputs of some cells.

    Attributes
    ----------
    worst : Value or None
        The output and cell of largest error over the condition number; None if none is judged.
    left_of_zero : float
        Largest absolute value of what is 0 by law, SI units; such values have no relative error.
    not_known : tuple of str
        Outputs that an equation rounds on its way, so that their 50 digits are not known.
    evaluated : ndarray of bool
        The cells that were evaluated before a stop.
    bound : int or None
        The bound that the closed forms are known to keep; see `Scene.rounding_bound`.
    """

    worst: Value | None
    left_of_zero: float
    not_known: tuple[str, ...]
    evaluated: NDArray[np.bool_]
    bound: int | None

    @property
    def cell(self) -> int:
        """The cell with the worst value; -1 if none is judged."""
        return -1 if self.worst is None else self.worst.cell

    @property
    def failed(self) -> int:
        """The number of values known to exceed the bound: 0 or 1, as only the worst is judged."""
        if self.worst is None or self.bound is None:
            return 0
        return int(self.worst.conditioned > self.bound)

    @property
    def compared(self) -> NDArray[np.bool_]:
        """The number of compared cells."""
        return self.evaluated

    def in_words(self, where: str) -> str:
        """Return a sentence on the worst error among the verified cells, for a file's attribute.

        It has the error in the unit of the output, in ulp (units in the last place) and over the
        condition number. `where` is the position of its cell in words.
        """
        if self.worst is None:
            text = "no value that is not 0 is known to 50 digits"
        else:
            worst = self.worst
            unit = QUANTITIES[worst.name].unit.replace("degree", "rad")
            text = (
                f"{worst.name} {where}: error {worst.error:.2g}"
                f"{'' if unit == '1' else f' {unit}'}, "
                f"{worst.ulps:.3g} ulp, {worst.conditioned:.2g} ulp over the condition number "
                f"{worst.kappa:.3g}"
            )
            if self.bound is not None:
                kept = "within" if worst.conditioned <= self.bound else "BEYOND"
                text += f", {kept} the bound of {self.bound}"
        if self.left_of_zero:
            text += f"; of values that are 0, {self.left_of_zero:.2g} is left at most"
        if self.not_known:
            text += f"; not known to 50 digits: {', '.join(self.not_known)}"
        return text


def rounding_of(
    plan: Plan,
    cells: Mapping[str, Array],
    got: Mapping[str, Array],
    watch: Watch | None = None,
) -> Rounding:
    """Return the effect of rounding on a plan's outputs at cells, by values of 50 digits.

    Parameters
    ----------
    plan : Plan
        Closed forms.
    cells : mapping of str to ndarray, shape (n,)
        The parameters, SI units.
    got : mapping of str to ndarray, shape (n,)
        The outputs as they were computed, SI units.
    watch : Watch, optional
        Asked before each piece of the cells and each output; a piece that it stops is left out.

    Returns
    -------
    Rounding
        The worst value with its error, what is left where the exact value is 0, outputs without
        exact values, and a mask of the cells that were compared before a stop.
    """
    watch = watch or Watch()
    size = next(iter(got.values())).size
    step = 1 if plan.scene.seconds_a_verified_cell > MAX_SECONDS_OF_A_PIECE / PIECE else PIECE
    worst: Value | None = None
    zero, not_known, done = 0.0, dict[str, None](), 0
    for start in range(0, size, step):
        piece = np.arange(start, min(start + step, size))
        found = _judged(plan, cells, got, piece, worst, watch)
        if found is None:
            break
        worst, left_of_zero, rounded = found
        zero, not_known = max(zero, left_of_zero), not_known | dict.fromkeys(rounded)
        done += piece.size
        watch.advance(piece.size / size)
    evaluated = np.arange(size) < done
    return Rounding(worst, zero, tuple(not_known), evaluated, plan.scene.rounding_bound)


def _judged(
    plan: Plan,
    cells: Mapping[str, Array],
    got: Mapping[str, Array],
    piece: NDArray[np.intp],
    worst: Value | None,
    watch: Watch,
) -> tuple[Value | None, float, tuple[str, ...]] | None:
    """Compare some computed cells with exact values of 50 digits; None if `watch` stopped it.

    Parameters
    ----------
    cells : mapping of str to ndarray, shape (n,)
        Parameters at all cells that are verified, SI units.
    got : mapping of str to ndarray, shape (n,)
        The outputs as computed in floats.
    piece : ndarray of int
        Numbers of the cells to compare now.
    worst : Value or None
        The worst value of earlier cells.

    Returns
    -------
    tuple
        The value with the largest error over its condition number; the largest float whose exact
        value is 0; the names of outputs that cannot be computed to 50 digits.
    """
    from vibrafeed.core.sweep.precise import VANISHES, exact_values  # mpmath, for those who verify

    if watch.stopped():
        return None
    exact = exact_values(plan, {name: cells[name][piece] for name in plan.parameters}, partial=True)
    zero = 0.0
    for name in (name for name in got if name in exact):
        if watch.stopped():
            return None
        for value, number in zip(exact[name], got[name][piece], strict=True):
            if abs(value) < VANISHES:
                zero = max(zero, abs(float(number)) if np.isfinite(number) else math.inf)
        worst = _worst(plan.only(name), cells, exact[name], got[name], piece, worst)
    return worst, zero, tuple(name for name in got if name not in exact)


def _worst(
    plan: Plan,
    cells: Mapping[str, Array],
    exact: NDArray[np.object_],
    got: Array,
    piece: NDArray[np.intp],
    worst: Value | None,
) -> Value | None:
    """Return the worst of some verified values: the largest error over its condition number.

    The condition number says how much the rounding of parameters alone may change the value; it is
    at least 1 and takes long: it is not computed for errors that cannot exceed the worst.

    Parameters
    ----------
    plan : Plan
        The equations of this one output.
    cells : mapping of str to ndarray, shape (n,)
        Parameters at all cells that are verified.
    exact : ndarray of mpmath numbers, shape (m,)
        The exact values at the cells numbered `piece`.
    got : ndarray, shape (n,)
        The values computed in floats.
    worst : Value or None
        The worst of earlier cells and outputs, which is returned if none here is worse.
    """
    from vibrafeed.core.sweep.precise import CONTEXT, errors_of, sensitivities

    (name,) = plan.outputs
    nothing = np.full(piece.size, CONTEXT.zero)
    ulps = errors_of(got[piece], exact, nothing, np.float64).ulps
    large = np.flatnonzero(
        ~np.isnan(ulps) & (ulps > (-1.0 if worst is None else worst.conditioned))
    )
    if not large.size:
        return worst
    piece, exact = piece[large], exact[large]
    moved = sensitivities(plan, {key: cells[key][piece] for key in plan.parameters})[name]
    errors = errors_of(got[piece], exact, np.broadcast_to(moved, piece.size), np.float64)
    for k, cell in enumerate(piece):
        kappa, error = errors.condition[k], 0.0
        if errors.ulps[k]:
            error = float(abs(CONTEXT.mpf(float(got[cell])) - exact[k]))
        one = Value(
            name, int(cell), error, float(errors.ulps[k]), 1.0 if np.isnan(kappa) else float(kappa)
        )
        if worst is None or one.conditioned > worst.conditioned:
            worst = one
    return worst


def verified(
    prepared: Prepared, values_at: Callable[[Sample], Mapping[str, Array]], watch: Watch
) -> dict[str, str | int]:
    """Return the result of verifying some cells of a sweep, as attributes; empty if not asked for.

    The cells are computed again with 50 digits, and the worst error is told.

    Parameters
    ----------
    prepared : Prepared
        The sweep, which says how many cells.
    values_at : callable
        Returns the outputs at the cells of a sample, as they were computed, SI units.
    watch : Watch
        May stop it; the cells compared until then count.
    """
    if prepared.study.verify is None:
        return {}
    plan, sample = prepared.plan, sample_of(prepared, {})
    cells = prepared.grid.at(sample.positions, sample.count, plan.parameters)
    rounding = rounding_of(plan, cells, values_at(sample), watch)
    evaluated = int(rounding.evaluated.sum())
    if not evaluated:
        return sample.verification_attributes(AGAINST)
    worst = rounding.in_words(sample.where(rounding.cell))
    return sample.verification_attributes(
        AGAINST, worst, evaluated=evaluated, compared=evaluated, failed=rounding.failed
    )
