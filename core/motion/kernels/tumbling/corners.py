"""The part that tumbles: its numbers and state, its corners and sides, the forces on them."""

import math
from collections import namedtuple

from numba.np.unsafe.ndarray import to_fixed_tuple

from vibrafeed.core.compiled import compiled
from vibrafeed.core.motion.kernels.inputs import Floats

FREE, FLAT, PARADOX = -1, -2, -3
"""What carries the part, if not the corner with that number: nothing, a side, and contact laws
without one solution."""

OVERLAP = 4e-15
"""Overlap over the half diagonal that counts as an impact: some roundings of a height."""
TOUCH = 1e-13
"""Gap over the half diagonal that counts as touching."""
DEEP = 1e-12
"""Overlap over the half diagonal that is more than rounding."""
SLOW = 1e-6
"""Velocity that counts as none, of sqrt(acceleration times half diagonal); a fall through `OVERLAP`
ends at 0.09e-6 of it."""


Cell = namedtuple(
    "Cell",
    "half_diagonal inertia_ratio corner_angle turning pull_along pull_normal drive_along "
    "drive_normal circular_frequency start_phase friction_kinetic friction_static restitution "
    "gap_normal pitch velocity_along velocity_upward pitch_rate duration time_step",
)
"""The numbers of one cell, SI; `turning` is 1 for a part with corners, 0 for a ball, whose one
contact stays below the centre. Pulls are gravity's components against the transport and towards
the plane."""

GROUPS = len(Cell._fields)


@compiled
def cell_of(row: Floats) -> Cell:
    """Return a row of a kernel's table, shape (columns,), as a named tuple `Cell`."""
    return Cell(*to_fixed_tuple(row, GROUPS))  # type: ignore[call-arg] # the compiler gives one


State = namedtuple("State", "along up pitch along_rate up_rate pitch_rate lost")
"""Places in the state: centre, pitch, their rates, energy per mass lost so far."""

STATE = State(*range(len(State._fields)))

Columns = namedtuple(
    "Columns",
    "pitch resting_side settling_time impacts largest_bounce velocity energy_lost",
)
"""Columns of a table of results: the fields of `Tumble`; the status has an array of its own."""

COLUMN = Columns(*range(len(Columns._fields)))

Path = namedtuple("Path", "time state gap touching")
"""Where in a row of a path stand time, state, lowest gap, and whether each corner carries."""

PATH = Path(time=0, state=1, gap=1 + len(STATE), touching=2 + len(STATE))
PATH_COLUMNS = PATH.touching + 4


@compiled
def corner_count(cell: Cell) -> int:
    """Return the number of corners: 4, or 1 for a ball (`turning` = 0)."""
    return 4 if cell.turning != 0.0 else 1


@compiled
def corner_at(cell: Cell, corner: int, pitch: float) -> tuple[float, float]:
    """Return sine and cosine of the angle s of a corner below the direction of transport.

    s is zeta + xi, pi - zeta + xi, pi + zeta + xi and -zeta + xi of the corners 0 to 3, with the
    angle zeta of the diagonal in the part and the `pitch` xi in rad (theory 2.1); pi/2 of a ball.
    The corner is rho sin s below the centre, rho half the diagonal.
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
    """Return the velocity of a corner off the plane, g_N' = y' - rho xi' cos s, in m/s."""
    _, c = corner_at(cell, corner, state[STATE.pitch])
    return state[STATE.up_rate] - cell.half_diagonal * state[STATE.pitch_rate] * c


@compiled
def slip_of(cell: Cell, state: Floats, corner: int) -> float:
    """Return the velocity of a corner along the plane, g_T' = x' - rho xi' sin s, in m/s."""
    s, _ = corner_at(cell, corner, state[STATE.pitch])
    return state[STATE.along_rate] - cell.half_diagonal * state[STATE.pitch_rate] * s


@compiled
def lowest_gap(cell: Cell, state: Floats) -> float:
    """Return the height of the lowest corner of a part above the plane in m."""
    least = gap_of(cell, state, 0)
    for corner in range(1, corner_count(cell)):
        least = min(least, gap_of(cell, state, corner))
    return least


@compiled
def lowest_rate(cell: Cell, state: Floats) -> float:
    """Return the velocity of a part's lowest corner off the plane in m/s."""
    lowest = 0
    for corner in range(1, corner_count(cell)):
        if gap_of(cell, state, corner) < gap_of(cell, state, lowest):
            lowest = corner
    return gap_rate_of(cell, state, lowest)


@compiled
def side_below(pitch: float) -> int:
    """Return the number of quarter turns to the pitch at which the lowest side lies flat."""
    return round(pitch / (math.pi / 2))


