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
    is_nonzero = length > 0
    return where(is_nonzero, scaled(a, 1 / np.where(is_nonzero, length, 1.0)), otherwise)


def any_across(axis: Vector) -> Vector:
    """Return some unit vector at right angles to a unit `axis`."""
    axis_z = axis[2]
    is_upright = np.abs(axis_z) > 0.5
    zero = np.zeros_like(axis_z)
    helper = where(
        is_upright, (np.ones_like(axis_z), zero, zero), (zero, zero, np.ones_like(axis_z))
    )
    return direction(across(helper, axis), helper)


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
    value_at: Callable[[Array], Array], derivatives: Callable[[Array], tuple[Array, Array]]
) -> tuple[Array, Array]:
    """Return the angles of the two lowest minima of a function with the period 2 pi [rad].

    `derivatives` gives its first and second one. Samples find the minima, Newton's method
    refines them. Where there is one minimum only, both angles are equal.
    """
    step = 2 * np.pi / SAMPLES
    values = [value_at(t) for t in step * np.arange(SAMPLES)]
    lowest = [np.full(np.shape(values[0]), np.inf) for _ in range(2)]
    angles = [np.zeros(np.shape(values[0])) for _ in range(2)]
    for index, value in enumerate(values):
        is_minimum = (value <= values[index - 1]) & (value < values[(index + 1) % SAMPLES])
        is_lowest, is_second = is_minimum & (value < lowest[0]), is_minimum & (value < lowest[1])
        angles[1] = np.where(is_lowest, angles[0], np.where(is_second, index * step, angles[1]))
        lowest[1] = np.where(is_lowest, lowest[0], np.where(is_second, value, lowest[1]))
        angles[0] = np.where(is_lowest, index * step, angles[0])
        lowest[0] = np.where(is_lowest, value, lowest[0])
    angles[1] = np.where(np.isfinite(lowest[1]), angles[1], angles[0])
    return _refined_minimum(angles[0], step, derivatives), _refined_minimum(
        angles[1], step, derivatives
    )


def _refined_minimum(
    angle: Array, half_bracket: float, derivatives: Callable[[Array], tuple[Array, Array]]
) -> Array:
    # The zero of the first derivative next to `angle`: Newton's steps within a bracket, else
    # halving.
    low, high = angle - half_bracket, angle + half_bracket
    converged: Mask = np.zeros(np.shape(angle), dtype=np.bool_)
    for _ in range(MAX_STEPS):
        slope, curvature = derivatives(angle)
        low, high = np.where(slope < 0, angle, low), np.where(slope > 0, angle, high)
        newton = angle - slope / np.where(curvature > 0, curvature, 1.0)
        accepts_newton = (newton > low) & (newton < high)
        accepts_newton = (curvature > 0) & (accepts_newton | (np.abs(newton - angle) <= NEAR))
        next_angle = np.where(accepts_newton, newton, (low + high) / 2)
        # A cell that has converged stays: it must not depend on those that are computed beside it.
        next_angle = np.where(converged | (slope == 0), angle, next_angle)
        converged = converged | (np.abs(next_angle - angle) <= 1e-15 * (1 + np.abs(angle)))
        angle = next_angle
        if np.all(converged):
            break
    return angle


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


def _offset_from_body(point: Vector, base: Cylinder) -> Vector:
    height, radial = dot(point, base.axis), across(point, base.axis)
    beyond_face = np.maximum(0.0, np.abs(height) - base.half) * np.where(height < 0, -1.0, 1.0)
    return plus(
        scaled(radial, _outside_fraction(norm(radial), base.radius)), base.axis, beyond_face
    )


def _outside_fraction(distance: Array, radius: Array) -> Array:
    outside = distance > radius
    return np.where(outside, (distance - radius) / np.where(outside, distance, 1.0), 0.0)


def _half_square_derivatives(rim: Rim, base: Cylinder, angle: Array) -> tuple[Array, Array]:
    # First and second derivative of d^2/2 by the angle, d the distance of the rim's point.
    point, along = rim.at(angle), rim.along(angle)
    offset, radial = _offset_from_body(point, base), across(point, base.axis)
    axial_rate, radial_rate = dot(along, base.axis), across(along, base.axis)
    # What moves away from the axis counts in full, what goes round it by the share outside.
    fraction = _outside_fraction(norm(radial), base.radius)
    outward = dot(radial_rate, direction(radial, base.axis))
    curvature = np.where(np.abs(dot(point, base.axis)) > base.half, axial_rate * axial_rate, 0.0)
    curvature = (
        curvature
        + np.where(fraction > 0, outward * outward * (1 - fraction), 0.0)
        + fraction * dot(radial_rate, radial_rate)
    )
    return dot(offset, along), curvature - dot(offset, minus(point, rim.middle))


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
    radial = any_across(body.axis)
    radii = scaled(radial, body.radius), scaled(cross(body.axis, radial), body.radius)
    candidates: list[Nearest] = []
    for sign in (-1.0, 1.0):
        middle = plus(minus(body.centre, base.centre), body.axis, sign * body.half)
        rim = Rim(middle, *radii)

        def squared(angle: Array, rim: Rim = rim) -> Array:
            offset = _offset_from_body(rim.at(angle), base)
            return dot(offset, offset)

        def derivatives(angle: Array, rim: Rim = rim) -> tuple[Array, Array]:
            return _half_square_derivatives(rim, base, angle)

        for angle in minima(squared, derivatives):
            offset = _offset_from_body(rim.at(angle), base)
            gap = norm(offset)
            n = direction(offset, body.axis)
            proven = (gap > 0) & (np.abs(separation(body, base, n) - gap) <= ALIKE * size)
            point = plus(base.centre, minus(rim.at(angle), offset))
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


