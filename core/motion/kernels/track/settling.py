"""From rest until the motion repeats: the map of one period of the drive onto the next.

Slow maps are sped up by Anderson's mixing of the last periods; only between periods of the same
events, and near the end, since a jump may else land on another motion, or on one that repels. After
a few jumps in vain the part is followed again without any: no mean is taken over moved states.
"""

import math
from typing import NamedTuple

import numpy as np

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.constants import STATUS, TALLY
from vibrafeed.core.motion.kernels.inputs import Cell, Flags, Floats, Stop, cell_of, copy
from vibrafeed.core.motion.kernels.means import wall_gap
from vibrafeed.core.motion.kernels.track import push
from vibrafeed.core.motion.kernels.track.advance import advance
from vibrafeed.core.motion.kernels.track.push import HOLD, STATE, Work, at_rest

MAX_MULTIPLE = 32
"""Periods of a cycle, as many as `reference` and the hops of the plane look for."""
APART, APART_AT_MOST = 1e4, 1e-5
"""In tolerances, and in the drive's speed: states of a cycle that are nearer come closer slowly."""
NEAR = 0.02
"""In the drive's speed: the change over a period below which mixing starts."""
SHRINKS = 0.97
"""Ratio by which the change over a period must fall between two plain periods before a jump."""
LONG = 32
"""Periods after which slower falls count, and now and then nearly equal states."""
SHRINKS_AT_ALL = 0.9999  # the same ratio after `LONG` periods without an end
NOISE = 20.0
"""In tolerances of a term: two equal states may differ by so much, as their steps fall
differently."""
MAX_JUMPS = 16
"""Most jumps of a run; most motions that repeat take three, one in 1,000 takes ten."""
FADES = 0.1
"""A cycle is being neared whose changes fall to this share over the last quarter of all periods."""
DEPTH = 3  # most differences of periods in Anderson's mixing
LARGEST_WEIGHT = 200.0  # of a difference in the mixing: larger ones predict nothing
INDEPENDENT = 1e-6  # relative size of what a difference adds to those before; less is rounding
NO_PHASES = np.zeros(0)  # phases of samples, where none are asked for


class History(NamedTuple):
    """States at the starts and ends of periods of the drive, and what happened in each.

    `starts` and `ends`, shape (periods + 1, 7), differ where a jump of the iteration came between;
    `holds` are at the starts. `stop` is a flag, looked at between periods, that ends the work.
    """

    starts: Floats
    ends: Floats
    tallies: Floats
    holds: Flags
    stop: Stop


class Series(NamedTuple):
    """The settings by which a cell is followed: order of the series, relative tolerance."""

    order: int
    tolerance: float


class Settled(NamedTuple):
    """The way in which a cell came to repeat.

    `multiple` are the periods after which it repeats, 0 if it does not; `done` those followed;
    `left` the distance of the state from its limit that may be left, in g/w.
    """

    status: int
    multiple: int
    done: int
    left: float


@compiled
def new_history(most: int, stop: Stop) -> History:
    """Return buffers for the states and sums of `most` periods of a motion, not yet filled."""
    return History(
        np.empty((most + 1, len(STATE))), np.empty((most + 1, len(STATE))),
        np.empty((most + 1, len(TALLY))), np.empty((most + 1, len(HOLD)), dtype=np.int64),
        stop,
    )  # fmt: skip


@compiled
def apart(wall: bool, rolling: float, history: History, later: int, earlier: int) -> float:
    """Return the distance between two states of a motion, 0 where it repeats, in units of g and w.

    The largest of |dz|, |du_x|, |du_z|, |du_y + dspin| and `wall_gap` between the end of period
    `later` and the start of period `earlier`.
    """
    new, old = history.ends[later], history.starts[earlier]
    most = max(
        abs(new[STATE.z] - old[STATE.z]),
        abs(new[STATE.ux] - old[STATE.ux]),
        abs(new[STATE.uz] - old[STATE.uz]),
    )
    across = new[STATE.uy] - old[STATE.uy]
    if rolling > 0.0:
        across += new[STATE.spin] - old[STATE.spin]
    most = max(most, abs(across))
    if wall:
        away = new[STATE.y] - old[STATE.y]
        most = max(most, wall_gap(history.tallies, earlier, later + 1, away))
    return most


@compiled
def repeats(
    wall: bool, rolling: float, history: History, last: int, since: int, close: float,
    parted: float,
) -> int:  # fmt: skip
    """Return the number of periods after which the motion repeats, 0 if it does not.

    The first m <= 32 with states apart by at most `close`; 0 if a divisor of m nearly repeats, by
    less than `parted`: the shorter cycle may not have settled yet.
    """
    ends, starts, column = history.ends, history.starts, STATE.ux
    for multiple in range(1, min(MAX_MULTIPLE, last - since + 1) + 1):
        if abs(ends[last, column] - starts[last - multiple + 1, column]) > close:
            continue  # as most are: told apart by one number
        if apart(wall, rolling, history, last, last - multiple + 1) > close:
            continue
        for part in range(1, multiple):
            near = multiple % part == 0
            if near and apart(wall, rolling, history, last, last - part + 1) < parted:
                return 0
        return multiple
    return 0


