"""The track of a bowl from its start to the exit: radius, climb and lining by stretch.

The names of a study's parameters say which stretches there are, as they do for the parts of a row.
Equations then give radius, climb and friction at a share of the track's length, and what passes the
whole track from the motion at nodes along it.
"""

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.mechanics.drive_unit import (
    Stretches,
    bounds,
    picked,
    radius_at,
    stretches_of,
    total_length,
)
from vibrafeed.core.motion.feeding import parts_per_minute
from vibrafeed.core.motion.method import where
from vibrafeed.core.motion.scales import product
from vibrafeed.core.plan.plan import run
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.drives import OF_STRETCHES
from vibrafeed.core.scenes.scene import Equation, between, fields
from vibrafeed.core.study.sweep_and_simulate import SETTINGS

SOURCE = "theory 15.6"
PARTS = 16
"""Equal intervals of a stretch, at whose ends the motion is followed at first."""
CLOSE, ACROSS = 1 / 60, 1 / 1000
"""Largest interval of a stretch, as a share of it, where hops remember the one before, and where
the number of periods changes: the motion jumps there, or takes too long to settle, in bands that
wider intervals miss."""
MEMORY = float(np.hypot(1.0, np.pi))
"""Throw number above which hops remember the one before (theory 13.7)."""
ENOUGH = 1e-3
"""Relative error of transit time and least velocity at which no interval is halved any more."""
HALVINGS, MOST = 10, 600
"""How often an interval is halved at most, and intervals of a stretch above which none is."""
INSIDE = 1e-9
"""Of a stretch: how far its first and last node lie from its ends."""
SMALL = 1e-4
"""Relative change of a velocity below which its quotient is taken from a series."""
PIECE = 100_000
"""Largest number of motions that are followed together, for memory."""
FOLLOWED = ("conveying_velocity", "conveying_velocity_error", "throw_number", "period_multiple")
"""What is taken of the motion at a place of the track."""
GIVES_WAY = {"stretch_climb": ("gamma",), "stretch_friction": ("friction", "friction_static",
             "friction_kinetic"), "stretch_radius": ("radius",)}  # fmt: skip
"""Parameters that a study may not give beside a quantity of the stretches, which takes their
place."""

OF_TRACK = ("stretch_radius", "stretch_turns", "stretch_climb")

_NUMBERED = re.compile(rf"({'|'.join(OF_STRETCHES)})_(\d+)")


@dataclass(frozen=True)
class Track:
    """The stretches of a track that the names of parameters give.

    `own` has, by the stem of a parameter (`stretch_climb`, ...), the numbers of the stretches that
    have their own value of it.
    """

    count: int
    own: Mapping[str, tuple[int, ...]]

    def names(self, stem: str) -> tuple[str, ...]:
        """Return the parameter that gives a quantity on each stretch: its own, or an earlier one's.

        `stem` is the parameter's name without number. Climbs that are not given are `gamma`.
        """
        own = self.own[stem]
        if not own:
            return ("gamma",) * self.count
        return tuple(f"{stem}_{max(k for k in own if k <= n)}" for n in range(1, self.count + 1))

    @property
    def inputs(self) -> tuple[str, ...]:
        """The names of the quantities that its stretches are computed from."""
        return ("start_radius", *(name for stem in OF_TRACK for name in self.names(stem)))

    def stretches(self, **inputs: Any) -> Stretches:
        """Return the stretches of the track from the values of its `inputs`, by name."""
        columns = ([inputs[name] for name in self.names(stem)] for stem in OF_TRACK)
        return stretches_of(inputs["start_radius"], *columns)


def track_of(names: Iterable[str], *, of_bowl: bool) -> tuple[Track | None, list[Problem]]:
    """Return the track that a study's parameter names define (None if none), and their problems.

    `of_bowl` is True if the study has a bowl drive unit, without which stretches are a problem;
    None is returned if there are problems.
    """
    parameters = tuple(names)
    matches = [match for match in map(_NUMBERED.fullmatch, parameters) if match]
    if not matches:
        return None, []
    own = {
        stem: tuple(sorted(int(match[2]) for match in matches if match[1] == stem))
        for stem in OF_STRETCHES
    }
    count = max(n for numbers in own.values() for n in numbers)
    problems = [*_problems(own, count, parameters)]
    if not of_bowl:
        no_bowl = Problem(
            f"parameters.{matches[0][0]}",
            "stretches of the track are used only with the drive unit of a bowl",
            "Add its parameters: spring_radius, moving_inertia and base_inertia",
        )
        problems.insert(0, no_bowl)
    return (None if problems else Track(count, own)), problems


