"""One period of the drive, step by step."""

from __future__ import annotations

import math

from core.compiled import compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.cells import Cell
from core.motion.kernels.results import TALLY
from core.motion.kernels.stepping.contacts import corner_step, floor_step, planar_step
from core.motion.kernels.stepping.tables import DRIVE, STATE


@compiled
def count(
    tally: Floats, share: float, normal: float, pressed: bool, vx: float, uz: float, z: float,
    still: float, fall: float,
) -> None:  # fmt: skip
    """Count one step, by its share: which way it slid, whether it landed, how high it was."""
    if normal > 0.0:
        if vx > still:
            tally[TALLY.forward] += share
        elif vx < -still:
            tally[TALLY.backward] += share
        else:
            tally[TALLY.stick] += share
        if uz < 0.0 and not pressed:
            tally[TALLY.landing] = max(tally[TALLY.landing], -uz)
            if -uz > fall:
                tally[TALLY.impacts] += 1.0
    else:
        tally[TALLY.flight] += share
        tally[TALLY.height] = max(tally[TALLY.height], z)


@compiled
def planar_period(state: Floats, tally: Floats, cell: Cell, drive: Floats, usual: float) -> None:
    """Advance a planar state by one period and tally it; a step is usually so long."""
    x, z, ux, uz = state[STATE.x], state[STATE.z], state[STATE.ux], state[STATE.uz]
    spare, pressed = state[STATE.spare], state[STATE.pressed] > 0.0
    pushes, lifts, jumps = drive[DRIVE.along], drive[DRIVE.normal], drive[DRIVE.jump]
    lengths, shares = drive[DRIVE.length], drive[DRIVE.share]
    down, weight = cell.gravity_number_along, cell.gravity_number_normal
    static, kinetic = cell.friction_static, cell.friction_kinetic
    restitution = cell.restitution
    still, fall, start, peak = 1e-6 * usual, usual * weight, x, 0.0
    for k in range(pushes.size):
        h = lengths[k]
        if jumps[k] > 0.0:
            spare = after_jump(spare)
        vx, vz, normal, spare = planar_step(
            z, ux, uz, spare, pressed, pushes[k] - down, lifts[k] - weight, h,
            restitution, static, kinetic,
        )  # fmt: skip
        x += 0.5 * h * (ux + vx)
        z += 0.5 * h * (uz + vz)
        count(tally, shares[k], normal, pressed, vx, uz, z, still, fall)
        peak = max(peak, abs(vx) + abs(vz))
        pressed = normal > 0.0
        ux, uz = vx, vz
    state[STATE.x], state[STATE.z], state[STATE.ux], state[STATE.uz] = x, z, ux, uz
    state[STATE.spare], state[STATE.pressed] = spare, pressed
    tally[TALLY.travel], tally[TALLY.peak] = x - start, peak


@compiled
def spatial_period(
    wall: bool, rolling: float, absolute: bool, state: Floats, tally: Floats, cell: Cell,
    drive: Floats, usual: float,
) -> None:  # fmt: skip
    """Advance a state in space by one period and tally it; a step is usually so long."""
    x, z, ux, uz = state[STATE.x], state[STATE.z], state[STATE.ux], state[STATE.uz]
    uy, spin = state[STATE.uy], state[STATE.spin]
    y = state[STATE.y] if wall else 0.0
    spare, pressed = state[STATE.spare], state[STATE.pressed] > 0.0
    still, fall, start, peak = 1e-6 * usual, usual * cell.gravity_number_normal, x, 0.0
    leaning, failed = wall and state[STATE.leaning] > 0.0, False
    across = y
    for k in range(drive.shape[1]):
        h = drive[DRIVE.length, k]
        if drive[DRIVE.jump, k] > 0.0:
            spare = after_jump(spare)
        ax, ay, az = acceleration(
            ux, drive[DRIVE.along, k], drive[DRIVE.across, k], drive[DRIVE.normal, k],
            drive[DRIVE.speed, k], cell, absolute,
        )  # fmt: skip
        if wall:
            vx, vy, vz, spin, normal, side, spare, failed = corner_step(
                y, z, ux, uy, uz, spin, spare, pressed, leaning, ax, ay, az, h,
                cell.restitution, cell.wall_restitution,
                cell.friction_static, cell.friction_kinetic, cell.wall_friction, rolling,
            )  # fmt: skip
            leaning = side > 0.0
            tally[TALLY.at_wall] += leaning
            tally[TALLY.failed] += failed
        else:
            vx, vy, vz, spin, normal, spare = floor_step(
                z, ux, uy, uz, spin, spare, pressed, ax, ay, az, h,
                cell.restitution, cell.friction_static, cell.friction_kinetic, rolling,
            )  # fmt: skip
        x += 0.5 * h * (ux + vx)
        y += 0.5 * h * (uy + vy)
        z += 0.5 * h * (uz + vz)
        count(tally, drive[DRIVE.share, k], normal, pressed, vx, uz, z, still, fall)
        peak = max(peak, abs(vx) + abs(vy) + abs(vz))
        pressed = normal > 0.0
        ux, uy, uz = vx, vy, vz
    state[STATE.x], state[STATE.z], state[STATE.ux], state[STATE.uz] = x, z, ux, uz
    state[STATE.uy], state[STATE.spin] = uy, spin
    state[STATE.spare], state[STATE.pressed] = spare, pressed
    if wall:
        state[STATE.y], state[STATE.leaning] = y, leaning
    tally[TALLY.travel], tally[TALLY.peak] = x - start, peak
    tally[TALLY.across] = 0.0 if rolling > 0.0 else y - across


@compiled
def acceleration(
    ux: float, along: float, across: float, normal: float, track: float, cell: Cell,
    absolute: bool,
) -> tuple[float, float, float]:  # fmt: skip
    """Return the acceleration of a free part relative to the track, a = b - g (theory 13.1).

    Across, -kappa (u_x + v_x)^2 more: from the three components of the push b, and the speed v_x of
    the track along, where the speed in the curve is the absolute one.
    """
    speed = ux + track if absolute else ux
    return (
        along - cell.gravity_number_along,
        across - cell.gravity_number_across - cell.curvature_number * speed * speed,
        normal - cell.gravity_number_normal,
    )


@compiled
def after_jump(spare: float) -> float:
    """Return `spare` where the push has jumped: the step before tells nothing of it."""
    return math.inf if spare >= 0.0 else spare
