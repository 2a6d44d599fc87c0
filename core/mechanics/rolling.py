"""A cylinder that lies on a plane, axis along x: rolling and sliding from rest (theory 7).

All functions take and return broadcastable float64 arrays, SI units, angles in radians.
"""

from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Elementwise, Mask, hypot, ratio

# Newton's steps: a solid cylinder has its root to the last bit after five, over all inputs that the
# tests try; what turns more easily needs more. A loop over arrays stops as soon as no root moves; a
# compiled one takes them all.
SOLID_STEPS, MAX_STEPS = 5, 12

SOLID = 2.0
"""m r^2/I of a solid cylinder about its axis, kap."""


def printed_angular_acceleration(*, drive_across: Array, diameter: Array) -> Array:
    """Return the angular acceleration as printed in (3.36), 4 P cos(beta) sin(alpha)/d [rad s-2].

    The source divides the drive's moment about the contact line by the inertia about the centre:
    three times the right value.
    """
    return 4 * drive_across / diameter


def rolling_angular_acceleration(*, drive_across: Array, diameter: Array) -> Array:
    """Return the angular acceleration of rolling, 4 P cos(beta) sin(alpha)/(3 d), (4.19) [rad s-2].

    The drive's moment about the contact line over the inertia about that line.
    """
    return 4 * drive_across / (3 * diameter)


def is_rolling(
    *,
    in_plane_drive_x: Array,
    in_plane_drive_y: Array,
    friction_static: Array,
    floor_acceleration: Array,
) -> Mask:
    """True where the contact line does not slip: hypot(D_x, D_y/3) <= mu_s n, n > 0.

    D_x and D_y are drive and gravity along the axis and across it, n the floor's force, all per
    mass.
    """
    grips = hypot(in_plane_drive_x, in_plane_drive_y / 3) <= friction_static * floor_acceleration
    return grips & (floor_acceleration > 0)


def is_at_rest(
    *,
    in_plane_drive_x: Array,
    in_plane_drive_y: Array,
    friction_static: Array,
    floor_acceleration: Array,
) -> Mask:
    """True where the cylinder stays at rest: no slip, and nothing that makes it roll."""
    grips = np.abs(in_plane_drive_x) <= friction_static * floor_acceleration
    return grips & (in_plane_drive_y == 0) & (floor_acceleration > 0)


def roll_root(
    *,
    in_plane_drive_x: Array,
    in_plane_drive_y: Array,
    friction_static: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
) -> Array:
    """Return the acceleration z of slip at the contact; 0 where the cylinder rolls [m s-2].

    z > 0 solves D_x^2/(z+q)^2 + D_y^2/(z+3q)^2 = 1, q = mu_k n, with drive and gravity D_x along
    the axis and D_y across it, and the floor's force n, all per mass. Static friction decides
    whether it rolls.
    """
    return slip_root(
        in_plane_drive_x, in_plane_drive_y, SOLID, friction_static, friction_kinetic,
        floor_acceleration,
    )  # fmt: skip


