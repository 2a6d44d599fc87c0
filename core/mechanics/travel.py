"""Velocity laws of dv/dt = K - mu v^2/R, drive held at its peak; (3.18) and its time forms.

K is the acceleration at zero speed, mu the kinetic coefficient, R the bowl radius, v0 the starting
speed. The forms hold for every sign of K and have mu -> 0 and R -> inf as plain limits: nothing is
divided by either. What never happens takes an infinite time; regimes say so.

All functions take and return broadcastable float64 arrays, SI units.
"""

import numpy as np

from vibrafeed.core.mechanics.arrays import (
    LOGARITHMIC,
    Array,
    Mask,
    arc_quotient,
    arc_series,
    cosine,
    expm1_quotient,
    over_itself,
    ratio,
)

# Above this phase the hyperbolic functions are replaced by their exponential forms.
LARGE_PHASE = 1.0
# Past this s = 2 mu x/R the starting speed has faded to less than 1e-300 of itself.
LONG_WAY = 1400.0
# Up to this s the square of the tangent of half an arc is small enough for a series: tanh(s/4).
SHORT_WAY = 0.15


def _rate(K: Array, friction: Array, radius: Array) -> Array:
    # A product of roots, since mu |K| may underflow.
    return np.sqrt(friction / radius) * np.sqrt(np.abs(K))


def _damping(friction: Array, radius: Array, distance: Array) -> Array:
    # Exponent by which wall friction damps the squared speed, s = 2 mu x/R [1].
    return 2 * friction * (distance / radius)


def transport_velocity(
    *,
    starting_acceleration: Array,
    friction_kinetic: Array,
    radius: Array,
    distance: Array,
    speed: Array,
) -> Array:
    """Return the speed after a distance x, (3.18) with a starting speed v0 [m s-1].

    v^2 = v0^2 exp(-s) + 2 K x phi(s), with s = 2 mu x/R, phi(s) = (1 - exp(-s))/s; 0 where the part
    does not start, or stops before.
    """
    carried, gained = _carried_and_gained(
        starting_acceleration, friction_kinetic, radius, distance, speed
    )
    from_rest, grows = carried == 0, starting_acceleration > 0  # from rest one root is enough
    moving = _speed_from_squares(carried, gained, grows)
    return np.where(from_rest, np.where(grows, gained, 0.0), moving)


def _speed_from_squares(carried: Array, gained: Array, grows: Mask) -> Array:
    # sqrt(c^2 + g^2) where it grows, else sqrt(c^2 - g^2), or 0 for c < g. One root for both, of
    # 1 + r^2 or (1 - r)(1 + r), r the ratio of the less to the greater: no overflow, and no
    # cancellation of squares near the stop.
    is_less = gained < carried
    larger, smaller = np.where(is_less, carried, gained), np.where(is_less, gained, carried)
    scale = np.where(larger > 0, larger, 1.0)
    smaller_over_larger = smaller / scale
    difference = np.maximum(0.0, carried - gained) / scale
    return larger * np.sqrt(
        np.where(
            grows,
            1.0 + smaller_over_larger * smaller_over_larger,
            difference * (1.0 + smaller_over_larger),
        )
    )


def _carried_and_gained(
    K: Array, friction: Array, radius: Array, distance: Array, speed: Array
) -> tuple[Array, Array]:
    # v0 exp(-s/2) and sqrt(2 |K| x phi(s)), what starting speed and |K| give the later speed.
    s = _damping(friction, radius, distance)
    gained = np.sqrt(2 * np.abs(K) * expm1_quotient(s)) * np.sqrt(distance)
    return speed * np.exp(-s / 2), gained


def terminal_velocity(
    *, starting_acceleration: Array, friction_kinetic: Array, radius: Array
) -> Array:
    """Return the speed that the part approaches, sqrt(K R/mu), 0 for K <= 0 [m s-1].

    K is the acceleration at zero speed, mu the friction, R the bowl's radius. Infinite (regime
    `unbounded`) without friction.
    """
    root_K = np.sqrt(np.maximum(0.0, starting_acceleration))
    root_R_over_mu = ratio(np.sqrt(radius), np.sqrt(friction_kinetic), np.inf)
    return np.where(root_K > 0, root_K, 1.0) * np.where(root_K > 0, root_R_over_mu, 0.0)