def _problems(
    own: Mapping[str, Sequence[int]], count: int, names: Collection[str]
) -> Iterator[Problem]:
    # Missing numbers of stretches, then parameters that the stretches replace.
    for stem in ("stretch_turns", "stretch_radius"):
        for n in range(1, count + 1):
            if n not in own[stem]:
                yield Problem(
                    f"parameters.{stem}_{n}",
                    f"{stem}_{n} is missing; each stretch needs a value",
                    "Add it",
                )
    for stem in ("stretch_climb", "stretch_friction"):
        if own[stem] and 1 not in own[stem]:
            yield Problem(
                f"parameters.{stem}_1",
                f"{stem}_1 is missing; a later stretch takes it over, but the first needs a value",
                "Add it",
            )
    for stem, others in GIVES_WAY.items():
        for name in others:
            if own[stem] and name in names:
                yield Problem(
                    f"parameters.{name}",
                    f"{name} follows from the stretches of the track ({stem}_{own[stem][0]})",
                    f"Remove {name}, or all parameters {stem}_...",
                )


def in_pieces(of_cells: Callable[..., Any], quantities: Mapping[str, Any], step: int) -> Any:
    """Return a record of arrays over cells, computed for at most `step` cells together.

    `of_cells` takes quantities by name, shape (cells,), and returns a named tuple of such arrays.
    """
    columns = np.broadcast_arrays(
        *(np.asarray(value, dtype=float) for value in quantities.values())
    )
    shape = columns[0].shape
    flat = {name: column.ravel() for name, column in zip(quantities, columns, strict=True)}
    pieces = [
        of_cells({name: values[start : start + step] for name, values in flat.items()})
        for start in range(0, columns[0].size, step)
    ]
    joined = (np.concatenate(part).reshape(shape) for part in zip(*pieces, strict=True))
    return pieces[0]._make(joined)


# --- equations


def track_radius(*, track_fraction: Array, stretches: Stretches) -> Array:
    """Return the radius at a share of the track's length, r^2 linear within a stretch [m]."""
    return radius_at(track_fraction, stretches)


def load_radius(*, load_fraction: Array, stretches: Stretches) -> Array:
    """Return the radius at which the load on the whole track is taken to act [m]."""
    return radius_at(load_fraction, stretches)


def track_feed_rate(*, passage: "Passage", length: Array, occupancy: Array) -> Array:
    """Return the number of parts per minute at the bottleneck, 60 v occupancy/length [min-1]."""
    return parts_per_minute(velocity=passage.slowest, length=length / occupancy)


class Passage(NamedTuple):
    """The passage of parts along a whole track; arrays of one shape, NaN without a mean velocity.

    Time of a part from start to exit [s], infinite where it stops on the way, and the bound of its
    error that the speeds between the nodes leave; the least mean velocity [m s-1], and how far
    below it a place between the nodes may lie; share of the length, and radius [m], where that is.
    """

    time: Array
    time_error: Array
    slowest: Array
    slowest_error: Array
    fraction: Array
    radius: Array


def slowness(first: Array, last: Array) -> Array:
    """Return the mean of 1/v between two points of a track, from which the time of a part follows.

    ln(v_2/v_1)/(v_2 - v_1) [s m-1] for a velocity v that is linear between both, with v_1 = `first`
    and v_2 = `last` [m s-1]. Infinite if one of both is not above 0, NaN if one has no value.
    """
    is_moving = (first > 0.0) & (last > 0.0)
    first_speed = np.where(is_moving, first, 1.0)
    relative_change = np.where(is_moving, last - first, 0.0) / first_speed
    is_small = np.abs(relative_change) < SMALL
    factor = np.where(
        is_small,
        1.0 - relative_change / 2.0 + relative_change * relative_change / 3.0,
        np.log1p(relative_change) / np.where(is_small, 1.0, relative_change),
    )
    otherwise = np.where(np.isnan(first + last), np.nan, np.inf)
    return np.where(is_moving, factor / first_speed, otherwise)


class Speeds(NamedTuple):
    """Mean velocities along stretches of tracks; arrays of one shape (n,).

    The nodes of a cell follow each other, from the start of the track to its exit: `stretch` counts
    from 0, `fraction` is that of its `length` [m]. Mean `velocity`, NaN where there is none, and
    its own `error` [m s-1]; throw number, and periods after which the motion repeats.
    """

    cell: NDArray[np.intp]
    stretch: NDArray[np.intp]
    fraction: Array
    length: Array
    velocity: Array
    error: Array
    throw: Array
    multiple: Array


