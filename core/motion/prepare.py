"""From a study of motion to what can be carried out: system, method, plan, grid."""

from collections.abc import Collection, Iterable
from dataclasses import replace
from functools import cached_property

from vibrafeed.core.errors import Problem, StudyError, raise_any, refused
from vibrafeed.core.lazy.checks import problems_of, problems_of_names
from vibrafeed.core.motion import rolling_scene, row_scene
from vibrafeed.core.motion.drive_units import on_unit, unit_of
from vibrafeed.core.motion.drives import driven, problems_of_wave, shape_of
from vibrafeed.core.motion.method import Contacts, Method
from vibrafeed.core.motion.plate import PLATE
from vibrafeed.core.motion.record import RESULTS, SCALES, Record
from vibrafeed.core.motion.systems import (
    CONTACTS,
    FALLING,
    SYSTEMS,
    methods_of,
    with_falling_restitution,
)
from vibrafeed.core.plan.bands import Bands, bands_of, problem_of_added, problems_of_bands
from vibrafeed.core.plan.differences import Asked, asked_of
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import Plan, choose_scene
from vibrafeed.core.plan.prepared import Chosen, Prepared, broken_constraints, plan_study
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.plate import TURNS
from vibrafeed.core.scenes import Scene
from vibrafeed.core.study.sweep_and_simulate import MAX_PERIODS, MotionSettings, SimulateStudy
from vibrafeed.core.study.values import Fixed

ERROR = "conveying_velocity_error"


class Simulation(Prepared):
    """A study of motion that can be carried out; `plan.variant` names the method."""

    study: SimulateStudy

    @property
    def not_lazy(self) -> Problem | None:
        """The problem with computing cells on reading; None for motion without more."""
        if self.study.trajectory is not None:
            return Problem(
                "trajectory",
                "a study with a trajectory cannot be computed cell by cell",
                "Remove trajectory",
            )
        return problem_of_added(self.study.sensitivities, self.grid)

    @property
    def method(self) -> Method:
        """The method by which the motion is simulated."""
        return methods_of(self.plan.scene.name)[self.plan.variant]

    @cached_property
    def derived(self) -> Asked | None:
        """The derivatives that the result contains; None without any."""
        return asked_of(self.plan, self.study.values(), self.study.sensitivities, self.cells)

    @cached_property
    def bands(self) -> Bands | None:
        """The bands of speeds in the result; None without any."""
        return None if self.study.reduce else bands_of(self.plan, self.grid)

    @property
    def stated_seconds_a_cell(self) -> float:
        """The rough time of a cell on one core [s], which no clock decides."""
        return self.method.seconds_a_cell

    @property
    def verified_by(self) -> str:
        """The name of the method that verifies random cells; empty if none can."""
        other = other_method(self.plan, self.grid)
        return f"the method {other.name}" if other else ""

    @property
    def seconds_a_verified_cell(self) -> float:
        """Roughly the time to verify a cell [s]."""
        other = other_method(self.plan, self.grid)
        return other.seconds_a_cell if other else 0.0


def other_method(plan: Plan, grid: Grid, free: Collection[str] = ()) -> Method | None:
    """Return the method by which motions of a grid can be verified; None if there is none.

    The scene has it, and the `grid` respects its limits. `free` are names of parameters that are
    not on the grid and take any value.
    """
    scene, methods = plan.scene, methods_of(plan.scene.name)
    for name in methods[plan.variant].checked_by:
        constraints = [constraint for constraint in scene.constraints if constraint.variant == name]
        is_free = not any(set(constraint.parameters) & set(free) for constraint in constraints)
        if name in scene.variants and is_free and not [*broken_constraints(scene, name, grid)]:
            return methods[name]
    return None