@compiled
def side_shape(cell: Cell, quarter_turns: int) -> tuple[float, float]:
    """Return half the length of the side on which a part lies, and its centre's height, in m."""
    run = cell.half_diagonal * math.cos(cell.corner_angle)
    rise = cell.half_diagonal * math.sin(cell.corner_angle)
    if quarter_turns % 2 == 0:
        return run, rise
    return rise, run


@compiled
def speed_scale(cell: Cell) -> float:
    """Return the speed gained over a half diagonal, sqrt((|g| + |P|) rho), in m/s."""
    acceleration = math.hypot(cell.pull_along, cell.pull_normal)
    acceleration += math.hypot(cell.drive_along, cell.drive_normal)
    return math.sqrt(acceleration * cell.half_diagonal)


@compiled
def kinetic(cell: Cell, state: Floats) -> float:
    """Return the kinetic energy per mass relative to the plane, in (m/s)^2.

    (x'^2 + y'^2 + rho^2 xi'^2/kappa)/2, with half diagonal rho and inertia ratio kappa.
    """
    turning_speed = cell.half_diagonal * state[STATE.pitch_rate]
    turning_squared = turning_speed * turning_speed / cell.inertia_ratio
    return 0.5 * (state[STATE.along_rate] ** 2 + state[STATE.up_rate] ** 2 + turning_squared)


@compiled
def free_acceleration(cell: Cell, time: float) -> tuple[float, float]:
    """Return the acceleration of a free part relative to the plane, along it and off it, in m/s^2.

    (P_x, P_y) sin(w t + phi) - (g_x, g_y), drive and pull of the `Cell` (theory 13.11).
    """
    drive_sine = math.sin(cell.circular_frequency * time + cell.start_phase)
    along = cell.drive_along * drive_sine - cell.pull_along
    return along, cell.drive_normal * drive_sine - cell.pull_normal


@compiled
def free_corner(
    cell: Cell, time: float, s: float, c: float, pitch_rate: float
) -> tuple[float, float]:
    """Return the acceleration in m/s^2 of a corner without forces, off the plane (chi) and along.

    chi = a_y + rho xi'^2 sin s and a_t = a_x - rho xi'^2 cos s, with the acceleration a of a free
    part (theory 2.2).
    """
    along, upward = free_acceleration(cell, time)
    centripetal = cell.turning * cell.half_diagonal * pitch_rate * pitch_rate
    return upward + centripetal * s, along - centripetal * c


@compiled
def holding_force(cell: Cell, s: float, c: float, chi: float, along: float) -> tuple[float, float]:
    """Return normal and friction force per mass that keep a corner of a part at rest, in m/s^2.

    -((1 + kappa s^2) chi - kappa s c a_t)/(1 + kappa) and -((1 + kappa c^2) a_t - kappa s c chi)/(1
    + kappa), with sine and cosine `s`, `c` of the corner's angle and the accelerations chi and a_t
    of `free_corner` (theory 2.4).
    """
    kappa = cell.inertia_ratio
    normal = -((1.0 + kappa * s * s) * chi - kappa * s * c * along) / (1.0 + kappa)
    friction = -((1.0 + kappa * c * c) * along - kappa * s * c * chi) / (1.0 + kappa)
    return normal, friction


@compiled
def response_of(cell: Cell, s: float, c: float, sigma: int) -> float:
    """Return m tau: the normal acceleration of a sliding corner over the normal force per mass.

    m tau = 1 + kappa c (c - sigma mu_k s). If it is not positive there is no solution, or several
    (theory 2.2).
    """
    return 1.0 + cell.inertia_ratio * c * (c - sigma * cell.friction_kinetic * s)


@compiled
def corner_force(
    cell: Cell, corner: int, sigma: int, time: float, pitch: float, pitch_rate: float
) -> tuple[float, float]:
    """Return normal and friction force per mass on a corner that sticks or slides, in m/s^2.

    n = -chi/(m tau), t = -sigma mu_k n in a slip in direction `sigma` (1, -1); for `sigma` 0 the
    forces that hold the corner in place (theory 2.3). 0 if m tau is not above 0.
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

    n = -a_y, and t = -sigma mu_k n in a slip, or -a_x if the side is held (`sigma` 0), with the
    acceleration a of a free part.
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

    (n -+ t height/half)/2: their moment about the centre is that of friction. A negative one tells
    that the part tips.
    """
    half_length, height = side_shape(cell, quarter_turns)
    tilt = friction * height / half_length
    return (normal - tilt) / 2, (normal + tilt) / 2