class Intervals(NamedTuple):
    """Times and least velocities between neighbouring nodes of `Speeds`; arrays of one shape (n,).

    An interval belongs to the node at its start; those that lead to another stretch or cell have no
    length, and take no time. `width` is a share of the stretch, `time` that of a part [s]; `delay`
    is what a bend of the velocity between the nodes may add, `least` the least velocity that it
    leaves possible [m s-1]; those `with_errors` also count the velocities' own.
    """

    width: Array
    time: Array
    delay: Array
    delay_with_errors: Array
    least: Array
    least_with_errors: Array


def intervals_of(speeds: Speeds) -> Intervals:
    """Return times and least velocities between the nodes of `speeds`, linear from one to the next.

    A bend lies at most d D beside the straight line in an interval of length d, where D is the
    difference of its slope to that of its neighbours, the smaller one: once to twice as far as a
    kink, eight times as far as a parabola. Nor is the velocity below those of both neighbours'
    lines, which counts where it jumps. Of D is taken off what the velocities' own errors explain.
    """
    velocity, error = speeds.velocity, speeds.error
    is_interval = (np.diff(speeds.cell) == 0) & (np.diff(speeds.stretch) == 0)
    width = np.where(is_interval, np.diff(speeds.fraction), 0.0)
    distance = width * speeds.length[1:]
    slope = np.diff(velocity) / np.where(is_interval, distance, 1.0)
    are_neighbours = is_interval[1:] & is_interval[:-1]
    slope_before = np.append(np.nan, np.where(are_neighbours, slope[:-1], np.nan))
    slope_after = np.append(np.where(are_neighbours, slope[1:], np.nan), np.nan)
    own_error = np.fmax(error[1:], error[:-1])
    bend = np.fmin(np.abs(slope - slope_before), np.abs(slope - slope_after)) * distance
    bend = np.fmax(bend - 3.0 * own_error, 0.0)

    def time(least: Array | float) -> Array:
        return np.where(
            is_interval, distance * slowness(velocity[:-1] - least, velocity[1:] - least), 0.0
        )

    with np.errstate(invalid="ignore"):  # of times that are infinite
        duration = time(0.0)
        delay, delay_with_errors = (
            time(bend / 2.0) - duration,
            time(bend / 2.0 + own_error) - duration,
        )
    extended = (
        velocity[:-1] + np.fmin(slope_before * distance, 0.0),
        velocity[1:] - np.fmax(slope_after * distance, 0.0),
    )
    least = np.fmax(np.minimum(velocity[:-1], velocity[1:]) - bend, np.minimum(*extended))
    least = np.where(is_interval, least, np.inf)
    fields_from_0 = ((0.0, width), (0.0, duration), (0.0, delay), (0.0, delay_with_errors))
    fields_from_inf = ((np.inf, least), (np.inf, least - own_error))
    return Intervals._make(
        np.append(values, end) for end, values in (*fields_from_0, *fields_from_inf)
    )


