"""From a study of optimisation to what can be carried out: scene, variables, problem, method."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from vibrafeed.core.errors import Problem, StudyError, given_twice, raise_any, refused
from vibrafeed.core.motion.prepare import choose_system
from vibrafeed.core.motion.systems import CONTACTS, SYSTEMS
from vibrafeed.core.optimise.exact import is_closed
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.optimise.optimisation import Optimisation
from vibrafeed.core.optimise.problem import (
    CONTACT_OUTPUTS,
    LIMIT,
    SECOND,
    OptimisationProblem,
    OutputBound,
)
from vibrafeed.core.optimise.search import MAX_VARIABLES
from vibrafeed.core.optimise.uncertain import LEAST_SHARE, MAX_UNCERTAIN, uncertain_of
from vibrafeed.core.plan.grid import Grid, to_si
from vibrafeed.core.plan.plan import choose_scene
from vibrafeed.core.plan.prepared import Chosen, locate_problem, plan_study
from vibrafeed.core.quantities import FLAGS, QUANTITIES
from vibrafeed.core.scenes import SCENES, Scene
from vibrafeed.core.scenes.scene import behind
from vibrafeed.core.study.distributions import Distribution, nominal, tolerance
from vibrafeed.core.study.grid_study import DrivenStudy, only_the_plain_sine
from vibrafeed.core.study.optimise_study import ANGLES, Limited, OptimiseStudy, Pareto
from vibrafeed.core.study.values import Between, Fixed, Span, Values
from vibrafeed.core.suggestions import suggestion

FRONT = "front"


def prepare(study: OptimiseStudy) -> Optimisation:
    """Return the optimisation that a study describes, checked and planned, ready to be computed."""
    values, intervals = study.values(), study.intervals()
    requested = tuple(dict.fromkeys((*study.criterion_outputs(), *study.outputs)))
    scene, variant, _ = chosen = _scene_of(study, requested)
    constraints = tuple(_output_bounds(study, scene, variant))
    second = SECOND.get(study.criterion.output, "")
    if study.criterion.kind == "maximise" and second in scene.outputs(variant):
        requested = (*requested, second)
    computed = dict.fromkeys((*requested, *(constraint.output for constraint in constraints)))
    outputs = tuple(name for name in computed if name != "regime")
    bounds = study.bounds() or _default_bounds(scene, variant, outputs, values)
    problems = [
        *_problems_of_fields(study, values),
        *_problems_of_constraints(study),
        *_problems_of_bounds(bounds),
        *_problems_of_intervals(study, intervals, values, bounds),
    ]
    ends = {name: (between.lower, between.upper) for name, between in bounds.items()}
    ends |= {name: tolerance(name, distribution) for name, distribution in intervals.items()}
    ranges = {name: Span(*pair, 2) for name, pair in ends.items() if name not in values}
    try:
        plan, _ = plan_study(study, outputs, chosen, ranges)
    except StudyError as error:
        problems += (
            locate_problem(_explained_by_drive(problem, scene), study) for problem in error.problems
        )
    if study.method is not None and study.method not in METHODS:
        unknown = f"'{study.method[:60]}' is not a method"
        problems.append(Problem("method", unknown, suggestion(study.method, METHODS)))
    if problems:
        raise StudyError(dict.fromkeys(problems))
    uncertain = None
    if intervals:
        uncertain = uncertain_of(
            intervals, study.robust or "worst", study.quantile, is_limited=bool(constraints)
        )
    problem = OptimisationProblem(
        plan, _bounds_in_si(bounds), study.criterion, constraints, uncertain
    )
    nominals = {name: Fixed(nominal(distribution)) for name, distribution in intervals.items()}
    fixed = {name: value for name, value in values.items() if name in plan.parameters}
    designs = grid = Grid.of({**fixed, **nominals})
    method = _method(study, problem)
    if isinstance(study.criterion, Pareto):
        fractions = Span(0.0, 1.0, study.criterion.points)
        grid = replace(designs, axes={**designs.axes, FRONT: fractions})
    # What is chosen is no parameter of the result.
    return Optimisation(study, plan, grid, designs, problem, method).check_verification()


def _method(study: OptimiseStudy, problem: OptimisationProblem) -> str:
    method = study.method or ("exact" if is_closed(problem) else "search")
    if method == "exact" and not is_closed(problem):
        raise refused("method", "this problem has no exact solution", "Remove method")
    return method


def _scene_of(study: OptimiseStudy, requested: Iterable[str]) -> Chosen:
    outputs = (*requested, *(constraint.output for constraint in study.constraints))
    parameters = (*study.values(), *study.bounds(), *study.intervals())
    try:
        chosen = choose_problem_scene(study.scene, study.variant, outputs, parameters)
    except StudyError as error:
        raise StudyError(locate_problem(problem, study) for problem in error.problems) from None
    raise_any(drive_refusal(study, chosen[0]))
    return chosen


def drive_refusal(study: DrivenStudy, scene: Scene) -> Iterable[Problem]:
    """Yield the problem of a measured drive if a study's scene is none that can follow it."""
    if study.drive is not None and (scene.choice != "method" or scene.name not in CONTACTS):
        yield only_the_plain_sine(
            f"Ask for conveying_velocity of {', '.join(CONTACTS)}, or give these"
        )


