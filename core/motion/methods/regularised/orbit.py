"""Integration of one part period by period, until its motion repeats."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import scipy

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.methods.regularised.laws import PEAK, Cell
from vibrafeed.core.watch import Watch

LARGEST_MULTIPLE = 8
"""Periods of the drive over which the motion may repeat."""

MAX_RESTARTS = 20
"""Pieces of a period, or of what lies between two jumps of it, each with a time of its own: where
more are needed the steps shrink without end."""

STEPS = 50
"""Fewest steps a period: none may leap over a whole hop or slip."""

LOOK = 64
"""Evaluations from one look at the watch to the next: some milliseconds."""

NOISE, CYCLES, DRIFTS = 0.01, 4, 0.75
"""A gap below this share of the closeness may be noise; over so many cycles it is a drift if it
grows to this share of as many gaps."""

PERIOD = 2 * math.pi


class SpentError(Exception):
    """The evaluations of a cell are used up."""


@dataclass(frozen=True)
class _Piece:
    """A stretch of a period: the phase that it begins at, and scipy's solution since then."""

    phase: float
    solution: Any


@dataclass(frozen=True)
class _Period:
    """One period of motion, in the pieces that the integrator needed."""

    pieces: tuple[_Piece, ...]

    @property
    def end(self) -> Array:
        """The state at the end of the period."""
        return self.pieces[-1].solution.y[:, -1]

    @property
    def phases(self) -> Array:
        """The ascending phases of the integration steps; some may be equal."""
        return np.concatenate([piece.phase + piece.solution.t for piece in self.pieces])

    def at(self, phase: float) -> Array:
        """Return the state at a phase; needs dense output of the integrator."""
        piece = next(p for p in reversed(self.pieces) if p.phase <= phase)
        return piece.solution.sol(phase - piece.phase)


class RegularisedRun:
    """Integration of a cell, period by period, with an account of the evaluations."""

    def __init__(
        self, cell: Cell, solver: str, tolerance: float, evaluations: int, watch: Watch
    ) -> None:
        """Prepare the integrator of a cell, with a limit of evaluations."""
        self.cell, self.solver, self.left, self.watch = cell, solver, evaluations, watch
        n = cell.coordinates
        slip, stiffness = cell.laws.slip_speed, cell.laws.stiffness
        # What counts is a creep as a share of the slip speed, and a depth as a share of the
        # depth under the weight.
        absolute = np.full(2 * n, tolerance)
        absolute[n - 1] = tolerance / stiffness
        absolute[n:-1] = tolerance * min(1.0, 10 * slip)
        self.options: dict[str, Any] = {
            "rtol": tolerance,
            "atol": absolute,
            "max_step": PERIOD / (STEPS * cell.order),
            "jac": cell.jacobian,
        }

    def rate(self, cell: Cell, phase: float, state: Array) -> list[float]:
        """Return the derivative of the cell's state by the phase, and count the evaluation.

        `state` is the one at `phase` in rad. Raises `SpentError` if all evaluations are used, and
        `StoppedError` if the watch has stopped the work.
        """
        if self.left <= 0:
            raise SpentError
        self.left -= 1
        if self.left % LOOK == 0:
            self.watch.check()
        return cell.rate(phase, state)

    def period(self, state: Array) -> _Period:
        """Return the motion over one period of the drive from a state, its positions set to 0.

        `state` holds the coordinates, of which the last is the height, then their velocities, in
        g/w^2 and g/w (w = 2 pi f). The height is kept, the positions along and across are counted
        from the start of the period. The integration restarts at jumps of the drive, so that no
        step leaps over one.
        """
        start = state.copy()
        start[: self.cell.coordinates - 1] = 0.0
        phase, pieces = 0.0, []
        for cell, end in self.cell.pieces(0.0, PERIOD):
            pieces += self._smoothly(cell, phase, end, start)
            phase, start = end, pieces[-1].solution.y[:, -1]
        return _Period(tuple(pieces))

    def _smoothly(self, cell: Cell, phase: float, end: float, start: Array) -> list[_Piece]:
        """Return the motion of a cell from `phase` to `end` in rad, between jumps of the drive.

        As pieces in the order of time; `start` is the state at first. A step may have to be shorter
        than ten spacings of floating-point numbers at that phase, where an integrator ends; a new
        piece then goes on with the time counted from there, whose spacings are as short as need be.
        Raises `SpentError` after too many pieces.
        """
        pieces: list[_Piece] = []
        for _ in range(MAX_RESTARTS):
            solution = self._from(cell, phase, end, start)
            pieces.append(_Piece(phase, solution))
            if solution.success:
                return pieces
            phase, start = phase + float(solution.t[-1]), solution.y[:, -1]
        raise SpentError

    def _from(self, cell: Cell, phase: float, end: float, start: Array) -> Any:
        """Return scipy's solution of the motion from a phase to `end`, or to where it gives up.

        `phase` and `end` are in rad, `start` is the state at `phase`; the solution's time counts
        from there. `cell` gives the derivatives of the state, with a drive that is smooth up to
        `end`.
        """

        def rate(since: float, state: Array) -> list[float]:
            """Return the derivative of the state at a phase since the start."""
            return self.rate(cell, phase + since, state)

        return scipy.integrate.solve_ivp(
            rate, (0.0, end - phase), start, method=self.solver, **self.options
        )


