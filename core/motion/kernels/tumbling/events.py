"""A run from impact to impact."""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Floats, Stop, copy
from vibrafeed.core.motion.kernels.statuses import STATUS
from vibrafeed.core.motion.kernels.tumbling.carry import carry
from vibrafeed.core.motion.kernels.tumbling.geometry import (
    corner_count,
    gap_of,
    gap_rate_of,
    lowest_gap,
    lowest_rate,
)
from vibrafeed.core.motion.kernels.tumbling.impact import strike
from vibrafeed.core.motion.kernels.tumbling.run import (
    MAX_STEPS,
    TumblingRun,
    record_rest,
    record_until,
    side_of,
    start_of,
)
from vibrafeed.core.motion.kernels.tumbling.support import choose, holds, rests_for_ever
from vibrafeed.core.motion.kernels.tumbling.tables import FLAT, FREE, OVERLAP, PARADOX, STATE, Cell

EVENTS, EVENTS_A_STEP = 20_000, 20  # most events of a run: so many, and so many more a step
STEPS_MORE = 50
"""Factor of the largest number of steps, which are shorter where the part turns fast."""
HALVINGS = 60  # most steps of the search for the end of a support
TOP_HALVINGS = 40  # of the time of a hop's top: its height is then off by a rounding
LARGEST_TURN = 0.1  # rad a step, so that no corner swings down and up again unseen


@compiled
def top_of(
    cell: Cell, support: int, state: Floats, after: Floats, time: float, step: float, trial: Floats
) -> float:  # fmt: skip
    """Return the largest height in m of the lowest corner of a tumbling part within a step.

    From `state` at `time` in s to `after`, `step` seconds later; in free flight where the velocity
    of the lowest corner falls through 0, by halving. So the largest bounce is found. `support` is
    what carries the part: a corner's number, `FLAT` or `FREE`; `trial` is a work array.
    """
    top = max(lowest_gap(cell, state), lowest_gap(cell, after))
    if support != FREE or lowest_rate(cell, state) <= 0.0 or lowest_rate(cell, after) >= 0.0:
        return top
    low, high = 0.0, step
    for _ in range(TOP_HALVINGS):
        middle = (low + high) / 2
        carry(cell, support, 0, state, time, middle, trial)
        if lowest_rate(cell, trial) > 0.0:
            low = middle
        else:
            high = middle
    return max(top, lowest_gap(cell, trial))


@compiled
def dips(
    cell: Cell, support: int, sigma: int, state: Floats, time: float, step: float, after: Floats,
    trial: Floats,
) -> float:  # fmt: skip
    """Return the time in s within a step at which a corner dips into the plane; else `step`.

    Such a corner may be above the plane at both ends of the step: it sinks in `state`, at the
    start, and rises in `after`, at the end. Its lowest point is taken where the line between both
    velocities off the plane is 0, and the motion is carried to there into the work array `trial`.

    `support` is what carries the part (a corner's number, `FLAT` or `FREE`), `sigma` its direction
    of slip (1, -1; 0 if held), `time` the start of the step and `step` its length in s. Both states
    have the columns of `STATE` (SI).
    """
    if support == FLAT:
        return step
    for corner in range(corner_count(cell)):
        sinking, rising = gap_rate_of(cell, state, corner), gap_rate_of(cell, after, corner)
        if corner != support and sinking < 0.0 < rising:
            part = step * sinking / (sinking - rising)
            carry(cell, support, sigma, state, time, part, trial)
            if gap_of(cell, trial, corner) < -OVERLAP * cell.half_diagonal:
                return part
    return step


