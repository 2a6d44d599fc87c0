"""Power series of a step: values, first roots, and those of a slip in two directions.

The slip of the floor is (u_x, u_y + spin), that of the wall (u_x, u_z). With its direction e, load
L and q = mu_k,

    slip' = D - q L (e_1, r e_2),        e = slip/|slip|,

D the acceleration without friction, r the response across: 1 for a block and 1 + m R^2/I for a
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
    iteration finds it (`root_of_falling`). Row `scratch` is overwritten.
    """
    lowest_power = 0
    while lowest_power < order and table[row, lowest_power] == 0.0:
        lowest_power += 1
    if table[row, lowest_power] < 0.0:
        return 0.0
    if table[row, lowest_power] + negative_part(table, row, lowest_power, order, span) > 0.0:
        return NEVER
    degree = order - lowest_power
    for k in range(degree + 1):
        table[scratch, k] = table[row, k + lowest_power]
    start = 0.0
    for _ in range(MAX_PASSES):
        root = root_of_falling(table, scratch, degree, span - start)
        if root >= 0.0:
            return start + root
        step = safe_step(table, scratch, degree, span - start)
        start += step
        if start >= span:
            return NEVER
        if step <= SHARP * span:
            return start
        for i in range(degree):
            for k in range(degree - 1, i - 1, -1):
                table[scratch, k] += step * table[scratch, k + 1]
        if table[scratch, 0] <= 0.0:
            return start
    return start


@borrowing
def root_of_falling(table: Floats, row: int, degree: int, span: float) -> float:
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
        value_at_t, slope_at_t = table[row, degree], 0.0
        for k in range(degree - 1, -1, -1):
            slope_at_t = slope_at_t * t + value_at_t
            value_at_t = value_at_t * t + table[row, k]
        if value_at_t > 0.0:
            low = t
        else:
            high = t
        next_t = t - value_at_t / slope_at_t
        if not low <= next_t <= high:
            next_t = 0.5 * (low + high)
        if abs(next_t - t) <= SHARP * high:
            return next_t
        t = next_t
    return t


@borrowing
def negative_part(table: Floats, row: int, low: int, order: int, t: float) -> float:
    """Return the negative terms of a polynomial above power `low` at t >= 0, divided by t^`low`."""
    t_squared, even_terms, odd_terms, k = t * t, 0.0, 0.0, order
    if (order - low) % 2 == 1:
        odd_terms, k = min(table[row, order], 0.0), order - 1
    while k > low:
        even_terms = (even_terms + min(table[row, k], 0.0)) * t_squared
        odd_terms = odd_terms * t_squared + min(table[row, k - 1], 0.0)
        k -= 2
    return even_terms + odd_terms * t


@borrowing
def safe_step(table: Floats, row: int, degree: int, span: float) -> float:
    """Return a step within which a polynomial that is positive at 0 stays positive.

    The chord from 0 to any t beyond the root of the bound, which is concave, crosses zero before
    it, at t a_0/(a_0 - bound(t)).
    """
    value_at_0 = table[row, 0]
    if value_at_0 <= 0.0:
        return 0.0
    # No further than where one of the terms alone takes it to zero.
    if degree > 0 and table[row, 1] < 0.0:
        span = min(span, value_at_0 / -table[row, 1])
    if degree > 1 and table[row, 2] < 0.0:
        span = min(span, math.sqrt(value_at_0 / -table[row, 2]))
    if value_at_0 + negative_part(table, row, 0, degree, span) > 0.0:
        return span
    while value_at_0 + negative_part(table, row, 0, degree, 0.5 * span) <= 0.0:
        span *= 0.5
        if span < 1e-300:
            return 0.0
    right = span
    for _ in range(3):
        bound, slope = 0.0, 0.0
        for k in range(degree, 0, -1):
            term = min(table[row, k], 0.0)
            slope = slope * right + bound
            bound = bound * right + term
        slope = slope * right + bound
        bound = bound * right + value_at_0
        # `bound` is the bound at `right`, not above zero; `slope` is its derivative.
        if slope < 0.0:
            right -= bound / slope
    bound = value_at_0 + negative_part(table, row, 0, degree, right)
    return right * value_at_0 / (value_at_0 - bound) if bound < 0.0 else right


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
def subtract_curvature(work: Work, along_k: float, curvature: float, k: int) -> None:
    """Add the effect of the track's curvature to one coefficient of the acceleration across.

    -kappa V^2 with the speed in space V = u_x + v_track; `along_k` is coefficient `k` of u_x
    (theory 13.1).
    """
    work[ROW.extra, k] = along_k + work[ROW.track, k]
    centripetal = curvature * square_of(work, ROW.extra, k)
    remainder = work[ROW.free + 1, k] - centripetal
    # Where an event tells that no force across is left, rounding must not leave one.
    work[ROW.free + 1, k] = 0.0 if abs(remainder) <= NOTHING * abs(centripetal) else remainder


