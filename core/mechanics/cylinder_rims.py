"""The point of a cylinder's rim that is nearest to another cylinder (theory 8.2)."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics import vectors
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.mechanics.cylinders import Cylinder, separation
from vibrafeed.core.mechanics.rectangle_contact import ALIKE
from vibrafeed.core.mechanics.vectors import Vector, across, cross, dot, norm, plus, scaled

SAMPLES = 24  # of a rim: its distance from an axis has at most two minima, far apart or shallow
MAX_STEPS = 40  # bisection alone would need 50 to the last digit; Newton's steps need about 5
NEAR = 1e-6  # radian: of so short a step rounding may decide on which side of the bracket it ends


def minima(
    value: Callable[[Array], Array], slope_and_bend: Callable[[Array], tuple[Array, Array]]
) -> tuple[Array, Array]:
    """Return the angles of the two lowest minima of a function with the period 2 pi [rad].

    Points of a rim that may touch another body are such minima of a distance. `value` gives the
    function at an angle, `slope_and_bend` its first and second derivative, for arrays of cells;
    samples find the minima, Newton's method refines them. Where there is one minimum only, both
    angles are equal.
    """
    step = 2 * np.pi / SAMPLES
    values = [value(t) for t in step * np.arange(SAMPLES)]
    least = [np.full(np.shape(values[0]), np.inf) for _ in range(2)]
    angles = [np.zeros(np.shape(values[0])) for _ in range(2)]
    for number, here in enumerate(values):
        dip = (here <= values[number - 1]) & (here < values[(number + 1) % SAMPLES])
        best, next_best = dip & (here < least[0]), dip & (here < least[1])
        angles[1] = np.where(best, angles[0], np.where(next_best, number * step, angles[1]))
        least[1] = np.where(best, least[0], np.where(next_best, here, least[1]))
        angles[0] = np.where(best, number * step, angles[0])
        least[0] = np.where(best, here, least[0])
    angles[1] = np.where(np.isfinite(least[1]), angles[1], angles[0])
    return _refined(angles[0], step, slope_and_bend), _refined(angles[1], step, slope_and_bend)


def _refined(
    t: Array, reach: float, slope_and_bend: Callable[[Array], tuple[Array, Array]]
) -> Array:
    """Return the angle of a function's minimum near a sampled angle [rad].

    `t` is the sample, `reach` the distance to its neighbours [rad], `slope_and_bend` returns first
    and second derivative at an angle. Newton's steps stay in a bracket around the sample that
    shrinks with each step.
    """
    low, high = t - reach, t + reach
    done: Mask = np.zeros(np.shape(t), dtype=np.bool_)
    for _ in range(MAX_STEPS):
        slope, bend = slope_and_bend(t)
        low, high = np.where(slope < 0, t, low), np.where(slope > 0, t, high)
        newton = t - slope / np.where(bend > 0, bend, 1.0)
        inside = (newton > low) & (newton < high)
        inside = (bend > 0) & (inside | (np.abs(newton - t) <= NEAR))
        ahead = np.where(inside, newton, (low + high) / 2)
        # What is done stays: a cell must not depend on those that are computed beside it.
        ahead = np.where(done | (slope == 0), t, ahead)
        done = done | (np.abs(ahead - t) <= 1e-15 * (1 + np.abs(t)))
        t = ahead
        if np.all(done):
            break
    return t


class Rim(NamedTuple):
    """A rim of a body: its middle as seen from the centre of another body, and two radii."""

    middle: Vector
    first: Vector
    second: Vector

    def at(self, angle: Array) -> Vector:
        """Return the point of the rim at an angle [m]."""
        return plus(plus(self.middle, self.first, np.cos(angle)), self.second, np.sin(angle))

    def along(self, angle: Array) -> Vector:
        """Return the derivative of the rim's point by the angle [m rad-1]."""
        return plus(scaled(self.second, np.cos(angle)), self.first, -np.sin(angle))


def _way(point: Vector, base: Cylinder) -> Vector:
    """Return the vector from the nearest point of a cylinder `base` to a point [m].

    `point` is given relative to the centre of `base`; inside the cylinder the vector is 0.
    """
    height, off = dot(point, base.axis), across(point, base.axis)
    above = np.maximum(0.0, np.abs(height) - base.half) * np.where(height < 0, -1.0, 1.0)
    return plus(scaled(off, _free(norm(off), base.radius)), base.axis, above)