def slip_root(
    along: Array, across: Array, rolling_factor: Array | float, friction_static: Array,
    friction_kinetic: Array, floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the acceleration z with which a round part's contact slips; 0 where it rolls [m s-2].

    From rest. z > 0 solves D_a^2/(z+q)^2 + D_c^2/(z+(1+kap)q)^2 = 1, q = mu_k n, with the push D_a
    along the axis, D_c across it, the floor's force n, all per mass, and kap = m r^2/I. After
    lift-off q = 0 and z = |D|.
    """
    contact_factor = 1 + rolling_factor
    push_along, push_across = np.abs(along), np.abs(across)
    rolls: Mask = hypot(along, across / contact_factor) <= friction_static * floor_acceleration
    rolls = rolls & (floor_acceleration > 0)
    q = friction_kinetic * floor_acceleration
    magnitude = hypot(push_along, push_across)
    slips = ~rolls & (magnitude > 0)
    # Unit scale, so that no power leaves the range of floats.
    scale = np.where(slips, magnitude, 1.0)
    x_fraction = np.where(slips, push_along, 1.0) / scale
    y_fraction, friction_fraction = (
        np.where(slips, push_across, 0.0) / scale,
        np.where(slips, q, 0.0) / scale,
    )
    return np.where(
        slips, slip_share(x_fraction, y_fraction, friction_fraction, contact_factor) * scale, 0.0
    )


@Elementwise
def slip_share(x: Array, y: Array, s: Array, contact_factor: Array | float) -> Array:
    """Return the root z >= 0 of h(z) = x^2/(z+s)^2 + y^2/(z+c s)^2 = 1, for slips [1].

    x and y are the shares of the push along and across the axis, x^2 + y^2 = 1, s kinetic friction
    times load over the push, c = `contact_factor` = 1 + m r^2/I.

    1/sqrt(h) is concave and nearly linear in z: its chords to infinity, and those of each term
    alone, lie below the root, and Newton's method climbs from there without safeguard (the secular
    equation of trust-region methods). In place of sqrt(h) - 1 stands 2 (h - 1)/(h + 3), which is
    less and equal up to the third order: a step has one quotient, no root.
    """
    x_squared, y_squared = x * x, y * y
    z = np.maximum(
        np.maximum(x - s, y - contact_factor * s),
        np.maximum(1.0 - s * (x_squared + contact_factor * y_squared), 0.0),
    )
    steps = (
        SOLID_STEPS if type(contact_factor) is float and contact_factor <= 1 + SOLID else MAX_STEPS
    )
    for _ in range(steps):
        z_x, z_y = z + s, z + contact_factor * s
        z_x_squared, z_y_squared = z_x * z_x, z_y * z_y
        x_term, y_term, both_squared = (
            x_squared * z_y_squared,
            y_squared * z_x_squared,
            z_x_squared * z_y_squared,
        )
        h = x_term + y_term
        next_z = z + 2.0 * (z_x * z_y) * (h - both_squared) * h / (
            (3.0 * both_squared + h) * (x_term * z_y + y_term * z_x)
        )
        if not np.any(next_z > z):  # a cell that has its root keeps it
            break
        z = np.where(next_z > z, next_z, z)
    return z


def across_axis(
    push: Array, roll_root: Array, rolling_factor: Array | float, rolling_share: Array | float,
    friction_kinetic: Array, floor_acceleration: Array,
) -> Array:  # fmt: skip
    """Return the acceleration of a round part across its axis, rolling or slipping [m s-2].

    D_c (z + kap q)/(z + (1 + kap) q), D_c = `push` across the axis, z = `roll_root`, kap = m r^2/I,
    q = mu_k n. Where z = 0 the part rolls with D_c kap/(1 + kap).
    """
    q = friction_kinetic * floor_acceleration
    denominator = roll_root + (1 + rolling_factor) * q
    slipping_share = ratio(roll_root + rolling_factor * q, denominator, rolling_share)
    return push * np.where(roll_root == 0, rolling_share, slipping_share)


def slipping_acceleration_x(
    *,
    in_plane_drive_x: Array,
    roll_root: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
) -> Array:
    """Return the acceleration of a cylinder along its axis, D_x z/(z+q) [m s-2].

    z is `roll_root` and q = mu_k n; 0 where it rolls without slip.
    """
    q = friction_kinetic * floor_acceleration
    return in_plane_drive_x * ratio(roll_root, roll_root + q, 0.0)


def slipping_acceleration_y(
    *,
    in_plane_drive_y: Array,
    roll_root: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
) -> Array:
    """Return the acceleration of a cylinder in rolling direction, D_y (z+2q)/(z+3q) [m s-2].

    z is `roll_root` and q = mu_k n; where it rolls (z = 0) it is 2 D_y/3.
    """
    return across_axis(
        in_plane_drive_y, roll_root, SOLID, 2.0 / 3.0, friction_kinetic, floor_acceleration
    )


def slipping_angular_acceleration(
    *,
    in_plane_drive_y: Array,
    roll_root: Array,
    friction_kinetic: Array,
    floor_acceleration: Array,
    diameter: Array,
) -> Array:
    """Return the angular acceleration of a cylinder about its axis, 4 q D_y/((z+3q) d) [rad s-2].

    z is `roll_root` and q = mu_k n; where it rolls (z = 0) it is 4 D_y/(3 d), in flight 0.
    """
    q = friction_kinetic * floor_acceleration
    e_y = ratio(in_plane_drive_y, roll_root + 3 * q, 0.0)
    return 4 * np.where(roll_root == 0, in_plane_drive_y / 3, q * e_y) / diameter


# --- Round parts on a vibrating floor, in the mean over a period (theory 18.2).
#
# Numbers as of motion in time: accelerations over g, velocities over g/w. The slip of a round part,
# s = u - r w, obeys
#
#     s' = D + (1 + kap) f,   |f| <= mu n,        u' = (s' + kap D)/(1 + kap)
#
# While the slip stays bounded its mean change is 0, so that the mean of u' is kap/(1 + kap) times
# that of D, whatever the drive, friction and rebounds: friction conveys no ball. On a slope that is
# steeper than (1 + kap) mu the slip runs away, and the mean of u' is that of D + mu n. Rolling
# resistance c (a couple c r n against the turning) conveys: in pure rolling
# u' = kap/(1 + kap) (D - c n sgn(u)), a block of friction c.


class RollingContact(NamedTuple):
    """The contact of a round part with floor and wall; all fields broadcast.

    Attributes
    ----------
    share, factor : ndarray
        kap/(1 + kap) and kap = m r^2/I [1].
    static, kinetic : ndarray
        Static and kinetic friction coefficients of the floor.
    restitution : ndarray
        Restitution of impacts on the floor.
    resistance : ndarray
        Coefficient of rolling resistance.
    drag : ndarray
        Friction force of the wall on the face, over the weight [1].
    load : ndarray
        Mean load on the floor, over the weight [1].
    uphill : ndarray
        Gravity against the direction of travel, over gravity: sin(gamma) [1].
    along, normal : ndarray
        Peak acceleration of the drive along the track and normal to it, over gravity [1].
    """

    share: Array
    factor: Array
    static: Array
    kinetic: Array
    restitution: Array
    resistance: Array
    drag: Array
    load: Array
    uphill: Array
    along: Array
    normal: Array

    @property
    def pull(self) -> Array:
        """Size of gravity along the track, over gravity [1]."""
        return np.abs(self.uphill)

    @property
    def resisting(self) -> Array:
        """Mean force that keeps the part from running down, over its weight [1].

        Rolling resistance, or the floor's friction if that is less: the part then slides.
        """
        resisting: Array = np.minimum(self.resistance, self.static) * self.load + self.drag
        return resisting

    @property
    def free(self) -> Mask:
        """True where nothing resists the motion in the mean."""
        return np.asarray(self.resisting == 0)

    @property
    def runs_away(self) -> Mask:
        """True where gravity is more than what resists the motion, rolling or slipping."""
        return np.asarray(self.pull > self.resisting)

    @property
    def rolling_down(self) -> Array:
        """Mean acceleration downhill while the slip stays bounded, over gravity [1].

        kap/(1 + kap) (|sin(gamma)| - c n - w), with the load n and the wall's friction w; 0 where
        rolling resistance and wall hold the part.
        """
        excess = self.pull - self.resistance * self.load - self.drag
        return np.asarray(self.share * np.maximum(excess, 0.0))

    @property
    def slipping_down(self) -> Array:
        """Mean acceleration downhill once the slip runs away, over gravity [1].

        |sin(gamma)| - mu_k n - w, with the load n and the wall's friction w; 0 where kinetic
        friction would stop the part.
        """
        excess = self.pull - self.kinetic * self.load - self.drag
        return np.asarray(np.maximum(excess, 0.0))

    @property
    def unbounded_slip(self) -> Mask:
        """True where gravity is more than static friction can turn into rolling.

        |sin(gamma)| > ((1 + kap) mu_s - kap c) n + w, for c up to mu_s. With a larger c the part
        does not turn.
        """
        rolling_friction = self.factor * np.maximum(self.static - self.resistance, 0.0)
        return np.asarray(self.pull > (self.static + rolling_friction) * self.load + self.drag)

    @property
    def lifts(self) -> Mask:
        """True where the part leaves the floor."""
        return np.asarray(np.abs(self.normal) > self.load)

    @property
    def traction(self) -> tuple[Array, Array]:
        """Bounds of the friction that rolling takes: the largest in a period, at least and at most.

        Friction over load times (1 + kap). Where (1 + kap) mu_s reaches the second the part always
        rolls; where (1 + kap) times the larger of mu_s and c is below the first it slips at times.
        The quotient (D -+ w +- kap c n)/n grows or falls steadily with the sine of the drive, so
        that its ends count. Infinite where the part leaves the floor.
        """
        least, most = np.zeros(()), np.zeros(())
        for sign in (1.0, -1.0):  # at the peak of the drive, and opposite
            push, load = sign * self.along - self.uphill, self.load - sign * self.normal
            safe_load = np.where(load > 0, load, 1.0)
            resistance_share = self.factor * self.resistance + self.drag / safe_load
            push_over_load = np.abs(push) / safe_load
            least = np.maximum(least, np.where(load > 0, push_over_load - resistance_share, np.inf))
            most = np.maximum(most, np.where(load > 0, push_over_load + resistance_share, np.inf))
        return least, most

    @property
    def surely_rolls(self) -> Mask:
        """True where the floor has the friction to roll at every instant of any motion."""
        return np.asarray(self.traction[1] <= (1 + self.factor) * self.static)

    @property
    def surely_slips(self) -> Mask:
        """True where it has too little at some instant of any motion."""
        available = (1 + self.factor) * np.maximum(self.static, self.resistance)
        return np.asarray(self.lifts | (self.traction[0] > available))