def _on_face(base_number: float, base: Cylinder, other: Cylinder, size: Array) -> _Form:
    # The lowest point or line of `other` on the face of `base` that is turned to it. Proven if it
    # lies over the disc. The form is rim, side or face on face, by the other axis.
    face_axis, between = base.axis, minus(other.centre, base.centre)
    n = scaled(face_axis, np.where(dot(face_axis, between) < 0, -1.0, 1.0))
    axial_part = dot(n, other.axis)
    tilted = across(n, other.axis)
    radial = direction(tilted, any_across(other.axis))
    gap = separation(other, base, n)
    face_on_face = 2 * other.radius * norm(tilted) <= ALIKE * size
    side_on_face = ~face_on_face & (2 * other.half * np.abs(axial_part) <= ALIKE * size)
    bottom = plus(other.centre, radial, -other.radius)
    rim = plus(bottom, other.axis, np.where(axial_part > 0, -other.half, other.half))
    rim_distance = norm(across(minus(rim, base.centre), face_axis))
    # The line of a side that lies on the face, as far as it crosses the disc.
    line = across(other.axis, face_axis)
    line = direction(line, any_across(face_axis))
    bottom_in_face = across(minus(bottom, base.centre), face_axis)
    bottom_along = dot(bottom_in_face, line)
    line_distance = norm(plus(bottom_in_face, line, -bottom_along))
    half_chord = np.sqrt(
        np.maximum(0.0, (base.radius - line_distance) * (base.radius + line_distance))
    )
    low = np.maximum(-bottom_along - half_chord, -other.half)
    high = np.minimum(-bottom_along + half_chord, other.half)
    # Faces: the discs meet if their centres are near enough.
    face_centre = across(between, face_axis)
    overlap = np.where(
        face_on_face,
        base.radius + other.radius - norm(face_centre),
        np.where(
            side_on_face,
            np.where(line_distance <= base.radius, high - low, -size),
            base.radius - rim_distance,
        ),
    )
    return _Form(
        gap,
        np.where(face_on_face, FACE_ON_FACE, np.where(side_on_face, SIDE_ON_FACE, RIM_ON_FACE)),
        np.where(face_on_face, 0.0, base_number),
        n,
        where(side_on_face, plus(bottom, other.axis, low), rim),
        where(side_on_face, plus(bottom, other.axis, high), rim),
        side_on_face,
        face_on_face | (np.abs(overlap) <= ALIKE * size),
        # Deeper than the base is thick, the point need not be in it.
        (overlap >= -ALIKE * size) & (gap > -2 * base.half),
    )


def _on_side(base_number: float, base: Cylinder, other: Cylinder, size: Array) -> list[_Form]:
    # Rim points of `other` nearest to the axis of `base`: up to two on each rim.
    forms = []
    e_1 = any_across(other.axis)
    e_2 = cross(other.axis, e_1)
    a_1 = scaled(across(e_1, base.axis), other.radius)
    a_2 = scaled(across(e_2, base.axis), other.radius)
    # Half the squared distance is F = p.a1 c + p.a2 s + (a1.a1 c^2 + 2 a1.a2 c s + a2.a2 s^2)/2.
    cosine_part, sine_part = (dot(a_1, a_1) - dot(a_2, a_2)) / 2, dot(a_1, a_2)
    for sign in (-1.0, 1.0):
        middle = plus(minus(other.centre, base.centre), other.axis, sign * other.half)
        p = across(middle, base.axis)
        p_1, p_2 = dot(p, a_1), dot(p, a_2)

        def value(t: Array, p_1: Array = p_1, p_2: Array = p_2) -> Array:
            bending = cosine_part * np.cos(2 * t) + sine_part * np.sin(2 * t)
            return p_1 * np.cos(t) + p_2 * np.sin(t) + bending / 2

        def derivatives(t: Array, p_1: Array = p_1, p_2: Array = p_2) -> tuple[Array, Array]:
            c, s = np.cos(t), np.sin(t)
            c_2, s_2 = np.cos(2 * t), np.sin(2 * t)
            slope = -p_1 * s + p_2 * c - cosine_part * s_2 + sine_part * c_2
            return slope, -p_1 * c - p_2 * s - 2 * (cosine_part * c_2 + sine_part * s_2)

        for angle in minima(value, derivatives):
            c, s = np.cos(angle), np.sin(angle)
            rim = plus(plus(middle, e_1, other.radius * c), e_2, other.radius * s)
            radial = across(rim, base.axis)
            distance = norm(radial)
            n = direction(radial, any_across(base.axis))
            n = direction(across(n, base.axis), n)
            gap = distance - base.radius
            overlap = base.half - np.abs(dot(rim, base.axis))
            point = plus(base.centre, rim)
            # The rim point has to be the one that comes first along n.
            is_nearest = np.abs(separation(other, base, n) - gap) <= ALIKE * size
            forms.append(
                _Form(
                    gap, np.asarray(float(RIM_ON_SIDE)), np.asarray(base_number), n, point, point,
                    np.zeros(np.shape(gap), dtype=np.bool_), np.abs(overlap) <= ALIKE * size,
                    is_nearest & (overlap >= -ALIKE * size),
                )
            )  # fmt: skip
    return forms