def _free(distance: Array, radius: Array) -> Array:
    """Return the share of a distance from an axis that lies beyond a radius; 0 inside [1]."""
    outside = distance > radius
    return np.where(outside, (distance - radius) / np.where(outside, distance, 1.0), 0.0)


def _slope_and_bend(rim: Rim, base: Cylinder, angle: Array) -> tuple[Array, Array]:
    """Return first and second derivative of d^2/2 by the angle of a point on a rim [m2].

    d is the distance of the rim's point at `angle` [rad] from the cylinder `base`; `rim` is given
    relative to the centre of `base`. A Newton iteration finds with them the point of the rim that
    is nearest to the cylinder.
    """
    point, along = rim.at(angle), rim.along(angle)
    way, off = _way(point, base), across(point, base.axis)
    climb, beside = dot(along, base.axis), across(along, base.axis)
    # What moves away from the axis counts in full, what goes round it by the share outside.
    free = _free(norm(off), base.radius)
    outward = dot(beside, vectors.direction(off, base.axis))
    bend = np.where(np.abs(dot(point, base.axis)) > base.half, climb * climb, 0.0)
    bend = (
        bend + np.where(free > 0, outward * outward * (1 - free), 0.0) + free * dot(beside, beside)
    )
    return dot(way, along), bend - dot(way, vectors.minus(point, rim.middle))


class Nearest(NamedTuple):
    """The point of one body on its rim that is nearest to another body.

    Attributes
    ----------
    gap : ndarray
        The distance.
    normal : three ndarrays
        Unit vector along it, towards the rim.
    point : three ndarrays
        The nearest point of the other body.
    proven : ndarray of bool
        Where the normal separates the bodies by the distance: they are apart, and nowhere nearer.
    """

    gap: Array
    normal: Vector
    point: Vector
    proven: Mask


def nearest_on_rims(body: Cylinder, base: Cylinder, size: Array) -> Nearest:
    """Return the gap between `base` and the nearest point on either rim of `body`, with normal.

    Where no face or side holds the contact of two cylinders. The gap is in m, the normal points
    from `base` to the rim, and `point` is the nearest point of `base`. `size` is the sum of both
    half diagonals [m], by which the tolerance scales. `proven` is False where the bodies overlap,
    or where no rim of `body` holds its nearest point.
    """
    first = vectors.any_across(body.axis)
    radii = scaled(first, body.radius), scaled(cross(body.axis, first), body.radius)
    candidates: list[Nearest] = []
    for sign in (-1.0, 1.0):
        middle = plus(vectors.minus(body.centre, base.centre), body.axis, sign * body.half)
        rim = Rim(middle, *radii)

        def squared(angle: Array, rim: Rim = rim) -> Array:
            """Return the squared distance of a rim point from the body."""
            way = _way(rim.at(angle), base)
            return dot(way, way)

        def derivatives(angle: Array, rim: Rim = rim) -> tuple[Array, Array]:
            """Return first and second derivative of half the squared distance by the rim angle."""
            return _slope_and_bend(rim, base, angle)

        for angle in minima(squared, derivatives):
            way = _way(rim.at(angle), base)
            gap = norm(way)
            n = vectors.direction(way, body.axis)
            proven = (gap > 0) & (np.abs(separation(body, base, n) - gap) <= ALIKE * size)
            point = plus(base.centre, vectors.minus(rim.at(angle), way))
            candidates.append(Nearest(gap, n, point, proven))
    best = candidates[0]
    for candidate in candidates[1:]:
        best = chosen(best.proven, best, candidate)
    return best


def chosen(mask: Mask, rim: Nearest, other: Nearest) -> Nearest:
    """Return the nearest point of a rim: that of `rim` where `mask` holds, else of `other`.

    All fields are arrays over the cells: gap [m], normal, point [m], and the mask `proven`.
    """
    return Nearest(
        np.where(mask, rim.gap, other.gap),
        vectors.where(mask, rim.normal, other.normal),
        vectors.where(mask, rim.point, other.point),
        np.where(mask, rim.proven, other.proven),
    )
