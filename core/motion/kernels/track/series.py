"""Power series of a step: values, first roots, and those of a slip in two directions.

The slip of the floor is (u_x, u_y + spin), that of the wall (u_x, u_z). With its direction e, load
L and q = mu_k,

    slip' = D - q L (e_1, r e_2),        e = slip/|slip|,

D the acceleration without friction, r the response across: 1 for a block and 1 + m r^2/I for a
cylinder (theory 13.13). Each series is a row of a table: a view would cost more than its values.
"""

import math
from typing import NamedTuple

from vibrafeed.core.compiled import borrowing
from vibrafeed.core.motion.kernels.inputs import Floats
from vibrafeed.core.motion.kernels.track.push import INVERSE, ROW, Work

MAX_PASSES = 200
"""Most passes of a search: halving alone ends after 53, and a step that gains less is at a root up
to rounding."""
NEVER = -1.0  # in the place of a root: there is none
SHARP = 1e-15
"""Share of the span to which a root is known."""


@borrowing
def value(table: Floats, row: int, order: int, t: float) -> float:
    """Return the value of a polynomial at `t` by Horner's scheme, a_0 + t (a_1 + t (a_2 + ...))."""
    total = table[row, order]
    for k in range(order - 1, -1, -1):
        total = total * t + table[row, k]
    return total


