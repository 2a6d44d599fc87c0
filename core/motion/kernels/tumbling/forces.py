"""Accelerations of a free part, and the forces that hold or brake one on the plane."""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.tumbling.geometry import corner_at, side_shape
from vibrafeed.core.motion.kernels.tumbling.tables import Cell


@compiled
def free_acceleration(cell: Cell, time: float) -> tuple[float, float]:
    """Return the acceleration of a free part relative to the plane, along it and off it, in m/s^2.

    (P_x, P_y) sin(w t + phi) - (g_x, g_y), drive and pull of the `Cell`, t = `time` in s (theory
    13.11).
    """
    swing = math.sin(cell.circular_frequency * time + cell.start_phase)
    along = cell.drive_along * swing - cell.pull_along
    return along, cell.drive_normal * swing - cell.pull_normal


@compiled
def free_corner(
    cell: Cell, time: float, s: float, c: float, pitch_rate: float
) -> tuple[float, float]:
    """Return the acceleration in m/s^2 of a corner without forces, off the plane (chi) and along.

    chi = a_y + rho xi'^2 sin s and a_t = a_x - rho xi'^2 cos s, with the acceleration a of a free
    part, half diagonal rho and pitch rate xi'; `s` and `c` are sin s and cos s of the corner's
    angle (theory 2.2). `time` is in s, `pitch_rate` in rad/s.
    """
    along, upward = free_acceleration(cell, time)
    turning = cell.turning * cell.half_diagonal * pitch_rate * pitch_rate
    return upward + turning * s, along - turning * c


@compiled
def holding_force(cell: Cell, s: float, c: float, chi: float, along: float) -> tuple[float, float]:
    """Return normal and friction force per mass that keep a corner of a part at rest, in m/s^2.

    The corner sticks if they lie within static friction. -((1 + kappa s^2) chi - kappa s c a_t)/(1
    + kappa) and -((1 + kappa c^2) a_t - kappa s c chi)/(1 + kappa), with the inertia ratio kappa,
    sine and cosine `s`, `c` of the corner's angle, and the accelerations of the corner without
    force, chi = `chi` normal to the plane and a_t = `along` it, in m/s^2 (theory 2.4).
    """
    kappa = cell.inertia_ratio
    normal = -((1.0 + kappa * s * s) * chi - kappa * s * c * along) / (1.0 + kappa)
    friction = -((1.0 + kappa * c * c) * along - kappa * s * c * chi) / (1.0 + kappa)
    return normal, friction


@compiled
def response_of(cell: Cell, s: float, c: float, sigma: int) -> float:
    """Return m tau: the normal acceleration of a sliding corner over the normal force per mass.

    m tau = 1 + kappa c (c - sigma mu_k s), with sine and cosine `s`, `c` of the corner's angle and
    the direction of slip `sigma`. If it is not positive there is no solution, or several (theory
    2.2).
    """
    return 1.0 + cell.inertia_ratio * c * (c - sigma * cell.friction_kinetic * s)


@compiled
def corner_force(
    cell: Cell, corner: int, sigma: int, time: float, pitch: float, pitch_rate: float
) -> tuple[float, float]:
    """Return normal and friction force per mass on a corner that sticks or slides, in m/s^2.

    n = -chi/(m tau), t = -sigma mu_k n in a slip in direction `sigma` (1, -1), with the normal
    acceleration chi of the corner without force, and m tau, what a unit of n adds to it; for
    `sigma` 0 the forces that hold the corner in place (theory 2.3). 0 if m tau is not above 0.
    `time` in s gives the phase of the drive, `pitch` and `pitch_rate` are in rad and rad/s.
    """
    s, c = corner_at(cell, corner, pitch)
    chi, along = free_corner(cell, time, s, c, pitch_rate)
    if sigma == 0:
        return holding_force(cell, s, c, chi, along)
    response = response_of(cell, s, c, sigma)
    if response <= 0.0:  # the state is refused after the step
        return 0.0, 0.0
    return -chi / response, sigma * cell.friction_kinetic * chi / response


@compiled
def flat_force(cell: Cell, sigma: int, time: float) -> tuple[float, float]:
    """Return normal and friction force per mass on a side that lies flat on the plane, in m/s^2.

    n = -a_y, and t = -sigma mu_k n in a slip in direction `sigma` (1, -1), or -a_x if the side is
    held (0), with the acceleration a of a free part. `time` in s gives the phase of the drive.
    """
    along, upward = free_acceleration(cell, time)
    if sigma == 0:
        return -upward, -along
    return -upward, sigma * cell.friction_kinetic * upward


@compiled
def side_forces(
    cell: Cell, quarter_turns: int, normal: float, friction: float
) -> tuple[float, float]:
    """Return the normal forces per mass at the right and left end of a side that lies flat.

    (n -+ t height/half)/2: their moment about the centre is that of friction. `normal` and
    `friction` are n and t, `quarter_turns` tells the side; half its length and the centre's height
    are those of `side_shape`. A negative one tells that the part tips.
    """
    half, height = side_shape(cell, quarter_turns)
    tilt = friction * height / half
    return (normal - tilt) / 2, (normal + tilt) / 2
