"""Wrenches as screws, and a cylinder that rolls and yaws on a level plane (theory 1.6, 9).

A screw is a resultant and a moment about a point. Sources disagree on which half comes first, so
halves have names. Halves are arrays of shape (..., 3) that broadcast against each other. A type
does not know its reference point and axes: whoever combines two answers for that.

Axes: n upwards (the source's E1), eta in rolling direction (E2), sigma along the axis (E3). Angles
are counted from sigma towards eta, as the source does; theory 9.2 says what that means in the axes
of the track. Pure rolling about mid-length, with angular velocity theta' n + phi' sigma and the
centre's velocity r phi' eta. SI units, angles in radians; wrenches are about the centre, in the
axes n, eta, sigma.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, hypot, ratio, sine
from vibrafeed.core.mechanics.rolling import is_rolling

# --- Rotations of rigid bodies as plain arrays (theory 1.1; (2.1) of the source).
#
# Plain arrays of shape (..., 3, 3) are the one representation of a rotation here, not
# ``scipy.spatial.transform.Rotation``: closed forms need three elementary matrices and their
# products, a grid of angles broadcasts by itself, and scipy would be a dependency for this alone.
# There are no quaternions.
#
# All matrices are active: they turn a vector, components in the same axes before and after. Where
# the source uses a passive matrix the transpose is written out.


def rotation_x(angle: Array) -> Array:
    """Return the matrix of the active rotation about x, shape (..., 3, 3)."""
    return _about_axis(0, angle)


def rotation_y(angle: Array) -> Array:
    """Return the matrix of the active rotation about y, shape (..., 3, 3)."""
    return _about_axis(1, angle)


def rotation_z(angle: Array) -> Array:
    """Return the matrix of the active rotation about z, shape (..., 3, 3)."""
    return _about_axis(2, angle)


def body_to_reference(*, about_x: Array, about_y: Array, about_z: Array) -> Array:
    """Return the matrix R_z R_y R_x that turns body components into reference components, (2.1).

    The angles are the source's Cardan angles alpha, beta, gamma; they are not those of the drive
    and of the track.
    """
    return rotation_z(about_z) @ rotation_y(about_y) @ rotation_x(about_x)


def turned(matrix: Array, vector: Array) -> Array:
    """Return the matrix times the vector, for arrays of both, shape (..., 3)."""
    return np.einsum("...ij,...j->...i", matrix, vector)


def _about_axis(axis: int, angle: Array) -> Array:
    """Return the matrix that turns vectors by an angle about an axis, shape (..., 3, 3).

    `axis` is 0, 1 or 2 for x, y or z, `angle` in rad, of any shape; an active rotation.
    """
    angle = np.asarray(angle, dtype=np.float64)
    c, s = cosine(angle), sine(angle)
    following, last = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.zeros((*angle.shape, 3, 3))
    matrix[..., axis, axis] = 1.0
    matrix[..., following, following] = c
    matrix[..., last, last] = c
    matrix[..., following, last] = -s
    matrix[..., last, following] = s
    return matrix


def vector(first: Array, second: Array, third: Array) -> Array:
    """Return the components as one array, on a new last axis."""
    return np.stack(np.broadcast_arrays(first, second, third), axis=-1)


def dot(a: Array, b: Array) -> Array:
    """Return the scalar product over the last axis."""
    return np.asarray(np.sum(a * b, axis=-1))


def cross(a: Array, b: Array) -> Array:
    """Return the vector product over the last axis."""
    return np.cross(a, b)


@dataclass(frozen=True, eq=False)
class DualVector:
    """Two vectors as one number s + e s0 with e^2 = 0.

    Attributes
    ----------
    real, dual : ndarray
        The halves s and s0.
    """

    real: Array
    dual: Array

    def __add__(self, other: DualVector) -> DualVector:
        return DualVector(self.real + other.real, self.dual + other.dual)

    def __sub__(self, other: DualVector) -> DualVector:
        return DualVector(self.real - other.real, self.dual - other.dual)

    def dot(self, other: DualVector) -> tuple[Array, Array]:
        """Return real and dual part of the scalar product with another screw about the same point.

        The dual part, s1.s2o + s1o.s2, is the mutual moment.
        """
        mutual = dot(self.real, other.dual) + dot(self.dual, other.real)
        return dot(self.real, other.real), mutual

    def cross(self, other: DualVector) -> DualVector:
        """Return the screw cross product s1 x s2 + e (s1 x s2o - s2 x s1o).

        (2.13) prints the last term without the cross.
        """
        dual = cross(self.real, other.dual) - cross(other.real, self.dual)
        return DualVector(cross(self.real, other.real), dual)

    def moved_to(self, point: Array) -> DualVector:
        """Return the same screw about another reference point.

        `point` leads from the present reference point to the new one [m], shape (..., 3).
        """
        return DualVector(self.real, _about(point, self.real, self.dual))

    def rotated(self, matrix: Array) -> DualVector:
        """Return the screw turned by an active rotation about the reference point."""
        return DualVector(turned(matrix, self.real), turned(matrix, self.dual))


@dataclass(frozen=True, eq=False)
class Twist:
    """Velocity of a rigid body.

    Attributes
    ----------
    angular, linear : ndarray
        Angular velocity w [rad s-1]; velocity v_P of the body's point P [m s-1].
    """

    angular: Array
    linear: Array

    def __add__(self, other: Twist) -> Twist:
        return Twist(self.angular + other.angular, self.linear + other.linear)

    def moved_to(self, point: Array) -> Twist:
        """Return the twist of another point Q of the body, v_Q = v_P + w x PQ.

        `point` is PQ, from the present point P to the new one [m], shape (..., 3).
        """
        return Twist(self.angular, _about(point, self.angular, self.linear))

    def rotated(self, matrix: Array) -> Twist:
        """Return the twist turned by an active rotation."""
        return Twist(turned(matrix, self.angular), turned(matrix, self.linear))

    def as_dual(self) -> DualVector:
        """Return w + e v_P."""
        return DualVector(self.angular, self.linear)

    def reduced(self) -> ScrewReduction:
        """Return pitch and axis of the motion; a translation has none."""
        return reduce_screw(self.angular, self.linear)


@dataclass(frozen=True, eq=False)
class Wrench:
    """Resultant of a force system.

    Attributes
    ----------
    force, moment : ndarray
        Resultant force f [N]; moment m_P about the reference point P [N m].
    """

    force: Array
    moment: Array

    def __add__(self, other: Wrench) -> Wrench:
        return Wrench(self.force + other.force, self.moment + other.moment)

    def moved_to(self, point: Array) -> Wrench:
        """Return the wrench about another point Q, m_Q = m_P + f x PQ.

        `point` is PQ, from the present point P to the new one [m], shape (..., 3).
        """
        return Wrench(self.force, _about(point, self.force, self.moment))

    def rotated(self, matrix: Array) -> Wrench:
        """Return the wrench turned by an active rotation."""
        return Wrench(turned(matrix, self.force), turned(matrix, self.moment))

    def as_dual(self) -> DualVector:
        """Return f + e m_P."""
        return DualVector(self.force, self.moment)

    def reduced(self) -> ScrewReduction:
        """Return pitch and axis, (4.1) to (4.7); a pure couple has none."""
        return reduce_screw(self.force, self.moment)


@dataclass(frozen=True, eq=False)
class MomentumScrew:
    """Momentum of a rigid body.

    Attributes
    ----------
    linear, angular : ndarray
        Momentum q [kg m s-1]; moment of momentum H_A about the body's point A [kg m2 s-1].
    """

    linear: Array
    angular: Array

    def moved_to(self, point: Array) -> MomentumScrew:
        """Return the momentum about another point; `point` leads to it from the present one [m]."""
        return MomentumScrew(self.linear, _about(point, self.linear, self.angular))

    def rotated(self, matrix: Array) -> MomentumScrew:
        """Return the momentum turned by an active rotation."""
        return MomentumScrew(turned(matrix, self.linear), turned(matrix, self.angular))

    def as_dual(self) -> DualVector:
        """Return q + e H_A."""
        return DualVector(self.linear, self.angular)


def force_at(*, point: Array, force: Array) -> Wrench:
    """Return the wrench of a force that acts at a point given from the reference point."""
    return Wrench(force, cross(point, force))


def power(wrench: Wrench, twist: Twist) -> Array:
    """Return the power of a wrench on a twist about the same point [W]."""
    return dot(wrench.moment, twist.angular) + dot(wrench.force, twist.linear)


class ScrewKind(IntEnum):
    """The kinds of a reduced screw: by what is left of it."""

    GENERAL = 0  # a resultant along an axis, and a moment along it
    PURE_COUPLE = 1  # no resultant: a couple, or a translation
    ZERO = 2  # nothing at all


@dataclass(frozen=True, eq=False)
class ScrewReduction:
    """A screw as pitch and axis: moment = axis_point x resultant + pitch resultant.

    Attributes
    ----------
    pitch : ndarray
        Moment along the axis over the resultant [m]; NaN where there is no axis.
    axis_point : ndarray
        From the reference point to the nearest point of the axis [m]; NaN where there is none.
    kind : ndarray of int8
        `ScrewKind` of each element.
    """

    pitch: Array
    axis_point: Array
    kind: NDArray[np.int8]


def reduce_screw(resultant: Array, moment: Array) -> ScrewReduction:
    """Return pitch S.S0/S^2 and axis S x S0/S^2 of a screw, (2.9), (4.1).

    `resultant` is S, `moment` is S0 about the reference point, shape (..., 3). Both halves are
    scaled by powers of two first, so that no square leaves the range of floats; a result beyond
    that range is infinite. The source prints the axis of a wrench with the opposite sign, (4.3),
    (4.5), (4.6): the vector from the axis to the point, which contradicts (2.9) and does not give
    back M in (4.7).
    """
    F, M = np.broadcast_arrays(
        np.asarray(resultant, dtype=np.float64), np.asarray(moment, dtype=np.float64)
    )
    f, f_exponent = _scaled(F)
    m, m_exponent = _scaled(M)
    has_force = np.any(F != 0, axis=-1)
    has_moment = np.any(M != 0, axis=-1)
    square = np.where(has_force, dot(f, f), 1.0)
    back = m_exponent - f_exponent
    with np.errstate(over="ignore", under="ignore"):
        pitch = np.ldexp(dot(f, m) / square, back)
        axis = np.ldexp(cross(f, m) / square[..., None], back[..., None])
    kind = np.where(
        has_force,
        ScrewKind.GENERAL,
        np.where(has_moment, ScrewKind.PURE_COUPLE, ScrewKind.ZERO),
    ).astype(np.int8)
    return ScrewReduction(
        np.where(has_force, pitch, np.nan), np.where(has_force[..., None], axis, np.nan), kind
    )


def inertia_about(*, mass: Array, central_inertia: Array, offset: Array) -> Array:
    """Return the inertia about a point of the body, from that about the mass centre [kg m2].

    `central_inertia` has the shape (..., 3, 3); `offset` leads from that point to the mass centre,
    or back [m] (Steiner).
    """
    square = dot(offset, offset)[..., None, None] * np.eye(3)
    steiner = square - offset[..., :, None] * offset[..., None, :]
    return central_inertia + np.asarray(mass)[..., None, None] * steiner


def momentum_screw(
    *, mass: Array, inertia: Array, mass_centre: Array, twist: Twist
) -> MomentumScrew:
    """Return momentum q = m (V_A + w x AG) and moment H_A = I_A w + m AG x V_A of a body, (2.11).

    A is any point of the body, with the velocity V_A; `inertia` I_A is about A, `mass_centre` AG
    leads from A to the mass centre G, all in body components. w and V_A are `twist`.
    """
    m = np.asarray(mass)[..., None]
    linear = m * (twist.linear + cross(twist.angular, mass_centre))
    angular = turned(inertia, twist.angular) + m * cross(mass_centre, twist.linear)
    return MomentumScrew(linear, angular)


def dual_euler(*, momentum: MomentumScrew, momentum_rate: MomentumScrew, twist: Twist) -> Wrench:
    """Return the wrench about the body's point A that a motion needs, (2.14).

    F = q' + w x q and M_A = H_A' + w x H_A + V_A x q: q and H_A are momentum and moment of
    momentum, w and V_A angular velocity and velocity of A. Components are those of axes that turn
    with w; `momentum_rate` holds their derivatives. A is any point that moves with these axes,
    accelerating or not.
    """
    required = momentum_rate.as_dual() + twist.as_dual().cross(momentum.as_dual())
    return Wrench(required.real, required.dual)


def newton_euler(
    *,
    mass: Array,
    central_inertia: Array,
    twist: Twist,
    twist_rate: Twist,
) -> Wrench:
    """Return the force and moment about the mass centre that a motion of a rigid body needs, (2.2).

    Newton's and Euler's laws in body components: m (v' + omega x v) and J omega' + omega x J omega.
    `mass` is in kg, `central_inertia` the matrix J about the mass centre, shape (..., 3, 3) [kg
    m2]; `twist` holds the angular velocity omega and the velocity v of the mass centre, and
    `twist_rate` the derivatives of these components.
    """
    acceleration = twist_rate.linear + cross(twist.angular, twist.linear)
    spin = turned(central_inertia, twist.angular)
    moment = turned(central_inertia, twist_rate.angular) + cross(twist.angular, spin)
    return Wrench(np.asarray(mass)[..., None] * acceleration, moment)


def _about(point: Array, resultant: Array, moment: Array) -> Array:
    return moment + cross(resultant, point)


def _scaled(half: Array) -> tuple[Array, NDArray[np.intc]]:
    """Return vectors scaled so that their largest component is in [1/2, 1), and the exponents."""
    _, exponent = np.frexp(np.max(np.abs(half), axis=-1))
    return np.ldexp(half, -exponent[..., None]), exponent


def level_gravity(*, gravity: Array) -> Array:
    """Return gravity onto a level floor, g [m s-2]."""
    return gravity


def rolling_drive(
    *, vibration_acceleration: Array, alpha: Array, beta: Array, axis_yaw: Array
) -> Array:
    """Return the drive at its peak along eta, D_eta = P cos(beta) sin(alpha + theta) [m s-2]."""
    return vibration_acceleration * cosine(beta) * sine(alpha + axis_yaw)


def axial_drive(
    *, vibration_acceleration: Array, alpha: Array, beta: Array, axis_yaw: Array
) -> Array:
    """Return the drive's peak along sigma, D_sigma = P cos(beta) cos(alpha + theta) [m s-2].

    sigma is the direction of the cylinder's axis, at the yaw theta (`axis_yaw`).
    """
    return vibration_acceleration * cosine(beta) * cosine(alpha + axis_yaw)


def axial_friction_acceleration(
    *, axial_drive: Array, diameter: Array, spin_rate: Array, yaw_rate: Array
) -> Array:
    """Return the friction per mass along the axis, D_sigma - r phi' theta', (4.16) [m s-2].

    D_sigma is the drive along the axis, r the radius, phi' the spin rate and theta' the yaw rate.
    """
    return axial_drive - diameter / 2 * spin_rate * yaw_rate


def rolling_friction(*, mass: Array, rolling_drive: Array) -> Array:
    """Return the friction force that rolls the cylinder, m D_eta/3, (4.15) [N]."""
    return mass * rolling_drive / 3


def axial_friction(*, mass: Array, axial_friction_acceleration: Array) -> Array:
    """Return the friction force along the axis, m (D_sigma - r phi' theta'), (4.16) [N]."""
    return mass * axial_friction_acceleration


def spin_acceleration(*, rolling_drive: Array, diameter: Array) -> Array:
    """Return the spin acceleration, phi'' = 4 D_eta/(3 d), (4.19) [rad s-2]."""
    return 4 * rolling_drive / (3 * diameter)


def yaw_acceleration(
    *, mass: Array, diameter: Array, length: Array, drilling_moment: Array
) -> Array:
    """Return the yaw acceleration, M_z/I1 with I1 = m (3 r^2 + L^2)/12; 0 in (4.18) [rad s-2].

    M_z is the drilling moment of the floor, r and L radius and length.
    """
    return 12 * drilling_moment / (mass * (0.75 * np.square(diameter) + np.square(length)))


def printed_yaw_rate(*, axial_drive: Array, diameter: Array, spin_rate: Array) -> Array:
    """Return the yaw rate as printed, theta' = 4 D_sigma/(3 d phi'), (4.20) [rad s-1].

    D_sigma is the drive along the axis, phi' the spin rate. It follows only if the floor's
    resultant is held at mid-length. Without spin it has no value, as at every start from rest, and
    its time derivative contradicts (4.18).
    """
    with np.errstate(over="ignore"):
        return ratio(4 * axial_drive, 3 * diameter * spin_rate, np.nan)


def pressure_offset_axial(
    *,
    axial_drive: Array,
    diameter: Array,
    spin_rate: Array,
    yaw_rate: Array,
    normal_acceleration: Array,
) -> Array:
    """Return the shift of the floor's normal force, r (D_sigma - (3/2) r phi' theta')/n0 [m].

    D_sigma is the drive along the axis, r the radius, phi' the spin rate, theta' the yaw rate, n0
    the normal force per mass. Friction along the axis tilts the cylinder and the yaw of its spin
    resists; the floor balances both. The source leaves it out. NaN in flight.
    """
    tilting = axial_drive - 0.75 * diameter * spin_rate * yaw_rate
    return diameter / 2 * _over_normal(tilting, normal_acceleration, np.nan)


def required_friction(
    *, rolling_drive: Array, axial_friction_acceleration: Array, normal_acceleration: Array
) -> Array:
    """Return the least static friction with which the cylinder rolls, hypot(F_eta, F_sigma)/N [1].

    F_eta and F_sigma are the friction forces in rolling direction and along the axis, N the floor's
    force; infinite in flight.
    """
    friction = hypot(rolling_drive / 3, axial_friction_acceleration)
    return _over_normal(friction, normal_acceleration, np.inf)


def cone_margin(
    *,
    mass: Array,
    friction_static: Array,
    rolling_drive: Array,
    axial_friction_acceleration: Array,
    normal_acceleration: Array,
) -> Array:
    """Return the margin of static friction, mu_s N - hypot(F_eta, F_sigma) [N].

    F_eta and F_sigma are the friction forces in rolling direction and along the axis, N the floor's
    force; below 0 the cylinder slips.
    """
    friction = hypot(rolling_drive / 3, axial_friction_acceleration)
    return mass * (friction_static * normal_acceleration - friction)


def floor_wrench(
    *,
    mass: Array,
    diameter: Array,
    spin_rate: Array,
    yaw_rate: Array,
    drilling_moment: Array,
    rolling_friction: Array,
    axial_friction: Array,
    floor_force: Array,
) -> Wrench:
    """Return the wrench of the floor about the centre, in the axes n, eta, sigma [N, N m].

    The force is (N, -F_eta, -F_sigma): floor force N, friction F_eta in rolling direction and
    F_sigma along the axis. The moment is (M_z, -I3 theta' phi', r F_eta): drilling moment M_z, then
    what turns the spin phi' with the yaw rate theta', I3 = m r^2/2.
    """
    force = vector(floor_force, -rolling_friction, -axial_friction)
    precession = _turning_of_spin(mass, diameter, spin_rate, yaw_rate)
    return Wrench(force, vector(drilling_moment, precession, diameter / 2 * rolling_friction))


def force_wrench(
    *,
    mass: Array,
    diameter: Array,
    spin_rate: Array,
    yaw_rate: Array,
    drilling_moment: Array,
    rolling_drive: Array,
    rolling_friction: Array,
) -> Wrench:
    """Return the wrench of drive, gravity and floor together about the centre, (4.12), (4.13).

    Of a cylinder that rolls and yaws on a level floor. In the axes n, eta, sigma [N, N m]; drive
    and gravity act at the centre. What (4.15) to (4.17) cancel is left out instead of subtracted:
    along n nothing remains, along sigma m r phi' theta', with spin rate phi' and yaw rate theta'.
    """
    turning = mass * (diameter / 2) * spin_rate * yaw_rate
    force = vector(np.zeros(()), mass * rolling_drive * (2 / 3), turning)
    precession = _turning_of_spin(mass, diameter, spin_rate, yaw_rate)
    return Wrench(force, vector(drilling_moment, precession, diameter / 2 * rolling_friction))


def floor_reduction(*, floor_wrench: Wrench) -> ScrewReduction:
    """Return pitch F.M/F^2 and axis F x M/F^2 of the floor's wrench, force F and moment M."""
    return floor_wrench.reduced()


