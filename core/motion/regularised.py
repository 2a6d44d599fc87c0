"""Regularised friction on a stiff floor, by general integrators: a comparison for the exact laws.

Friction is a steep function of the sliding velocity and the floor is a spring with a damper. Both
laws are smooth where Coulomb's and Signorini's are set-valued (theory 13.1), so that any stiff
integrator applies; the price is a part that creeps where it should stick, and small steps. The
laws of theory 13.1 come back as `slip_speed` goes to 0 and `contact_stiffness` to infinity.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from core.mechanics.arrays import Array
from core.motion.motion import STATUS, Motion
from core.watch import Watch

SOLVERS = ("Radau", "BDF", "LSODA")
"""The implicit integrators of scipy."""

PEAK = 3.0
"""Speed of the static peak, and the limit of sticking, in slip speeds.

Up to here friction grows with speed and holds the part by creep. At 3 slip speeds the law without
a peak has 95 % of its final value.
"""

MOST_EVALUATIONS = 1_000_000
"""Evaluations of the right-hand side after which a cell is given up: about ten seconds."""

LARGEST_MULTIPLE = 8
"""Periods of the drive over which the motion may repeat."""

COARSER, SOFTER = 4.0, 16.0
"""Factors of the slip speed and of the stiffness for the estimate of the error.

4^(2/3) and 16^(1/3) are 2.5: at the slowest orders the difference is 1.5 times the error.
"""

TWICE_COARSER = 5.0
"""Over this the difference is divided where both factors are applied twice.

(16 - 1)/(4 - 1): at order 1 it then says the same. Friction errs by terms of several orders and
either sign; where they cross, the first difference is as good as 0, and the second is not.
"""

SAFETY = 3.0
"""The estimate is so many times the differences, as that of time stepping is.

Where a slip stops near the peak of friction, the error falls more slowly than the orders say. Of
68 random studies the true error was larger than the differences once taken in 5, by up to 14.
"""

LOOSER = 10.0
"""Factor of the tolerance for the estimate of the integrator's error."""

MOST_RESTARTS = 20
"""Pieces of one period, each with a time of its own."""

STEPS = 50
"""Fewest steps a period: none may leap over a whole hop or slip."""

PERIOD = 2 * math.pi


class _SpentError(Exception):
    """The evaluations of a cell are used up."""


@dataclass(frozen=True)
class Laws:
    """The regularised laws of one cell, all dimensionless.

    Attributes
    ----------
    friction_kinetic, friction_static : float
        Coefficients at large speeds and at the peak.
    slip_speed : float
        Speed below which friction gives way, in g/w.
    stiffness, damping : float
        Of the floor, over the mass, in w^2 and w.
    """

    friction_kinetic: float
    friction_static: float
    slip_speed: float
    stiffness: float
    damping: float

    @property
    def onset(self) -> float:
        """Force of the spring, over the weight, at which the damper has set in.

        It sets in over the depth to which the weight presses the spring. If it set in at once, the
        force would jump at a landing, and integrators end there: the step that their tolerance asks
        for is below the spacing of floating numbers. On floors stiffer than 1e8 that depth itself
        is passed in so short a time; there it is 1e-4 of the depth to which an impact at g/w goes.
        """
        return max(1.0, 1e-4 * math.sqrt(self.stiffness))

    def friction(self, speed: float) -> tuple[float, float]:
        """Return force/(normal force x speed), and its derivative by speed over speed.

        The coefficient falls from the static to the kinetic one as a Gaussian of the speed. Its
        height and width are those for which the force has its maximum, the static coefficient
        exactly, at `PEAK` slip speeds; all shapes with a lower or higher peak would break loose at
        a wrong load however small the slip speed is.
        """
        square = speed * speed
        root = math.sqrt(square + self.slip_speed * self.slip_speed)
        value = self.friction_kinetic / root
        slope = -self.friction_kinetic / root**3
        if self.friction_static > self.friction_kinetic:
            peak = self.friction_static * math.sqrt(1 + PEAK**2) / PEAK
            extra = peak - self.friction_kinetic
            width = 2 * (1 + PEAK**2) * extra / peak  # square, in that of the speed of the peak
            width *= (PEAK * self.slip_speed) ** 2
            bump = extra * math.exp(((PEAK * self.slip_speed) ** 2 - square) / width)
            value += bump / root
            slope -= bump / root**3 + 2 * bump / (width * root)
        return value, slope

    def unclamped(self, height: float, velocity: float) -> float:
        """Return the force of spring and damper over the weight, which may pull (Kelvin-Voigt)."""
        spring = -self.stiffness * height
        return spring - self.damping * min(1.0, spring / self.onset) * velocity

    def normal(self, height: float, velocity: float) -> tuple[float, float, float]:
        """Return the force of the floor over the weight, and its derivatives; it never pulls."""
        force = self.unclamped(height, velocity) if height < 0 else 0.0
        if force <= 0:
            return 0.0, 0.0, 0.0
        spring = -self.stiffness * height
        by_height = -self.stiffness
        if spring < self.onset:
            by_height += self.damping * self.stiffness * velocity / self.onset
        return force, by_height, -self.damping * min(1.0, spring / self.onset)


