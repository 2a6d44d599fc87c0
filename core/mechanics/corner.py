"""A part that touches a fixed plane with one corner, in its own plane of motion (theory 2, 6).

The corner lies on the right, below the centre: pitch counts clockwise, so that s, the angle of the
diagonal from corner to centre, is zeta + xi. Everything is per mass. With e = c - sigma mu s (c, s:
cosine and sine of the angle s, sigma the direction of slip) most results are products and need
no difference of nearly equal numbers.

All functions take and return broadcastable float64 arrays, SI units, angles in radians. Pairs
(`corner_direction`, `diagonal_direction`) hold the sine and cosine of an angle.
"""

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, ratio, sine

# --- One unilateral contact: force or separation, never both (theory 2.3).
#
# A contact presses with a force per mass n >= 0 and opens with an acceleration a >= 0, one of which
# is 0, where a = response * n + free. Friction can make the response negative; then there may be
# two solutions or none (Painleve's paradox). The comparisons are exact, at 0 too.

SEPARATION, SLIDING, STICK, TWO_SOLUTIONS, NO_SOLUTION = 0.0, 1.0, 2.0, 3.0, 4.0
"""The cases. `contact_case` adds STICK to those of `case`."""


def case(response: Array, free: Array) -> Array:
    """Return the case of a contact: number and kind of its forces n.

    n is the force per mass, a the acceleration that opens the gap [m s-2]: n >= 0,
    a = response n + free >= 0, and one of both is 0. `free` is a without a force, `response` what
    a unit of n adds to it [1].

    ========  =====  ================================  =============
    response  free   solutions                         case
    ========  =====  ================================  =============
    > 0       > 0    n = 0                             SEPARATION
    > 0       <= 0   n = -free/response                SLIDING
    < 0       > 0    both of these                     TWO_SOLUTIONS
    < 0       = 0    n = 0, grazing                    SLIDING
    < 0       < 0    none                              NO_SOLUTION
    = 0       > 0    n = 0                             SEPARATION
    = 0       = 0    every n >= 0                      TWO_SOLUTIONS
    = 0       < 0    none                              NO_SOLUTION
    ========  =====  ================================  =============
    """
    when_opening = np.where(response < 0, TWO_SOLUTIONS, SEPARATION)
    when_pressing = np.where(response > 0, SLIDING, NO_SOLUTION)
    when_touching = np.where(response == 0, TWO_SOLUTIONS, SLIDING)
    return np.where(free > 0, when_opening, np.where(free < 0, when_pressing, when_touching))


def contact_force(response: Array, free: Array) -> Array:
    """Return the contact force per mass, n = -free/response, of the solution that stays in contact.

    In m/s^2; `response` and `free` as of `case`. 0 in separation; NaN where there is no solution
    and where every n >= 0 is one.
    """
    solution = case(response, free)
    unknown = (solution == NO_SOLUTION) | (response == 0)
    with np.errstate(over="ignore"):  # next to response 0 the force may exceed every float
        quotient = -free / np.where(response == 0, 1.0, response)
    force = np.where(free == 0, 0.0, quotient)
    return np.where(solution == SEPARATION, 0.0, np.where(unknown, np.nan, force))


Direction = tuple[Array, Array]
"""Sine and cosine of an angle."""


# --- geometry and motion


def diagonal_angle(*, corner_angle: Array, pitch: Array) -> Array:
    """Return the angle of the diagonal above the plane, s = zeta + xi [rad]."""
    return corner_angle + pitch


def diagonal_direction(*, corner_direction: Direction, pitch: Array) -> Direction:
    """Return sine and cosine of the diagonal's angle s = zeta + xi above the plane.

    By the addition theorem, zeta being the angle within the part and xi the pitch: s itself,
    rounded, would lose the digits of a cosine near 90 degrees.
    """
    rise, run = corner_direction
    return (
        rise * cosine(pitch) + run * sine(pitch),
        run * cosine(pitch) - rise * sine(pitch),
    )


