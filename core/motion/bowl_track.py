"""The track of a bowl from its start to the exit: radius, climb and lining by stretch.

The names of a study's parameters say which stretches there are, as they do for the parts of a row.
Equations then give radius, climb and friction at a share of the track's length, and what passes the
whole track from the motion at nodes along it.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from core.errors import Problem
from core.mechanics.arrays import Array, Mask
from core.mechanics.bowl_track import (
    Stretches,
    bounds,
    picked,
    radius_at,
    stretches_of,
    total_length,
)
from core.motion.rates import parts_per_minute
from core.plan.equations import run
from core.quantities.bowl_track import OF_STRETCHES
from core.scenes.graph import between
from core.scenes.scene import Condition, Equation, fields, keywords
from core.study.simulate_study import SETTINGS

SOURCE = "theory 15.6"
PARTS = 16
"""Equal intervals of a stretch, at whose ends the motion is followed."""
INSIDE = 1e-9
"""Of a stretch: how far its first and last node lie from its ends."""
SMALL = 1e-4
"""Relative change of a velocity below which its quotient is taken from a series."""
PIECE = 100_000
"""Largest number of motions that are followed together, for memory."""
GIVES_WAY = {"stretch_climb": ("gamma",), "stretch_friction": ("friction", "friction_static",
             "friction_kinetic"), "stretch_radius": ("radius",)}  # fmt: skip
"""Parameters that a study may not give beside a quantity of the stretches, which takes their
place."""

_NUMBERED = re.compile(rf"({'|'.join(OF_STRETCHES)})_(\d+)")


@dataclass(frozen=True)
class Track:
    """The stretches of a track that the names of parameters give.

    Attributes
    ----------
    count
        Number of stretches.
    own
        By the stem of a parameter (`stretch_climb`, ...), the numbers of the stretches that have
        their own value of it.
    """

    count: int
    own: Mapping[str, tuple[int, ...]]

    def names(self, stem: str) -> tuple[str, ...]:
        """Return the parameter that gives a quantity on each stretch: its own, or an earlier one's.

        `stem` is the parameter's name without number; on stretch 3 a climb may come from stretch 1.
        """
        return tuple(
            f"{stem}_{max(k for k in self.own[stem] if k <= n)}" for n in range(1, self.count + 1)
        )


def track_of(names: Iterable[str], *, of_bowl: bool) -> tuple[Track | None, list[Problem]]:
    """Return the track that a study's parameter names define (None if none), and their problems.

    Names such as `stretch_turns_1` say how many stretches there are and what each has of its own.
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
    count = max(n for which in own.values() for n in which)
    problems = [] if of_bowl else [_without_bowl(matches[0][0])]
    problems += [*_missing(own, count), *_twice(own, parameters)]
    return (None if problems else Track(count, own)), problems


def _missing(own: Mapping[str, Sequence[int]], count: int) -> Iterator[Problem]:
    """Yield a problem for each numbered parameter that a stretch of a bowl's track lacks.

    Each stretch needs its turns and end radius; climb and friction may come from an earlier
    stretch. `own` holds, by the stem of a parameter such as `stretch_climb`, the numbers of the
    stretches that have it; `count` is the number of stretches.
    """
    for stem in ("stretch_turns", "stretch_radius"):
        for n in range(1, count + 1):
            if n not in own[stem]:
                message = "it is missing; each stretch needs it"
                yield Problem(f"parameters.{stem}_{n}", message, "Add it")
    for stem in ("stretch_climb", "stretch_friction"):
        if own[stem] and 1 not in own[stem]:
            message = "it is missing: the first stretch has none before it"
            yield Problem(f"parameters.{stem}_1", message, "Add it")


def _twice(own: Mapping[str, Sequence[int]], names: Collection[str]) -> Iterator[Problem]:
    """Yield a problem for each parameter in `names` that stretches of a bowl's track determine.

    Such as a climb beside the climbs of stretches. `own` holds, by the stem of a parameter such as
    `stretch_climb`, the numbers of the stretches that have it; `names` are those of the study.
    """
    for stem, others in GIVES_WAY.items():
        for name in others:
            if own[stem] and name in names:
                message = f"{name} follows from the stretches of the track ({stem}_{own[stem][0]})"
                yield Problem(
                    f"parameters.{name}", message, f"Remove {name}, or all parameters {stem}_..."
                )


def _without_bowl(name: str) -> Problem:
    """Return the problem of stretches in a study whose track is not on a bowl drive unit."""
    message = "stretches belong to the track of a bowl on its drive unit"
    return Problem(
        f"parameters.{name}",
        message,
        "Add the parameters of the bowl drive unit: spring_radius, moving_inertia, base_inertia",
    )


# --- equations


