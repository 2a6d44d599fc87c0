"""Rows of parts in one lane, from event to event: exact up to rounding (theory 17).

Parts touch, push and are held by friction; faces are smooth, so that a contact acts along the track
only and the normal motion does not know of the row: all parts hop and land together. A row whose
parts have one friction moves as one part does, and is followed as one, to the bit.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion import compiled
from vibrafeed.core.motion.cells import run_cells
from vibrafeed.core.motion.course import TrajectoryRequest, TrajectoryValues
from vibrafeed.core.motion.groups import BLOCK_ON_FLOOR, Contacts, Groups, table
from vibrafeed.core.motion.method import Follow, FollowCourse, Method
from vibrafeed.core.motion.methods import events
from vibrafeed.core.motion.methods.events import motion_by_events
from vibrafeed.core.motion.result import ANSWERED, STATUS
from vibrafeed.core.motion.waves import NORMAL, of_columns
from vibrafeed.core.quantities.row import MAX_NUMBERED
from vibrafeed.core.watch import Watch

PERIODS = 400.0
"""Most periods by default: a row that repeats does so within some tens; half of them give the mean
of one that does not, to some 0.1 %."""

SHOWN = 10
"""Periods from the start that a trajectory of steps shows: parts meet and part within some."""


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
        Between parts, and of the front part against the stop.
    shift : tuple of ndarray
        What is added to the friction of each part, drawn at random; empty if none is.
    stop : str
        "none", "track" of a stop that moves with the track, "space" of one at rest beside it.
    stop_gap : ndarray
        Gap between the front part and the stop at the start, in g/w^2.
    """

    number: Array
    friction: tuple[Array, ...]
    mass: tuple[Array, ...]
    gap: tuple[Array, ...]
    restitution: Array
    shift: tuple[Array, ...] = ()
    stop: str = "none"
    stop_gap: Array | float = 0.0


STOPS = ("none", "track", "space")
"""What may stand in front of a row, in the order of the kernel's numbers."""


