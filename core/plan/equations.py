"""Running the equations of a plan on arrays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.plan.plan import Plan
from core.quantities import REGIMES
from core.scenes import Condition, Equation
from core.watch import Watch

Known = dict[str, Any]
"""Quantities by name: arrays that broadcast, SI units, and bundles of them."""


def too_large_is_data() -> np.errstate:
    """Return the context in which what is too large for a float is infinite, without a warning.

    What hangs on it may be no number; the compiled loops of large sweeps say nothing of it either.
    """
    return np.errstate(over="ignore", invalid="ignore")


def run_equations(plan: Plan, parameters: Mapping[str, Any], watch: Watch | None = None) -> Known:
    """Return every quantity of a plan on whole arrays, SI units: given, default and computed.

    Equations that take long ask the watch.
    """
    known: Known = {name: np.asarray(value) for name, value in plan.defaults.items()}
    return run(plan.equations, known | dict(parameters), watch)


def run(equations: Iterable[Equation], known: Known, watch: Watch | None = None) -> Known:
    """Add what equations give, one after another, to what is known; return that."""
    with too_large_is_data():
        for equation in equations:
            watched = {"watch": watch} if equation.takes_long else {}
            known[equation.gives] = equation.function(
                **{name: known[name] for name in equation.inputs}, **watched
            )
    return known


def regimes(plan: Plan, known: Mapping[str, Any]) -> NDArray[np.int8]:
    """Return the regime of each cell: the first condition that holds, or what remains."""
    return np.asarray(regimes_of(plan.conditions, plan.otherwise, known))


def regimes_of(conditions: Sequence[Condition], otherwise: str, known: Mapping[str, Any]) -> Any:
    """Return the same as `regimes`, of conditions and the regime where none of them holds."""
    regime: Any = np.int8(REGIMES[otherwise].value)
    with too_large_is_data():
        for condition in reversed(conditions):
            holds = condition.function(**{name: known[name] for name in condition.inputs})
            regime = np.where(holds, np.int8(REGIMES[condition.regime].value), regime)
    return regime
