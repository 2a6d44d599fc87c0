"""The aim of an optimisation in words."""

from __future__ import annotations

from vibrafeed.core.optimise.problem import OptimisationProblem
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.distributions import Distribution, nominal, tolerance
from vibrafeed.core.study.optimise_study import Limited, Pareto, Weighted
from vibrafeed.core.study.values import Between


def criterion_in_words(problem: OptimisationProblem) -> str:
    """Return the criterion in a few words."""
    return _looked_for(problem) + _over_interval(problem)


def _over_interval(problem: OptimisationProblem) -> str:
    """Return the words on uncertain parameters for a criterion; empty if there are none.

    An example is ", in the worst case over friction from 0.2 to 0.4".
    """
    if problem.uncertain is None:
        return ""
    how = {"worst": "in the worst case", "mean": "on average"}.get(problem.uncertain.how)
    how = how or f"of the {problem.uncertain.quantile:g} quantile"
    names = (_known(name, one) for name, one in problem.uncertain.distributions.items())
    return f", {how} over {', '.join(names)}"


def _known(name: str, distribution: Distribution) -> str:
    """Return the uncertainty of a parameter in words, such as "friction from 0.2 to 0.4".

    It stands in the criterion of an optimisation; `name` is the parameter.
    """
    unit = QUANTITIES[name].suffix
    if isinstance(distribution, Between):
        return f"{name} from {distribution.lower:g} to {distribution.upper:g}{unit}"
    lower, upper = tolerance(name, distribution)
    return f"{name} about {nominal(distribution):g} ({lower:.4g} to {upper:.4g}){unit}"


def _looked_for(problem: OptimisationProblem) -> str:
    """Return the objective of an optimisation in words, such as "largest conveying_velocity"."""
    criterion = problem.criterion
    output, against = criterion.output, problem.against
    if isinstance(criterion, Weighted):
        return f"largest {output} - {criterion.weight:g} |{against}|"
    if isinstance(criterion, Limited):
        unit = QUANTITIES[criterion.against].suffix
        return f"largest {output} with |{against}| <= {criterion.limit:g}{unit}"
    if isinstance(criterion, Pareto):
        return f"{output} high, |{against}| low: the whole front"
    return f"{'least' if problem.sign < 0 else 'largest'} {output}"
