"""Polynomials of a step: values, and where one first comes down through zero.

Each is a row of a table, and is named by it: a view of its own would cost more than its values.
"""

from __future__ import annotations

import math

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.arrays import Floats

MAX_PASSES = 200
"""Most passes of a search: halving alone ends after 53, and a step that gains less is at a root up
to rounding."""
NEVER = -1.0  # in the place of a root: there is none
SHARP = 1e-15
"""Share of the span to which a root is known."""


@borrowing
def value(table: Floats, row: int, order: int, t: float) -> float:
    """Return the value of a polynomial at `t` by Horner's scheme, a_0 + t (a_1 + t (a_2 + ...)).

    Its coefficients stand in row `row` of `table`, up to the power `order`.
    """
    total = table[row, order]
    for k in range(order - 1, -1, -1):
        total = total * t + table[row, k]
    return total


@borrowing
def first_fall(table: Floats, row: int, order: int, span: float, scratch: int) -> float:
    """Return the first t in [0, span] at which a polynomial falls through 0; `NEVER` (-1) if none.

    For the next event of a step. Its coefficients stand in row `row` of `table`, up to the power
    `order`; row `scratch` is overwritten. A value of exactly 0 at the start is divided out. The
    negative terms alone bound the polynomial P from below, P(t) >= P(0) + `negative_part`: up to
    where that bound is 0, P has no root. P is shifted there (`safe_step`) and the bound asked
    again; near a root that P crosses, Newton's iteration finds it (`near_fall`).
    """
    low = 0
    while low < order and table[row, low] == 0.0:
        low += 1
    if table[row, low] < 0.0:
        return 0.0
    if table[row, low] + negative_part(table, row, low, order, span) > 0.0:
        return NEVER
    degree = order - low
    for k in range(degree + 1):
        table[scratch, k] = table[row, k + low]
    at = 0.0
    for _ in range(MAX_PASSES):
        near = near_fall(table, scratch, degree, span - at)
        if near >= 0.0:
            return at + near
        step = safe_step(table, scratch, degree, span - at)
        at += step
        if at >= span:
            return NEVER
        if step <= SHARP * span:
            return at
        for i in range(degree):
            for k in range(degree - 1, i - 1, -1):
                table[scratch, k] += step * table[scratch, k + 1]
        if table[scratch, 0] <= 0.0:
            return at
    return at


@borrowing
def near_fall(table: Floats, row: int, degree: int, span: float) -> float:
    """Return the first root of a polynomial that falls all the way to it; -1 if it may not.

    An event of motion is such a root. The coefficients a_k stand in row `row` of `table`, up to
    power `degree`; the polynomial is above 0 at 0, and the root is sought up to `span`. It falls
    all the way if a_1 + sum of k max(a_k, 0) t^(k-1) < 0 up to twice the root of the tangent, or up
    to `span`. Newton's iteration within a bracket, t -> t - P/P'.
    """
    if degree < 1 or not table[row, 1] < 0.0:
        return NEVER
    high = min(span, 2.0 * table[row, 0] / -table[row, 1])
    rising = 0.0
    for k in range(degree, 1, -1):
        rising = (rising + k * max(table[row, k], 0.0)) * high
    if table[row, 1] + rising >= 0.0 or value(table, row, degree, high) > 0.0:
        return NEVER
    low, t = 0.0, min(high, table[row, 0] / -table[row, 1])
    for _ in range(MAX_PASSES):
        total, slope = table[row, degree], 0.0
        for k in range(degree - 1, -1, -1):
            slope = slope * t + total
            total = total * t + table[row, k]
        if total > 0.0:
            low = t
        else:
            high = t
        new = t - total / slope
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - t) <= SHARP * high:
            return new
        t = new
    return t


@borrowing
def negative_part(table: Floats, row: int, low: int, order: int, t: float) -> float:
    """Return the negative terms of a polynomial above power `low` at t >= 0, divided by t^`low`.

    A lower bound of the polynomial's later terms: the sum of min(a_k, 0) t^(k - low), k > low, with
    the coefficients in row `row` of `table` up to power `order`. Even and odd powers are summed
    apart, so that neither sum waits for the other.
    """
    square, even, odd, k = t * t, 0.0, 0.0, order
    if (order - low) % 2 == 1:
        odd, k = min(table[row, order], 0.0), order - 1
    while k > low:
        even = (even + min(table[row, k], 0.0)) * square
        odd = odd * square + min(table[row, k - 1], 0.0)
        k -= 2
    return even + odd * t


@borrowing
def safe_step(table: Floats, row: int, degree: int, span: float) -> float:
    """Return a step within which a polynomial that is positive at 0 stays positive.

    The search for the first event of a motion moves on by such steps. The coefficients stand in row
    `row` of `table`, up to power `degree`; the step is at most `span`. A lower bound is a_0 plus
    the negative terms alone, which is concave: Newton's iteration comes to its root from the right,
    and the chord from 0 to any t beyond crosses zero before it, at t a_0/(a_0 - bound(t)).
    """
    first = table[row, 0]
    if first <= 0.0:
        return 0.0
    # No further than where one of the terms alone takes it to zero.
    if degree > 0 and table[row, 1] < 0.0:
        span = min(span, first / -table[row, 1])
    if degree > 1 and table[row, 2] < 0.0:
        span = min(span, math.sqrt(first / -table[row, 2]))
    if first + negative_part(table, row, 0, degree, span) > 0.0:
        return span
    while first + negative_part(table, row, 0, degree, 0.5 * span) <= 0.0:
        span *= 0.5
        if span < 1e-300:
            return 0.0
    right = span
    for _ in range(3):
        total, slope = 0.0, 0.0
        for k in range(degree, 0, -1):
            term = min(table[row, k], 0.0)
            slope = slope * right + total
            total = total * right + term
        slope = slope * right + total
        total = total * right + first
        # `total` is the bound at `right`, not above zero; `slope` is its derivative.
        if slope < 0.0:
            right -= total / slope
    total = first + negative_part(table, row, 0, degree, right)
    return right * first / (first - total) if total < 0.0 else right
