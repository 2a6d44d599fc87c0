"""Polynomials on a stretch of phase, as Chebyshev coefficients, and their certain roots.

A stretch of length h is the interval 0 to 1 here; a column of coefficients belongs to T_k(2 s - 1).
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.polynomial import chebyshev, legendre

from vibrafeed.core.mechanics.arrays import Array

NODES = 16
"""Gauss's nodes of a stretch, at which the equation of motion is fulfilled."""

TERMS = NODES + 2
"""Chebyshev coefficients of what is integrated twice."""

NOISE = 1e-15
"""A polynomial below this, all along a stretch, has no sign there: it is 0 up to rounding."""

GRAZES = 1e-13
"""A condition that starts at 0 and ends below minus this, in g or g/w, fell at once."""

NARROWEST = 2.0**-44
"""Width of a stretch, of 1, below which it is not cut into halves."""


def _columns(terms: int, function: object, length: int = TERMS) -> Array:
    """Return the matrix of a linear function of `terms` coefficients, shape (`length`, `terms`).

    Column k is the `function` (a callable from coefficients to coefficients) of the k-th unit
    polynomial, padded with 0 or cut to `length`. A product with the matrix then applies the
    function, such as an integral, to any polynomial.
    """
    columns = np.zeros((length, terms))
    for k, unit in enumerate(np.eye(terms)):
        column = function(unit)[:length]  # type: ignore[operator]
        columns[: len(column), k] = column
    return columns


AT = 0.5 * (legendre.leggauss(NODES)[0] + 1.0)
"""The nodes, from 0 to 1."""

FROM_NODES = np.zeros((TERMS, NODES))
FROM_NODES[:NODES] = np.linalg.inv(chebyshev.chebvander(2.0 * AT - 1.0, NODES - 1))
"""Values at the nodes to coefficients."""

AT_NODES = chebyshev.chebvander(2.0 * AT - 1.0, TERMS - 1)
"""Coefficients to values at the nodes."""

INTEGRAL = _columns(TERMS, lambda unit: 0.5 * chebyshev.chebint(unit, lbnd=-1.0))
"""Coefficients to those of the integral from 0."""

SLOPE = _columns(TERMS, lambda unit: 2.0 * chebyshev.chebder(unit))
"""Coefficients to those of the derivative."""

NODES_INTEGRAL = AT_NODES @ INTEGRAL @ FROM_NODES
"""Values at the nodes to the integrals from 0 to each node."""

NODES_SLOPE = np.linalg.inv(NODES_INTEGRAL)
"""Integrals from 0 to each node to the values at the nodes."""

_DEGREES = np.arange(TERMS)
_POINTS = np.cos(np.pi * (np.arange(TERMS) + 0.5) / TERMS)
_FROM_POINTS = np.linalg.inv(chebyshev.chebvander(_POINTS, TERMS - 1))
HALVES = tuple(
    _FROM_POINTS @ chebyshev.chebvander(0.5 * (_POINTS + side), TERMS - 1) for side in (-1.0, 1.0)
)
"""Coefficients on a stretch to those on its first and on its second half."""

_QUADRATURE, _WEIGHTS = legendre.leggauss(NODES)
_QUADRATURE, _WEIGHTS = 0.5 * (_QUADRATURE + 1.0), 0.5 * _WEIGHTS
_SCALED = np.stack([  # of f(s v), at the points s and v
    chebyshev.chebvander((_POINTS + 1.0) * v - 1.0, TERMS - 1) for v in _QUADRATURE
])  # fmt: skip
MEAN = _FROM_POINTS @ np.tensordot(_WEIGHTS, _SCALED, 1)
"""Coefficients of f to those of its integral from 0 to s, over s."""
MEAN_TWICE = _FROM_POINTS @ np.tensordot(_WEIGHTS * (1.0 - _QUADRATURE), _SCALED, 1)
"""Coefficients of f to those of the integral of its integral, over s^2."""


def values(coefficients: Array, at: float) -> Array:
    """Return the values of one or several polynomials at a point from 0 to 1.

    `coefficients` are those of Chebyshev polynomials, shape (..., TERMS).
    """
    angle = math.acos(min(1.0, max(-1.0, 2.0 * at - 1.0)))
    return coefficients @ np.cos(angle * _DEGREES)


def _sense(rises: bool) -> int:
    """Return 1 for rising, -1 for falling."""
    return 1 if rises else -1


def crossings(coefficients: Array) -> Iterator[tuple[float, int]]:
    """Yield the roots of a polynomial in order, from 0 to 1, each with 1 (rising) or -1 (falling).

    `coefficients` are those of its Chebyshev polynomials on [0, 1]. The stretch is cut into halves
    until they prove that the polynomial keeps its sign there (the first is larger than all others
    together), or that its derivative does: then the signs at the ends tell of the one root. Only a
    pair of roots can be missed between which the polynomial is 0 up to rounding.
    """
    above: bool | None = None
    stack = [(0.0, 1.0, coefficients)]
    while stack:
        start, width, c = stack.pop()
        first, others = float(c[0]), float(np.abs(c[1:]).sum())
        if abs(first) + others < NOISE:
            continue
        if abs(first) > others:
            if above is not None and above != (first > 0.0):
                yield start, _sense(first > 0.0)
            above = first > 0.0
            continue
        slope = SLOPE @ c
        monotone = abs(slope[0]) > np.abs(slope[1:]).sum()
        if not monotone and width > NARROWEST:
            stack += [
                (start + 0.5 * width, 0.5 * width, HALVES[1] @ c),
                (start, 0.5 * width, HALVES[0] @ c),
            ]
            continue
        low, high = float(c[::2].sum() - c[1::2].sum()), float(c.sum())
        if low != 0.0:
            if above is not None and above != (low > 0.0):
                yield start, _sense(low > 0.0)
            above = low > 0.0
        if high == 0.0:
            continue
        rises = high > 0.0
        if above is not None and above != rises:
            at = start + width * _root(c, slope, low, high) if low * high < 0.0 else start
            yield at, _sense(rises)
        above = rises


def first_fall(coefficients: Array) -> float:
    """Return the first point, from 0 to 1, at which a polynomial falls through 0; else infinity."""
    return next((at for at, sense in crossings(coefficients) if sense < 0), math.inf)


def fall_from_start(condition: Array) -> float:
    """Return the point, from 0 to 1, at which a condition first falls through 0; else infinity.

    `condition` holds Chebyshev coefficients over a stretch. One that is 0 at the start but for
    rounding, and below it at the end, has fallen at the start.
    """
    at = first_fall(condition)
    return 0.0 if at > 1.0 and condition.sum() < -GRAZES else at


def _root(c: Array, slope: Array, low: float, high: float) -> float:
    """Return the root, from 0 to 1, of a monotonic polynomial, by Newton's method within bounds.

    `c` and `slope` are the Chebyshev coefficients of the polynomial and of its derivative, `low`
    and `high` its values at 0 and 1, of opposite signs. Events of a motion are such roots.
    """
    left, right = 0.0, 1.0
    at = low / (low - high)
    for _ in range(100):
        value = float(values(c, at))
        if (value > 0.0) == (low > 0.0):
            left = at
        else:
            right = at
        new = at - value / float(values(slope, at))
        if not left < new < right:
            new = 0.5 * (left + right)
        if abs(new - at) <= 1e-16 or value == 0.0:
            return new if value else at
        at = new
    return at
