"""Rows of parts in one lane: flow, what fills and clears it, and the force on what holds it.

Closed forms (theory 17.5). Parts are equal, their faces smooth; a row moves with the velocity v of
one part. Arrays broadcast; SI units, rates in 1/s but where a unit is given.
"""

import numpy as np

from vibrafeed.core.mechanics import floor
from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, ratio, sine
from vibrafeed.core.quantities.row import MAX_PARTS
from vibrafeed.core.scenes.on_floor import LEVEL_GRAVITY
from vibrafeed.core.scenes.scene import STANDARD_GRAVITY, Condition, Equation, Scene

MINUTE = 60.0  # seconds
HELD_FROM = 1.7048313528
"""Throw number G from which every contact with the floor happens while the track runs forward: the
root of asin(1/G) + D(G) = 3 pi/2, D the phase in which a part that lifts off by itself flies."""


# --- flow


def lane_pitch(*, length: Array, part_gap: Array) -> Array:
    """Return the distance from part to part of a closed row, l + gap [m]."""
    return length + part_gap


def throughput_limit(*, row_velocity: Array, lane_pitch: Array) -> Array:
    """Return the most parts a minute that a lane conveys, 60 v/l [min-1]."""
    return MINUTE * row_velocity / lane_pitch


def throughput(*, inflow: Array, throughput_limit: Array) -> Array:
    """Return the parts a minute that leave a free lane: the inflow, up to its limit [min-1]."""
    return np.minimum(inflow, throughput_limit)


def is_crowded(*, inflow: Array, throughput_limit: Array) -> Mask:
    """True where more parts come than the lane can take."""
    return inflow > throughput_limit


def part_spacing(*, row_velocity: Array, throughput: Array) -> Array:
    """Return the distance from part to part of a free lane, 60 v/q, with q parts a minute [m]."""
    return ratio(MINUTE * row_velocity, throughput, np.inf)


def queue_velocity(*, inflow: Array, row_velocity: Array, lane_pitch: Array) -> Array:
    """Return the velocity with which the tail of a queue moves back, q l v/(v - q l) [m s-1].

    The queue stands in front of a closed end; q is the inflow in parts a second. Infinite where the
    inflow is all that the lane takes, NaN where it is more.
    """
    flow = inflow / MINUTE * lane_pitch  # q l
    spare = row_velocity - flow
    return np.where(spare < 0, np.nan, ratio(flow * row_velocity, spare, np.inf))


def fill_time(*, lane_length: Array, lane_pitch: Array, inflow: Array) -> Array:
    """Return the time until a lane with a closed end is full, L/(l q), whatever the velocity [s].

    L is the length of the lane, l the pitch of a closed row, q the inflow in parts a second.
    """
    return ratio(MINUTE * lane_length, lane_pitch * inflow, np.inf)


def clear_time(*, lane_length: Array, row_velocity: Array) -> Array:
    """Return the time until a full lane is clear, L/v: rigid parts start all at once [s]."""
    return lane_length / row_velocity


def escapement_rate(
    *, closed_time: Array, open_time: Array, lane_pitch: Array, row_velocity: Array
) -> Array:
    """Return the parts a minute of an escapement, 60/(t_c + max(t_o, l/v)): one a stroke [min-1].

    It stays open at least until a part of the pitch l has passed at the velocity v.
    """
    return MINUTE / (closed_time + np.maximum(open_time, lane_pitch / row_velocity))


# --- platoons


def mean_platoons(*, parts: Array) -> Array:
    """Return the mean number of platoons of n parts with random friction, 1 + 1/2 + ... + 1/n [1].

    Platoons are parts that stay together. It holds where parts slip one way only, whatever the
    distribution of friction: the faces of the convex minorant of a random walk (Sparre Andersen).
    """
    platoons = np.zeros_like(parts)
    for k in range(1, MAX_PARTS + 1):
        platoons = platoons + np.where(parts >= k, 1.0 / k, 0.0)
    return platoons


