"""Compiled time stepping of one part by the midpoint rule of Moreau and Jean (theory 13.9).

Three scenes, each with the coordinates and contacts that it has and no others: `PLANAR` (along and
normal to the floor), `FLOOR` (across as well, and spin), `WALL` (the distance from the wall as
well). All numbers are dimensionless: phase, lengths in g/w^2, velocities in g/w.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.motion.kernels.statuses import (
    APERIODIC,
    AT_REST,
    LIMIT_REACHED,
    NEUTRAL,
    NO_SOLUTION,
    PERIODIC,
    RUNAWAY,
)  # fmt: skip

Floats = NDArray[np.float64]

PLANAR, FLOOR, WALL = 0, 1, 2

# Columns of a state; a scene stops where its coordinates end.
X, Z, UX, UZ, SPARE, PRESSED, UY, SPIN, Y, LEANING = range(10)
WIDTHS = (6, 8, 10)

# Columns of the tally of one period.
TRAVEL, FORWARD, BACKWARD, STICK, FLIGHT, IMPACTS, LANDING, HEIGHT, PEAK, AT_WALL, FAILED = range(
    11
)
TALLIES = 11

# Columns of the groups of one cell.
(
    DRIVE_ALONG, DRIVE_ACROSS, DRIVE_NORMAL, GRAVITY_ALONG, GRAVITY_ACROSS, GRAVITY_NORMAL,
    CURVATURE, FRICTION_STATIC, FRICTION_KINETIC, WALL_FRICTION, RESTITUTION, WALL_RESTITUTION,
) = range(12)  # fmt: skip
GROUPS = 12

# Columns of the result of one run.
VELOCITY, SPREAD, NOISE, R_STICK, R_FORWARD, R_BACKWARD, R_FLIGHT, R_IMPACTS, R_LANDING = range(9)
R_HEIGHT, MULTIPLE, RESULTS = 9, 10, 11

MOST_SWEEPS = 200
MOST_MULTIPLE = 12
WINDOW = 16
SHARP = 0.03
BATCHES = 8

SAFETY = 3.0
LANDING_SHARE = 0.15
"""The estimate of the error: `SAFETY` times the largest difference of three runs and, with hops,
this share of what a step of the finest changes in the velocity.

The place of a landing within a step has the standard deviation 1/sqrt(12) of it; half of that is
left where several landings, and friction, have a say. Three runs differ too little by chance: with
a safety of 2 and nothing else the true error was larger in 3 % of random studies, up to 34 times;
`benchmarks.honest_estimates` tells what is left.
"""


@compiled
def friction_impulse(
    slip_1: float, slip_2: float, hold: float, slide: float, response: float
) -> tuple[float, float, bool]:
    """Return the impulse of friction at one contact, two components, and whether it sticks.

    The slip is that without the impulse; a unit impulse changes it by 1 and by `response`. It
    sticks if an impulse within the disc of radius `hold` can stop the slip; else the impulse has
    the size `slide` and opposes the slip that is left: the secular equation of theory 7.3.
    """
    stop_2 = slip_2 / response
    if slip_1 * slip_1 + stop_2 * stop_2 <= hold * hold:
        return -slip_1, -stop_2, True
    left = math.hypot(slip_1, slip_2)
    if response == 1.0:
        return -slide * slip_1 / left, -slide * slip_2 / left, False
    # Newton on 1/|e(z)| = 1, concave: from below the root it rises and cannot overshoot.
    z = max(0.0, abs(slip_1) - slide, abs(slip_2) - response * slide, left - response * slide)
    e_1, e_2 = 0.0, 0.0
    for _ in range(60):
        e_1 = slip_1 / (z + slide)
        e_2 = slip_2 / (z + response * slide)
        square = e_1 * e_1 + e_2 * e_2
        slope = e_1 * e_1 / (z + slide) + e_2 * e_2 / (z + response * slide)
        step = square * (math.sqrt(square) - 1.0) / slope
        z += step
        if not step > 1e-14 * left:
            break
    size = math.hypot(e_1, e_2)
    return -slide * e_1 / size, -slide * e_2 / size, False


@compiled
def slip_along(
    slip: float, push: float, hold: float, slide: float, spare: float
) -> tuple[float, float]:
    """Return slip along one axis after a step, and what static friction could still take.

    `spare` is negative where the contact slips, and infinite where it sticks but the step before
    tells nothing. A projection over the whole step, as the plain scheme has it, would be right to
    the order of the step; but the error of a slip that starts or stops within the step depends on
    where in the step it does so, and two step lengths may agree on the same error. So the step is
    cut there: where the force passes what friction holds (a straight line between the middles of
    this step and of the one before), or where the slip is zero, at which static friction is asked
    (theory 13.4).
    """
    hold = max(hold, slide)
    if spare >= 0.0:
        excess = abs(push) - hold
        if excess <= 0.0:
            return 0.0, -excess
        share = 0.5 + excess / (excess + spare) if spare < math.inf else 1.0
        return share * (push - math.copysign(slide, push)), -1.0
    end = slip + push - math.copysign(slide, slip)
    if slip * end > 0.0:
        return end, -1.0
    if abs(push) <= hold:
        return 0.0, hold - abs(push)
    share = end / (end - slip)
    return share * (push - math.copysign(slide, push)), -1.0


@compiled
def planar_step(
    z: float, ux: float, uz: float, spare: float, pressed: bool, ax: float, az: float, h: float,
    restitution: float, friction_static: float, friction_kinetic: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Return velocities along and normal, normal impulse and `spare`, a step later.

    Static friction holds a contact that stuck at the end of the step before, and one whose slip
    comes to zero while it is pressed on. All other slip, and that of a landing, is kinetic.
    """
    vx, vz = ux + h * ax, uz + h * az
    if z + 0.5 * h * uz > 0.0:
        return vx, vz, 0.0, -1.0
    normal = -(vz + restitution * min(uz, 0.0))
    if normal <= 0.0:
        return vx, vz, 0.0, -1.0
    vz += normal
    slide = friction_kinetic * normal
    if pressed:
        vx, spare = slip_along(ux, h * ax, friction_static * normal, slide, spare)
        return vx, vz, normal, spare
    if abs(vx) <= slide:
        return 0.0, vz, normal, math.inf
    return vx - math.copysign(slide, vx), vz, normal, -1.0


