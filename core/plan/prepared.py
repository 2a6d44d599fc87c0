"""From a study to its plan and grid, checked together, and to the price of evaluating them.

For the price 64 cells are computed and timed, once, with a margin of two. Nobody knows beforehand
whether a motion repeats, so the samples are followed for more and more periods while a budget of
time lasts. What has not repeated by then counts as if it never did.
"""

import math
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import LimitError, Problem, StoppedError, StudyError, raise_any, refused
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.differences import Added
from vibrafeed.core.plan.grid import Grid, from_si, positions_of, spread
from vibrafeed.core.plan.plan import Plan, plan_scene, run_equations
from vibrafeed.core.quantities import FLAGS, MOTION_STATUSES, QUANTITIES
from vibrafeed.core.scenes import CONSTRAINTS, Scene
from vibrafeed.core.scenes.scene import MESH, MeshPart
from vibrafeed.core.study.grid_study import PARAMETERS, Study
from vibrafeed.core.study.part_study import PartOfFile
from vibrafeed.core.study.sweep_and_simulate import FEWEST_PERIODS
from vibrafeed.core.study.values import Values
from vibrafeed.core.suggestions import SEARCHED, intended
from vibrafeed.core.watch import Watch

Box = Mapping[str, tuple[int, int]]
"""A part of a grid: start and stop on the axes of which it is not the whole."""

EXTENDED_SLOWER = 20.0  # times a double, with the arrays between the steps
MAX_SECONDS_TO_VERIFY = 100.0  # a study that takes longer to verify is refused