def closing_time(*, part_gap: Array, row_velocity: Array, front_velocity: Array) -> Array:
    """Return the time until the gap g to a slower row in front closes, g/(v - v_f) [s].

    v and v_f are the velocities of this row and of the one in front; infinite where the latter is
    not slower.
    """
    closing_velocity = row_velocity - front_velocity
    return np.where(closing_velocity > 0, ratio(part_gap, closing_velocity, np.inf), np.inf)


def pair_force(
    *, part_mass_1: Array, part_mass_2: Array, part_friction_1: Array, part_friction_2: Array,
    gravity: Array,
) -> Array:  # fmt: skip
    """Return the force between two parts that slide forward, m (mu_2 - mu_1) g [N].

    m = m1 m2/(m1 + m2), and part 1 is behind part 2; 0 where part 1 has the larger friction and
    stays back.
    """
    reduced_mass = part_mass_1 * (part_mass_2 / (part_mass_1 + part_mass_2))
    return reduced_mass * np.maximum(part_friction_2 - part_friction_1, 0.0) * gravity


# --- bend


def bend_pitch(*, length: Array, part_width: Array, bend_radius: Array) -> Array:
    """Return the distance of neighbours on the outer wall of a bend, along their centres [m].

    Parts of length l and width a touch at the inner corners, so that the angle between them is 2
    atan((l/2)/(r - a)), r = sqrt(R^2 - l^2/4), in a bend of radius R.
    """
    half = length / 2
    chord = np.sqrt(bend_radius * bend_radius - half * half)
    return 2 * np.arctan2(half, chord - part_width) * (chord - part_width / 2)


def is_too_long(*, length: Array, part_width: Array, bend_radius: Array) -> Mask:
    """True where a part does not fit into the bend."""
    half = length / 2
    return bend_radius * bend_radius - half * half <= part_width * part_width


def held_line_force(
    *, line_push: Array, bend_radius: Array, bend_friction: Array, bend_length: Array
) -> Array:
    """Return the front force C of a row that sticks in a bend, (q R/mu)(exp(mu s/R) - 1) [N].

    dC/ds = q + mu C/R, since the track slips forward under the row, and the wall's friction pushes
    with it: push q per length, radius R and length s of the bend, friction mu of its wall (theory
    17.5).
    """
    return (
        line_push * bend_radius / bend_friction
        * np.expm1(bend_friction * bend_length / bend_radius)
    )  # fmt: skip


def sliding_line_force(
    *, line_push: Array, bend_radius: Array, bend_friction: Array, bend_length: Array
) -> Array:
    """Return the front force C of a row that slides in a bend, (q R/mu)(1 - exp(-mu s/R)) [N].

    dC/ds = q - mu C/R, symbols as of `held_line_force`: C tends to q R/mu, as the pressure of grain
    in a silo does.
    """
    return (
        -line_push * bend_radius / bend_friction
        * np.expm1(-bend_friction * bend_length / bend_radius)
    )  # fmt: skip


# --- stop at rest in space, under a sine


def row_weight(*, row_mass: Array, gravity: Array) -> Array:
    """Return the weight of the row, M g [N]."""
    return row_mass * gravity


def held_force(*, row_weight: Array, friction_kinetic: Array) -> Array:
    """Return the mean force of a row on a stop at rest in space, on a level track, mu M g [N].

    Exact from a throw number of 1.70483 on, whatever the drive along the track; below it an upper
    bound.
    """
    return friction_kinetic * row_weight


def is_bound_only(*, throw_number: Array) -> Mask:
    """True where the throw number is below 1.70483: the force is bounded, but not known."""
    return throw_number < HELD_FROM


# --- stop at rest in space, under two levels of acceleration


