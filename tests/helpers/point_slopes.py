"""Derivatives at one point, and in words why there is none."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import NamedTuple, TypeAlias

import numpy as np

from vibrafeed.core.errors import StudyError
from vibrafeed.core.motion.derivatives import derivatives_at
from vibrafeed.core.motion.prepare import choose_system
from vibrafeed.core.plan.derivatives import DERIVATIVE_STATUS, Derived, derivatives, values_of
from vibrafeed.core.plan.plan import make_plan, plan_scene
from vibrafeed.core.quantities.derivative import DERIVATIVE_STATUSES

NAMES = {value: name for name, value in DERIVATIVE_STATUS.items()}


class Sensitivity(NamedTuple):
    """How an output changes with a parameter at a point, SI units.

    Attributes
    ----------
    derivative : float
        Of the output by the parameter; NaN where there is none.
    logarithmic : float
        d ln(output)/d ln(parameter), the exponent of a power law; NaN where the output is 0.
    error : float
        Estimate of the error of `derivative`; 0 if exact up to rounding.
    note : str
        Why there is no derivative, or how it was found; empty for an exact one.
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
    """Return the exact derivatives of closed-form outputs at a point.

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
        As for a sweep, and as `derivatives` does.
    """
    plan = make_plan(scene, variant, outputs, point)
    at = values_of(plan, point, parameters)
    found = derivatives(plan, point, parameters)
    return {key: in_words(one, float(at[key[1]][0])) for key, one in found.items()}


def in_words(derived: Derived, at: float) -> Sensitivity:
    """Return the derivative at a single cell, where the parameter has the value `at`."""
    _, slope, error, status, below, above, jumps = (field[0] for field in derived)
    if status == DERIVATIVE_STATUS["both_sides"]:
        note = "from both sides of a switch"
    elif status == DERIVATIVE_STATUS["differences"]:
        note = "from differences"
    elif status == DERIVATIVE_STATUS["no_value"]:
        note = "the output has no finite value here"
    elif status == DERIVATIVE_STATUS["kink"] and not math.isnan(below + above):
        sides = f"{below:g} below and {above:g} above"
        note = f"at a switch: {sides}{', with a jump' if jumps else ''}"
    elif status == DERIVATIVE_STATUS["exact"]:
        note = ""
    else:
        note = DERIVATIVE_STATUSES[NAMES[int(status)]].description.removeprefix("none: ")
    if status >= DERIVATIVE_STATUS["kink"]:
        return Sensitivity(math.nan, math.nan, math.nan, note)
    logarithmic = float(derived.logarithmic(np.asarray([at]))[0])
    return Sensitivity(float(slope), logarithmic, float(error), note)


def motion_sensitivities(
    scene: str,
    method: str | None,
    outputs: Collection[str],
    point: Mapping[str, float],
    parameters: Collection[str],
) -> Sensitivities:
    """Return the derivatives of simulated motion at a point, in words where there are none.

    Parameters
    ----------
    scene, method
        As in a study.
    outputs : collection of str
        Outputs of the system.
    point : mapping of str to float
        Parameters by name, SI units and radians.
    parameters : collection of str
        What to derive by.

    Raises
    ------
    StudyError
        As for a simulation, and as `derivatives_at` does.
    """
    system, chosen, problems = choose_system(scene, method, point)
    if problems:
        raise StudyError(problems)
    plan = plan_scene(system, chosen, outputs, point)
    at = values_of(plan, point, parameters)
    found = derivatives_at(plan, point, parameters)
    return {key: in_words(one, float(at[key[1]][0])) for key, one in found.items()}