def _problems_of_bounds(bounds: Mapping[str, Between]) -> Iterable[Problem]:
    yield from (
        Problem(
            f"variables.{name}",
            f"no two whole numbers lie between the bounds of {name}",
            "Widen the bounds, or give one value in [parameters]",
        )
        for name, between in bounds.items()
        if QUANTITIES[name].count and math.ceil(between.lower) >= math.floor(between.upper)
    )
    if not bounds:
        yield Problem(
            "variables",
            "the study has no variables",
            'Add one, for example [variables] beta = { lower = 0, upper = "90 deg" }',
        )
    if len(bounds) > MAX_VARIABLES:
        yield Problem(
            "variables",
            f"the study has {len(bounds)} variables, at most {MAX_VARIABLES} are allowed",
            "Give some of them a fixed value in [parameters]",
        )


def _bounds_in_si(bounds: Mapping[str, Between]) -> dict[str, tuple[float, float]]:
    ends = {}
    for name, between in bounds.items():
        lower, upper = between.lower, between.upper
        if QUANTITIES[name].count:
            lower, upper = math.ceil(lower), math.floor(upper)
        lower, upper = (float(to_si(name, np.asarray(end))) for end in (lower, upper))
        ends[name] = lower, upper
    return ends


def choose_problem_scene(
    name: str, variant: str | None, outputs: Iterable[str], parameters: Iterable[str] = ()
) -> Chosen:
    """Return the scene for an optimum: a closed form with its variant, or a motion with its method.

    Motion is taken if an output needs it, or if a parameter belongs to a drive other than the plain
    sine, which closed forms do not know. The third result are problems of the variant, which is
    then replaced by the default.
    """
    scene, chosen, problems = choose_scene(name, variant)
    closed = {output for variant_ in scene.variants for output in scene.outputs(variant_)}
    if name in SYSTEMS:
        system, method, _ = choose_system(name, None, parameters)
        # A wave, a drive unit and a floor that gives have equations of their own.
        is_plain = system.variants[method] == SYSTEMS[name].variants[method]
        if not is_plain or any(
            output not in closed and output in system.outputs(method) for output in outputs
        ):
            or_outputs = ", or ask for outputs of the closed forms alone" if is_plain else ""
            problem = Problem(
                "variant",
                "variant is given, but a simulated motion has no variants",
                f"Remove it{or_outputs}",
            )
            return system, method, [problem] if variant else []
    return scene, chosen, problems


def _output_bounds(study: OptimiseStudy, scene: Scene, variant: str) -> Iterable[OutputBound]:
    if isinstance(study.criterion, Limited):
        yield OutputBound(LIMIT, study.criterion.against, study.criterion.limit, True, True)
    switches = {"floor_contact": study.floor_contact, "wall_contact": study.wall_contact}
    for name, output in CONTACT_OUTPUTS.items():
        if switches[name] and output in scene.outputs(variant):
            yield OutputBound(name, output, 0.0, upper=False)
    for constraint in study.constraints:
        for name, bound in constraint.ends():
            yield OutputBound(
                name, constraint.output, bound, name.endswith("upper"), constraint.absolute
            )


def _default_bounds(
    scene: Scene, variant: str, outputs: Iterable[str], values: Mapping[str, Values]
) -> dict[str, Between]:
    # 0 to 90 degrees for the drive angles that outputs need, unless given or refused by the scene.
    needed = behind(outputs, scene.producers(variant).get).keys()
    unsuitable = {
        constraint.parameters[0]
        for constraint in scene.constraints
        if constraint.variant in ("", variant)
        and len(constraint.parameters) == 1
        and not constraint.holds(0.0, np.pi / 2)
    }
    return {
        name: bounds
        for name, bounds in ANGLES.items()
        if name in needed - unsuitable and name not in values
    }


# --- checks of several sections


