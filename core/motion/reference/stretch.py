"""A stretch of phase in one mode of contact: its smooth equation solved, all of it a polynomial.

The rates of change are polynomials that fulfil the equation at Gauss's nodes (collocation). What
the rates depend on is found by Newton's iteration: of a slip its size and its angle,

    size' = pull(size, angle),    size angle' = turn(size, angle),

which has one smooth solution through a start at size 0, too: there the slip follows the push.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev, legendre

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.method import Numbers
from vibrafeed.core.motion.reference.laws import SPIN, UX, Mode, ReferenceLaws

# --- polynomials: a stretch is the interval 0 to 1, coefficients belong to T_k(2 s - 1)

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


def values(coefficients: Array, point: float) -> Array:
    """Return the values of one or several polynomials at a point from 0 to 1.

    `coefficients` are those of Chebyshev polynomials, shape (..., TERMS).
    """
    angle = math.acos(min(1.0, max(-1.0, 2.0 * point - 1.0)))
    return coefficients @ np.cos(angle * _DEGREES)


def crossings(coefficients: Array) -> Iterator[tuple[float, int]]:
    """Yield the roots of a polynomial in order, from 0 to 1, each with 1 (rising) or -1 (falling).

    `coefficients` are those of its Chebyshev polynomials on [0, 1]. The stretch is cut into halves
    until they prove that the polynomial keeps its sign there (the first is larger than all others
    together), or that its derivative does: then the signs at the ends tell of the one root. Only a
    pair of roots can be missed between which the polynomial is 0 up to rounding.
    """
    was_positive: bool | None = None
    stack = [(0.0, 1.0, coefficients)]
    while stack:
        start, width, series = stack.pop()
        first, other_terms = float(series[0]), float(np.abs(series[1:]).sum())
        if abs(first) + other_terms < NOISE:
            continue
        if abs(first) > other_terms:
            if was_positive is not None and was_positive != (first > 0.0):
                yield start, 1 if first > 0.0 else -1
            was_positive = first > 0.0
            continue
        slope = SLOPE @ series
        monotone = abs(slope[0]) > np.abs(slope[1:]).sum()
        if not monotone and width > NARROWEST:
            stack += [
                (start + 0.5 * width, 0.5 * width, HALVES[1] @ series),
                (start, 0.5 * width, HALVES[0] @ series),
            ]
            continue
        value_at_start, value_at_end = (
            float(series[::2].sum() - series[1::2].sum()),
            float(series.sum()),
        )
        if value_at_start != 0.0:
            if was_positive is not None and was_positive != (value_at_start > 0.0):
                yield start, 1 if value_at_start > 0.0 else -1
            was_positive = value_at_start > 0.0
        if value_at_end == 0.0:
            continue
        is_positive = value_at_end > 0.0
        if was_positive is not None and was_positive != is_positive:
            root = (
                start + width * _root(series, slope, value_at_start, value_at_end)
                if value_at_start * value_at_end < 0.0
                else start
            )
            yield root, 1 if is_positive else -1
        was_positive = is_positive


def first_fall(coefficients: Array) -> float:
    """Return the first point, from 0 to 1, at which a polynomial falls through 0; else infinity."""
    return next((root for root, sense in crossings(coefficients) if sense < 0), math.inf)


def fall_from_start(condition: Array) -> float:
    """Return the point, from 0 to 1, at which a condition first falls through 0; else infinity.

    `condition` holds Chebyshev coefficients over a stretch. One that is 0 at the start but for
    rounding, and below it at the end, has fallen at the start.
    """
    root = first_fall(condition)
    return 0.0 if root > 1.0 and condition.sum() < -GRAZES else root


def _root(series: Array, slope: Array, value_at_0: float, value_at_1: float) -> float:
    # The root between 0 and 1 of a Chebyshev series, its values there `low` and `high`, of opposite
    # sign: Newton's method, and bisection where a step leaves the bracket.
    low, high = 0.0, 1.0
    point = value_at_0 / (value_at_0 - value_at_1)
    for _ in range(100):
        value = float(values(series, point))
        if (value > 0.0) == (value_at_0 > 0.0):
            low = point
        else:
            high = point
        next_point = point - value / float(values(slope, point))
        if not low < next_point < high:
            next_point = 0.5 * (low + high)
        if abs(next_point - point) <= 1e-16 or value == 0.0:
            return next_point if value else point
        point = next_point
    return point


# --- the equation on a stretch

STRAIGHT = 1e-14
"""A slip that is turned by no more than this, in g, does not turn."""

SMALL = 1e-7
"""Step of the differences that give the slopes of Newton's iteration; enough for its last step."""