def choose_system(name: str, method: str | None, parameters: Iterable[str]) -> Chosen:
    """Return the scene for a study of motion, the name of its method, and problems with that name.

    The names of the study's `parameters` decide what the equations are: the drive may be a sine,
    another wave, or a drive unit; restitution may fall with speed. Raises `StudyError` if there is
    no such scene, or the parameters are those of two kinds of drive.
    """
    scene, method, problems = choose_scene(name, method, SYSTEMS)
    names = tuple(parameters)
    if name == PLATE:
        shape, shape_problems = shape_of(names)
        if shape_problems:
            raise StudyError([*problems, *shape_problems])
        return (driven(scene, shape) if shape else scene), method, problems
    names = tuple(parameter for parameter in names if parameter not in TURNS)  # of a plate alone
    if name not in CONTACTS and name != row_scene.ROW:
        return scene, method, problems
    shape, shape_problems = shape_of(names)
    unit, unit_problems = unit_of(names)
    if name == row_scene.ROW:
        scene, row_problems = (
            row_scene.row_of(names),
            [*row_scene.problems_of_row(names), *shape_problems],
        )
        if row_problems:
            raise StudyError([*problems, *row_problems])
        unit_problems += (
            row_scene.problems_of_load(names) if unit is not None and unit.loaded else []
        )
    elif FALLING in names:
        scene = with_falling_restitution(scene, names)
    if unit is None:  # of which drive the others are missing, or too many, nobody knows
        unit_problems += shape_problems
    if unit_problems:
        raise StudyError([*problems, *unit_problems])
    if unit is not None:
        scene = on_unit(scene, unit, CONTACTS.get(name, Contacts()))
    return (driven(scene, shape) if shape else scene), method, problems


def problems_of_settings(study: MotionSettings, scene: Scene, method: str) -> list[Problem]:
    """Return a problem for each setting of a study that its method does not use."""
    needed = {name for equation in scene.variants[method] for name in equation.inputs}
    return [
        Problem(
            name,
            f"the method {method} does not use {name}",
            fix_for_unused_setting(scene, name),
        )
        for name in study.settings()
        if name not in needed
    ]


def prepare(study: SimulateStudy) -> Simulation:
    """Return the prepared simulation of a study: its scene and method, plan of equations, and grid.

    Raises `StudyError` with every problem of scene, method, outputs, settings and parameters.
    """
    scene, method, scene_problems = choose_system(study.scene, study.method, study.values())
    if study.drive is not None and scene.name not in CONTACTS:
        raise refused(
            "drive",
            f"{scene.name} cannot use a recorded drive, only a sine",
            f"Choose among {', '.join(CONTACTS)}",
        )
    if (record := record_of(study)) is not None:
        raise_any(_problems_of_record(study, scene, method))
        scene = record.drives(scene, method)
    settings = study.settings()
    never_left_out = ("motion_status", "mean_acceleration") if study.reduce is None else ()
    extra_outputs = [name for name in never_left_out if name in scene.outputs(method)]
    outputs = tuple(dict.fromkeys((*study.outputs, *extra_outputs)))
    if study.trajectory is not None:  # its way back to metres and seconds has to be planned
        outputs += tuple(
            scale for scale in SCALES if scale not in outputs and scale in scene.outputs(method)
        )
    problems = [
        *problems_of_settings(study, scene, method),
        *_problems_of_trajectory(study, scene, method),
        *_problems_of_reduction(study),
    ]
    try:
        plan, grid = plan_study(study, outputs, (scene, method, scene_problems))
    except StudyError as error:
        raise StudyError([*error.problems, *problems]) from None
    shape, _ = shape_of(study.values())
    if shape is not None and not set(shape.inputs) & set(grid.axes):
        problems += problems_of_wave(shape, grid.si())
    problems += _shows_too_much(study, grid)
    problems += problems_of(study.reduce, plan, grid) if study.reduce is not None else []
    raise_any(problems)
    plan = replace(plan, defaults={**plan.defaults, **settings})
    prepared = Simulation(study, plan, grid)
    _ = prepared.added  # which raises what is wrong with it
    if prepared.derived is not None and "period_multiple" not in scene.outputs(method):
        message = f"the motion of {scene.name} has no period, so it has no derivatives"
        cyclic = (*CONTACTS, *rolling_scene.SCENES, row_scene.ROW)
        raise refused(
            "sensitivities", message, f"Remove sensitivities, or choose among {', '.join(cyclic)}"
        )
    return prepared.check_verification()