def force_reduction(*, force_wrench: Wrench) -> ScrewReduction:
    """Return pitch F.M/F^2 and axis F x M/F^2 of all forces' wrench, force F and moment M."""
    return force_wrench.reduced()


def printed_floor_reduction(*, floor_wrench: Wrench) -> ScrewReduction:
    """Return pitch and axis of the floor's wrench with the sign of (4.3), (4.5), (4.6)."""
    return _as_printed(floor_wrench.reduced())


def printed_force_reduction(*, force_wrench: Wrench) -> ScrewReduction:
    """Return pitch and axis of the force system with the sign of (4.3), (4.5), (4.6)."""
    return _as_printed(force_wrench.reduced())


def tips_along_axis(*, pressure_offset_axial: Array, length: Array) -> Mask:
    """True where the floor's normal force would leave the cylinder: |e| > L/2, it tips."""
    return np.abs(pressure_offset_axial) > length / 2


def slips(
    *,
    rolling_drive: Array,
    axial_friction_acceleration: Array,
    friction_static: Array,
    normal_acceleration: Array,
) -> Mask:
    """True where a rolling and yawing cylinder needs more friction than there is.

    hypot(F_eta, F_sigma) > mu_s N, with the friction forces in rolling direction (`rolling_drive`,
    of which a solid cylinder needs a third) and along the axis, and the floor's force N, all per
    mass [m s-2].
    """
    return ~is_rolling(
        in_plane_drive_x=axial_friction_acceleration,
        in_plane_drive_y=rolling_drive,
        friction_static=friction_static,
        floor_acceleration=normal_acceleration,
    )