@compiled
def floor_step(
    z: float, ux: float, uy: float, uz: float, spin: float, spare: float, pressed: bool,
    ax: float, ay: float, az: float, h: float,
    restitution: float, friction_static: float, friction_kinetic: float, rolling: float,
) -> tuple[float, float, float, float, float, float]:  # fmt: skip
    """Return velocities, spin, normal impulse and `spare`, a step later; no wall.

    The spin is the velocity across that it gives the lowest point (theory 7.3). Where the plane of
    the slip has two axes, a step is cut as in `slip_along`: where the slip is least if it turns.
    """
    vx, vy, vz = ux + h * ax, uy + h * ay, uz + h * az
    if z + 0.5 * h * uz > 0.0:
        return vx, vy, vz, spin, 0.0, -1.0
    normal = -(vz + restitution * min(uz, 0.0))
    if normal <= 0.0:
        return vx, vy, vz, spin, 0.0, -1.0
    vz += normal
    response = 1.0 + rolling
    slide = friction_kinetic * normal
    hold = max(friction_static * normal, slide)
    vs = vy + spin
    left_x, left_y = 0.0, 0.0  # impulse before the cut
    rest_x, rest_y, share = vx, vs, 1.0  # slip at its end with the push of what is left
    if pressed and spare >= 0.0:
        need = math.hypot(vx, vs / response)
        if need <= hold:
            return _held(vx, vy, vz, spin, normal, hold - need, rolling)
        if spare < math.inf:
            share = 0.5 + (need - hold) / (need - hold + spare)
        left_x, left_y = -(1.0 - share) * vx, -(1.0 - share) * vs / response
        rest_x, rest_y, hold = share * vx, share * vs, 0.0
    elif pressed:
        us = uy + spin
        speed = math.hypot(ux, us)
        if speed > 0.0:
            ex, ey = -slide * ux / speed, -slide * us / speed
            end_x, end_y = vx + ex, vs + response * ey
            along = ux * end_x + us * end_y
            if along <= 0.0:
                share = along / (along - speed * speed)
                left_x, left_y = (1.0 - share) * ex, (1.0 - share) * ey
                rest_x = share * vx + (1.0 - share) * end_x
                rest_y = share * vs + (1.0 - share) * end_y
            else:
                hold = slide
    else:
        hold = slide
    fx, fy, held = friction_impulse(rest_x, rest_y, share * hold, share * slide, response)
    if held:
        spare = math.inf
        if pressed:
            spare = max(0.0, hold - math.hypot(h * ax, h * ay / response))
        return _held(vx, vy, vz, spin, normal, spare, rolling)
    fx += left_x
    fy += left_y
    return vx + fx, vy + fy, vz, spin + rolling * fy, normal, -1.0