def damping_ratio(restitution: float, stiffness: float) -> float:
    """Return the damping ratio of a floor that never pulls, with the given restitution.

    With a damping ratio sin a an impact ends, when the force is 0, at the share
    exp(-(pi - 2a) tan a) of its speed; with cosh b at exp(-2b coth b). Both are independent of the
    speed, as Newton's law asks; with Hunt and Crossley's damper they are not. A restitution of 0
    needs endless damping, which would let the part sink and rise slowly. The ratio stays below
    (stiffness^(1/2)/8)^(1/3), but at least 1: there a landing at g/w under the full weight ends
    without any rebound, and the floor still recovers in a time of order stiffness^(-1/3).
    """
    most = max(1.0, (math.sqrt(stiffness) / 8) ** (1 / 3))
    if restitution >= 1:
        return 0.0

    from scipy.optimize import brentq

    def exponent(ratio: float) -> float:
        if ratio < 1:
            angle = math.asin(ratio)
            return (math.pi - 2 * angle) * math.tan(angle)
        arc = math.acosh(ratio)
        return 2 * arc / math.tanh(arc) if arc > 0 else 2.0

    if restitution <= math.exp(-exponent(most)):
        return most
    return brentq(lambda ratio: exponent(ratio) + math.log(restitution), 0.0, most, xtol=1e-14)


def laws(
    friction_kinetic: float,
    friction_static: float,
    restitution: float,
    slip_speed: float,
    stiffness: float,
) -> Laws:
    """Return the laws with the damping that gives the restitution."""
    damping = 2 * damping_ratio(restitution, stiffness) * math.sqrt(stiffness)
    static = max(friction_static, friction_kinetic)
    return Laws(friction_kinetic, static, slip_speed, stiffness, damping)


