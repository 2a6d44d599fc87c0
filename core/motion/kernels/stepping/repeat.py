"""Finds the number of periods after which the motion repeats, and its means."""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.cells import Cell
from vibrafeed.core.motion.kernels.means import ended, fill_means, mean_velocity, scatter, wall_gap
from vibrafeed.core.motion.kernels.results import COLUMN, TALLY
from vibrafeed.core.motion.kernels.statuses import STATUS
from vibrafeed.core.motion.kernels.stepping.tables import FLOOR, STATE, WALL

MAX_MULTIPLE = 12
"""Periods of a cycle: it must come back within `WINDOW`, and show more than once there."""
WINDOW = 16  # periods over which a cycle must be seen again and again
SHARP = 0.03  # share of the allowed change, within which early cycles must come back
SLOWS = 0.8
"""Largest ratio of a drift to that a third of a window before, of a part that hops: landings fall
on steps by chance, and a drift that goes on must not look as if it slowed down."""
APART = 3.0
"""States of a cycle that differ by less than so many times what one step changes are one state.

Of the motions on the bowl of `tests/laws/test_stepping_labels.py` that repeat every period, one in
1,600 runs through a cycle that differs by more; a third differ by up to one step.
"""


@compiled
def difference(states: Floats, tallies: Floats, later: int, earlier: int) -> float:
    """Return the distance of the states at the ends of two periods, to see if a motion repeats.

    The largest of |du_x|, |du_z|, |dz|, |du_y|, |dspin| and |dy|, of rows `later` and `earlier` of
    `states` (columns of `STATE`), in units of g and w = 2 pi f. A height below 0 counts as 0: by
    time stepping a part in contact sinks in by up to a step of its fall. |dy| is left out for a
    part that did not touch the wall between, as `tallies` tell, and moves away.
    """
    new, old = states[later], states[earlier]
    most = max(abs(new[STATE.ux] - old[STATE.ux]), abs(new[STATE.uz] - old[STATE.uz]))
    most = max(most, abs(max(new[STATE.z], 0.0) - max(old[STATE.z], 0.0)))
    if new.size > STATE.uy:
        most = max(most, abs(new[STATE.uy] - old[STATE.uy]), abs(new[STATE.spin] - old[STATE.spin]))
    if new.size > STATE.y:
        away = max(new[STATE.y], 0.0) - max(old[STATE.y], 0.0)
        most = max(most, wall_gap(tallies, earlier, later, away))
    return most


@compiled
def limit(
    tallies: Floats, done: int, part: int, slows: float, rounding: float, period: float
) -> tuple[float, float]:
    """Return the limit to which a mean velocity drifts, and its present distance from it, in g/w.

    From the means v_1, v_2, v_3 of the last three groups of `part` periods: a transient dies out
    with the ratio q = (v_3 - v_2)/(v_2 - v_1), so that (v_3 - v_2) q/(1 - q) is to come. The
    distance is infinite if |q| is at least `slows`. Changes up to `rounding` (in g/w) count as
    none. `tallies` holds the distance of each of the `done` periods (columns of `TALLY`), `period`
    is the duration of one in rad. Here w = 2 pi f.
    """
    travel = tallies[:, TALLY.travel]
    first = mean_velocity(travel, done - 3 * part, done - 2 * part, period)
    second = mean_velocity(travel, done - 2 * part, done - part, period)
    third = mean_velocity(travel, done - part, done, period)
    last, before = third - second, second - first
    if last * before <= 0.0 or abs(last) <= rounding:
        return third, abs(last)
    if abs(last) >= slows * abs(before):
        return third, math.inf
    rest = last * last / (before - last)
    return third + rest, abs(last) + abs(rest)