@compiled
def _held(
    vx: float, vy: float, vz: float, spin: float, normal: float, spare: float, rolling: float
) -> tuple[float, float, float, float, float, float]:
    """Return the state after a step in which the contact came to stick: no slip, exactly."""
    if rolling == 0.0:
        return 0.0, 0.0, vz, 0.0, normal, spare
    vy -= (vy + spin) / (1.0 + rolling)
    return 0.0, vy, vz, -vy, normal, spare


@compiled
def _rubbing(
    vx: float, floor_load: float, wall_load: float, spin: float, static: float, kinetic: float,
    wall_friction: float, rolling: float,
) -> tuple[float, float, float, float, bool]:  # fmt: skip
    """Return velocity along, spin, both normals and whether it sticks, of a spinning cylinder.

    It keeps to floor and wall and rubs on both, each with the slip (u_x, spin), the wall's spin
    being negative; friction at each presses on the other or lifts it.
    """
    normal, side = floor_load, wall_load
    fx, turn, held = 0.0, 0.0, False
    for _ in range(MOST_SWEEPS):
        slide = kinetic * normal + wall_friction * side
        hold = static * normal + wall_friction * side
        fx, turn, held = friction_impulse(vx, spin, hold, slide, rolling)
        most = hold if held else slide
        share = turn / most if most > 0.0 else 0.0
        floor_part = (static if held else kinetic) * normal * share
        new_normal = max(0.0, floor_load + wall_friction * side * share)
        new_side = max(0.0, wall_load - floor_part)
        change = abs(new_normal - normal) + abs(new_side - side)
        normal, side = new_normal, new_side
        if change <= 1e-14 * (floor_load + wall_load):
            return vx + fx, 0.0 if held else spin + rolling * turn, normal, side, held
    return vx, spin, -1.0, -1.0, False


@compiled
def corner_step(
    y: float, z: float, ux: float, uy: float, uz: float, spin: float,
    spare: float, pressed: bool, leaning: bool,
    ax: float, ay: float, az: float, h: float,
    restitution: float, wall_restitution: float, friction_static: float, friction_kinetic: float,
    wall_friction: float, rolling: float,
) -> tuple[float, float, float, float, float, float, float, bool]:  # fmt: skip
    """Return velocities, spin, both normal impulses, `spare` and whether no solution was found.

    Projected Gauss-Seidel, each contact solved exactly in its turn. Both normals come before the
    frictions: among the forces that may hold a part those without a wedging of floor against wall
    are then taken, so that it holds up to mu_s n + mu_w s (theory 4.4). A part that keeps to floor
    and wall without spin needs no sweeps: it slips along one axis only.
    """
    floor, wall = z + 0.5 * h * uz <= 0.0, y + 0.5 * h * uy <= 0.0
    if not wall:
        vx, vy, vz, spin, normal, spare = floor_step(
            z, ux, uy, uz, spin, spare, pressed, ax, ay, az, h,
            restitution, friction_static, friction_kinetic, rolling,
        )  # fmt: skip
        return vx, vy, vz, spin, normal, 0.0, spare, False
    vx, vy, vz = ux + h * ax, uy + h * ay, uz + h * az
    response, spin_before = 1.0 + rolling, spin
    steady = pressed and (leaning or uy == 0.0)
    if steady and floor and spin == 0.0 and vz < 0.0 and vy <= 0.0:
        limit = wall_friction * -vy
        vx, spare = slip_along(
            ux, h * ax, friction_static * -vz + limit, friction_kinetic * -vz + limit, spare
        )
        return vx, 0.0, 0.0, 0.0, -vz, -vy, spare, False
    if steady and floor and rolling > 0.0 and vz < 0.0 and vy <= 0.0:
        vx, spin, normal, side, held = _rubbing(
            vx, -vz, -vy, spin, friction_static if spare >= 0.0 else friction_kinetic,
            friction_kinetic, wall_friction, rolling,
        )  # fmt: skip
        if normal >= 0.0 and side >= 0.0:
            return vx, 0.0, 0.0, spin, normal, side, math.inf if held else -1.0, False
        vx, spin = ux + h * ax, spin_before
    back_z, back_y = restitution * min(uz, 0.0), wall_restitution * min(uy, 0.0)
    # One contact may do, with nothing to iterate: the other parts by itself.
    wx, wy, wz, ws, normal, alone = floor_step(
        z, ux, uy, uz, spin, spare, pressed, ax, ay, az, h,
        restitution, friction_static, friction_kinetic, rolling,
    )  # fmt: skip
    if wy + back_y >= 0.0:
        return wx, wy, wz, ws, normal, 0.0, alone, False
    if not floor:
        side = -(vy + back_y)
        limit = wall_friction * side
        gx, gz, _ = friction_impulse(vx, vz - spin, limit, limit, response)
        return vx + gx, vy + side, vz + gz, spin - rolling * gz, 0.0, side, -1.0, False
    small = 1e-11 * h * (abs(ax) + abs(ay) + abs(az)) + 1e-15 * (abs(vx) + abs(vy) + abs(vz))
    normal, side = 0.0, 0.0
    fx, fy, wx, wz = 0.0, 0.0, 0.0, 0.0
    held, stopped, change = False, False, 0.0
    for sweep in range(MOST_SWEEPS):
        change = 0.0
        if floor:
            new = max(0.0, normal - (vz + back_z))
            vz += new - normal
            change += abs(new - normal)
            normal = new
        new = max(0.0, side - (vy + back_y))
        vy += new - side
        change += abs(new - side)
        side = new
        if floor:
            # Two coefficients have no potential: after half of the sweeps one of them decides.
            static = spare >= 0.0 and 2 * sweep < MOST_SWEEPS
            gx, gy, held = friction_impulse(
                vx - fx, vy + spin - response * fy,
                (friction_static if static else friction_kinetic) * normal,
                friction_kinetic * normal, response,
            )  # fmt: skip
            vx += gx - fx
            vy += gy - fy
            spin += rolling * (gy - fy)
            change += abs(gx - fx) + abs(gy - fy)
            fx, fy = gx, gy
        limit = wall_friction * side
        gx, gz, _ = friction_impulse(vx - wx, vz - spin - response * wz, limit, limit, response)
        vx += gx - wx
        vz += gz - wz
        spin -= rolling * (gz - wz)
        change += abs(gx - wx) + abs(gz - wz)
        wx, wz = gx, gz
        # The wall may stop what the floor could not.
        stopped = abs(vx) + abs(vy + spin) <= small
        if change <= small:
            break
    # Where sweeps creep, what they still change is less than the error of the step.
    failed = change > 1e-2 * h * (abs(ax) + abs(ay) + abs(az))
    if normal > 0.0 and (held or stopped):
        return 0.0, vy, vz, spin, normal, side, math.inf, failed
    return vx, vy, vz, spin, normal, side, -1.0, failed


