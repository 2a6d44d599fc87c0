"""Rows of parts in one lane, from event to event: exact up to rounding (theory 17).

Parts touch, push and are held by friction; faces are smooth, so that a contact acts along the track
only and the normal motion does not know of the row: all parts hop and land together. A row whose
parts have one friction moves as one part does, and is followed as one, to the bit.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array
from core.motion import compiled
from core.motion.cells import run_cells
from core.motion.course import TrajectoryRequest, TrajectoryValues
from core.motion.groups import BLOCK_ON_FLOOR, Contacts, Groups, table
from core.motion.method import Follow, FollowCourse, Method
from core.motion.methods import events
from core.motion.methods.events import motion_by_events
from core.motion.price import Price, Priced
from core.motion.result import ANSWERED, STATUS
from core.quantities.row import MOST_NUMBERED
from core.watch import Watch

PERIODS = 400.0
"""Most periods by default: a row that repeats does so within some tens; half of them give the mean
of one that does not, to some 0.1 %."""

SHOWN = 10
"""Periods from the start that a trajectory of steps shows: parts meet and part within some."""

EVENT_SECONDS = 1.2e-6
"""Of one event of one part on one core; a period has some two of each part, and collisions."""


class RowParts(NamedTuple):
    """The parts of rows, from the rear to the front; arrays (parts, ...) that broadcast.

    Attributes
    ----------
    number : ndarray, shape (...)
        Parts of each row; what stands behind them is not looked at.
    friction : tuple of ndarray
        Coefficients of part 1, 2, ..., NaN where a part has that of the groups.
    mass : tuple of ndarray
        Masses; only their ratios count.
    gap : tuple of ndarray
        Gaps in front of each part at the start, in g/w^2.
    restitution : ndarray
        Between parts.
    """

    number: Array
    friction: tuple[Array, ...]
    mass: tuple[Array, ...]
    gap: tuple[Array, ...]
    restitution: Array


class RowMotion(NamedTuple):
    """Motion of rows once it repeats, in the scales of the drive; arrays of one shape.

    Attributes
    ----------
    velocity, spread, error : ndarray
        Mean over the parts; standard deviation of the means of batches; the error of the mean.
    platoons : ndarray
        Groups of parts that have left each other for ever.
    slowest, fastest : ndarray
        Mean velocities of the slowest and of the fastest part.
    contact : ndarray
        Share of the time in which neighbours touch at one velocity, mean of all contacts.
    collisions : ndarray
        Per period of the drive.
    impact : ndarray
        Energy that collisions take in a period, in units of a mass and (g/w)^2.
    flight : ndarray
        Share of the period in the air.
    multiple : ndarray
        Periods after which the motion repeats; 0 where it does not.
    status : ndarray of int8
        Value of a `MOTION_STATUSES` entry.
    """

    velocity: Array
    spread: Array
    error: Array
    platoons: Array
    slowest: Array
    fastest: Array
    contact: Array
    collisions: Array
    impact: Array
    flight: Array
    multiple: Array
    status: NDArray[np.int8]


def row_motion(
    groups: Groups, parts: RowParts, most_periods: Array, watch: Watch | None = None
) -> RowMotion:
    """Return the motion of rows that start at rest on the track.

    A wave may have steps along the track; harmonics, or steps off the floor, are refused before.
    """
    rows, shape = _cells(groups, parts, most_periods)
    room = len(parts.friction)
    counts = rows[:, _head("parts")].astype(int)
    static, kinetic = (rows[:, _HEAD + k * room : _HEAD + (k + 1) * room] for k in (0, 1))
    inside = np.arange(room) < counts[:, np.newaxis]
    alike = np.ones(len(rows), dtype=bool)
    for part in (static, kinetic):
        alike &= ((part == part[:, :1]) | ~inside).all(axis=1)
    table_ = np.full((len(rows), compiled.rows.ROW_COLUMNS), np.nan)
    status = np.full(len(rows), STATUS["not_computed"], dtype=np.int8)
    if (~alike).any():
        table_[~alike], status[~alike] = run_cells(
            compiled.rows.row_cells,
            rows[~alike],
            columns=compiled.rows.ROW_COLUMNS,
            piece=16,
            watch=watch,
        )
    if alike.any():
        table_[alike], status[alike] = _as_one(groups, shape, static, kinetic, alike, watch)
    columns = [np.ascontiguousarray(column).reshape(shape) for column in table_.T]
    return RowMotion._make([*columns, status.reshape(shape)])


def _as_one(
    groups: Groups, shape: tuple[int, ...], static: Array, kinetic: Array,
    alike: NDArray[np.bool_], watch: Watch | None,
) -> tuple[Array, NDArray[np.int8]]:  # fmt: skip
    """Return table and statuses of rows of one friction: those of one part."""
    one = groups._replace(
        friction_static=static[:, 0].reshape(shape), friction_kinetic=kinetic[:, 0].reshape(shape)
    )
    settings: dict[str, Any] = dict(events.EVENTS.defaults)
    motion = motion_by_events(one, BLOCK_ON_FLOOR, watch=watch, **settings)
    flat = {name: np.broadcast_to(part, shape).ravel()[alike]
            for name, part in motion._asdict().items()}  # fmt: skip
    answered = np.isin(flat["status"], [STATUS[name] for name in ANSWERED])
    nothing = np.where(answered, 0.0, np.nan)
    velocity = flat["velocity"]
    columns = RowMotion(
        velocity, flat["spread"], flat["error"], nothing + 1.0, velocity, velocity, nothing + 1.0,
        nothing, nothing, flat["flight"], flat["multiple"], flat["status"],
    )  # fmt: skip
    return np.stack(columns[:-1], axis=1), flat["status"]


_HEAD_NAMES = (
    "drive_number_along", "drive_number_normal", "gravity_number_along", "gravity_number_normal",
    "part_restitution", "most_periods", "room", "parts",
)  # fmt: skip
_HEAD = len(_HEAD_NAMES)


def _head(name: str) -> int:
    return _HEAD_NAMES.index(name)


def _cells(groups: Groups, parts: RowParts, most_periods: Array) -> tuple[Array, tuple[int, ...]]:
    """Return the rows of the kernel, and the shape of the cells."""
    room = len(parts.friction)
    own = [np.isnan(one) for one in parts.friction]
    static, kinetic = (
        [np.where(none, common, one) for none, one in zip(own, parts.friction, strict=True)]
        for common in (groups.friction_static, groups.friction_kinetic)
    )
    drive = (groups.drive_number_along, groups.drive_number_normal)
    steps = ()
    if groups.wave is not None:
        none = np.zeros(groups.wave.cells)
        drive, steps = (none, none), (*groups.wave.steps[3], *groups.wave.steps[0])
    return table(
        (
            *drive, groups.gravity_number_along,
            groups.gravity_number_normal, parts.restitution, most_periods, float(room),
            parts.number, *static, *kinetic, *parts.mass, *parts.gap, *steps,
        )
    )  # fmt: skip


def _follow(contacts: Contacts) -> Follow:
    del contacts

    def motion(
        *, groups: Groups, row: RowParts, most_periods: Array, watch: Watch | None = None
    ) -> RowMotion:
        """Return the motion of a row of parts, once it repeats."""
        return row_motion(groups, row, most_periods, watch)

    return motion


def _course(contacts: Contacts) -> FollowCourse:
    """Return what gives the places of the parts of a row, from its start."""
    del contacts

    def course(asked: TrajectoryRequest) -> TrajectoryValues:
        turn = 2 * np.pi
        pace = asked.scale("velocity_scale") / asked.scale("length_scale")
        if isinstance(asked.samples, int):
            times = np.linspace(0.0, SHOWN * turn, asked.samples + 1) / pace
        else:
            times = np.array(asked.samples)
        rows, _ = _cells(asked.arguments["groups"], asked.arguments["row"], np.asarray(PERIODS))
        parts = int(rows[0, _head("parts")])
        places, gaps = np.empty((times.size, parts)), np.empty((times.size, parts - 1))
        compiled.rows.path_of_row(rows[0], times * pace, places, gaps)
        pitch = np.asarray(asked.known["length"]).item() if "length" in asked.known else 0.0
        room = len(asked.arguments["row"].friction)
        first = _HEAD + 3 * room
        starts = np.r_[0.0, np.cumsum(rows[0, first : first + parts - 1])]
        scale = asked.scale("length_scale")
        values = {
            f"part_position_{n + 1}": (places[:, n] + starts[n]) * scale + n * pitch
            for n in range(min(parts, MOST_NUMBERED))
        }
        return TrajectoryValues(times, values, {})

    return course


def _price(cells: Priced) -> Price:
    """Return what a row takes: events go with parts and, where they collide, with their square."""
    row: RowParts = cells.known["row"]
    count = np.asarray(row.number, dtype=float)
    period = EVENT_SECONDS * count * (4.0 + count)
    return Price(40.0 * period, np.asarray(cells.setting("most_periods")) * 3.0 * period)


EVENTS = Method(
    name="events",
    follow=_follow,
    source="theory 17",
    accuracy="exact up to rounding, some 1e-12 of the drive, where the motion repeats; the error "
    "of the mean of batches of periods where it does not",
    seconds_a_cell=_price,
    defaults={"most_periods": PERIODS},
    course=_course,
)