@compiled
def settled(
    tallies: Floats, done: int, multiple: int, window: int, rounding: float, allowed: float,
    period: float, result: Floats,
) -> bool:  # fmt: skip
    """True if the mean velocity has settled; then its error is written into `result`.

    Motion on the floor converges smoothly: its `limit` is extrapolated and written, too, and must
    itself stand still. A part that hops lands on steps that vary from period to period; its mean
    stays that of the window, which `result` holds already.

    Parameters
    ----------
    tallies, done
        Sums over each period (a row each, columns of `TALLY`), and the periods so far.
    multiple, window
        Periods of the cycle, and periods over which it was seen.
    rounding, allowed
        Changes of a velocity in g/w (w = 2 pi f) that are rounding, and that a step may make.
    period
        Duration of a period in rad.
    result
        The cell's row of results (columns of `COLUMN`).
    """
    part = max(1, window // multiple // 3) * multiple
    if done < 4 * part:
        return False
    hops = False
    for k in range(done - 4 * part, done):
        hops = hops or tallies[k, TALLY.flight] > 0.0
    slows = SLOWS if hops else 1.0
    end, rest = limit(tallies, done, part, slows, rounding, period)
    if hops:
        if rest > 0.1 * allowed:
            return False
        result[COLUMN.error] = rest
        return True
    before, _ = limit(tallies, done - part, part, slows, rounding, period)
    if not math.isfinite(rest) or abs(end - before) > 1e-3 * allowed:
        return False
    result[COLUMN.velocity] = end
    # What the extrapolation changed by, or at most would in what is left of the transient.
    result[COLUMN.error] = max(2.0 * abs(end - before), 1e-3 * rest)
    return True


@compiled
def repeats(
    states: Floats, tallies: Floats, done: int, rounding: float, allowed: float, period: float,
    result: Floats,
) -> int:  # fmt: skip
    """Return the number of periods after which a motion by time stepping repeats; 0 if it does not.

    A state that comes back within `rounding` repeats for ever. Otherwise slips and landings fall on
    steps that vary, and the state wanders by the order of a step: it must then come back to within
    `allowed` for a whole window of periods, and its mean velocity must not drift (`settled`).

    Parameters
    ----------
    states, tallies, done
        States at the ends of periods, sums of each (columns of `TALLY`), and the periods so far.
    rounding, allowed
        Changes of a velocity in g/w (w = 2 pi f) that are rounding, and that a step may make.
    period
        Duration of a period in rad.
    result
        Filled with the means, columns of `COLUMN`, if the state comes back, even where the mean
        has not settled.
    """
    for multiple in range(1, min(MAX_MULTIPLE, done) + 1):
        now, then = states[done], states[done - multiple]
        if (
            difference(states, tallies, done, done - multiple) <= rounding
            and abs(now[STATE.z] - then[STATE.z]) <= rounding
            and (now[STATE.spare] >= 0.0) == (then[STATE.spare] >= 0.0)
        ):
            fill_means(tallies, done - multiple, done, period, result)
            return distinct_from(states, tallies, done, multiple, allowed)
    for multiple in range(1, MAX_MULTIPLE + 1):
        window = multiple * ((WINDOW + multiple - 1) // multiple)
        # A transient of hops is given time before it may pass for chance.
        late = done >= 4 * window
        bound = allowed if late else SHARP * allowed
        if done < window + multiple or difference(states, tallies, done, done - window) > bound:
            continue
        good = True
        for back in range(window):
            end = done - back
            if difference(states, tallies, end, end - multiple) > bound:
                good = False
                break
        if good:
            fill_means(tallies, done - window, done, period, result)
            if settled(tallies, done, multiple, window, rounding, bound, period, result):
                return distinct_from(states, tallies, done, multiple, allowed)
    return 0


@compiled
def distinct_from(states: Floats, tallies: Floats, done: int, cycle: int, allowed: float) -> int:
    """Return the number of periods of the shortest cycle that the method's error still allows.

    A cycle of `cycle` periods may be a shorter one that varies only by where in steps its slips and
    landings fall. The smallest divisor of `cycle` is taken after which all states differ by at most
    3 `allowed`, the change by one step in g/w (w = 2 pi f). A truly doubled period differs by more,
    whatever the step. `states` and `tallies` hold the ends and sums of the `done` periods.
    """
    for multiple in range(1, cycle):
        if cycle % multiple:
            continue
        same = True
        for end in range(done - cycle + multiple, done + 1):
            if difference(states, tallies, end, end - multiple) > APART * allowed:
                same = False
                break
        if same:
            return multiple
    return cycle


@compiled
def unsettled(
    scene: int, cell: Cell, states: Floats, tallies: Floats, done: int, period: float,
    result: Floats,
) -> int:  # fmt: skip
    """Return the status of a motion by time stepping that did not repeat, and write its spread.

    `runaway`, `aperiodic`, or `limit_reached` if its mean drifts. Without a wall it also runs away
    if its velocity across keeps growing, by more than half as much as before over each quarter. The
    spread is the standard deviation of the means of batches, in g/w (w = 2 pi f), a column of
    `result`. `scene` is `PLANAR`, `FLOOR` or `WALL`, `cell` holds the part's numbers; `states` and
    `tallies` hold `done` periods of the duration `period` in rad.
    """
    pull, quarter = abs(cell.gravity_number_along), done // 4
    if scene == FLOOR:
        pull = math.hypot(pull, cell.gravity_number_across)
        # Without a wall a part on a lean may slide or roll away across.
        late = states[done, STATE.uy] - states[done - quarter, STATE.uy]
        early = states[done - quarter, STATE.uy] - states[done - 2 * quarter, STATE.uy]
        if late * early > 0.0 and abs(late) > 0.5 * abs(early) and abs(late) > quarter * 1e-3:
            return STATUS.runaway
    travel = tallies[:done, TALLY.travel]
    status, batches = ended(cell, scene == WALL, pull, travel, period, 0.0)
    if status != STATUS.runaway:
        result[COLUMN.spread] = scatter(batches)
    return status
