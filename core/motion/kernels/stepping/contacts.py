"""The contacts in one step: floor, wall and friction, each scene by itself."""

from __future__ import annotations

import math
from typing import NamedTuple

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.cells import Cell

MAX_SWEEPS = 200
"""Sweeps of Gauss and Seidel over both contacts, each of which shrinks what is left by mu_s mu_w:
at a product of 0.83 to 1e-16. What wedges creeps on; it is judged by the error of the step."""
MAX_NEWTON = 60
"""Newton's steps from the left on a concave function: even if each did no more than halve the
error, 47 would end it."""


class BodyState(NamedTuple):
    """A part above the floor: height, velocities relative to the track, and spin.

    The spin is the velocity across that it gives the lowest point (theory 7.3).
    """

    z: float
    ux: float
    uy: float
    uz: float
    spin: float


class Touch(NamedTuple):
    """The contact with the floor after a step: `pressed` if it carried the part, and `spare`.

    `spare` is the impulse that static friction could still take in g/w, negative for a slip,
    infinite if unknown (see `slip_along`).
    """

    spare: float
    pressed: bool


class Push(NamedTuple):
    """The acceleration of a free part in the middle of a step in g, and the step's length h.

    h is in rad.
    """

    ax: float
    ay: float
    az: float
    h: float


class FloorLaws(NamedTuple):
    """Restitution and friction of the floor, and m r^2/I of a cylinder (0 for a block).

    Not the whole cell: what is handed to a step takes time.
    """

    restitution: float
    friction_static: float
    friction_kinetic: float
    rolling: float


@compiled
def floor_laws(cell: Cell, rolling: float) -> FloorLaws:
    """Return the numbers of the floor out of a cell's numbers."""
    return FloorLaws(cell.restitution, cell.friction_static, cell.friction_kinetic, rolling)


class Wall(NamedTuple):
    """The wall: a part's distance from it, if it carried the part, restitution and friction."""

    y: float
    leaning: bool
    restitution: float
    friction: float


class Stepped(NamedTuple):
    """The end of a step: velocities and spin in g/w, the floor's normal impulse, and `spare`.

    `spare` is what static friction could still take (see `slip_along`).
    """

    vx: float
    vy: float
    vz: float
    spin: float
    normal: float
    spare: float


Cornered = tuple[Stepped, float, bool]
"""What a step at a wall ends with: also the normal impulse of the wall, and whether it failed.

It fails where the contacts have no solution that is known well enough.
"""


