"""From a study of motion to what can be carried out: system, method, plan, grid."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.bowl_track import AlongTrack
from vibrafeed.core.motion.drive_units import on_unit, unit_of
from vibrafeed.core.motion.driven import driven
from vibrafeed.core.motion.drives import shape_of, what_is_open
from vibrafeed.core.motion.groups import Contacts
from vibrafeed.core.motion.in_common import families_of
from vibrafeed.core.motion.method import Method
from vibrafeed.core.motion.part_load import price_of_load
from vibrafeed.core.motion.price import (
    Priced,
    prices_of,
    sampled_parameters,
    seconds_of,
    some_cells,
)
from vibrafeed.core.motion.rolling_scene import ROLLING
from vibrafeed.core.motion.row_scene import ROW, choose_row, of_unit
from vibrafeed.core.motion.soft_floor import LINING, on_soft_floor
from vibrafeed.core.motion.systems import CONTACTS, SYSTEMS, methods_of
from vibrafeed.core.motion.trial import TRIED_CELLS, Trial
from vibrafeed.core.plan.derived import Asked, asked_of
from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.plan.plan import Plan, choose_scene
from vibrafeed.core.plan.prepared import (
    Chosen,
    Prepared,
    broken_constraints,
    plan_study,
)
from vibrafeed.core.plan.price import pace
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.reduce.checks import problems_of, problems_of_names
from vibrafeed.core.scenes import Scene
from vibrafeed.core.study.simulate_study import MAX_PERIODS, SimulateStudy
from vibrafeed.core.study.values import Fixed

SCALES = ("velocity_scale", "length_scale")
ERROR = "conveying_velocity_error"


class Simulation(Prepared):
    """A study of motion that can be carried out; `plan.variant` names the method."""

    study: SimulateStudy

    @property
    def method(self) -> Method:
        """The method by which the motion is simulated."""
        return methods_of(self.plan.scene.name)[self.plan.variant]

    @cached_property
    def derived(self) -> Asked | None:
        """The derivatives that the result contains; None without any."""
        return asked_of(self.plan, self.study.values(), self.study.sensitivities, self.cells)

    @cached_property
    def _price(self) -> tuple[float, float]:
        """The likely and the largest time of a cell [s]."""
        passes = 1 if self.derived is None else self.derived.passes
        likely, most = (passes * one for one in price_of(self.method, self.plan, self.grid))
        # A course may be followed for all the periods that are allowed.
        return (likely if self.study.trajectory is None else most), most

    @property
    def seconds_a_cell(self) -> float:
        """The likely time of a cell on one core [s]."""
        return self._price[0]

    @property
    def most_seconds_a_cell(self) -> float:
        """The largest time of a cell on one core [s]."""
        return self._price[1]

    @cached_property
    def tried_seconds_a_cell(self) -> float:
        """The likely time of a cell on one core, measured on a trial of a few cells [s].

        For a trajectory the estimate by formula is taken. Cells that differ only along axes on
        which no motion depends share one simulation, so that its time is divided among them.
        """
        if self.study.trajectory is not None:
            return self.seconds_a_cell
        # An axis that no motion depends on makes no more of them.
        depends = self.plan.depends_on(self.grid.axes)
        long = [depends[one.gives] for one in self.plan.equations if one.takes_long]
        cells = self.grid.size(self.grid.dims(frozenset().union(*long)))
        each = tried_price(self.method, self.plan, self.grid, cells=cells)
        return each * cells / self.cells * (1 if self.derived is None else self.derived.passes)

    @property
    def verified_by(self) -> str:
        """The name of the method that verifies random cells; empty if none can."""
        other = other_method(self.plan, self.grid)
        return f"the method {other.name}" if other else ""

    @property
    def seconds_a_verified_cell(self) -> float:
        """The time to verify a cell [s]."""
        other = other_method(self.plan, self.grid)
        return price_of(other, self.plan, self.grid)[0] if other else 0.0


def other_method(plan: Plan, grid: Grid, free: Collection[str] = ()) -> Method | None:
    """Return the method by which motions of a grid can be verified; None if there is none.

    The first of those by which the method of the `plan` is checked that the scene has and whose
    limits the `grid` of parameters respects. `free` are names of parameters that are not on the
    grid and take any value.
    """
    scene, methods = plan.scene, methods_of(plan.scene.name)
    for name in methods[plan.variant].checked_by:
        concerned = [one for one in scene.constraints if one.variant == name]
        held = not any(set(one.parameters) & set(free) for one in concerned)
        if name in scene.variants and held and not [*broken_constraints(scene, name, grid)]:
            return methods[name]
    return None


def price_of(
    method: Method, plan: Plan, grid: Grid, free: Mapping[str, tuple[float, float]] | None = None
) -> tuple[float, float]:
    """Return the likely and the largest time of a grid's cell by a method [s].

    By formulas, from some cells of the grid.

    Parameters
    ----------
    method
        The simulation method; one other than that of the plan has its own default settings.
    plan, grid
        The plan of the study, and its grid of parameters.
    free
        Parameters that are not on the grid, and the ends of their values, SI units.
    """
    settings = method.defaults if method.name != plan.variant else {}
    contacts = CONTACTS.get(plan.scene.name, Contacts())

    def cells() -> Priced:
        return some_cells(plan, sampled_parameters(plan, grid, free or {})[0], settings, contacts)

    likely, most = seconds_of(method.seconds_a_cell, cells)
    whole = partial(_with_all_motions, plan, method)
    return float(whole(likely)) * pace(), float(whole(most)) * pace()


def tried_price(
    method: Method,
    plan: Plan,
    grid: Grid,
    free: Mapping[str, tuple[float, float]] | None = None,
    *,
    cells: float,
) -> float:
    """Return the likely time of a cell on one core [s], found by following some cells first.

    Where no compiled code is kept, it is the price by formula of `price_of`: nobody waits for a
    compiler to learn a price.

    Parameters
    ----------
    method, plan
        The method of the plan, and the plan of the study.
    grid, free
        Values of the grid, and ranges of free parameters, as in `price_of`.
    cells
        Number of cells of the study, which limits the time of the trial.
    """
    from vibrafeed.core.kernel_cache import are_kept, packages

    if not are_kept(name for name in packages() if name.startswith("motion-")):
        return price_of(method, plan, grid, free)[0]
    chosen, count = sampled_parameters(plan, grid, free or {}, TRIED_CELLS)
    contacts = CONTACTS.get(plan.scene.name, Contacts())
    priced = some_cells(plan, chosen, {}, contacts)
    families = None
    if not free and "groups" in priced.known and np.any(priced.restless):
        families = families_of(plan, grid, contacts, TRIED_CELLS)
    if families is not None:
        chosen, count = dict(families.singles), families.count
        priced = some_cells(plan, chosen, {}, contacts)

    def price(periods: float | None) -> Array:
        asked = priced
        if periods is not None and "max_periods" in priced.known:
            asked = Priced({**priced.known, "max_periods": np.asarray(periods)}, contacts)
        likely = prices_of(method.seconds_a_cell, lambda: asked).likely
        told = _with_all_motions(plan, method, np.broadcast_to(likely, (count,)))
        return np.asarray(told * pace())

    kinds = np.broadcast_to(priced.across if "groups" in priced.known else False, (count,))
    trial = Trial(plan, chosen, kinds, price, method.fewest_periods, families)
    return trial.seconds_a_cell(cells)


def _with_all_motions(plan: Plan, method: Method, seconds: Array | float) -> Array:
    """Return the time of all motions that a cell of a plan follows [s].

    `seconds` is the time of one motion by the `method` [s]. A cell may need motions at many places
    of a bowl's track, and some 200 for the load of parts on a drive unit.
    """
    seconds = np.asarray(seconds)
    rounds = (
        sum(equation.takes_long for equation in plan.equations)
        if method.name == plan.variant
        else 1
    )
    along = [
        equation.function.nodes
        for equation in plan.equations
        if isinstance(equation.function, AlongTrack)
    ]
    loaded = any(equation.gives == "part_load" for equation in plan.equations)
    load = price_of_load(seconds) if loaded else 0.0
    return np.asarray((rounds + sum(along)) * seconds + load)


def choose_system(name: str, method: str | None, parameters: Iterable[str]) -> Chosen:
    """Return the scene for a study of motion, the name of its method, and problems with that name.

    `name` is the scene's name, `method` that of the method (None for the default). The names of the
    study's `parameters` decide what the equations are: the drive may be a sine, another wave, or a
    drive unit; the floor rigid or springy.

    Raises
    ------
    StudyError
        If there is no such scene, or the parameters are those of two kinds of drive.
    """
    scene, method, problems = choose_scene(name, method, SYSTEMS)
    names = tuple(parameters)
    if name == ROW:
        scene, more_problems = choose_row(scene, names)
        if more_problems:
            raise StudyError([*problems, *more_problems])
    if name not in CONTACTS and name != ROW:
        return scene, method, problems
    if name in CONTACTS:
        scene = on_soft_floor(name, names)
    unit, more_problems = unit_of(names)
    if name == ROW:
        shape, more = None, of_unit(unit, names)  # its drive is in place
    else:
        shape, more = shape_of(names) if unit is None else (None, [])
    if more_problems or more:  # of which drive the others are missing, or too many, nobody knows
        raise StudyError([*problems, *more_problems, *more])
    if unit is not None:
        return on_unit(scene, unit, CONTACTS.get(name, Contacts())), method, problems
    return (driven(scene, shape) if shape else scene), method, problems


def _problems_of_settings(study: SimulateStudy, scene: Scene, method: str) -> Iterable[Problem]:
    """Yield problems of the settings that a study gives to its method.

    Settings that the `method` of the `scene` does not use, and a contact stiffness beside the
    stiffness of a lining, from which it follows.
    """
    settings = study.settings()
    needed = {name for equation in scene.variants[method] for name in equation.inputs}
    for name in settings:
        if name not in needed:
            message = f"the method {method} does not use it"
            yield Problem(name, message, fix_for_unused_setting(scene, name))
    if "contact_stiffness" in settings and LINING in study.values():
        message = f"it follows from {LINING}, mass and frequency"
        yield Problem("contact_stiffness", message, f"Remove it, or {LINING}")


def prepare(study: SimulateStudy) -> Simulation:
    """Return the prepared simulation of a study: its scene and method, plan of equations, and grid.

    Raises
    ------
    StudyError
        With every problem of scene, method, outputs, settings and parameters, found before anything
        is computed.
    """
    chosen = choose_system(study.scene, study.method, study.values())
    scene, method, _ = chosen
    if study.drive is not None and scene.name not in CONTACTS:
        fix = f"Choose among {', '.join(CONTACTS)}"
        raise StudyError(
            [Problem("drive", f"{scene.name} takes only a sine drive, not a section drive", fix)]
        )
    settings = study.settings()
    more = never_left_out(scene, method) if study.reduce is None else ()
    asked = tuple(dict.fromkeys((*study.outputs, *more)))
    if study.trajectory is not None:  # its way back to metres and seconds has to be planned
        asked += tuple(n for n in SCALES if n not in asked and n in scene.outputs(method))
    problems = [
        *_problems_of_settings(study, scene, method),
        *_problems_of_trajectory(study, scene, method),
    ]
    problems += _problems_of_reduction(study)
    try:
        plan, grid = plan_study(study, asked, chosen)
    except StudyError as error:
        raise StudyError([*error.problems, *problems]) from None
    shape, _ = shape_of(study.values())
    if shape is not None and not set(shape.inputs) & set(grid.axes):
        problems += what_is_open(shape, grid.si())
    problems += _too_many_steps(study, methods_of(scene.name)[method], grid)
    problems += problems_of(study.reduce, plan, grid) if study.reduce is not None else []
    if problems:
        raise StudyError(problems)
    plan = replace(plan, defaults={**plan.defaults, **settings})
    return _derivable(Simulation(study, plan, grid)).check_verification()


def _derivable(prepared: Simulation) -> Simulation:
    """Return a simulation unchanged; raise `StudyError` if its derivatives cannot be computed.

    That is if the motion has no cycle. `prepared` is the planned simulation.
    """
    if prepared.derived is None:
        return prepared
    if "period_multiple" not in prepared.plan.scene.outputs(prepared.plan.variant):
        message = f"the motion of {prepared.plan.scene.name} is followed for a time, not a cycle"
        cyclic = (*CONTACTS, *ROLLING, ROW)
        fix = f"Leave it out, or choose among {', '.join(cyclic)}"
        raise StudyError([Problem("sensitivities", message, fix)])
    return prepared


def never_left_out(scene: Scene, method: str) -> tuple[str, ...]:
    """Return the outputs that are always computed: the status, and the mean acceleration if any.

    For a scene and the name of its method; they are added to those that a study asks for.
    """
    more = ("mean_acceleration",) if "mean_acceleration" in scene.outputs(method) else ()
    return ("motion_status", *more)


def fix_for_unused_setting(scene: Scene, setting: str) -> str:
    """Return the fix for a setting that the method in force ignores: the methods that use it."""
    users = [name for name in scene.variants if setting in scene.variant_defaults.get(name, {})]
    return f"Remove it, or set method to {' or '.join(users)}" if users else "Remove it"


def _problems_of_trajectory(study: SimulateStudy, scene: Scene, method: str) -> list[Problem]:
    """Return the problems of the key `trajectory` of a study; empty if there are none.

    It needs one value of every parameter, and a `method` of the `scene` that follows a part in
    time, not one that gives means only.
    """
    if study.trajectory is None:
        return []
    axes = [name for name, values in study.values().items() if not isinstance(values, Fixed)]
    problems = []
    if axes:
        ranged = ", ".join(QUANTITIES[name].label.lower() for name in axes)
        fix = f"Give one value of {', '.join(axes)}, or leave trajectory out"
        problems.append(
            Problem(
                "trajectory", f"trajectory shows one point, but {ranged} has a range of values", fix
            )
        )
    methods = methods_of(scene.name)
    followed = [name for name in scene.variants if methods[name].course is not None]
    if method not in followed:
        fix = f"Set method to {' or '.join(followed)}" if followed else "Leave trajectory out"
        message = f"the method {method} of {scene.name} gives means only"
        problems.append(Problem("trajectory", message, fix))
    return problems


def _problems_of_reduction(study: SimulateStudy) -> list[Problem]:
    """Return the problems of the key `reduce` of a study of motion; empty if there are none.

    A reduction gives statistics over axes in place of all cells: derivatives and a trajectory are
    refused beside it, and its names of outputs and axes must exist.
    """
    if study.reduce is None:
        return []
    problems = problems_of_names(study.reduce, study.outputs, study.values())
    for key, message in (
        ("sensitivities", "derivatives are given with all cells; the study has reduce too"),
        ("trajectory", "it shows one point; the study has reduce too"),
    ):
        if getattr(study, key):
            problems.append(Problem(key, message, f"Remove either {key} or reduce"))
    return problems


def _too_many_steps(study: SimulateStudy, method: Method, grid: Grid) -> Iterable[Problem]:
    """Yield a problem of a study whose cells or trajectory take more steps than allowed.

    Also one if a trajectory goes on for more periods than any method follows. `study` is checked
    with the settings and limits of its `method`; `grid` has the frequency of the trajectory's one
    cell.
    """
    settings = {**method.defaults, **study.settings()}
    periods, steps = settings.get("max_periods", 0.0), settings.get("steps_per_period", 0.0)
    if method.most_steps is not None and 4 * steps * periods > method.most_steps:
        message = f"4 x {steps:,.0f} steps x {periods:,.0f} periods are more than one cell may take"
        fix = f"Keep steps_per_period x max_periods within {method.most_steps // 4:,}"
        yield Problem("steps_per_period", message, fix)
    if not isinstance(study.trajectory, tuple):
        return
    shown = study.trajectory[-1] * grid.fixed.get("frequency", 0.0)
    most = float(MAX_PERIODS)
    if method.most_steps is not None:
        most = min(most, method.most_steps / (2 * steps + 1) - periods - 1)
    if shown > most >= 0:
        latest = most / grid.fixed["frequency"]
        message = f"its latest time is {shown:,.0f} periods of the drive from the first"
        yield Problem("trajectory", message, f"End it by {latest:.3g} s, {most:,.0f} periods")