@dataclass(frozen=True)
class AllStretches:
    """The function of the equation that gives the stretches of a track."""

    track: Track

    def __post_init__(self) -> None:
        object.__setattr__(self, "__doc__", "Return the stretches of the track.")

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the quantities that the equation needs."""
        track = self.track
        stems = ("stretch_radius", "stretch_turns")
        return ("start_radius", *(n for stem in stems for n in track.names(stem)), *self.climbs)

    @property
    def climbs(self) -> tuple[str, ...]:
        """Names of the climbs, one a stretch."""
        own = self.track.own["stretch_climb"]
        return self.track.names("stretch_climb") if own else ("gamma",) * self.track.count

    @property
    def __signature__(self) -> inspect.Signature:
        return keywords(self.inputs)

    def __call__(self, **inputs: Any) -> Stretches:
        """Return the stretches of the track from the values of the inputs, by name."""
        radii, turns = (
            [inputs[name] for name in self.track.names(stem)]
            for stem in ("stretch_radius", "stretch_turns")
        )
        climbs = [inputs[name] for name in self.climbs]
        return stretches_of(inputs["start_radius"], radii, turns, climbs)


@dataclass(frozen=True)
class AtFraction:
    """The function of an equation that gives a quantity at a share of the track's length.

    `stem` is the parameter's name without number, such as `stretch_friction`.
    """

    track: Track
    stem: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "__doc__", "Return what the stretch has at this place.")

    @property
    def __signature__(self) -> inspect.Signature:
        return keywords(("track_fraction", "stretches", *self.track.names(self.stem)))

    def __call__(self, **inputs: Any) -> Array:
        """Return the value of the quantity on the stretch at a share of the track's length."""
        values = [inputs[name] for name in self.track.names(self.stem)]
        return picked(inputs["track_fraction"], inputs["stretches"], values)


def track_radius(*, track_fraction: Array, stretches: Stretches) -> Array:
    """Return the radius at a share of the track's length, r^2 linear within a stretch [m]."""
    return radius_at(track_fraction, stretches)


def radius(*, track_radius: Array) -> Array:
    """Return the radius of the track where the part is [m]."""
    return track_radius


def load_radius(*, load_fraction: Array, stretches: Stretches) -> Array:
    """Return the radius at which the load on the whole track is taken to act [m]."""
    return radius_at(load_fraction, stretches)


def track_length(*, stretches: Stretches) -> Array:
    """Return the length of the track, the sum of pi n (r_1 + r_2)/cos(gamma) [m]."""
    return total_length(stretches)


def track_feed_rate(*, passage: Passage, length: Array, occupancy: Array) -> Array:
    """Return the number of parts per minute at the bottleneck, 60 v occupancy/length [min-1]."""
    return parts_per_minute(velocity=passage.slowest, length=length / occupancy)


def stalls(*, passage: Passage) -> Mask:
    """True where parts stop or travel backwards somewhere on the track."""
    return np.logical_not(passage.slowest > 0.0)


class Passage(NamedTuple):
    """The passage of parts along a whole track; arrays of one shape.

    Attributes
    ----------
    time : ndarray
        Of a part from start to exit [s]; infinite where it stops on the way.
    slowest : ndarray
        The least mean velocity [m s-1].
    fraction, radius : ndarray
        Share of the length, and radius [m], at which that is.
    """

    time: Array
    slowest: Array
    fraction: Array
    radius: Array


def slowness(first: Array, last: Array) -> Array:
    """Return the mean of 1/v between two points of a track, from which the time of a part follows.

    ln(v_2/v_1)/(v_2 - v_1) [s m-1] for a velocity v that is linear between both, with v_1 = `first`
    and v_2 = `last` [m s-1]. Infinite if one of both is not above 0, NaN if one has no value.
    """
    moves = (first > 0.0) & (last > 0.0)
    v = np.where(moves, first, 1.0)
    x = np.where(moves, last - first, 0.0) / v
    small = np.abs(x) < SMALL
    share = np.where(small, 1.0 - x / 2.0 + x * x / 3.0, np.log1p(x) / np.where(small, 1.0, x))
    held = np.where(np.isnan(first + last), np.nan, np.inf)
    return np.where(moves, share / v, held)


