"""Running the equations of a plan on whole arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from core.sweep.plan import Plan
from core.watch import Watch

WATCHED = ("motion", "tumble")
"""What takes long, may be stopped, and has a course in time."""


def run_equations(
    plan: Plan, given: Mapping[str, Any], watch: Watch | None = None
) -> dict[str, Any]:
    """Return every quantity of a plan on whole arrays, SI units: given, default and computed.

    `given` holds the parameters; equations that take long ask the watch.
    """
    known: dict[str, Any] = {name: np.asarray(value) for name, value in plan.defaults.items()}
    known |= given
    for equation in plan.equations:
        arguments = {name: known[name] for name in equation.inputs}
        function: Callable[..., Any] = equation.function
        watched = {"watch": watch} if equation.gives in WATCHED else {}
        known[equation.gives] = function(**arguments, **watched)
    return known
