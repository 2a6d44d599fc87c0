"""The shape of a cylinder, and how far a direction separates two of them (theory 8.2)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics import vectors
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.mechanics.vectors import Vector, across, dot, norm


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
    between = dot(n, vectors.minus(body.centre, other.centre))
    return between - support(body, n) - support(other, n)