def touching_height(*, half_diagonal: Array, diagonal_direction: Direction) -> Array:
    """Return the height of the centre at which the corner touches, rho sin(s) [m]."""
    return half_diagonal * diagonal_direction[0]


def gap_normal(*, centre_height: Array, touching_height: Array) -> Array:
    """Return the gap between corner and plane, y - rho sin(s), (3.2), (3.28) [m]."""
    return centre_height - touching_height


def gap_tangential(
    *, centre_along: Array, half_diagonal: Array, diagonal_direction: Direction
) -> Array:
    """Return the coordinate of the corner along the plane, x + rho cos(s), (3.2), (3.28) [m]."""
    return centre_along + half_diagonal * diagonal_direction[1]


def pivot_velocity_along(
    *, half_diagonal: Array, pitch_rate: Array, diagonal_direction: Direction
) -> Array:
    """Return the velocity along the plane of a centre that turns about a corner at rest [m s-1].

    It is rho xi' sin(s): half diagonal rho, pitch rate xi', angle s of the diagonal.
    """
    return half_diagonal * pitch_rate * diagonal_direction[0]


def pivot_velocity_upward(
    *, half_diagonal: Array, pitch_rate: Array, diagonal_direction: Direction
) -> Array:
    """Return the upward velocity of the centre about a corner at rest, rho xi' cos(s) [m s-1]."""
    return half_diagonal * pitch_rate * diagonal_direction[1]


def gap_normal_rate(*, velocity_upward: Array, pivot_velocity_upward: Array) -> Array:
    """Return the rate of the gap, y' - rho xi' cos(s), (3.3), (3.29) with cos [m s-1]."""
    return velocity_upward - pivot_velocity_upward


def gap_tangential_rate(*, velocity_along: Array, pivot_velocity_along: Array) -> Array:
    """Return the slip velocity of the corner, x' - rho xi' sin(s), (3.3), (3.29) [m s-1]."""
    return velocity_along - pivot_velocity_along


def free_normal_acceleration(
    *, half_diagonal: Array, pitch_rate: Array, diagonal_direction: Direction, gravity: Array
) -> Array:
    """Return the corner's free normal acceleration, chi = rho xi'^2 sin(s) - g [m s-2]."""
    return half_diagonal * pitch_rate * pitch_rate * diagonal_direction[0] - gravity


def free_tangential_acceleration(
    *, half_diagonal: Array, pitch_rate: Array, diagonal_direction: Direction
) -> Array:
    """Return the corner's free acceleration along the plane, -rho xi'^2 cos(s) [m s-2]."""
    return -half_diagonal * pitch_rate * pitch_rate * diagonal_direction[1]


# --- what friction makes of a normal force


def _response(kappa: Array, direction: Direction, sigma_mu: Array) -> Array:
    # Normal acceleration of a slipping corner over its normal force per mass; sigma is the slip.
    s, c = direction
    return 1.0 + kappa * c * (c - sigma_mu * s)


def normal_response_right(
    *, inertia_ratio: Array, diagonal_direction: Direction, friction_kinetic: Array
) -> Array:
    """Return the normal response in slip to the right, 1 + kappa c^2 - mu kappa s c, (3.6a) [1].

    Normal acceleration per normal force per mass; s, c are sine and cosine of the diagonal's angle,
    kappa the inertia ratio. Below 0 Painleve's paradox occurs.
    """
    return _response(inertia_ratio, diagonal_direction, friction_kinetic)


def normal_response_left(
    *, inertia_ratio: Array, diagonal_direction: Direction, friction_kinetic: Array
) -> Array:
    """Return the normal response in slip to the left, 1 + kappa c^2 + mu kappa s c [1].

    Symbols as of `normal_response_right`.
    """
    return _response(inertia_ratio, diagonal_direction, -friction_kinetic)