@dataclass
class Orbit:
    """The end of a run: states at the ends of its last periods, mean velocity, periods, status.

    `velocity` is in g/w; `multiple` is the number of periods after which it repeats, 0 if it does
    not.
    """

    states: list[Array]
    velocity: float
    multiple: int
    status: str

    def across(self, coordinates: int) -> float:
        """Return the mean velocity across the track in g/w; 0 in the plane (2 coordinates).

        Here w = 2 pi f, f being the frequency of the drive.
        """
        if coordinates < 3:
            return 0.0
        return float(np.mean([state[1] for state in self.states[-self.multiple :]])) / PERIOD


def orbit_of(run: RegularisedRun, state: Array, max_periods: int, closeness: float) -> Orbit:
    """Return the motion of a part once it repeats, or the end of a run that did not.

    `run` integrates period by period from `state` (coordinates and velocities in g/w^2 and g/w, w =
    2 pi f), `max_periods` at most; `closeness` is the distance in g/w at which states count as
    equal. The result has the states at the ends of the last periods, the mean velocity in g/w (NaN
    for a runaway), the periods after which the motion repeats, 0 if it does not, and the status
    `periodic`, `runaway` or `limit_reached`.
    """
    n = run.cell.coordinates
    weight = run.cell.laws.friction_kinetic * run.cell.gravity[-1]
    steep = math.hypot(*run.cell.gravity[:-1]) > weight * (1 + 1e-12)
    swing = 2 * run.cell.swing + run.cell.laws.slip_speed
    # The position at the end of a period is its travel, since it starts at 0.
    states = [state]

    def gap(index: int, multiple: int) -> float:
        """Return the largest difference of the states at the ends of two periods."""
        return float(np.max(np.abs(states[index] - states[index - multiple])))

    def repeats(multiple: int) -> bool:
        """True if the motion repeats after `multiple` periods, but for integrator noise.

        What the differences will still add up to, a geometric series, must be below the closeness;
        or they must be noise, which does not add up over cycles as a slow drift does. Where
        friction changes less in a period than noise does, nobody can tell: False.
        """
        if 0.0 < PERIOD * weight <= NOISE * closeness:
            return False
        now, before = gap(-1, multiple), gap(-2, multiple)
        if now < closeness * (1 - now / max(before, closeness * 1e-9)):
            return True
        several = CYCLES * multiple
        return (
            now < NOISE * closeness
            and several < len(states) - 1
            and gap(-1, several) < DRIFTS * CYCLES * now
        )

    def mean(periods: int) -> float:
        """Return the mean velocity over the last periods."""
        return float(np.mean([s[0] for s in states[-periods:]])) / PERIOD

    try:
        for done in range(1, max_periods + 1):
            states.append(run.period(states[-1]).end)
            # The first state has no travel of its own, and the rate takes one period more.
            for multiple in range(1, min(LARGEST_MULTIPLE, done - 2) + 1):
                if repeats(multiple):
                    return Orbit(states[-1 - multiple :], mean(multiple), multiple, "periodic")
            # Faster than the drive can turn it round, and the slope is steeper than friction.
            slow, fast = (math.hypot(*s[n:-1]) for s in states[-2:])
            if steep and fast > slow > swing:
                return Orbit(states[-2:], math.nan, 0, "runaway")
    except SpentError:
        pass
    velocity = mean(len(states) // 2) if len(states) > 1 else math.nan
    return Orbit(states[-2:], velocity, 0, "limit_reached")


def _crossings(
    function: Callable[[Array], float], state_at: Callable[[float], Array], phases: Array
) -> list[float]:
    """Return the phases at which a function of the part's state changes sign, for its events.

    `function` takes a state, `state_at` gives the state at a phase; `phases` in rad are ascending,
    so dense that a pair of changes lies between no two. scipy's own search for events fails where
    an interpolant misses the end of a step by rounding.
    """

    def value(phase: float) -> float:
        """Return the function's value at a phase."""
        return function(state_at(phase))

    values = [value(phase) for phase in phases]
    return [
        scipy.optimize.brentq(value, start, end, xtol=1e-12) if before else start
        for (start, end), (before, after) in zip(pairwise(phases), pairwise(values), strict=True)
        if (before < 0) != (after < 0)
    ]


def measures_of(run: RegularisedRun, orbit: Orbit) -> dict[str, float]:
    """Return shares of the four modes, impacts a period, landing speed and hop height of a cycle.

    By the names of the fields of `Motion`; speeds in g/w (w = 2 pi f), heights in g/w^2. The cycle
    of `orbit` is followed once more by the integrator `run`: a part sticks where it slips by less
    than 3 slip speeds, and flies where the floor does not press on it. Raises `SpentError` if the
    evaluations are used up.
    """
    n = run.cell.coordinates
    law = run.cell.laws
    limit = PEAK * law.slip_speed

    def release(state: Array) -> float:
        """Return a number that is negative where the floor presses on the part."""
        height = float(state[n - 1])
        return height if height >= 0 else -law.unclamped(height, float(state[-1]))

    def slip(state: Array) -> float:
        """Return the slip speed less the limit below which the part counts as sticking."""
        return math.hypot(*state[n:-1]) - limit

    def along(state: Array) -> float:
        """Return the slip velocity along the track."""
        return float(state[n])

    def climb(state: Array) -> float:
        """Return the velocity normal to the floor."""
        return float(state[-1])

    run.options["dense_output"] = True
    share = dict.fromkeys(("stick", "forward", "backward", "flight"), 0.0)
    impacts, landing, hop = 0, 0.0, 0.0
    periods = max(1, orbit.multiple)
    state = orbit.states[0]
    for _ in range(periods):
        solution = run.period(state)
        at, steps = solution.at, solution.phases
        phases = np.sort(np.concatenate([steps, (steps[1:] + steps[:-1]) / 2]))
        cuts = {
            function: _crossings(function, at, phases) for function in (release, slip, along, climb)
        }
        ends = np.unique(np.concatenate([[0.0, PERIOD], *cuts.values()]))
        kinds = []
        for start, end in pairwise(ends):
            middle = at((start + end) / 2)
            if release(middle) >= 0:
                kind = "flight"
            elif slip(middle) < 0:
                kind = "stick"
            else:
                kind = "forward" if middle[n] > 0 else "backward"
            kinds.append(kind)
            share[kind] += (end - start) / (PERIOD * periods)
        for (before, after), phase in zip(pairwise(kinds), ends[1:-1], strict=True):
            if before == "flight" and after != "flight":
                impacts += 1
                landing = max(landing, -climb(at(phase)))
        hop = max([hop, *(at(phase)[n - 1] for phase in cuts[climb])])
        state = solution.end
    return {**share, "impacts": impacts / periods, "landing_speed": landing, "hop_height": hop}
