"""The series of a contact that slips in two directions (theory 13.13).

The contact is the floor's, whose slip is (u_x, u_y + spin), or the wall's, with (u_x, u_z). With
the direction e of the slip, its load L and q = mu_k,

    slip' = D - q L (e_1, r e_2),        e = slip/|slip|,

where D is the acceleration without friction and r the response of the contact to friction across,
1 for a block and 1 + m r^2/I for a cylinder. A curve adds -kappa V^2 to the acceleration across,
and as much to the load of the wall, with V = u_x + the track's own velocity.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from core.compiled import compiled
from core.motion.kernels.arrays import Floats
from core.motion.kernels.track.tables import Work

NOTHING = 1e-15
"""Of two forces that cancel: what is left is rounding."""


class Contact(NamedTuple):
    """What the contact that slips is.

    Attributes
    ----------
    second : int
        Axis of the slip's second component: 1 at the floor, 2 at the wall.
    pressed : int
        Axis along which it is pressed on: 2 at the floor, 1 at the wall.
    friction : float
        Kinetic.
    response : float
        Of the second component to friction.
    curvature : float
        Curvature number; it acts on axis 1.
    """

    second: int
    pressed: int
    friction: float
    response: float
    curvature: float


@compiled
def product(a: Floats, b: Floats, k: int) -> float:
    """Return the coefficient k of a product of two series."""
    total = 0.0
    for i in range(k + 1):
        total += a[i] * b[k - i]
    return total


@compiled
def products(a: Floats, b: Floats, c: Floats, k: int) -> tuple[float, float]:
    """Return the coefficients k of a b and of a c."""
    first, second = 0.0, 0.0
    for i in range(k + 1):
        first += a[i] * b[k - i]
        second += a[i] * c[k - i]
    return first, second


@compiled
def squares(a: Floats, b: Floats, k: int) -> tuple[float, float]:
    """Return the coefficients k of the squares of two series."""
    first, second, half = 0.0, 0.0, (k + 1) // 2
    for i in range(half):
        first += a[i] * a[k - i]
        second += b[i] * b[k - i]
    if k % 2:
        return 2.0 * first, 2.0 * second
    return 2.0 * first + a[half] * a[half], 2.0 * second + b[half] * b[half]


@compiled
def bend(work: Work, along: float, curvature: float, k: int) -> None:
    """Add what the curve does, to order k, with the coefficient k of the velocity along."""
    if curvature != 0.0:
        speed = work.extra[0]
        speed[k] = along + work.track[k]
        turn = curvature * product(speed, speed, k)
        rest = work.free[1, k] - turn
        # Where an event tells that no force across is left, rounding must not leave one.
        work.free[1, k] = 0.0 if abs(rest) <= NOTHING * abs(turn) else rest


@compiled
def slide_series(contact: Contact, order: int, work: Work) -> None:
    """Fill slip, its square and the load, from the slip at the start, which must not be 0."""
    first, second = work.slip[0], work.slip[1]
    push, across = work.free[0], work.free[contact.second]
    square, load, size, rub = work.square, work.load, work.extra[1], work.extra[2]
    rubs = contact.friction > 0.0
    for k in range(order + 1):
        square_1, square_2 = squares(first, second, k)
        square[k] = square_1 + square_2
        if k == order:
            break
        bend(work, first[k], contact.curvature, k)
        load[k] = -work.free[contact.pressed, k]
        friction_1, friction_2 = 0.0, 0.0
        if rubs:
            # The power -1/2 of the square, and friction per mass over slip.
            if k == 0:
                size[0] = 1.0 / math.sqrt(square[0])
            else:
                total, rising = 0.0, 0.0
                for j in range(k):
                    term = square[k - j] * size[j]
                    total += term
                    rising += j * term
                size[k] = -0.5 * (k * total + rising) / (k * square[0])
            rub[k] = contact.friction * product(load, size, k)
            friction_1, friction_2 = products(rub, first, second, k)
            friction_2 *= contact.response
        first[k + 1] = (push[k] - friction_1) / (k + 1)
        second[k + 1] = (across[k] - friction_2) / (k + 1)


@compiled
def onset_series(
    contact: Contact, order: int, cosine: float, sine: float, start: float, work: Work
) -> None:
    """Fill slip and load of a slip that begins with no size in a direction (cosine, sine).

    In polar form, slip = r (cos theta, sin theta), where theta' has a factor 1/r:

        r'       = D_1 cos + D_2 sin - q L (cos^2 + response sin^2)
        r theta' = D_2 cos - D_1 sin - q L (response - 1) sin cos

    `start` is r' at the start: 0 where static friction is no larger than kinetic. The series of
    theta is a formal one then: good within its smallest term.
    """
    first, second = work.slip[0], work.slip[1]
    push, across, load = work.free[0], work.free[contact.second], work.load
    r, turn, c, s = work.extra[1], work.extra[2], work.extra[3], work.extra[4]
    cross, squared = work.extra[5], work.extra[6]  # of cosine and sine, and of the sine
    q, uneven = contact.friction, contact.response - 1.0
    r[0], c[0], s[0] = 0.0, cosine, sine
    pull = 0.0
    for k in range(order + 1):
        first[k], second[k] = 0.0, 0.0
        for i in range(1, k + 1):
            first[k] += r[i] * c[k - i]
            second[k] += r[i] * s[k - i]
        if k == order:
            break
        bend(work, first[k], contact.curvature, k)
        load[k] = -work.free[contact.pressed, k]
        if k == 0:
            pull = push[0] * cosine + across[0] * sine
            pull += uneven * q * load[0] * (cosine - sine) * (cosine + sine)
        else:
            c[k], s[k] = 0.0, 0.0
            for j in range(k - 1):
                c[k] -= turn[j] * s[k - 1 - j] / k
                s[k] += turn[j] * c[k - 1 - j] / k
            rest = product(across, c, k) - product(push, s, k)
            if uneven != 0.0:
                cross[k] = product(c, s, k)
                rest -= uneven * q * product(load, cross, k)
            for i in range(2, k + 1):
                rest -= r[i] * turn[k - i]
            angle = rest / (pull + k * start)
            turn[k - 1] = k * angle
            c[k] -= angle * sine
            s[k] += angle * cosine
        growth = product(push, c, k) + product(across, s, k) - q * load[k]
        if uneven != 0.0:
            cross[k], squared[k] = product(c, s, k), product(s, s, k)
            growth -= uneven * q * product(load, squared, k)
        r[k + 1] = start if k == 0 else growth / (k + 1)
    work.square[: order + 1] = r[: order + 1]


@compiled
def last_of_slip(
    contact: Contact, cosine: float, sine: float, size: float, rate: float, work: Work
) -> None:
    """Fill the slip of size `size` as a straight line to its end."""
    work.slip[0, 0], work.slip[1, 0] = size * cosine, size * sine
    work.slip[0, 1], work.slip[1, 1] = -rate * cosine, -rate * sine
    bend(work, work.slip[0, 0], contact.curvature, 0)
    work.load[0] = -work.free[contact.pressed, 0]


@compiled
def fill_velocities(contact: Contact, order: int, velocity_2: float, work: Work) -> None:
    """Fill the velocities of the part along the axes of the slip, from slip and acceleration.

    Friction acts on the slip of a cylinder `response` times as much as on its velocity.
    """
    response = contact.response
    along, other = work.velocity[0], work.velocity[contact.second]
    other[0] = velocity_2
    for k in range(order + 1):
        along[k] = work.slip[0, k]
        if k > 0:
            pushed = work.free[contact.second, k - 1] / k
            other[k] = work.slip[1, k]
            if response != 1.0:
                other[k] = (work.slip[1, k] + (response - 1.0) * pushed) / response


@compiled
def asymptotic_span(order: int, work: Work) -> float:
    """Return how far a formal series is good: its terms must fall to the last."""
    span = math.inf
    for k in range(order // 2, order):
        now = abs(work.slip[0, k]) + abs(work.slip[1, k])
        after = abs(work.slip[0, k + 1]) + abs(work.slip[1, k + 1])
        if now > 0.0 and after > 0.0:
            span = min(span, 0.7 * now / after)
    return span