class RowMotion(NamedTuple):
    """Motion of rows once it repeats, in the scales of the drive; arrays of one shape.

    Attributes
    ----------
    velocity, spread, error : ndarray
        Mean over the parts, NaN of a row that still drifts; standard deviation of the means of
        batches; the error of the mean, for 99 % where the motion does not repeat.
    platoons : ndarray
        Groups of parts that have left each other for ever.
    slowest, fastest : ndarray
        Mean velocities of the slowest and of the fastest part.
    contact : ndarray
        Share of the time in which neighbours touch at one velocity, mean of all contacts.
    collisions : ndarray
        Contacts that close with a relative velocity, per period of the drive.
    impact : ndarray
        Energy that collisions take in a period, in units of a mass and (g/w)^2.
    flight : ndarray
        Share of the period in the air.
    multiple : ndarray
        Periods after which the motion repeats; 0 where it does not.
    gap : ndarray
        Mean gap between neighbours of one platoon, in g/w^2; NaN where each part is by itself.
    stop_force, stop_peak : ndarray
        Mean force on the stop, strokes included, and the largest force between strokes, in units of
        a mass and g. Of a stop of the track it is the least that friction leaves to it.
    stop_impulse : ndarray
        Of the strokes against the stop in a period, in units of a mass and g/w.
    stop_contact : ndarray
        Share of the time in which the row touches the stop.
    part_velocity : ndarray, shape (parts, ...)
        Mean velocity of each part, NaN behind the last.
    part_platoon : ndarray, shape (parts, ...)
        Number of the platoon of each part, 1 at the rear.
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
    gap: Array
    stop_force: Array
    stop_peak: Array
    stop_impulse: Array
    stop_contact: Array
    part_velocity: Array
    part_platoon: Array
    status: NDArray[np.int8]


def row_motion(
    groups: Groups, parts: RowParts, max_periods: Array, watch: Watch | None = None
) -> RowMotion:
    """Return the motion of rows of parts that start at rest on the track, once it repeats.

    Parameters
    ----------
    groups, parts
        Dimensionless groups of the cells, and the parts of their rows. Parts that rebound from the
        floor hop each by itself: their rows are not followed, and have NaN.
    max_periods
        Periods after which a motion counts as aperiodic, or as many more if it still drifts.
    watch
        May stop the work; cells not computed have the status `not_computed`.
    """
    periods = np.where(np.equal(groups.restitution, 0.0), max_periods, 0.0)
    rows, shape = _cells(groups, parts, periods)
    room, columns = len(parts.friction), RowMotion._fields.index("part_velocity")
    width = columns + 2 * room
    alike, supported = _alike(rows, room), rows[:, compiled.rows.AT.max_periods] > 0.0
    as_one = alike & supported & (parts.stop == "none")
    if as_one.all():
        means, each, status = _as_one(groups, rows, shape, as_one, room, watch)
    else:
        table_ = np.full((len(rows), width), np.nan)
        status = np.full(len(rows), STATUS["not_computed"], dtype=np.int8)
        away = ~as_one & supported & _runs_away(rows, room)
        status[away] = STATUS["runaway"]
        rest = ~as_one & supported & ~away
        held = _merge_equal_parts(rows[rest], alike[rest], room)
        if rest.any():
            table_[rest], status[rest] = run_cells(
                _by_events, held, columns=width, piece=16, watch=watch
            )
            table_[status == STATUS["limit_reached"]] = np.nan
        _spread_to_parts(table_, rows, alike & rest, room, columns)
        if as_one.any():
            of_rows, of_parts, status[as_one] = _as_one(groups, rows, shape, as_one, room, watch)
            table_[as_one] = np.concatenate([np.stack(of_rows, axis=1), *of_parts], axis=1)
        means = [np.ascontiguousarray(column) for column in table_.T[:columns]]
        each = [table_[:, start : start + room] for start in (columns, columns + room)]
    by_part = [np.reshape(np.ascontiguousarray(one.T), (room, *shape)) for one in each]
    return RowMotion._make([*(one.reshape(shape) for one in means), *by_part,
                            status.reshape(shape)])  # fmt: skip


def _waved(rows: Array) -> NDArray[np.bool_]:
    """Return a mask of the rows whose drive is a wave that the kernel for sines cannot follow.

    That is any but a sine or steps along the track. `rows` is the kernel's input, a row of numbers
    for each row of parts, with the columns of the wave last.
    """
    tables = compiled.rows
    columns = rows[:, tables.HEAD + len(tables.OWN) * int(rows[0, tables.AT.room]) :]
    if not columns.size:
        return np.zeros(len(rows), dtype=bool)
    wave = of_columns(columns)
    return wave.steps[NORMAL].any(axis=0) | (wave.harmonics.shape[2] > 0)


def _own(rows: Array, room: int, number: int) -> Array:
    """Return a number of `Own` of each part, a view of shape (rows, room)."""
    start = compiled.rows.HEAD + number * room
    return rows[:, start : start + room]


def _by_events(
    cells: Array, table_: Array, status: NDArray[np.int8], stop: NDArray[np.int8]
) -> None:
    """Fill results and statuses of rows of parts from event to event, by the kernel for each drive.

    Drives that are waves need another kernel than sines and steps along the track. `cells` has a
    row of numbers for each row of parts, `table_` a row of results, `status` one value; `stop` is a
    flag that ends the work.
    """
    waved = _waved(cells)
    for some, kernel in ((~waved, "row_cells"), (waved, "waved_row_cells")):
        if some.any():
            means, found = table_[some], status[some]
            getattr(compiled.rows, kernel)(cells[some], means, found, stop)
            table_[some], status[some] = means, found


def _alike(rows: Array, room: int) -> NDArray[np.bool_]:
    """Return a mask of the rows of parts in which all have one static and one kinetic friction.

    Such parts move as one. `rows` is the kernel's input, a row of numbers for each row of parts,
    with `room` columns for each number of the parts.
    """
    inside = _inside(rows, room)
    alike = np.ones(len(rows), dtype=bool)
    for number in (compiled.rows.OWN.static, compiled.rows.OWN.kinetic):
        part = _own(rows, room, number)
        alike &= ((part == part[:, :1]) | ~inside).all(axis=1)
    return alike


def _inside(rows: Array, room: int) -> NDArray[np.bool_]:
    """Return a mask, shape (rows, room), of the parts that exist in each row."""
    counts = rows[:, compiled.rows.AT.parts].astype(int)
    return np.arange(room) < counts[:, np.newaxis]


def _runs_away(rows: Array, room: int) -> NDArray[np.bool_]:
    """Return a mask of the rows whose parts at the lower end leave the others for ever.

    That is where friction cannot hold these parts together: sum m_i (|sin(gamma)| - mu_s,i n) > 0
    over some parts from the lower end on, n the mean load. A stop in front holds those in front.
    `rows` is the kernel's input, with `room` columns for each number of the parts.
    """
    at, own = compiled.rows.AT, compiled.rows.OWN
    along, load = rows[:, at.gravity_number_along], rows[:, at.gravity_number_normal]
    pull = np.abs(along)[:, np.newaxis] - _own(rows, room, own.static) * load[:, np.newaxis]
    pull = np.where(_inside(rows, room), _own(rows, room, own.mass) * pull, 0.0)
    behind = (along > 0) & (np.cumsum(pull, axis=1) > 0).any(axis=1)
    in_front = (along < 0) & (np.cumsum(pull[:, ::-1], axis=1) > 0).any(axis=1)
    return np.asarray(behind | (in_front & (rows[:, at.stop] == STOPS.index("none"))))


def _merge_equal_parts(rows: Array, alike: NDArray[np.bool_], room: int) -> Array:
    """Return the kernel's input with rows of touching parts of one friction replaced by one part.

    Such parts move as one, of their total mass. `rows` has a row of numbers for each row of parts,
    with `room` columns for each number of the parts; `alike` is the mask of those with one
    friction.
    """
    own = compiled.rows.OWN
    masses, gaps = _own(rows, room, own.mass), _own(rows, room, own.gap)
    inside = _inside(rows, room)
    closed = (gaps[:, :-1] == 0.0) | ~inside[:, 1:]
    whole = alike & closed.all(axis=1)
    merged = rows.copy()
    _own(merged, room, own.mass)[whole, 0] = np.where(inside, masses, 0.0).sum(axis=1)[whole]
    merged[whole, compiled.rows.AT.parts] = 1.0
    return merged


def _spread_to_parts(
    table_: Array, rows: Array, alike: NDArray[np.bool_], room: int, columns: int
) -> None:
    """Fill the columns of each part in the results of rows that were followed as a single part.

    Each part gets the velocity of that one and the first platoon; neighbours touch all the time.

    `table_` holds the results, a row of numbers for each row of parts, `rows` the kernel's input;
    `alike` is the mask of the rows of one friction, `room` the number of columns for each number of
    the parts, `columns` that of the columns before them.
    """
    as_one = alike & np.isnan(table_[:, columns + 1]) & ~np.isnan(table_[:, columns])
    inside = _inside(rows, room)[as_one]
    for start, value in ((columns, table_[as_one, columns]), (columns + room, 1.0)):
        own = np.where(inside, np.reshape(value, (-1, 1)), np.nan)
        table_[as_one, start : start + room] = own
    for name, nothing in (("contact", 1.0), ("gap", 0.0)):
        table_[as_one, RowMotion._fields.index(name)] = nothing


def _as_one(
    groups: Groups, rows: Array, shape: tuple[int, ...], alike: NDArray[np.bool_], room: int,
    watch: Watch | None,
) -> tuple[list[Array], list[Array], NDArray[np.int8]]:  # fmt: skip
    """Return means, columns of each part, and statuses of rows of parts that all move as one.

    Parts of one friction without a stop do so: the motion of a single part is followed, and spread
    over them.

    Parameters
    ----------
    groups, shape
        Dimensionless groups of all cells, and their shape.
    rows, room
        The kernel's input, a row a cell, with `room` columns for each number of the parts.
    alike
        Mask of the rows that are taken.
    watch
        May stop the work.

    Returns
    -------
    A list of arrays of the means of `RowMotion`, of shape (rows,); velocity and platoon of each
    part, shape (rows, room), NaN behind the last part; and statuses.
    """
    own = compiled.rows.OWN
    static, kinetic = (_own(rows, room, n)[:, 0].reshape(shape) for n in (own.static, own.kinetic))
    one = groups._replace(friction_static=static, friction_kinetic=kinetic, restitution=0.0)
    settings: dict[str, Any] = dict(events.EVENTS.defaults)
    motion = motion_by_events(one, BLOCK_ON_FLOOR, watch=watch, **settings)
    names = ("velocity", "spread", "error", "flight", "multiple", "status")
    flat = {
        name: np.broadcast_to(getattr(motion, name), shape).ravel()[alike] for name in names
    }  # fmt: skip
    answered = np.isin(flat["status"], [STATUS[name] for name in ANSWERED])
    nothing = np.where(answered, 0.0, np.nan)
    inside = _inside(rows[alike], room)
    gaps = _own(rows[alike], room, own.gap)[:, :-1]
    contacts = inside[:, 1:].sum(axis=1)
    apart = np.where(inside[:, 1:], gaps, 0.0)
    touching = 1.0 - (apart > 0.0).sum(axis=1) / contacts
    columns = [
        flat["velocity"], flat["spread"], flat["error"], nothing + 1.0, flat["velocity"],
        flat["velocity"], nothing + touching, nothing, nothing, flat["flight"], flat["multiple"],
        nothing + apart.sum(axis=1) / contacts, *[nothing] * 4,
    ]  # fmt: skip
    each = [
        np.where(inside, value[:, np.newaxis], np.nan)
        for value in (flat["velocity"], nothing + 1.0)
    ]
    return columns, each, flat["status"]


def _cells(groups: Groups, parts: RowParts, max_periods: Array) -> tuple[Array, tuple[int, ...]]:
    """Return the kernel's input for rows of parts, one row of numbers a cell, and cells' shape.

    `groups` are the dimensionless groups of drive and floor, `parts` the numbers of the parts,
    `max_periods` is a setting of the method. The columns are the fields of `Head`, static and
    kinetic frictions, masses and gaps of the parts, and those of a wave, if there is one.
    """
    room = len(parts.friction)
    own = [np.isnan(one) for one in parts.friction]
    static, kinetic = (
        [np.where(none, common, one) for none, one in zip(own, parts.friction, strict=True)]
        for common in (groups.friction_static, groups.friction_kinetic)
    )
    if parts.shift:
        static, kinetic = (
            [np.maximum(0.0, one + more) for one, more in zip(some, parts.shift, strict=True)]
            for some in (static, kinetic)
        )
    wave = groups.wave
    drive = (groups.drive_number_along, groups.drive_number_normal)
    if wave is not None:
        drive = (np.zeros(wave.cells), np.zeros(wave.cells))
    head = compiled.rows.Head(
        *drive, groups.gravity_number_along, groups.gravity_number_normal, parts.restitution,
        max_periods, float(STOPS.index(parts.stop)), parts.stop_gap, float(room), parts.number,
    )  # fmt: skip
    rows, shape = table((*head, *static, *kinetic, *parts.mass, *parts.gap))
    if wave is not None:
        rows = np.concatenate([rows, wave.columns(shape)], axis=1)
    return rows, shape


def _follow(contacts: Contacts) -> Follow:
    """Return the function of the motion equation that follows rows of parts from event to event.

    Methods are built by such functions from the `contacts` of a system, which a row does not need.
    """
    del contacts

    def motion(
        *, groups: Groups, row: RowParts, max_periods: Array, watch: Watch | None = None
    ) -> RowMotion:
        """Return the motion of a row of parts, once it repeats."""
        return row_motion(groups, row, max_periods, watch)

    return motion


def _course(contacts: Contacts) -> FollowCourse:
    """Return the function that computes the positions of a row's parts at asked times, by events.

    Methods are built by such functions from the `contacts` of a system, which a row does not need.
    Positions are counted from the place in which the rear part starts, with the lengths of parts
    between them if the study gives these [m].
    """
    del contacts

    def course(asked: TrajectoryRequest) -> TrajectoryValues:
        """Return the positions of all parts of the row at the asked times."""
        turn = 2 * np.pi
        pace = asked.scale("velocity_scale") / asked.scale("length_scale")
        if isinstance(asked.samples, int):
            times = np.linspace(0.0, SHOWN * turn, asked.samples + 1) / pace
        else:
            times = np.array(asked.samples)
        rows, _ = _cells(asked.arguments["groups"], asked.arguments["row"], np.asarray(PERIODS))
        parts = int(rows[0, compiled.rows.AT.parts])
        contacts = parts - (asked.arguments["row"].stop == "none")
        places, gaps = np.empty((times.size, parts)), np.empty((times.size, contacts))
        waved = bool(_waved(rows)[0])
        path = compiled.rows.path_of_waved_row if waved else compiled.rows.path_of_row
        path(rows[0], times * pace, places, gaps)
        pitch = np.asarray(asked.known["length"]).item() if "length" in asked.known else 0.0
        room = len(asked.arguments["row"].friction)
        gap = _own(rows, room, compiled.rows.OWN.gap)[0, : parts - 1]
        starts = np.r_[0.0, np.cumsum(gap)]
        scale = asked.scale("length_scale")
        values = {
            f"part_position_{n + 1}": (places[:, n] + starts[n]) * scale + n * pitch
            for n in range(min(parts, MAX_NUMBERED))
        }
        return TrajectoryValues(times, values, {})

    return course


EVENTS = Method(
    name="events",
    follow=_follow,
    source="theory 17",
    accuracy="exact up to rounding, some 1e-12 of the drive, where the motion repeats; the error "
    "of the mean of batches of periods where it does not",
    seconds_a_cell=5e-3,
    defaults={"max_periods": PERIODS},
    course=_course,
)
