"""The work of friction and drive over a step, and the kinetic energy of a part (theory 13.15)."""

from __future__ import annotations

import math

from core.compiled import borrowing
from core.motion.kernels.arrays import Floats
from core.motion.kernels.cells import Cell
from core.motion.kernels.quadrature import NODES, WEIGHTS
from core.motion.kernels.results import SPENT
from core.motion.kernels.track.drive import sine_slope
from core.motion.kernels.track.polynomials import value
from core.motion.kernels.track.tables import BOTH, FLOOR, FREE, ROW, STATE, Work


@borrowing
def kinetic(state: Floats, rolling: float) -> float:
    """Return the kinetic energy per mass relative to the track, with the spin of a cylinder.

    (u.u + spin^2/(m r^2/I))/2 (theory 13.15).
    """
    square = state[STATE.ux] ** 2 + state[STATE.uy] ** 2 + state[STATE.uz] ** 2
    if rolling > 0.0:
        square += state[STATE.spin] ** 2 / rolling
    return 0.5 * square


@borrowing
def spend(
    cell: Cell,
    tau: float,
    span: float,
    order: int,
    contacts: int,
    slips: bool,
    work: Work,
    spent: Floats,
) -> None:
    """Add the work of drive and friction over a step from tau on to `spent`.

    The integrals of b.u, of b'.u (NaN of a wave: `planar.drive.push_slope`) and of friction. Where
    `spent` has no columns nothing is asked. The accelerations without contacts hold gravity, and
    what a curve does.
    """
    if spent.size == 0:
        return
    gravity = (cell.gravity_number_along, cell.gravity_number_across, cell.gravity_number_normal)
    pushes = (cell.drive_number_along, cell.drive_number_across, cell.drive_number_normal)
    half = 0.5 * span
    for number in range(NODES.size):
        for side in (-NODES[number], NODES[number]):
            at = half * (1.0 + side)
            power, swing, weight = 0.0, 0.0, half * WEIGHTS[number]
            slope = sine_slope(work, tau + at)
            for axis in range(3):
                push = value(work, ROW.free + axis, order - 1, at) + gravity[axis]
                velocity = value(work, ROW.velocity + axis, order, at)
                power += push * velocity
                swing += slope * pushes[axis] * velocity
            spent[SPENT.drive] += weight * power
            spent[SPENT.swing] += weight * swing
            if slips and contacts != FREE:
                spent[SPENT.friction] += weight * rubbing(cell, contacts, order, at, work)


@borrowing
def rubbing(cell: Cell, contacts: int, order: int, at: float, work: Work) -> float:
    """Return the power of friction at slipping contacts, some phase after a step began.

    mu_k N |slip| of the floor, mu_w S |slip| of the wall, N = -D_z and S = -D_y (theory 13.15).
    """
    floor = -cell.friction_kinetic * value(work, ROW.free + 2, order - 1, at)
    wall = -cell.wall_friction * value(work, ROW.free + 1, order - 1, at)
    if contacts == BOTH:
        return (floor + wall) * abs(value(work, ROW.velocity, order, at))
    slip_1, slip_2 = value(work, ROW.slip, order, at), value(work, ROW.slip + 1, order, at)
    return (floor if contacts == FLOOR else wall) * math.hypot(slip_1, slip_2)