@dataclass(frozen=True)
class AlongTrack:
    """The way along a whole track: gives the `Passage`.

    Attributes
    ----------
    track : Track
        Gives the stretches of a cell.
    way : tuple of Equation
        From a share of the track's length to the motion there.
    needs : tuple of str
        Quantities that it needs from outside.
    """

    track: Track
    way: tuple[Equation, ...]
    needs: tuple[str, ...]

    def passage(self, **inputs: Any) -> Passage:
        """Return the passage of parts along the whole track, for every cell.

        From the quantities of `needs` by name; the cells are followed in pieces of `PIECE` motions.
        """
        settings = {name: inputs[name] for name in self.needs if name in SETTINGS}
        quantities = {name: inputs[name] for name in self.needs if name not in settings}
        of_cells = partial(self._of_cells, settings)
        step = max(1, PIECE // (self.track.count * (PARTS + 1)))
        return in_pieces(of_cells, quantities, step)

    def _of_cells(self, settings: dict[str, Any], quantities: dict[str, Array]) -> Passage:
        # Nodes at equal distances first; then intervals that are not resolved are halved, until
        # none is left. Of each cell the times add up, and the slowest node is the bottleneck.
        cells, count = len(quantities["start_radius"]), self.track.count
        node_fractions = np.clip(np.linspace(0.0, 1.0, PARTS + 1), INSIDE, 1.0 - INSIDE)
        cell, stretch = np.divmod(np.repeat(np.arange(cells * count), len(node_fractions)), count)
        speeds = self._speeds(
            quantities, settings, cell, stretch, np.tile(node_fractions, cells * count)
        )
        for _ in range(HALVINGS):
            unresolved = np.flatnonzero(self._needs_halving(speeds))
            if not unresolved.size:
                break
            middle = 0.5 * (speeds.fraction[unresolved] + speeds.fraction[unresolved + 1])
            middles = self._speeds(
                quantities, settings, speeds.cell[unresolved], speeds.stretch[unresolved], middle
            )
            speeds = Speeds._make(
                np.insert(old, unresolved + 1, new)
                for old, new in zip(speeds, middles, strict=True)
            )
        intervals, start = intervals_of(speeds), np.flatnonzero(np.diff(speeds.cell, prepend=-1))
        time, delay = (
            np.add.reduceat(durations, start)
            for durations in (intervals.time, intervals.delay_with_errors)
        )
        least = np.minimum.reduceat(speeds.velocity, start)  # NaN is least of all
        lowest = np.minimum.reduceat(intervals.least_with_errors, start)
        is_least = np.isnan(speeds.velocity) | (speeds.velocity == least[speeds.cell])
        least_nodes = np.flatnonzero(is_least)
        slowest = least_nodes[np.unique(speeds.cell[least_nodes], return_index=True)[1]]
        stretches, fraction = self._location(
            quantities, speeds.cell[slowest], speeds.stretch[slowest], speeds.fraction[slowest]
        )
        has_no_velocity = np.isnan(least)
        return Passage(
            time=np.where(least <= 0.0, np.inf, time),
            time_error=np.where(least <= 0.0, 0.0, delay),
            slowest=least,
            slowest_error=least - lowest,
            fraction=np.where(has_no_velocity, np.nan, fraction),
            radius=np.where(has_no_velocity, np.nan, radius_at(fraction, stretches)),
        )

    def _location(
        self,
        quantities: dict[str, Array],
        cell: NDArray[np.intp],
        stretch: NDArray[np.intp],
        at: Array,
    ) -> tuple[Stretches, Array]:
        # The stretches of the given nodes, and the share of the track's length at which each lies:
        # `at` is a share of its stretch.
        stretches = self.track.stretches(
            **{name: quantities[name][cell] for name in self.track.inputs}
        )
        stretch_bounds, rows = np.stack(bounds(stretches)), np.arange(len(cell))
        stretch_start, stretch_end = (
            stretch_bounds[stretch, rows],
            stretch_bounds[stretch + 1, rows],
        )
        return stretches, stretch_start + (stretch_end - stretch_start) * at

    def _speeds(
        self, quantities: dict[str, Array], settings: dict[str, Any], cell: NDArray[np.intp],
        stretch: NDArray[np.intp], at: Array,
    ) -> Speeds:  # fmt: skip
        # The motion at nodes: of the cell `cell`, at the share `at` of its stretch.
        stretches, fraction = self._location(quantities, cell, stretch, at)
        local = {name: value[cell] for name, value in quantities.items()} | settings
        results = run(self.way, {**local, "stretches": stretches, "track_fraction": fraction})
        length = np.stack(stretches.length)[stretch, np.arange(len(at))]
        motion = (np.broadcast_to(np.asarray(results[name], float), at.shape) for name in FOLLOWED)
        return Speeds(cell, stretch, at, length, *motion)

    def _needs_halving(self, speeds: Speeds) -> Mask:
        # True for intervals whose delay or least velocity may still change the result, or that are
        # wider than jumps of the motion allow.
        intervals, cell = intervals_of(speeds), speeds.cell
        start = np.flatnonzero(np.diff(cell, prepend=-1))
        time = np.add.reduceat(intervals.time, start)[cell]
        least = np.minimum.reduceat(speeds.velocity, start)[cell]
        stretch_number = cell * self.track.count + speeds.stretch
        tolerance = ENOUGH / (PARTS * self.track.count)
        delay_counts = np.isfinite(time) & (intervals.delay > tolerance * time)
        may_be_slower = intervals.least < least - ENOUGH * np.abs(least)
        depends_on_history = np.fmax(speeds.throw[:-1], speeds.throw[1:]) > MEMORY
        depends_on_history |= np.fmax(speeds.multiple[:-1], speeds.multiple[1:]) > 1.0
        differs = speeds.multiple[:-1] != speeds.multiple[1:]
        widest = np.where(differs, ACROSS, np.where(depends_on_history, CLOSE, 1.0))
        is_too_wide = intervals.width > np.append(widest, 1.0)
        return (
            (np.bincount(stretch_number)[stretch_number] <= MOST)
            & ~np.isnan(least)
            & (delay_counts | may_be_slower | is_too_wide)
        )


RESULTS = (
    Equation(
        "track_length",
        total_length,
        SOURCE,
        says="Return the length of the track, the sum of pi n (r_1 + r_2)/cos(gamma) [m].",
    ),
    *fields(
        "passage",
        SOURCE,
        transit_time=("time", "the time of a part from start to exit; infinite if it stops [s]"),
        transit_time_error=(
            "time_error",
            "error of the transit time from speeds between the places that are followed [s]",
        ),
        bottleneck_velocity=("slowest", "the least mean velocity along the track [m s-1]"),
        bottleneck_velocity_error=(
            "slowest_error",
            "how far below it a place between those that are followed may be [m s-1]",
        ),
        bottleneck_fraction=("fraction", "the share of the length at which parts are slowest [1]"),
        bottleneck_radius=("radius", "the radius at which parts are slowest [m]"),
    ),
    Equation("track_feed_rate", track_feed_rate, SOURCE),
)
DEFAULTS = {"track_fraction": 0.0, "load_fraction": 0.5}
_OF_PASSAGE = frozenset(one.gives for one in RESULTS if one.gives != "track_length")
CONDITIONS = (
    where(
        "unresolved", "a place of the track was met at which the motion has no mean velocity",
        lambda *, passage: np.isnan(passage.slowest), _OF_PASSAGE, otherwise="passes",
    ),
    where(
        "stalls", "parts stop or travel backwards somewhere on the track",
        lambda *, passage: passage.slowest <= 0.0, _OF_PASSAGE,
    ),
)  # fmt: skip


def along_track(track: Track) -> tuple[Equation, ...]:
    """Return the equations for radius, climb and friction of a bowl's track at one place of it.

    The place is a share of the track's length, the quantity `track_fraction`. `track` says how many
    stretches there are, and which has a climb or friction of its own; without any these remain
    parameters.
    """
    own = {
        "stretch_climb": ("gamma",),
        "stretch_friction": ("friction_static", "friction_kinetic"),
    }
    return (
        Equation(
            "stretches",
            track.stretches,
            SOURCE,
            needs=track.inputs,
            says="Return the stretches of the track.",
        ),
        Equation("track_radius", track_radius, SOURCE),
        product(
            "radius",
            "track_radius",
            source=SOURCE,
            says="the radius of the track where the part is [m]",
        ),
        *(
            Equation(
                name,
                partial(_at_fraction, track.names(stem)),
                SOURCE,
                needs=("track_fraction", "stretches", *track.names(stem)),
                says="Return what the stretch has at this place.",
            )
            for stem, names in own.items()
            if track.own[stem]
            for name in names
        ),
    )


def _at_fraction(
    own: tuple[str, ...], *, track_fraction: Array, stretches: Stretches, **inputs: Array
) -> Array:
    return picked(track_fraction, stretches, [inputs[name] for name in own])


def along(track: Track, equations: Collection[Equation]) -> tuple[Equation, ...]:
    """Return the equations that follow parts along the whole track of a bowl.

    They give transit time, feed rate, and place and velocity of the bottleneck, from motions at
    several nodes of each stretch of the `track`. `equations` are those of a part at one place,
    which lead from its share of the track's length (`track_fraction`) to its motion.
    """
    to_motion = between(equations, ("track_fraction",), FOLLOWED)
    needed = {name for equation in to_motion for name in equation.inputs} - {
        equation.gives for equation in to_motion
    }
    # Several arrays in one are computed anew at each place: only arrays of cells are handed on.
    bundles = {name for name in needed - {"stretches"} if QUANTITIES[name].bundle}
    to_motion = (*(equation for equation in equations if equation.gives in bundles), *to_motion)
    needed_inputs = {*track.inputs, *(name for equation in to_motion for name in equation.inputs)}
    needed_inputs -= {"track_fraction", "stretches", *(equation.gives for equation in to_motion)}
    whole_track = AlongTrack(track, to_motion, tuple(sorted(needed_inputs)))
    says = "Return what passes the whole track, from the motion at nodes along it."
    return (
        Equation("passage", whole_track.passage, SOURCE, needs=whole_track.needs, says=says),
        *RESULTS,
    )
