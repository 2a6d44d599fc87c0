"""The optimisers, by name.

Each takes the problem, the designs (arrays of shape (cells,)), the scales of the outputs, and a
watch. scipy's take one design after the other; the others all at once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.optimise import known_optima, scipy_methods
from vibrafeed.core.optimise.grid import MAX_GRIDDED, by_grid, with_best_rest
from vibrafeed.core.optimise.optima import Optima, Solver
from vibrafeed.core.optimise.population import by_population
from vibrafeed.core.optimise.problem import OptimisationProblem
from vibrafeed.core.watch import Watch


def _known(solver: Callable[[OptimisationProblem, Mapping[str, Array]], Optima]) -> Solver:
    """Return a method of optimisation that uses known optima: closed forms or compiled Newton.

    `solver` returns these optima for a problem and its designs. Where nothing moves a part
    forwards, the method takes the best choice at which it rests.
    """

    def solve(
        problem: OptimisationProblem,
        design: Mapping[str, Array],
        scales: Mapping[str, Array],
        watch: Watch,
    ) -> Optima:
        """Return the known optima of every design."""
        optima = with_best_rest(problem, solver(problem, design), design, scales, watch)
        watch.advance(1.0)
        return optima

    return solve


@dataclass(frozen=True)
class OptimisationMethod:
    """An optimiser.

    Attributes
    ----------
    solve : callable
        Solves any number of designs.
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
    at_once: bool = False


METHODS: dict[str, OptimisationMethod] = {
    "exact": OptimisationMethod(
        _known(known_optima.by_closed_form), 1e-10, "closed form", at_once=True
    ),
    "newton": OptimisationMethod(
        _known(known_optima.by_newton), 1e-10, "compiled batch solver", at_once=True
    ),
    "population": OptimisationMethod(
        by_population, 1e-8, "differential evolution of all designs at once", at_once=True
    ),
    "search": OptimisationMethod(
        scipy_methods.one_by_one(scipy_methods.search, 0.0, scipy_methods.search_budget),
        1e-6,
        "global search for outputs that jump",
    ),
    "grid": OptimisationMethod(
        by_grid, 1e-6, "a dense grid, then finer ones around its best", at_once=True
    ),
    "differential_evolution": OptimisationMethod(
        scipy_methods.one_by_one(scipy_methods.differential_evolution, 1e-9, lambda _: 6_000),
        1e-7,
        "scipy's differential evolution",
    ),
    "shgo": OptimisationMethod(
        scipy_methods.one_by_one(scipy_methods.shgo, 1e-8, lambda _: 5_000),
        1e-6,
        "scipy's simplicial homology search",
    ),
    "direct": OptimisationMethod(
        scipy_methods.one_by_one(scipy_methods.direct, 1e-3, lambda _: scipy_methods.MAX_DIRECT),
        1e-3,
        "scipy's dividing rectangles",
    ),
    "slsqp": OptimisationMethod(
        scipy_methods.one_by_one(scipy_methods.slsqp, 1e-8, lambda _: 3_000),
        1e-7,
        "scipy's SLSQP from several starts",
    ),
    "trust-constr": OptimisationMethod(
        scipy_methods.one_by_one(scipy_methods.trust_constr, 1e-6, lambda _: 6_000),
        1e-6,
        "scipy's trust region from several starts",
    ),
    "minimize_scalar": OptimisationMethod(
        scipy_methods.one_by_one(scipy_methods.minimize_scalar, 1e-8, lambda _: 300),
        1e-6,
        "scipy's bounded search of one variable",
    ),
}
"""Every optimiser, by the name that a study gives."""


def refusal(name: str, problem: OptimisationProblem) -> tuple[str, str] | None:
    """Return the reason why a method cannot solve a problem, and advice; None if it can.

    `name` is the method, a key of `METHODS`.
    """
    if problem.uncertain is not None and name in ("slsqp", "trust-constr"):
        return "the worst case has kinks, and it needs slopes", "Leave method out"
    if name == "exact" and not known_optima.is_closed(problem):
        return "there is no closed form of this problem", "Leave method out"
    if name == "newton" and not known_optima.is_compiled(problem):
        return "the batch solver does not know this problem", "Leave method out"
    if name == "minimize_scalar" and len(problem.names) != 1:
        return f"it takes one variable, not {len(problem.names)}", "Leave method out"
    if name == "grid" and len(problem.names) > MAX_GRIDDED:
        return f"it takes at most {MAX_GRIDDED} variables", "Leave method out"
    return None


def default_method(problem: OptimisationProblem, cells: int) -> str:
    """Return the name of the method for a study that names none.

    It is a closed form or compiled Newton if they know the problem; else ``"search"`` for motions,
    which jump, and ``"population"`` for others. `cells`, the number of designs, is not used.
    """
    front = known_optima.is_front(problem)
    order = ("exact", "newton") if front else ("newton", "exact")
    for name in order:
        if refusal(name, problem) is None:
            return name
    if problem.is_motion:
        return "search"
    return "population"