def _sides(body_1: Cylinder, body_2: Cylinder, size: Array) -> _Form:
    # The nearest points of both axes, at the distances foot_1 and foot_2 from the centres: foot_1 =
    # (k d_2 - d_1)/(1 - k^2), k the cosine between the axes; parallel sides touch along a line.
    between = minus(body_1.centre, body_2.centre)
    axes_cosine = dot(body_1.axis, body_2.axis)
    common_normal = cross(body_1.axis, body_2.axis)
    sine = norm(common_normal)
    is_parallel = sine * (body_1.half + body_2.half) <= ALIKE * size
    radial = across(between, body_2.axis)
    n = where(
        is_parallel,
        radial,
        scaled(common_normal, np.where(dot(common_normal, between) < 0, -1.0, 1.0)),
    )
    n = direction(n, any_across(body_2.axis))
    gap = dot(n, between) - body_1.radius - body_2.radius
    sine_squared = np.where(is_parallel, 1.0, sine * sine)
    d_1, d_2 = dot(between, body_1.axis), dot(between, body_2.axis)
    foot_1, foot_2 = (
        (axes_cosine * d_2 - d_1) / sine_squared,
        (d_2 - axes_cosine * d_1) / sine_squared,
    )
    low, high = (
        np.maximum(d_2 - body_1.half, -body_2.half),
        np.minimum(d_2 + body_1.half, body_2.half),
    )
    margin_1, margin_2 = body_1.half - np.abs(foot_1), body_2.half - np.abs(foot_2)
    overlap = np.where(is_parallel, high - low, np.minimum(margin_1, margin_2))
    # One end on a side has the normal of that side; two ends have none.
    end_margin = np.abs(np.where(is_parallel, high - low, np.maximum(margin_1, margin_2)))
    surface = plus(body_2.centre, n, body_2.radius + gap / 2)
    return _Form(
        gap,
        np.asarray(float(SIDE_ON_SIDE)),
        np.asarray(0.0),
        n,
        plus(surface, body_2.axis, np.where(is_parallel, low, foot_2)),
        plus(surface, body_2.axis, np.where(is_parallel, high, foot_2)),
        is_parallel,
        (end_margin <= ALIKE * size) & (overlap >= -ALIKE * size),
        overlap >= -ALIKE * size,
    )


def _contact_rank(form: _Form) -> Array:
    is_extended = form.line | (form.form == FACE_ON_FACE)
    return np.where(is_extended, 2.0, 0.0) + np.where(form.several, 1.0, 0.0)


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
    forms = [
        _on_face(2.0, body_2, body_1, size),
        *_on_side(2.0, body_2, body_1, size),
        _sides(body_1, body_2, size),
    ]
    forms_of_1 = [_on_face(1.0, body_1, body_2, size), *_on_side(1.0, body_1, body_2, size)]
    forms += [form._replace(normal=scaled(form.normal, -1.0)) for form in forms_of_1]
    best = forms[0]
    bound = separation(body_1, body_2, best.normal)
    for form in forms[1:]:
        bound = np.maximum(bound, separation(body_1, body_2, form.normal))
        # At the ends of a line or a face, points touch as well: the line or face comes first.
        is_larger, is_equal = form.gap > best.gap, np.abs(form.gap - best.gap) <= ALIKE * size
        is_larger = np.where(is_equal, _contact_rank(form) > _contact_rank(best), is_larger)
        better = (form.proven & ~best.proven) | ((form.proven == best.proven) & is_larger)
        best = _Form(*where(better, form, best))
    gap, normal = np.where(best.proven, best.gap, bound), best.normal
    first, second = best.first, best.second
    if not np.all(best.proven):
        rims = nearest_on_rims(body_1, body_2, size)
        use_rims = rims.proven & ~best.proven
        gap, normal = np.where(use_rims, rims.gap, gap), where(use_rims, rims.normal, normal)
        first, second = (where(use_rims, rims.point, point) for point in (first, second))
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