def travel_time(
    *,
    transport_velocity: Array,
    starting_acceleration: Array,
    friction_kinetic: Array,
    radius: Array,
    distance: Array,
    speed: Array,
) -> Array:
    """Return the time in which a part covers a distance x [s]; infinite if it does not get there.

    With s = 2 mu x/R, phi(s) = (1 - exp(-s))/s, k^2 = mu |K|/R and q = 2 x phi(s)/(v + v0 exp(-s)),
    v the speed at the end, it is atanh(k q)/k for K > 0, atan(k q)/k for K < 0, q for K = 0; also
    twice the same of p = x phi(s/2)/(v + v0 exp(-s/2)), which is a series for s up to `SHORT_WAY`.
    """
    K, v, v0 = starting_acceleration, transport_velocity, speed
    s = _damping(friction_kinetic, radius, distance)
    is_short = s <= SHORT_WAY
    time = _short_time(K, v, v0, s, friction_kinetic, radius, distance)
    if np.any(~is_short):
        time = np.where(is_short, time, _long_time(K, v, v0, s, friction_kinetic, radius, distance))
    return time


def _short_time(
    K: Array, v: Array, v0: Array, s: Array, friction: Array, radius: Array, distance: Array
) -> Array:
    # Half of the arc has the tangent k p, p = x phi(s/2)/(v + v0 exp(-s/2)), and the time is 2 p
    # times the `arc_series` of (mu/R) K p^2. From rest K cancels, and that is tanh(s/4).
    decay = np.exp(-s / 2)
    p, arrives = _time_quotient(distance * expm1_quotient(s / 2), v, v + v0 * decay, distance)
    from_rest = -np.expm1(-s / 2) / (1 + decay)
    square = np.where(v0 == 0, from_rest, friction / radius * p * (K * p))
    return np.where(arrives, 2.0 * p * arc_series(square), np.inf)


def _long_time(
    K: Array, v: Array, v0: Array, s: Array, friction: Array, radius: Array, distance: Array
) -> Array:
    # q times the `arc_quotient` of (mu/R) K q^2, whose root is exp(-s/2) (v + v0)/(v + v0 exp(-s)).
    # From rest K cancels, and (mu/R) K q^2 = 1 - exp(-s).
    from_rest, has_distance = v0 == 0, distance > 0
    twice_faded_distance = 2 * distance * expm1_quotient(s)
    q, arrives = _time_quotient(twice_faded_distance, v, v + v0 * np.exp(-s), distance)
    # Past LONG_WAY the exponential would underflow, and what was carried is long gone.
    square, root = -np.expm1(-s), np.exp(-np.minimum(s, LONG_WAY) / 2)
    if np.any(~from_rest):  # else both stay on the small grid of their own
        root_in_motion = root / np.where(has_distance, twice_faded_distance, 1.0) * ((v + v0) * q)
        square = np.where(from_rest, square, friction / radius * q * (K * q))
        root = np.where(from_rest, root, root_in_motion)
    beyond_long_way = np.where(square > LOGARITHMIC, np.maximum(0.0, s - LONG_WAY) / 2, 0.0)
    return np.where(arrives, q * (arc_quotient(square, root) + beyond_long_way), np.inf)


def _time_quotient(
    numerator: Array, speed: Array, denominator: Array, distance: Array
) -> tuple[Array, Mask]:
    # numerator/denominator, and True where it is finite: the part moves on and arrives.
    has_distance = distance > 0
    with np.errstate(over="ignore", divide="ignore"):
        quotient = np.where(has_distance, numerator, 0.0) / np.where(
            has_distance, np.where(speed > 0, denominator, 0.0), 1.0
        )
    arrives = np.isfinite(quotient)
    return np.where(arrives, quotient, 0.0), arrives


def mean_velocity(
    *,
    travel_time: Array,
    distance: Array,
    speed: Array,
    transport_velocity: Array,
    friction_kinetic: Array,
    radius: Array,
) -> Array:
    """Return the distance over the travel time [m s-1]; 0 where the part does not get there.

    Where the part gets there, but in a time beyond the range of floats, the mean is computed from
    the speeds at start and end instead.
    """
    s = _damping(friction_kinetic, radius, distance)
    from_speeds = (transport_velocity + speed * np.exp(-s)) / (2 * expm1_quotient(s))
    mean = ratio(distance, travel_time, speed)
    return np.where(np.isinf(travel_time) & (transport_velocity > 0), from_speeds, mean)