@compiled
def remaining(
    wall: bool, rolling: float, history: History, last: int, multiple: int, since: int
) -> float:
    """Return an estimate of the distance of a state from that of the repeating motion, in g/w.

    d/(1 - q), q = d/d0 at most 0.999, with the change d over the last cycle and d0 over the one
    before; d alone if that began before period `since`, the last jump of the iteration (theory
    13.13).
    """
    change = apart(wall, rolling, history, last, last - multiple + 1)
    if last - 2 * multiple + 1 < since or change == 0.0:
        return change
    before = apart(wall, rolling, history, last - multiple, last - 2 * multiple + 1)
    ratio = min(change / before, 0.999) if before > 0.0 else 0.0
    return change / (1.0 - ratio)


@compiled
def follow_period(
    cell: Cell, wall: bool, rolling: float, series: Series, period: int, state: Floats, hold: Flags,
    history: History, work: Work,
) -> bool:  # fmt: skip
    """Follow a cell for one more period and record it in `history`; False if that fails."""
    state[STATE.x] = 0.0
    history.starts[period], history.holds[period] = state, hold
    fine = advance(
        cell, wall, rolling, series.order, series.tolerance * push.size(work), state, hold,
        history.tallies[period], work, NO_PHASES, history.starts[:0], state[:0],
    )  # fmt: skip
    history.ends[period] = state
    return fine and bool(np.all(np.isfinite(state)))


@compiled
def settle(
    cell: Cell, wall: bool, rolling: float, series: Series, most: int, state: Floats, hold: Flags,
    history: History, work: Work,
) -> Settled:  # fmt: skip
    """Follow a cell until its motion repeats, or for `most` periods; return how it repeats."""
    start, start_hold = state.copy(), hold.copy()
    near = APART_AT_MOST * push.size(work)
    settled, most_jumps = Settled(STATUS.aperiodic, 0, 0, math.inf), MAX_JUMPS
    for _ in range(3):
        settled, jumps = approach(
            cell, wall, rolling, series, most, most_jumps, state, hold, history, work
        )
        if settled.status != STATUS.aperiodic:
            return settled
        most_jumps = 0
        if jumps > 0:
            state[:], hold[:] = start, start_hold
            continue
        settled = neared(wall, rolling, history, settled.done, near)
        if settled.multiple == 0:
            return settled
    return settled


@compiled
def to_cycle(
    row: Floats, wall: bool, rolling: float, series: Series, history: History, work: Work
) -> tuple[Settled, Floats, Flags]:
    """Follow a cell from rest until it repeats; return how, and state and contacts there."""
    cell = cell_of(row)
    push.set_drive(cell, row, work)
    state, hold = at_rest()
    most = int(cell.max_periods)
    settled = settle(cell, wall, rolling, series, most, state, hold, history, work)
    if settled.multiple > 0:
        first = settled.done - settled.multiple
        state, hold = history.starts[first].copy(), history.holds[first].copy()
    return settled, state, hold