@borrowing
def slide_series(contact: Contact, order: int, work: Work) -> None:
    """Fill the power series of a slip that is not 0 at the start: its components, square and load.

    Its size s comes from s^2 = slip^2, and R = q L/s from R s = q L, coefficient by coefficient up
    to power `order`. Sums run over pairs i + j = k, several at a time, so that each waits for its
    own last term only.
    """
    slip_1, slip_2, pressed = ROW.slip, ROW.slip + 1, ROW.free + contact.pressed
    push_1, push_2 = ROW.free, ROW.free + contact.second
    square, load, size, ratio = ROW.square, ROW.load, ROW.extra + 1, ROW.extra + 2
    is_curved, has_friction = contact.curvature != 0.0, contact.friction > 0.0
    start_1, start_2 = work[slip_1, 0], work[slip_2, 0]
    start = math.sqrt(start_1 * start_1 + start_2 * start_2)
    inverse_start, ratio_start = 1.0 / start, 0.0
    for k in range(order + 1):
        if k == 0:
            work[square, 0], work[size, 0] = start * start, start
        else:
            square_terms, size_terms, ratio_terms = 0.0, 0.0, 0.0
            for i in range(1, (k + 1) // 2):
                j = k - i
                square_terms += (
                    work[slip_1, i] * work[slip_1, j] + work[slip_2, i] * work[slip_2, j]
                )
                size_terms += work[size, i] * work[size, j]
                ratio_terms += work[ratio, i] * work[size, j] + work[ratio, j] * work[size, i]
            square_terms += start_1 * work[slip_1, k] + start_2 * work[slip_2, k]
            square_terms, size_terms = 2.0 * square_terms, 2.0 * size_terms
            if k % 2 == 0:
                i = k // 2
                square_terms += (
                    work[slip_1, i] * work[slip_1, i] + work[slip_2, i] * work[slip_2, i]
                )
                size_terms += work[size, i] * work[size, i]
                ratio_terms += work[ratio, i] * work[size, i]
            work[square, k] = square_terms
            work[size, k] = 0.5 * (square_terms - size_terms) * inverse_start
            work[ratio, k] = ratio_terms + ratio_start * work[size, k]
        if k == order:
            break
        if is_curved:
            subtract_curvature(work, work[slip_1, k], contact.curvature, k)
        work[load, k] = -work[pressed, k]
        friction_1, friction_2 = 0.0, 0.0
        if has_friction:
            known_terms = work[ratio, k] if k > 0 else 0.0
            work[ratio, k] = (contact.friction * work[load, k] - known_terms) * inverse_start
            if k == 0:
                ratio_start = work[ratio, 0]
            else:
                friction_1 = ratio_start * work[slip_1, k]
                friction_2 = ratio_start * work[slip_2, k]
            for i in range(1, (k + 1) // 2):
                j = k - i
                friction_1 += work[ratio, i] * work[slip_1, j] + work[ratio, j] * work[slip_1, i]
                friction_2 += work[ratio, i] * work[slip_2, j] + work[ratio, j] * work[slip_2, i]
            if k > 0 and k % 2 == 0:
                i = k // 2
                friction_1 += work[ratio, i] * work[slip_1, i]
                friction_2 += work[ratio, i] * work[slip_2, i]
            friction_1 += work[ratio, k] * start_1
            friction_2 += work[ratio, k] * start_2
            friction_2 *= contact.response
        work[slip_1, k + 1] = (work[push_1, k] - friction_1) * INVERSE[k + 1]
        work[slip_2, k + 1] = (work[push_2, k] - friction_2) * INVERSE[k + 1]


@borrowing
def stays_in_line(contact: Contact, order: int, work: Work) -> bool:
    """True if a slip keeps its direction, so that its series are simpler: s_1 D_2 = s_2 D_1."""
    first, second = work[ROW.slip, 0], work[ROW.slip + 1, 0]
    if contact.curvature != 0.0 or (contact.response != 1.0 and first * second != 0.0):
        return False
    across = ROW.free + contact.second
    for k in range(order):
        product_1, product_2 = first * work[across, k], second * work[ROW.free, k]
        if abs(product_1 - product_2) > NOTHING * (abs(product_1) + abs(product_2)):
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
        friction = contact.friction * work[load, k]
        work[first, k + 1] = (work[ROW.free, k] - friction * cosine) * INVERSE[k + 1]
        push_2 = work[ROW.free + contact.second, k]
        work[second, k + 1] = (push_2 - contact.response * friction * sine) * INVERSE[k + 1]
        work[size, k + 1] = cosine * work[first, k + 1] + sine * work[second, k + 1]


@borrowing
def onset_series(
    contact: Contact, order: int, cosine: float, sine: float, start_rate: float, work: Work
) -> None:
    """Fill the power series of a slip that begins at 0: components, size and load.

    In polar form, slip = r (cos theta, sin theta), with acceleration D without friction, load L, q
    = mu_k and the contact's response:

        r'       = D_1 cos + D_2 sin - q L (cos^2 + response sin^2)
        r theta' = D_2 cos - D_1 sin - q L (response - 1) sin cos
    """
    first, second = ROW.slip, ROW.slip + 1
    push, across, load = ROW.free, ROW.free + contact.second, ROW.load
    r, turning_rate, c, s = (
        ROW.extra + 1,
        ROW.extra + 2,
        ROW.extra + 3,
        ROW.extra + 4,
    )
    sine_cosine, sine_squared = ROW.extra + 5, ROW.extra + 6  # of cosine and sine, and of the sine
    friction, response_minus_1 = contact.friction, contact.response - 1.0
    work[r, 0], work[c, 0], work[s, 0] = 0.0, cosine, sine
    start_force = 0.0
    for k in range(order + 1):
        work[first, k], work[second, k] = 0.0, 0.0
        for i in range(1, k + 1):
            work[first, k] += work[r, i] * work[c, k - i]
            work[second, k] += work[r, i] * work[s, k - i]
        if k == order:
            break
        if contact.curvature != 0.0:
            subtract_curvature(work, work[first, k], contact.curvature, k)
        work[load, k] = -work[ROW.free + contact.pressed, k]
        if k == 0:
            start_force = work[push, 0] * cosine + work[across, 0] * sine
            start_force += (
                response_minus_1 * friction * work[load, 0] * (cosine - sine) * (cosine + sine)
            )
        else:
            work[c, k], work[s, k] = 0.0, 0.0
            for j in range(k - 1):
                work[c, k] -= work[turning_rate, j] * work[s, k - 1 - j] * INVERSE[k]
                work[s, k] += work[turning_rate, j] * work[c, k - 1 - j] * INVERSE[k]
            remainder = product(work, across, c, k) - product(work, push, s, k)
            if response_minus_1 != 0.0:
                work[sine_cosine, k] = product(work, c, s, k)
                remainder -= response_minus_1 * friction * product(work, load, sine_cosine, k)
            for i in range(2, k + 1):
                remainder -= work[r, i] * work[turning_rate, k - i]
            angle = remainder / (start_force + k * start_rate)
            work[turning_rate, k - 1] = k * angle
            work[c, k] -= angle * sine
            work[s, k] += angle * cosine
        growth = product(work, push, c, k) + product(work, across, s, k) - friction * work[load, k]
        if response_minus_1 != 0.0:
            work[sine_cosine, k], work[sine_squared, k] = (
                product(work, c, s, k),
                product(work, s, s, k),
            )
            growth -= response_minus_1 * friction * product(work, load, sine_squared, k)
        work[r, k + 1] = start_rate if k == 0 else growth * INVERSE[k + 1]
    for k in range(order + 1):
        work[ROW.square, k] = work[r, k]


@borrowing
def straight_series(
    contact: Contact, cosine: float, sine: float, size: float, rate: float, work: Work
) -> None:
    """Fill the power series of the last piece of a slip: a straight line to its end.

    Slip = (size - rate t) e at t rad after its start, e = (`cosine`, `sine`). The piece has the
    order 1: no further terms are read.
    """
    work[ROW.slip, 0], work[ROW.slip + 1, 0] = size * cosine, size * sine
    work[ROW.slip, 1], work[ROW.slip + 1, 1] = -rate * cosine, -rate * sine
    if contact.curvature != 0.0:
        subtract_curvature(work, work[ROW.slip, 0], contact.curvature, 0)
    work[ROW.load, 0] = -work[ROW.free + contact.pressed, 0]


@borrowing
def fill_velocities(contact: Contact, order: int, velocity_2: float, work: Work) -> None:
    """Fill the power series of the part's velocities along both axes of a slipping contact.

    Along the second axis u_2' = (slip_2' + (r - 1) D_2)/r, with r = 1 + m R^2/I of a cylinder.
    """
    response = contact.response
    along, second_axis = ROW.velocity, ROW.velocity + contact.second
    work[second_axis, 0] = velocity_2
    for k in range(order + 1):
        work[along, k] = work[ROW.slip, k]
        if k > 0:
            velocity_gain = work[ROW.free + contact.second, k - 1] * INVERSE[k]
            work[second_axis, k] = work[ROW.slip + 1, k]
            if response != 1.0:
                work[second_axis, k] = (
                    work[ROW.slip + 1, k] + (response - 1.0) * velocity_gain
                ) / response


@borrowing
def asymptotic_span(order: int, work: Work) -> float:
    """Return the phase in rad within which an asymptotic power series of the slip is accurate.

    0.7 min |a_k|/|a_(k+1)| over the last half of its terms a_k.
    """
    span = math.inf
    for k in range(order // 2, order):
        term = abs(work[ROW.slip, k]) + abs(work[ROW.slip + 1, k])
        next_term = abs(work[ROW.slip, k + 1]) + abs(work[ROW.slip + 1, k + 1])
        if term > 0.0 and next_term > 0.0:
            span = min(span, 0.7 * term / next_term)
    return span