@dataclass(frozen=True)
class AlongTrack:
    """The function of the equation that gives the `Passage`.

    Attributes
    ----------
    stretches : AllStretches
        Gives the stretches of a cell.
    way : tuple of Equation
        From a share of the track's length to the mean velocity there.
    needs : tuple of str
        Quantities that it needs from outside.
    """

    stretches: AllStretches
    way: tuple[Equation, ...]
    needs: tuple[str, ...]

    def __post_init__(self) -> None:
        says = "Return what passes the whole track, from the motion at nodes along it."
        object.__setattr__(self, "__doc__", says)

    @property
    def nodes(self) -> int:
        """The number of motions that are followed in each cell, at points along the track."""
        return self.stretches.track.count * (PARTS + 1)

    @property
    def __signature__(self) -> inspect.Signature:
        """One argument a quantity."""
        return keywords(self.needs)

    def __call__(self, **inputs: Any) -> Passage:
        """Return the passage of parts along the whole track, for every cell.

        From the quantities of `needs` by name; the cells are followed in pieces of `PIECE` motions.
        """
        settings = {name: inputs[name] for name in self.needs if name in SETTINGS}
        names = [name for name in self.needs if name not in settings]
        columns = np.broadcast_arrays(*(np.asarray(inputs[name], dtype=float) for name in names))
        shape = columns[0].shape
        flat = [column.reshape(-1, 1) for column in columns]
        step = max(1, PIECE // self.nodes)
        pieces = [
            self._of_cells(
                settings | {n: v[at : at + step] for n, v in zip(names, flat, strict=True)}
            )
            for at in range(0, len(flat[0]), step)
        ]
        return Passage._make(
            np.concatenate(part).reshape(shape) for part in zip(*pieces, strict=True)
        )

    def _of_cells(self, known: dict[str, Any]) -> Passage:
        """Return the passage of parts along the whole track of a bowl, for a piece of the cells.

        Transit time, least mean velocity, and where that is. The motion is followed at `nodes`
        places of the track; between two the mean velocity is taken as linear. `known` holds the
        quantities of `needs` by name, of shape (cells, 1).
        """
        stretches = self.stretches(**{name: known[name] for name in self.stretches.inputs})
        x = np.clip(np.linspace(0.0, 1.0, PARTS + 1), INSIDE, 1.0 - INSIDE)
        ends = bounds(stretches)
        nodes = np.concatenate([low + (high - low) * x for low, high in pairwise(ends)], axis=1)
        cells = len(nodes)
        found = run(self.way, {**known, "stretches": stretches, "track_fraction": nodes})
        velocity = np.broadcast_to(found["conveying_velocity"], nodes.shape)
        rows, slowest = np.arange(cells), np.argmin(velocity, axis=1)  # NaN is least of all
        of_stretch = velocity.reshape(cells, -1, PARTS + 1)
        means = slowness(of_stretch[..., :-1], of_stretch[..., 1:]).mean(axis=2)
        lengths = np.concatenate(stretches.length, axis=1)
        return Passage(
            time=(lengths * means).sum(axis=1),
            slowest=velocity[rows, slowest],
            fraction=nodes[rows, slowest],
            radius=radius_at(nodes, stretches)[rows, slowest],
        )


RESULTS = (
    Equation("track_length", track_length, SOURCE),
    *fields(
        "passage",
        SOURCE,
        transit_time=("time", "the time of a part from start to exit; infinite if it stops [s]"),
        bottleneck_velocity=("slowest", "the least mean velocity along the track [m s-1]"),
        bottleneck_fraction=("fraction", "the share of the length at which parts are slowest [1]"),
        bottleneck_radius=("radius", "the radius at which parts are slowest [m]"),
    ),
    Equation("track_feed_rate", track_feed_rate, SOURCE),
)
DEFAULTS = {"track_fraction": 0.0, "load_fraction": 0.5}
STALLS = Condition(
    "stalls",
    stalls,
    frozenset(one.gives for one in RESULTS if one.gives != "track_length"),
)


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
        Equation("stretches", AllStretches(track), SOURCE),
        Equation("track_radius", track_radius, SOURCE),
        Equation("radius", radius, SOURCE),
        *(
            Equation(name, AtFraction(track, stem), SOURCE)
            for stem, names in own.items()
            if track.own[stem]
            for name in names
        ),
    )


def along(track: Track, equations: Collection[Equation]) -> tuple[Equation, ...]:
    """Return the equations that follow parts along the whole track of a bowl.

    They give transit time, feed rate, and place and velocity of the bottleneck, from motions at
    several nodes of each stretch of the `track`. `equations` are those of a part at one place,
    which lead from its share of the track's length (`track_fraction`) to its mean velocity.
    """
    stretches = AllStretches(track)
    way = between(equations, ("track_fraction",), ("conveying_velocity",))
    given = {*stretches.inputs, *(name for one in way for name in one.inputs)}
    given -= {"track_fraction", "stretches", *(one.gives for one in way)}
    passage = AlongTrack(stretches, way, tuple(sorted(given)))
    return (Equation("passage", passage, SOURCE), *RESULTS)


@dataclass(frozen=True)
class AtLoad:
    """Tells where on a track the parts are that load it, as `part_load` takes it."""

    stretches: AllStretches
    gives = ("track_fraction", "stretches")

    @property
    def inputs(self) -> tuple[str, ...]:
        """The names of the inputs: share of the length, and those that give the stretches."""
        return ("load_fraction", *self.stretches.inputs)

    def __call__(self, known: Mapping[str, Array]) -> dict[str, Any]:
        """Return the share of the length at which the load acts, and the stretches of the track."""
        stretches = self.stretches(**{name: known[name] for name in self.stretches.inputs})
        return {"track_fraction": known["load_fraction"], "stretches": stretches}
