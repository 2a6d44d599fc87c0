"""A stretch of phase in one mode of contact: its smooth equation solved, all of it a polynomial.

The rates of change are polynomials that fulfil the equation at Gauss's nodes (collocation). What
the rates depend on is found by Newton's iteration: of a slip its size and its angle,

    size' = pull(size, angle),    size angle' = turn(size, angle),

which has one smooth solution through a start at size 0, too: there the slip follows the push.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from core.mechanics.arrays import Array
from core.motion.groups import Numbers
from core.motion.methods.reference.laws import SPIN, UX, Laws, Mode
from core.motion.methods.reference.polynomials import (
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
"""Of the differences that give the slopes of Newton's iteration; enough for its last step."""


@dataclass
class Stretch:
    """What a part does over a stretch of phase, with no event.

    Attributes
    ----------
    start, length : float
    states : ndarray, shape (7, TERMS)
        Coefficients of the state.
    rates : ndarray, shape (4, TERMS)
        Of the velocities and the spin.
    size, growth : ndarray, shape (TERMS,)
        Of the size of the slip, and of its rate; 0 where there is none.
    normal, side : ndarray, shape (TERMS,)
        Of the forces of floor and wall.
    tail : float
        Size of the last coefficients: what more nodes would have changed, and more.
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
        """Return the state at a point of 0 to 1."""
        return values(self.states, at)


def solve(
    laws: Laws, mode: Mode, state: Array, start: float, length: float, begins: bool
) -> Stretch | None:
    """Return a part's stretch in a mode; None if the iteration does not come to an end.

    `begins` says that a slip starts from rest.
    """
    phases = start + length * AT
    size, rate, tail = np.zeros(NODES), np.zeros(NODES), 0.0
    if mode.slips and (mode.floor or mode.wall):
        slip = _slip(laws, mode, state, phases, length, begins)
        if slip is None:
            return None
        size, rate, e, tail = slip
        ux = size * e[0]
    else:
        e = (0.0, 0.0)
        ux = np.zeros(NODES)  # of a part that sticks; a free one speeds up whatever it does
        if not (mode.floor or mode.wall):
            ux = state[UX] + length * (NODES_INTEGRAL @ laws.free(phases, 0.0)[0])
    forces = laws.forces(phases, mode, ux, e)
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
        start, length, states, coefficients[:4], FROM_NODES @ size, FROM_NODES @ rate,
        coefficients[4], coefficients[5], tail,
    )


def _slip(
    laws: Laws, mode: Mode, state: Array, phases: Array, length: float, begins: bool
) -> tuple[Array, Array, tuple[Numbers, Numbers], float] | None:
    """Return size, rate and direction of a slip at the nodes, and how large the last terms are."""
    first, second = laws.slip(mode, state)
    start = phases[0] - length * AT[0]
    if begins:
        size0, (first, second) = 0.0, laws.onset_direction(start, mode)
    else:
        size0 = math.hypot(first, second)
    angle0 = math.atan2(second, first)
    pull, turn = laws.sliding(phases, mode, np.full(NODES, size0), angle0)
    straight = float(np.abs(turn).max()) < STRAIGHT
    rate, angular = np.asarray(pull) + np.zeros(NODES), np.zeros(NODES)
    if not straight and begins:
        ahead = [laws.onset_direction(phase, mode) for phase in phases.tolist()]
        off = [math.remainder(math.atan2(b, a) - angle0, 2.0 * math.pi) for a, b in ahead]
        angular = NODES_SLOPE @ np.array(off) / length
        rate = laws.sliding(phases, mode, np.zeros(NODES), angle0 + np.array(off))[0]
    elif not straight:
        most = 0.5 / length
        angular = np.clip(turn / size0, -most, most)
    reach = length * NODES_INTEGRAL
    jacobian = np.zeros((2 * NODES, 2 * NODES))
    unit = np.eye(NODES)
    for _ in range(15):
        size, angle = size0 + reach @ rate, angle0 + reach @ angular
        pull, turn = laws.sliding(
            phases,
            mode,
            np.stack([size, size + SMALL, size]),
            np.stack([angle, angle, angle + SMALL]),
        )
        slopes = (pull[1:] - pull[0]) / SMALL
        jacobian[:NODES, :NODES] = unit - slopes[0][:, None] * reach
        if straight:
            jacobian[NODES:, NODES:] = unit
            off_turn = np.zeros(NODES)
        else:
            turns = (turn[1:] - turn[0]) / SMALL
            jacobian[:NODES, NODES:] = -slopes[1][:, None] * reach
            jacobian[NODES:, :NODES] = (angular - turns[0])[:, None] * reach
            jacobian[NODES:, NODES:] = np.diag(size) - turns[1][:, None] * reach
            off_turn = size * angular - turn[0]
        try:
            step = np.linalg.solve(jacobian, np.concatenate([rate - pull[0], off_turn]))
        except np.linalg.LinAlgError:
            return None
        rate, angular = rate - step[:NODES], angular - step[NODES:]
        largest = float(np.abs(size).max())
        change = length * (np.abs(step[:NODES]).max() + largest * np.abs(step[NODES:]).max())
        if not change < 1e3:
            return None
        if change < 1e-10:
            break
    else:
        return None
    size, angle = size0 + reach @ rate, angle0 + reach @ angular
    last = FROM_NODES[NODES - 2 : NODES]
    tail = length * float(
        np.abs(last @ rate).max() + largest * np.abs(last @ angular).max()
    )
    e = (math.copysign(1.0, first), 0.0) if straight and abs(second) < STRAIGHT else (
        np.cos(angle), np.sin(angle)
    )  # fmt: skip
    return size, rate, e, tail