@dataclass(frozen=True)
class Cell:
    """One part on one track: the right-hand side of its motion and its Jacobian.

    The state is the position and the velocity, (x, z, u_x, u_z) in the plane and
    (x, y, z, u_x, u_y, u_z) in space.

    Attributes
    ----------
    laws : Laws
    drive, gravity : tuple of float
        Along the track, (across it,) and normal to the floor.
    """

    laws: Laws
    drive: tuple[float, ...]
    gravity: tuple[float, ...]

    @property
    def coordinates(self) -> int:
        """2 in the plane, 3 in space."""
        return len(self.drive)

    def rest(self) -> Array:
        """Return the state at rest, sunk as deep as the weight asks, so that nothing bounces."""
        state = np.zeros(2 * self.coordinates)
        state[self.coordinates - 1] = -self.gravity[-1] / self.laws.stiffness
        return state

    def rate(self, phase: float, state: Array) -> list[float]:
        """Return the derivative of the state (theory 13.1)."""
        n = self.coordinates
        position, *velocity = state[n - 1 :].tolist()
        force, _, _ = self.laws.normal(position, velocity[-1])
        sine = math.sin(phase)
        free = [d * sine - g for d, g in zip(self.drive, self.gravity, strict=True)]
        free[-1] += force
        if force > 0:
            resistance = force * self.laws.friction(math.hypot(*velocity[:-1]))[0]
            for i in range(n - 1):
                free[i] -= resistance * velocity[i]
        return velocity + free

    def jacobian(self, phase: float, state: Array) -> Array:
        """Return the derivative of `rate` by the state."""
        del phase  # the drive does not depend on the state
        n = self.coordinates
        position, *velocity = state[n - 1 :].tolist()
        matrix = np.zeros((2 * n, 2 * n))
        matrix[range(n), range(n, 2 * n)] = 1.0
        force, by_height, by_climb = self.laws.normal(position, velocity[-1])
        if force > 0:
            sliding = np.array(velocity[:-1])
            value, slope = self.laws.friction(math.hypot(*velocity[:-1]))
            direction = np.append(-value * sliding, 1.0)  # of the contact force
            matrix[n:, n - 1] = by_height * direction
            matrix[n:, 2 * n - 1] = by_climb * direction
            matrix[n:-1, n:-1] -= force * (
                value * np.eye(n - 1) + slope * np.outer(sliding, sliding)
            )
        return matrix


@dataclass(frozen=True)
class _Piece:
    """A stretch of a period: the phase that it begins at, and scipy's solution since then."""

    phase: float
    found: Any


@dataclass(frozen=True)
class _Period:
    """One period of motion, in the pieces that the integrator needed."""

    pieces: tuple[_Piece, ...]

    @property
    def end(self) -> Array:
        """State at the end."""
        return self.pieces[-1].found.y[:, -1]

    @property
    def phases(self) -> Array:
        """Phases of the steps, ascending; some may be equal."""
        return np.concatenate([piece.phase + piece.found.t for piece in self.pieces])

    def at(self, phase: float) -> Array:
        """Return the state at a phase; the options must have asked for dense output."""
        piece = next(p for p in reversed(self.pieces) if p.phase <= phase)
        return piece.found.sol(phase - piece.phase)


class _Run:
    """Integration of a cell, period by period, with an account of the evaluations."""

    def __init__(self, cell: Cell, solver: str, tolerance: float, evaluations: int) -> None:
        self.cell, self.solver, self.left = cell, solver, evaluations
        n = cell.coordinates
        slip, stiffness = cell.laws.slip_speed, cell.laws.stiffness
        # What counts is a creep as a share of the slip speed, and a depth as a share of the
        # depth under the weight.
        absolute = np.full(2 * n, tolerance)
        absolute[n - 1] = tolerance / stiffness
        absolute[n:-1] = tolerance * min(1.0, 10 * slip)
        self.options: dict[str, Any] = {
            "method": solver,
            "rtol": tolerance,
            "atol": absolute,
            "max_step": PERIOD / STEPS,
            "jac": cell.jacobian,
        }

    def rate(self, phase: float, state: Array) -> list[float]:
        if self.left <= 0:
            raise _SpentError
        self.left -= 1
        return self.cell.rate(phase, state)

    def period(self, state: Array) -> _Period:
        """Return the motion over one period from the state, the position set back to 0.

        A step may have to be shorter than ten spacings of the phase, where an integrator ends; it
        then goes on with the time counted from there, whose spacings are as short as need be.
        """
        start = state.copy()
        start[: self.cell.coordinates - 1] = 0.0
        phase, pieces = 0.0, []
        for _ in range(MOST_RESTARTS):
            found = self._from(phase, start)
            pieces.append(_Piece(phase, found))
            if found.success:
                return _Period(tuple(pieces))
            phase, start = phase + float(found.t[-1]), found.y[:, -1]
        raise _SpentError

    def _from(self, phase: float, start: Array) -> Any:
        """Return scipy's solution from a phase to the end of the period, or to where it ends."""
        from scipy.integrate import solve_ivp

        def rate(since: float, state: Array) -> list[float]:
            return self.rate(phase + since, state)

        return solve_ivp(rate, (0.0, PERIOD - phase), start, **self.options)


