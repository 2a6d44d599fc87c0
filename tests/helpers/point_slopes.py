"""Derivatives at one point, and in words why there is none."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import NamedTuple, TypeAlias

import numpy as np

from plans import make_plan
from vibrafeed.core.errors import StudyError
from vibrafeed.core.motion.prepare import choose_system
from vibrafeed.core.plan.differences import STATUS, Derived, derivatives, values_of
from vibrafeed.core.plan.plan import plan_scene
from vibrafeed.core.quantities.flags import DERIVATIVE_STATUSES

NAMES = {value: name for name, value in STATUS.items()}


class Sensitivity(NamedTuple):
    """How an output changes with a parameter at a point, SI units.

    Attributes
    ----------
    derivative : float
        Of the output by the parameter; NaN where there is none.
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
    """Return the derivatives of closed-form outputs at a point.

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
    _, slope, error, status = (field[0] for field in derived)
    name = NAMES[int(status)]
    note = DERIVATIVE_STATUSES[name].description.removeprefix("none: ")
    if status >= STATUS["kink"]:
        return Sensitivity(math.nan, math.nan, math.nan, note)
    logarithmic = float(derived.logarithmic(np.asarray([at]))[0])
    note = "" if name == "differences" else note
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
        As for a simulation, and as `derivatives` does.
    """
    system, chosen, problems = choose_system(scene, method, point)
    if problems:
        raise StudyError(problems)
    plan = plan_scene(system, chosen, outputs, point)
    at = values_of(plan, point, parameters)
    found = derivatives(plan, point, parameters)
    return {key: in_words(one, float(at[key[1]][0])) for key, one in found.items()}