@compiled
def neared(wall: bool, rolling: float, history: History, done: int, near: float) -> Settled:
    """Return the period of a motion that approaches a cycle slowly, as the record `Settled`.

    The change over a cycle must have fallen to less than a tenth within the last L cycles: with the
    ratio q = (d/d0)^(1/L) the state is still off by d q/(1 - q), which must be less than `near`
    (theory 13.13).
    """
    for multiple in range(1, min(MAX_MULTIPLE, done // 8) + 1):
        cycles = done // 4 // multiple
        change = apart(wall, rolling, history, done - 1, done - multiple)
        if change >= near:
            continue
        last = done - 1 - cycles * multiple
        before = apart(wall, rolling, history, last, last - multiple + 1)
        if change >= FADES * before:
            continue
        ratio = (change / before) ** (1.0 / cycles)
        left = change * ratio / (1.0 - ratio)
        if left < near:
            return Settled(STATUS.periodic, multiple, done, left)
    return Settled(STATUS.aperiodic, 0, done, math.inf)


@compiled
def approach(
    cell: Cell, wall: bool, rolling: float, series: Series, most: int, most_jumps: int,
    state: Floats, hold: Flags, history: History, work: Work,
) -> tuple[Settled, int]:  # fmt: skip
    """Follow a cell until it repeats, within limits; return how it repeats, and jumps used."""
    speed = push.size(work)
    close = cell.tolerance * speed
    since, shrank, jumps = 0, 0, 0
    for period in range(most):
        if raised(history.stop):
            return Settled(STATUS.limit_reached, 0, period, math.inf), jumps
        tally = history.tallies[period]
        if not follow_period(cell, wall, rolling, series, period, state, hold, history, work):
            return Settled(STATUS.limit_reached, 0, period + 1, math.inf), jumps
        moves = tally[TALLY.forward] + tally[TALLY.backward] + tally[TALLY.flight]
        # A slip straight across counts to neither way along the track.
        if moves == 0.0 and tally[TALLY.across] == 0.0 and rolling == 0.0:
            return Settled(STATUS.at_rest, 1, period + 1, 0.0), jumps
        patient = period % LONG == LONG - 1
        near = max(close, NOISE * series.tolerance * speed) if patient else close
        parted = max(near, min(APART * near, APART_AT_MOST * speed))
        multiple = repeats(wall, rolling, history, period, since, near, parted)
        if multiple > 0:
            left = remaining(wall, rolling, history, period, multiple, since)
            return Settled(STATUS.periodic, multiple, period + 1, left), jumps
        if period == 0 or period <= since or most_jumps == 0:
            continue
        change, before = step_size(wall, history, period), step_size(wall, history, period - 1)
        alike = same_events(history, period, period - 1)
        shrinks = SHRINKS if period - since < LONG else SHRINKS_AT_ALL
        shrank = shrank + 1 if alike and change < shrinks * before else 0
        if shrank < 2 or change >= NEAR * speed:
            continue
        if jumps == most_jumps:
            return Settled(STATUS.aperiodic, 0, period + 1, math.inf), jumps
        if jump(wall, history, period, since, state):
            since, shrank, jumps = period + 1, 0, jumps + 1
    return Settled(STATUS.aperiodic, 0, most, math.inf), jumps


@compiled
def same_events(history: History, first: int, second: int) -> bool:
    """True if two periods had the same events in the same order: their event hashes are equal."""
    tallies = history.tallies
    return bool(tallies[first, TALLY.signature] == tallies[second, TALLY.signature])


@compiled
def first_coordinate(wall: bool, history: History, period: int) -> int:
    """Return the first column of the state that takes part in Anderson's mixing."""
    touched = wall and history.tallies[period, TALLY.at_wall] > 0.0
    return STATE.y if touched else STATE.z


@compiled
def step_size(wall: bool, history: History, period: int) -> float:
    """Return the largest change of a state over a period, max |end - start|, in g/w and g/w^2."""
    most = 0.0
    for i in range(first_coordinate(wall, history, period), len(STATE)):
        most = max(most, abs(history.ends[period, i] - history.starts[period, i]))
    return most


@compiled
def jump(wall: bool, history: History, last: int, since: int, state: Floats) -> bool:
    """Move the state to where the motion is predicted to repeat; False if there is no prediction.

    Weights minimise |f_last - sum of weights times differences of f| of the residuals f = end -
    start of periods with equal events; the new state is the same combination of the ends.
    """
    depth = 0
    while depth < min(DEPTH, last - since) and same_events(history, last - depth - 1, last):
        depth += 1
    first, columns = first_coordinate(wall, history, last), len(STATE)
    weights, used = mixing_weights(history, last, depth, first)
    if used == 0:
        return False
    for i in range(first, columns):
        value = history.ends[last, i]
        for j in range(used):
            value -= weights[j] * (history.ends[last - j, i] - history.ends[last - j - 1, i])
        state[i] = value
    if state[STATE.z] < 0.0 or (wall and state[STATE.y] < 0.0):
        copy(history.ends[last], state)
        return False
    return True


@compiled
def mixing_weights(history: History, last: int, depth: int, first: int) -> tuple[Floats, int]:
    """Return the weights by which a slow transient is extrapolated, and how many are in use.

    Least squares by modified Gram and Schmidt, Q R w = f_last; 0 are in use if a weight is too
    large.
    """
    columns = len(STATE)
    basis, triangle, weights = np.zeros((DEPTH, columns)), np.zeros((DEPTH, DEPTH)), np.zeros(DEPTH)
    residual = history.ends[last] - history.starts[last]
    used = 0
    for j in range(depth):
        row = history.ends[last - j] - history.starts[last - j]
        row -= history.ends[last - j - 1] - history.starts[last - j - 1]
        row[:first] = 0.0
        size = np.sum(row * row)
        for other in range(j):
            triangle[other, j] = np.sum(basis[other] * row)
            row -= triangle[other, j] * basis[other]
        rest = np.sum(row * row)
        if not rest > INDEPENDENT**2 * size:
            break
        triangle[j, j] = math.sqrt(rest)
        basis[j] = row / triangle[j, j]
        used += 1
    for j in range(used - 1, -1, -1):
        dot = np.sum(basis[j] * residual)
        for other in range(j + 1, used):
            dot -= triangle[j, other] * weights[other]
        weights[j] = dot / triangle[j, j]
        if not abs(weights[j]) < LARGEST_WEIGHT:
            return weights, 0
    return weights, used
