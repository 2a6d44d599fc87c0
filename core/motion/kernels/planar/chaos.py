"""Means of a motion that does not repeat, over runs from several phases."""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.planar.cycle import (
    FIRST_LOOK,
    LONGEST_CYCLE,
    find_cycle,
    rests,
    write_segment,
)
from core.motion.kernels.planar.flight import hop_height, landing
from core.motion.kernels.planar.flow import TURN, Drive, flow, phase_to, velocity_after
from core.motion.kernels.planar.repeating import repeating
from core.motion.kernels.planar.slide import contact
from core.motion.kernels.planar.tables import DISTANCE, MOST_SEGMENTS, PIECE, SUMS, TIMES, Cell
from core.motion.kernels.results import COLUMN, RESULTS
from core.motion.kernels.statuses import MODE, MODES, STATUS

PHASES = 8  # runs of a motion that rounding decides, started at as many phases
SEARCHES = 4  # of them look for a cycle; if none falls into one, the others do not wait for it
PATIENCE = 1024  # hops without rest after which a part is taken to fall into no cycle
SHARE_SETTLING = 0.2  # of a run, before its mean is taken
HOPS_PER_PERIOD = 16  # of a run, on average; more end it
SURE = 5.41  # standard deviations of a mean of 8 runs that hold 99.9 % (Student, 7 degrees)
SETTLED_ROUGHLY = 1e-8  # as `SETTLED_EXACTLY`, in a run whose mean has a spread of 1e-3 at best
RECENT = 64  # hops since the part was at rest, from which on it may be nearing a cycle
JOLT = 1e-6  # of gravity: largest speed of a lift-off from rest, other than exactly 0
GOLDEN = 0.6180339887498949  # its multiples, modulo 1, come nowhere twice
KEPT_BITS = 2.0**32
"""Cells that agree in so many bits have the same runs: an answer that hangs on the last bit of a
parameter tells a user nothing, and their error is 1e6 times larger than what is rounded away."""


@compiled
def kept(value: float) -> float:
    """Return a value with the first bits only."""
    mantissa, exponent = math.frexp(value)
    return math.ldexp(np.rint(mantissa * KEPT_BITS) / KEPT_BITS, exponent)


@compiled
def rounded(cell: Cell, drive: Drive) -> tuple[Drive, float]:
    """Return drive and restitution with their first bits only, where a part still lifts off."""
    few = Drive(
        kept(drive.c), kept(drive.s), kept(drive.gs), kept(drive.gn),
        kept(drive.mu_s), kept(drive.mu_k),
    )  # fmt: skip
    return (few if few.s > few.gn else drive), kept(cell.restitution)


@compiled
def long_run(
    run: int, phase: float, periods: int, patience: int, drive: Drive, e: float, guess: float,
    rows: Floats, sums: Floats,
) -> tuple[float, int, float, float, float, bool, int]:  # fmt: skip
    """Follow a part from rest on the floor, at one of `PHASES` phases from `phase` on.

    The run lasts so many periods, and until the part comes to rest, if it did not lately, or has
    made so many hops, `patience`. Its first part is dropped. `sums` is as in `contact`. From rest a
    part would take the same course again, to the last bit: it is lifted off with a jolt, each time
    another one, so that the mean is over the ways that it may take and not over one of them.

    Returns
    -------
    tuple
        Time, 0 if the hops allowed did not reach beyond the first part; impacts, largest landing
        speed and height; how far the part strayed from a steady travel at the velocity `guess`;
        whether it slid downhill all the time, gaining speed; and, if the run ended in a cycle of
        hops, how many they are: the first of `rows` then hold them, and the time is the periods.
    """
    c, s, gs, gn, mu_k = drive.c, drive.s, drive.gs, drive.gn, drive.mu_k
    up_at = math.asin(gn / s)
    no_log = np.empty((0, len(PIECE)))
    settling = periods * SHARE_SETTLING * TURN
    hops = HOPS_PER_PERIOD * periods + FIRST_LOOK
    total, began, impacts, fastest, highest = 0.0, math.inf, 0, 0.0, 0.0
    settling_hops = int(hops * SHARE_SETTLING)
    sums[:] = 0.0
    u, w = 0.0, 0.0
    ahead, behind = 0.0, 0.0
    u_began, slips_down = 0.0, mu_k * gn < abs(gs)
    count, look_at, jolt = 0, FIRST_LOOK, run
    tau = (phase + TURN * run / PHASES) % TURN
    if s * math.sin(tau) < gn:
        span = phase_to(up_at, tau)
        u = contact(tau, span, u, drive, sums, no_log, 0)[0]
        tau, w, total = up_at, JOLT * gn * ((GOLDEN * jolt) % 1.0), span
    for hop in range(hops + patience):
        if began == math.inf and (total >= settling or hop >= settling_hops):
            began, impacts, fastest, highest = total, 0, 0.0, 0.0
            sums[:] = 0.0
            u_began = u
        enough = total - began >= periods * TURN - settling or hop >= hops
        if enough and not RECENT <= count < patience:
            break
        span = landing(w, s, gn, tau)
        if span < 0:
            break
        speed = max(0.0, -velocity_after(w, s, gn, tau, span))
        write_segment(rows, count, tau, span, w, speed, (1 + e) * speed)
        count += 1
        if began < math.inf:
            highest = hop_height(w, s, gn, tau, span, highest)
        u, distance = flow(u, c, gs, math.sin(tau), math.cos(tau), span)
        sums[DISTANCE] += distance
        sums[TIMES + MODE.flight] += span
        impacts, fastest = impacts + 1, max(fastest, speed)
        total += span
        tau, w = (tau + span) % TURN, e * speed
        stays = rests(tau, w, s, gn, e, up_at, SETTLED_ROUGHLY)
        friction = mu_k * (speed if stays else speed + w)
        u = 0.0 if abs(u) <= friction else u - (friction if u > 0 else -friction)
        if stays:
            span = phase_to(up_at, tau)
            u = contact(tau, span, u, drive, sums, no_log, 0)[0]
            jolt += PHASES
            tau, w, total = up_at, JOLT * gn * ((GOLDEN * jolt) % 1.0), total + span
            count, look_at = 0, FIRST_LOOK
        elif count >= look_at:
            look_at = count + count // 2
            cycle_hops, cycle_periods = find_cycle(s, gn, e, up_at, rows, count, tau, w)
            if cycle_hops:
                return TURN * cycle_periods, 0, 0.0, 0.0, 0.0, False, cycle_hops
        if count >= MOST_SEGMENTS - LONGEST_CYCLE - 2:
            count, look_at = 0, FIRST_LOOK
        if began < math.inf:
            strayed = sums[DISTANCE] - guess * (total - began)
            ahead, behind = max(ahead, strayed), min(behind, strayed)
            slips_down = slips_down and u * gs < 0
    uphill = sums[TIMES + (MODE.forward if gs > 0 else MODE.backward)] + sums[TIMES + MODE.stick]
    runs_away = slips_down and uphill == 0 and abs(u) > abs(u_began)
    return max(0.0, total - began), impacts, fastest, highest, ahead - behind, runs_away, 0


