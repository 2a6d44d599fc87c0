"""Motion of one part from event to event at high order: the reference for the other methods.

Between events each mode of contact is a smooth differential equation, solved to about 11 digits;
events are found on its dense output (theory 13.1, 13.3 to 13.5). Single parts, at the speed of
plain Python: some hundredths of a second for a period.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from core.mechanics.arrays import Array
from core.motion.motion import STATUS, Motion
from core.motion.stepping import Path

TOLERANCE = 1e-12
STOPPED = 1e-10
"""Slips and speeds off a contact below this, in g/w, are taken as zero."""

TOUCHING = 1e-15
"""A part nearer to a contact than this, in g/w^2, that has stopped and is pressed on, touches it:
the height of a hop at 1e-8 g/w, below which a run of hops is at its end."""

LONGEST_STEP = 0.05
"""Of the integrator: an event is missed only if its condition changes sign twice within one."""

MOST_EVENTS = 5000
"""Events of one period; more is a failure."""

MOST_MULTIPLE = 6

X, Y, Z, UX, UY, UZ, SPIN = range(7)
NODES, WEIGHTS = (0.5 * (np.polynomial.legendre.leggauss(5)[k] + (1.0, 0.0)[k]) for k in range(2))


class Point(NamedTuple):
    """The groups of one part, as in `core.motion.stepping.stepped_motion`."""

    drive_number_along: float
    drive_number_across: float
    drive_number_normal: float
    gravity_number_along: float
    gravity_number_across: float
    gravity_number_normal: float
    friction_static: float
    friction_kinetic: float
    curvature_number: float = 0.0
    restitution: float = 0.0
    wall_friction: float = 0.0
    wall_restitution: float = 0.0
    wall: bool = False
    rolling: float = 0.0
    absolute_speed: bool = True


class Mode(NamedTuple):
    """Which contacts carry, and whether they slip; both do or neither."""

    floor: bool
    wall: bool
    slips: bool


class Forces(NamedTuple):
    """Normal forces per weight, and the rates of the three velocities and the spin."""

    normal: float
    side: float
    rates: tuple[float, float, float, float]


class Tally:
    """What a run counts: phases spent in each way, impacts, extremes."""

    def __init__(self) -> None:
        self.stick = self.forward = self.backward = self.flight = 0.0
        self.impacts, self.landing_speed, self.hop_height = 0, 0.0, 0.0


class FailedError(Exception):
    """The contact laws gave no way on, or too many events."""


def reference_path(
    *,
    phases: ArrayLike,
    position: Sequence[float] = (0.0, 0.0, 0.0),
    velocity: Sequence[float] = (0.0, 0.0, 0.0),
    spin: float = 0.0,
    **groups: Any,
) -> Path:
    """Return where one part is at given phases, to about ten digits.

    Parameters
    ----------
    phases : array_like, shape (n,)
        Ascending; the given state is that at the first.
    position, velocity : sequence of 3 floats
        Along, across and normal, in g/w^2 and g/w.
    spin : float
        As in `core.motion.stepping.stepped_path`.
    **groups
        The fields of `Point`.

    Returns
    -------
    Path
    """
    asked = np.atleast_1d(np.asarray(phases, dtype=np.float64))
    if not np.all(np.isfinite(asked)) or np.any(np.diff(asked) < 0.0):
        raise ValueError("phases must be finite and ascend")
    part = _Part(Point(**groups), np.array([*position, *velocity, spin], dtype=np.float64))
    part.phase = float(asked[0])
    rows = np.full((asked.size, 7), np.nan)
    with contextlib.suppress(FailedError):  # what was not reached stays NaN
        part.advance(float(asked[-1]), asked, rows)
    return Path(asked, rows[:, X : Z + 1], rows[:, UX : UZ + 1])


def reference_motion(*, most_periods: int = 100, **groups: Any) -> Motion:
    """Return the motion of one part once it repeats, to about ten digits; arrays of no dimension.

    A transient that dies out as a power is extrapolated to its end; `error` is what the last
    extrapolations differed by. Motion that does not repeat to 1e-11 is `aperiodic`, its means are
    over the second half of the periods run, and its spread is that of the single periods; whether
    it runs away is for the reader to see.

    Parameters
    ----------
    most_periods : int
        Periods after which the motion counts as aperiodic.
    **groups
        The fields of `Point`.
    """
    part = _Part(Point(**groups), np.zeros(7))
    states, tallies = [part.state.copy()], []
    for period in range(most_periods):
        part.tally = Tally()
        try:
            part.advance(2.0 * math.pi * (period + 1))
        except FailedError:
            return _result(math.nan, math.nan, math.nan, [], 0, "no_solution")
        tallies.append(part.tally)
        states.append(part.state.copy())
        moved = part.tally.forward + part.tally.backward + part.tally.flight
        if moved == 0.0 and np.array_equal(states[-1], states[-2]):
            return _result(0.0, 0.0, 0.0, tallies[-1:], 1, "at_rest")
        for multiple in range(1, min(MOST_MULTIPLE, (period + 1) // 4) + 1):
            found = _limit(states, multiple)
            if found is not None:
                return _result(*found, 0.0, tallies[-multiple:], multiple, "periodic")
    half = len(tallies) // 2
    travels = np.diff([state[X] for state in states])[half:] / (2.0 * math.pi)
    spread = float(np.std(travels))
    return _result(float(np.mean(travels)), spread, spread, tallies[half:], 0, "aperiodic")


def _limit(states: list[Array], multiple: int) -> tuple[float, float] | None:
    """Return mean velocity and its error if the last periods converge with this multiple."""
    ends = np.array([states[-1 - k * multiple] for k in range(5)])
    velocity = (ends[:-1, X] - ends[1:, X]) / (2.0 * math.pi * multiple)
    apart = np.abs(ends[:-1, Z:] - ends[1:, Z:]).max(axis=1)
    if max(apart[0], apart[1], abs(velocity[0] - velocity[1])) < 1e-11:
        return float(velocity[0]), float(abs(velocity[0] - velocity[1]))
    if not (apart[0] < 0.999 * apart[1] < apart[2] and apart[0] < 1e-3):
        return None
    limits = []
    for new, middle, old in (velocity[:3], velocity[1:]):
        change = (new - middle) - (middle - old)
        if change == 0.0:
            return None
        limits.append(new - (new - middle) ** 2 / change)
    error = float(abs(limits[0] - limits[1]))
    return (float(limits[0]), error) if error < 1e-11 else None


def _result(
    velocity: float, error: float, spread: float, tallies: list[Tally], multiple: int, status: str
) -> Motion:
    """Return the counts of some periods as a result."""
    phase = 2.0 * math.pi * max(1, len(tallies))

    def total(name: str) -> float:
        return sum(getattr(tally, name) for tally in tallies)

    def most(name: str) -> float:
        return max((getattr(tally, name) for tally in tallies), default=math.nan)

    values = (
        velocity, spread, error,
        *(total(name) / phase for name in ("stick", "forward", "backward", "flight")),
        total("impacts") / max(1, len(tallies)), most("landing_speed"), most("hop_height"),
        float(multiple),
    )  # fmt: skip
    arrays = (np.asarray(value, dtype=np.float64) for value in values)
    return Motion._make((*arrays, np.asarray(STATUS[status], dtype=np.int8)))


class _Part:
    """One part on its way: its state, the contacts that touch, the phase."""

    def __init__(self, point: Point, state: Array) -> None:
        self.point, self.state, self.phase, self.tally = point, state, 0.0, Tally()
        self.response = 1.0 + point.rolling
        # Touching: no distance and no speed off the contact.
        self.on_floor = bool(state[Z] == 0.0 and state[UZ] == 0.0)
        self.on_wall = bool(point.wall and state[Y] == 0.0 and state[UY] == 0.0)

    # --- forces

    def free(self, phase: float, ux: float) -> tuple[float, float, float]:
        """Return the acceleration of a free part relative to the track (theory 13.1)."""
        p, sine = self.point, math.sin(phase)
        speed = ux + p.drive_number_along * math.cos(phase) if p.absolute_speed else ux
        return (
            p.drive_number_along * sine - p.gravity_number_along,
            p.drive_number_across * sine
            - p.gravity_number_across
            - p.curvature_number * speed * speed,
            p.drive_number_normal * sine - p.gravity_number_normal,
        )

    def forces(self, phase: float, mode: Mode, ux: float, e: tuple[float, float]) -> Forces:
        """Return forces and rates in a mode; `e` is the direction of the slip, if it slips."""
        p, (dx, dy, dz) = self.point, self.free(phase, ux)
        if mode.floor and mode.wall:
            if not mode.slips:
                return Forces(-dz, -dy, (0.0, 0.0, 0.0, 0.0))
            k, m, es = p.friction_kinetic, p.wall_friction, e[1]
            normal = (-dz + m * es * dy) / (1.0 + m * k * es * es)
            side = -dy + k * es * normal
            drag = k * normal + m * side
            return Forces(normal, side, (dx - drag * e[0], 0.0, 0.0, -p.rolling * drag * es))
        if mode.floor:
            if mode.slips:
                fx, fy = (p.friction_kinetic * dz * component for component in e)
            else:
                fx, fy = -dx, -dy / self.response
            return Forces(-dz, 0.0, (dx + fx, dy + fy, 0.0, p.rolling * fy))
        if mode.wall:
            if mode.slips:
                wx, wz = (p.wall_friction * dy * component for component in e)
            else:
                wx, wz = -dx, -dz / self.response
            return Forces(0.0, -dy, (dx + wx, 0.0, dz + wz, -p.rolling * wz))
        return Forces(0.0, 0.0, (dx, dy, dz, 0.0))

    def slip(self, mode: Mode, state: Array) -> tuple[float, float]:
        """Return the two components of the slip of the contact, or of both contacts at once."""
        if mode.floor and mode.wall:  # the floor has (u_x, spin), the wall (u_x, -spin)
            return float(state[UX]), float(state[SPIN])
        if mode.floor:
            return float(state[UX]), float(state[UY] + state[SPIN])
        return float(state[UX]), float(state[UZ] - state[SPIN])

    def impending(self, phase: float, mode: Mode) -> tuple[float, float, float, float]:
        """Return push (two components), what sliding takes of it, and what sticking could."""
        p, (dx, dy, dz) = self.point, self.free(phase, 0.0)
        if mode.floor and mode.wall:
            side = -p.wall_friction * dy
            return dx, 0.0, -p.friction_kinetic * dz + side, -p.friction_static * dz + side
        if mode.floor:
            return dx, dy, -p.friction_kinetic * dz, -p.friction_static * dz
        return dx, dz, -p.wall_friction * dy, -p.wall_friction * dy

    def excess(self, phase: float, mode: Mode) -> float:
        """Return by how much the push is more than friction holds."""
        first, second, _, hold = self.impending(phase, mode)
        return math.hypot(first, second / self.response) - hold

    def onset_direction(self, phase: float, mode: Mode) -> tuple[float, float]:
        """Return the direction in which slip begins: the secular equation of theory 7.3."""
        first, second, slide, _ = self.impending(phase, mode)
        return self.secular(first, second, slide)

    def secular(self, first: float, second: float, slide: float) -> tuple[float, float]:
        """Return the direction of the slip left by friction of the size `slide`."""
        response, size = self.response, math.hypot(first, second)
        if response == 1.0:
            return first / size, second / size
        low, high = 0.0, size
        for _ in range(200):  # halving: slow, and without anything of the stepping method
            z = 0.5 * (low + high)
            if z in (low, high):
                break
            if math.hypot(first / (z + slide), second / (z + response * slide)) > 1.0:
                low = z
            else:
                high = z
        e = first / (high + slide), second / (high + response * slide)
        return e[0] / math.hypot(*e), e[1] / math.hypot(*e)

    # --- modes

    def choose(self, opened: str) -> Mode:
        """Return the mode in which the part goes on; `opened` names a contact just lost."""
        self.settle()
        for _ in range(3):
            _, dy, dz = self.free(self.phase, float(self.state[UX]))
            floor = self.on_floor and opened != "floor" and dz < 0.0
            wall = self.on_wall and opened != "wall" and dy < 0.0
            if not (floor or wall):
                return Mode(False, False, True)
            mode = Mode(floor, wall, True)
            slip = self.slip(mode, self.state)
            if math.hypot(*slip) <= STOPPED:
                self.stop(mode)
                # An event found at its threshold is one: the slip starts.
                begins = opened == "slip" or self.excess(self.phase, mode) > 0.0
                return Mode(floor, wall, begins)
            size = math.hypot(*slip)
            e = (slip[0] / size, slip[1] / size)
            found = self.forces(self.phase, mode, float(self.state[UX]), e)
            if floor and found.normal < 0.0:
                opened = "floor"
            elif wall and found.side < 0.0:
                opened = "wall"
            else:
                return mode
        raise FailedError

    def settle(self) -> None:
        """Put a part that has stopped next to a contact, and is pressed on it, onto it.

        A slip along the wall may stop amid the last hops on the floor; it would begin anew with a
        phase that is longer than a hop, for ever.
        """
        s = self.state
        _, dy, dz = self.free(self.phase, float(s[UX]))
        if not self.on_floor and dz < 0.0 and abs(s[Z]) <= TOUCHING and abs(s[UZ]) <= STOPPED:
            s[Z], s[UZ], self.on_floor = 0.0, 0.0, True
        if not self.point.wall or self.on_wall:
            return
        if dy < 0.0 and abs(s[Y]) <= TOUCHING and abs(s[UY]) <= STOPPED:
            s[Y], s[UY], self.on_wall = 0.0, 0.0, True

    def stop(self, mode: Mode) -> None:
        """Take away a slip that is zero but for rounding."""
        s, p = self.state, self.point
        s[UX] = 0.0
        if mode.floor and mode.wall:
            s[SPIN] = 0.0
        elif mode.floor:
            s[UY] = 0.0 if p.rolling == 0.0 else s[UY]
            s[SPIN] = -s[UY] if p.rolling else 0.0
        else:
            s[UZ] = 0.0 if p.rolling == 0.0 else s[UZ]
            s[SPIN] = s[UZ] if p.rolling else 0.0

    # --- the equations of a mode

    def pack(self, mode: Mode, state: Array) -> Array:
        """Return the unknowns of a mode: of a slip its size and direction, smooth through zero."""
        if not mode.slips or not (mode.floor or mode.wall):
            return state.copy()
        first, second = self.slip(mode, state)
        other = state[UY] if mode.floor else state[UZ]
        return np.array([
            *state[:UX], math.hypot(first, second), math.atan2(second, first), other,
        ])  # fmt: skip

    def unpack(self, mode: Mode, unknowns: Array) -> Array:
        """Return the state of a mode's unknowns."""
        if not mode.slips or not (mode.floor or mode.wall):
            return unknowns
        x, y, z, size, angle, other = unknowns
        first, second = size * math.cos(angle), size * math.sin(angle)
        if mode.floor and mode.wall:
            return np.array([x, y, z, first, 0.0, 0.0, second])
        spin = second - other if mode.floor else other - second
        if self.point.rolling == 0.0:
            other, spin = second, 0.0
        if mode.floor:
            return np.array([x, y, z, first, other, 0.0, spin])
        return np.array([x, y, z, first, 0.0, other, spin])

    def derivative(self, mode: Mode) -> Callable[[float, Array], Array]:
        """Return the right-hand side of a mode."""

        def stuck_or_free(phase: float, s: Array) -> Array:
            rates = self.forces(phase, mode, float(s[UX]), (0.0, 0.0)).rates
            return np.array([s[UX], s[UY], s[UZ], *rates])

        def sliding(phase: float, unknowns: Array) -> Array:
            state = self.unpack(mode, unknowns)
            size, angle = unknowns[3], unknowns[4]
            e = math.cos(angle), math.sin(angle)
            ax, ay, az, spin = self.forces(phase, mode, float(state[UX]), e).rates
            second = spin if mode.floor and mode.wall else ay + spin if mode.floor else az - spin
            turn = e[0] * second - e[1] * ax
            # A slip that stays on one line passes through zero there; it does not turn.
            turning = turn / size if abs(turn) > 1e-15 and size != 0.0 else 0.0
            return np.array([
                state[UX], state[UY], state[UZ], e[0] * ax + e[1] * second, turning,
                ay if mode.floor else az,
            ])  # fmt: skip

        return sliding if mode.slips and (mode.floor or mode.wall) else stuck_or_free

    def events(self, mode: Mode) -> list[Any]:
        """Return the conditions that end a mode, each with its name and the sense of its change."""
        found: list[Any] = []

        def add(name: str, sense: int, value: Callable[[float, Array], float]) -> None:
            def event(phase: float, unknowns: Array) -> float:
                return value(phase, unknowns)

            event.terminal, event.direction, event.contact = True, sense, name  # type: ignore[attr-defined]
            found.append(event)

        def carried(contact: str) -> Callable[[float, Array], float]:
            def value(phase: float, unknowns: Array) -> float:
                state = self.unpack(mode, unknowns)
                angle = unknowns[4]
                e = (math.cos(angle), math.sin(angle)) if mode.slips else (0.0, 0.0)
                return float(getattr(self.forces(phase, mode, float(state[UX]), e), contact))

            return value

        def approach(place: int, speed: int) -> Callable[[float, Array], float]:
            def value(phase: float, unknowns: Array) -> float:
                state = self.unpack(mode, unknowns)
                gap = float(state[place])
                return gap if state[speed] < -STOPPED else max(gap, 1e-300)

            return value

        if mode.floor:
            add("lift", -1, carried("normal"))
        else:
            add("land", -1, approach(Z, UZ))
        if mode.wall:
            add("leave", -1, carried("side"))
        elif self.on_wall:  # still touching: held by the floor
            add("press", 1, lambda phase, _: -self.free(phase, 0.0)[1] - TOLERANCE)
        elif self.point.wall:
            add("bump", -1, approach(Y, UY))
        if mode.floor or mode.wall:
            if mode.slips:
                add("stop", -1, lambda _, unknowns: float(unknowns[3]) - STOPPED)
            else:
                add("slip", 1, lambda phase, _: self.excess(phase, mode))
        return found

    # --- going on

    def advance(self, end: float, asked: Array | None = None, rows: Array | None = None) -> None:
        """Go on to a phase, event by event; fill the rows of the asked phases passed."""
        from scipy.integrate import solve_ivp

        opened, still = "", 0
        if asked is not None and rows is not None:
            rows[asked <= self.phase] = self.state
        for _ in range(MOST_EVENTS):
            if self.phase >= end:
                return
            if missed := self.missed():
                opened = self.happen(missed, Mode(False, False, True))
                continue
            mode = self.choose(opened)
            touching = mode.floor or mode.wall
            if mode.slips and touching and math.hypot(*self.slip(mode, self.state)) <= STOPPED:
                self.begin(mode, end, asked, rows)
                opened = ""
                continue
            self.on_floor = mode.floor
            # Without slip a block stays at the wall though it does not press on it.
            held = mode.floor and not mode.slips and self.point.rolling == 0.0
            self.on_wall = mode.wall or (self.on_wall and held)
            events = self.events(mode)
            start = self.phase
            solution = solve_ivp(
                self.derivative(mode), (start, end), self.pack(mode, self.state), method="DOP853",
                rtol=TOLERANCE, atol=1e-14, max_step=LONGEST_STEP, events=events,
                dense_output=True,
            )  # fmt: skip
            if not solution.success:
                raise FailedError
            reached = float(solution.t[-1])
            self.phase, self.state = reached, self.unpack(mode, solution.y[:, -1]).copy()
            self.note(mode, solution, start)
            if asked is not None and rows is not None:
                for k in np.nonzero((asked > start) & (asked <= reached))[0]:
                    rows[k] = self.unpack(mode, solution.sol(asked[k]))
            opened = ""
            for event, phases in zip(events, solution.t_events, strict=True):
                if phases.size:
                    opened = self.happen(event.contact, mode)
            still = still + 1 if reached == start else 0
            if still > 20:  # round in a circle at one phase
                raise FailedError
        raise FailedError

    def missed(self) -> str:
        """Return the impact that is due at once, where another event came within its rounding.

        The integrator sees an event only where its condition changes sign later on.
        """
        s = self.state
        if s[Z] <= 0.0 and s[UZ] < -STOPPED:
            return "land"
        if self.point.wall and s[Y] <= 0.0 and s[UY] < -STOPPED:
            return "bump"
        return ""

    def happen(self, event: str, mode: Mode) -> str:
        """Change the state as an event says; return which contact it opened, or "slip"."""
        if event == "lift":
            return "floor"
        if event == "leave":
            return "wall"
        if event == "slip":
            return "slip"
        if event == "stop":
            self.stop(mode)
        elif event == "land":
            self.tally.impacts += 1
            self.tally.landing_speed = max(self.tally.landing_speed, -float(self.state[UZ]))
            self.state[Z] = 0.0
            self.impact(True, self.on_wall)
        elif event == "bump":
            self.state[Y] = 0.0
            self.impact(self.on_floor, True)
        return ""

    def begin(self, mode: Mode, end: float, asked: Array | None, rows: Array | None) -> None:
        """Begin a slip from rest over a short phase, where its direction is that of the push.

        The direction of a slip of size zero is singular; it follows the push with a lag of the
        order of the slip. The phase is short enough for that to be beyond ten digits.
        """
        first, second, slide, _ = self.impending(self.phase, mode)
        gain = max(0.0, math.hypot(first, second) - self.response * slide)
        whole = min(1e-3, 1e-7 / gain if gain > 0.0 else 1e-3, end - self.phase)
        origin, start = self.state.copy(), self.phase

        def after(phase: float) -> Array:
            state = origin.copy()
            for node, weight in zip(NODES, WEIGHTS, strict=True):
                when = start + node * phase
                e = self.onset_direction(when, mode)
                rates = np.array(self.forces(when, mode, 0.0, e).rates)
                state[UX:] += weight * phase * rates
                state[:UX] += weight * phase * (1.0 - node) * phase * rates[:3]
            state[:UX] += phase * origin[UX:SPIN]
            return state

        self.phase = start + whole
        self.state = after(whole)
        if math.hypot(*self.slip(mode, self.state)) <= STOPPED:
            # Too slow to tell from rest: put it on its way, by less than is resolved.
            e = self.onset_direction(self.phase, mode)
            self.state[UX] += 2.0 * STOPPED * e[0]
            if mode.floor and mode.wall:
                pass
            elif mode.floor:
                self.state[UY] += 2.0 * STOPPED * e[1]
            else:
                self.state[UZ] += 2.0 * STOPPED * e[1]
        if self.on_wall and not mode.wall:
            self.on_wall = False
        if asked is not None and rows is not None:
            for k in np.nonzero((asked > start) & (asked <= self.phase))[0]:
                rows[k] = after(float(asked[k]) - start)
        self.count(mode, float(self.state[UX]), whole)

    def impact(self, floor: bool, wall: bool) -> None:
        """Apply the impulses of a landing or of an impact on the wall, or of both (theory 13.1)."""
        p, s = self.point, self.state
        target_z, target_y = -p.restitution * s[UZ], -p.wall_restitution * s[UY]
        normal = side = fx = fy = wx = wz = 0.0
        for _ in range(500):
            before = (normal, side, fx, fy, wx, wz)
            if floor:
                new = max(0.0, normal - (s[UZ] - target_z))
                s[UZ] += new - normal
                normal = new
            if wall:
                new = max(0.0, side - (s[UY] - target_y))
                s[UY] += new - side
                side = new
            if floor:
                gx, gy = self.stopping(
                    s[UX] - fx, s[UY] + s[SPIN] - self.response * fy, p.friction_kinetic * normal
                )
                s[UX] += gx - fx
                s[UY] += gy - fy
                s[SPIN] += p.rolling * (gy - fy)
                fx, fy = gx, gy
            if wall:
                gx, gz = self.stopping(
                    s[UX] - wx, s[UZ] - s[SPIN] - self.response * wz, p.wall_friction * side
                )
                s[UX] += gx - wx
                s[UZ] += gz - wz
                s[SPIN] -= p.rolling * (gz - wz)
                wx, wz = gx, gz
            after = (normal, side, fx, fy, wx, wz)
            if max(abs(a - b) for a, b in zip(after, before, strict=True)) < 1e-15:
                break
        else:
            raise FailedError
        if floor and abs(s[UZ]) < STOPPED:  # a run of hops ends (theory 13.5)
            s[UZ], self.on_floor = 0.0, True
        elif floor:
            self.on_floor = False
        if wall and abs(s[UY]) < STOPPED:
            s[UY], self.on_wall = 0.0, True
        elif wall:
            self.on_wall = False

    def stopping(self, first: float, second: float, limit: float) -> tuple[float, float]:
        """Return the impulse of friction that stops a slip, or as much as the disc allows."""
        if math.hypot(first, second / self.response) <= limit:
            return -first, -second / self.response
        e = self.secular(first, second, limit)
        return -limit * e[0], -limit * e[1]

    # --- counting

    def note(self, mode: Mode, solution: Any, start: float) -> None:
        """Count the phase of a finished piece, by the direction along the track."""
        phases = solution.t
        states = [self.unpack(mode, column) for column in solution.y.T]
        for k in range(len(phases) - 1):
            middle = 0.5 * float(states[k][UX] + states[k + 1][UX])
            self.count(mode, middle, float(phases[k + 1] - phases[k]))
        if not mode.floor:
            for k in range(len(phases) - 1):
                u, v = float(states[k][UZ]), float(states[k + 1][UZ])
                top = max(float(states[k][Z]), float(states[k + 1][Z]))
                if u > 0.0 > v:  # the top lies within
                    share = phases[k] + (phases[k + 1] - phases[k]) * u / (u - v)
                    top = max(top, float(self.unpack(mode, solution.sol(share))[Z]))
                self.tally.hop_height = max(self.tally.hop_height, top)

    def count(self, mode: Mode, ux: float, duration: float) -> None:
        """Add a duration to what the part does meanwhile."""
        if not mode.floor:
            self.tally.flight += duration
        elif ux > STOPPED:
            self.tally.forward += duration
        elif ux < -STOPPED:
            self.tally.backward += duration
        else:
            self.tally.stick += duration
