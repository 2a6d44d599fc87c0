"""The contact of two cylinders in its five forms, each with a proof of its gap (theory 8.2).

A direction n separates two convex bodies by at least what their support functions say. A form gives
n and a point of each body; if the points lie along n and as far apart as n separates, the gap is
exact and no other form can have a larger one. In overlap such points prove that the bodies do
overlap, though not by how much at least. Only proven forms count. Where there is none, two rims may
be nearest, with a proof of the same kind; where that fails too, rims have entered each other.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics import vectors
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.mechanics.cylinder_rims import minima, nearest_on_rims
from vibrafeed.core.mechanics.cylinders import Cylinder, separation
from vibrafeed.core.mechanics.rectangle_contact import ALIKE
from vibrafeed.core.mechanics.vectors import Vector, across, cross, dot, norm, plus, scaled

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
    """One of the forms that a contact can have, with the fields of `CylinderContact`.

    `gap` is what its normal separates the bodies by, `body` the `face_body`; `proven` is true where
    its points are as far apart as that, so that no other form can have a larger gap.
    """

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
    """Return the candidate for the contact of an end face of `base` with the body `other`.

    The face may meet rim, side or face of `other`. The record has the gap [m], the normal from
    `base` to `other`, the ends of the contact line (of a point both the same), and `proven`, where
    the point lies on the face. `number`, 1 or 2, is the number of the body `base` in the pair,
    `size` the sum of both half diagonals [m], by which tolerances scale.
    """
    u, apart = base.axis, vectors.minus(other.centre, base.centre)
    n = scaled(u, np.where(dot(u, apart) < 0, -1.0, 1.0))
    w = dot(n, other.axis)
    leaning = across(n, other.axis)
    down = vectors.direction(leaning, vectors.any_across(other.axis))
    gap = separation(other, base, n)
    flat = 2 * other.radius * norm(leaning) <= ALIKE * size
    line = ~flat & (2 * other.half * np.abs(w) <= ALIKE * size)
    bottom = plus(other.centre, down, -other.radius)
    rim = plus(bottom, other.axis, np.where(w > 0, -other.half, other.half))
    off = norm(across(vectors.minus(rim, base.centre), u))
    # The line of a side that lies on the face, as far as it crosses the disc.
    along = across(other.axis, u)
    along = vectors.direction(along, vectors.any_across(u))
    foot = across(vectors.minus(bottom, base.centre), u)
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
        vectors.where(line, plus(bottom, other.axis, low), rim),
        vectors.where(line, plus(bottom, other.axis, high), rim),
        line,
        flat | (np.abs(overlap) <= ALIKE * size),
        # Deeper than the base is thick, the point need not be in it.
        (overlap >= -ALIKE * size) & (gap > -2 * base.half),
    )


def _on_side(number: float, base: Cylinder, other: Cylinder, size: Array) -> list[_Form]:
    """Return the candidates for the contact of both rims of `other` with the side of `base`.

    Up to two for each rim. Each has gap [m], normal, point and a flag `proven`: its point is the
    first of `other` along the normal, and lies on the side within its length. A rim point is a
    candidate where its distance from the axis of `base` has a minimum by the angle on the rim.

    `number`, 1 or 2, is the number of the body `base` in the pair, `size` the sum of both half
    diagonals [m], by which tolerances scale.
    """
    forms = []
    e_1 = vectors.any_across(other.axis)
    e_2 = cross(other.axis, e_1)
    a_1 = scaled(across(e_1, base.axis), other.radius)
    a_2 = scaled(across(e_2, base.axis), other.radius)
    # Half the squared distance is F = p.a1 c + p.a2 s + (a1.a1 c^2 + 2 a1.a2 c s + a2.a2 s^2)/2.
    square, mixed = (dot(a_1, a_1) - dot(a_2, a_2)) / 2, dot(a_1, a_2)
    for sign in (-1.0, 1.0):
        middle = plus(vectors.minus(other.centre, base.centre), other.axis, sign * other.half)
        p = across(middle, base.axis)
        p_1, p_2 = dot(p, a_1), dot(p, a_2)

        def value(t: Array, p_1: Array = p_1, p_2: Array = p_2) -> Array:
            """Return half the squared distance from the axis, less a constant, at rim angle t."""
            bending = square * np.cos(2 * t) + mixed * np.sin(2 * t)
            return p_1 * np.cos(t) + p_2 * np.sin(t) + bending / 2

        def derivatives(t: Array, p_1: Array = p_1, p_2: Array = p_2) -> tuple[Array, Array]:
            """Return first and second derivative of `value` by the rim angle t."""
            c, s = np.cos(t), np.sin(t)
            c_2, s_2 = np.cos(2 * t), np.sin(2 * t)
            slope = -p_1 * s + p_2 * c - square * s_2 + mixed * c_2
            return slope, -p_1 * c - p_2 * s - 2 * (square * c_2 + mixed * s_2)

        for angle in minima(value, derivatives):
            c, s = np.cos(angle), np.sin(angle)
            rim = plus(plus(middle, e_1, other.radius * c), e_2, other.radius * s)
            off = across(rim, base.axis)
            distance = norm(off)
            n = vectors.direction(off, vectors.any_across(base.axis))
            n = vectors.direction(across(n, base.axis), n)
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
    """Return the candidate for the contact of two cylinders by their sides, crossed or parallel.

    Crossed axes touch in a point, parallel ones along a line from `first` to `second`. The record
    has the gap [m], the normal from body 2 to body 1, and `proven`, where the point or line lies on
    both sides within their lengths. `size` is the sum of both half diagonals [m], by which
    tolerances scale.
    """
    apart = vectors.minus(body_1.centre, body_2.centre)
    k = dot(body_1.axis, body_2.axis)
    turn = cross(body_1.axis, body_2.axis)
    sine = norm(turn)
    line = sine * (body_1.half + body_2.half) <= ALIKE * size
    off = across(apart, body_2.axis)
    n = vectors.where(line, off, scaled(turn, np.where(dot(turn, apart) < 0, -1.0, 1.0)))
    n = vectors.direction(n, vectors.any_across(body_2.axis))
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
    """Return the rank of a contact form by what touches, to prefer the larger where gaps are alike.

    0 for a point, 1 for a point on both rims, 2 for a line or a face, 3 for a face or for the end
    of a line that lies on both rims; such an end has the normal of the line all the same.
    """
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
        best = _Form(
            np.where(better, form.gap, best.gap),
            np.where(better, form.form, best.form),
            np.where(better, form.body, best.body),
            vectors.where(better, form.normal, best.normal),
            vectors.where(better, form.first, best.first),
            vectors.where(better, form.second, best.second),
            np.where(better, form.line, best.line),
            np.where(better, form.several, best.several),
            np.where(better, form.proven, best.proven),
        )
    gap, normal = np.where(best.proven, best.gap, bound), best.normal
    first, second = best.first, best.second
    if not np.all(best.proven):
        rims = nearest_on_rims(body_1, body_2, size)
        use = rims.proven & ~best.proven
        gap, normal = np.where(use, rims.gap, gap), vectors.where(use, rims.normal, normal)
        first, second = (vectors.where(use, rims.point, point) for point in (first, second))
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
