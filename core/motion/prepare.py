"""From a study of motion to what can be carried out: system, method, plan, grid."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

from core.errors import Problem, StudyError
from core.motion.course import COURSES
from core.motion.systems import SYSTEMS
from core.plan.grid import Grid
from core.plan.plan import choose_scene
from core.plan.prepared import Chosen, Prepared, broken_constraints, further_problems, plan_study
from core.quantities import QUANTITIES
from core.scenes import Scene
from core.study.models import SimulateStudy
from core.study.values import Fixed

DEFAULT_OUTPUTS = ("conveying_velocity",)
TUMBLING = ("rectangle-isolated", "cylinder-isolated")
PLANAR_METHOD = "events"
SCALES = ("velocity_scale", "length_scale")
ERROR = "conveying_velocity_error"
OTHERS = {
    "events": ("reference", "time-stepping"),
    "time-stepping": ("events", "reference"),
    "reference": ("events", "time-stepping"),
    "regularised": ("events", "reference"),
    "regularised-BDF": ("events", "reference"),
    "regularised-LSODA": ("events", "reference"),
}
"""By what a method is verified: the most exact of the others that can follow the motion."""

SECONDS_A_CELL = {
    "events": 5e-6, "time-stepping": 1.5e-3, "reference": 0.5,
    "regularised": 2.0, "regularised-BDF": 2.0, "regularised-LSODA": 0.5,
}  # fmt: skip
SECONDS_A_BOUNCE = 3e-4  # of a point of `events` with restitution, and of a tumbling part


class Simulation(Prepared):
    """A study of motion that can be carried out; `plan.variant` is the method."""

    study: SimulateStudy

    @property
    def seconds_a_cell(self) -> float:
        """As in `Prepared`."""
        bounces = self.grid.axes.keys() & {"restitution"} or self.grid.fixed.get("restitution")
        if self.plan.variant == "events" and (bounces or self.plan.scene.name in TUMBLING):
            return SECONDS_A_BOUNCE
        return SECONDS_A_CELL[self.plan.variant]

    @property
    def verified_by(self) -> str:
        """As in `Prepared`."""
        other = other_method(self.plan.scene, self.plan.variant, self.grid)
        return f"the method {other}" if other else ""

    @property
    def seconds_a_verified_cell(self) -> float:
        """As in `Prepared`."""
        other = other_method(self.plan.scene, self.plan.variant, self.grid)
        return SECONDS_A_CELL[other] if other else 0.0


def other_method(scene: Scene, method: str, grid: Grid, free: Collection[str] = ()) -> str | None:
    """Return the method that verifies the motions of a grid by another one; None if there is none.

    `free` are parameters that are not on the grid and take any value.
    """
    for other in OTHERS[method]:
        concerned = [one for one in scene.constraints if one.variant == other]
        held = not any(set(one.parameters) & set(free) for one in concerned)
        if other in scene.variants and held and not [*broken_constraints(scene, other, grid)]:
            return other
    return None


def prepare(study: SimulateStudy) -> Simulation:
    """Return the simulation of a study.

    Raises
    ------
    StudyError
        With every problem of scene, method, outputs, settings and parameters.
    """
    across = study.values().get("alpha")
    planar = across is None or across.canonical() == 0

    chosen = _choose(study.scene, study.method, planar)
    scene, method, _ = chosen
    settings = study.settings()
    # `motion_status` tells how each value was found: it is never left out.
    asked = tuple(dict.fromkeys((*study.outputs, "motion_status")))
    if study.trajectory is not None:  # its way back to metres and seconds has to be planned
        asked += tuple(n for n in SCALES if n not in asked and n in scene.outputs(method))
    needed = {name for equation in scene.variants[method] for name in equation.inputs}
    problems = [
        Problem(name, f"the method {method} does not use it", "Remove it")
        for name in settings
        if name not in needed
    ]
    problems += _wrong_course(study, scene, method)
    try:
        plan, grid = plan_study(study, asked, chosen)
    except StudyError as error:
        raise StudyError([*error.problems, *problems]) from None
    if problems:
        raise StudyError(problems)
    plan = replace(plan, defaults={**plan.defaults, **settings})
    return Simulation(study, plan, grid).check_verification()


def further(content: Mapping[str, Any], known: StudyError) -> list[Problem]:
    """Return what a plan of unsound content would object to, as far as it can be told."""
    return further_problems(content, known, _chosen, DEFAULT_OUTPUTS)


def find_system(name: str, method: str | None, planar: bool = True) -> tuple[Scene, str]:
    """Return a system and the method in force.

    Where none is named that is `events` if the motion stays in one vertical plane and the system
    has that method, else the system's own choice.

    Raises
    ------
    StudyError
        If there is no such system or method.
    """
    scene, method, problems = _choose(name, method, planar)
    if problems:
        raise StudyError(problems)
    return scene, method


def _choose(name: str, method: str | None, planar: bool) -> Chosen:
    scene, chosen, problems = choose_scene(name, method, SYSTEMS)
    if chosen != method and planar and PLANAR_METHOD in scene.variants:
        chosen = PLANAR_METHOD
    return scene, chosen, problems


def _chosen(content: Mapping[str, Any]) -> Chosen:
    method, parameters = content.get("method"), content["parameters"]
    return _choose(
        content["scene"],
        method if isinstance(method, str) else None,
        parameters.get("alpha", 0) == 0,
    )


def _wrong_course(study: SimulateStudy, scene: Scene, method: str) -> list[Problem]:
    """Return why a study cannot show the course of a part in time, if it asks for that."""
    if study.trajectory is None:
        return []
    axes = [name for name, values in study.values().items() if not isinstance(values, Fixed)]
    problems = []
    if axes:
        ranged = ", ".join(QUANTITIES[name].label.lower() for name in axes)
        fix = f"Give one value of {', '.join(axes)}, or leave trajectory out"
        problems.append(Problem("trajectory", f"it shows one point, and {ranged} is ranged", fix))
    followed = list(COURSES[scene.name])
    if method not in followed:
        fix = f"Set method to {' or '.join(followed)}"
        message = f"the method {method} of {scene.name} gives means only"
        problems.append(Problem("trajectory", message, fix))
    return problems
