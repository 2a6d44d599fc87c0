"""The landings of runs of a motion that rounding decides, which many cells have in common.

The motion normal to the floor knows nothing of friction, nor of the drive along the track: cells
with the same drive and gravity normal to the floor and the same rebound land at the same times.
To find a landing takes nine times as long as to follow the slip from it to the next. So the
landings of the last such motion are kept, and a cell that has the same goes through them again.
"""

from __future__ import annotations

import math
from collections import namedtuple

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Floats, Stop
from vibrafeed.core.motion.kernels.planar.chaos import (
    HOPS_PER_PERIOD,
    MAX_STARTS,
    PHASES,
    SEARCHES,
    SETTLED_ROUGHLY,
    first_flight,
    jolted,
)
from vibrafeed.core.motion.kernels.planar.cycle import (
    FIRST_LOOK,
    LONGEST_CYCLE,
    find_cycle,
    is_owned,
    write_segment,
)
from vibrafeed.core.motion.kernels.planar.drive import (
    Drive,
    air_swings,
    hop_height,
    landing,
    lift_off,
    rise,
    to_lift_off,
)
from vibrafeed.core.motion.kernels.planar.flow import TURN
from vibrafeed.core.motion.kernels.planar.rebound import Restitution, impulse, rebound
from vibrafeed.core.motion.kernels.planar.stays import rests
from vibrafeed.core.motion.kernels.planar.tables import MAX_SEGMENTS, PIECE, SEGMENT, SUMS

APART = 1e6
"""Times the jolt of a lift-off from rest, by which runs start: at once they go different ways.

Those of `chaos` agree up to there in eight digits, and take tens of periods to lose them: so early
their scatter tells nothing of the error.
"""
HOP_CAPACITY = MAX_SEGMENTS // PHASES  # rows for a run's hops since the part was at rest
FIRST_ROOM = (
    256  # landings of each run for which there is room at first; it doubles when it is full
)
ON_ITS_WAY, ENDED = 0.0, 1.0
"""Whether more landings of a run can be found."""

Landing = namedtuple("Landing", "phase span speed rebound stays fastest highest swing sway")
"""Columns of the landings of a run, a row a landing, of the flight that ends there.

`phase` and `span` of the flight in rad, `speed` of the landing and `rebound` in g/w (w = 2 pi f);
`stays` is 1 if the part then stays on the floor until its lift-off, else 0. `fastest` and `highest`
are the largest landing speed and height in g/w^2 of the run so far; `swing` and `sway` are the
flight's `air_swings`.
"""

Normal = namedtuple("Normal", "phase rebound time landings hops look jolt ended")
"""Columns of the state of a run normal to the floor: what it goes on from.

`landings` so far, `hops` since the last rest, of which `look` is when a cycle is looked for next.
"""

Landings = namedtuple("Landings", "owner states segments tables")
"""What is kept: of which motion (`owner`), and of each run its state, its hops, its landings.

`owner` has the numbers of `normal_numbers`, the rebound law and the phase at the start, shape (5,);
`states` the columns of `Normal`, shape (8, 8); `segments` those of `SEGMENT`, for the runs that
look for cycles, shape (3, capacity, 5); `tables` those of `Landing`, shape (8, room, 9).
"""

LANDING, NORMAL = Landing(*range(len(Landing._fields))), Normal(*range(len(Normal._fields)))


@compiled
def no_landings() -> Landings:
    """Return room for the landings of eight runs, which belong to no motion yet."""
    return Landings(
        np.full(5, math.nan),
        np.zeros((PHASES, len(NORMAL))),
        np.empty((SEARCHES, HOP_CAPACITY, len(SEGMENT))),
        np.zeros((PHASES, FIRST_ROOM, len(LANDING))),
    )


@compiled
def belong_to(landings: Landings, drive: Drive, e: Restitution, phase: float) -> None:
    """Make `landings` those of a motion: kept if they are, else begun with its first lift-offs.

    `phase` in rad is the study's own start. Landings of waves are begun for each cell.
    """
    if is_owned(landings.owner, drive, e, phase):
        return
    sums, no_log = np.zeros(SUMS), np.empty((0, len(PIECE)))
    landings.states[:] = 0.0
    landings.tables[:, 0] = 0.0
    for number in range(PHASES):
        state = landings.states[number]
        _, w, tau, time, _ = first_flight(number, phase, drive, sums, no_log)
        state[NORMAL.phase], state[NORMAL.rebound], state[NORMAL.time] = tau, w * APART, time
        state[NORMAL.look], state[NORMAL.jolt] = FIRST_LOOK, number


