"""Corners and sides of a part, their gaps and velocities."""

from __future__ import annotations

import math

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.tumbling.tables import STATE, Cell


@compiled
def corner_count(cell: Cell) -> int:
    """Return the number of corners: 4, or 1 for a ball (`turning` = 0)."""
    return 4 if cell.turning != 0.0 else 1


@compiled
def corner_at(cell: Cell, corner: int, pitch: float) -> tuple[float, float]:
    """Return sine and cosine of the angle s of a corner below the direction of transport.

    s is zeta + xi, pi - zeta + xi, pi + zeta + xi and -zeta + xi of the corners 0 to 3, with the
    angle zeta of the diagonal in the part (`cell.corner_angle`) and the `pitch` xi in rad (theory
    2.1); pi/2 of a ball. The corner is rho sin s below the centre, rho half the diagonal.
    """
    if cell.turning == 0.0:
        return 1.0, 0.0
    angle = pitch + cell.corner_angle
    if corner == 1:
        angle = pitch + math.pi - cell.corner_angle
    elif corner == 2:
        angle = pitch + math.pi + cell.corner_angle
    elif corner == 3:
        angle = pitch - cell.corner_angle
    return math.sin(angle), math.cos(angle)


@compiled
def gap_of(cell: Cell, state: Floats, corner: int) -> float:
    """Return the height of a corner above the plane in m, g_N = y - rho sin s (theory 2.1)."""
    s, _ = corner_at(cell, corner, state[STATE.pitch])
    return state[STATE.up] - cell.half_diagonal * s


@compiled
def gap_rate_of(cell: Cell, state: Floats, corner: int) -> float:
    """Return the velocity of a corner off the plane, g_N' = y' - rho xi' cos s, in m/s.

    With the angle s of the corner and the half diagonal rho (theory 2.1).
    """
    _, c = corner_at(cell, corner, state[STATE.pitch])
    return state[STATE.up_rate] - cell.half_diagonal * state[STATE.pitch_rate] * c


@compiled
def slip_of(cell: Cell, state: Floats, corner: int) -> float:
    """Return the velocity of a corner along the plane, g_T' = x' - rho xi' sin s, in m/s.

    With the angle s of the corner and the half diagonal rho (theory 2.1).
    """
    s, _ = corner_at(cell, corner, state[STATE.pitch])
    return state[STATE.along_rate] - cell.half_diagonal * state[STATE.pitch_rate] * s


@compiled
def lowest_gap(cell: Cell, state: Floats) -> float:
    """Return the height of the lowest corner of a part above the plane in m.

    `state` has the columns of `STATE` (SI), `cell` the sizes of the part; below 0 in the plane.
    """
    least = gap_of(cell, state, 0)
    for corner in range(1, corner_count(cell)):
        least = min(least, gap_of(cell, state, corner))
    return least


@compiled
def lowest_rate(cell: Cell, state: Floats) -> float:
    """Return the velocity of a part's lowest corner off the plane in m/s; below 0 if it nears it.

    `state` has the columns of `STATE`.
    """
    lowest = 0
    for corner in range(1, corner_count(cell)):
        if gap_of(cell, state, corner) < gap_of(cell, state, lowest):
            lowest = corner
    return gap_rate_of(cell, state, lowest)


@compiled
def side_below(pitch: float) -> int:
    """Return the number of quarter turns to the pitch at which the lowest side lies flat.

    round(xi/(pi/2)), with the pitch xi in rad.
    """
    return round(pitch / (math.pi / 2))


@compiled
def side_shape(cell: Cell, quarter_turns: int) -> tuple[float, float]:
    """Return half the length of the side on which a part lies, and its centre's height, in m.

    rho cos zeta and rho sin zeta, with half diagonal rho and corner angle zeta of the part in
    `cell`, exchanged after an odd number of `quarter_turns`.
    """
    run = cell.half_diagonal * math.cos(cell.corner_angle)
    rise = cell.half_diagonal * math.sin(cell.corner_angle)
    if quarter_turns % 2 == 0:
        return run, rise
    return rise, run


@compiled
def speed_scale(cell: Cell) -> float:
    """Return the speed gained over a half diagonal, sqrt((|g| + |P|) rho), in m/s.

    Small velocities are measured by it.
    """
    most = math.hypot(cell.pull_along, cell.pull_normal)
    most += math.hypot(cell.drive_along, cell.drive_normal)
    return math.sqrt(most * cell.half_diagonal)


@compiled
def kinetic(cell: Cell, state: Floats) -> float:
    """Return the kinetic energy per mass relative to the plane, in (m/s)^2.

    (x'^2 + y'^2 + rho^2 xi'^2/kappa)/2, with half diagonal rho and inertia ratio kappa.
    """
    turning = cell.half_diagonal * state[STATE.pitch_rate]
    square = turning * turning / cell.inertia_ratio
    return 0.5 * (state[STATE.along_rate] ** 2 + state[STATE.up_rate] ** 2 + square)
