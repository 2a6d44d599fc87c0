"""One period of the drive, step by step."""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.cells import Cell
from vibrafeed.core.motion.kernels.results import TALLY
from vibrafeed.core.motion.kernels.stepping.contacts import (
    BodyState,
    Push,
    Touch,
    Wall,
    corner_step,
    floor_laws,
    floor_step,
    planar_step,
)
from vibrafeed.core.motion.kernels.stepping.tables import DRIVE, STATE


@compiled
def count(
    tally: Floats, share: float, normal: float, pressed: bool, vx: float, uz: float, z: float,
    still: float, fall: float,
) -> None:  # fmt: skip
    """Add one time step to the sums of a period: its mode, a landing, the height.

    Forward if v_x > `still`, backward if v_x < -`still`, else stick; flight if the floor gives no
    impulse `normal`. A landing faster than `fall`, the speed that gravity gives in a step, counts
    as an impact. `share` is the length of the step over that of a usual one; `pressed` is True if
    the floor carried the part before, `vx` is the velocity along after the step, `uz` the normal
    velocity before, `z` the height after; in g/w (w = 2 pi f) and g/w^2. `tally` has the columns of
    `TALLY`.
    """
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
    """Advance the state of a part in the plane by one period of the drive, and add up its times.

    By time stepping: each step of h rad from velocity u to v moves the part by h (u + v)/2 (theory
    13.9). `state` and `tally` have the columns of `STATE` and `TALLY`, in g/w and g/w^2 (w = 2 pi
    f); `cell` holds the part's numbers, `drive` the rows of `DRIVE` and a column a step; `usual` is
    the length of most steps in rad.
    """
    x, z, ux, uz = state[STATE.x], state[STATE.z], state[STATE.ux], state[STATE.uz]
    spare, pressed = state[STATE.spare], state[STATE.pressed] > 0.0
    pushes, lifts, jumps = drive[DRIVE.along], drive[DRIVE.normal], drive[DRIVE.jump]
    lengths, shares = drive[DRIVE.length], drive[DRIVE.share]
    down, weight = cell.gravity_number_along, cell.gravity_number_normal
    still, fall, start, peak = 1e-6 * usual, usual * weight, x, 0.0
    for k in range(pushes.size):
        h = lengths[k]
        if jumps[k] > 0.0:
            spare = after_jump(spare)
        vx, vz, normal, spare = planar_step(
            z, ux, uz, spare, pressed, pushes[k] - down, lifts[k] - weight, h, cell
        )
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
    """Advance the state of a part in space by one period of the drive, and add up its times.

    By time stepping (theory 13.9).

    Parameters
    ----------
    wall, rolling, absolute
        True with a wall; m r^2/I of a cylinder or 0; True if the speed in space counts in a curve.
    state, tally
        Changed, with the columns of `STATE` and `TALLY`, in g/w and g/w^2 (w = 2 pi f). The
        distance across is 0 for a cylinder, which rolls.
    cell, drive
        The part's numbers; rows of `DRIVE` and a column a step.
    usual
        Length of most steps in rad.
    """
    x, z, ux, uz = state[STATE.x], state[STATE.z], state[STATE.ux], state[STATE.uz]
    uy, spin = state[STATE.uy], state[STATE.spin]
    y = state[STATE.y] if wall else 0.0
    spare, pressed = state[STATE.spare], state[STATE.pressed] > 0.0
    still, fall, start, peak = 1e-6 * usual, usual * cell.gravity_number_normal, x, 0.0
    leaning, across = wall and state[STATE.leaning] > 0.0, y
    laws = floor_laws(cell, rolling)
    for k in range(drive.shape[1]):
        h = drive[DRIVE.length, k]
        if drive[DRIVE.jump, k] > 0.0:
            spare = after_jump(spare)
        ax, ay, az = acceleration(
            ux, drive[DRIVE.along, k], drive[DRIVE.across, k], drive[DRIVE.normal, k],
            drive[DRIVE.speed, k], cell, absolute,
        )  # fmt: skip
        body, push = BodyState(z, ux, uy, uz, spin), Push(ax, ay, az, h)
        touch = Touch(spare, pressed)
        if wall:
            beside = Wall(y, leaning, cell.wall_restitution, cell.wall_friction)
            after, side, failed = corner_step(beside, body, touch, push, laws)
            leaning = side > 0.0
            tally[TALLY.at_wall] += leaning
            tally[TALLY.failed] += failed
        else:
            after = floor_step(body, touch, push, laws)
        vx, vy, vz, spin, normal, spare = after
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
    """Return the acceleration of a free part relative to the track in g: along, across, normal.

    The push of the drive (`along`, `across`, `normal`, in g) less gravity. In a curve -kappa V^2 is
    added across, with the curvature number kappa and the tangential speed V: `ux`, in g/w (w = 2 pi
    f), plus the track's velocity `track` if `absolute` is True (theory 13.1). `cell` holds the
    part's numbers.
    """
    speed = ux + track if absolute else ux
    return (
        along - cell.gravity_number_along,
        across - cell.gravity_number_across - cell.curvature_number * speed * speed,
        normal - cell.gravity_number_normal,
    )


@compiled
def after_jump(spare: float) -> float:
    """Return `spare` reset after a jump of the drive: the step before no longer predicts this one.

    `spare` is the impulse that static friction could still take: infinite now for a contact that
    sticks; unchanged, negative, for one that slips.
    """
    return math.inf if spare >= 0.0 else spare
