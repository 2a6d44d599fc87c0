"""The contacts in one step: floor, wall and friction, each scene by itself."""

from __future__ import annotations

import math

from core.compiled import compiled

MOST_SWEEPS = 200


@compiled
def friction_impulse(
    slip_1: float, slip_2: float, hold: float, slide: float, response: float
) -> tuple[float, float, bool]:
    """Return the impulse of friction at one contact, two components, and whether it sticks.

    The slip is that without the impulse; a unit impulse changes it by 1 and by `response`. It
    sticks if an impulse within the disc of radius `hold` can stop the slip; else the impulse is
    -q e, with q = `slide` and e = (s_1/(z + q), s_2/(z + r q)) along the slip that is left, where
    |e| = 1 gives z: the secular equation of theory 7.3, with the response r.
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
            return held_state(vy, vz, spin, normal, hold - need, rolling)
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
        return held_state(vy, vz, spin, normal, spare, rolling)
    fx += left_x
    fy += left_y
    return vx + fx, vy + fy, vz, spin + rolling * fy, normal, -1.0


@compiled
def held_state(
    vy: float, vz: float, spin: float, normal: float, spare: float, rolling: float
) -> tuple[float, float, float, float, float, float]:
    """Return the state after a step in which the contact came to stick: no slip, exactly."""
    if rolling == 0.0:
        return 0.0, 0.0, vz, 0.0, normal, spare
    vy -= (vy + spin) / (1.0 + rolling)
    return 0.0, vy, vz, -vy, normal, spare


@compiled
def rubbing(
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
        vx, spin, normal, side, held = rubbing(
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
