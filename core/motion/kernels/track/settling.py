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


class Settling(NamedTuple):
    """The way in which a cell came to repeat.

    `multiple` are the periods after which it repeats, 0 if it does not; `periods` those followed;
    `transient` the distance of the state from its limit that may be left, in g/w.
    """

    status: int
    multiple: int
    periods: int
    transient: float


@compiled
def new_history(max_periods: int, stop: Stop) -> History:
    """Return buffers for the states and sums of `max_periods` of a motion, not yet filled."""
    return History(
        np.empty((max_periods + 1, len(STATE))), np.empty((max_periods + 1, len(STATE))),
        np.empty((max_periods + 1, len(TALLY))),
        np.empty((max_periods + 1, len(HOLD)), dtype=np.int64), stop,
    )  # fmt: skip


@compiled
def state_distance(wall: bool, rolling: float, history: History, later: int, earlier: int) -> float:
    """Return the distance between two states of a motion, 0 where it repeats, in units of g and w.

    The largest of |dz|, |du_x|, |du_z|, |du_y + dspin| and `wall_gap` between the end of period
    `later` and the start of period `earlier`.
    """
    new, old = history.ends[later], history.starts[earlier]
    largest = max(
        abs(new[STATE.z] - old[STATE.z]),
        abs(new[STATE.ux] - old[STATE.ux]),
        abs(new[STATE.uz] - old[STATE.uz]),
    )
    across = new[STATE.uy] - old[STATE.uy]
    if rolling > 0.0:
        across += new[STATE.spin] - old[STATE.spin]
    largest = max(largest, abs(across))
    if wall:
        drift = new[STATE.y] - old[STATE.y]
        largest = max(largest, wall_gap(history.tallies, earlier, later + 1, drift))
    return largest


@compiled
def repeats(
    wall: bool, rolling: float, history: History, last: int, counted_from: int, tolerance: float,
    divisor_distance: float,
) -> int:  # fmt: skip
    """Return the number of periods after which the motion repeats, 0 if it does not.

    The first m <= 32 with states apart by at most `tolerance`; 0 if a divisor of m nearly repeats,
    by less than `divisor_distance`: the shorter cycle may not have settled yet.
    """
    ends, starts, column = history.ends, history.starts, STATE.ux
    for multiple in range(1, min(MAX_MULTIPLE, last - counted_from + 1) + 1):
        if abs(ends[last, column] - starts[last - multiple + 1, column]) > tolerance:
            continue  # as most are: told apart by one number
        if state_distance(wall, rolling, history, last, last - multiple + 1) > tolerance:
            continue
        for divisor in range(1, multiple):
            divides = multiple % divisor == 0
            if (
                divides
                and state_distance(wall, rolling, history, last, last - divisor + 1)
                < divisor_distance
            ):
                return 0
        return multiple
    return 0


@compiled
def remaining_transient(
    wall: bool, rolling: float, history: History, last: int, multiple: int, counted_from: int
) -> float:
    """Return an estimate of the distance of a state from that of the repeating motion, in g/w.

    d/(1 - q), q = d/d0 at most 0.999, with the change d over the last cycle and d0 over the one
    before; d alone if that began before period `counted_from`, the last jump of the iteration
    (theory 13.13).
    """
    change = state_distance(wall, rolling, history, last, last - multiple + 1)
    if last - 2 * multiple + 1 < counted_from or change == 0.0:
        return change
    change_before = state_distance(wall, rolling, history, last - multiple, last - 2 * multiple + 1)
    ratio = min(change / change_before, 0.999) if change_before > 0.0 else 0.0
    return change / (1.0 - ratio)


@compiled
def follow_period(
    cell: Cell, wall: bool, rolling: float, series: Series, period: int, state: Floats, hold: Flags,
    history: History, work: Work,
) -> bool:  # fmt: skip
    """Follow a cell for one more period and record it in `history`; False if that fails."""
    # Without phases to sample, and with empty arrays for samples and energies.
    state[STATE.x] = 0.0
    history.starts[period], history.holds[period] = state, hold
    succeeded = advance(
        cell, wall, rolling, series.order, series.tolerance * push.drive_speed(work), state, hold,
        history.tallies[period], work, NO_PHASES, history.starts[:0], state[:0],
    )  # fmt: skip
    history.ends[period] = state
    return succeeded and bool(np.all(np.isfinite(state)))