def normal_response(
    *, inertia_ratio: Array, diagonal_direction: Direction, friction_kinetic: Array,
    slip_direction: Array,
) -> Array:  # fmt: skip
    """Return the normal response m tau = 1 + kappa c (c - sigma mu s) in the slip direction [1].

    Symbols as of `normal_response_right`; sigma is 1 right, -1 left, and 0, without friction, where
    nothing slips.
    """
    return _response(inertia_ratio, diagonal_direction, slip_direction * friction_kinetic)


def holding_normal_acceleration(
    *, inertia_ratio: Array, half_diagonal: Array, pitch_rate: Array, diagonal_direction:
    Direction, gravity: Array,
) -> Array:  # fmt: skip
    """Return the normal force per mass that keeps the corner at rest, g (1 + kappa s^2)/(1 + kappa)
    - rho xi'^2 s; negative where it would have to pull [m s-2].
    """  # noqa: D205
    s, _ = diagonal_direction
    weight = gravity * ((1.0 + inertia_ratio * s * s) / (1.0 + inertia_ratio))
    return weight - half_diagonal * pitch_rate * pitch_rate * s


def holding_tangential_acceleration(
    *, inertia_ratio: Array, half_diagonal: Array, pitch_rate: Array, diagonal_direction:
    Direction, gravity: Array,
) -> Array:  # fmt: skip
    """Return the friction force per mass that keeps the corner at rest, c (rho xi'^2 - g kappa s/(1
    + kappa)) [m s-2].
    """  # noqa: D205
    s, c = diagonal_direction
    centripetal = half_diagonal * pitch_rate * pitch_rate
    return c * (centripetal - gravity * s * (inertia_ratio / (1.0 + inertia_ratio)))


def _is_held(normal: Array, tangential: Array, friction_static: Array) -> Mask:
    return (normal >= 0) & (np.abs(tangential) <= friction_static * normal)


def slip_direction(
    *, gap_tangential_rate: Array, free_normal_acceleration: Array, holding_normal_acceleration:
    Array, holding_tangential_acceleration: Array, friction_static: Array,
) -> Array:  # fmt: skip
    """Return the direction in which a part's corner slips on the plane: 1, -1, or 0 if it sticks.

    A corner that moves slips along its velocity. From rest it slips against the friction that would
    have held it, unless static friction holds it or it leaves the plane (theory 2.4).
    """
    held = _is_held(holding_normal_acceleration, holding_tangential_acceleration, friction_static)
    stays = held | (free_normal_acceleration > 0)
    from_rest = np.where(stays, 0.0, -np.sign(holding_tangential_acceleration))
    return np.where(gap_tangential_rate == 0, from_rest, np.sign(gap_tangential_rate))


def contact_case(
    *, gap_tangential_rate: Array, free_normal_acceleration: Array, holding_normal_acceleration:
    Array, holding_tangential_acceleration: Array, friction_static: Array, normal_response:
    Array,
) -> Array:  # fmt: skip
    """Return the case of the contact: separation, sliding, stick, two solutions or none.

    A corner at rest sticks if the force that would hold it lies in the cone of static friction;
    else the case follows from the normal response and the free normal acceleration. At rest one
    solution always exists (theory 2.4).
    """
    held = _is_held(holding_normal_acceleration, holding_tangential_acceleration, friction_static)
    otherwise = case(normal_response, free_normal_acceleration)
    return np.where((gap_tangential_rate == 0) & held, STICK, otherwise)


# --- forces and accelerations: of the solution in contact, where there are two


def by_case(
    contact_case: Array, slip_direction: Array, free: Array | float, held: Array, sliding: Array
) -> Array:
    """Return one of three values by the contact case of each cell; NaN where no solution exists.

    `free` is the value in separation, `held` that of a corner that does not slip, `sliding` that of
    one that slips or starts to.
    """
    in_contact = np.where(slip_direction == 0, held, sliding)
    in_contact = np.where(contact_case == SEPARATION, free, in_contact)
    return np.where(contact_case == NO_SOLUTION, np.nan, in_contact)