def _speed_ratio(K: Array, friction: Array, radius: Array, speed: Array) -> Array:
    # Starting speed over sqrt(|K| R/mu), where the part brakes (K < 0); else 0 [1].
    root = np.sqrt(np.where(K < 0, -K, 1.0))
    return np.where(K < 0, speed * np.sqrt(friction / radius) / root, 0.0)


def stopping_distance(
    *, starting_acceleration: Array, friction_kinetic: Array, radius: Array, speed: Array
) -> Array:
    """Return the stopping distance, R/(2 mu) log1p(mu v0^2/(|K| R)); infinite without stop [m].

    With y = v0 sqrt(mu/(|K| R)); for y below 1 it is written as v0^2/(2 |K|) log1p(y^2)/y^2, else
    the logarithm is taken of y: v0/|K| may be too large for a float where the distance is not.
    """
    K = starting_acceleration
    y = _speed_ratio(K, friction_kinetic, radius, speed)
    fast = y > 1
    slow = (K < 0) & ~fast
    root_energy = np.where(slow, speed, 0.0) / np.sqrt(np.where(slow, -K, 1.0))
    with np.errstate(over="ignore"):  # beyond the floats it is infinite
        from_y = (
            root_energy * root_energy / 2 * over_itself(np.log1p, np.square(np.where(fast, 0.0, y)))
        )
    y_above_1 = np.where(fast, y, 1.0)
    R_over_mu = ratio(np.where(fast, radius, 0.0), friction_kinetic, 0.0)
    from_logarithm = R_over_mu * (np.log(y_above_1) + np.log1p(np.square(1 / y_above_1)) / 2)
    at_rest = (K == 0) & (speed == 0)
    return np.where(K < 0, np.where(fast, from_logarithm, from_y), np.where(at_rest, 0.0, np.inf))


def stopping_time(
    *, starting_acceleration: Array, friction_kinetic: Array, radius: Array, speed: Array
) -> Array:
    """Return the stopping time, sqrt(R/(|K| mu)) atan(v0 sqrt(mu/(|K| R))); infinite if none [s].

    Below y = v0 sqrt(mu/(|K| R)) = 1 it is written as v0/|K| atan(y)/y, which holds for mu = 0,
    too.
    """
    K = starting_acceleration
    y = _speed_ratio(K, friction_kinetic, radius, speed)
    fast = y > 1
    slow = (K < 0) & ~fast
    with np.errstate(over="ignore"):  # beyond the floats it is infinite
        frictionless_time = np.where(slow, speed, 0.0) / np.where(slow, -K, 1.0)
        angle = np.where(fast, np.arctan(y), 0.0)
        from_angle = ratio(angle, _rate(K, friction_kinetic, radius), np.inf)
    from_quotient = frictionless_time * over_itself(np.arctan, np.where(fast, 0.0, y))
    at_rest = (K == 0) & (speed == 0)
    return np.where(
        K < 0, np.where(fast, from_angle, from_quotient), np.where(at_rest, 0.0, np.inf)
    )


def velocity_at_time(
    *,
    starting_acceleration: Array,
    friction_kinetic: Array,
    radius: Array,
    time: Array,
    speed: Array,
    stopping_time: Array,
) -> Array:
    """Return the speed at a time t, (v0 + K t T)/(1 + mu v0 t T/R) [m s-1]; 0 after the stop.

    T = tanh(u)/u for K > 0, tan(u)/u for K < 0, u = t sqrt(mu |K|/R).
    """
    K, v0 = starting_acceleration, speed
    moving = (time < stopping_time) | (time == 0)
    t = np.where(moving, time, 0.0)
    u = t * _rate(K, friction_kinetic, radius)
    tT = t * np.where(K > 0, over_itself(np.tanh, u), over_itself(np.tan, np.where(K > 0, 0.0, u)))
    velocity = (v0 + K * tT) / (1.0 + friction_kinetic * (tT / radius) * v0)
    return np.where(moving, np.maximum(0.0, velocity), 0.0)