def two_level_hold(
    *, forward_acceleration: Array, return_acceleration: Array, friction_kinetic: Array,
    gravity: Array, frequency: Array,
) -> tuple[Array, Array, Array]:  # fmt: skip
    """Return time without contact [s], impact velocity [m s-1] and period [s] of a row at a stop.

    The track's velocity rises with a_s to V = a_s t_s/2, t_s = T a_m/(a_s + a_m), and falls with
    a_m. At time 0 it passes 0, falling, and friction drags the row off the stop with velocity
    -mu g t. From t_h = V/a_m the track accelerates forward again; it has the row's velocity at
    t = (V + a_s t_h)/(a_s + mu g) and carries the row from then on. The row strikes the stop after
    a further time s = (mu g t + sqrt((mu g t)^2 + a_s mu g t^2))/a_s, with V_i = a_s s - mu g t.
    The first result is t + s, the second V_i (theory 17.5).
    """
    period = 1.0 / frequency
    a_s, a_m, mu_g = forward_acceleration, return_acceleration, friction_kinetic * gravity
    peak = a_s * period * a_m / (a_s + a_m) / 2  # V
    t = (peak + a_s * peak / a_m) / (a_s + mu_g)
    backward = mu_g * t
    s = (backward + np.sqrt(backward * backward + a_s * mu_g * t * t)) / a_s
    return t + s, a_s * s - backward, period


def two_level_force(
    *, two_level_hold: tuple[Array, Array, Array], row_weight: Array, friction_kinetic: Array,
    gravity: Array,
) -> Array:  # fmt: skip
    """Return the mean force on the stop, M (mu g (T - t - s) + V_i)/T, impacts included [N].

    M is the mass of the row; the others as of `two_level_hold`.
    """
    free_time, impact_velocity, period = two_level_hold
    drag = friction_kinetic * gravity * (period - free_time)
    return row_weight / gravity * (drag + impact_velocity) / period


def two_level_contact(*, two_level_hold: tuple[Array, Array, Array]) -> Array:
    """Return the share of the time in which the row touches the stop, (T - t - s)/T [1]."""
    free_time, _, period = two_level_hold
    return (period - free_time) / period


def two_level_impacts(
    *, two_level_hold: tuple[Array, Array, Array], friction_kinetic: Array, gravity: Array
) -> Array:
    """Return the share of the impacts in the mean force on the stop [1].

    V_i/(mu g (T - t - s) + V_i), as of `two_level_hold`.
    """
    free_time, impact_velocity, period = two_level_hold
    drag = friction_kinetic * gravity * (period - free_time)
    return impact_velocity / (drag + impact_velocity)


def strikes_too_late(
    *, two_level_hold: tuple[Array, Array, Array], forward_acceleration: Array,
    return_acceleration: Array,
) -> Mask:  # fmt: skip
    """True where the track turns back before the row is at the stop: t + s > t_h + 2 V/a_s.

    The closed form of the force on the stop does not hold there; symbols as of `two_level_hold`.
    """
    free_time, _, period = two_level_hold
    a_s, a_m = forward_acceleration, return_acceleration
    peak = a_s * period * a_m / (a_s + a_m) / 2  # V
    return free_time > peak / a_m + 2 * peak / a_s


def is_not_carried(
    *, forward_acceleration: Array, return_acceleration: Array, friction_kinetic: Array,
    gravity: Array,
) -> Mask:  # fmt: skip
    """True where friction does not carry the row forward, or holds it while the track runs back."""
    mu_g = friction_kinetic * gravity
    return (forward_acceleration > mu_g) | (return_acceleration <= mu_g)


# --- stop that moves with the track, under a sine


def least_held_force(
    *, row_weight: Array, friction_static: Array, gravity: Array, gamma: Array,
    vibration_acceleration: Array, beta: Array,
) -> Array:  # fmt: skip
    """Return the mean over a period of the least force on a stop that moves with the track [N].

    Parts of total mass M press with at least F(t) = M max(0, D - mu n), push D and load n per mass.
    The mean is (M/pi)(C cos(t_f) - k (pi/2 - t_f)), with C = P (cos beta + mu sin beta), k = g (sin
    gamma + mu cos gamma) and sin(t_f) = k/C; 0 where C <= k.
    """
    c = vibration_acceleration * (cosine(beta) + friction_static * sine(beta))
    k = gravity * (sine(gamma) + friction_static * cosine(gamma))
    t_f = _arcsine(k, c)
    mean = (c * np.cos(t_f) - k * (np.pi / 2 - t_f)) / np.pi
    return row_weight / gravity * np.where(c > k, mean, 0.0)