def floor_acceleration(
    *, contact_case: Array, slip_direction: Array, normal_response: Array,
    free_normal_acceleration: Array, holding_normal_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the plane's normal force per mass: -chi/(m tau) in slip, 0 in separation [m s-2].

    chi is the free normal acceleration, m tau the normal response; for a corner at rest it is the
    holding force. NaN where there is no solution, and where every force is one (tau = chi = 0).
    """
    sliding = contact_force(normal_response, free_normal_acceleration)
    return by_case(contact_case, slip_direction, 0.0, holding_normal_acceleration, sliding)


def acceleration_along(
    *, contact_case: Array, slip_direction: Array, floor_acceleration: Array, friction_kinetic:
    Array, holding_tangential_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the acceleration of the centre along the plane: friction per mass, (3.1) [m s-2]."""
    sliding = -slip_direction * friction_kinetic * floor_acceleration
    return by_case(contact_case, slip_direction, 0.0, holding_tangential_acceleration, sliding)


def acceleration_upward(
    *, contact_case: Array, slip_direction: Array, normal_response: Array, inertia_ratio: Array,
    half_diagonal: Array, pitch_rate: Array, diagonal_direction: Direction, friction_kinetic:
    Array, gravity: Array,
) -> Array:  # fmt: skip
    """Return the upward acceleration of the centre, n - g, (3.1) [m s-2].

    In slip it is -(rho xi'^2 s + g kappa c e)/(m tau), e = c - sigma mu s, without a difference of
    nearly equal numbers; -g in flight, and that of a pendulum while the corner is held.
    """
    s, c = diagonal_direction
    centripetal = half_diagonal * pitch_rate * pitch_rate * s
    e = c - slip_direction * friction_kinetic * s
    sliding = -ratio(centripetal + gravity * inertia_ratio * c * e, normal_response, np.nan)
    held = -(centripetal + gravity * c * c * (inertia_ratio / (1.0 + inertia_ratio)))
    return by_case(contact_case, slip_direction, -gravity, held, sliding)


def pitch_acceleration(
    *, contact_case: Array, slip_direction: Array, floor_acceleration: Array, inertia_ratio:
    Array, half_diagonal: Array, diagonal_direction: Direction, friction_kinetic: Array,
    gravity: Array,
) -> Array:  # fmt: skip
    """Return the pitch acceleration, xi'' = -kappa (n c + t s)/rho, (3.1) [rad s-2].

    t is -mu_k n in the direction of slip. 0 in flight; while the corner is held that of a pendulum
    about it, whatever the pitch rate.
    """
    s, c = diagonal_direction
    e = c - slip_direction * friction_kinetic * s
    sliding = -inertia_ratio * floor_acceleration * e / half_diagonal
    held = -gravity * c * (inertia_ratio / (1.0 + inertia_ratio)) / half_diagonal
    return by_case(contact_case, slip_direction, 0.0, held, sliding)


def gap_normal_acceleration(*, contact_case: Array, free_normal_acceleration: Array) -> Array:
    """Return the acceleration with which the gap opens, g_N'', (3.4), (3.30) [m s-2].

    It is chi (`free_normal_acceleration`) in separation, 0 in contact, NaN where no solution
    exists.
    """
    opening = np.where(contact_case == SEPARATION, free_normal_acceleration, 0.0)
    return np.where(contact_case == NO_SOLUTION, np.nan, opening)


def gap_tangential_acceleration(
    *, contact_case: Array, slip_direction: Array, normal_response: Array,
    free_tangential_acceleration: Array, inertia_ratio: Array, half_diagonal: Array, pitch_rate:
    Array, diagonal_direction: Direction, friction_kinetic: Array, gravity: Array,
) -> Array:  # fmt: skip
    """Return the acceleration of the corner along the plane, g_T'', from (3.6b), (3.33b) [m s-2].

    In slip it is (g (kappa s e - sigma mu) - (1 + kappa) rho xi'^2 e)/(m tau), e = c - sigma mu s.
    The source prints +mu and sin^2 in place of -mu and s. 0 where the corner is held, the free
    acceleration where it leaves the plane.
    """
    s, c = diagonal_direction
    sigma_mu = slip_direction * friction_kinetic
    e = c - sigma_mu * s
    centripetal = (1.0 + inertia_ratio) * half_diagonal * pitch_rate * pitch_rate * e
    pushing = gravity * (inertia_ratio * s * e - sigma_mu)
    sliding = ratio(pushing - centripetal, normal_response, np.nan)
    return by_case(
        contact_case, slip_direction, free_tangential_acceleration, np.zeros(()), sliding
    )


def friction_force(*, mass: Array, acceleration_along: Array) -> Array:
    """Return the friction force on the corner, along the plane [N]."""
    return mass * acceleration_along


def impact_impulse_normal(
    *, contact_case: Array, mass: Array, inertia_ratio: Array, diagonal_direction: Direction,
    gap_tangential_rate: Array,
) -> Array:  # fmt: skip
    """Return the normal impulse that stops the slip where no force is a solution; else 0 [N s].

    Lambda_N = m g_T' kappa s c/(1 + kappa), g_T' the slip velocity. Slip ends first, then
    compression with the corner at rest, so that friction drops out (theory 2.6).
    """
    s, c = diagonal_direction
    impulse = mass * gap_tangential_rate * (inertia_ratio / (1.0 + inertia_ratio) * s * c)
    return np.where(contact_case == NO_SOLUTION, impulse, 0.0)


def impact_impulse_tangential(
    *, contact_case: Array, mass: Array, inertia_ratio: Array, diagonal_direction: Direction,
    gap_tangential_rate: Array,
) -> Array:  # fmt: skip
    """Return the friction impulse that stops the slip where no force is a solution; else 0 [N s].

    Lambda_T = -m g_T' (1 + kappa c^2)/(1 + kappa), with the normal impulse of
    `impact_impulse_normal` (theory 2.6).
    """
    _, c = diagonal_direction
    slip_stop_factor = (1.0 + inertia_ratio * c * c) / (1.0 + inertia_ratio)
    return np.where(
        contact_case == NO_SOLUTION, -mass * gap_tangential_rate * slip_stop_factor, 0.0
    )


# --- limiting friction


def inverse_limiting_friction(*, inertia_ratio: Array, diagonal_direction: Direction) -> Array:
    """Return the inverse of mu_c for slip to the right, kappa s c/(1 + kappa c^2) [1].

    At mu_c the normal response vanishes: beyond it a contact may have two solutions or none. Where
    the inverse is negative, slip to the right has one solution at every friction.
    """
    s, c = diagonal_direction
    return inertia_ratio * s * c / (1.0 + inertia_ratio * c * c)


def limiting_friction_right(*, inverse_limiting_friction: Array) -> Array:
    """Return the friction at which tau = 0 in slip to the right; infinite outside 0 < s < 90 deg
    (modulo 180 deg), where no friction makes tau vanish [1].
    """  # noqa: D205
    meaningful = inverse_limiting_friction > 0
    with np.errstate(over="ignore"):
        return np.where(
            meaningful, 1.0 / np.where(meaningful, inverse_limiting_friction, 1.0), np.inf
        )


def limiting_friction_left(*, inverse_limiting_friction: Array) -> Array:
    """Return the limiting friction in slip to the left; infinite outside 90 < s < 180 deg [1]."""
    return limiting_friction_right(inverse_limiting_friction=-inverse_limiting_friction)


def least_limiting_friction(*, inertia_ratio: Array) -> Array:
    """Return the least mu_c over all pitches, 2 sqrt(1 + kappa)/kappa [1]."""
    return 2.0 * np.sqrt(1.0 + inertia_ratio) / inertia_ratio


def least_limiting_pitch(*, inertia_ratio: Array, corner_angle: Array) -> Array:
    """Return the pitch of the least mu_c, right slip: atan(sqrt(1 + kappa)) - zeta [rad]."""
    return np.arctan(np.sqrt(1.0 + inertia_ratio)) - corner_angle


# --- conditions


def is_case(known: float, *, contact_case: Array) -> Mask:
    """True where the contact is in the case `known`."""
    return contact_case == known