@compiled
def friction_impulse(
    slip_1: float, slip_2: float, hold: float, slide: float, response: float
) -> tuple[float, float, bool]:
    """Return the friction impulse (two components) at one contact, and True if it sticks.

    Per mass, in g/w (w = 2 pi f). The slip (`slip_1`, `slip_2`) is that without the impulse; a unit
    impulse changes it by 1 and by r = `response`. It sticks if an impulse of at most `hold` can
    stop it; else the impulse is -q e, with q = `slide` and e = (s_1/(z + q), s_2/(z + r q)) along
    the slip that is left, where |e| = 1 gives z: the secular equation of theory 7.3.
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
    for _ in range(MAX_NEWTON):
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
    """Return the slip along one axis after a time step, and the static friction left unused.

    Both in g/w (w = 2 pi f). A step with a start, stop or reversal of the slip is cut there, where
    the force passes what friction holds (on a straight line between the middles of this step and
    the one before) or the slip is zero: otherwise the error depends on where in the step that is,
    and two step lengths may agree on the same error (theory 13.9).

    Parameters
    ----------
    slip
        Slip u before the step.
    push
        Its change h a without friction.
    hold, slide
        Impulses that static and kinetic friction can give, H and Q: the slip stays 0 while |h a| <=
        H, else it becomes u + h a - Q sign(u).
    spare
        H - |h a| of the step before: negative if the contact slipped, infinite if it is unknown.
        The second result is the same of this step, -1 for a slip.
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
    cell: Cell,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Return velocities, normal impulse and unused static friction after a time step in the plane.

    In units of g and w = 2 pi f: v = u + h a + i if z + h u_z/2 <= 0, with the normal impulse i
    that leaves v_z = -eps u_z. Static friction holds a contact that was `pressed` and stuck, or
    whose slip comes to zero; all other slip, and that of a landing, is kinetic (theory 13.9).

    Parameters
    ----------
    z, ux, uz
        Height and velocities before the step.
    spare, pressed
        Unused static friction in the step before (negative for a slip, infinite if unknown), and
        True if the floor carried the part then.
    ax, az, h
        Acceleration without contact, and length of the step in rad.
    cell
        The part's numbers.
    """
    vx, vz = ux + h * ax, uz + h * az
    if z + 0.5 * h * uz > 0.0:
        return vx, vz, 0.0, -1.0
    normal = -(vz + cell.restitution * min(uz, 0.0))
    if normal <= 0.0:
        return vx, vz, 0.0, -1.0
    vz += normal
    slide = cell.friction_kinetic * normal
    if pressed:
        vx, spare = slip_along(ux, h * ax, cell.friction_static * normal, slide, spare)
        return vx, vz, normal, spare
    if abs(vx) <= slide:
        return 0.0, vz, normal, math.inf
    return vx - math.copysign(slide, vx), vz, normal, -1.0


@compiled
def floor_step(body: BodyState, touch: Touch, push: Push, laws: FloorLaws) -> Stepped:
    """Return the state of a part after a time step on a floor without wall, in space.

    As in the plane, with a slip (u_x, u_y + spin): the friction impulse (f_x, f_y) changes it by
    (f_x, r f_y), r = 1 + m r^2/I, and the spin by (r - 1) f_y. A step is cut where a slip starts,
    stops, or is least if it turns (theory 13.9).

    `body` is the state before in g/w^2 and g/w (w = 2 pi f), `touch` says if the floor carried the
    part before and what static friction had left, `push` is the acceleration in g and length h of
    the step in rad, `laws` has restitution and friction. The result has velocities, spin, normal
    impulse, and what static friction has left: negative for a slip, infinite if unknown.
    """
    h, rolling = push.h, laws.rolling
    vx, vy, vz = body.ux + h * push.ax, body.uy + h * push.ay, body.uz + h * push.az
    if body.z + 0.5 * h * body.uz > 0.0:
        return Stepped(vx, vy, vz, body.spin, 0.0, -1.0)
    normal = -(vz + laws.restitution * min(body.uz, 0.0))
    if normal <= 0.0:
        return Stepped(vx, vy, vz, body.spin, 0.0, -1.0)
    vz += normal
    response = 1.0 + rolling
    slide = laws.friction_kinetic * normal
    hold = max(laws.friction_static * normal, slide)
    vs = vy + body.spin
    left_x, left_y = 0.0, 0.0  # impulse before the cut
    rest_x, rest_y, share = vx, vs, 1.0  # slip at its end with the push of what is left
    if touch.pressed and touch.spare >= 0.0:
        need = math.hypot(vx, vs / response)
        if need <= hold:
            return held_state(vy, vz, body.spin, normal, hold - need, rolling)
        if touch.spare < math.inf:
            share = 0.5 + (need - hold) / (need - hold + touch.spare)
        left_x, left_y = -(1.0 - share) * vx, -(1.0 - share) * vs / response
        rest_x, rest_y, hold = share * vx, share * vs, 0.0
    elif touch.pressed:
        us = body.uy + body.spin
        speed = math.hypot(body.ux, us)
        if speed > 0.0:
            ex, ey = -slide * body.ux / speed, -slide * us / speed
            end_x, end_y = vx + ex, vs + response * ey
            along = body.ux * end_x + us * end_y
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
        if touch.pressed:
            spare = max(0.0, hold - math.hypot(h * push.ax, h * push.ay / response))
        return held_state(vy, vz, body.spin, normal, spare, rolling)
    fx += left_x
    fy += left_y
    return Stepped(vx + fx, vy + fy, vz, body.spin + rolling * fy, normal, -1.0)


@compiled
def held_state(
    vy: float, vz: float, spin: float, normal: float, spare: float, rolling: float
) -> Stepped:
    """Return the state after a time step in which the contact with the floor sticks: no slip.

    `vy`, `vz`, `spin` are velocities and spin without friction, `normal` the normal impulse, in g/w
    (w = 2 pi f); a cylinder (`rolling` = m r^2/I > 0) rolls on with v_y - (v_y + spin)/(1 + m
    r^2/I) and a spin of minus that, a block stops. `spare`, the static friction left unused, is
    handed on.
    """
    if rolling == 0.0:
        return Stepped(0.0, 0.0, vz, 0.0, normal, spare)
    vy -= (vy + spin) / (1.0 + rolling)
    return Stepped(0.0, vy, vz, -vy, normal, spare)


@compiled
def rubbing(
    vx: float, floor_load: float, wall_load: float, spin: float, static: float, kinetic: float,
    wall_friction: float, rolling: float,
) -> tuple[float, float, float, float, bool]:  # fmt: skip
    """Return velocity, spin, both normal impulses and True if it sticks, of a cylinder in a corner.

    It spins between floor and wall and rubs on both, with the slip (u_x, spin) at each, the wall's
    spin being negative. Friction at each presses on the other or lifts it: n = n0 + mu_w S e_s and
    S = S0 - mu n e_s, with the share e_s of friction that turns the cylinder, solved by turns.
    Normal impulses of -1 tell that there is no solution. Velocities and impulses per mass are in
    g/w (w = 2 pi f).

    Parameters
    ----------
    vx, spin
        Velocities along and of spin without friction.
    floor_load, wall_load
        Normal impulses n0, S0 without friction.
    static, kinetic
        Friction coefficients of the floor.
    wall_friction
        Friction coefficient mu_w of the wall.
    rolling
        m r^2/I of the cylinder (radius r, moment of inertia I).
    """
    normal, side = floor_load, wall_load
    fx, turn, held = 0.0, 0.0, False
    for _ in range(MAX_SWEEPS):
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
def corner_step(wall: Wall, body: BodyState, touch: Touch, push: Push, laws: FloorLaws) -> Cornered:
    """Return the state after a time step of a part at floor and wall, and the wall's impulse.

    A contact takes part if its gap is closed in the middle of the step, z + h u_z/2 <= 0 and y + h
    u_y/2 <= 0 (theory 13.9). A part that keeps to floor and wall without spin slips along one axis
    only, where friction holds up to mu_s n + mu_w S (theory 4.4).

    `wall` and `laws` have restitution and friction of wall and floor, `body` the state before in
    g/w^2 and g/w (w = 2 pi f), `touch` the contact with the floor before, `push` the acceleration
    in g and length h of the step in rad. The second result is the wall's impulse S in g/w, the
    third True if no solution was found.
    """
    h, spare, spin, rolling = push.h, touch.spare, body.spin, laws.rolling
    if not wall.y + 0.5 * h * body.uy <= 0.0:
        return floor_step(body, touch, push, laws), 0.0, False
    floor = body.z + 0.5 * h * body.uz <= 0.0
    vx, vy, vz = body.ux + h * push.ax, body.uy + h * push.ay, body.uz + h * push.az
    steady = touch.pressed and (wall.leaning or body.uy == 0.0)
    if steady and floor and vz < 0.0 and vy <= 0.0:
        static, kinetic = laws.friction_static, laws.friction_kinetic
        if spin == 0.0:
            limit = wall.friction * -vy
            vx, spare = slip_along(
                body.ux, h * push.ax, static * -vz + limit, kinetic * -vz + limit, spare
            )
            return Stepped(vx, 0.0, 0.0, 0.0, -vz, spare), -vy, False
        if rolling > 0.0:
            slip, turn, normal, side, held = rubbing(
                vx, -vz, -vy, spin, static if spare >= 0.0 else kinetic, kinetic,
                wall.friction, rolling,
            )  # fmt: skip
            if normal >= 0.0 and side >= 0.0:
                spare = math.inf if held else -1.0
                return Stepped(slip, 0.0, 0.0, turn, normal, spare), side, False
    # One contact may do, with nothing to iterate: the other parts by itself.
    alone = floor_step(body, touch, push, laws)
    back = wall.restitution * min(body.uy, 0.0)
    if alone.vy + back >= 0.0:
        return alone, 0.0, False
    if not floor:
        side, response = -(vy + back), 1.0 + rolling
        limit = wall.friction * side
        gx, gz, _ = friction_impulse(vx, vz - spin, limit, limit, response)
        after = Stepped(vx + gx, vy + side, vz + gz, spin - rolling * gz, 0.0, -1.0)
        return after, side, False
    return sweep_corner(wall, body, spare, push, laws)


@compiled
def sweep_corner(
    wall: Wall, body: BodyState, spare: float, push: Push, laws: FloorLaws
) -> Cornered:
    """Return the state after a time step in which floor and wall both carry the part, by iteration.

    Projected Gauss-Seidel: each sweep solves one contact after the other, normal impulses n =
    max(0, n - v_z - eps u_z) of the floor and S = max(0, S - v_y - eps_w u_y) of the wall first,
    then the frictions. Normals first, because among several solutions the one without wedging
    between floor and wall is wanted: friction then holds the part up to mu_s n + mu_w S.

    Parameters
    ----------
    wall, laws
        Restitution and friction of wall and floor.
    body
        Velocities and spin before the step, in g/w (w = 2 pi f).
    spare
        Unused static friction of the floor in the step before; negative if the part slipped there.
    push
        Acceleration of the free part in g, and length h of the step in rad.

    Returns
    -------
    The new state `Stepped` (velocities, spin, floor impulse n, spare static friction: infinite if
    the part sticks, -1 if it slips), the wall's impulse S, and True if the sweeps did not converge.
    """
    h, rolling, spin = push.h, laws.rolling, body.spin
    response = 1.0 + rolling
    vx, vy, vz = body.ux + h * push.ax, body.uy + h * push.ay, body.uz + h * push.az
    back_z = laws.restitution * min(body.uz, 0.0)
    back_y = wall.restitution * min(body.uy, 0.0)
    pushed = abs(push.ax) + abs(push.ay) + abs(push.az)
    small = 1e-11 * h * pushed + 1e-15 * (abs(vx) + abs(vy) + abs(vz))
    normal, side = 0.0, 0.0
    fx, fy, wx, wz = 0.0, 0.0, 0.0, 0.0
    held, stopped, change = False, False, 0.0
    for sweep in range(MAX_SWEEPS):
        change = 0.0
        new = max(0.0, normal - (vz + back_z))
        vz += new - normal
        change += abs(new - normal)
        normal = new
        new = max(0.0, side - (vy + back_y))
        vy += new - side
        change += abs(new - side)
        side = new
        # Two coefficients have no potential: after half of the sweeps one of them decides.
        static = spare >= 0.0 and 2 * sweep < MAX_SWEEPS
        gx, gy, held = friction_impulse(
            vx - fx, vy + spin - response * fy,
            (laws.friction_static if static else laws.friction_kinetic) * normal,
            laws.friction_kinetic * normal, response,
        )  # fmt: skip
        vx += gx - fx
        vy += gy - fy
        spin += rolling * (gy - fy)
        change += abs(gx - fx) + abs(gy - fy)
        fx, fy = gx, gy
        limit = wall.friction * side
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
    failed = change > 1e-2 * h * pushed
    if normal > 0.0 and (held or stopped):
        return Stepped(0.0, vy, vz, spin, normal, math.inf), side, failed
    return Stepped(vx, vy, vz, spin, normal, -1.0), side, failed