def record_of(study: SimulateStudy) -> Record | None:
    """Return the drive of a study whose recording is followed as it is; None of any other."""
    drive = study.drive
    return Record.of(drive.samples, drive.derivative or 2) if drive and drive.samples else None


def _problems_of_record(study: SimulateStudy, scene: Scene, method: str) -> Iterable[Problem]:
    # A recording that is followed once gives bursts only, and only of scenes that have them.
    if "burst" not in scene.producers(method):
        message = f"{scene.name} cannot use a recording without a fit (once = true)"
        followed = [
            name
            for name, other_scene in SYSTEMS.items()
            if "burst" in other_scene.producers("events")
        ]
        yield Problem("drive.once", message, f"Choose among {', '.join(followed)}")
    elif unavailable := [name for name in study.outputs if name not in RESULTS]:
        message = f"{unavailable[0]} cannot be computed from a recording with once = true"
        yield Problem("outputs", message, f"Request {' or '.join(RESULTS)}")


def fix_for_unused_setting(scene: Scene, setting: str) -> str:
    """Return the fix for a setting that the method in force ignores: the methods that use it."""
    users = [name for name in scene.variants if setting in scene.variant_defaults.get(name, {})]
    return f"Remove it, or set method to {' or '.join(users)}" if users else "Remove it"


def _problems_of_trajectory(study: SimulateStudy, scene: Scene, method: str) -> Iterable[Problem]:
    # A trajectory is of one cell, by a method that gives more than means.
    if study.trajectory is None:
        return
    axes = [name for name, values in study.values().items() if not isinstance(values, Fixed)]
    if axes:
        ranged = ", ".join(QUANTITIES[name].label.lower() for name in axes)
        yield Problem(
            "trajectory",
            f"a trajectory is computed for a single design, but {ranged} has several values",
            f"Give one value of {', '.join(axes)}, or remove trajectory",
        )
    methods = methods_of(scene.name)
    followed = [name for name in scene.variants if methods[name].course is not None]
    if method not in followed:
        yield Problem(
            "trajectory",
            f"the method {method} of {scene.name} computes only means, no trajectory",
            f"Set method to {' or '.join(followed)}" if followed else "Remove trajectory",
        )


def _problems_of_reduction(study: SimulateStudy) -> Iterable[Problem]:
    # What cannot be given beside statistics in place of the cells.
    if study.reduce is None:
        return
    yield from problems_of_names(study.reduce, study.outputs, study.values())
    yield from problems_of_bands(study.values())
    for key, message in (
        ("sensitivities", "derivatives cannot be combined with reduce"),
        ("trajectory", "a trajectory cannot be combined with reduce"),
    ):
        if getattr(study, key):
            yield Problem(key, message, f"Remove either {key} or reduce")


def _shows_too_much(study: SimulateStudy, grid: Grid) -> Iterable[Problem]:
    # A trajectory whose last time lies more than `MAX_PERIODS` periods from the first.
    last = study.trajectory[-1] if isinstance(study.trajectory, tuple) else 0.0
    shown = last * grid.fixed.get("frequency", 0.0)
    if shown > MAX_PERIODS:
        latest = MAX_PERIODS / grid.fixed["frequency"]
        yield Problem(
            "trajectory",
            f"the trajectory ends after {shown:,.0f} periods of the drive",
            f"End it by {latest:.3g} s, which is {MAX_PERIODS:,} periods",
        )
