"""Running the equations of a plan on arrays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.plan.plan import Plan, Verdict
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes import Equation
from vibrafeed.core.watch import Watch

Known = dict[str, Any]
"""Quantities by name: arrays that broadcast, SI units, and bundles of them."""


def too_large_is_data() -> np.errstate:
    """Return a context in which overflow gives infinity without a warning.

    What hangs on it may be no number; the compiled loops of large sweeps say nothing of it either.
    """
    return np.errstate(over="ignore", invalid="ignore")


def run_equations(plan: Plan, parameters: Mapping[str, Any], watch: Watch | None = None) -> Known:
    """Compute all equations of a plan on whole arrays; return every quantity, SI units.

    Equations that take long, such as motions, ask `watch` whether to stop.
    """
    known: Known = {name: np.asarray(value) for name, value in plan.defaults.items()}
    return run(plan.equations, known | dict(parameters), watch)


def run(equations: Iterable[Equation], known: Known, watch: Watch | None = None) -> Known:
    """Compute equations one after another, adding their results to `known`, which is returned."""
    with too_large_is_data():
        for equation in equations:
            watched = {"watch": watch} if equation.takes_long else {}
            known[equation.gives] = equation.function(
                **{name: known[name] for name in equation.inputs}, **watched
            )
    return known


def regimes(plan: Plan, known: Mapping[str, Any]) -> dict[str, NDArray[np.int8]]:
    """Return the regimes of the cells by each verdict of a plan, by the name of the verdict."""
    return {name: np.asarray(one) for name, one in regimes_of(plan.verdicts, known).items()}


def regimes_of(verdicts: Sequence[Verdict], known: Mapping[str, Any]) -> dict[str, Any]:
    """Return the number of each cell's regime by each verdict: the first condition that holds.

    A condition of several verdicts is looked at once. The results are int8.
    """
    results: dict[str, Any] = {}
    with too_large_is_data():
        holds = {
            condition: condition.function(**{name: known[name] for name in condition.inputs})
            for condition in dict.fromkeys(one for v in verdicts for one in v.conditions)
        }
        for verdict in verdicts:
            regime: Any = np.int8(REGIMES[verdict.otherwise].value)
            for condition in reversed(verdict.conditions):
                regime = np.where(
                    holds[condition], np.int8(REGIMES[condition.regime].value), regime
                )
            results[verdict.name] = regime
    return results
