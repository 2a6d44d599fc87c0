"""How an output changes with each parameter at the optima: d ln(output)/d ln(parameter)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array
from core.motion.derivatives import motion_sensitivities
from core.optimise.problem import Problem
from core.plan.derivatives import sensitivities

MOST_SENSITIVE = 1_000
"""Designs of a study that asks for sensitivities: each is derived by itself."""


def sensitive(problem: Problem) -> tuple[str, ...]:
    """Return the parameters that the output of the criterion is derived by."""
    plan = problem.plan.only(problem.criterion.output)
    return tuple(dict.fromkeys((*problem.names, *plan.parameters)))


def slopes(
    problem: Problem, x: Array, design: Mapping[str, Array], lost: NDArray[np.bool_]
) -> dict[str, Array]:
    """Return the logarithmic derivatives at optima x, shape (variables, cells).

    Those of closed forms are exact; those of motion are differences inside one regime. NaN where
    there is none: at a kink, a jump, and for a parameter or an output that is 0.
    """
    names, output = sensitive(problem), problem.criterion.output
    found = {name: np.full(lost.shape, np.nan) for name in names}
    scene = problem.plan.scene
    derive: Any = motion_sensitivities if problem.is_motion else sensitivities
    for cell in np.flatnonzero(~lost):
        point = {n: float(design[n][cell]) for n in names if n in design}
        point |= {name: float(x[i, cell]) for i, name in enumerate(problem.names)}
        told = derive(scene.name, problem.plan.variant, [output], point, names)
        for name in names:
            found[name][cell] = told[output, name].logarithmic
    return found
