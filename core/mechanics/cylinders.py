"""The shape of a cylinder, and how far a direction separates two of them (theory 8.2)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask

# --- Vectors in space as three arrays, so that each component broadcasts on its own grid.

Vector = tuple[Array, Array, Array]
"""Components along x, y, z."""


def dot(a: Vector, b: Vector) -> Array:
    """Return the scalar product a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product a x b of two vectors, each a tuple of three arrays."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def norm(a: Vector) -> Array:
    """Return the length |a| of a vector."""
    return np.sqrt(dot(a, a))


def scaled(a: Vector, by: Array | float) -> Vector:
    """Return a vector times a number."""
    return a[0] * by, a[1] * by, a[2] * by


def plus(a: Vector, b: Vector, by: Array | float = 1.0) -> Vector:
    """Return the sum a + by b."""
    return a[0] + by * b[0], a[1] + by * b[1], a[2] + by * b[2]


def minus(a: Vector, b: Vector) -> Vector:
    """Return the difference a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def across(a: Vector, axis: Vector) -> Vector:
    """Return the component of a vector that is normal to a unit axis."""
    return plus(a, axis, -dot(a, axis))


def where(condition: Mask, a: Vector, b: Vector) -> Vector:
    """Return a vector: a where the condition holds, else b."""
    return tuple(np.where(condition, x, y) for x, y in zip(a, b, strict=True))  # type: ignore[return-value]


def direction(a: Vector, otherwise: Vector) -> Vector:
    """Return the unit vector a/|a|; `otherwise` where a is 0."""
    length = norm(a)
    some = length > 0
    return where(some, scaled(a, 1 / np.where(some, length, 1.0)), otherwise)


def any_across(axis: Vector) -> Vector:
    """Return some unit vector at right angles to a unit `axis`, both tuples of three arrays.

    For a base of the plane across the axis, where any will do.
    """
    z = axis[2]
    flat = np.abs(z) > 0.5
    zero = np.zeros_like(z)
    e = where(flat, (np.ones_like(z), zero, zero), (zero, zero, np.ones_like(z)))
    return direction(across(e, axis), e)


# --- The shape of a cylinder, and how far a direction separates two of them (theory 8.2).


class Cylinder(NamedTuple):
    """Centre, unit axis, radius and half length."""

    centre: Vector
    axis: Vector
    radius: Array
    half: Array


def support(body: Cylinder, n: Vector) -> Array:
    """Return the extent of a cylinder from its centre in the direction n [m]."""
    return body.half * np.abs(dot(n, body.axis)) + body.radius * norm(across(n, body.axis))


def separation(body: Cylinder, other: Cylinder, n: Vector) -> Array:
    """Return the distance between two cylinders along the unit vector n; negative in overlap [m].

    n points from `other` to `body`: n.(C - C') less what both bodies extend from their centres
    along n.
    """
    between = dot(n, minus(body.centre, other.centre))
    return between - support(body, n) - support(other, n)
