"""The optimisers, by name. Each takes problem, designs, scales of the outputs, and a watch."""

from __future__ import annotations

from dataclasses import dataclass

from vibrafeed.core.optimise.exact import by_exact, is_closed
from vibrafeed.core.optimise.optima import Solver
from vibrafeed.core.optimise.problem import OptimisationProblem
from vibrafeed.core.optimise.scipy_methods import by_scipy
from vibrafeed.core.optimise.search import by_search


@dataclass(frozen=True)
class OptimisationMethod:
    """An optimiser.

    Attributes
    ----------
    solve : callable
        Solves any number of designs, arrays of shape (cells,).
    tolerance : float
        A margin within so much of its output's scale counts as none: what the method leaves.
    says : str
        What it is, in one line.
    at_once : bool
        Whether it takes all designs at once.
    """

    solve: Solver
    tolerance: float
    says: str
    at_once: bool = True


METHODS: dict[str, OptimisationMethod] = {
    "exact": OptimisationMethod(by_exact, 1e-10, "closed form"),
    "search": OptimisationMethod(by_search, 1e-8, "differential evolution of all designs at once"),
    "scipy": OptimisationMethod(
        by_scipy, 1e-7, "scipy's differential evolution and SLSQP", at_once=False
    ),
}
"""Every optimiser, by the name that a study gives."""

FORMER = {
    "newton": "exact",
    "population": "search",
    "grid": "search",
    **dict.fromkeys(
        ("slsqp", "trust-constr", "differential_evolution", "shgo", "direct", "minimize_scalar"),
        "scipy",
    ),
}
"""Names of methods that went, and the one to name instead."""


def refusal(name: str, problem: OptimisationProblem) -> tuple[str, str] | None:
    """Return the reason why a method cannot solve a problem, and advice; None if it can.

    `name` is the method, a key of `METHODS`.
    """
    if name == "exact" and not is_closed(problem):
        return "there is no closed form of this problem", "Leave method out"
    return None


def default_method(problem: OptimisationProblem) -> str:
    """Return the name of the method for a study that names none."""
    return "exact" if is_closed(problem) else "search"