def has_no_printed_yaw_rate(*, printed_yaw_rate: Array) -> Mask:
    """True where (4.20) has no value: without spin, or too little for a float."""
    return ~np.isfinite(printed_yaw_rate)


def has_no_force_axis(*, force_reduction: ScrewReduction) -> Mask:
    """True where the force system has no axis: it is a pure couple, or nothing."""
    return np.asarray(force_reduction.kind != ScrewKind.GENERAL)


def _over_normal(value: Array, normal_acceleration: Array, otherwise: float) -> Array:
    """Return value/n0, and `otherwise` in flight."""
    pressed = normal_acceleration > 0
    return np.where(pressed, value / np.where(pressed, normal_acceleration, 1.0), otherwise)


def _turning_of_spin(mass: Array, diameter: Array, spin_rate: Array, yaw_rate: Array) -> Array:
    """Return the moment about eta that turns the spin, -I3 theta' phi', I3 = m r^2/2 [N m].

    phi' is the spin rate, theta' the yaw rate.
    """
    return -mass * np.square(diameter) / 8 * spin_rate * yaw_rate


def _as_printed(reduction: ScrewReduction) -> ScrewReduction:
    """Return a screw's pitch and axis with the sign of the axis as printed."""
    return ScrewReduction(reduction.pitch, -reduction.axis_point, reduction.kind)