@dataclass(frozen=True)
class Prepared:
    """A study that can be carried out: its plan and its grid."""

    study: Study
    plan: Plan
    grid: Grid
    questions: tuple[str, ...] = field(default=(), kw_only=True)
    """Questions about values that are allowed and unusual, wherever they come from."""
    known_price: "Price | None" = field(default=None, kw_only=True, compare=False)
    """The price of its cells where it is known, such as from another process."""

    can_stop: ClassVar[bool] = True
    """Whether computing it can be stopped between two cells."""
    keeps_some: ClassVar[bool] = True
    """Whether a result that was stopped holds the cells that were computed by then."""

    @property
    def not_lazy(self) -> Problem | None:
        """The problem with computing cells when they are read; None if that is possible."""
        return Problem(
            "kind",
            "a study of this kind cannot be computed cell by cell",
            "Use a sweep",
        )

    def check_lazy(self, fix: str) -> Self:
        """Return the study; raise `StudyError` with `fix` if cells cannot be computed when read."""
        if self.not_lazy is not None:
            raise StudyError([replace(self.not_lazy, fix=fix)])
        return self

    @property
    def unused(self) -> Iterable[str]:
        """Questions about parameters of the scene that the outputs do not use."""
        scene = self.plan.scene.name
        for name in self.study.values():
            if name not in self.plan.parameters:
                yield f"{name} changes nothing: no requested output of {scene} depends on it"

    def facts(self) -> dict[str, Any]:
        """Return further facts for the plan's JSON document."""
        return {}

    @property
    def sentences(self) -> tuple[str, ...]:
        """Return further facts for the plan as sentences."""
        return ()

    @property
    def derived(self) -> Added | None:
        """The derivatives in the result; None without any."""
        return None

    @property
    def bands(self) -> Added | None:
        """The bands of speeds in the result; None without any."""
        return None

    @property
    def added(self) -> tuple[Added, ...]:
        """Variables of the result beside the outputs: derivatives, ends of bands."""
        return tuple(added for added in (self.derived, self.bands) if added is not None)

    @cached_property
    def dims(self) -> dict[str, tuple[str, ...]]:
        """The names of the axes of each variable of the result, by name, verdicts last."""
        depends = self.plan.depends_on(self.grid.along)
        dims = {name: self.grid.dims(depends[name]) for name in self.plan.outputs}
        for added in self.added:
            dims |= added.dims(self.grid, depends)
        return dims | {name: self.grid.dims(depends[name]) for name in self.plan.verdict_names}

    @cached_property
    def units(self) -> dict[str, str]:
        """The unit of each output."""
        added_units = {name: unit for added in self.added for name, unit in added.units.items()}
        added_units |= dict.fromkeys(self.plan.verdict_names, QUANTITIES["regime"].unit)
        return {name: added_units.get(name) or QUANTITIES[name].unit for name in self.dims}

    @property
    def cells(self) -> int:
        """The number of points of the grid."""
        return self.grid.cells

    @property
    def bytes(self) -> int:
        """The bytes of the stored outputs, uncompressed."""
        sizes = self.sizes
        return sum(
            self.width(name) * math.prod(sizes[dim] for dim in dims)
            for name, dims in self.dims.items()
        )

    def width(self, name: str) -> int:
        """Return the bytes of one stored value of an output."""
        is_added_flag = any("flag_values" in added.labels.get(name, ()) for added in self.added)
        return 1 if is_added_flag or self._is_flag(name) else 8

    def in_files(self, name: str, values: NDArray[Any]) -> NDArray[Any]:
        """Return computed values of an output in the units of files."""
        return values if self._is_flag(name) else from_si(name, values)

    def _is_flag(self, name: str) -> bool:
        return name in FLAGS or name in self.plan.verdict_names

    @property
    def sizes(self) -> Mapping[str, int]:
        """The length of each dimension of the outputs."""
        return self.grid.shape

    @property
    def stored(self) -> int:
        """The number of points of the result."""
        return self.cells

    @property
    def cut_axes(self) -> tuple[str, ...]:
        """The axes along which the study can be computed in pieces."""
        return tuple(self.grid.axes)

    def within(self, box: Box) -> Self:
        """Return the study restricted to a part of its grid."""
        return replace(self, grid=self.grid.within(box))

    @cached_property
    def price(self) -> "Price":
        """The price of the cells on one core, without verification; motions are sampled for it."""
        return self.known_price or self._new_price()

    def _new_price(self) -> "Price":
        once = price(self.plan, self.grid, self.stated_seconds_a_cell)
        passes = sum(added.passes for added in self.added) or 1
        return once._replace(cell=passes * once.cell)

    @property
    def stated_seconds_a_cell(self) -> float:
        """The rough time of a cell on one core [s], which no clock decides."""
        return self.plan.scene.seconds_a_cell

    @property
    def seconds_a_cell(self) -> float:
        """The price of a cell on one core [s]."""
        return self.price.cell

    @property
    def seconds(self) -> float:
        """The price of the study on one core, including verification [s]."""
        return self.price.of(self.cells) + self.seconds_to_verify

    @property
    def seconds_here(self) -> float:
        """The price of the study on this machine [s]."""
        return self.seconds

    @property
    def size_in_words(self) -> str:
        """A text with cells, bytes and time on one core, to show before a study is run."""
        seconds = self.seconds
        cells = f"{self.cells:,} cell{'s' * (self.cells != 1)}"
        return (
            f"{cells}, {self.bytes:,} bytes before compression, "
            f"some {in_words(seconds)} on one core, {seconds / 3600:.1g} core hours"
        )

    @property
    def verified_by(self) -> str:
        """The method that verifies random cells; empty if none can."""
        return "the same equations in extended precision"

    @property
    def seconds_a_verified_cell(self) -> float:
        """The likely time to verify a point [s]: two differences a parameter."""
        evaluations = 1 + 2 * len(self.plan.parameters)
        return EXTENDED_SLOWER * evaluations * self.plan.scene.seconds_a_cell

    @property
    def seconds_to_verify(self) -> float:
        """The likely time of verification [s]; 0 if not asked for."""
        cells = min(self.study.verify or 0, self.cells)
        return cells * self.seconds_a_verified_cell if cells else 0.0

    @property
    def computing_share(self) -> float:
        """The share of computing in the total time with verification, for the progress."""
        if not self.seconds_to_verify:
            return 1.0
        seconds = self.price.of(self.cells)
        return seconds / (seconds + self.seconds_to_verify)

    def unverified(self) -> Self:
        """Return the study without verification."""
        return replace(self, study=self.study.model_copy(update={"verify": None}))

    def check_verification(self) -> Self:
        """Return the study; raise `StudyError` if verifying it, as asked, takes above 100 s."""
        if self.study.verify is None:
            return self
        if not self.verified_by:
            raise refused("verify", "no other method can simulate this motion", "Remove verify")
        if self.seconds_to_verify > MAX_SECONDS_TO_VERIFY:
            each = self.seconds_a_verified_cell
            raise refused(
                "verify",
                f"verifying so many cells takes too long: about {each:.2g} s per cell",
                f"Set verify to at most {int(MAX_SECONDS_TO_VERIFY / each):,}",
            )
        return self

    def check_limits(self, *, cells: int | None, bytes_: int | None) -> None:
        """Raise `LimitError` if the study has more cells or bytes than allowed; None allows any."""
        for limit, asked, allowed in (("cells", self.stored, cells), ("bytes", self.bytes, bytes_)):
            if allowed is not None and asked > allowed:
                raise LimitError(limit, asked, allowed, self.what_fits(allowed / asked))

    def what_fits(self, fraction: float) -> str:
        """Return a sentence on a grid that fits the limits, with that share of the cells."""
        longest = max(self.grid.shape, key=lambda name: self.grid.shape[name])
        fitting = int(self.grid.shape[longest] * fraction)
        points, axes = self.grid.shape[longest], len(self.grid.shape)
        if fitting >= 2:
            return f"It fits with {fitting:,} instead of {points:,} values of {longest}"
        per_axis = int((self.cells * fraction) ** (1 / axes))
        if per_axis >= 2:
            return f"It fits with {per_axis:,} values on each of the {axes} axes"
        return f"It fits with fewer than {axes} ranged parameters"


