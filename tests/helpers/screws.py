"""Screws as a whole (theory 1.6): twists, wrenches, momentum, and the dual Euler equation.

What chapter 2 of the source derives; scenes are checked by it. A twist added to a wrench is
nonsense that six bare numbers allow, so kinds do not mix.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibrafeed.core.mechanics import screws
from vibrafeed.core.mechanics.arrays import Array, cosine, sine
from vibrafeed.core.mechanics.screws import ScrewReduction, dot, reduce_screw

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
        dual = np.cross(self.real, other.dual) - np.cross(other.real, self.dual)
        return DualVector(np.cross(self.real, other.real), dual)

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


class Wrench(screws.Wrench):
    """Resultant of a force system that can be added, moved and turned."""

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
    return Wrench(force, np.cross(point, force))


def power(wrench: Wrench, twist: Twist) -> Array:
    """Return the power of a wrench on a twist about the same point [W]."""
    return dot(wrench.moment, twist.angular) + dot(wrench.force, twist.linear)


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
    linear = m * (twist.linear + np.cross(twist.angular, mass_centre))
    angular = turned(inertia, twist.angular) + m * np.cross(mass_centre, twist.linear)
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
    acceleration = twist_rate.linear + np.cross(twist.angular, twist.linear)
    spin = turned(central_inertia, twist.angular)
    moment = turned(central_inertia, twist_rate.angular) + np.cross(twist.angular, spin)
    return Wrench(np.asarray(mass)[..., None] * acceleration, moment)


def _about(point: Array, resultant: Array, moment: Array) -> Array:
    return moment + np.cross(resultant, point)
