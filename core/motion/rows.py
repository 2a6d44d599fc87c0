"""Rows of parts in one lane, from event to event: exact up to rounding (theory 17).

Parts touch, push and are held by friction; faces are smooth, so that a contact acts along the track
only and the normal motion does not know of the row: all parts hop and land together. A row whose
parts have one friction moves as one part does, and is followed as one, to the bit.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion import events, kernel_calls
from vibrafeed.core.motion.kernel_calls import run_cells
from vibrafeed.core.motion.method import (
    ANSWERED,
    BLOCK_ON_FLOOR,
    STATUS,
    TIME,
    Contacts,
    Groups,
    Method,
    Trajectory,
    TrajectoryRequest,
    table,
)
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
    groups: Groups, row: RowParts, max_periods: Array, watch: Watch | None = None
) -> RowMotion:
    """Return the motion of a row of parts, once it repeats.

    It starts at rest on the track. Parts that rebound from the floor hop independently: their rows
    are not followed, and have NaN. After `max_periods` a motion counts as aperiodic, or after as
    many more if it still drifts.
    """
    periods = np.where(np.equal(groups.restitution, 0.0), max_periods, 0.0)
    rows, shape = _cells(groups, row, periods)
    capacity, columns = len(row.friction), RowMotion._fields.index("part_velocity")
    exists, own_columns = _part_exists(rows), kernel_calls.rows.OWN
    frictions = [_own_numbers(rows, number) for number in (own_columns.static, own_columns.kinetic)]
    has_one_friction = np.logical_and.reduce([
        ((values == values[:, :1]) | ~exists).all(axis=1) for values in frictions
    ])  # fmt: skip
    supported = rows[:, kernel_calls.rows.AT.max_periods] > 0.0
    moves_as_one = has_one_friction & supported & (row.stop == "none")
    table_ = np.full((len(rows), columns + 2 * capacity), np.nan)
    status = np.full(len(rows), STATUS["not_computed"], dtype=np.int8)
    remaining = ~moves_as_one & supported
    if remaining.any():
        runs_away = remaining & _runs_away(rows)
        status[runs_away] = STATUS["runaway"]
        remaining &= ~runs_away
    if remaining.any():
        merged_rows = _merge_equal_parts(rows[remaining], has_one_friction[remaining])
        table_[remaining], status[remaining] = run_cells(
            _by_events, merged_rows, columns=table_.shape[1], piece=16, watch=watch
        )
        table_[status == STATUS["limit_reached"]] = np.nan
        # Rows that were followed as a single part: all have its velocity, and touch all the time.
        is_merged = (
            has_one_friction
            & remaining
            & np.isnan(table_[:, columns + 1])
            & ~np.isnan(table_[:, columns])
        )
        for start, value in (
            (columns, table_[is_merged, columns, np.newaxis]),
            (columns + capacity, 1.0),
        ):
            table_[is_merged, start : start + capacity] = np.where(exists[is_merged], value, np.nan)
        table_[is_merged, RowMotion._fields.index("contact")] = 1.0
        table_[is_merged, RowMotion._fields.index("gap")] = 0.0
    if moves_as_one.any():
        table_[moves_as_one], status[moves_as_one] = _followed_as_one(
            groups, rows, shape, moves_as_one, watch
        )
    means = [np.ascontiguousarray(column).reshape(shape) for column in table_.T[:columns]]
    by_part = [
        np.ascontiguousarray(table_[:, start : start + capacity].T).reshape(capacity, *shape)
        for start in (columns, columns + capacity)
    ]
    return RowMotion._make([*means, *by_part, status.reshape(shape)])


def _needs_wave_kernel(rows: Array) -> NDArray[np.bool_]:
    # A drive that the kernel for sines and steps along the track cannot follow.
    tables = kernel_calls.rows
    columns = rows[:, tables.HEAD + len(tables.OWN) * int(rows[0, tables.AT.room]) :]
    if not columns.size:
        return np.zeros(len(rows), dtype=bool)
    wave = of_columns(columns)
    return wave.steps[NORMAL].any(axis=0) | (wave.harmonics.shape[2] > 0)


def _own_numbers(rows: Array, number: int) -> Array:
    # A number of `Own` of each part, a view of shape (rows, room).
    capacity = int(rows[0, kernel_calls.rows.AT.room])
    start = kernel_calls.rows.HEAD + number * capacity
    return rows[:, start : start + capacity]


def _by_events(
    cells: Array, table_: Array, status: NDArray[np.int8], stop: NDArray[np.int8]
) -> None:
    # Rows under a wave that only its own kernel can follow go to that, all others to the faster
    # one.
    needs_wave = _needs_wave_kernel(cells)
    for mask, kernel in ((~needs_wave, "row_cells"), (needs_wave, "wave_row_cells")):
        if mask.any():
            means, mask_status = table_[mask], status[mask]
            getattr(kernel_calls.rows, kernel)(cells[mask], means, mask_status, stop)
            table_[mask], status[mask] = means, mask_status


def _part_exists(rows: Array) -> NDArray[np.bool_]:
    head = kernel_calls.rows.AT
    return np.arange(int(rows[0, head.room])) < rows[:, head.parts, np.newaxis].astype(int)


def _runs_away(rows: Array) -> NDArray[np.bool_]:
    # Parts at the lower end leave the others for ever where friction cannot hold them together:
    # sum m_i (|sin(gamma)| - mu_s,i n) > 0 over some from there on, n the mean load. A stop in
    # front holds those in front.
    head, own_columns = kernel_calls.rows.AT, kernel_calls.rows.OWN
    along, load = rows[:, head.gravity_number_along], rows[:, head.gravity_number_normal]
    pull = (
        np.abs(along)[:, np.newaxis] - _own_numbers(rows, own_columns.static) * load[:, np.newaxis]
    )
    pull = np.where(_part_exists(rows), _own_numbers(rows, own_columns.mass) * pull, 0.0)
    rear_leaves = (along > 0) & (np.cumsum(pull, axis=1) > 0).any(axis=1)
    front_leaves = (along < 0) & (np.cumsum(pull[:, ::-1], axis=1) > 0).any(axis=1)
    return np.asarray(rear_leaves | (front_leaves & (rows[:, head.stop] == STOPS.index("none"))))


def _merge_equal_parts(rows: Array, has_one_friction: NDArray[np.bool_]) -> Array:
    # Touching parts of one friction move as one, of their total mass.
    own_columns, exists = kernel_calls.rows.OWN, _part_exists(rows)
    all_touch = (_own_numbers(rows, own_columns.gap)[:, :-1] == 0.0) | ~exists[:, 1:]
    is_merged, merged = has_one_friction & all_touch.all(axis=1), rows.copy()
    masses = np.where(exists, _own_numbers(rows, own_columns.mass), 0.0).sum(axis=1)
    _own_numbers(merged, own_columns.mass)[is_merged, 0] = masses[is_merged]
    merged[is_merged, kernel_calls.rows.AT.parts] = 1.0
    return merged


def _followed_as_one(
    groups: Groups, rows: Array, shape: tuple[int, ...], mask: NDArray[np.bool_],
    watch: Watch | None,
) -> tuple[Array, NDArray[np.int8]]:  # fmt: skip
    # Parts of one friction without a stop: a single part is followed, and spread over them.
    own_columns = kernel_calls.rows.OWN
    static, kinetic = (
        _own_numbers(rows, number)[:, 0].reshape(shape)
        for number in (own_columns.static, own_columns.kinetic)
    )
    single_part = groups._replace(friction_static=static, friction_kinetic=kinetic, restitution=0.0)
    settings: dict[str, Any] = dict(events.EVENTS.defaults)
    motion = events.motion_by_events(single_part, BLOCK_ON_FLOOR, watch=watch, **settings)
    names = ("velocity", "spread", "error", "flight", "multiple", "status")
    velocity, spread, error, flight, multiple, status = (
        np.broadcast_to(getattr(motion, name), shape).ravel()[mask] for name in names
    )
    answered = np.isin(status, [STATUS[name] for name in ANSWERED])
    zero_or_nan = np.where(answered, 0.0, np.nan)
    exists = _part_exists(rows[mask])
    contacts = exists[:, 1:].sum(axis=1)
    gaps = np.where(exists[:, 1:], _own_numbers(rows[mask], own_columns.gap)[:, :-1], 0.0)
    touching_share = 1.0 - (gaps > 0.0).sum(axis=1) / contacts
    # The columns of `RowMotion`: one platoon, no collisions, no stop.
    columns = [
        velocity, spread, error, zero_or_nan + 1.0, velocity, velocity,
        zero_or_nan + touching_share, zero_or_nan, zero_or_nan, flight, multiple,
        zero_or_nan + gaps.sum(axis=1) / contacts, *[zero_or_nan] * 4,
    ]  # fmt: skip
    by_part = (
        np.where(exists, value[:, np.newaxis], np.nan) for value in (velocity, zero_or_nan + 1.0)
    )
    return np.concatenate([np.stack(columns, axis=1), *by_part], axis=1), status


def _cells(groups: Groups, parts: RowParts, max_periods: Array) -> tuple[Array, tuple[int, ...]]:
    # A kernel's row for each row of parts: the columns `Head`, then `Own` of every part, then the
    # wave.
    capacity = len(parts.friction)
    uses_common = [np.isnan(friction) for friction in parts.friction]
    static, kinetic = (
        [
            np.where(is_common, common, friction)
            for is_common, friction in zip(uses_common, parts.friction, strict=True)
        ]
        for common in (groups.friction_static, groups.friction_kinetic)
    )
    if parts.shift:
        static, kinetic = (
            [
                np.maximum(0.0, friction + shift)
                for friction, shift in zip(frictions, parts.shift, strict=True)
            ]
            for frictions in (static, kinetic)
        )
    wave = groups.wave
    drive = (groups.drive_number_along, groups.drive_number_normal)
    if wave is not None:
        drive = (np.zeros(wave.cells), np.zeros(wave.cells))
    head = kernel_calls.rows.Head(
        *drive, groups.gravity_number_along, groups.gravity_number_normal, parts.restitution,
        max_periods, float(STOPS.index(parts.stop)), parts.stop_gap, float(capacity), parts.number,
    )  # fmt: skip
    rows, shape = table((*head, *static, *kinetic, *parts.mass, *parts.gap))
    if wave is not None:
        rows = np.concatenate([rows, wave.columns(shape)], axis=1)
    return rows, shape


def _trajectory(request: TrajectoryRequest, contacts: Contacts) -> Trajectory:
    # Positions count from the place in which the rear part starts, with the lengths of parts
    # between them if the study gives these.
    del contacts
    row, scale = request.arguments["row"], request.scale("length_scale")
    phase_rate = request.scale("velocity_scale") / scale
    times = np.array(request.samples)
    if isinstance(request.samples, int):
        times = np.linspace(0.0, SHOWN * (2 * np.pi), request.samples + 1) / phase_rate
    rows, _ = _cells(request.arguments["groups"], row, np.asarray(PERIODS))
    parts = int(rows[0, kernel_calls.rows.AT.parts])
    positions_of_parts = np.empty((times.size, parts))
    gaps = np.empty((times.size, parts - (row.stop == "none")))
    needs_wave = bool(_needs_wave_kernel(rows)[0])
    fill_path = kernel_calls.rows.path_of_wave_row if needs_wave else kernel_calls.rows.path_of_row
    fill_path(rows[0], times * phase_rate, positions_of_parts, gaps)
    pitch = np.asarray(request.known["length"]).item() if "length" in request.known else 0.0
    starts = np.r_[0.0, np.cumsum(_own_numbers(rows, kernel_calls.rows.OWN.gap)[0, : parts - 1])]
    positions = {
        f"part_position_{part + 1}": (positions_of_parts[:, part] + starts[part]) * scale
        + part * pitch
        for part in range(min(parts, MAX_NUMBERED))
    }
    return {TIME: times, **positions}


EVENTS = Method(
    name="events",
    follow=row_motion,
    source="theory 17",
    accuracy="exact up to rounding, some 1e-12 of the drive, where the motion repeats; the error "
    "of the mean of batches of periods where it does not",
    seconds_a_cell=5e-3,
    defaults={"max_periods": PERIODS},
    course=_trajectory,
)