def distance_at_time(
    *,
    starting_acceleration: Array,
    friction_kinetic: Array,
    radius: Array,
    time: Array,
    speed: Array,
    stopping_time: Array,
    stopping_distance: Array,
) -> Array:
    """Return the distance that a part has covered at a time t [m]; that of its stop afterwards.

    exp(mu x/R) is cosh u + y0 sinh u (K > 0) or cos u + y0 sin u (K < 0), u = t sqrt(mu |K|/R), y0
    = v0/sqrt(|K| R/mu). It is written as one log1p whose argument has mu/R as a factor, so that
    R/mu cancels.
    """
    K, v0 = starting_acceleration, speed
    moving = (time < stopping_time) | (time == 0)
    t = np.where(moving, time, 0.0)
    k = _rate(K, friction_kinetic, radius)
    u = t * k
    forward = K > 0
    is_late = forward & (u > LARGE_PHASE)
    # Arguments outside a branch are replaced: no overflow, no warning.
    small_forward = np.where(forward & ~is_late, u, 0.0)
    braking = np.where(forward, 0.0, u)
    from_speed = v0 * t * over_itself(np.sin, braking) * over_itself(np.sinh, small_forward)
    half_angle = over_itself(np.sin, braking / 2) * over_itself(np.sinh, small_forward / 2)
    from_drive = K * t * t / 2 * half_angle * half_angle
    straight = from_speed + from_drive
    z = np.where(is_late, 0.0, straight * (friction_kinetic / radius))
    early = straight * over_itself(np.log1p, z)
    y0 = ratio(k * v0, np.abs(K), 0.0)
    late_phase = np.where(is_late, u, 1.0)
    beyond_phase = np.log1p((np.where(is_late, y0, 1.0) - 1.0) * (-np.expm1(-2 * late_phase)) / 2)
    late = K * np.square(t / late_phase) * (late_phase + beyond_phase)
    return np.where(moving, np.where(is_late, late, early), stopping_distance)


def suggested_distance(*, amplitude: Array, alpha: Array, beta: Array) -> Array:
    """Return the bound of the distance for negligible gravity, (A0/2) cos(beta) cos(alpha) [m]."""
    return np.abs(amplitude / 2 * cosine(beta) * cosine(alpha))


def distance_bound(
    *,
    starting_acceleration: Array,
    velocity_bound: Array,
    friction_kinetic: Array,
    radius: Array,
) -> Array:
    """Return the distance after which a part from rest would be faster than the track [m].

    Beyond it the law (3.18) describes nothing real: x_max = -R/(2 mu) log1p(-mu v_b^2/(K R)), with
    the largest speed v_b of the track. Infinite where the terminal velocity is below v_b, or the
    part does not start.
    """
    K = starting_acceleration
    starts = K > 0
    frictionless = np.square(velocity_bound) / (2 * np.where(starts, K, 1.0))
    z = 2 * frictionless * friction_kinetic / radius
    is_reached = starts & (z < 1)
    return np.where(
        is_reached, frictionless * over_itself(np.log1p, -np.where(is_reached, z, 0.0)), np.inf
    )


def does_not_start(*, starting_acceleration: Array, speed: Array) -> Mask:
    """True where no forward motion arises: K <= 0 from rest."""
    return (starting_acceleration <= 0) & (speed == 0)


def stops_before_distance(
    *,
    starting_acceleration: Array,
    friction_kinetic: Array,
    radius: Array,
    distance: Array,
    speed: Array,
) -> Mask:
    """True where a part in motion stops before, or at, the distance: v^2 <= 0 in (3.18).

    It is `stopping_distance` compared with the distance, without its logarithm.
    """
    K = starting_acceleration
    carried, gained = _carried_and_gained(K, friction_kinetic, radius, distance, speed)
    return (speed > 0) & (K < 0) & (carried <= gained)


def exceeds_track(velocity: str, **values: Array) -> Mask:
    """True where a velocity exceeds the largest speed of the track, which friction cannot do."""
    return values[velocity] > values["velocity_bound"]


def is_endless(quantity: str, **values: Array) -> Mask:
    """True where a quantity is infinite."""
    return np.isinf(values[quantity])
