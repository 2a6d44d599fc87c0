"""The path of one part, from any state."""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled, raised
from vibrafeed.core.motion.kernels.arrays import Floats, Stop
from vibrafeed.core.motion.kernels.cells import cell_of
from vibrafeed.core.motion.kernels.stepping.contacts import (
    BodyState,
    Push,
    Touch,
    Wall,
    corner_step,
    floor_laws,
    floor_step,
)
from vibrafeed.core.motion.kernels.stepping.period import acceleration, after_jump
from vibrafeed.core.motion.kernels.stepping.tables import DRIVE


@compiled
def path(
    wall: bool, rolling: float, absolute: bool, group: Floats, phases: Floats, h: float,
    steps: int, start: Floats, wave: Floats, position: Floats, velocity: Floats, stop: Stop,
) -> None:  # fmt: skip
    """Fill positions and velocities (n, 3) at ascending phases by time stepping, from any state.

    In g/w^2 and g/w (w = 2 pi f), along, across and normal. Within a step from velocity u to v the
    velocity is linear, as in the scheme: u + s (v - u) and x + s h (u + s (v - u)/2) at the share s
    of a step h. Samples after a step without a solution, or after `stop`, are left as they were
    (theory 13.9).

    Parameters
    ----------
    wall, rolling, absolute
        True with a wall; m r^2/I of a cylinder or 0; True if the speed in space counts in a curve.
    group
        The fields of `Cell`.
    phases
        The n phases in rad.
    h, steps
        Length of a step in rad, and number of steps.
    start
        Position (3), velocity (3) and spin, in g/w^2 and g/w.
    wave
        The drive of a period from the first phase on (rows of `DRIVE`), without columns for a sine.
    """
    cell = cell_of(group)
    laws = floor_laws(cell, rolling)
    x, y, z, ux, uy, uz, spin = start
    resting = ux == 0.0 and uy + spin == 0.0 and uz == 0.0 and z <= 0.0
    spare = math.inf if resting else -1.0
    pressed, leaning = uz == 0.0 and z <= 0.0, uy == 0.0 and y <= 0.0
    begin, sampled, elapsed = phases[0], 0, 0.0
    for k in range(steps):
        if raised(stop):
            break
        tau = begin + (k + 0.5) * h
        if wave.size > 0:
            column = k % wave.shape[1]
            along, across = wave[DRIVE.along, column], wave[DRIVE.across, column]
            lift, track = wave[DRIVE.normal, column], wave[DRIVE.speed, column]
            h = wave[DRIVE.length, column]
            if wave[DRIVE.jump, column] > 0.0:
                spare = after_jump(spare)
        else:
            sine = math.sin(tau)
            along, across = cell.drive_number_along * sine, cell.drive_number_across * sine
            lift, track = cell.drive_number_normal * sine, cell.drive_number_along * math.cos(tau)
        ax, ay, az = acceleration(ux, along, across, lift, track, cell, absolute)
        body, push = BodyState(z, ux, uy, uz, spin), Push(ax, ay, az, h)
        touch = Touch(spare, pressed)
        if wall:
            beside = Wall(y, leaning, cell.wall_restitution, cell.wall_friction)
            after, side, failed = corner_step(beside, body, touch, push, laws)
            leaning = side > 0.0
            if failed:
                break
        else:
            after = floor_step(body, touch, push, laws)
        vx, vy, vz, spin, normal, spare = after
        end = elapsed + h if wave.size > 0 else (k + 1) * h
        while sampled < phases.size and (phases[sampled] - begin <= end or k == steps - 1):
            s = (phases[sampled] - begin) / h - k
            if wave.size > 0:
                s = (phases[sampled] - begin - elapsed) / h
            position[sampled, 0] = x + s * h * (ux + 0.5 * s * (vx - ux))
            position[sampled, 1] = y + s * h * (uy + 0.5 * s * (vy - uy))
            position[sampled, 2] = z + s * h * (uz + 0.5 * s * (vz - uz))
            velocity[sampled, 0] = ux + s * (vx - ux)
            velocity[sampled, 1] = uy + s * (vy - uy)
            velocity[sampled, 2] = uz + s * (vz - uz)
            sampled += 1
        elapsed = end
        x += 0.5 * h * (ux + vx)
        y += 0.5 * h * (uy + vy)
        z += 0.5 * h * (uz + vz)
        pressed = normal > 0.0
        ux, uy, uz = vx, vy, vz
