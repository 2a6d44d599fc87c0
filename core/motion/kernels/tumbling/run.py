"""Start, records and results of a run of a tumbling part."""

from __future__ import annotations

from typing import NamedTuple

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Floats, copy
from vibrafeed.core.motion.kernels.statuses import STATUS
from vibrafeed.core.motion.kernels.tumbling.geometry import (
    corner_at,
    corner_count,
    lowest_gap,
    side_below,
)
from vibrafeed.core.motion.kernels.tumbling.tables import COLUMN, FLAT, PATH, STATE, Cell

MAX_STEPS = 20_000_000
"""Of a cell: 400 s of motion at 50 Hz and 1,000 steps a period, where all parts have long
settled."""


class TumblingRun(NamedTuple):
    """The results of a run besides its state, as the columns of its table follow `Tumble`.

    Times in s, `largest_bounce` in m; `side` is the number of the side that lies flat, 0 if none.
    """

    status: int
    time: float
    settling_time: float
    impacts: int
    largest_bounce: float
    side: int


@compiled
def start_of(cell: Cell, state: Floats) -> None:
    """Set the state of a tumbling part to the start of its run, from the numbers of the cell.

    `state` (columns of `STATE`, SI) gets pitch, pitch rate, velocities, and the height of the
    centre y = rho max sin s + gap, with the half diagonal rho, the angles s of the corners below
    the centre, and the gap between the lowest corner and the plane.
    """
    state[:] = 0.0
    state[STATE.pitch], state[STATE.pitch_rate] = cell.pitch, cell.pitch_rate
    state[STATE.along_rate], state[STATE.up_rate] = cell.velocity_along, cell.velocity_upward
    lowest = 0.0
    for corner in range(corner_count(cell)):
        s, _ = corner_at(cell, corner, cell.pitch)
        lowest = max(lowest, s)
    state[STATE.up] = cell.half_diagonal * lowest + cell.gap_normal


@compiled
def record(cell: Cell, state: Floats, time: float, support: int, row: Floats) -> None:
    """Write time, state, lowest gap and touching corners of a part into a row of its path.

    `row` has the columns of `PATH` and `state` those of `STATE` (SI), `time` is in s; `support` is
    what carries the part: a corner's number, `FLAT` for a side with two corners, or `FREE`.
    """
    row[:] = 0.0
    row[PATH.time] = time
    copy(state, row[PATH.state : PATH.gap])
    row[PATH.gap] = lowest_gap(cell, state)
    if support >= 0:
        row[PATH.touching + support] = 1.0
    elif support == FLAT:
        quarter_turns = side_below(state[STATE.pitch])
        row[PATH.touching + (-quarter_turns) % 4] = 1.0
        row[PATH.touching + (1 - quarter_turns) % 4] = 1.0


@compiled
def record_until(
    cell: Cell, state: Floats, time: float, support: int, times: Floats, written: int, rows: Floats
) -> int:  # fmt: skip
    """Write the state of a tumbling part into the rows of all wanted times up to `time` (s).

    `times` are ascending in s, of which the first `written` are done; the new number is returned.
    `rows` have the columns of `PATH`. `support` is what carries the part: a corner's number, `FLAT`
    or `FREE`.
    """
    while written < times.size and times[written] <= time:
        record(cell, state, times[written], support, rows[written])
        written += 1
    return written


@compiled
def record_rest(
    cell: Cell, state: Floats, support: int, times: Floats, written: int, rows: Floats
) -> None:  # fmt: skip
    """Write the final state into the rows of all wanted times that are left, from `written` on."""
    for row in range(written, times.size):
        record(cell, state, times[row], support, rows[row])


@compiled
def side_of(cell: Cell, support: int, pitch: float) -> int:
    """Return the number of the side that lies flat, 1 to 4; 0 if none does, 1 for a ball.

    `support` is a corner's number, `FLAT` or `FREE`; `pitch` in rad.
    """
    if support == FLAT:
        return side_below(pitch) % 4 + 1
    return 1 if support >= 0 and cell.turning == 0.0 else 0


@compiled
def fill(cell: Cell, run: TumblingRun, state: Floats, row: Floats) -> None:
    """Write the results of the run of a tumbling part into its row of the table.

    `row` has the columns of `COLUMN`: pitch and side at the end, settling time, impacts, largest
    bounce, mean velocity, energy lost per mass. `state` (columns of `STATE`, SI) is that at the
    end. A part that settled has its mean velocity over the whole duration.
    """
    row[COLUMN.pitch] = state[STATE.pitch]
    row[COLUMN.resting_side] = run.side
    row[COLUMN.settling_time] = run.settling_time
    row[COLUMN.impacts] = run.impacts
    row[COLUMN.largest_bounce] = run.largest_bounce
    elapsed = cell.duration if run.status == STATUS.settled else run.time
    row[COLUMN.velocity] = state[STATE.along] / elapsed if elapsed > 0.0 else 0.0
    row[COLUMN.energy_lost] = state[STATE.lost]
