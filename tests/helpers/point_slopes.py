"""Derivatives at one point, and in words why there is none."""

import math
from collections.abc import Collection, Mapping
from typing import NamedTuple, TypeAlias

from plans import make_plan
from vibrafeed.core.errors import StudyError
from vibrafeed.core.motion.prepare import choose_system
from vibrafeed.core.plan.differences import STATUS, derivatives, values_of
from vibrafeed.core.plan.plan import Plan, plan_scene
from vibrafeed.core.quantities.flags import DERIVATIVE_STATUSES

NAMES = {value: name for name, value in STATUS.items()}


class Sensitivity(NamedTuple):
    """How an output changes with a parameter at a point, SI units; NaN where it has no slope.

    Attributes
    ----------
    derivative : float
        Of the output by the parameter.
    logarithmic : float
        d ln(output)/d ln(parameter), the exponent of a power law; NaN where the output is 0.
    error : float
        Estimate of the error of `derivative`.
    note : str
        Why there is no derivative, or that it is one-sided; empty for one of both sides.
    """

    derivative: float
    logarithmic: float
    error: float
    note: str


Sensitivities: TypeAlias = dict[tuple[str, str], Sensitivity]
"""By output and parameter."""


def sensitivities(
    scene: str,
    variant: str | None,
    outputs: Collection[str],
    point: Mapping[str, float],
    parameters: Collection[str],
) -> Sensitivities:
    """Return the derivatives of closed-form outputs at a point, in SI units and radians."""
    return _in_words(make_plan(scene, variant, outputs, point), point, parameters)


def motion_sensitivities(
    scene: str,
    method: str | None,
    outputs: Collection[str],
    point: Mapping[str, float],
    parameters: Collection[str],
) -> Sensitivities:
    """Return the derivatives of simulated motion; raise `StudyError` as a simulation does."""
    system, chosen, problems = choose_system(scene, method, point)
    if problems:
        raise StudyError(problems)
    return _in_words(plan_scene(system, chosen, outputs, point), point, parameters)


def _in_words(plan: Plan, point: Mapping[str, float], parameters: Collection[str]) -> Sensitivities:
    at, told = values_of(plan, point, parameters), {}
    for key, derived in derivatives(plan, point, parameters).items():
        _, slope, error, status = (float(field[0]) for field in derived)
        name = NAMES[int(status)]
        note = DERIVATIVE_STATUSES[name].description.removeprefix("none: ")
        exponent = float(derived.logarithmic(at[key[1]][:1])[0])
        numbers = [slope, exponent, error] if status < STATUS["kink"] else [math.nan] * 3
        told[key] = Sensitivity(*numbers, "" if name == "differences" else note)
    return told
