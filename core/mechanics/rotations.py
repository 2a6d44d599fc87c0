"""Rotations of rigid bodies as plain arrays (theory 1.1; (2.1) of the source).

Plain arrays of shape (..., 3, 3) are the one representation of a rotation here, not
``scipy.spatial.transform.Rotation``: closed forms need three elementary matrices and their
products, a grid of angles broadcasts by itself, and scipy would be a dependency for this alone.
There are no quaternions.

All matrices are active: they turn a vector, components in the same axes before and after. Where the
source uses a passive matrix the transpose is written out.
"""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics.angles import cosine, sine
from vibrafeed.core.mechanics.arrays import Array


def rotation_x(angle: Array) -> Array:
    """Return the matrix of the active rotation about x, shape (..., 3, 3)."""
    return _about(0, angle)


def rotation_y(angle: Array) -> Array:
    """Return the matrix of the active rotation about y, shape (..., 3, 3)."""
    return _about(1, angle)


def rotation_z(angle: Array) -> Array:
    """Return the matrix of the active rotation about z, shape (..., 3, 3)."""
    return _about(2, angle)


def body_to_reference(*, about_x: Array, about_y: Array, about_z: Array) -> Array:
    """Return the matrix R_z R_y R_x that turns body components into reference components, (2.1).

    The angles are the source's Cardan angles alpha, beta, gamma; they are not those of the drive
    and of the track.
    """
    return rotation_z(about_z) @ rotation_y(about_y) @ rotation_x(about_x)


def turned(matrix: Array, vector: Array) -> Array:
    """Return the matrix times the vector, for arrays of both, shape (..., 3)."""
    return np.einsum("...ij,...j->...i", matrix, vector)


def _about(axis: int, angle: Array) -> Array:
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