def locked_held_force(
    *, row_weight: Array, friction_static: Array, gravity: Array, gamma: Array,
    vibration_acceleration: Array, beta: Array,
) -> Array:  # fmt: skip
    """Return the mean force of a row on a stop of the track, as friction may lock it in [N].

    Stiff elastic parts keep a force until friction is overcome: F/M follows max(L, min(U, F)), at
    least 0, between L = D - mu n and U = D + mu n, both sines of the phase less a constant. F is
    largest, F_1, where L is, stays until U falls to it, follows U to its least value F_2, and stays
    until L rises to that (theory 17.5).
    """
    cos_gamma, sin_gamma = cosine(gamma), sine(gamma)
    # L = l_sine sin(phase) - l_constant, U = u_sine sin(phase) - u_constant.
    l_sine = vibration_acceleration * (cosine(beta) + friction_static * sine(beta))
    l_constant = gravity * (sin_gamma + friction_static * cos_gamma)
    u_sine = vibration_acceleration * (cosine(beta) - friction_static * sine(beta))
    u_constant = gravity * (sin_gamma - friction_static * cos_gamma)
    f_1 = np.maximum(l_sine - l_constant, 0.0)
    f_2 = np.maximum(np.minimum(f_1, -np.abs(u_sine) - u_constant), 0.0)
    # Phases within -pi/2 and pi/2: U is F_1 and F_2 at u_1 and u_2, mirrored where it falls, and
    # L is F_2 at l_2.
    u_1, u_2 = _arcsine(f_1 + u_constant, u_sine), _arcsine(f_2 + u_constant, u_sine)
    l_2 = _arcsine(f_2 + l_constant, l_sine)
    half = np.pi / 2
    integral = (
        f_1 * (half - u_1)  # F_1 from the peak of L on
        + u_sine * (np.cos(u_2) - np.cos(u_1))  # U while it falls
        - u_constant * (u_1 - u_2)
        + f_2 * (half + u_2)  # F_2 to the lowest point of the sine, and from there
        + f_2 * (half + l_2)
        + l_sine * np.cos(l_2)  # L while it rises to its peak
        - l_constant * (half - l_2)
    )
    return row_weight / gravity * np.where(f_1 > 0.0, integral / (2 * np.pi), 0.0)


def _arcsine(value: Array, gain: Array) -> Array:
    return np.arcsin(np.maximum(np.minimum(ratio(value, gain, 1.0), 1.0), -1.0))