ROOT_TOLERANCE = 1e-10
"""A last step of Newton's iteration below this, in g/w, leaves nothing but rounding."""

MAX_STEPS = 15
"""Most steps of Newton's iteration, which squares the error: if it takes more the stretch is
cut."""

LAST = FROM_NODES[NODES - 2 : NODES]
UNIT = np.eye(NODES)


@dataclass(frozen=True)
class Care:
    """The accuracy settings with which a part is followed.

    Attributes
    ----------
    tail : float
        What the last coefficients of a slip's change may be, in g/w.
    longest : float
        Stretch of phase.
    closing : float
        A slip that turns, smaller than this in g/w, is followed to its stop along a straight line.
    hop : float
        Rebound times the duration of all hops left, below which a run of hops ends.
    """

    tail: float
    longest: float
    closing: float
    hop: float


USUAL = Care(tail=1e-12, longest=1.0, closing=1e-7, hop=1e-15)
FINER = Care(tail=1e-13, longest=0.45, closing=3e-8, hop=1e-16)


class Slip(NamedTuple):
    """A slip at the nodes of a stretch: size in g/w, its rate in g, and direction.

    `tail` is the size of the last terms of its series, in g/w.
    """

    size: Numbers
    rate: Numbers
    e: tuple[Numbers, Numbers]
    tail: float


@dataclass
class Stretch:
    """The motion of a part over a stretch of phase without an event, as polynomials.

    Attributes
    ----------
    start, length
        Phase at the start and duration, in rad.
    states
        Chebyshev coefficients of the state, shape (7, TERMS).
    rates
        Those of the rates of velocities and spin, shape (4, TERMS).
    size, growth
        Those of the size of the slip and of its rate, shape (TERMS,); 0 without slip.
    normal, side
        Those of the forces of floor and wall, shape (TERMS,).
    tail
        Size of the last coefficients in g/w: what more nodes would have changed, and more.
    """

    start: float
    length: float
    states: Array
    rates: Array
    size: Array
    growth: Array
    normal: Array
    side: Array
    tail: float = 0.0

    def state(self, at: float) -> Array:
        """Return the state at a point from 0 to 1."""
        return values(self.states, at)

    def sample(self, phases: Array, end: float, rows: Array) -> None:
        """Fill the states at those of the asked phases that lie within it, up to phase `end`.

        `rows` has a state, shape (7,), for each of the `phases`.
        """
        for k in np.nonzero((phases > self.start) & (phases <= end))[0]:
            rows[k] = self.state((phases[k] - self.start) / self.length)


def solve(
    laws: ReferenceLaws, mode: Mode, state: Array, start: float, length: float, begins: bool
) -> Stretch | None:
    """Return the motion of a part over a stretch of phase in one contact mode, as polynomials.

    By collocation at Gauss's nodes; None if the iteration for a slip fails. `laws` gives the
    forces, `mode` says which contacts carry the part and if they slip, `state` (7 numbers) is that
    at the phase `start` in rad; the stretch lasts `length` rad; `begins` is True if a slip starts
    from rest.
    """
    phases = start + length * AT
    slip: Slip | None = Slip(np.zeros(NODES), np.zeros(NODES), (0.0, 0.0), 0.0)
    ux = np.zeros(NODES)  # of a part that sticks
    if not (mode.floor or mode.wall):  # it speeds up whatever its speed
        ux = state[UX] + length * (NODES_INTEGRAL @ laws.free(phases, 0.0)[0])
    elif mode.slips:
        slip = _slip(laws, mode, state, phases, length, begins)
        ux = slip.size * slip.e[0] if slip else ux
    if slip is None:
        return None
    forces = laws.forces(phases, mode, ux, slip.e)
    at_nodes = np.empty((6, NODES))
    for row, value in enumerate((*forces.rates, forces.normal, forces.side)):
        at_nodes[row] = value
    coefficients = at_nodes @ FROM_NODES.T
    states = np.zeros((7, TERMS))
    states[UX:] = length * (coefficients[:4] @ INTEGRAL.T)
    states[UX:, 0] += state[UX:]
    states[:UX] = length * (states[UX:SPIN] @ INTEGRAL.T)
    states[:UX, 0] += state[:UX]
    return Stretch(
        start,
        length,
        states,
        coefficients[:4],
        FROM_NODES @ slip.size,
        FROM_NODES @ slip.rate,
        coefficients[4],
        coefficients[5],
        slip.tail,
    )