@dataclass
class _Orbit:
    """What a run came to: the last states at the end of a period, and the mean velocity."""

    states: list[Array]
    velocity: float
    multiple: int
    status: str


def _orbit(run: _Run, state: Array, most_periods: int, closeness: float) -> _Orbit:
    """Return the motion once it repeats, or what there is when the periods are used up."""
    n = run.cell.coordinates
    weight = run.cell.laws.friction_kinetic * run.cell.gravity[-1]
    steep = math.hypot(*run.cell.gravity[:-1]) > weight * (1 + 1e-12)
    swing = 2 * math.hypot(*run.cell.drive[:-1]) + run.cell.laws.slip_speed
    # The position at the end of a period is its travel, since it starts at 0.
    states = [state]

    def gap(place: int, multiple: int) -> float:
        return float(np.max(np.abs(states[place] - states[place - multiple])))

    def mean(periods: int) -> float:
        return float(np.mean([s[0] for s in states[-periods:]])) / PERIOD

    try:
        for done in range(1, most_periods + 1):
            states.append(run.period(states[-1]).end)
            # The first state has no travel of its own, and the rate takes one period more.
            for multiple in range(1, min(LARGEST_MULTIPLE, done - 2) + 1):
                now, before = gap(-1, multiple), gap(-2, multiple)
                # The gaps still to come are a geometric series of the rate at which they shrink.
                if now < closeness * max(0.01, 1 - now / max(before, closeness * 1e-9)):
                    return _Orbit(states[-1 - multiple :], mean(multiple), multiple, "periodic")
            # Faster than the drive can turn it round, and the slope is steeper than friction.
            slow, fast = (math.hypot(*s[n:-1]) for s in states[-2:])
            if steep and fast > slow > swing:
                return _Orbit(states[-2:], math.nan, 0, "runaway")
    except _SpentError:
        pass
    velocity = mean(len(states) // 2) if len(states) > 1 else math.nan
    return _Orbit(states[-2:], velocity, 0, "limit_reached")


def _crossings(
    function: Callable[[Array], float], state_at: Callable[[float], Array], phases: Array
) -> list[float]:
    """Return where the function of the state changes its sign between the phases.

    scipy's own search for events fails where an interpolant misses the end of a step by rounding.
    """
    from scipy.optimize import brentq

    def value(phase: float) -> float:
        return function(state_at(phase))

    values = [value(phase) for phase in phases]
    return [
        brentq(value, start, end, xtol=1e-12) if before else start
        for (start, end), (before, after) in zip(pairwise(phases), pairwise(values), strict=True)
        if (before < 0) != (after < 0)
    ]


def _measures(run: _Run, orbit: _Orbit) -> dict[str, float]:
    """Return the shares of the period and the impacts, over the periods until it repeats."""
    n = run.cell.coordinates
    law = run.cell.laws
    limit = PEAK * law.slip_speed

    def release(state: Array) -> float:
        """Return what is negative where the floor presses."""
        height = float(state[n - 1])
        return height if height >= 0 else -law.unclamped(height, float(state[-1]))

    def slip(state: Array) -> float:
        return math.hypot(*state[n:-1]) - limit

    def along(state: Array) -> float:
        return float(state[n])

    def climb(state: Array) -> float:
        return float(state[-1])

    run.options["dense_output"] = True
    share = dict.fromkeys(("stick", "forward", "backward", "flight"), 0.0)
    impacts, landing, hop = 0, 0.0, 0.0
    periods = max(1, orbit.multiple)
    state = orbit.states[0]
    for _ in range(periods):
        found = run.period(state)
        at, steps = found.at, found.phases
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
        state = found.end
    return {**share, "impacts": impacts / periods, "landing_speed": landing, "hop_height": hop}


def _cell_motion(
    cell: Cell, coarse: tuple[Cell, Cell], solver: str, tolerance: float, most_periods: int
) -> dict[str, float | str]:
    """Return the fields of `Motion` for one cell, the status by its name."""
    nothing: dict[str, float | str] = {**dict.fromkeys(Motion._fields, math.nan), "multiple": 0}
    if cell.gravity[-1] <= 0:  # the part falls off the floor
        return {**nothing, "status": "runaway"}
    frictionless = cell.laws.friction_static == 0
    if frictionless and any(cell.gravity[:-1]):
        return {**nothing, "status": "runaway"}

    # Closer than this the regularisation itself is not known: it moves velocities by shares of
    # the slip speed. The other bound is the integrator's own noise over hundreds of steps.
    closeness = max(0.1 * cell.laws.slip_speed, 100 * tolerance)
    run = _Run(cell, solver, tolerance, MOST_EVALUATIONS)
    orbit = _orbit(run, cell.rest(), most_periods, closeness)
    unfinished = {**nothing, "velocity": orbit.velocity, "status": orbit.status}
    if orbit.status != "periodic":
        return unfinished
    try:
        measures = _measures(run, orbit)
    except _SpentError:
        return {**unfinished, "status": "limit_reached"}
    # From where the fine motion is, so that all are on one attractor where there are several.
    # Runs of their own, since the errors of the laws and of the integrator can cancel in one.
    once, twice, loose = (
        _orbit(
            _Run(changed, solver, looser * tolerance, MOST_EVALUATIONS),
            orbit.states[-1],
            most_periods,
            max(wider * closeness, 100 * looser * tolerance),
        ).velocity
        - orbit.velocity
        for changed, looser, wider in (
            (coarse[0], 1.0, COARSER),
            (coarse[1], 1.0, COARSER**2),
            (cell, LOOSER, COARSER),
        )
    )
    by_laws = np.fmax(abs(once), abs(twice) / TWICE_COARSER)
    return {
        **measures,
        "velocity": orbit.velocity,
        "spread": 0.0,
        "error": SAFETY * (float(by_laws) + abs(loose)),
        "multiple": orbit.multiple,
        "status": "neutral" if frictionless else "periodic",
    }


def regularised_motion(
    *,
    drive_number_along: ArrayLike,
    drive_number_across: ArrayLike,
    drive_number_normal: ArrayLike,
    gravity_number_along: ArrayLike,
    gravity_number_across: ArrayLike,
    gravity_number_normal: ArrayLike,
    friction_kinetic: ArrayLike,
    friction_static: ArrayLike,
    restitution: ArrayLike,
    slip_speed: ArrayLike,
    contact_stiffness: ArrayLike,
    tolerance: ArrayLike,
    most_periods: ArrayLike,
    solver: str,
    planar: bool,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion with regularised friction on a stiff floor, by a stiff integrator.

    Theory 13.1 without a wall and without curvature, 13.2 in the plane. A loop over the cells: a
    comparison for the methods that keep the exact laws, not a rival.

    Parameters
    ----------
    drive_number_along, drive_number_across, drive_number_normal : array_like
        Acceleration of the drive over g.
    gravity_number_along, gravity_number_across, gravity_number_normal : array_like
        Gravity over g, against the track's axes.
    friction_kinetic, friction_static : array_like
        Coefficients; a static one below the kinetic one counts as equal to it.
    restitution : array_like
        Coefficient of restitution, from 0 to 1. Values below about (8/stiffness^(1/2))^(2/3)/4,
        0 among them, all give this share; see `damping_ratio`.
    slip_speed : array_like
        Speed below which friction gives way, in g/w.
    contact_stiffness : array_like
        Stiffness of the floor, over mass times w^2.
    tolerance : array_like
        Relative error of a step of the integrator; up to a thousandth of the slip speed, lest the
        integrator's scatter hide what the laws' errors are.
    most_periods : array_like of int
        Periods of the drive after which a cell is given up.
    solver : str
        One of `SOLVERS`. LSODA takes the least time, but may stay with its explicit formula after
        a landing until the evaluations are used up; Radau did not fail.
    planar : bool
        True for motion along and normal to the track only; the groups across must then be 0.
    watch : Watch, optional
        May stop it between cells; what is not started is `not_computed`.

    Returns
    -------
    Motion
        Arrays of the arguments' common shape. The laws are approached at least as slip_speed^(2/3)
        (the delay at the peak of friction; the power is 1 without a peak) and stiffness^(-1/3) (the
        recovery of the damped floor). With 4 times the slip speed and a sixteenth of the stiffness
        either error is 2.5 times as large. `error` is three times the larger of the differences to
        that run and, divided by 5, to one where both are applied twice, plus three times that to a
        run with 10 times the tolerance: 4.5 times the error at those powers, 9 at order 1.

        A part at rest creeps: it is `periodic` with the mean velocity of the creep, of the order
        of the slip speed, and a stick of 1; the status `at_rest` is never given. Sticking means
        slower than 3 slip speeds, flight no force of the floor. Hops are counted as far as the
        integrator resolves them. The status is `limit_reached` where the motion has not repeated
        within 8 periods of the drive when the periods or a million evaluations are used up, or
        where the integrator gives up: the velocity is then the mean of the later half, and the
        rest is NaN. It is `no_solution` where
        an argument is not a number or out of its range.
    """
    if solver not in SOLVERS:
        raise ValueError(f"solver is {solver!r}; it must be one of {', '.join(SOLVERS)}")
    arguments = np.broadcast_arrays(
        *(
            np.asarray(argument, dtype=float)
            for argument in (
                drive_number_along, drive_number_across, drive_number_normal,
                gravity_number_along, gravity_number_across, gravity_number_normal,
                friction_kinetic, friction_static, restitution,
                slip_speed, contact_stiffness, tolerance, most_periods,
            )
        )
    )  # fmt: skip
    if planar and (np.any(arguments[1]) or np.any(arguments[4])):
        raise ValueError("planar motion has no drive and no gravity across the track")
    shape = arguments[0].shape
    fields = {name: np.full(shape, np.nan) for name in Motion._fields[:-1]}
    fields["multiple"][...] = 0
    status = np.full(shape, STATUS["not_computed"], dtype=np.int8)
    watch = watch or Watch()
    kept = [0, 2] if planar else [0, 1, 2]
    for place in np.ndindex(shape):
        if watch.stopped():
            break
        status[place] = STATUS["no_solution"]
        numbers = [float(argument[place]) for argument in arguments]
        drive = tuple(numbers[i] for i in kept)
        gravity = tuple(numbers[3 + i] for i in kept)
        kinetic, static, rebound, slip, stiffness, error, periods = numbers[6:]
        usable = all(map(math.isfinite, numbers)) and min(slip, stiffness, error, periods) > 0
        if not (usable and kinetic >= 0 and 0 <= rebound <= 1):
            continue
        cell = Cell(laws(kinetic, static, rebound, slip, stiffness), drive, gravity)
        once, twice = (
            replace(
                cell, laws=laws(kinetic, static, rebound, COARSER**n * slip, stiffness / SOFTER**n)
            )
            for n in (1, 2)
        )
        found = _cell_motion(cell, (once, twice), solver, error, int(periods))
        for name, values in fields.items():
            values[place] = found[name]
        status[place] = STATUS[str(found["status"])]
    return Motion(**fields, status=status)
