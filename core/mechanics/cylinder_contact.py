"""The contact of two cylinders in its five forms, each with a proof of its gap (theory 8.2).

A direction n separates two convex bodies by at least what their support functions say. A form gives
n and a point of each body; if the points lie along n and as far apart as n separates, the gap is
exact and no other form can have a larger one. In overlap such points prove that the bodies do
overlap, though not by how much at least. Only proven forms count. Where there is none, two rims may
be nearest, with a proof of the same kind; where that fails too, rims have entered each other.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.mechanics.rectangle_contact import ALIKE

# --- Vectors in space as three arrays, so that each component broadcasts on its own grid.

Vector = tuple[Array, Array, Array]
"""Components along x, y, z."""


def dot(a: Vector, b: Vector) -> Array:
    """Return the scalar product a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product a x b."""
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


def where(condition: Mask, a: Any, b: Any) -> Any:
    """Return a vector, or the fields of a record: a where the condition holds, else b."""
    return tuple(
        where(condition, x, y) if isinstance(x, tuple) else np.where(condition, x, y)
        for x, y in zip(a, b, strict=True)
    )


def direction(a: Vector, otherwise: Vector) -> Vector:
    """Return the unit vector a/|a|; `otherwise` where a is 0."""
    length = norm(a)
    some = length > 0
    return where(some, scaled(a, 1 / np.where(some, length, 1.0)), otherwise)


def any_across(axis: Vector) -> Vector:
    """Return some unit vector at right angles to a unit `axis`."""
    z = axis[2]
    flat = np.abs(z) > 0.5
    zero = np.zeros_like(z)
    e = where(flat, (np.ones_like(z), zero, zero), (zero, zero, np.ones_like(z)))
    return direction(across(e, axis), e)


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
    """Return the distance of two cylinders along n, from `other` to `body`; < 0 in overlap [m]."""
    between = dot(n, minus(body.centre, other.centre))
    return between - support(body, n) - support(other, n)


# --- The point of a cylinder's rim that is nearest to another cylinder (theory 8.2).

SAMPLES = 24  # of a rim: its distance from an axis has at most two minima, far apart or shallow
MAX_STEPS = 40  # bisection alone would need 50 to the last digit; Newton's steps need about 5
NEAR = 1e-6  # radian: of so short a step rounding may decide on which side of the bracket it ends


def minima(
    value: Callable[[Array], Array], slope_and_bend: Callable[[Array], tuple[Array, Array]]
) -> tuple[Array, Array]:
    """Return the angles of the two lowest minima of a function with the period 2 pi [rad].

    `slope_and_bend` gives its first and second derivative. Samples find the minima, Newton's method
    refines them. Where there is one minimum only, both angles are equal.
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
    height, off = dot(point, base.axis), across(point, base.axis)
    above = np.maximum(0.0, np.abs(height) - base.half) * np.where(height < 0, -1.0, 1.0)
    return plus(scaled(off, _free(norm(off), base.radius)), base.axis, above)


def _free(distance: Array, radius: Array) -> Array:
    outside = distance > radius
    return np.where(outside, (distance - radius) / np.where(outside, distance, 1.0), 0.0)


