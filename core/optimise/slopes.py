"""The change of an output with each parameter at the optima: d ln(output)/d ln(parameter)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise.problem import OptimisationProblem
from vibrafeed.core.plan.differences import derivatives, values_of
from vibrafeed.core.plan.plan import plan_scene

MAX_SENSITIVE = 1_000
"""Designs of a study that asks for sensitivities: each is derived by itself."""


def sensitive(problem: OptimisationProblem) -> tuple[str, ...]:
    """Return the parameters by which the criterion's output is differentiated."""
    plan = problem.plan.only(problem.criterion.output)
    return tuple(dict.fromkeys((*problem.names, *plan.parameters)))


def slopes(
    problem: OptimisationProblem, x: Array, design: Mapping[str, Array], lost: NDArray[np.bool_]
) -> dict[str, Array]:
    """Return the elasticities d ln(output)/d ln(parameter) of the objective's output at optima.

    They tell a user which parameter matters at the optimum. The names are
    ``sensitivity_<parameter>``, the values arrays (cells,), from differences inside one regime. NaN
    where there is none: at a kink, a jump, and for a parameter or an output that is 0. 0 for a
    variable that the output does not depend on.
    """
    names, output, kept = sensitive(problem), problem.criterion.output, ~lost
    used = problem.plan.only(output).parameters
    elasticities = {name: np.where(kept, np.nan if name in used else 0.0, np.nan) for name in names}
    if kept.any():
        cells = {name: design[name][kept] for name in used if name in design}
        cells |= {name: x[i, kept] for i, name in enumerate(problem.names) if name in used}
        plan = plan_scene(problem.plan.scene, problem.plan.variant, (output,), cells)
        by = tuple(name for name in names if name in used)
        values = values_of(plan, cells, by)
        for (_, name), derived in derivatives(plan, cells, by).items():
            elasticities[name][kept] = derived.logarithmic(values[name])
    return {f"sensitivity_{name}": values for name, values in elasticities.items()}
