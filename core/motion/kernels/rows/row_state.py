"""The state of a row, and the columns of its cells and results."""

import math
from collections import namedtuple
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.compiled import borrowing, compiled
from vibrafeed.core.motion.kernels.inputs import Floats
from vibrafeed.core.motion.kernels.sine_sums import WaveColumns, wave_columns

Whole = NDArray[np.int64]

Head = namedtuple(
    "Head",
    "drive_number_along drive_number_normal gravity_number_along gravity_number_normal "
    "part_restitution max_periods stop stop_gap room parts",
)
"""The first columns of a cell; `stop` is one of the three below."""

Own = namedtuple("Own", "static kinetic mass gap")
"""Numbers of each part behind those columns: frictions, mass and the gap in front of it, each with
room for the longest row of a study. A wave stands at the end (`sine_sums.WaveColumns`)."""

AT, OWN = Head(*range(len(Head._fields))), Own(*range(len(Own._fields)))
HEAD = len(AT)

NO_STOP, ON_TRACK, IN_SPACE = range(3)
"""What holds the row in front: nothing, a stop that moves with the track, one at rest in space."""

RowColumns = namedtuple(
    "RowColumns",
    "velocity spread error platoons slowest fastest contact collisions impact flight multiple "
    "gap stop_force stop_peak stop_impulse stop_contact",
)
"""One column a field of `vibrafeed.core.motion.methods.rows.RowMotion`, in its order. The velocity
of each part follows, then the number of its platoon from the rear, each with room as in a cell."""

COLUMN = RowColumns(*range(len(RowColumns._fields)))
ROW_COLUMNS = len(RowColumns._fields)

Tally = namedtuple("Tally", "closed air hits lost pressed struck peak held moving")
"""Of a period: phase times closed contacts, phase in the air, collisions, the energy they took; of
the stop impulse without and with strokes, largest force, phase in touch; phase in motion."""

TALLY = Tally(*range(len(Tally._fields)))
TALLIES = len(TALLY)

Air = namedtuple("Air", "landing impulse")
"""The phase until all parts land, inf on the floor, and the impulse per mass with which they do."""

ON_FLOOR = Air(math.inf, 0.0)  # the flight of parts that are on the floor


class Drive(NamedTuple):
    """Push and load per weight: c sin(tau) + level - gs along, gn - s sin(tau) onto the floor.

    c and s are the pushes, gs and gn gravity; `ends` are the phases at which the steps of the drive
    end, `levels` what each adds to the push.
    """

    push_along: float
    push_normal: float
    gravity_along: float
    gravity_normal: float
    ends: Floats
    levels: Floats


class Row(NamedTuple):
    """Parts from the rear to the front: their numbers, their state, and room for the work.

    `closed[i]` is 1 where part i touches the one in front of it and both have the same velocity: a
    flag, because rounding would decide a test of gap and velocities. `gap` is in g/w^2, `speed` in
    g/w, relative to the track. `push_factor` and `pull` are C and k of u' = C sin(tau) - k. `mode`
    is 1 for parts that slide forward, -1 backward, 0 at rest. A stop is a last part of infinite
    mass.
    """

    mass: Floats
    static: Floats
    kinetic: Floats
    gap: Floats
    speed: Floats
    place: Floats
    push_factor: Floats
    pull: Floats
    mode: Whole
    closed: Whole
    value: Floats
    weight: Floats
    last: Whole
    stop: int


@borrowing
def own_column(cell: Floats, number: int) -> int:
    """Return the first column of a number of each part; behind the last of `Own`, of the wave."""
    return HEAD + number * int(cell[AT.room])


@compiled
def own_numbers(cell: Floats, number: int, count: int) -> Floats:
    """Return a copy of a number of the first parts of a cell."""
    start = own_column(cell, number)
    return cell[start : start + count].copy()


@borrowing
def columns_of(cell: Floats) -> WaveColumns:
    """Return the columns of the wave of a cell."""
    return wave_columns(cell, own_column(cell, len(OWN)))


@compiled
def drive_of(cell: Floats) -> Drive:
    """Return the drive of a cell with a row of parts; a sine has one step of level 0."""
    columns = columns_of(cell)
    ends, levels = np.array([2 * np.pi]), np.zeros(1)
    if columns.steps > 0:
        ends = cell[columns.ends : columns.ends + columns.steps].copy()
        levels = cell[columns.levels : columns.levels + columns.steps].copy()
    return Drive(
        cell[AT.drive_number_along], cell[AT.drive_number_normal], cell[AT.gravity_number_along],
        cell[AT.gravity_number_normal], ends, levels,
    )  # fmt: skip


@compiled
def row_at(cell: Floats, backward: float) -> Row:
    """Return the parts of a row at rest on the track, as the state from which they are followed."""
    stop, parts = int(cell[AT.stop]), int(cell[AT.parts])
    static, kinetic = own_numbers(cell, OWN.static, parts), own_numbers(cell, OWN.kinetic, parts)
    mass = own_numbers(cell, OWN.mass, parts)
    contacts, bodies = parts - 1, parts
    if stop != NO_STOP:
        contacts, bodies = parts, parts + 1
    gap = own_numbers(cell, OWN.gap, contacts)
    speed = np.zeros(bodies)
    if stop != NO_STOP:
        gap[parts - 1] = cell[AT.stop_gap]
    if stop == IN_SPACE:
        speed[parts] = backward
    closed = np.zeros(contacts, dtype=np.int64)
    for i in range(contacts):
        closed[i] = 1 if gap[i] == 0.0 and speed[i] == speed[i + 1] else 0
    return Row(
        mass, static, kinetic, gap, speed, np.zeros(parts), np.zeros(bodies),
        np.zeros(bodies), np.zeros(parts, dtype=np.int64), closed, np.zeros(parts),
        np.zeros(parts), np.zeros(parts, dtype=np.int64), stop,
    )  # fmt: skip


@compiled
def backward_speed(drive: Drive) -> float:
    """Return the velocity relative to the track, at phase 0, of a body at rest in space.

    In g/w: w with w' = c sin(tau) + level of the step, and without mean over a period.
    """
    start, velocity, mean = 0.0, 0.0, 0.0
    for step in range(drive.ends.size):
        span = drive.ends[step] - start
        mean += velocity * span + drive.levels[step] * span * span / 2.0
        velocity += drive.levels[step] * span
        start = drive.ends[step]
    return -drive.push_along - mean / start