@compiled
def run_from(
    run: int, phase: float, patience: int, cell: Cell, drive: Drive, e: float, guess: float,
    rows: Floats, sums: Floats, result: Floats,
) -> int:  # fmt: skip
    """Fill `result` with the means of the motion of one run; return a status.

    A motion that ends in a cycle has the means of that. The error of another is how far the part
    strays from a steady travel, over the time: the run ends somewhere in a motion that may nearly
    repeat.
    """
    periods = max(1, int(cell.most_periods) // PHASES)
    time, impacts, fastest, highest, strayed, runs_away, count = long_run(
        run, phase, periods, patience, drive, e, guess, rows, sums
    )
    if count > 0:
        cycle, no_log = round(time / TURN), np.empty((0, len(PIECE)))
        return repeating(rows, count, cycle, phase, 0.0, drive, cell, sums, no_log, result)[0]
    if time <= 0:
        return STATUS.limit_reached
    if runs_away:
        return STATUS.runaway
    result[COLUMN.velocity], result[COLUMN.error] = sums[DISTANCE] / time, strayed / time
    for mode in range(MODES):
        result[COLUMN.stick + mode] = sums[TIMES + mode] / time
    result[COLUMN.impacts] = impacts * TURN / time
    result[COLUMN.landing_speed], result[COLUMN.hop_height] = fastest, highest
    return STATUS.aperiodic


@compiled
def from_phases(
    cell: Cell, phase: float, drive: Drive, rows: Floats, sums: Floats, result: Floats
) -> int:
    """Fill the result of a motion that rounding decides; return a status.

    The means are those of runs from several phases of the drive. Where none of them ends in a cycle the motion
    is aperiodic, and the error is that of the mean: the scatter of the runs, and what all have
    alike, of which the runs tell nothing. Where one does, or several do, the part falls into one of
    them; the error holds what each run gives.
    """
    drive, e = rounded(cell, drive)
    found = np.empty((PHASES, RESULTS))
    count, away, cycles, guess, common, known = 0, 0, 0, 0.0, 0.0, 0.0
    for run in range(PHASES):
        one = found[count]
        patience = PATIENCE if run < SEARCHES or cycles > 0 else 0
        status = run_from(run, phase, patience, cell, drive, e, guess, rows, sums, one)
        if status == STATUS.runaway:
            away += 1
        elif status == STATUS.limit_reached:
            return status
        else:
            cycles += 0 if status == STATUS.aperiodic else 1
            guess += (one[COLUMN.velocity] - guess) / (count + 1)
            if status == STATUS.aperiodic:  # the first had no velocity to stray from
                common = max(common, one[COLUMN.error] if run > 0 else 0.0)
            else:
                known = max(known, one[COLUMN.error])
            count += 1
    if count == 0:
        return STATUS.runaway
    for column in range(RESULTS):
        result[column] = found[:count, column].mean()
    result[COLUMN.landing_speed] = found[:count, COLUMN.landing_speed].max()
    result[COLUMN.hop_height] = found[:count, COLUMN.hop_height].max()
    result[COLUMN.multiple] = 0.0
    off = np.abs(found[:count, COLUMN.velocity] - result[COLUMN.velocity])
    spread = math.sqrt((off * off).sum() / max(1, count - 1))
    result[COLUMN.spread] = spread
    if cycles == 0:
        result[COLUMN.error] = SURE * spread / math.sqrt(count) + common
        return STATUS.aperiodic
    result[COLUMN.error] = off.max() + known
    return STATUS.sensitive
