"""Means of a motion that does not repeat, over runs from several phases."""

from __future__ import annotations

import math

import numpy as np

from core.compiled import compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.planar.cycle import FIRST_LOOK, rests
from core.motion.kernels.planar.flight import hop_height, landing
from core.motion.kernels.planar.flow import TURN, Drive, flow, phase_to, velocity_after
from core.motion.kernels.planar.slide import contact
from core.motion.kernels.planar.tables import DISTANCE, PIECE, SUMS, TIMES
from core.motion.kernels.results import COLUMN
from core.motion.kernels.statuses import MODE, MODES, STATUS

PHASES = 8  # runs of an aperiodic motion, started at as many phases
SHARE_SETTLING = 0.2  # of an aperiodic run, before its mean is taken
HOPS_PER_PERIOD = 16  # of an aperiodic run, on average; more end it
SURE = 5.41  # standard deviations of a mean of 8 runs that hold 99.9 % (Student, 7 degrees)
SETTLED_ROUGHLY = 1e-8  # as `SETTLED_EXACTLY`, in a run whose mean has a spread of 1e-3 at best


@compiled
def long_run(
    tau: float, periods: int, hops: int, drive: Drive, e: float, guess: float, sums: Floats
) -> tuple[float, int, float, float, float, bool]:
    """Run from rest on the floor at tau; fill `sums`.

    The first part of the run is dropped. `sums` is as in `contact`.

    Returns
    -------
    tuple
        Time, 0 if the hops allowed did not reach beyond the first part; impacts, largest landing
        speed and height; how far the part strayed from a steady travel at the velocity `guess`;
        and whether it slid downhill all the time, gaining speed.
    """
    c, s, gs, gn, mu_k = drive.c, drive.s, drive.gs, drive.gn, drive.mu_k
    up_at = math.asin(gn / s)
    no_log = np.empty((0, len(PIECE)))
    settling = periods * SHARE_SETTLING * TURN
    total, began, impacts, fastest, highest = 0.0, math.inf, 0, 0.0, 0.0
    settling_hops = int(hops * SHARE_SETTLING)
    sums[:] = 0.0
    u, w = 0.0, 0.0
    ahead, behind = 0.0, 0.0
    u_began, slips_down = 0.0, mu_k * gn < abs(gs)
    if s * math.sin(tau) < gn:
        span = phase_to(up_at, tau)
        u = contact(tau, span, u, drive, sums, no_log, 0)[0]
        tau, total = up_at, span
    for hop in range(hops):
        if began == math.inf and (total >= settling or hop >= settling_hops):
            began, impacts, fastest, highest = total, 0, 0.0, 0.0
            sums[:] = 0.0
            u_began = u
        if total - began >= periods * TURN - settling:
            break
        span = landing(w, s, gn, tau)
        if span < 0:
            break
        speed = max(0.0, -velocity_after(w, s, gn, tau, span))
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
            tau, w, total = up_at, 0.0, total + span
        if began < math.inf:
            strayed = sums[DISTANCE] - guess * (total - began)
            ahead, behind = max(ahead, strayed), min(behind, strayed)
            slips_down = slips_down and u * gs < 0
    uphill = sums[TIMES + (MODE.forward if gs > 0 else MODE.backward)] + sums[TIMES + MODE.stick]
    runs_away = slips_down and uphill == 0 and abs(u) > abs(u_began)
    return max(0.0, total - began), impacts, fastest, highest, ahead - behind, runs_away


@compiled
def from_phases(phase: float, drive: Drive, e: float, most_periods: int, result: Floats) -> int:
    """Fill the result of an aperiodic motion: means over runs from several phases; return a status.

    The error of the mean is of two kinds: the scatter of the runs, and what all have alike, since
    each ends somewhere in a motion that may nearly repeat. Of the second the runs tell nothing; it
    is at most how far a part strays from a steady travel, over the time.
    """
    sums = np.empty(SUMS)
    periods = max(1, most_periods // PHASES)
    mean, square, time, impacts, fastest, highest = 0.0, 0.0, 0.0, 0, 0.0, 0.0
    shares = np.zeros(MODES)
    common, away = 0.0, 0
    for run in range(PHASES):
        start = (phase + TURN * run / PHASES) % TURN
        span, hits, speed, height, strayed, runs_away = long_run(
            start, periods, HOPS_PER_PERIOD * periods + FIRST_LOOK, drive, e, mean, sums
        )
        if span <= 0:
            return STATUS.limit_reached
        away += 1 if runs_away else 0
        if run > 0:  # the first has no velocity to stray from
            common = max(common, strayed / span)
        velocity = sums[DISTANCE] / span
        deviation = velocity - mean
        mean += deviation / (run + 1)
        square += deviation * (velocity - mean)
        time, impacts = time + span, impacts + hits
        fastest, highest = max(fastest, speed), max(highest, height)
        for mode in range(MODES):
            shares[mode] += sums[TIMES + mode]
    if away == PHASES:
        return STATUS.runaway
    spread = math.sqrt(square / (PHASES - 1))
    result[COLUMN.velocity], result[COLUMN.spread] = mean, spread
    result[COLUMN.error] = SURE * spread / math.sqrt(PHASES) + common
    for mode in range(MODES):
        result[COLUMN.stick + mode] = shares[mode] / time
    result[COLUMN.impacts], result[COLUMN.landing_speed] = impacts * TURN / time, fastest
    result[COLUMN.hop_height], result[COLUMN.multiple] = highest, 0.0
    return STATUS.aperiodic