def _problems_of_fields(study: OptimiseStudy, values: Mapping[str, Values]) -> Iterable[Problem]:
    criterion = study.criterion
    if isinstance(criterion, Limited) and criterion.limit < 0:
        yield Problem(
            "criterion.limit",
            f"the limit of an absolute value is {criterion.limit:g}, which is below 0",
            "Give 0 or more",
        )
    places = {
        f"constraints.{number}.output": constraint.output
        for number, constraint in enumerate(study.constraints)
    }
    places |= {"criterion.output": criterion.output}
    places |= {"criterion.against": getattr(criterion, "against", "")}
    yield from (
        Problem(
            place,
            f"the values of {name} are names, not numbers, so it cannot be optimised",
            "Choose another output",
        )
        for place, name in places.items()
        if name in FLAGS
    )
    if len(set(study.criterion_outputs())) < len(study.criterion_outputs()):
        yield Problem(
            "criterion.against",
            "the second output of the criterion is the same as the first",
            "Set against to another output in [criterion]",
        )
    yield from given_twice("variables", study.bounds(), "parameters", values)


def _problems_of_constraints(study: OptimiseStudy) -> Iterable[Problem]:
    seen: set[str] = set()
    for number, constraint in enumerate(study.constraints):
        path = f"constraints.{number}"
        if constraint.lower is None and constraint.upper is None:
            yield Problem(
                path, "the constraint has neither lower nor upper", "Add lower, upper or both"
            )
        elif (
            constraint.lower is not None
            and constraint.upper is not None
            and constraint.lower > constraint.upper
        ):
            yield Problem(path, "the lower bound is above the upper bound", "Swap lower and upper")
        if constraint.absolute and constraint.upper is not None and constraint.upper < 0:
            yield Problem(
                f"{path}.upper",
                "the upper bound of an absolute value is below 0",
                "Give 0 or more",
            )
        for name, _ in constraint.ends():
            if name in seen:
                yield Problem(
                    path,
                    f"two constraints set the same bound of {constraint.output}",
                    "Remove one of the two constraints",
                )
            seen.add(name)


def _problems_of_intervals(
    study: OptimiseStudy,
    intervals: Mapping[str, Distribution],
    values: Mapping[str, Values],
    bounds: Mapping[str, Between],
) -> Iterable[Problem]:
    yield from given_twice("uncertain", intervals, "parameters", values)
    yield from given_twice("uncertain", intervals, "variables", bounds)
    if len(intervals) > MAX_UNCERTAIN:
        yield Problem(
            "uncertain",
            f"{len(intervals)} parameters are uncertain, at most {MAX_UNCERTAIN} are allowed",
            'Keep those that matter most: kind = "sensitivity" shows which',
        )
    yield from _problems_of_quantile(study)
    if study.robust is not None and not intervals:
        yield Problem(
            "robust",
            "robust is given, but no parameter is uncertain",
            "Name one, such as uncertain.friction = { lower = 0.2, upper = 0.4 }",
        )
    if intervals and isinstance(study.criterion, Pareto):
        yield Problem(
            "uncertain",
            "a trade-off (criterion pareto) cannot be computed with uncertain parameters",
            "Use the criterion limit, at several limits",
        )


def _problems_of_quantile(study: OptimiseStudy) -> Iterable[Problem]:
    if study.robust == "quantile" and study.quantile is None:
        yield Problem(
            "quantile",
            "robust = 'quantile' needs a quantile",
            "Add quantile = 0.05 for the value that 95 % of the parts exceed",
        )
    if study.quantile is not None and not LEAST_SHARE <= study.quantile <= 1 - LEAST_SHARE:
        yield Problem(
            "quantile",
            f"a quantile of {study.quantile:g} would need too many points",
            f'Give {LEAST_SHARE:g} to {1 - LEAST_SHARE:g}, or set robust = "worst"',
        )
    if study.quantile is not None and study.robust != "quantile":
        yield Problem(
            "quantile",
            "quantile is given, but only robust = 'quantile' uses it",
            'Remove quantile, or set robust = "quantile"',
        )


def _explained_by_drive(problem: Problem, scene: Scene) -> Problem:
    # Closed forms know the plain sine only: the message says so for one of their outputs.
    producers = scene.producers(scene.default_variant)
    closed = SCENES.get(scene.name)
    if "wave" not in producers or closed is None or not problem.about:
        return problem
    if not any(problem.about in closed.outputs(variant) for variant in closed.variants):
        return problem
    return replace(
        problem,
        message=f"{problem.about} can be computed only for a plain sine, but the study gives "
        "another drive",
        fix="Use an output of the motion, such as conveying_velocity",
    )
