"""The work of friction and drive over a step, and the kinetic energy of a part (theory 13.15)."""

from __future__ import annotations

import math

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.arrays import Floats
from vibrafeed.core.motion.kernels.cells import Cell
from vibrafeed.core.motion.kernels.quadrature import NODES, WEIGHTS
from vibrafeed.core.motion.kernels.results import SPENT
from vibrafeed.core.motion.kernels.track.drive import sine_slope
from vibrafeed.core.motion.kernels.track.polynomials import value
from vibrafeed.core.motion.kernels.track.tables import BOTH, FLOOR, FREE, ROW, STATE, Work


@borrowing
def kinetic(state: Floats, rolling: float) -> float:
    """Return the kinetic energy per mass relative to the track, in (g/w)^2, with a cylinder's spin.

    (u.u + spin^2/(m r^2/I))/2; `state` has the columns of `STATE`, `rolling` is m r^2/I or 0
    (theory 13.15). Here w = 2 pi f.
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
    """Add the work of drive and friction over a step to `spent` (columns of `SPENT`), in (g/w)^2.

    Per mass (w = 2 pi f): the integrals of b.u (drive), of b'.u (swing, NaN of a wave) and of
    friction, with the push b, its derivative b' by the phase and the velocity u, by Gauss's rule
    (theory 13.15). Nothing is done if `spent` has no columns.

    `cell` holds the part's numbers; the step begins at phase `tau` and lasts `span`, in rad; its
    power series are in `work`, up to power `order`. `contacts` is the bit set of what carries the
    part (floor 1, wall 2), `slips` is True if it slips.
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
    """Return the power that friction takes at slipping contacts, per mass in g^2/w (w = 2 pi f).

    mu_k N |slip| of the floor, mu_w S |slip| of the wall, with the loads N = -D_z and S = -D_y from
    the accelerations D without contacts. `cell` has the friction coefficients; `contacts` is the
    bit set of what carries the part (floor 1, wall 2); `at` is the phase since the step began in
    rad, `order` the highest power of the step's series in `work` (theory 13.15).
    """
    floor = -cell.friction_kinetic * value(work, ROW.free + 2, order - 1, at)
    wall = -cell.wall_friction * value(work, ROW.free + 1, order - 1, at)
    if contacts == BOTH:
        return (floor + wall) * abs(value(work, ROW.velocity, order, at))
    slip_1, slip_2 = value(work, ROW.slip, order, at), value(work, ROW.slip + 1, order, at)
    return (floor if contacts == FLOOR else wall) * math.hypot(slip_1, slip_2)
