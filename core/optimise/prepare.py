"""From a study of optimisation to what can be carried out: scene, variables, problem, method."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from core.errors import Problem as Wrong
from core.errors import StudyError, suggestion
from core.motion.method import Method
from core.motion.prepare import find_system, other_method, stays_planar
from core.motion.systems import SYSTEMS
from core.optimise.methods import METHODS, default_method, refusal
from core.optimise.problem import CONTACTS, LIMIT, Kept, Problem, Variable
from core.optimise.slopes import MOST_SENSITIVE, sensitive
from core.plan.grid import Grid, to_si
from core.plan.plan import choose_scene, scene_parameters
from core.plan.prepared import Box, Chosen, Prepared, further_problems, plan_study
from core.quantities import QUANTITIES
from core.scenes import Scene
from core.scenes.graph import behind
from core.study.models import (
    Limited,
    OptimiseStudy,
    OutputLimit,
    Pareto,
)
from core.study.values import Between, Fixed, Span, Values

ANGLES = {"alpha": Between(0.0, 90.0), "beta": Between(0.0, 90.0)}
"""The variables of a study that names none."""

QUICK = ("exact", "newton")  # without a search
QUICK_SECONDS, OTHER_SECONDS, MOTION_SECONDS = 2e-5, 0.05, 0.3
"""Roughly what a design takes."""
RIVAL_SECONDS = 0.02  # roughly, of a design by the method that verifies

MOST_VARIABLES = 4
FRONT = "front"
NAMES_OF_STATES = ("regime", "motion_status")
FLAGS = ("optimum_status", "regime", "knee")


@dataclass(frozen=True)
class Optimisation(Prepared):
    """An optimisation that can be carried out; the grid's last axis is the front, if any.

    Attributes
    ----------
    designs : Grid
        The grid without the front.
    problem : Problem
        What is solved at each of its points.
    method : str
        A key of `METHODS`.
    """

    study: OptimiseStudy
    designs: Grid
    problem: Problem
    method: str

    @cached_property
    def units(self) -> dict[str, str]:
        """The unit of each variable of the result, in order."""
        problem = self.problem
        criterion = problem.criterion
        units = {f"best_{name}": QUANTITIES[name].unit for name in problem.names}
        units["objective"] = QUANTITIES[criterion.output].unit
        told = (criterion.output, problem.against, *(kept.output for kept in problem.kept))
        asked = [name for name in self.study.outputs if name != "regime"]
        units |= {name: QUANTITIES[name].unit for name in (*filter(None, told), *asked)}
        for kept in problem.kept:
            units[f"margin_{kept.name}"] = QUANTITIES[kept.output].unit
            units[f"binds_{kept.name}"] = "1"
        for name in problem.names:
            units |= {f"binds_{name}_lower": "1", f"binds_{name}_upper": "1"}
        units |= dict.fromkeys(("optimality_residual", "optimum_gap", "evaluations"), "1")
        if isinstance(criterion, Pareto):
            units["knee"] = "1"
        if self.study.sensitivities:
            units |= dict.fromkeys((f"sensitivity_{name}" for name in sensitive(problem)), "1")
        return {**units, "optimum_status": "1", "regime": "1"}

    @cached_property
    def dims(self) -> dict[str, tuple[str, ...]]:
        """The axes of each variable: all of them."""
        return dict.fromkeys(self.units, tuple(self.grid.axes))

    @property
    def seconds_a_cell(self) -> float:
        """As in `Prepared`."""
        if self.problem.is_motion:
            return MOTION_SECONDS
        return QUICK_SECONDS if self.method in QUICK else OTHER_SECONDS

    @property
    def other_motion(self) -> Method | None:
        """The method that follows the motions again, if the outputs are those of a motion."""
        return other_method(self.plan, self.designs, self.problem.names)

    @property
    def verified_by(self) -> str:
        """As in `Prepared`."""
        if not self.problem.is_motion:
            return super().verified_by
        return f"the method {self.other_motion.name}" if self.other_motion else ""

    @property
    def seconds_a_verified_cell(self) -> float:
        """As in `Prepared`."""
        if not self.problem.is_motion:
            return super().seconds_a_verified_cell + RIVAL_SECONDS
        return self.other_motion.seconds_a_cell if self.other_motion else 0.0

    @property
    def cut_axes(self) -> tuple[str, ...]:
        """The axes along which the study may be carried out in pieces: a front is one whole."""
        return tuple(self.designs.axes)

    def within(self, box: Box) -> Optimisation:
        """Return the same study for a part of its designs."""
        return replace(self, grid=self.grid.within(box), designs=self.designs.within(box))

    @property
    def bytes(self) -> int:
        """Bytes that the result takes, uncompressed."""
        short = sum(name in FLAGS or name.startswith("binds_") for name in self.units)
        return self.cells * (8 * (len(self.units) - short) + short)


def prepare(study: OptimiseStudy) -> Optimisation:
    """Return the optimisation of a study.

    Raises
    ------
    StudyError
        With every problem of scene, criterion, constraints, variables, parameters and method.
    """
    values = study.values()
    problems: list[Wrong] = []
    asked = tuple(dict.fromkeys((*_criterion_outputs(study), *study.outputs)))
    scene, variant, wrong_variant = choose_problem_scene(
        study.scene, study.variant, asked, stays_planar(values, study.bounds())
    )
    kept = tuple(_kept(study, scene, variant))
    outputs = tuple(dict.fromkeys((*asked, *(one.output for one in kept))))
    outputs = tuple(name for name in outputs if name != "regime")
    problems += _misplaced(study, values, scene)
    bounds = study.bounds() or _default_bounds(scene, variant, outputs, values)
    if not bounds:
        message = "nothing is left to choose"
        fix = 'Name some, for example [variables] beta = { lower = 0, upper = "90 deg" }'
        problems.append(Wrong("variables", message, fix))
    if len(bounds) > MOST_VARIABLES:
        message = f"there are {len(bounds)} of them"
        problems.append(Wrong("variables", message, f"Choose at most {MOST_VARIABLES}"))
    intervals = study.intervals()
    problems += _wrong_intervals(study, intervals, values, bounds)
    spans = {
        name: Span(one.lower, one.upper, 2)
        for name, one in {**bounds, **intervals}.items()
        if name not in values
    }
    try:
        plan, _ = plan_study(study, outputs, (scene, variant, wrong_variant), spans)
    except StudyError as error:
        problems += [_placed(one, study, bounds, asked) for one in error.problems]
    if study.method is not None and study.method not in METHODS:
        message = f"'{study.method[:60]}' is not a method"
        problems.append(Wrong("method", message, suggestion(study.method, METHODS)))
    if problems:
        raise StudyError(dict.fromkeys(problems))
    variables = tuple(_variable(name, between) for name, between in bounds.items())
    unsure = [_variable(name, between) for name, between in intervals.items()]
    problem = Problem(
        plan,
        variables,
        study.criterion,
        kept,
        unsure[0] if unsure else None,
        study.robust or "worst",
    )
    middles = {n: Fixed((one.lower + one.upper) / 2) for n, one in intervals.items()}
    designs = Grid.of({**values, **middles})
    if study.sensitivities and designs.cells > MOST_SENSITIVE:
        message = f"each of {designs.cells:,} designs would be derived singly"
        fix = f"Range over at most {MOST_SENSITIVE:,} designs, or leave sensitivities out"
        raise StudyError([Wrong("sensitivities", message, fix)])
    method = study.method or default_method(problem, designs.cells)
    why_not = refusal(method, problem)
    if why_not is not None:
        raise StudyError([Wrong("method", *why_not)])
    if isinstance(study.criterion, Pareto):
        shares = Span(0.0, 1.0, study.criterion.points)
        grid = Grid({**designs.axes, FRONT: shares}, designs.fixed)
    else:
        grid = designs
    # What is chosen is no parameter of the result.
    return Optimisation(study, plan, grid, designs, problem, method).check_verification()


def _variable(name: str, between: Between) -> Variable:
    ends = (between.lower, between.upper)
    return Variable(name, *(float(to_si(name, np.asarray(end))) for end in ends))


def _wrong_intervals(
    study: OptimiseStudy,
    intervals: Mapping[str, Between],
    values: Mapping[str, Values],
    bounds: Mapping[str, Between],
) -> Iterable[Wrong]:
    """Yield what is wrong with the uncertain parameter."""
    for name in intervals:
        if name in values or name in bounds:
            section = "parameters" if name in values else "variables"
            fix = f"Remove it there, or under {section}.{name}"
            yield Wrong(f"uncertain.{name}", f"it is also under {section}", fix)
    if len(intervals) > 1:
        fix = "Keep the one that matters most"
        yield Wrong("uncertain", f"there are {len(intervals)} of them, and one is taken", fix)
    if study.robust is not None and not intervals:
        fix = "Add [uncertain], for example friction = { lower = 0.2, upper = 0.4 }"
        yield Wrong("robust", "nothing is uncertain", fix)
    if intervals and isinstance(study.criterion, Pareto):
        fix = "Use the criterion limit, at some limits"
        yield Wrong("uncertain", "a whole front is not traced over an interval", fix)


def choose_problem_scene(
    name: str, variant: str | None, outputs: Iterable[str], planar: bool = True
) -> Chosen:
    """Return the closed-form scene with its variant; or, if an output asks for it, the system.

    The third is what is wrong with the variant, which then gives way to the default.

    Raises
    ------
    StudyError
        If there is no such scene.
    """
    scene, chosen, problems = choose_scene(name, variant)
    closed = {output for one in scene.variants for output in scene.outputs(one)}
    if name in SYSTEMS:
        system, method = find_system(name, None, planar)
        if any(o not in closed and o in system.outputs(method) for o in outputs):
            fix = "Remove it, or ask for outputs of the closed forms alone"
            told = [Wrong("variant", "motion in time has no variants", fix)] if variant else []
            return system, method, told
    return scene, chosen, problems


def _criterion_outputs(study: OptimiseStudy) -> tuple[str, ...]:
    against = getattr(study.criterion, "against", None)
    return (study.criterion.output, *((against,) if against else ()))


def _kept(study: OptimiseStudy, scene: Scene, variant: str) -> Iterable[Kept]:
    """Yield every constraint: contacts, the limit of the criterion, those of the study."""
    if isinstance(study.criterion, Limited):
        yield Kept(LIMIT, study.criterion.against, study.criterion.limit, True, True)
    switches = {"floor_contact": study.floor_contact, "wall_contact": study.wall_contact}
    for name, output in CONTACTS.items():
        if switches[name] and output in scene.outputs(variant):
            yield Kept(name, output, 0.0, upper=False)
    for one in study.constraints:
        for name, bound in _ends(one):
            yield Kept(name, one.output, bound, name.endswith("upper"), one.absolute)


def _ends(one: OutputLimit) -> Iterable[tuple[str, float]]:
    name = f"{one.output}_absolute" if one.absolute else one.output
    if one.lower is not None:
        yield f"{name}_lower", one.lower
    if one.upper is not None:
        yield f"{name}_upper", one.upper


def _misplaced(study: OptimiseStudy, values: Mapping[str, Values], scene: Scene) -> Iterable[Wrong]:
    """Yield what is wrong between the parts of a study."""
    criterion = study.criterion
    if isinstance(criterion, Limited) and criterion.limit < 0:
        fix = "Give the largest absolute value, 0 or more"
        yield Wrong("criterion.limit", f"it is {criterion.limit:g}", fix)
    places = {f"constraints.{i}.output": one.output for i, one in enumerate(study.constraints)}
    places |= {"criterion.output": criterion.output}
    places |= {"criterion.against": getattr(criterion, "against", "")}
    for place, name in places.items():
        if name in NAMES_OF_STATES:
            yield Wrong(place, f"{name} is a name and not a number", "Take another output")
    if len(set(_criterion_outputs(study))) < len(_criterion_outputs(study)):
        yield Wrong("criterion.against", "it is the output itself", "Name another output")
    for name in study.bounds():
        if name in values:
            fix = f"Remove it there, or under parameters.{name}"
            yield Wrong(f"variables.{name}", "it is also given as a parameter", fix)
    seen: set[str] = set()
    for number, one in enumerate(study.constraints):
        place = f"constraints.{number}"
        if one.lower is None and one.upper is None:
            yield Wrong(place, "it bounds nothing", "Give lower, upper or both")
        elif one.lower is not None and one.upper is not None and one.lower > one.upper:
            yield Wrong(place, "lower is above upper", "Swap them")
        if one.absolute and one.upper is not None and one.upper < 0:
            yield Wrong(f"{place}.upper", "no absolute value is below 0", "Give 0 or more")
        for name, _ in _ends(one):
            if name in seen:
                yield Wrong(place, f"{one.output} has such a bound already", "Remove one of them")
            seen.add(name)


def _default_bounds(
    scene: Scene, variant: str, outputs: Iterable[str], values: Mapping[str, Values]
) -> dict[str, Between]:
    """Return the angles that the outputs depend on, as far as a study leaves them open."""
    needed = behind(outputs, scene.producers(variant).get).keys()
    refused = {
        constraint.parameters[0]
        for constraint in scene.constraints
        if constraint.variant in ("", variant)
        and len(constraint.parameters) == 1
        and not constraint.holds(0.0, np.pi / 2)
    }
    return {n: b for n, b in ANGLES.items() if n in needed - refused and n not in values}


def _placed(
    problem: Wrong, study: OptimiseStudy, bounds: Mapping[str, Between], asked: tuple[str, ...]
) -> Wrong:
    """Return a problem of the plan at the place where the study says what it is about."""
    section, _, name = problem.place.partition(".")
    if section == "parameters" and name in bounds:
        return replace(problem, place=f"variables.{name}")
    if section == "outputs":
        for number, one in enumerate(study.constraints):
            if f"'{one.output}'" in problem.message:
                return replace(problem, place=f"constraints.{number}.output")
        for key in ("output", "against"):
            if f"'{getattr(study.criterion, key, None)}'" in problem.message:
                return replace(problem, place=f"criterion.{key}")
    return problem


def further(content: Mapping[str, Any], known: StudyError) -> list[Wrong]:
    """Return what a plan of unsound content would object to, as far as it can be told."""
    if not isinstance(content.get("parameters"), Mapping):
        return []
    criterion, variables = content.get("criterion"), content.get("variables")
    criterion = criterion if isinstance(criterion, Mapping) else {}
    parameters = {**content["parameters"]}
    outputs = tuple(
        name
        for name in (criterion.get("output", "acceleration_x"), criterion.get("against"))
        if isinstance(name, str)
    )

    def chosen(content: Mapping[str, Any]) -> Chosen:
        variant = content.get("variant")
        return choose_problem_scene(
            content["scene"], variant if isinstance(variant, str) else None, outputs
        )

    if isinstance(variables, Mapping):
        parameters |= variables
    elif isinstance(content.get("scene"), str):
        try:
            known_parameters = scene_parameters(*chosen(content)[:2])
        except StudyError as error:
            return [p for p in error.problems if p.place not in {q.place for q in known.problems}]
        parameters |= {name: 0 for name in ANGLES if name in known_parameters}
    whole = {**content, "parameters": parameters, "outputs": outputs}
    return further_problems(whole, known, chosen)


__all__ = ["FRONT", "Optimisation", "choose_problem_scene", "further", "prepare"]
