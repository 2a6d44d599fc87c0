"""The contact of two rectangles: separating axes, supporting corner, edge on edge (theory 5.1)."""

from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, sine

# Share of the parts' size below which lengths count as equal: two corners on a face, or a corner on
# a corner. Far above rounding, far below what a part is made to.
ALIKE = 1e-9


class Rectangle(NamedTuple):
    """Centre, angle of the length from +x towards +y, length and width."""

    x: Array
    y: Array
    angle: Array
    length: Array
    width: Array


class RectangleContact(NamedTuple):
    """The place where two rectangles are nearest, or overlap least.

    Attributes
    ----------
    gap : ndarray
        Distance of the corner from the face; negative in overlap.
    size : ndarray
        Sum of both half diagonals, the length that tolerances are relative to.
    face_body : ndarray
        1 or 2, the body whose face it is.
    corner : ndarray
        1 to 4, the corner of the other body, counterclockwise from (+length, +width); 0 where an
        edge lies on the face.
    normal_x, normal_y : ndarray
        Unit normal, from body 2 to body 1.
    first_x, first_y, second_x, second_y : ndarray
        Ends of the touching edge; both the corner where a corner touches.
    edge : ndarray of bool
        Where an edge lies on the face.
    at_corner : ndarray of bool
        Where the touching part of the face shrinks to its end: a corner on a corner.
    beside : ndarray of bool
        Where the corner misses the face.
    """

    gap: Array
    size: Array
    face_body: Array
    corner: Array
    normal_x: Array
    normal_y: Array
    first_x: Array
    first_y: Array
    second_x: Array
    second_y: Array
    edge: Mask
    at_corner: Mask
    beside: Mask


class _Face(NamedTuple):
    """A face of a body, and the other body as seen from it; lengths in m."""

    gap: Array
    n_x: Array
    n_y: Array
    x: Array
    y: Array
    distance: Array
    half: Array
    other_x: Array
    other_y: Array
    c: Array
    s: Array
    half_length: Array
    half_width: Array
    body: Array


def _faces(
    body: float, x: Array, y: Array, angle: Array, half_length: Array, half_width: Array,
    other_x: Array, other_y: Array, other_angle: Array, other_length: Array, other_width: Array,
) -> tuple[_Face, _Face]:  # fmt: skip
    # The two faces of a body that are turned to the other one: along its length and along its
    # width, each with the gap to the other body's support.
    c, s = cosine(angle), sine(angle)
    other_c, other_s = cosine(other_angle), sine(other_angle)
    relative_angle = other_angle - angle
    abs_cos, abs_sin = np.abs(cosine(relative_angle)), np.abs(sine(relative_angle))
    faces = []
    for axis_x, axis_y, distance, half, length_factor, width_factor in (
        (c, s, half_length, half_width, abs_cos, abs_sin),
        (-s, c, half_width, half_length, abs_sin, abs_cos),
    ):
        centre_offset = axis_x * (other_x - x) + axis_y * (other_y - y)
        sign = np.where(centre_offset < 0, -1.0, 1.0)
        gap = (
            np.abs(centre_offset)
            - distance
            - (length_factor * other_length + width_factor * other_width)
        )
        faces.append(
            _Face(gap, sign * axis_x, sign * axis_y, x, y, distance, half, other_x, other_y,
                  other_c, other_s, other_length, other_width, np.asarray(body))
        )  # fmt: skip
    return faces[0], faces[1]


def _nearer(face: _Face, other: _Face) -> _Face:
    is_first = face.gap >= other.gap
    return _Face(*(np.where(is_first, a, b) for a, b in zip(face, other, strict=True)))


def rectangle_contact(*, rectangle_1: Rectangle, rectangle_2: Rectangle) -> RectangleContact:
    """Return the nearest points of two rectangles: gap [m], normal, corner or edge, and its ends.

    The face of either body with the largest gap, and the corner or edge of the other body nearest
    to it. The largest of the four gaps is negative exactly in overlap (separating axes). It is the
    distance where the corner lies over the face, and a lower bound of the distance beside the face.
    Impacts of two parts are computed from this contact.
    """
    outline_1, outline_2 = (
        (body.x, body.y, body.angle, body.length / 2, body.width / 2)
        for body in (rectangle_1, rectangle_2)
    )
    face = _nearer(
        _nearer(*_faces(1.0, *outline_1, *outline_2)), _nearer(*_faces(2.0, *outline_2, *outline_1))
    )
    diagonal_1 = np.hypot(rectangle_1.length, rectangle_1.width)
    diagonal_2 = np.hypot(rectangle_2.length, rectangle_2.width)
    size = (diagonal_1 + diagonal_2) / 2
    # Components of the normal along the other body's axes, and of its axes along the face.
    along_length = face.n_x * face.c + face.n_y * face.s
    along_width = face.n_y * face.c - face.n_x * face.s
    length_sign = np.where(along_length > 0, -1.0, 1.0)
    width_sign = np.where(along_width > 0, -1.0, 1.0)
    corner_x = (
        face.other_x
        + length_sign * face.half_length * face.c
        - width_sign * face.half_width * face.s
    )
    corner_y = (
        face.other_y
        + length_sign * face.half_length * face.s
        + width_sign * face.half_width * face.c
    )
    corner = np.where(
        width_sign > 0, np.where(length_sign > 0, 1.0, 2.0), np.where(length_sign > 0, 4.0, 3.0)
    )
    # Rise of the edges that meet in the corner, over the face.
    rise_length = 2 * np.abs(along_length) * face.half_length
    rise_width = 2 * np.abs(along_width) * face.half_width
    edge = np.minimum(rise_length, rise_width) <= ALIKE * size
    t_x, t_y = -face.n_y, face.n_x
    near_end = t_x * (corner_x - face.x) + t_y * (corner_y - face.y)
    edge_is_length = rise_length <= rise_width
    far_end = np.where(
        edge_is_length,
        -2 * length_sign * face.half_length * (t_x * face.c + t_y * face.s),
        -2 * width_sign * face.half_width * (t_y * face.c - t_x * face.s),
    )
    far_end = np.where(edge, near_end + far_end, near_end)
    low, high = np.minimum(near_end, far_end), np.maximum(near_end, far_end)
    low, high = np.maximum(low, -face.half), np.minimum(high, face.half)
    overlap = high - low
    overlap_margin = np.where(edge, overlap, face.half - np.abs(near_end))
    beside, at_corner = overlap_margin < -ALIKE * size, np.abs(overlap_margin) <= ALIKE * size
    corner = np.where(edge, 0.0, corner)
    on_edge = edge & (overlap > 0)
    level = face.distance + face.gap
    base_x, base_y = face.x + face.n_x * level, face.y + face.n_y * level
    sign = np.where(face.body == 2.0, 1.0, -1.0)
    return RectangleContact(
        gap=face.gap,
        size=size,
        face_body=face.body,
        corner=corner,
        normal_x=sign * face.n_x,
        normal_y=sign * face.n_y,
        first_x=np.where(on_edge, base_x + t_x * low, corner_x),
        first_y=np.where(on_edge, base_y + t_y * low, corner_y),
        second_x=np.where(on_edge, base_x + t_x * high, corner_x),
        second_y=np.where(on_edge, base_y + t_y * high, corner_y),
        edge=edge,
        at_corner=at_corner,
        beside=beside,
    )