@compiled
def with_room(landings: Landings) -> Landings:
    """Return the same landings with room for twice as many."""
    room = landings.tables.shape[1]
    tables = np.empty((PHASES, 2 * room, len(LANDING)))
    tables[:, :room] = landings.tables
    return Landings(landings.owner, landings.states, landings.segments, tables)


@compiled
def write_landing(
    row: Floats, largest: Floats, drive: Drive, e: Restitution, tau: float, w: float, span: float
) -> None:
    """Write into `row` (columns of `LANDING`) the landing after a flight of `span` rad.

    The part takes off at phase `tau` with velocity `w` in g/w (w = 2 pi f); `largest` are the
    fastest landing and the greatest height so far, shape (2,).
    """
    speed = max(0.0, -rise(drive, w, tau, span)[0])
    up = rebound(e, speed)[0]
    row[LANDING.fastest] = max(largest[0], speed)
    row[LANDING.highest] = hop_height(drive, w, tau, span, largest[1])
    row[LANDING.phase], row[LANDING.span] = tau, span
    row[LANDING.speed], row[LANDING.rebound] = speed, up
    stays = rests(drive, (tau + span) % TURN, up, e, SETTLED_ROUGHLY)
    row[LANDING.stays] = 1.0 if stays else 0.0
    row[LANDING.swing], row[LANDING.sway] = air_swings(drive, tau, span)


@compiled
def land_until(
    landings: Landings, number: int, until: float, drive: Drive, e: Restitution, stop: Stop
) -> bool:
    """Find the landings of run `number` up to the time `until`; False if there is no more room.

    `until` in rad since the start of the run. The part flies under `drive` and rebounds by `e`; its
    state and landings go into `landings`. A run `ended` if it nears a cycle, hops too often, or a
    landing is not found; it does so after the same landing, however far it is followed at a time.
    Only the first `SEARCHES` runs look for a cycle, and leave its last landing to who follows it. A
    part that came to rest takes off anew with a jolt, of another size each time, so that runs
    differ. Raising `stop` interrupts: the result is then True, and the run is not at its end.
    """
    state, table = landings.states[number], landings.tables[number]
    is_searched = number < SEARCHES
    rows = landings.segments[min(number, SEARCHES - 1)]
    tau, w, time = state[NORMAL.phase], state[NORMAL.rebound], state[NORMAL.time]
    landed, count = int(state[NORMAL.landings]), int(state[NORMAL.hops])
    look_at, jolt = int(state[NORMAL.look]), int(state[NORMAL.jolt])
    has_room = True
    while time < until and state[NORMAL.ended] == ON_ITS_WAY:
        has_room = landed < table.shape[0]
        if not has_room or raised(stop):
            break
        span = landing(drive, w, tau)
        if span < 0 or landed > HOPS_PER_PERIOD * time / TURN + FIRST_LOOK:
            state[NORMAL.ended] = ENDED
            break
        row = table[landed]
        write_landing(row, table[max(0, landed - 1), LANDING.fastest :], drive, e, tau, w, span)
        speed, up, stays = row[LANDING.speed], row[LANDING.rebound], row[LANDING.stays] > 0.0
        at = (tau + span) % TURN
        landed += 1
        if is_searched:
            write_segment(rows, count, tau, span, w, speed, impulse(e, speed, up))
        count += 1
        tau, w, time = at, up, time + span
        if stays:
            jolt += MAX_STARTS
            tau, w = lift_off(drive, at), jolted(jolt, drive.gn)
            time += to_lift_off(drive, at)
            count, look_at = 0, FIRST_LOOK
        elif is_searched and count >= look_at:
            look_at = count + count // 2
            if find_cycle(drive, e, rows, count, tau, w)[0]:
                landed -= 1
                state[NORMAL.ended] = ENDED
        if count >= HOP_CAPACITY - LONGEST_CYCLE - 2:
            count, look_at = 0, FIRST_LOOK
    state[NORMAL.phase], state[NORMAL.rebound], state[NORMAL.time] = tau, w, time
    state[NORMAL.landings], state[NORMAL.hops], state[NORMAL.look] = landed, count, look_at
    state[NORMAL.jolt] = jolt
    return has_room