@compiled
def count(
    tally: Floats, normal: float, pressed: bool, vx: float, uz: float, z: float,
    still: float, fall: float,
) -> None:  # fmt: skip
    """Count one step: which way it slid, whether it landed, how high it was."""
    if normal > 0.0:
        if vx > still:
            tally[FORWARD] += 1.0
        elif vx < -still:
            tally[BACKWARD] += 1.0
        else:
            tally[STICK] += 1.0
        if uz < 0.0 and not pressed:
            tally[LANDING] = max(tally[LANDING], -uz)
            if -uz > fall:
                tally[IMPACTS] += 1.0
    else:
        tally[FLIGHT] += 1.0
        tally[HEIGHT] = max(tally[HEIGHT], z)


@compiled
def planar_period(state: Floats, tally: Floats, cell: Floats, sines: Floats, h: float) -> None:
    """Advance a planar state by one period and tally it."""
    x, z, ux, uz = state[X], state[Z], state[UX], state[UZ]
    spare, pressed = state[SPARE], state[PRESSED] > 0.0
    along, normal_drive = cell[DRIVE_ALONG], cell[DRIVE_NORMAL]
    down, weight = cell[GRAVITY_ALONG], cell[GRAVITY_NORMAL]
    static, kinetic = cell[FRICTION_STATIC], cell[FRICTION_KINETIC]
    restitution = cell[RESTITUTION]
    still, fall, start, peak = 1e-6 * h, h * weight, x, 0.0
    for sine in sines:
        vx, vz, normal, spare = planar_step(
            z, ux, uz, spare, pressed, along * sine - down, normal_drive * sine - weight, h,
            restitution, static, kinetic,
        )  # fmt: skip
        x += 0.5 * h * (ux + vx)
        z += 0.5 * h * (uz + vz)
        count(tally, normal, pressed, vx, uz, z, still, fall)
        peak = max(peak, abs(vx) + abs(vz))
        pressed = normal > 0.0
        ux, uz = vx, vz
    state[X], state[Z], state[UX], state[UZ] = x, z, ux, uz
    state[SPARE], state[PRESSED] = spare, pressed
    tally[TRAVEL], tally[PEAK] = x - start, peak


