"""Random cells of a result evaluated again in extended precision: what `verify` asks for.

It tells what rounding, grids and files do to the equations. Equations that are wrong in themselves
give the same with any number of digits; that is for the tests of each scene.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.labels import Sample, sample_of
from vibrafeed.core.plan.plan import Plan, run_equations
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.scenes import Scene
from vibrafeed.core.watch import Watch

EXTENDED: Final = bool(np.finfo(np.longdouble).eps < 2.0**-60)
"""Whether `numpy.longdouble` has more digits than a double: not on Windows and ARM Macs."""

AGAINST = (
    "the same equations in extended precision"
    if EXTENDED
    else "nothing: numpy.longdouble is double precision on this machine"
)
STEP = 2.0**-30
"""Of the central differences behind a condition number, as a share of the parameter."""


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


def outputs_in(
    plan: Plan, cells: Mapping[str, NDArray[Any]], dtype: Any
) -> dict[str, NDArray[Any]]:
    """Return the outputs of closed forms, computed throughout in one floating-point type.

    Parameters
    ----------
    plan : Plan
        Closed forms.
    cells : mapping of str to ndarray, shape (n,)
        The parameters, SI units.
    dtype : type
        Such as `numpy.longdouble`.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        SI units. An output that an equation computes in another type is left out.
    """
    size = max((values.size for values in cells.values()), default=1)
    parameters = {name: np.asarray(value, dtype=dtype) for name, value in plan.defaults.items()}
    parameters |= {name: np.asarray(cells[name], dtype=dtype) for name in plan.parameters}
    with np.errstate(all="ignore"):  # overflow of a short type is an error like others
        results = run_equations(plan, parameters)
    values = {name: np.asarray(results[name]) for name in plan.outputs}
    return {
        name: np.broadcast_to(value, size) for name, value in values.items() if value.dtype == dtype
    }


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
        Outputs that an equation computes in double precision, so that no further digits are known.
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
        """The compared cells."""
        return self.evaluated

    def in_words(self, where: str) -> str:
        """Return a sentence on the worst error among the verified cells, for a file's attribute.

        It has the error in the unit of the output, in ulp (units in the last place) and over the
        condition number. `where` is the position of its cell in words.
        """
        if self.worst is None:
            text = "no value that is not 0 is known to more digits"
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
                verdict = "within" if worst.conditioned <= self.bound else "BEYOND"
                text += f", {verdict} the bound of {self.bound}"
        if self.left_of_zero:
            text += f"; of values that are 0, {self.left_of_zero:.2g} is left at most"
        if self.not_known:
            text += f"; computed in double precision alone: {', '.join(self.not_known)}"
        return text


def rounding_of(
    plan: Plan,
    cells: Mapping[str, Array],
    computed: Mapping[str, Array],
    watch: Watch | None = None,
) -> Rounding:
    """Return the effect of rounding on a plan's outputs at cells, by values in extended precision.

    Parameters
    ----------
    plan : Plan
        Closed forms.
    cells : mapping of str to ndarray, shape (n,)
        The parameters, SI units.
    computed : mapping of str to ndarray, shape (n,)
        The outputs to check, SI units.
    watch : Watch, optional
        Asked before each output; once it stops, no cell counts as compared.
    """
    watch = watch or Watch()
    size = next(iter(computed.values())).size
    bound = plan.scene.rounding_bound
    if not EXTENDED or watch.stopped():
        return Rounding(None, 0.0, (), np.zeros(size, dtype=np.bool_), bound)
    exact = outputs_in(plan, cells, np.longdouble)
    condition_sums = _condition_sums(plan, cells, watch)
    if condition_sums is None:
        return Rounding(None, 0.0, (), np.zeros(size, dtype=np.bool_), bound)
    worst: Value | None = None
    largest_at_zero = 0.0
    for name in (name for name in computed if name in exact):
        is_zero = exact[name] == 0
        largest_at_zero = max(
            largest_at_zero, float(np.max(np.abs(computed[name][is_zero]), initial=0.0))
        )
        worst = _worse_value(name, exact[name], condition_sums[name], computed[name], worst)
    not_known = tuple(name for name in computed if name not in exact)
    return Rounding(worst, largest_at_zero, not_known, np.ones(size, dtype=np.bool_), bound)


def _worse_value(
    name: str,
    exact: NDArray[np.longdouble],
    condition_sum: NDArray[np.longdouble],
    computed: Array,
    worst: Value | None,
) -> Value | None:
    """Return the value of an output with the largest error over its condition number.

    `worst` is returned if none is worse. A value that is not finite is right if it is the same, and
    infinitely wrong otherwise; a value that is 0 has no relative error.
    """
    is_finite = np.isfinite(exact) & np.isfinite(computed)
    is_same = (exact == computed) | (np.isnan(exact) & np.isnan(computed))
    with np.errstate(all="ignore"):
        error = np.where(is_same, 0.0, np.where(is_finite, np.abs(exact - computed), np.inf))
        ulps = np.where(is_same, 0.0, error / np.spacing(np.abs(exact.astype(np.float64))))
        kappa = np.fmax(condition_sum / np.abs(exact), 1.0)
        conditioned = np.where(is_same, 0.0, np.where(is_finite, ulps / kappa, np.inf))
    # Without a relative error it is never the worst.
    conditioned[(exact == 0) & is_finite & ~is_same] = -1.0
    cell = int(np.argmax(conditioned))
    if conditioned[cell] < 0 or (worst and conditioned[cell] <= worst.conditioned):
        return worst
    return Value(name, cell, float(error[cell]), float(ulps[cell]), float(kappa[cell]))


def _condition_sums(
    plan: Plan, cells: Mapping[str, Array], watch: Watch
) -> dict[str, NDArray[np.longdouble]] | None:
    """Return the sum of |x dF/dx| over the parameters x for each output F; None after a stop."""
    total: dict[str, Any] = dict.fromkeys(plan.outputs, np.longdouble(0.0))
    for name in plan.parameters:
        if watch.stopped():
            return None
        value = np.asarray(cells[name], dtype=np.longdouble)
        above, below = (
            outputs_in(plan, {**cells, name: value * (1 + direction * STEP)}, np.longdouble)
            for direction in (1, -1)
        )
        # Central difference over a relative step: |x dF/dx| = |F(x + h x) - F(x - h x)|/(2 h).
        with np.errstate(invalid="ignore"):
            total = {
                output: total[output] + np.abs(above[output] - below[output]) / (2 * STEP)
                for output in above
            }
        watch.advance(1 / len(plan.parameters))
    return total


def verified(
    prepared: Prepared, values_at: Callable[[Sample], Mapping[str, Array]], watch: Watch
) -> dict[str, str | int]:
    """Return the result of verifying some cells of a sweep, as attributes; empty if not asked for.

    The cells are computed again in extended precision, and the worst error is told.

    Parameters
    ----------
    prepared : Prepared
        The sweep, which says how many cells.
    values_at : callable
        Returns the outputs at the cells of a sample, as they were computed, SI units.
    watch : Watch
        May stop it.
    """
    if prepared.study.verify is None:
        return {}
    plan, sample = prepared.plan, sample_of(prepared, {})
    if not EXTENDED:
        return sample.verification_attributes(AGAINST, "not compared", evaluated=sample.chosen)
    cells = prepared.grid.at(sample.positions, sample.count, plan.parameters)
    rounding = rounding_of(plan, cells, values_at(sample), watch)
    evaluated = int(rounding.evaluated.sum())
    if not evaluated:
        return sample.verification_attributes(AGAINST)
    worst = rounding.in_words(sample.where(rounding.cell))
    return sample.verification_attributes(
        AGAINST, worst, evaluated=evaluated, compared=evaluated, failed=rounding.failed
    )
