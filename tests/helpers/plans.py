"""Plans of scenes by their names, and the values that their equations give."""

import warnings
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from vibrafeed.core.plan.plan import Plan, Verdict, find_scene, plan_scene, regimes_of


def make_plan(
    scene: str, variant: str | None, outputs: Collection[str], parameters: Collection[str]
) -> Plan:
    """Return the plan for outputs of a named scene; raise `StudyError` with every problem."""
    return plan_scene(*find_scene(scene, variant), outputs, parameters)


def quantities_at(
    scene: str, variant: str | None, outputs: Collection[str], cells: Mapping[str, Any]
) -> dict[str, Any]:
    """Return every quantity of the plan at cells, and the numbers of the regime."""
    plan = make_plan(scene, variant, outputs, list(cells))
    known, shape = _known(plan, cells), np.broadcast_shapes(*map(np.shape, cells.values()))
    found = regimes_of([Verdict("regime", tuple(outputs), plan.conditions)], known)
    return known | {"regime": np.broadcast_to(found["regime"], shape)}


def values_at(
    scene: str, variant: str | None, outputs: Collection[str], cells: Mapping[str, Any]
) -> dict[str, Any]:
    """Return outputs at cells, SI units: each equation is called once, and none may warn."""
    plan = make_plan(scene, variant, outputs, cells)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", ".*usual values are")
        known = _known(plan, cells)
    return {name: known[name] for name in plan.outputs}


def _known(plan: Plan, cells: Mapping[str, Any]) -> dict[str, Any]:
    known = {name: np.asarray(value) for name, value in {**plan.defaults, **cells}.items()}
    for equation in plan.equations:
        known[equation.gives] = equation.function(**{n: known[n] for n in equation.inputs})
    return known