def least_two_level_force(
    *, row_weight: Array, friction_static: Array, gravity: Array, forward_acceleration: Array,
    return_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the mean least force on a stop that moves with a track of two accelerations [N].

    M (a_m - mu g) a_s/(a_s + a_m), with a_s forward and a_m back: the row presses while the track
    runs back; 0 where friction holds it.
    """
    excess = np.maximum(return_acceleration - friction_static * gravity, 0.0)
    time_fraction = forward_acceleration / (forward_acceleration + return_acceleration)
    return row_weight / gravity * excess * time_fraction


def slips_back_in_steps(
    *, friction_static: Array, gravity: Array, forward_acceleration: Array
) -> Mask:
    """True where the row leaves its stop as the track creeps forward: a_s > mu g."""
    return forward_acceleration > friction_static * gravity


def never_closes(*, row_velocity: Array, front_velocity: Array) -> Mask:
    """True where the parts in front are as fast, or faster."""
    return row_velocity <= front_velocity


def slips_back(
    *, friction_static: Array, gravity: Array, gamma: Array, vibration_acceleration: Array,
    beta: Array,
) -> Mask:  # fmt: skip
    """True where the row leaves a stop of the track: P (cb - mu sb) > g (mu cos gamma - sin gamma).

    P is the vibration acceleration; cb and sb are cosine and sine of beta.
    """
    push = vibration_acceleration * (cosine(beta) - friction_static * sine(beta))
    return push > gravity * (friction_static * cosine(gamma) - sine(gamma))


def leaves_floor(
    *, gravity: Array, gamma: Array, vibration_acceleration: Array, beta: Array
) -> Mask:
    """True where the row leaves the floor."""
    return vibration_acceleration * sine(beta) > gravity * cosine(gamma)


SOURCE = "theory 17.5"
WEIGHT = Equation("row_weight", row_weight, SOURCE)
LOCKED = frozenset(("least_stop_force", "locked_stop_force"))
STEPS = frozenset(("stop_force", "stop_contact_fraction", "stop_impact_share"))

SCENE = Scene(
    name="row-on-plane",
    title="Row of equal parts in one lane",
    source="",
    validity="The parts are equal, have smooth faces, move as a single part does, and neither "
    "tip nor wedge. With fixed_stop the stop is at rest in space, the drive is a sine and the "
    "lane is level; the force is exact if the throw number is at least 1.705. With track_stop "
    "the stop moves with the track: rigid parts press on it with least_stop_force or more, and "
    "stiff elastic parts keep locked_stop_force.",
    variants={
        "lane": (
            Equation("lane_pitch", lane_pitch, SOURCE),
            Equation("throughput_limit", throughput_limit, SOURCE),
            Equation("throughput", throughput, SOURCE),
            Equation("part_spacing", part_spacing, SOURCE),
            Equation("queue_velocity", queue_velocity, SOURCE),
            Equation("fill_time", fill_time, SOURCE),
            Equation("clear_time", clear_time, SOURCE),
            Equation("escapement_rate", escapement_rate, SOURCE),
        ),
        "bend": (
            Equation("bend_pitch", bend_pitch, SOURCE),
            Equation("held_line_force", held_line_force, SOURCE),
            Equation("sliding_line_force", sliding_line_force, SOURCE),
        ),
        "fixed_stop": (
            Equation("vibration_acceleration", floor.vibration_acceleration, "theory 0.2"),
            Equation("drive_normal", floor.drive_normal, "(3.10)"),
            LEVEL_GRAVITY,
            Equation("throw_number", floor.throw_number, "theory 13.2"),
            WEIGHT,
            Equation("stop_force", held_force, SOURCE),
        ),
        "stepped_stop": (
            WEIGHT,
            Equation("two_level_hold", two_level_hold, SOURCE),
            Equation("stop_force", two_level_force, SOURCE),
            Equation("stop_contact_fraction", two_level_contact, SOURCE),
            Equation("stop_impact_share", two_level_impacts, SOURCE),
        ),
        "track_stop": (
            Equation("vibration_acceleration", floor.vibration_acceleration, "theory 0.2"),
            WEIGHT,
            Equation("least_stop_force", least_held_force, SOURCE),
            Equation("locked_stop_force", locked_held_force, SOURCE),
        ),
        "stepped_track_stop": (
            WEIGHT, Equation("least_stop_force", least_two_level_force, SOURCE),
        ),
        "platoons": (
            Equation("mean_platoons", mean_platoons, SOURCE),
            Equation("closing_time", closing_time, SOURCE),
            Equation("pair_force", pair_force, SOURCE),
        ),
    },
    default_variant="lane",
    conditions={
        "lane": (
            Condition("crowded", is_crowded,
                      frozenset(("throughput", "part_spacing", "queue_velocity")), "contact"),
        ),
        "bend": (
            Condition("invalid_geometry", is_too_long, frozenset(("bend_pitch",)), "contact"),
        ),
        "fixed_stop": (
            Condition("indeterminate_force", is_bound_only, frozenset(("stop_force",)), "contact"),
        ),
        "stepped_stop": (
            Condition("indeterminate_force", is_not_carried, STEPS, otherwise="contact"),
            Condition("indeterminate_force", strikes_too_late, STEPS),
        ),
        "track_stop": (
            Condition("flight", leaves_floor, LOCKED, otherwise="contact"),
            Condition("indeterminate_force", slips_back, LOCKED),
        ),
        "stepped_track_stop": (
            Condition("indeterminate_force", slips_back_in_steps, frozenset(("least_stop_force",)),
                      "contact"),
        ),
        "platoons": (
            Condition("separating", never_closes, frozenset(("closing_time",)), "contact"),
        ),
    },
    defaults={"part_gap": 0.0, "gravity": STANDARD_GRAVITY},
    variant_defaults={"track_stop": {"gamma": 0.0}},
    constraints=(),
)  # fmt: skip