Chosen = tuple[Scene, str, list[Problem]]
"""The scene of a study, the variant in force, and what is wrong with the one that it names."""


def plan_study(
    study: Study,
    outputs: Iterable[str],
    chosen: Chosen,
    further: Mapping[str, Values] | None = None,
) -> tuple[Plan, Grid]:
    """Return the plan (equations in order) and the grid of a study of any kind.

    `chosen` are scene, variant and the problems of their names; `further` are parameters that the
    study gives elsewhere than under `parameters`, and that are no part of the grid. Raises
    `StudyError` with all problems at once.
    """
    values = {**study.values(), **(further or {})}
    grid = Grid.of(values)
    scene, variant, problems = chosen
    part: PartOfFile | None = getattr(study, "part", None)
    problems += _problems_of_part(scene, variant, part)
    scene = scene.fitted(values, MeshPart(part.volume, part.aspects) if part else None)
    problems += broken_constraints(scene, variant, grid)
    try:
        plan = plan_scene(scene, variant, tuple(outputs), values, study.values())
    except StudyError as error:
        raise StudyError([*error.problems, *problems]) from None
    raise_any(problems)
    used = {name: value for name, value in study.values().items() if name in plan.parameters}
    return plan, Grid.of(used)


def _problems_of_part(scene: Scene, variant: str, part: PartOfFile | None) -> Iterable[Problem]:
    if part is None and variant == MESH:
        yield Problem(
            "part",
            f"variant {MESH} needs a part from a file",
            'Add [part] with, for example, file = "bracket.stl" and unit = "mm"',
        )
    if part is not None and variant != MESH:
        fix = f'Set variant = "{MESH}", or remove [part]'
        yield Problem(
            "part",
            f"{scene.name} ({variant}) cannot use a part from a file",
            fix if MESH in scene.variants else "Remove [part]",
        )


def names_intended(parameters: Iterable[object]) -> list[str]:
    """Return the parameters that a user intended, misspelt ones corrected, others left out."""
    names_given = [*map(str, parameters)]
    unknown = [name for name in names_given if name not in PARAMETERS]
    corrected = {name: intended(name, PARAMETERS) for name in unknown[:SEARCHED]}
    names = (name if name in PARAMETERS else corrected.get(name) for name in names_given)
    return [name for name in names if name]


