"""Interpolation in an atlas: within one pattern of motion, with an error, or not at all.

It is linear over the four numbers. A corner without weight counts for nothing: a part on a level
track with one coefficient of friction, whose numbers are nodes, has four corners and not sixteen.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.atlas.build import SAFETY, SHARE_DIGITS, SHARE_SAFETY, VELOCITY_DIGITS
from vibrafeed.core.atlas.cells import BITS
from vibrafeed.core.atlas.numbers import AXES, Numbers, out_of_range, rests
from vibrafeed.core.atlas.read import ERRORS, VALUES, Atlas
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.result import SHARES
from vibrafeed.core.quantities import Flag

PIECE: Final = 8192  # cells that are looked up at a time: their corners stay in the cache

LOOKUP_STATUSES: Mapping[str, Flag] = {
    "answered": Flag(0, "interpolated inside a regime, with a stated error"),
    "near_border": Flag(
        1, "near the border of a regime, where the atlas has no value: simulate", valid=False
    ),
    "out_of_range": Flag(2, "outside the range of the atlas: simulate", valid=False),
    "simulated": Flag(3, "no value in the atlas; the part was simulated exactly"),
}
STATUS: Mapping[str, int] = {name: flag.value for name, flag in LOOKUP_STATUSES.items()}


class AtlasValues(NamedTuple):
    """Values of an atlas at some cells, arrays of shape (n,).

    Attributes
    ----------
    velocity, error : ndarray
        Velocity number and its stated error; NaN where the atlas does not answer.
    stick, forward, backward, flight : ndarray
        Shares of the period.
    share_error : ndarray
        Stated error of each share.
    pattern : ndarray of int8
        The ways of moving; 0 where the atlas does not answer.
    status : ndarray of int8
        Value of a `LOOKUP_STATUSES` entry.
    """

    velocity: Array
    error: Array
    stick: Array
    forward: Array
    backward: Array
    flight: Array
    share_error: Array
    pattern: NDArray[np.int8]
    status: NDArray[np.int8]


def find(atlas: Atlas, numbers: Numbers) -> AtlasValues:
    """Return velocities, shares and stated errors interpolated in an atlas, arrays of shape (n,).

    `numbers` are the four dimensionless numbers of n parts and drives, each of shape (n,). They are
    looked up piece by piece, so that the nodes read stay in the processor's cache.
    """
    pieces = [
        _piece(atlas, Numbers(*(one[start : start + PIECE] for one in numbers)))
        for start in range(0, max(1, numbers.throw_number.size), PIECE)
    ]
    return AtlasValues(*(np.concatenate(fields) for fields in zip(*pieces, strict=True)))


def _piece(atlas: Atlas, numbers: Numbers) -> AtlasValues:
    """Return interpolated values of a few cells: linear over four numbers, with stated errors.

    `numbers` are the four atlas numbers, each of shape (n,). The error is SAFETY times the sum over
    the axes of 4 t (1 - t) e, plus rounding: t is the position between two nodes, 0 to 1, and e the
    largest error of interpolation along that axis stored at the corners. A cell whose corners have
    different patterns of motion, or whose error is unknown, gets no value but a status that says
    so.
    """
    count = numbers.throw_number.size
    outside = np.logical_or.reduce(list(out_of_range(numbers).values()))
    base = np.zeros(count, dtype=np.intp)
    nearest = np.zeros(count, dtype=np.intp)
    fractions, steps = [], []
    for axis, (nodes, values) in enumerate(zip(atlas.axes, numbers, strict=True)):
        inside = np.where(outside, nodes[0], values)
        below = np.clip(np.searchsorted(nodes, inside, side="right") - 1, 0, nodes.size - 2)
        position = (inside - nodes[below]) / (nodes[below + 1] - nodes[below])
        step = int(np.prod(atlas.shape[axis + 1 :], dtype=np.intp))
        base += below * step
        nearest += (below + (position > 0.5)) * step
        fractions.append(position)
        steps.append(step)
    values, errors, agrees = _corners(atlas, base, fractions, steps, atlas.patterns[nearest])
    between = np.stack([4.0 * position * (1.0 - position) for position in fractions], axis=-1)
    # What no neighbour tells is infinite, and counts where the number is no node.
    bends = np.where(between > 0, errors[:, : len(AXES)], 0.0) * between
    error = SAFETY * bends.sum(axis=-1) + 2.0 * 10.0**-VELOCITY_DIGITS
    agrees &= np.isfinite(error)
    bend = np.where(between.max(axis=-1) > 0, np.minimum(errors[:, -1], 1.0), 0.0)
    share_error = np.minimum(SHARE_SAFETY * bend + 10.0**-SHARE_DIGITS, 1.0)
    return _with_status(numbers, outside, agrees, values, error, share_error, atlas, nearest)


def _corners(
    atlas: Atlas,
    base: NDArray[np.intp],
    fractions: list[NDArray[np.float64]],
    steps: list[int],
    pattern: NDArray[np.int8],
) -> tuple[NDArray[np.float64], NDArray[np.float32], NDArray[np.bool_]]:
    """Interpolate the atlas at n cells from the up to 16 nodes around each of them.

    Parameters
    ----------
    base : ndarray, shape (n,)
        Flat index of the node at the lower end of every axis.
    fractions : list of ndarray, shape (n,)
        For each axis, the position between the two nodes, 0 to 1.
    steps : list of int
        For each axis, the distance in the flat index from one node to the next.
    pattern : ndarray, shape (n,)
        Pattern of motion of the nearest node.

    Returns
    -------
    values, errors : ndarray, shapes (n, 5) and (n, 5)
        Weighted means of the variables `VALUES`; largest of each of `ERRORS` at corners with
        weight.
    agrees : ndarray of bool, shape (n,)
        True where all corners with weight have the pattern, which is not 0.
    """
    count = base.size
    values = np.zeros((count, len(VALUES)))
    errors = np.zeros((count, len(ERRORS)), dtype=np.float32)
    agrees = pattern > 0
    for corner in product((0, 1), repeat=len(steps)):
        weight = np.ones(count)
        for upper, fraction in zip(corner, fractions, strict=True):
            weight *= fraction if upper else 1.0 - fraction
        weighs = weight > 0
        if not weighs.any():
            continue
        at = base + sum(step for upper, step in zip(corner, steps, strict=True) if upper)
        if not weighs.all():  # an unused corner may lie beyond the last node
            at = np.where(weighs, at, base)
        record = atlas.records.take(at, axis=0)
        agrees &= ~weighs | (atlas.patterns.take(at) == pattern)
        values += weight[:, None] * record[:, : len(VALUES)]
        found = record[:, len(VALUES) :]
        if not weighs.all():
            found[~weighs] = 0.0
        np.maximum(errors, found, out=errors)
    return values, errors, agrees


def _with_status(
    numbers: Numbers,
    outside: NDArray[np.bool_],
    agrees: NDArray[np.bool_],
    values: NDArray[np.float64],
    error: Array,
    share_error: Array,
    atlas: Atlas,
    nearest: NDArray[np.intp],
) -> AtlasValues:
    """Return the values of a look-up of n cells with a status each; NaN where there is no value.

    Parts that friction holds all the time rest exactly: velocity and errors 0, wherever they lie.

    Parameters
    ----------
    numbers : Numbers
        The four atlas numbers of the cells.
    outside, agrees : ndarray of bool, shape (n,)
        True beyond the axes of the atlas; True where all nodes around a cell have one pattern of
        motion, so that interpolation is allowed.
    values : ndarray, shape (n, 5)
        Interpolated velocity number and four shares of the period.
    error, share_error : ndarray, shape (n,)
        Stated errors of velocity number and shares.
    atlas : Atlas
        Has the pattern of motion of each node.
    nearest : ndarray of int, shape (n,)
        Flat index of the nearest node, whose pattern the cell takes.
    """
    status = np.where(outside, STATUS["out_of_range"], STATUS["near_border"])
    held = rests(numbers) & ~outside
    answered = held | (agrees & ~outside)
    status = np.where(answered, STATUS["answered"], status).astype(np.int8)
    at_rest = np.array([0.0, *(float(name == "stick") for name in SHARES)])
    values = np.where(held[:, None], at_rest, values)
    values = np.where(answered[:, None], values, np.nan)
    pattern = np.where(held, BITS["stick"], atlas.patterns[nearest])
    exactly = np.where(held, 0.0, error), np.where(held, 0.0, share_error)
    error, share_error = (np.where(answered, one, np.nan) for one in exactly)
    pattern = np.where(answered, pattern, 0).astype(np.int8)
    return AtlasValues._make((values[:, 0], error, *values[:, 1:].T, share_error, pattern, status))
