"""Screws as a whole (theory 1.6): twists, wrenches, momentum, and the dual Euler equation.

What chapter 2 of the source derives; scenes are checked by it. A screw is two vectors as one dual
number, real + e dual with e^2 = 0, about a reference point. Matrices are active: they turn a
vector, components in the same axes before and after.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, cosine, sine
from vibrafeed.core.mechanics.screws import ScrewReduction, dot, reduce_screw

Screw = TypeVar("Screw", bound="DualVector")


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
    """Return the matrix R_z R_y R_x that turns body components into reference components, (2.1)."""
    return rotation_z(about_z) @ rotation_y(about_y) @ rotation_x(about_x)


def turned(matrix: Array, vector: Array) -> Array:
    """Return the matrix times the vector, for arrays of both, shape (..., 3)."""
    return np.einsum("...ij,...j->...i", matrix, vector)


def _about_axis(axis: int, angle: Array) -> Array:
    cross = np.cross(np.eye(3)[axis], -np.eye(3))  # v -> axis x v
    along = np.outer(np.eye(3)[axis], np.eye(3)[axis])
    c, s = (np.asarray(part)[..., None, None] for part in (cosine(angle), sine(angle)))
    return c * (np.eye(3) - along) + s * cross + along


@dataclass(frozen=True, eq=False)
class DualVector:
    """Two vectors as one number, about a reference point."""

    real: Array
    dual: Array

    def __add__(self: Screw, other: Screw) -> Screw:
        return type(self)(self.real + other.real, self.dual + other.dual)

    def dot(self, other: DualVector) -> tuple[Array, Array]:
        """Return real part and dual part, the mutual moment, of the scalar product."""
        mutual = dot(self.real, other.dual) + dot(self.dual, other.real)
        return dot(self.real, other.real), mutual

    def cross(self, other: DualVector) -> DualVector:
        """Return the product s1 x s2 + e (s1 x s2o - s2 x s1o): (2.13) lacks the last cross."""
        dual = np.cross(self.real, other.dual) - np.cross(other.real, self.dual)
        return DualVector(np.cross(self.real, other.real), dual)

    def moved_to(self: Screw, point: Array) -> Screw:
        """Return the same screw about another point; `point` leads there from the present one."""
        return type(self)(self.real, self.dual + np.cross(self.real, point))

    def rotated(self: Screw, matrix: Array) -> Screw:
        """Return the screw turned by an active rotation about the reference point."""
        return type(self)(turned(matrix, self.real), turned(matrix, self.dual))

    def reduced(self) -> ScrewReduction:
        """Return pitch and axis."""
        return reduce_screw(self.real, self.dual)


class Twist(DualVector):
    """Angular velocity w [rad s-1], and velocity v_P of the body's point P [m s-1]."""


class Wrench(DualVector):
    """Resultant of a force system [N], and its moment about P [N m]."""


class MomentumScrew(DualVector):
    """Momentum of a rigid body [kg m s-1], and moment of momentum about its point A [kg m2 s-1]."""


def force_at(*, point: Array, force: Array) -> Wrench:
    """Return the wrench of a force that acts at a point given from the reference point."""
    return Wrench(force, np.cross(point, force))


def power(wrench: Wrench, twist: Twist) -> Array:
    """Return the power of a wrench on a twist about the same point [W]."""
    return wrench.dot(twist)[1]


def inertia_about(*, mass: Array, central_inertia: Array, offset: Array) -> Array:
    """Return the inertia about a point of the body, from that about the mass centre (Steiner)."""
    square = dot(offset, offset)[..., None, None] * np.eye(3)
    steiner = square - offset[..., :, None] * offset[..., None, :]
    return central_inertia + np.asarray(mass)[..., None, None] * steiner


def momentum_screw(
    *, mass: Array, inertia: Array, mass_centre: Array, twist: Twist
) -> MomentumScrew:
    """Return momentum q = m (V_A + w x AG) and moment H_A = I_A w + m AG x V_A of a body, (2.11).

    A is any point of the body, `mass_centre` AG leads from A to the mass centre G.
    """
    m = np.asarray(mass)[..., None]
    linear = m * (twist.dual + np.cross(twist.real, mass_centre))
    angular = turned(inertia, twist.real) + m * np.cross(mass_centre, twist.dual)
    return MomentumScrew(linear, angular)


def dual_euler(*, momentum: MomentumScrew, momentum_rate: MomentumScrew, twist: Twist) -> Wrench:
    """Return the wrench about the body's point A that a motion needs, (2.14).

    F = q' + w x q and M_A = H_A' + w x H_A + V_A x q, in axes that turn with w.
    """
    turning = twist.cross(momentum)
    return Wrench(momentum_rate.real + turning.real, momentum_rate.dual + turning.dual)


def newton_euler(*, mass: Array, central_inertia: Array, twist: Twist, twist_rate: Twist) -> Wrench:
    """Return the force and moment about the mass centre that a motion of a rigid body needs, (2.2).

    m (v' + w x v) and J w' + w x J w, in body components.
    """
    acceleration = twist_rate.dual + np.cross(twist.real, twist.dual)
    spin = turned(central_inertia, twist.real)
    moment = turned(central_inertia, twist_rate.real) + np.cross(twist.real, spin)
    return Wrench(np.asarray(mass)[..., None] * acceleration, moment)