def locate_problem(problem: Problem, study: Study) -> Problem:
    """Return a problem of a plan with the path at which its cause stands in the study."""
    section, _, name = problem.place.partition(".")
    if section == "parameters":
        return replace(problem, place=study.places().get(name, problem.place))
    if section == "outputs" and problem.about:
        return replace(problem, place=study.output_places().get(problem.about, problem.place))
    return problem


def broken_constraints(scene: Scene, variant: str, grid: Grid) -> Iterable[Problem]:
    """Yield problems of parameters whose ends on the grid break a relation of the scene."""
    parameters = {*grid.along, *grid.fixed}
    for constraint in (*scene.constraints, *CONSTRAINTS):
        applies = constraint.variant in ("", variant)
        if applies and set(constraint.parameters) <= parameters:
            ends = [end for name in constraint.parameters for end in grid.bounds(name)]
            if not constraint.holds(*ends):
                place = f"parameters.{constraint.parameters[0]}"
                yield Problem(place, constraint.message, constraint.fix)


SAMPLED = 64
"""Most cells that are computed for a price."""
MARGIN = 2.0
"""Factor on the measured time."""
BUDGET, PATIENCE = 0.3, 20.0
"""Longest time of the processor that a round of the sample takes [s], and the longest by the clock
over it, since others may use the core."""
MORE = 4.0
"""Factor from the number of periods of one round to that of the next."""
SURPRISE = 3.0 * MORE
"""Ratio of the times of a cell in two rounds from which on the second is repeated."""
LIMIT = "max_periods"

ENDED = [MOTION_STATUSES[name].value for name in ("periodic", "at_rest", "neutral")]
"""Statuses of motions that more periods do not prolong."""
NOT_COMPUTED = MOTION_STATUSES["not_computed"].value


class Price(NamedTuple):
    """The price of a study in seconds of one core: to begin, and for each cell."""

    start: float
    cell: float

    def of(self, cells: float) -> float:
        """Return the price of a number of cells [s]; more cells never cost less."""
        return self.start + self.cell * cells


class _Round(NamedTuple):
    seconds: float
    done: int
    open: bool

    @property
    def each(self) -> float:
        return self.seconds / max(self.done, 1)


def price(
    plan: Plan,
    grid: Grid,
    untimed: float | None = None,
    ranges: Mapping[str, tuple[float, float]] | None = None,
) -> Price:
    """Return the price of evaluating a plan on a grid, from some cells that are evenly spread.

    `untimed` is that of a cell where nothing is timed [s], the scene's if left out: of closed
    forms, and of motions whose code is not compiled yet. `ranges` are the ends of parameters that
    are not on the grid, SI units.
    """
    seconds = plan.scene.seconds_a_cell if untimed is None else untimed
    if not any(equation.takes_long for equation in plan.equations) or not _is_compiled():
        return Price(0.0, MARGIN * seconds)
    parameters, count, fraction = _spread_cells(plan, grid, ranges or {})
    start, seconds = _time_of_call_and_cell(plan, parameters, count)
    return Price(MARGIN * start, MARGIN * seconds * fraction)


def _is_compiled() -> bool:
    from vibrafeed.core.kernel_cache import are_kept, packages

    return bool(are_kept(name for name in packages() if name.startswith("motion-")))