@compiled
def first_misfit(
    cell: Cell, support: int, sigma: int, state: Floats, time: float, step: float, after: Floats,
    trial: Floats,
) -> float:  # fmt: skip
    """Return the time in s within a step at which the support of a tumbling part ceases to fit.

    `state` at `time` fits, `after`, `step` seconds later, does not; `after` is set to the state at
    that time. `support` is what carries the part (a corner's number, `FLAT` or `FREE`), `sigma` its
    direction of slip (1, -1; 0 if held); `trial` is a work array. A corner that falls on the plane
    is followed back by Newton's method, which approaches from below a path that bends down;
    everything else is halved.
    """
    overlap = OVERLAP * cell.half_diagonal
    low, part, halve = 0.0, step, False
    for _ in range(HALVINGS):
        guess = (low + part) / 2
        deepest, falling = -overlap, -1
        for corner in range(corner_count(cell)):
            gap = gap_of(cell, after, corner)
            if corner != support and gap < deepest:
                deepest, falling = gap, corner
        at_plane = falling >= 0 and deepest >= -1.5 * overlap
        if part - low <= (1e-9 if at_plane else 1e-12 if falling < 0 else 0.0) * step:
            break
        if at_plane:  # was the corner the first? just before, everything has to fit
            guess = max(guess, part - 1e-9 * step)
        elif falling >= 0:
            rate = gap_rate_of(cell, after, falling)
            if rate < 0.0 and not halve:
                back = part - (deepest + overlap) / rate
                if low < back < part:
                    guess = back
        if guess in (low, part):
            break
        carry(cell, support, sigma, state, time, guess, trial)
        halve = holds(cell, support, sigma, trial, time + guess)
        if halve:
            low = guess
        else:
            part = guess
            copy(trial, after)
    return part


@compiled
def end_of_step(cell: Cell, state: Floats, time: float, times: Floats, written: int) -> float:
    """Return the end in s of the next time step of a tumbling part that starts at `time`.

    Limited by the step of `cell`, the duration of the run, the next time at which the state is
    wanted (`times`, of which `written` are done), and 0.1 rad of pitch. `state` has the columns of
    `STATE` (SI).
    """
    end, pitch_rate = min(time + cell.time_step, cell.duration), state[STATE.pitch_rate]
    if written < times.size:
        end = min(end, times[written])
    if abs(pitch_rate) * (end - time) > LARGEST_TURN:
        return time + LARGEST_TURN / abs(pitch_rate)
    return end


@compiled
def run_events(cell: Cell, state: Floats, times: Floats, rows: Floats, stop: Stop) -> TumblingRun:
    """Simulate one tumbling part from event to event; return the record of its run.

    A step on one support (corner, side or none) is integrated, and cut where that support ceases to
    fit; then follow impacts and the choice of the next support, until the part rests for good or
    its duration ends (theory 13.11).

    `cell` holds the part's numbers (SI). `state` (columns of `STATE`) is set to that at the end;
    `rows` (columns of `PATH`) are filled at the ascending `times` in s; `stop` is a flag that ends
    the work. The record has the status, times, impacts, largest bounce, and the side that lies on
    the plane.
    """
    after, trial = np.empty_like(state), np.empty_like(state)
    start_of(cell, state)
    time, settling, bounce = 0.0, np.nan, 0.0
    impacts = events = written = 0
    status = STATUS.limit_reached
    if strike(cell, state, after):
        impacts = 1
    support, sigma = choose(cell, state, time)
    steps = math.ceil(min(cell.duration / cell.time_step, MAX_STEPS))
    most_events = EVENTS + EVENTS_A_STEP * steps
    steps_left = min(1000 + STEPS_MORE * steps, MAX_STEPS) + times.size
    while True:
        written = record_until(cell, state, time, support, times, written, rows)
        if support == PARADOX:
            status = STATUS.no_solution
            break
        if rests_for_ever(cell, support, sigma, state):
            status, settling = STATUS.settled, time
            break
        if time >= cell.duration:
            status = STATUS.moving
            break
        if steps_left <= 0 or events >= most_events or raised(stop):
            break
        steps_left -= 1
        end = end_of_step(cell, state, time, times, written)
        step = end - time
        carry(cell, support, sigma, state, time, step, after)
        part = dips(cell, support, sigma, state, time, step, after, trial)
        fits = part == step and holds(cell, support, sigma, after, end)
        if not fits:
            if part != step:
                carry(cell, support, sigma, state, time, part, after)
            part = first_misfit(cell, support, sigma, state, time, part, after, trial)
        if impacts > 0:
            bounce = max(bounce, top_of(cell, support, state, after, time, part, trial))
        copy(after, state)
        time = end if part == step else time + part
        if fits:
            continue
        events += 1
        if strike(cell, state, after):
            impacts += 1
        support, sigma = choose(cell, state, time)
    if status in (STATUS.settled, STATUS.moving) or time >= cell.duration:
        record_rest(cell, state, support, times, written, rows)
    return TumblingRun(
        status, time, settling, impacts, bounce, side_of(cell, support, state[STATE.pitch])
    )