@compiled
def follow_until_repeating(
    cell: Cell, wall: bool, rolling: float, series: Series, max_periods: int, state: Floats,
    hold: Flags, history: History, work: Work,
) -> Settling:  # fmt: skip
    """Follow a cell until its motion repeats, or for `max_periods`; return how it repeats."""
    start, start_hold = state.copy(), hold.copy()
    largest_transient = APART_AT_MOST * push.drive_speed(work)
    settled, most_jumps = Settling(STATUS.aperiodic, 0, 0, math.inf), MAX_JUMPS
    for _ in range(3):
        settled, jumps = follow_within_limits(
            cell, wall, rolling, series, max_periods, most_jumps, state, hold, history, work
        )
        if settled.status != STATUS.aperiodic:
            return settled
        most_jumps = 0
        if jumps > 0:
            state[:], hold[:] = start, start_hold
            continue
        settled = slowly_approached_cycle(
            wall, rolling, history, settled.periods, largest_transient
        )
        if settled.multiple == 0:
            return settled
    return settled


@compiled
def follow_from_rest(
    row: Floats, wall: bool, rolling: float, series: Series, history: History, work: Work
) -> tuple[Settling, Floats, Flags]:
    """Follow a cell from rest until it repeats; return how, and state and contacts there."""
    cell = cell_of(row)
    push.set_drive(cell, row, work)
    state, hold = at_rest()
    max_periods = int(cell.max_periods)
    settled = follow_until_repeating(
        cell, wall, rolling, series, max_periods, state, hold, history, work
    )
    if settled.multiple > 0:
        first = settled.periods - settled.multiple
        state, hold = history.starts[first].copy(), history.holds[first].copy()
    return settled, state, hold