def _spread_cells(
    plan: Plan, grid: Grid, ranges: Mapping[str, tuple[float, float]]
) -> tuple[dict[str, Array], int, float]:
    # Parameters of sampled cells, their number, and the fraction of the cells with a motion of
    # their own.
    depends = plan.depends_on(grid.along)
    axes_of_motion = frozenset().union(
        *(depends[equation.gives] for equation in plan.equations if equation.takes_long)
    )
    sizes = {name: grid.shape[name] for name in grid.dims(axes_of_motion)}
    cells = math.prod(sizes.values())
    count = SAMPLED if ranges else min(SAMPLED, cells)
    points = spread(count, len(sizes) + len(ranges)).T
    # All cells, in an order in which any first half is spread too, or evenly spread ones.
    if cells <= count and not ranges:
        order = np.concatenate([np.arange(0, count, 2), np.arange(1, count, 2)])
        positions = positions_of(sizes, order)
    else:
        indices = np.floor(points[:, : len(sizes)] * [*sizes.values()]).astype(np.int64)
        positions = dict(zip(sizes, indices.T, strict=True))
    positions |= dict.fromkeys(set(grid.axes) - set(sizes), np.zeros(count, dtype=np.int64))
    parameters = grid.at(positions, count, plan.parameters)
    for column, (name, (low, high)) in enumerate(ranges.items(), start=len(sizes)):
        parameters[name] = low + (high - low) * points[:, column]
    return parameters, count, cells / grid.cells


def _time_of_call_and_cell(
    plan: Plan, parameters: Mapping[str, Any], count: int
) -> tuple[float, float]:
    # Seconds of a call beside those of its cells (0 if not told apart), and seconds of a cell.
    max_periods = float(np.max({**plan.defaults, **parameters}.get(LIMIT, 0.0)))
    periods = seconds_before = periods_before = 0.0
    while True:
        periods = min(max_periods, max(float(FEWEST_PERIODS), MORE * periods))
        timed_round = _timed_round(plan, parameters, count, periods)
        if timed_round.each > SURPRISE * seconds_before:  # it may have loaded code: repeat
            timed_round = _timed_round(plan, parameters, count, periods)
        is_unfinished = timed_round.open and periods < max_periods
        if not is_unfinished or timed_round.done < count or MORE * timed_round.seconds > BUDGET:
            break
        seconds_before, periods_before = timed_round.each, periods
    if is_unfinished:  # extrapolate linearly, as if the motion never repeated
        growth = (timed_round.each - seconds_before) / (periods - periods_before)
        return 0.0, timed_round.each + max(growth, 0.0) * (max_periods - periods)
    if timed_round.done < count or count == 1:
        return 0.0, timed_round.each
    # A round of half the cells tells the time of a call from that of each cell.
    half_count = count // 2
    seconds_each = (
        timed_round.seconds - _timed_round(plan, parameters, half_count, periods).seconds
    ) / (count - half_count)
    seconds_each = min(max(seconds_each, 0.1 * timed_round.each), timed_round.each)
    return count * (timed_round.each - seconds_each), seconds_each


def _timed_round(plan: Plan, parameters: Mapping[str, Any], count: int, periods: float) -> _Round:
    # Follow the first `count` cells for some periods, with a bound on the time.
    cells = {name: value[:count] if np.ndim(value) else value for name, value in parameters.items()}
    if LIMIT in plan.defaults or LIMIT in parameters:
        cells[LIMIT] = np.asarray(periods)
    processor_start, thread_start = time.process_time(), time.thread_time()
    watch = Watch(
        threads=1,
        stop=lambda: time.process_time() - processor_start > BUDGET,
        deadline=time.monotonic() + PATIENCE * BUDGET,
    )
    try:
        outcome = run_equations(plan, cells, watch)
    except StoppedError:
        return _Round(time.thread_time() - thread_start, 0, open=True)
    seconds = time.thread_time() - thread_start
    motions = (outcome[equation.gives] for equation in plan.equations if equation.takes_long)
    statuses = [
        np.broadcast_to(motion.status, count) for motion in motions if hasattr(motion, "status")
    ]
    left_out = np.any([status == NOT_COMPUTED for status in statuses], axis=0)
    done = count - int(np.sum(left_out))
    is_open = not done or not all(np.isin(status[~left_out], ENDED).all() for status in statuses)
    return _Round(seconds, done, is_open)


def in_words(seconds: float) -> str:
    """Return a time [s] in words with two digits, as users see it: ``3.2 minutes``."""
    for unit, length in (("days", 86_400), ("hours", 3600), ("minutes", 60)):
        if seconds >= 2 * length:
            return f"{float(f'{seconds / length:.2g}'):,g} {unit}"
    return f"{float(f'{seconds:.2g}'):g} s"