def _slip(
    laws: ReferenceLaws, mode: Mode, state: Array, phases: Array, length: float, begins: bool
) -> Slip | None:
    # The slip at the nodes: along a straight line where its direction does not change, else with
    # first guesses of its rate and turning for `_turning`. None if no iteration converges.
    first, second = laws.slip(mode, state)
    size = math.hypot(first, second)
    if begins:
        first, second = laws.onset_direction(phases[0] - length * AT[0], mode)
    angle = math.atan2(second, first)
    pull, turning = laws.sliding(phases, mode, np.full(NODES, size), angle)
    pull = pull + np.zeros(NODES)
    if np.abs(turning).max() < STRAIGHT:
        return _straight(laws, mode, phases, length, (size, angle), pull)
    if begins:  # it follows the push
        directions = [laws.onset_direction(phase, mode) for phase in phases.tolist()]
        angle_changes = np.array([
            math.remainder(math.atan2(b, a) - angle, 2.0 * math.pi) for a, b in directions
        ])  # fmt: skip
        angle_rate = NODES_SLOPE @ angle_changes / length
        pull = laws.sliding(phases, mode, np.zeros(NODES), angle + angle_changes)[0]
    else:
        angle_rate = np.clip(turning / size, -0.5 / length, 0.5 / length)
    return _turning(laws, mode, phases, length, (size, angle), pull, angle_rate)


def _straight(
    laws: ReferenceLaws,
    mode: Mode,
    phases: Array,
    length: float,
    start: tuple[float, float],
    rate: Array,
) -> Slip | None:
    # A slip of constant direction: size' = pull(size) at the nodes by Newton's method, size =
    # first_size + integral of the rate. None if it does not converge.
    first_size, angle = start
    integral = length * NODES_INTEGRAL
    size = first_size + integral @ rate
    for _ in range(MAX_STEPS):
        if laws.groups.curvature_number == 0.0:  # the forces do not depend on the speed
            break
        pull, _ = laws.sliding(phases, mode, np.stack([size, size + SMALL]), angle)
        slope = (pull[1] - pull[0]) / SMALL
        step = np.linalg.solve(np.eye(NODES) - slope[:, None] * integral, rate - pull[0])
        rate = rate - step
        size = first_size + integral @ rate
        if length * np.abs(step).max() < ROOT_TOLERANCE:
            break
    else:
        return None
    direction = math.cos(angle), math.sin(angle)
    direction = (
        (math.copysign(1.0, direction[0]), 0.0) if abs(direction[1]) < STRAIGHT else direction
    )
    return Slip(size, rate, direction, length * float(np.abs(LAST @ rate).max()))


def _turning(
    laws: ReferenceLaws,
    mode: Mode,
    phases: Array,
    length: float,
    start: tuple[float, float],
    rate: Array,
    angle_rate: Array,
) -> Slip | None:
    # Newton's method for rate and angle_rate at all nodes at once: residuals rate - pull and size
    # angle_rate - turn, whose Jacobian has a block for each. None if it does not converge.
    first_size, first_angle = start
    integral = length * NODES_INTEGRAL
    jacobian = np.zeros((2 * NODES, 2 * NODES))
    for _ in range(MAX_STEPS):
        size, angle = first_size + integral @ rate, first_angle + integral @ angle_rate
        pull, turn = laws.sliding(
            phases,
            mode,
            np.array([size, size + SMALL, size]),
            np.array([angle, angle, angle + SMALL]),
        )
        pull_slopes, turn_slopes = (pull[1:] - pull[0]) / SMALL, (turn[1:] - turn[0]) / SMALL
        jacobian[:NODES, :NODES] = UNIT - pull_slopes[0][:, None] * integral
        jacobian[:NODES, NODES:] = -pull_slopes[1][:, None] * integral
        jacobian[NODES:, :NODES] = (angle_rate - turn_slopes[0])[:, None] * integral
        jacobian[NODES:, NODES:] = size[:, None] * UNIT - turn_slopes[1][:, None] * integral
        residual = np.concatenate([rate - pull[0], size * angle_rate - turn[0]])
        try:
            step = np.linalg.solve(jacobian, residual)
        except np.linalg.LinAlgError:
            return None
        rate, angle_rate = rate - step[:NODES], angle_rate - step[NODES:]
        largest = float(np.abs(size).max())
        change = length * (np.abs(step[:NODES]).max() + largest * np.abs(step[NODES:]).max())
        if not change < 1e3:
            return None
        if change < ROOT_TOLERANCE:
            break
    else:
        return None
    angle = first_angle + integral @ angle_rate
    last_terms = np.abs(LAST @ rate).max() + largest * np.abs(LAST @ angle_rate).max()
    direction = np.cos(angle), np.sin(angle)
    return Slip(first_size + integral @ rate, rate, direction, length * float(last_terms))