@compiled
def slowly_approached_cycle(
    wall: bool, rolling: float, history: History, periods: int, largest_transient: float
) -> Settling:
    """Return the period of a motion that approaches a cycle slowly, as the record `Settling`.

    The change over a cycle must have fallen to less than a tenth within the last L cycles: with the
    ratio q = (d/d0)^(1/L) the state is still off by d q/(1 - q), which must be less than
    `largest_transient` (theory 13.13).
    """
    for multiple in range(1, min(MAX_MULTIPLE, periods // 8) + 1):
        cycles = periods // 4 // multiple
        change = state_distance(wall, rolling, history, periods - 1, periods - multiple)
        if change >= largest_transient:
            continue
        last = periods - 1 - cycles * multiple
        change_before = state_distance(wall, rolling, history, last, last - multiple + 1)
        if change >= FADES * change_before:
            continue
        ratio = (change / change_before) ** (1.0 / cycles)
        transient = change * ratio / (1.0 - ratio)
        if transient < largest_transient:
            return Settling(STATUS.periodic, multiple, periods, transient)
    return Settling(STATUS.aperiodic, 0, periods, math.inf)


@compiled
def follow_within_limits(
    cell: Cell, wall: bool, rolling: float, series: Series, max_periods: int, most_jumps: int,
    state: Floats, hold: Flags, history: History, work: Work,
) -> tuple[Settling, int]:  # fmt: skip
    """Follow a cell until it repeats, within limits; return how it repeats, and jumps used."""
    speed = push.drive_speed(work)
    tolerance = cell.tolerance * speed
    counted_from, shrinking_periods, jumps = 0, 0, 0
    for period in range(max_periods):
        if raised(history.stop):
            return Settling(STATUS.limit_reached, 0, period, math.inf), jumps
        tally = history.tallies[period]
        if not follow_period(cell, wall, rolling, series, period, state, hold, history, work):
            return Settling(STATUS.limit_reached, 0, period + 1, math.inf), jumps
        moves = tally[TALLY.forward] + tally[TALLY.backward] + tally[TALLY.flight]
        # A slip straight across counts to neither way along the track.
        if moves == 0.0 and tally[TALLY.across] == 0.0 and rolling == 0.0:
            return Settling(STATUS.at_rest, 1, period + 1, 0.0), jumps
        is_wide_check = period % LONG == LONG - 1
        state_tolerance = (
            max(tolerance, NOISE * series.tolerance * speed) if is_wide_check else tolerance
        )
        divisor_distance = max(state_tolerance, min(APART * state_tolerance, APART_AT_MOST * speed))
        multiple = repeats(
            wall, rolling, history, period, counted_from, state_tolerance, divisor_distance
        )
        if multiple > 0:
            transient = remaining_transient(wall, rolling, history, period, multiple, counted_from)
            return Settling(STATUS.periodic, multiple, period + 1, transient), jumps
        if period == 0 or period <= counted_from or most_jumps == 0:
            continue
        change, change_before = (
            step_size(wall, history, period),
            step_size(wall, history, period - 1),
        )
        has_same_events = same_events(history, period, period - 1)
        largest_ratio = SHRINKS if period - counted_from < LONG else SHRINKS_AT_ALL
        shrinking_periods = (
            shrinking_periods + 1
            if has_same_events and change < largest_ratio * change_before
            else 0
        )
        if shrinking_periods < 2 or change >= NEAR * speed:
            continue
        if jumps == most_jumps:
            return Settling(STATUS.aperiodic, 0, period + 1, math.inf), jumps
        if jump_to_prediction(wall, history, period, counted_from, state):
            counted_from, shrinking_periods, jumps = period + 1, 0, jumps + 1
    return Settling(STATUS.aperiodic, 0, max_periods, math.inf), jumps


@compiled
def same_events(history: History, first: int, second: int) -> bool:
    """True if two periods had the same events in the same order: their event hashes are equal."""
    tallies = history.tallies
    return bool(tallies[first, TALLY.signature] == tallies[second, TALLY.signature])


@compiled
def first_coordinate(wall: bool, history: History, period: int) -> int:
    """Return the first column of the state that takes part in Anderson's mixing."""
    touched_wall = wall and history.tallies[period, TALLY.at_wall] > 0.0
    return STATE.y if touched_wall else STATE.z


@compiled
def step_size(wall: bool, history: History, period: int) -> float:
    """Return the largest change of a state over a period, max |end - start|, in g/w and g/w^2."""
    largest = 0.0
    for i in range(first_coordinate(wall, history, period), len(STATE)):
        largest = max(largest, abs(history.ends[period, i] - history.starts[period, i]))
    return largest


@compiled
def jump_to_prediction(
    wall: bool, history: History, last: int, counted_from: int, state: Floats
) -> bool:
    """Move the state to where the motion is predicted to repeat; False if there is no prediction.

    Weights minimise |f_last - sum of weights times differences of f| of the residuals f = end -
    start of periods with equal events; the new state is the same combination of the ends.
    """
    depth = 0
    while depth < min(DEPTH, last - counted_from) and same_events(history, last - depth - 1, last):
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
        difference = history.ends[last - j] - history.starts[last - j]
        difference -= history.ends[last - j - 1] - history.starts[last - j - 1]
        difference[:first] = 0.0
        size = np.sum(difference * difference)
        for earlier in range(j):
            triangle[earlier, j] = np.sum(basis[earlier] * difference)
            difference -= triangle[earlier, j] * basis[earlier]
        remainder = np.sum(difference * difference)
        if not remainder > INDEPENDENT**2 * size:
            break
        triangle[j, j] = math.sqrt(remainder)
        basis[j] = difference / triangle[j, j]
        used += 1
    for j in range(used - 1, -1, -1):
        dot = np.sum(basis[j] * residual)
        for earlier in range(j + 1, used):
            dot -= triangle[j, earlier] * weights[earlier]
        weights[j] = dot / triangle[j, j]
        if not abs(weights[j]) < LARGEST_WEIGHT:
            return weights, 0
    return weights, used
