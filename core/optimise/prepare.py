"""From a study of optimisation to what can be carried out: scene, variables, problem, method."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.motion.prepare import choose_system
from vibrafeed.core.motion.systems import CONTACTS, SYSTEMS
from vibrafeed.core.optimise.checks import misplaced, of_other_drive, problems_of_intervals
from vibrafeed.core.optimise.methods import METHODS, default_method, refusal
from vibrafeed.core.optimise.optimisation import Optimisation
from vibrafeed.core.optimise.problem import (
    CONTACT_OUTPUTS,
    LIMIT,
    SECOND,
    Kept,
    OptimisationProblem,
    Variable,
)
from vibrafeed.core.optimise.robust import uncertain_of
from vibrafeed.core.optimise.search import MAX_VARIABLES
from vibrafeed.core.optimise.slopes import MAX_SENSITIVE
from vibrafeed.core.plan.grid import Grid, to_si
from vibrafeed.core.plan.plan import choose_scene
from vibrafeed.core.plan.prepared import Chosen, locate_problem, plan_study
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.scenes import Scene
from vibrafeed.core.scenes.graph import behind
from vibrafeed.core.study.distributions import Distribution, nominal, tolerance
from vibrafeed.core.study.drive import only_the_plain_sine
from vibrafeed.core.study.optimise_study import ANGLES, Limited, OptimiseStudy, Pareto
from vibrafeed.core.study.values import Between, Fixed, Span, Values
from vibrafeed.core.suggestions import suggestion

FRONT = "front"


def prepare(study: OptimiseStudy) -> Optimisation:
    """Return the optimisation that a study describes, checked and planned, ready to be computed.

    Raises
    ------
    StudyError
        With every problem of scene, criterion, constraints, variables, parameters and method.
    """
    values, intervals = study.values(), study.intervals()
    asked = tuple(dict.fromkeys((*study.criterion_outputs(), *study.outputs)))
    scene, variant, _ = chosen = _chosen(study, asked)
    kept = tuple(_kept(study, scene, variant))
    second = SECOND.get(study.criterion.output, "")
    if study.criterion.kind == "maximise" and second in scene.outputs(variant):
        asked = (*asked, second)
    concerned = dict.fromkeys((*asked, *(each.output for each in kept)))
    outputs = tuple(name for name in concerned if name != "regime")
    bounds = study.bounds() or _default_bounds(scene, variant, outputs, values)
    problems = [
        *misplaced(study, values),
        *_problems_of_count(bounds),
        *_problems_of_whole_bounds(bounds),
        *problems_of_intervals(study, intervals, values, bounds),
    ]
    spans = _spans(bounds, intervals, values)
    try:
        plan, _ = plan_study(study, outputs, chosen, spans)
    except StudyError as error:
        problems += (locate_problem(of_other_drive(each, scene), study) for each in error.problems)
    problems += _unknown_method(study.method)
    if problems:
        raise StudyError(dict.fromkeys(problems))
    variables = tuple(_variable(name, between) for name, between in bounds.items())
    how = study.robust or "worst"
    unsure = None
    if intervals:
        unsure = uncertain_of(intervals, how, study.quantile, is_limited=bool(kept))
    problem = OptimisationProblem(plan, variables, study.criterion, kept, unsure)
    middles = {name: Fixed(nominal(each)) for name, each in intervals.items()}
    designs = grid = Grid.of({**values, **middles})
    method = _method(study, problem, designs)
    if isinstance(study.criterion, Pareto):
        shares = Span(0.0, 1.0, study.criterion.points)
        grid = Grid({**designs.axes, FRONT: shares}, designs.fixed)
    # What is chosen is no parameter of the result.
    return Optimisation(study, plan, grid, designs, problem, method).check_verification()


def _spans(
    bounds: Mapping[str, Between],
    intervals: Mapping[str, Distribution],
    values: Mapping[str, Values],
) -> dict[str, Span]:
    """Return the range of each variable and uncertain parameter, for the plan, in units of studies.

    Names that are also parameters are left out.
    """
    ends = {name: (one.lower, one.upper) for name, one in bounds.items()}
    ends |= {name: tolerance(name, one) for name, one in intervals.items()}
    return {name: Span(*pair, 2) for name, pair in ends.items() if name not in values}


def _unknown_method(name: str | None) -> Iterable[Problem]:
    """Yield the problem of an unknown method."""
    if name is not None and name not in METHODS:
        yield Problem("method", f"'{name[:60]}' is not a method", suggestion(name, METHODS))


def _chosen(study: OptimiseStudy, asked: Iterable[str]) -> Chosen:
    """Return the scene and the variant for an optimisation, as the user named them or by default.

    `asked` are the outputs of criterion and study, which with the parameters decide whether closed
    forms or the motion in time are needed. Raises `StudyError` if there are none such, or if a
    drive other than the plain sine is given with outputs that do not come from a motion.
    """
    named = (*asked, *(each.output for each in study.constraints))
    given = (*study.values(), *study.bounds(), *study.intervals())
    try:
        chosen = choose_problem_scene(study.scene, study.variant, named, given)
    except StudyError as error:
        raise StudyError(locate_problem(each, study) for each in error.problems) from None
    scene = chosen[0]
    if study.drive is not None and (scene.choice != "method" or scene.name not in CONTACTS):
        fix = f"Ask for conveying_velocity of {', '.join(CONTACTS)}, or give these"
        raise StudyError([only_the_plain_sine(fix)])
    return chosen


def _problems_of_whole_bounds(bounds: Mapping[str, Between]) -> Iterable[Problem]:
    """Yield a problem for each variable that counts something and has no choice within its bounds.

    Variables such as a number of parts are whole numbers; `bounds` has the bounds of all variables.
    """
    for name, between in bounds.items():
        if QUANTITIES[name].count and math.ceil(between.lower) >= math.floor(between.upper):
            message = "it is a whole number, and there is no choice between these bounds"
            fix = "Widen them, or give one value among the parameters"
            yield Problem(f"variables.{name}", message, fix)


def _problems_of_count(bounds: Mapping[str, Between]) -> Iterable[Problem]:
    """Yield a problem if an optimisation has too many variables, or none; `bounds` are theirs."""
    if not bounds:
        message = "there are no variables"
        fix = 'Name some, for example [variables] beta = { lower = 0, upper = "90 deg" }'
        yield Problem("variables", message, fix)
    if len(bounds) > MAX_VARIABLES:
        message = f"there are {len(bounds)} of them"
        yield Problem("variables", message, f"Choose at most {MAX_VARIABLES}")


def _method(study: OptimiseStudy, problem: OptimisationProblem, designs: Grid) -> str:
    """Return the name of the method by which a study is optimised, asked for or by default.

    `designs` is the grid of the fixed parameters; the default depends on their number. Raises
    `StudyError` if the method cannot solve the problem, or if sensitivities are asked for too many
    designs.
    """
    if study.sensitivities and designs.cells > MAX_SENSITIVE:
        message = f"each of {designs.cells:,} designs would be derived singly"
        fix = f"Range over at most {MAX_SENSITIVE:,} designs, or leave sensitivities out"
        raise StudyError([Problem("sensitivities", message, fix)])
    method = study.method or default_method(problem, designs.cells)
    why_not = refusal(method, problem)
    if why_not is not None:
        raise StudyError([Problem("method", *why_not)])
    return method


def _variable(name: str, between: Between) -> Variable:
    """Return a variable with its bounds in SI units; those of counts are rounded inwards.

    `between` are the bounds in the unit of studies. `name` is the parameter.
    """
    ends = (between.lower, between.upper)
    if QUANTITIES[name].count:
        ends = (math.ceil(between.lower), math.floor(between.upper))
    return Variable(name, *(float(to_si(name, np.asarray(end))) for end in ends))


def choose_problem_scene(
    name: str, variant: str | None, outputs: Iterable[str], parameters: Iterable[str] = ()
) -> Chosen:
    """Return the scene for an optimum: a closed form with its variant, or a motion with its method.

    Motion is taken if an output needs it, or if a parameter belongs to a drive other than the plain
    sine, which closed forms do not know. The third result are problems of the variant, which is
    then replaced by the default.

    Parameters
    ----------
    name, variant : str, str or None
        Scene and variant of the study.
    outputs, parameters : iterable of str
        All outputs that are asked for; all parameters, variables included.

    Raises
    ------
    StudyError
        If there is no such scene, or the names are those of two kinds of drive.
    """
    scene, chosen, problems = choose_scene(name, variant)
    closed = {output for one in scene.variants for output in scene.outputs(one)}
    if name in SYSTEMS:
        system, method, _ = choose_system(name, None, parameters)
        # A wave, a drive unit and a floor that gives have equations of their own.
        plain = system.variants[method] == SYSTEMS[name].variants[method]
        if not plain or any(o not in closed and o in system.outputs(method) for o in outputs):
            fix = (
                "Remove it, or ask for outputs of the closed forms alone" if plain else "Remove it"
            )
            refusals = (
                [
                    Problem(
                        "variant", "variant is given, but a simulated motion has no variants", fix
                    )
                ]
                if variant
                else []
            )
            return system, method, refusals
    return scene, chosen, problems


def _kept(study: OptimiseStudy, scene: Scene, variant: str) -> Iterable[Kept]:
    """Yield every bound that outputs of an optimisation have to keep, in the units of studies.

    They are the limit of the criterion, contacts with floor and wall, as far as this variant has
    them and the study keeps them, and the constraints of the study.
    """
    if isinstance(study.criterion, Limited):
        yield Kept(LIMIT, study.criterion.against, study.criterion.limit, True, True)
    switches = {"floor_contact": study.floor_contact, "wall_contact": study.wall_contact}
    for name, output in CONTACT_OUTPUTS.items():
        if switches[name] and output in scene.outputs(variant):
            yield Kept(name, output, 0.0, upper=False)
    for one in study.constraints:
        for name, bound in one.ends():
            yield Kept(name, one.output, bound, name.endswith("upper"), one.absolute)


def _default_bounds(
    scene: Scene, variant: str, outputs: Iterable[str], values: Mapping[str, Values]
) -> dict[str, Between]:
    """Return default bounds of the drive's angles, for a study that names no variables.

    They are of those angles on which the `outputs` depend, which the study does not give among its
    `values`, and for which 0 to 90 degrees are allowed in this scene and variant.
    """
    needed = behind(outputs, scene.producers(variant).get).keys()
    refused = {
        constraint.parameters[0]
        for constraint in scene.constraints
        if constraint.variant in ("", variant)
        and len(constraint.parameters) == 1
        and not constraint.holds(0.0, np.pi / 2)
    }
    return {n: b for n, b in ANGLES.items() if n in needed - refused and n not in values}


__all__ = ["FRONT", "choose_problem_scene", "prepare"]
