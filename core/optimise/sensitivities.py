"""How an answer changes with what it hangs on: sensitivities.

The derivatives of closed forms are exact (`core.optimise.duals`), those of simulated motion are
extrapolated from differences inside one regime, with an estimate of their error (theory 12.4).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from typing import Any, NamedTuple

import numpy as np

from core.errors import Problem, StudyError
from core.mechanics import yawing
from core.mechanics.arrays import Array
from core.mechanics.screws import Reduction, ScrewKind, Wrench, cross, dot
from core.motion.prepare import choose_system
from core.optimise.duals import Dual, NotDifferentiableError, slope_of, unboxed, value_of
from core.plan.equations import regimes
from core.plan.plan import Plan, make_plan, plan_scene
from core.scenes import Equation

SIDE = 1e-6  # step to either side of a switch, relative
WIDER = 16  # times that step, for comparison
ROUNDING = 1e-12  # of a value, relative
AGREE = 1e-5  # relative difference of the derivatives of both sides that are still one
HALVINGS = 12  # of the step of a difference
LARGEST_STEP = 0.02  # relative
TRUSTED = 1e-3  # relative error of a derivative of simulated motion that is still given


class Sensitivity(NamedTuple):
    """How an output changes with a parameter, SI units.

    Attributes
    ----------
    derivative : float
        Of the output by the parameter; NaN where there is none.
    logarithmic : float
        d ln(output)/d ln(parameter), the exponent of a power law; NaN where the output is 0.
    error : float
        Estimate of the error of `derivative`; 0 if exact but for rounding.
    note : str
        Why there is no derivative, or how it was found; empty for an exact one.
    """

    derivative: float
    logarithmic: float
    error: float
    note: str


Sensitivities = dict[tuple[str, str], Sensitivity]
"""By output and parameter."""


# --- closed forms


def sensitivities(
    scene: str,
    variant: str | None,
    outputs: Collection[str],
    point: Mapping[str, float],
    parameters: Collection[str],
) -> Sensitivities:
    """Return the exact derivatives of closed-form outputs at a point.

    At a switch of the equations (an equality that a step would decide) both sides are asked: the
    derivative is that of both if they agree, else NaN with a note that gives the two.

    Parameters
    ----------
    scene, variant
        As in a study.
    outputs : collection of str
        Outputs of the scene.
    point : mapping of str to float
        Parameters by name, SI units and radians.
    parameters : collection of str
        What to derive by: parameters of the point, or those with a default value.

    Raises
    ------
    StudyError
        As for a sweep, for a parameter that is no number here, and for an output whose equations
        have no derivative by `core.optimise.duals`.
    """
    plan = make_plan(scene, variant, outputs, point)
    values = _values(plan, point, parameters)
    found: Sensitivities = {}
    for parameter in parameters:
        at = values[parameter]
        middle = _derivatives(plan, values, parameter)
        doubtful = [name for name, one in middle.items() if not (one.sure and one.finite)]
        sides = _beside(plan, values, parameter) if doubtful else []
        for output, one in middle.items():
            if not math.isfinite(one.value):
                found[output, parameter] = _none("the output has no finite value here")
            elif output in doubtful:
                around = [side[output] for side in sides]
                found[output, parameter] = _from_both_sides(one.value, at, *around)
            else:
                found[output, parameter] = _sensitivity(one.value, one.slope, at)
    return found


def _values(plan: Plan, point: Mapping[str, float], parameters: Collection[str]) -> dict[str, Any]:
    values = {**plan.defaults, **{name: point[name] for name in plan.parameters}}
    unknown = [name for name in parameters if name not in values]
    if unknown:
        fix = f"Known here: {', '.join(values)}"
        message = f"no output asked for of {plan.scene.name} is computed from it"
        raise StudyError([Problem(f"parameters.{name}", message, fix) for name in unknown])
    return {name: float(value) for name, value in values.items()}


def _sensitivity(
    value: float, slope: float, at: float, error: float = 0.0, note: str = ""
) -> Sensitivity:
    logarithmic = slope / value * at if value != 0 and math.isfinite(value) else math.nan
    return Sensitivity(slope, logarithmic, error, note)


def _none(note: str) -> Sensitivity:
    return Sensitivity(math.nan, math.nan, math.nan, note)


class _One(NamedTuple):
    """Value and slope of an output, and whether no switch took part."""

    value: float
    slope: float
    sure: bool

    @property
    def finite(self) -> bool:
        return math.isfinite(self.slope)


def _derivatives(plan: Plan, values: Mapping[str, float], parameter: str) -> dict[str, _One]:
    """Return value and derivative of each output."""
    ties: list[str] = []
    known: dict[str, Any] = {name: np.asarray(value) for name, value in values.items()}
    known[parameter] = Dual(values[parameter], 1.0, ties)
    unsure: set[str] = set()
    for equation in plan.equations:
        ties.clear()
        known[equation.gives] = unboxed(_run(equation, known, parameter))
        if ties or unsure.intersection(equation.inputs):
            unsure.add(equation.gives)
    return {
        name: _One(float(value_of(known[name])), float(slope_of(known[name])), name not in unsure)
        for name in plan.outputs
    }


def _run(equation: Equation, known: Mapping[str, Any], parameter: str) -> Any:
    function = IN_PLACE_OF.get(equation.function, equation.function)
    try:
        with np.errstate(all="ignore"):  # of the branches not taken, whose slopes may be anything
            return function(**{name: known[name] for name in equation.inputs})
    except NotDifferentiableError as error:
        raise StudyError(
            [
                Problem(
                    f"outputs.{equation.gives}",
                    f"its equation has no exact derivative by {parameter}: {error}",
                    "Leave it out, or compare two points of a sweep",
                )
            ]
        ) from error


def _beside(plan: Plan, values: Mapping[str, float], parameter: str) -> list[dict[str, _One]]:
    """Return the derivatives at two points below and two above a point, from below."""
    at = values[parameter]
    step = SIDE * (abs(at) or 1.0)
    return [
        _derivatives(plan, {**values, parameter: at + away * step}, parameter)
        for away in (-WIDER, -1, 1, WIDER)
    ]


def _from_both_sides(
    value: float, at: float, far_below: _One, below: _One, above: _One, far_above: _One
) -> Sensitivity:
    """Return the derivative next to a switch, if it tends to one number from both sides."""
    step = SIDE * (abs(at) or 1.0)
    largest, apart = max(abs(below.slope), abs(above.slope)), abs(above.slope - below.slope)
    # A jump: values of both sides further apart than the slopes explain.
    jumps = abs(above.value - below.value) > 4 * step * largest + ROUNDING * abs(value)
    # At a kink the slopes stay apart however near; those of a bend come together.
    far_apart = abs(far_above.slope - far_below.slope)
    bends = apart <= max(AGREE * largest, far_apart * 2 / WIDER)
    if math.isfinite(apart) and bends and not jumps:
        mean = (below.slope + above.slope) / 2
        return _sensitivity(value, mean, at, apart, "from both sides of a switch")
    sides = f"{below.slope:g} below and {above.slope:g} above"
    return _none(f"at a switch: {sides}{', with a jump' if jumps else ''}")


def _reduced(wrench: Wrench) -> Reduction:
    """Return pitch and axis of a wrench without the scaling of `reduce_screw`."""
    square = unboxed(dot(wrench.force, wrench.force))
    pitch = unboxed(dot(wrench.force, wrench.moment)) / square
    force = np.any(value_of(wrench.force) != 0)
    kind = np.asarray(ScrewKind.GENERAL if force else ScrewKind.ZERO, dtype=np.int8)
    return Reduction(pitch, cross(wrench.force, wrench.moment) / square[..., None], kind)


def _printed(wrench: Wrench) -> Reduction:
    reduction = _reduced(wrench)
    return Reduction(reduction.pitch, -reduction.axis_point, reduction.kind)


IN_PLACE_OF: dict[Callable[..., Any], Callable[..., Any]] = {
    yawing.floor_reduction: lambda *, floor_wrench: _reduced(floor_wrench),
    yawing.force_reduction: lambda *, force_wrench: _reduced(force_wrench),
    yawing.printed_floor_reduction: lambda *, floor_wrench: _printed(floor_wrench),
    yawing.printed_force_reduction: lambda *, force_wrench: _printed(force_wrench),
}
"""Equations whose programs take numbers apart bit by bit, and the same in plain arithmetic."""


# --- simulated motion


def motion_sensitivities(
    scene: str,
    method: str | None,
    outputs: Collection[str],
    point: Mapping[str, float],
    parameters: Collection[str],
) -> Sensitivities:
    """Return the derivatives of simulated motion at a point, from differences inside its regime.

    Central differences over steps that halve from 2 % down are extrapolated (Ridders); the pair of
    least error stands. Steps across which regime, period multiple or the impacts of a period change
    are left out. NaN with a note where nothing is left, where the motion is aperiodic or has no
    value, or where the estimate of the error exceeds a thousandth: next to a jump, or in motion
    that hangs on its parameters too roughly.
    """
    system, chosen, problems = choose_system(scene, method, point)
    if problems:
        raise StudyError(problems)
    asked = tuple(dict.fromkeys((*outputs, "period_multiple", "impacts_per_period")))
    plan = plan_scene(system, chosen, asked, point)
    values = _values(plan, point, parameters)
    steps = LARGEST_STEP * 0.5 ** np.arange(HALVINGS)
    found: Sensitivities = {}
    for parameter in parameters:
        at = values[parameter]
        step = steps * (abs(at) or 1.0)
        known = _simulated(plan, values, parameter, at + np.concatenate([[0.0], -step, step]))
        same = _same_regime(plan, known)
        if same is None:
            none = _none("aperiodic, or no motion that repeats")
            found |= {(output, parameter): none for output in outputs}
            continue
        same = np.broadcast_to(same, 1 + 2 * HALVINGS)
        inside = same[1 : 1 + HALVINGS] & same[1 + HALVINGS :]
        for output in outputs:
            results = np.broadcast_to(known[output], same.shape)
            low, high = results[1 : 1 + HALVINGS], results[1 + HALVINGS :]
            differences = ((high - low) / (2 * step))[inside]
            found[output, parameter] = _extrapolated(float(results[0]), differences, at)
    return found


def _simulated(
    plan: Plan, values: Mapping[str, float], parameter: str, at: Array
) -> dict[str, Any]:
    known: dict[str, Any] = {name: np.asarray(value) for name, value in values.items()}
    known[parameter] = at
    for equation in plan.equations:
        known[equation.gives] = equation.function(**{n: known[n] for n in equation.inputs})
    return known


def _same_regime(plan: Plan, known: dict[str, Any]) -> Any:
    """Return where the motion is of the kind of the first; None if that does not repeat."""
    kinds = np.stack(
        np.broadcast_arrays(
            regimes(plan, known), known["period_multiple"], known["impacts_per_period"]
        )
    )
    kinds = kinds.reshape(3, -1)
    if not kinds[1, 0] >= 1:
        return None
    return np.isclose(kinds, kinds[:, :1], rtol=1e-12, atol=0).all(axis=0)


def _extrapolated(value: float, differences: Array, at: float) -> Sensitivity:
    """Return Ridders' limit of central differences over halving steps, the largest first."""
    if not math.isfinite(value):
        return _none("the motion has no value here")
    best, error = math.nan, math.inf
    above: list[float] = []
    for difference in map(float, differences):
        row = [difference]
        for order, former in enumerate(above, 1):
            row.append(row[-1] + (row[-1] - former) / (4.0**order - 1))
            apart = max(abs(row[-1] - row[-2]), abs(row[-1] - former))
            if apart < error:
                best, error = row[-1], apart
        above = row
    if not math.isfinite(best):
        return _none("the regime changes too near")
    if error > TRUSTED * abs(best):
        return _none(f"differences do not settle: {best:g} with an error of {error:g}")
    return _sensitivity(value, best, at, error, "from differences")
