"""A stretch of phase in one mode of contact: its smooth equation solved, all of it a polynomial.

The rates of change are polynomials that fulfil the equation at Gauss's nodes (collocation). What
the rates depend on is found by Newton's iteration: of a slip its size and its angle,

    size' = pull(size, angle),    size angle' = turn(size, angle),

which has one smooth solution through a start at size 0, too: there the slip follows the push.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.groups import Numbers
from vibrafeed.core.motion.methods.reference.laws import SPIN, UX, Mode, ReferenceLaws
from vibrafeed.core.motion.methods.reference.polynomials import (
    AT,
    FROM_NODES,
    INTEGRAL,
    NODES,
    NODES_INTEGRAL,
    NODES_SLOPE,
    TERMS,
    values,
)

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
    """Return the slip of a part over a stretch of phase, at Gauss's nodes; None if it fails.

    Size, rate and direction at the nodes. The slip keeps its direction if nothing turns it by more
    than `STRAIGHT`, else an iteration finds how it turns. If the part `begins` to slip here, its
    direction is that of the push less friction. `laws` gives the forces, `mode` the contacts, which
    slip; `state` (7 numbers) is that at the start, `phases` are those of the nodes and `length` the
    duration, in rad.
    """
    first, second = laws.slip(mode, state)
    size = math.hypot(first, second)
    if begins:
        first, second = laws.onset_direction(phases[0] - length * AT[0], mode)
    angle = math.atan2(second, first)
    pull, turn = laws.sliding(phases, mode, np.full(NODES, size), angle)
    pull = pull + np.zeros(NODES)
    if np.abs(turn).max() < STRAIGHT:
        return _straight(laws, mode, phases, length, (size, angle), pull)
    if begins:  # it follows the push
        ahead = [laws.onset_direction(phase, mode) for phase in phases.tolist()]
        off = np.array([
            math.remainder(math.atan2(b, a) - angle, 2.0 * math.pi) for a, b in ahead
        ])  # fmt: skip
        angular = NODES_SLOPE @ off / length
        pull = laws.sliding(phases, mode, np.zeros(NODES), angle + off)[0]
    else:
        angular = np.clip(turn / size, -0.5 / length, 0.5 / length)
    return _turning(laws, mode, phases, length, (size, angle), pull, angular)


def _straight(
    laws: ReferenceLaws,
    mode: Mode,
    phases: Array,
    length: float,
    start: tuple[float, float],
    rate: Array,
) -> Slip | None:
    """Return a slip with a constant direction, at Gauss's nodes of a stretch; None if it fails.

    The rate of its size is found by Newton's iteration, as in a curve forces depend on the speed.

    Parameters
    ----------
    laws, mode
        Forces on the part, and its contacts, which slip.
    phases, length
        Phases of the nodes, shape (NODES,), and duration of the stretch, in rad.
    start
        Size of the slip in g/w (w = 2 pi f) and its angle in rad at the start.
    rate
        Guess of the rate of its size at the nodes in g, shape (NODES,).
    """
    size0, angle = start
    reach = length * NODES_INTEGRAL
    size = size0 + reach @ rate
    for _ in range(MAX_STEPS):
        if laws.groups.curvature_number == 0.0:  # the forces do not depend on the speed
            break
        pull, _ = laws.sliding(phases, mode, np.stack([size, size + SMALL]), angle)
        slope = (pull[1] - pull[0]) / SMALL
        step = np.linalg.solve(np.eye(NODES) - slope[:, None] * reach, rate - pull[0])
        rate = rate - step
        size = size0 + reach @ rate
        if length * np.abs(step).max() < ROOT_TOLERANCE:
            break
    else:
        return None
    e = math.cos(angle), math.sin(angle)
    e = (math.copysign(1.0, e[0]), 0.0) if abs(e[1]) < STRAIGHT else e
    return Slip(size, rate, e, length * float(np.abs(LAST @ rate).max()))


def _turning(
    laws: ReferenceLaws,
    mode: Mode,
    phases: Array,
    length: float,
    start: tuple[float, float],
    rate: Array,
    angular: Array,
) -> Slip | None:
    """Return a slip whose direction turns, over a stretch of phase; None if the iteration fails.

    Size s and angle a of the slip fulfil s' = pull(s, a), s a' = turn(s, a) at Gauss's nodes. The
    unknowns of Newton's iteration are the rates s' and a' at the nodes; `reach` integrates rates to
    values at the nodes.

    Parameters
    ----------
    laws, mode
        Forces on the part, and its contacts, which slip.
    phases, length
        Phases of the nodes, shape (NODES,), and duration of the stretch, in rad.
    start
        Size of the slip in g/w (w = 2 pi f) and its angle in rad at the start of the stretch.
    rate, angular
        Guesses of s' in g and of a' at the nodes, shape (NODES,).
    """
    size0, angle0 = start
    reach = length * NODES_INTEGRAL
    jacobian = np.zeros((2 * NODES, 2 * NODES))
    for _ in range(MAX_STEPS):
        size, angle = size0 + reach @ rate, angle0 + reach @ angular
        pull, turn = laws.sliding(
            phases,
            mode,
            np.array([size, size + SMALL, size]),
            np.array([angle, angle, angle + SMALL]),
        )
        pulls, turns = (pull[1:] - pull[0]) / SMALL, (turn[1:] - turn[0]) / SMALL
        jacobian[:NODES, :NODES] = UNIT - pulls[0][:, None] * reach
        jacobian[:NODES, NODES:] = -pulls[1][:, None] * reach
        jacobian[NODES:, :NODES] = (angular - turns[0])[:, None] * reach
        jacobian[NODES:, NODES:] = size[:, None] * UNIT - turns[1][:, None] * reach
        off = np.concatenate([rate - pull[0], size * angular - turn[0]])
        try:
            step = np.linalg.solve(jacobian, off)
        except np.linalg.LinAlgError:
            return None
        rate, angular = rate - step[:NODES], angular - step[NODES:]
        largest = float(np.abs(size).max())
        change = length * (np.abs(step[:NODES]).max() + largest * np.abs(step[NODES:]).max())
        if not change < 1e3:
            return None
        if change < ROOT_TOLERANCE:
            break
    else:
        return None
    angle = angle0 + reach @ angular
    last = np.abs(LAST @ rate).max() + largest * np.abs(LAST @ angular).max()
    e = np.cos(angle), np.sin(angle)
    return Slip(size0 + reach @ rate, rate, e, length * float(last))