@borrowing
def first_fall(table: Floats, row: int, order: int, span: float, scratch: int) -> float:
    """Return the first t in [0, span] at which a polynomial falls through 0; `NEVER` (-1) if none.

    The negative terms alone bound the polynomial P from below: up to where P(0) + `negative_part`
    is 0, P has no root. P is shifted there (`safe_step`); near a root that P crosses, Newton's
    iteration finds it (`near_fall`). Row `scratch` is overwritten.
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

    It falls all the way if a_1 + sum of k max(a_k, 0) t^(k-1) < 0 up to twice the root of the
    tangent. Newton's iteration within a bracket.
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
    """Return the negative terms of a polynomial above power `low` at t >= 0, divided by t^`low`."""
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

    The chord from 0 to any t beyond the root of the bound, which is concave, crosses zero before
    it, at t a_0/(a_0 - bound(t)).
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


NOTHING = 1e-15
"""Share of two forces that cancel, below which what is left is rounding."""


class Contact(NamedTuple):
    """The contact that slips.

    `second` is the axis of the slip's second component: 1 (across) at the floor, 2 (normal) at the
    wall; `pressed` that along which it is pressed on. `response` is that of the second component to
    friction, 1 + m r^2/I of a cylinder, else 1; `curvature` g/(w^2 R) acts on axis 1.
    """

    second: int
    pressed: int
    friction: float
    response: float
    curvature: float


@borrowing
def product(work: Work, a: int, b: int, k: int) -> float:
    """Return the coefficient of power k of the product of two power series, sum of a_i b_(k-i)."""
    total = 0.0
    for i in range(k + 1):
        total += work[a, i] * work[b, k - i]
    return total


@borrowing
def square_of(work: Work, a: int, k: int) -> float:
    """Return the coefficient of power k of the square of a power series, sum of a_i a_(k-i)."""
    total, half = 0.0, (k + 1) // 2
    for i in range(half):
        total += work[a, i] * work[a, k - i]
    return 2.0 * total if k % 2 else 2.0 * total + work[a, half] * work[a, half]


@borrowing
def bend(work: Work, along: float, curvature: float, k: int) -> None:
    """Add the effect of the track's curvature to one coefficient of the acceleration across.

    -kappa V^2 with the speed in space V = u_x + v_track; `along` is coefficient `k` of u_x (theory
    13.1).
    """
    work[ROW.extra, k] = along + work[ROW.track, k]
    turn = curvature * square_of(work, ROW.extra, k)
    rest = work[ROW.free + 1, k] - turn
    # Where an event tells that no force across is left, rounding must not leave one.
    work[ROW.free + 1, k] = 0.0 if abs(rest) <= NOTHING * abs(turn) else rest


@borrowing
def slide_series(contact: Contact, order: int, work: Work) -> None:
    """Fill the power series of a slip that is not 0 at the start: its components, square and load.

    Its size s comes from s^2 = slip^2, and R = q L/s from R s = q L, coefficient by coefficient up
    to power `order`. Sums run over pairs i + j = k, several at a time, so that each waits for its
    own last term only.
    """
    first, second, pressed = ROW.slip, ROW.slip + 1, ROW.free + contact.pressed
    push, across = ROW.free, ROW.free + contact.second
    square, load, size, rub = ROW.square, ROW.load, ROW.extra + 1, ROW.extra + 2
    curved, rubs = contact.curvature != 0.0, contact.friction > 0.0
    start_1, start_2 = work[first, 0], work[second, 0]
    start = math.sqrt(start_1 * start_1 + start_2 * start_2)
    per_start, rub_start = 1.0 / start, 0.0
    for k in range(order + 1):
        if k == 0:
            work[square, 0], work[size, 0] = start * start, start
        else:
            squares, both, rubbed = 0.0, 0.0, 0.0
            for i in range(1, (k + 1) // 2):
                j = k - i
                squares += work[first, i] * work[first, j] + work[second, i] * work[second, j]
                both += work[size, i] * work[size, j]
                rubbed += work[rub, i] * work[size, j] + work[rub, j] * work[size, i]
            squares += start_1 * work[first, k] + start_2 * work[second, k]
            squares, both = 2.0 * squares, 2.0 * both
            if k % 2 == 0:
                i = k // 2
                squares += work[first, i] * work[first, i] + work[second, i] * work[second, i]
                both += work[size, i] * work[size, i]
                rubbed += work[rub, i] * work[size, i]
            work[square, k] = squares
            work[size, k] = 0.5 * (squares - both) * per_start
            work[rub, k] = rubbed + rub_start * work[size, k]
        if k == order:
            break
        if curved:
            bend(work, work[first, k], contact.curvature, k)
        work[load, k] = -work[pressed, k]
        friction_1, friction_2 = 0.0, 0.0
        if rubs:
            less = work[rub, k] if k > 0 else 0.0
            work[rub, k] = (contact.friction * work[load, k] - less) * per_start
            if k == 0:
                rub_start = work[rub, 0]
            else:
                friction_1 = rub_start * work[first, k]
                friction_2 = rub_start * work[second, k]
            for i in range(1, (k + 1) // 2):
                j = k - i
                friction_1 += work[rub, i] * work[first, j] + work[rub, j] * work[first, i]
                friction_2 += work[rub, i] * work[second, j] + work[rub, j] * work[second, i]
            if k > 0 and k % 2 == 0:
                i = k // 2
                friction_1 += work[rub, i] * work[first, i]
                friction_2 += work[rub, i] * work[second, i]
            friction_1 += work[rub, k] * start_1
            friction_2 += work[rub, k] * start_2
            friction_2 *= contact.response
        work[first, k + 1] = (work[push, k] - friction_1) * INVERSE[k + 1]
        work[second, k + 1] = (work[across, k] - friction_2) * INVERSE[k + 1]


@borrowing
def stays_in_line(contact: Contact, order: int, work: Work) -> bool:
    """True if a slip keeps its direction, so that its series are simpler: s_1 D_2 = s_2 D_1."""
    first, second = work[ROW.slip, 0], work[ROW.slip + 1, 0]
    if contact.curvature != 0.0 or (contact.response != 1.0 and first * second != 0.0):
        return False
    across = ROW.free + contact.second
    for k in range(order):
        one, other = first * work[across, k], second * work[ROW.free, k]
        if abs(one - other) > NOTHING * (abs(one) + abs(other)):
            return False
    return True


@borrowing
def line_series(contact: Contact, order: int, work: Work) -> None:
    """Fill the power series of a slip with a constant direction: components, size and load."""
    first, second, size, load = ROW.slip, ROW.slip + 1, ROW.square, ROW.load
    start_1, start_2 = work[first, 0], work[second, 0]
    work[size, 0] = math.sqrt(start_1 * start_1 + start_2 * start_2)
    cosine, sine = start_1 / work[size, 0], start_2 / work[size, 0]
    for k in range(order + 1):
        work[load, k] = -work[ROW.free + contact.pressed, k]
        if k == order:
            break
        rub = contact.friction * work[load, k]
        work[first, k + 1] = (work[ROW.free, k] - rub * cosine) * INVERSE[k + 1]
        pushed = work[ROW.free + contact.second, k]
        work[second, k + 1] = (pushed - contact.response * rub * sine) * INVERSE[k + 1]
        work[size, k + 1] = cosine * work[first, k + 1] + sine * work[second, k + 1]


@borrowing
def onset_series(
    contact: Contact, order: int, cosine: float, sine: float, start: float, work: Work
) -> None:
    """Fill the power series of a slip that begins at 0: components, size and load.

    In polar form, slip = r (cos theta, sin theta), with acceleration D without friction, load L, q
    = mu_k and the contact's response:

        r'       = D_1 cos + D_2 sin - q L (cos^2 + response sin^2)
        r theta' = D_2 cos - D_1 sin - q L (response - 1) sin cos
    """
    first, second = ROW.slip, ROW.slip + 1
    push, across, load = ROW.free, ROW.free + contact.second, ROW.load
    r, turn, c, s = (
        ROW.extra + 1,
        ROW.extra + 2,
        ROW.extra + 3,
        ROW.extra + 4,
    )
    cross, squared = ROW.extra + 5, ROW.extra + 6  # of cosine and sine, and of the sine
    q, uneven = contact.friction, contact.response - 1.0
    work[r, 0], work[c, 0], work[s, 0] = 0.0, cosine, sine
    pull = 0.0
    for k in range(order + 1):
        work[first, k], work[second, k] = 0.0, 0.0
        for i in range(1, k + 1):
            work[first, k] += work[r, i] * work[c, k - i]
            work[second, k] += work[r, i] * work[s, k - i]
        if k == order:
            break
        if contact.curvature != 0.0:
            bend(work, work[first, k], contact.curvature, k)
        work[load, k] = -work[ROW.free + contact.pressed, k]
        if k == 0:
            pull = work[push, 0] * cosine + work[across, 0] * sine
            pull += uneven * q * work[load, 0] * (cosine - sine) * (cosine + sine)
        else:
            work[c, k], work[s, k] = 0.0, 0.0
            for j in range(k - 1):
                work[c, k] -= work[turn, j] * work[s, k - 1 - j] * INVERSE[k]
                work[s, k] += work[turn, j] * work[c, k - 1 - j] * INVERSE[k]
            rest = product(work, across, c, k) - product(work, push, s, k)
            if uneven != 0.0:
                work[cross, k] = product(work, c, s, k)
                rest -= uneven * q * product(work, load, cross, k)
            for i in range(2, k + 1):
                rest -= work[r, i] * work[turn, k - i]
            angle = rest / (pull + k * start)
            work[turn, k - 1] = k * angle
            work[c, k] -= angle * sine
            work[s, k] += angle * cosine
        growth = product(work, push, c, k) + product(work, across, s, k) - q * work[load, k]
        if uneven != 0.0:
            work[cross, k], work[squared, k] = product(work, c, s, k), product(work, s, s, k)
            growth -= uneven * q * product(work, load, squared, k)
        work[r, k + 1] = start if k == 0 else growth * INVERSE[k + 1]
    for k in range(order + 1):
        work[ROW.square, k] = work[r, k]


@borrowing
def last_of_slip(
    contact: Contact, cosine: float, sine: float, size: float, rate: float, work: Work
) -> None:
    """Fill the power series of the last piece of a slip: a straight line to its end.

    Slip = (size - rate D) e.
    """
    work[ROW.slip, 0], work[ROW.slip + 1, 0] = size * cosine, size * sine
    work[ROW.slip, 1], work[ROW.slip + 1, 1] = -rate * cosine, -rate * sine
    if contact.curvature != 0.0:
        bend(work, work[ROW.slip, 0], contact.curvature, 0)
    work[ROW.load, 0] = -work[ROW.free + contact.pressed, 0]


@borrowing
def fill_velocities(contact: Contact, order: int, velocity_2: float, work: Work) -> None:
    """Fill the power series of the part's velocities along both axes of a slipping contact.

    Along the second axis u_2' = (slip_2' + (r - 1) D_2)/r, with r = 1 + m r^2/I of a cylinder.
    """
    response = contact.response
    along, other = ROW.velocity, ROW.velocity + contact.second
    work[other, 0] = velocity_2
    for k in range(order + 1):
        work[along, k] = work[ROW.slip, k]
        if k > 0:
            pushed = work[ROW.free + contact.second, k - 1] * INVERSE[k]
            work[other, k] = work[ROW.slip + 1, k]
            if response != 1.0:
                work[other, k] = (work[ROW.slip + 1, k] + (response - 1.0) * pushed) / response


@borrowing
def asymptotic_span(order: int, work: Work) -> float:
    """Return the phase in rad within which an asymptotic power series of the slip is accurate.

    0.7 min |a_k|/|a_(k+1)| over the last half of its terms a_k.
    """
    span = math.inf
    for k in range(order // 2, order):
        now = abs(work[ROW.slip, k]) + abs(work[ROW.slip + 1, k])
        after = abs(work[ROW.slip, k + 1]) + abs(work[ROW.slip + 1, k + 1])
        if now > 0.0 and after > 0.0:
            span = min(span, 0.7 * now / after)
    return span