def _slope_and_bend(rim: Rim, base: Cylinder, angle: Array) -> tuple[Array, Array]:
    # First and second derivative of d^2/2 by the angle, d the distance of the rim's point.
    point, along = rim.at(angle), rim.along(angle)
    way, off = _way(point, base), across(point, base.axis)
    climb, beside = dot(along, base.axis), across(along, base.axis)
    # What moves away from the axis counts in full, what goes round it by the share outside.
    free = _free(norm(off), base.radius)
    outward = dot(beside, direction(off, base.axis))
    bend = np.where(np.abs(dot(point, base.axis)) > base.half, climb * climb, 0.0)
    bend = (
        bend + np.where(free > 0, outward * outward * (1 - free), 0.0) + free * dot(beside, beside)
    )
    return dot(way, along), bend - dot(way, minus(point, rim.middle))


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

    `size` is the sum of both half diagonals [m], by which the tolerance scales. `proven` is False
    where the bodies overlap, or where no rim of `body` holds its nearest point.
    """
    first = any_across(body.axis)
    radii = scaled(first, body.radius), scaled(cross(body.axis, first), body.radius)
    candidates: list[Nearest] = []
    for sign in (-1.0, 1.0):
        middle = plus(minus(body.centre, base.centre), body.axis, sign * body.half)
        rim = Rim(middle, *radii)

        def squared(angle: Array, rim: Rim = rim) -> Array:
            way = _way(rim.at(angle), base)
            return dot(way, way)

        def derivatives(angle: Array, rim: Rim = rim) -> tuple[Array, Array]:
            return _slope_and_bend(rim, base, angle)

        for angle in minima(squared, derivatives):
            way = _way(rim.at(angle), base)
            gap = norm(way)
            n = direction(way, body.axis)
            proven = (gap > 0) & (np.abs(separation(body, base, n) - gap) <= ALIKE * size)
            point = plus(base.centre, minus(rim.at(angle), way))
            candidates.append(Nearest(gap, n, point, proven))
    best = candidates[0]
    for candidate in candidates[1:]:
        best = Nearest(*where(best.proven, best, candidate))
    return best


# What `form` says.
NO_FORM, RIM_ON_FACE, RIM_ON_SIDE, FACE_ON_FACE, SIDE_ON_SIDE, SIDE_ON_FACE = range(6)


class CylinderContact(NamedTuple):
    """The place where two cylinders are nearest; lengths in m.

    Attributes
    ----------
    gap : ndarray
        Distance; negative in overlap, a lower bound of it where rims have entered each other.
    size : ndarray
        Sum of both half diagonals, to which tolerances are relative.
    form : ndarray
        0 none, 1 rim on face, 2 rim on side, 3 face on face, 4 side on side, 5 side on face.
    face_body : ndarray
        The body whose face or side is met, 1 or 2; 0 where it is both or none.
    normal : three ndarrays
        Unit normal, from body 2 to body 1.
    first, second : three ndarrays each
        Ends of a line of contact; the same point where a point touches.
    line : ndarray of bool
        Where a line touches.
    several : ndarray of bool
        Where a face lies on a face, the contact lies on a rim of both bodies, or no form is proven.
    """

    gap: Array
    size: Array
    form: Array
    face_body: Array
    normal: Vector
    first: Vector
    second: Vector
    line: Mask
    several: Mask


class _Form(NamedTuple):
    """One of the forms that a contact can have, with the fields of `CylinderContact`."""

    gap: Array
    form: Array
    body: Array
    normal: Vector
    first: Vector
    second: Vector
    line: Mask
    several: Mask
    proven: Mask


def _on_face(number: float, base: Cylinder, other: Cylinder, size: Array) -> _Form:
    u, apart = base.axis, minus(other.centre, base.centre)
    n = scaled(u, np.where(dot(u, apart) < 0, -1.0, 1.0))
    w = dot(n, other.axis)
    leaning = across(n, other.axis)
    down = direction(leaning, any_across(other.axis))
    gap = separation(other, base, n)
    flat = 2 * other.radius * norm(leaning) <= ALIKE * size
    line = ~flat & (2 * other.half * np.abs(w) <= ALIKE * size)
    bottom = plus(other.centre, down, -other.radius)
    rim = plus(bottom, other.axis, np.where(w > 0, -other.half, other.half))
    off = norm(across(minus(rim, base.centre), u))
    # The line of a side that lies on the face, as far as it crosses the disc.
    along = across(other.axis, u)
    along = direction(along, any_across(u))
    foot = across(minus(bottom, base.centre), u)
    ahead = dot(foot, along)
    beside = norm(plus(foot, along, -ahead))
    chord = np.sqrt(np.maximum(0.0, (base.radius - beside) * (base.radius + beside)))
    low = np.maximum(-ahead - chord, -other.half)
    high = np.minimum(-ahead + chord, other.half)
    # Faces: the discs meet if their centres are near enough.
    face_centre = across(apart, u)
    overlap = np.where(
        flat,
        base.radius + other.radius - norm(face_centre),
        np.where(line, np.where(beside <= base.radius, high - low, -size), base.radius - off),
    )
    return _Form(
        gap,
        np.where(flat, FACE_ON_FACE, np.where(line, SIDE_ON_FACE, RIM_ON_FACE)),
        np.where(flat, 0.0, number),
        n,
        where(line, plus(bottom, other.axis, low), rim),
        where(line, plus(bottom, other.axis, high), rim),
        line,
        flat | (np.abs(overlap) <= ALIKE * size),
        # Deeper than the base is thick, the point need not be in it.
        (overlap >= -ALIKE * size) & (gap > -2 * base.half),
    )


def _on_side(number: float, base: Cylinder, other: Cylinder, size: Array) -> list[_Form]:
    forms = []
    e_1 = any_across(other.axis)
    e_2 = cross(other.axis, e_1)
    a_1 = scaled(across(e_1, base.axis), other.radius)
    a_2 = scaled(across(e_2, base.axis), other.radius)
    # Half the squared distance is F = p.a1 c + p.a2 s + (a1.a1 c^2 + 2 a1.a2 c s + a2.a2 s^2)/2.
    square, mixed = (dot(a_1, a_1) - dot(a_2, a_2)) / 2, dot(a_1, a_2)
    for sign in (-1.0, 1.0):
        middle = plus(minus(other.centre, base.centre), other.axis, sign * other.half)
        p = across(middle, base.axis)
        p_1, p_2 = dot(p, a_1), dot(p, a_2)

        def value(t: Array, p_1: Array = p_1, p_2: Array = p_2) -> Array:
            bending = square * np.cos(2 * t) + mixed * np.sin(2 * t)
            return p_1 * np.cos(t) + p_2 * np.sin(t) + bending / 2

        def derivatives(t: Array, p_1: Array = p_1, p_2: Array = p_2) -> tuple[Array, Array]:
            c, s = np.cos(t), np.sin(t)
            c_2, s_2 = np.cos(2 * t), np.sin(2 * t)
            slope = -p_1 * s + p_2 * c - square * s_2 + mixed * c_2
            return slope, -p_1 * c - p_2 * s - 2 * (square * c_2 + mixed * s_2)

        for angle in minima(value, derivatives):
            c, s = np.cos(angle), np.sin(angle)
            rim = plus(plus(middle, e_1, other.radius * c), e_2, other.radius * s)
            off = across(rim, base.axis)
            distance = norm(off)
            n = direction(off, any_across(base.axis))
            n = direction(across(n, base.axis), n)
            gap = distance - base.radius
            overlap = base.half - np.abs(dot(rim, base.axis))
            point = plus(base.centre, rim)
            # The rim point has to be the one that comes first along n.
            first = np.abs(separation(other, base, n) - gap) <= ALIKE * size
            forms.append(
                _Form(
                    gap, np.asarray(float(RIM_ON_SIDE)), np.asarray(number), n, point, point,
                    np.zeros(np.shape(gap), dtype=np.bool_), np.abs(overlap) <= ALIKE * size,
                    first & (overlap >= -ALIKE * size),
                )
            )  # fmt: skip
    return forms


def _sides(body_1: Cylinder, body_2: Cylinder, size: Array) -> _Form:
    apart = minus(body_1.centre, body_2.centre)
    k = dot(body_1.axis, body_2.axis)
    turn = cross(body_1.axis, body_2.axis)
    sine = norm(turn)
    line = sine * (body_1.half + body_2.half) <= ALIKE * size
    off = across(apart, body_2.axis)
    n = where(line, off, scaled(turn, np.where(dot(turn, apart) < 0, -1.0, 1.0)))
    n = direction(n, any_across(body_2.axis))
    gap = dot(n, apart) - body_1.radius - body_2.radius
    square = np.where(line, 1.0, sine * sine)
    d_1, d_2 = dot(apart, body_1.axis), dot(apart, body_2.axis)
    s, t = (k * d_2 - d_1) / square, (d_2 - k * d_1) / square
    low, high = (
        np.maximum(d_2 - body_1.half, -body_2.half),
        np.minimum(d_2 + body_1.half, body_2.half),
    )
    room_1, room_2 = body_1.half - np.abs(s), body_2.half - np.abs(t)
    overlap = np.where(line, high - low, np.minimum(room_1, room_2))
    # One end on a side has the normal of that side; two ends have none.
    end = np.abs(np.where(line, high - low, np.maximum(room_1, room_2)))
    surface = plus(body_2.centre, n, body_2.radius + gap / 2)
    return _Form(
        gap,
        np.asarray(float(SIDE_ON_SIDE)),
        np.asarray(0.0),
        n,
        plus(surface, body_2.axis, np.where(line, low, t)),
        plus(surface, body_2.axis, np.where(line, high, t)),
        line,
        (end <= ALIKE * size) & (overlap >= -ALIKE * size),
        overlap >= -ALIKE * size,
    )


def _extent(form: _Form) -> Array:
    wide = form.line | (form.form == FACE_ON_FACE)
    return np.where(wide, 2.0, 0.0) + np.where(form.several, 1.0, 0.0)


def cylinder_contact(*, cylinder_1: Cylinder, cylinder_2: Cylinder) -> CylinderContact:
    """Return the nearest points of two cylinders: gap [m], normal, contact line, and form.

    Candidates are all pairs of faces, rims and sides. A candidate is proven if its points are as
    far apart as its normal separates the bodies: then no other can have a larger gap. The proven
    one with the largest gap is taken. Where none is proven, the nearest points on two rims are
    tried; where those fail too, the gap is a lower bound of the distance or overlap, and `form` is
    0 (theory 8.2).
    """
    body_1, body_2 = cylinder_1, cylinder_2
    size = np.hypot(body_1.radius, body_1.half) + np.hypot(body_2.radius, body_2.half)
    to_first = [
        _on_face(2.0, body_2, body_1, size),
        *_on_side(2.0, body_2, body_1, size),
        _sides(body_1, body_2, size),
    ]
    to_second = [_on_face(1.0, body_1, body_2, size), *_on_side(1.0, body_1, body_2, size)]
    to_first += [form._replace(normal=scaled(form.normal, -1.0)) for form in to_second]
    best = to_first[0]
    bound = separation(body_1, body_2, best.normal)
    for form in to_first[1:]:
        bound = np.maximum(bound, separation(body_1, body_2, form.normal))
        # At the ends of a line or a face, points touch as well: the line or face comes first.
        ahead, alike = form.gap > best.gap, np.abs(form.gap - best.gap) <= ALIKE * size
        ahead = np.where(alike, _extent(form) > _extent(best), ahead)
        better = (form.proven & ~best.proven) | ((form.proven == best.proven) & ahead)
        best = _Form(*where(better, form, best))
    gap, normal = np.where(best.proven, best.gap, bound), best.normal
    first, second = best.first, best.second
    if not np.all(best.proven):
        rims = nearest_on_rims(body_1, body_2, size)
        use = rims.proven & ~best.proven
        gap, normal = np.where(use, rims.gap, gap), where(use, rims.normal, normal)
        first, second = (where(use, rims.point, point) for point in (first, second))
    return CylinderContact(
        gap=gap,
        size=size,
        form=np.where(best.proven, best.form, float(NO_FORM)),
        face_body=np.where(best.proven, best.body, 0.0),
        normal=normal,
        first=first,
        second=second,
        line=best.line & best.proven,
        several=best.several | ~best.proven,
    )