@compiled
def spatial_period(
    wall: bool, rolling: float, absolute: bool, state: Floats, tally: Floats, cell: Floats,
    sines: Floats, cosines: Floats, h: float,
) -> None:  # fmt: skip
    """Advance a state in space by one period and tally it."""
    x, z, ux, uz = state[X], state[Z], state[UX], state[UZ]
    uy, spin = state[UY], state[SPIN]
    y = state[Y] if wall else 0.0
    spare, pressed = state[SPARE], state[PRESSED] > 0.0
    still, fall, start, peak = 1e-6 * h, h * cell[GRAVITY_NORMAL], x, 0.0
    leaning, failed = wall and state[LEANING] > 0.0, False
    for k in range(sines.size):
        ax, ay, az = acceleration(ux, sines[k], cosines[k], cell, absolute)
        if wall:
            vx, vy, vz, spin, normal, side, spare, failed = corner_step(
                y, z, ux, uy, uz, spin, spare, pressed, leaning, ax, ay, az, h,
                cell[RESTITUTION], cell[WALL_RESTITUTION],
                cell[FRICTION_STATIC], cell[FRICTION_KINETIC], cell[WALL_FRICTION], rolling,
            )  # fmt: skip
            y += 0.5 * h * (uy + vy)
            leaning = side > 0.0
            tally[AT_WALL] += leaning
            tally[FAILED] += failed
        else:
            vx, vy, vz, spin, normal, spare = floor_step(
                z, ux, uy, uz, spin, spare, pressed, ax, ay, az, h,
                cell[RESTITUTION], cell[FRICTION_STATIC], cell[FRICTION_KINETIC], rolling,
            )  # fmt: skip
        x += 0.5 * h * (ux + vx)
        z += 0.5 * h * (uz + vz)
        count(tally, normal, pressed, vx, uz, z, still, fall)
        peak = max(peak, abs(vx) + abs(vy) + abs(vz))
        pressed = normal > 0.0
        ux, uy, uz = vx, vy, vz
    state[X], state[Z], state[UX], state[UZ] = x, z, ux, uz
    state[UY], state[SPIN] = uy, spin
    state[SPARE], state[PRESSED] = spare, pressed
    if wall:
        state[Y], state[LEANING] = y, leaning
    tally[TRAVEL], tally[PEAK] = x - start, peak


@compiled
def acceleration(
    ux: float, sine: float, cosine: float, cell: Floats, absolute: bool
) -> tuple[float, float, float]:
    """Return the acceleration of a free part relative to the track (theory 13.1)."""
    speed = ux + cell[DRIVE_ALONG] * cosine if absolute else ux
    return (
        cell[DRIVE_ALONG] * sine - cell[GRAVITY_ALONG],
        cell[DRIVE_ACROSS] * sine - cell[GRAVITY_ACROSS] - cell[CURVATURE] * speed * speed,
        cell[DRIVE_NORMAL] * sine - cell[GRAVITY_NORMAL],
    )


@compiled
def difference(states: Floats, tallies: Floats, later: int, earlier: int) -> float:
    """Return how far two states at the ends of periods lie apart, as far as it matters.

    A part in contact stays where it sank in, at most a step of its fall deep: no difference. The
    distance from the wall does not matter to a part that did not touch it and moves away.
    """
    new, old = states[later], states[earlier]
    most = max(abs(new[UX] - old[UX]), abs(new[UZ] - old[UZ]))
    most = max(most, abs(max(new[Z], 0.0) - max(old[Z], 0.0)))
    if new.size > UY:
        most = max(most, abs(new[UY] - old[UY]), abs(new[SPIN] - old[SPIN]))
    if new.size > Y:
        touched = False
        for k in range(earlier, later):
            touched = touched or tallies[k, AT_WALL] > 0.0
        away = max(new[Y], 0.0) - max(old[Y], 0.0)
        most = max(most, abs(away) if touched else max(0.0, -away))
    return most


@compiled
def mean_velocity(tallies: Floats, first: int, last: int, period: float) -> float:
    """Return the mean velocity over the periods from `first` to before `last`."""
    travel = 0.0
    for k in range(first, last):
        travel += tallies[k, TRAVEL]
    return travel / ((last - first) * period)


@compiled
def limit(tallies: Floats, done: int, part: int, period: float) -> tuple[float, float]:
    """Return where the mean velocity drifts to, and how far it still is from there.

    From the means of three parts of so many periods: a transient dies out as a power, so that what
    is to come is the last change times ratio/(1 - ratio).
    """
    first = mean_velocity(tallies, done - 3 * part, done - 2 * part, period)
    second = mean_velocity(tallies, done - 2 * part, done - part, period)
    third = mean_velocity(tallies, done - part, done, period)
    last, before = third - second, second - first
    if last * before > 0.0 and abs(last) < abs(before):
        rest = last * last / (before - last)
        return third + rest, abs(last) + abs(rest)
    return third, abs(last)


