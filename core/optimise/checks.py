"""Checks of a study of optimisation that concern several of its sections."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from vibrafeed.core.errors import Problem
from vibrafeed.core.optimise.robust import LEAST_SHARE, MAX_UNCERTAIN
from vibrafeed.core.quantities import FLAGS
from vibrafeed.core.scenes import SCENES, Scene
from vibrafeed.core.study.distributions import Distribution
from vibrafeed.core.study.optimise_study import Limited, OptimiseStudy, Pareto
from vibrafeed.core.study.values import Between, Values


def misplaced(study: OptimiseStudy, values: Mapping[str, Values]) -> Iterable[Problem]:
    """Yield the problems that concern several sections of an optimisation study.

    `values` are its parameters. Variables may not be given as parameters, outputs that are codes
    may not be optimised, and constraints have to be consistent.
    """
    criterion = study.criterion
    if isinstance(criterion, Limited) and criterion.limit < 0:
        fix = "Give the largest absolute value, 0 or more"
        yield Problem("criterion.limit", f"it is {criterion.limit:g}", fix)
    places = {f"constraints.{i}.output": one.output for i, one in enumerate(study.constraints)}
    places |= {"criterion.output": criterion.output}
    places |= {"criterion.against": getattr(criterion, "against", "")}
    for place, name in places.items():
        if name in FLAGS:
            yield Problem(
                place,
                f"the output {name} has names as values, not numbers, and cannot be optimised",
                "Choose another output",
            )
    if len(set(study.criterion_outputs())) < len(study.criterion_outputs()):
        yield Problem(
            "criterion.against",
            "the second output of the criterion is the same as the first",
            "Name another output as against in [criterion]",
        )
    for name in study.bounds():
        if name in values:
            fix = f"Remove {name} from the variables or from the parameters"
            yield Problem(
                f"variables.{name}",
                f"{name} is given twice: in [variables] and in [parameters]",
                fix,
            )
    yield from _problems_of_constraints(study)


def _problems_of_constraints(study: OptimiseStudy) -> Iterable[Problem]:
    """Yield the problems of each constraint of an optimisation, and of two bounds with one name.

    A constraint is an output with a lower bound, an upper one or both, perhaps of its absolute
    value. A problem names the path in the study and a fix.
    """
    seen: set[str] = set()
    for number, constraint in enumerate(study.constraints):
        path = f"constraints.{number}"
        if constraint.lower is None and constraint.upper is None:
            yield Problem(
                path, "the constraint has neither lower nor upper", "Give lower, upper or both"
            )
        elif (
            constraint.lower is not None
            and constraint.upper is not None
            and constraint.lower > constraint.upper
        ):
            yield Problem(path, "lower is above upper", "Swap them")
        if constraint.absolute and constraint.upper is not None and constraint.upper < 0:
            yield Problem(
                f"{path}.upper",
                "the constraint's upper bound of an absolute value is below 0",
                "Give 0 or more",
            )
        for name, _ in constraint.ends():
            if name in seen:
                yield Problem(
                    path,
                    f"{constraint.output} has the same bound twice",
                    "Remove one of the two constraints",
                )
            seen.add(name)


def problems_of_intervals(
    study: OptimiseStudy,
    intervals: Mapping[str, Distribution],
    values: Mapping[str, Values],
    bounds: Mapping[str, Between],
) -> Iterable[Problem]:
    """Yield problems of the uncertain parameters of a study that optimises.

    Found are names that are also fixed or varied, too many of them, and settings of `robust` (what
    of the uncertain objective is optimised: worst case, mean, quantile) that do not fit.

    Parameters
    ----------
    intervals : mapping of str to Distribution
        The uncertain parameters.
    values : mapping of str to Values
        The fixed parameters.
    bounds : mapping of str to Between
        The variables.
    """
    for name in intervals:
        if name in values or name in bounds:
            section = "parameters" if name in values else "variables"
            fix = f"Remove it there, or under {section}.{name}"
            yield Problem(f"uncertain.{name}", f"it is also under {section}", fix)
    if len(intervals) > MAX_UNCERTAIN:
        fix = f'Keep the {MAX_UNCERTAIN} that matter most: kind = "sensitivity" shows which'
        yield Problem("uncertain", f"there are {len(intervals)} of them", fix)
    yield from _problems_of_quantile(study)
    if study.robust is not None and not intervals:
        fix = "Add [uncertain], for example friction = { lower = 0.2, upper = 0.4 }"
        yield Problem("robust", "no parameter is uncertain", fix)
    if intervals and isinstance(study.criterion, Pareto):
        fix = "Use the criterion limit, at several limits"
        yield Problem(
            "uncertain",
            "a trade-off (criterion pareto) cannot be computed with uncertain parameters",
            fix,
        )


def _problems_of_quantile(study: OptimiseStudy) -> Iterable[Problem]:
    """Yield the problems of the quantile of a study: missing, without use, or too rare."""
    if study.robust == "quantile" and study.quantile is None:
        fix = "Add quantile = 0.05 for what all but a twentieth of the parts do better than"
        yield Problem("quantile", "it is missing", fix)
    if study.quantile is not None and not LEAST_SHARE <= study.quantile <= 1 - LEAST_SHARE:
        message = f"a quantile of {study.quantile:g} takes too many points"
        fix = f'Give {LEAST_SHARE:g} to {1 - LEAST_SHARE:g}, or take robust = "worst"'
        yield Problem("quantile", message, fix)
    if study.quantile is not None and study.robust != "quantile":
        yield Problem(
            "quantile",
            "quantile is given, but only robust = 'quantile' uses it",
            'Remove quantile, or set robust = "quantile"',
        )


def of_other_drive(problem: Problem, scene: Scene) -> Problem:
    """Return a plan's problem, reworded if only the plain sine drive has the output.

    `scene` is the one that was planned.
    """
    producers = scene.producers(scene.default_variant)
    closed = SCENES.get(scene.name)
    if "wave" not in producers or closed is None or not problem.about:
        return problem
    if not any(problem.about in closed.outputs(variant) for variant in closed.variants):
        return problem
    message = (
        f"'{problem.about}' is a closed form of the plain sine, and the study gives another drive"
    )
    fix = "Take an output of the motion, such as conveying_velocity"
    return replace(problem, message=message, fix=fix)