@compiled
def settled(
    tallies: Floats, done: int, multiple: int, window: int, allowed: float,
    period: float, result: Floats,
) -> bool:  # fmt: skip
    """Return whether the mean velocity has settled; if so, put it and its doubt into the result.

    Motion that keeps to the floor converges smoothly, and slowly where friction is small: its
    limit is extrapolated, and must itself stand still. A part that hops may land on steps that vary
    from period to period; its mean is that of the window.
    """
    part = max(1, window // multiple // 3) * multiple
    if done < 4 * part:
        return False
    hops = False
    for k in range(done - 4 * part, done):
        hops = hops or tallies[k, FLIGHT] > 0.0
    end, rest = limit(tallies, done, part, period)
    if hops:
        if rest > 0.1 * allowed:
            return False
        result[NOISE] = rest
        return True
    before, _ = limit(tallies, done - part, part, period)
    if abs(end - before) > 1e-3 * allowed:
        return False
    result[VELOCITY] = end
    # What the extrapolation changed by, or at most would in what is left of the transient.
    result[NOISE] = max(2.0 * abs(end - before), 1e-3 * rest)
    return True


@compiled
def repeats(
    states: Floats, tallies: Floats, done: int, rounding: float, allowed: float, period: float,
    result: Floats,
) -> int:  # fmt: skip
    """Return after how many periods the motion repeats, and put its means into the result.

    0 if it does not. A state that comes back to rounding repeats for ever. Else slips and
    landings fall on steps that vary, and the state wanders by the order of a step; then it must
    come back to within that for a whole window, over the window as well, and its mean velocity must
    not drift, so that a slow transient is not taken for a repetition.
    """
    for multiple in range(1, min(MOST_MULTIPLE, done) + 1):
        now, then = states[done], states[done - multiple]
        if (
            difference(states, tallies, done, done - multiple) <= rounding
            and abs(now[Z] - then[Z]) <= rounding
            and (now[SPARE] >= 0.0) == (then[SPARE] >= 0.0)
        ):
            means(tallies, done - multiple, done, period, result)
            return multiple
    for multiple in range(1, MOST_MULTIPLE + 1):
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
            means(tallies, done - window, done, period, result)
            if settled(tallies, done, multiple, window, bound, period, result):
                return multiple
    return 0


@compiled
def means(tallies: Floats, first: int, last: int, period: float, result: Floats) -> None:
    """Put the means over the periods from `first` to before `last` into a result."""
    periods = last - first
    result[:] = 0.0
    travel = 0.0
    for k in range(first, last):
        travel += tallies[k, TRAVEL]
        result[R_STICK] += tallies[k, STICK]
        result[R_FORWARD] += tallies[k, FORWARD]
        result[R_BACKWARD] += tallies[k, BACKWARD]
        result[R_FLIGHT] += tallies[k, FLIGHT]
        result[R_IMPACTS] += tallies[k, IMPACTS]
        result[R_LANDING] = max(result[R_LANDING], tallies[k, LANDING])
        result[R_HEIGHT] = max(result[R_HEIGHT], tallies[k, HEIGHT])
    result[VELOCITY] = travel / (periods * period)
    counted = result[R_STICK] + result[R_FORWARD] + result[R_BACKWARD] + result[R_FLIGHT]
    result[R_STICK : R_FLIGHT + 1] /= counted
    result[R_IMPACTS] /= periods


@compiled
def unsettled(
    scene: int, cell: Floats, states: Floats, tallies: Floats, done: int, period: float,
    result: Floats,
) -> int:  # fmt: skip
    """Return the status of a motion that did not repeat; put the spread of its batches."""
    quarter = done // 4
    first = mean_velocity(tallies, quarter, 2 * quarter, period)
    second = mean_velocity(tallies, 2 * quarter, 3 * quarter, period)
    third = mean_velocity(tallies, 3 * quarter, 4 * quarter, period)
    gain, before = third - second, second - first
    trend = gain * before > 0.0 and abs(gain) > 0.2 * abs(before)
    # At high speed friction is mu_k times the weight, whether the part hops or not.
    friction = cell[FRICTION_KINETIC] * cell[GRAVITY_NORMAL]
    pull = abs(cell[GRAVITY_ALONG])
    if scene == FLOOR:
        pull = math.hypot(pull, cell[GRAVITY_ACROSS])
        # Without a wall a part on a lean may slide or roll away across.
        late = states[done, UY] - states[done - quarter, UY]
        early = states[done - quarter, UY] - states[done - 2 * quarter, UY]
        if late * early > 0.0 and abs(late) > 0.5 * abs(early) and abs(late) > quarter * 1e-3:
            return RUNAWAY
    if scene == WALL:
        friction += cell[WALL_FRICTION] * max(0.0, cell[GRAVITY_ACROSS])
    if trend and pull >= friction and abs(gain) > 0.5 * abs(before):
        return RUNAWAY
    batch = max(1, (done - quarter) // BATCHES)
    square, centre = 0.0, mean_velocity(tallies, done - BATCHES * batch, done, period)
    for k in range(BATCHES):
        start = done - (k + 1) * batch
        square += (mean_velocity(tallies, start, start + batch, period) - centre) ** 2
    result[SPREAD] = math.sqrt(square / (BATCHES - 1))
    # A trend far above the scatter of the batches' differences is a transient not yet over.
    if trend and abs(gain) > 2.0 * result[SPREAD] / math.sqrt(BATCHES / 3.0):
        return LIMIT_REACHED
    return APERIODIC


@compiled
def run(
    scene: int, cell: Floats, rolling: float, absolute: bool, sines: Floats, cosines: Floats,
    h: float, most: int, tolerance: float, states: Floats, tallies: Floats, result: Floats,
) -> int:  # fmt: skip
    """Run one cell from rest until it repeats; fill the result and return the status."""
    steps = sines.size
    # The largest acceleration: what a step can change in a velocity, by the place of an event.
    scale = 0.0
    for k in range(DRIVE_ALONG, GRAVITY_NORMAL + 1):
        scale += abs(cell[k])
    width = WIDTHS[scene]
    state = np.zeros(width)
    state[SPARE], state[PRESSED] = math.inf, 1.0
    if scene == WALL:
        state[LEANING] = 1.0
    states[0, :width] = state
    seen = states[:, :width]
    done = 0
    for period in range(most):
        tally = tallies[period]
        tally[:] = 0.0
        if scene == PLANAR:
            planar_period(state, tally, cell, sines, h)
        else:
            spatial_period(scene == WALL, rolling, absolute, state, tally, cell, sines, cosines, h)
        done = period + 1
        seen[done] = state
        if not math.isfinite(tally[PEAK]) or tally[FAILED] > 0.0:
            result[:] = np.nan
            return NO_SOLUTION
        if tally[PEAK] <= 1e-9 * h:
            means(tallies, period, done, steps * h, result)
            result[VELOCITY], result[MULTIPLE] = 0.0, 1.0
            return AT_REST
        multiple = repeats(
            seen, tallies, done, 1e-12 * scale, tolerance * h * scale, steps * h, result
        )
        if multiple > 0:
            result[MULTIPLE] = multiple
            return PERIODIC
    means(tallies, done // 4, done, steps * h, result)
    return unsettled(scene, cell, seen, tallies, done, steps * h, result)


@compiled
def push_of(scene: int, cell: Floats) -> float:
    """Return what can change the velocity along the track in a unit of phase."""
    load = abs(cell[DRIVE_NORMAL]) + cell[GRAVITY_NORMAL]
    push = abs(cell[DRIVE_ALONG]) + abs(cell[GRAVITY_ALONG]) + cell[FRICTION_KINETIC] * load
    if scene == WALL:
        push += cell[WALL_FRICTION] * (abs(cell[DRIVE_ACROSS]) + abs(cell[GRAVITY_ACROSS]))
    return push


@compiled
def step_cells(
    scene: int, rolling: float, absolute: bool, waves: Floats, shifted_waves: Floats,
    fine_waves: Floats, most: int, tolerance: float, groups: Floats, table: Floats,
    status: NDArray[np.int8],
) -> None:  # fmt: skip
    """Fill the table of `core.motion.motion.Motion` and the statuses, one cell a row.

    The waves hold sine and cosine at the middles of the steps, in rows: of the coarser run, of one
    that starts half a step earlier, and of the finer.
    """
    states, tallies = np.zeros((most + 1, WIDTHS[scene])), np.zeros((most, TALLIES))
    coarse, shifted, fine = np.zeros(RESULTS), np.zeros(RESULTS), np.zeros(RESULTS)
    period = 2.0 * math.pi
    for i in range(groups.shape[0]):
        cell = groups[i]
        table[i] = np.nan
        if not np.all(np.isfinite(cell)) or cell[GRAVITY_NORMAL] <= 0.0:
            status[i] = NO_SOLUTION
            continue
        found = run(
            scene, cell, rolling, absolute, fine_waves[0], fine_waves[1],
            period / fine_waves.shape[1], most, tolerance, states, tallies, fine,
        )  # fmt: skip
        frictionless = cell[FRICTION_STATIC] == 0.0 and cell[FRICTION_KINETIC] == 0.0
        if scene == WALL:
            frictionless = frictionless and cell[WALL_FRICTION] == 0.0
        if frictionless and found != NO_SOLUTION and found != AT_REST:
            found = NEUTRAL if cell[GRAVITY_ALONG] == 0.0 else RUNAWAY
        status[i] = found
        if found in (NO_SOLUTION, RUNAWAY):
            continue
        step = period / waves.shape[1]
        run(
            scene, cell, rolling, absolute, waves[0], waves[1], step,
            most, tolerance, states, tallies, coarse,
        )  # fmt: skip
        apart = abs(fine[VELOCITY] - coarse[VELOCITY])
        if not math.isfinite(apart):  # the coarser run found no solution in a step
            apart = abs(fine[VELOCITY])
        error = max(apart, fine[NOISE], fine[SPREAD])
        if error > 1e-12:
            # Where in a step landings and stops fall is chance, and may hide the error of the step.
            run(
                scene, cell, rolling, absolute, shifted_waves[0], shifted_waves[1], step,
                most, tolerance, states, tallies, shifted,
            )  # fmt: skip
            apart = abs(fine[VELOCITY] - shifted[VELOCITY])
            error = SAFETY * max(error, apart if math.isfinite(apart) else 0.0)
        if fine[R_FLIGHT] > 0.0:
            # All three runs may agree by chance. A landing falls anywhere within a step.
            error += LANDING_SHARE * period / fine_waves.shape[1] * push_of(scene, cell)
        table[i, 0] = fine[VELOCITY]
        table[i, 1] = fine[SPREAD]
        table[i, 2] = error
        table[i, 3:] = fine[R_STICK:]


@compiled
def path(
    wall: bool, rolling: float, absolute: bool, cell: Floats, phases: Floats, h: float,
    steps: int, start: Floats, position: Floats, velocity: Floats,
) -> None:  # fmt: skip
    """Fill position and velocity (n, 3) at ascending phases, from x, y, z, u_x, u_y, u_z, spin.

    Within a step the velocity is taken as linear, as the scheme itself does. What comes after a
    step without a solution is left as it was.
    """
    x, y, z, ux, uy, uz, spin = start
    resting = ux == 0.0 and uy + spin == 0.0 and uz == 0.0 and z <= 0.0
    spare = math.inf if resting else -1.0
    pressed, leaning = uz == 0.0 and z <= 0.0, uy == 0.0 and y <= 0.0
    begin, given = phases[0], 0
    for k in range(steps):
        tau = begin + (k + 0.5) * h
        before = spin
        ax, ay, az = acceleration(ux, math.sin(tau), math.cos(tau), cell, absolute)
        if wall:
            vx, vy, vz, spin, normal, side, spare, failed = corner_step(
                y, z, ux, uy, uz, before, spare, pressed, leaning, ax, ay, az, h,
                cell[RESTITUTION], cell[WALL_RESTITUTION],
                cell[FRICTION_STATIC], cell[FRICTION_KINETIC], cell[WALL_FRICTION], rolling,
            )  # fmt: skip
            leaning = side > 0.0
            if failed:
                break
        else:
            vx, vy, vz, spin, normal, spare = floor_step(
                z, ux, uy, uz, before, spare, pressed, ax, ay, az, h,
                cell[RESTITUTION], cell[FRICTION_STATIC], cell[FRICTION_KINETIC], rolling,
            )  # fmt: skip
        while given < phases.size and (phases[given] - begin <= (k + 1) * h or k == steps - 1):
            s = (phases[given] - begin) / h - k
            position[given, 0] = x + s * h * (ux + 0.5 * s * (vx - ux))
            position[given, 1] = y + s * h * (uy + 0.5 * s * (vy - uy))
            position[given, 2] = z + s * h * (uz + 0.5 * s * (vz - uz))
            velocity[given, 0] = ux + s * (vx - ux)
            velocity[given, 1] = uy + s * (vy - uy)
            velocity[given, 2] = uz + s * (vz - uz)
            given += 1
        x += 0.5 * h * (ux + vx)
        y += 0.5 * h * (uy + vy)
        z += 0.5 * h * (uz + vz)
        pressed = normal > 0.0
        ux, uy, uz = vx, vy, vz
