"""One part on its way from event to event, integrated at high order between them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from core.mechanics.arrays import Array
from core.motion.methods.reference.laws import SPIN, UX, UY, UZ, Laws, Mode, Y, Z

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

NODES, WEIGHTS = (0.5 * (np.polynomial.legendre.leggauss(5)[k] + (1.0, 0.0)[k]) for k in range(2))


class Tally:
    """What a run counts: phases spent in each way, impacts, extremes."""

    def __init__(self) -> None:
        self.stick = self.forward = self.backward = self.flight = 0.0
        self.impacts, self.landing_speed, self.hop_height = 0, 0.0, 0.0


class FailedError(Exception):
    """The contact laws gave no way on, or too many events."""


class Part:
    """One part on its way: its state, the contacts that touch, the phase."""

    def __init__(self, laws: Laws, state: Array) -> None:
        self.laws, self.state, self.phase, self.tally = laws, state, 0.0, Tally()
        # Touching: no distance and no speed off the contact.
        self.on_floor = bool(state[Z] == 0.0 and state[UZ] == 0.0)
        self.on_wall = bool(laws.contacts.wall and state[Y] == 0.0 and state[UY] == 0.0)

    # --- modes

    def choose(self, opened: str) -> Mode:
        """Return the mode in which the part goes on; `opened` names a contact just lost."""
        self.settle()
        for _ in range(3):
            _, dy, dz = self.laws.free(self.phase, float(self.state[UX]))
            floor = self.on_floor and opened != "floor" and dz < 0.0
            wall = self.on_wall and opened != "wall" and dy < 0.0
            if not (floor or wall):
                return Mode(False, False, True)
            mode = Mode(floor, wall, True)
            slip = self.laws.slip(mode, self.state)
            if math.hypot(*slip) <= STOPPED:
                self.stop(mode)
                # An event found at its threshold is one: the slip starts.
                begins = opened == "slip" or self.laws.excess(self.phase, mode) > 0.0
                return Mode(floor, wall, begins)
            size = math.hypot(*slip)
            e = (slip[0] / size, slip[1] / size)
            found = self.laws.forces(self.phase, mode, float(self.state[UX]), e)
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
        _, dy, dz = self.laws.free(self.phase, float(s[UX]))
        if not self.on_floor and dz < 0.0 and abs(s[Z]) <= TOUCHING and abs(s[UZ]) <= STOPPED:
            s[Z], s[UZ], self.on_floor = 0.0, 0.0, True
        if not self.laws.contacts.wall or self.on_wall:
            return
        if dy < 0.0 and abs(s[Y]) <= TOUCHING and abs(s[UY]) <= STOPPED:
            s[Y], s[UY], self.on_wall = 0.0, 0.0, True

    def stop(self, mode: Mode) -> None:
        """Take away a slip that is zero but for rounding."""
        s, rolling = self.state, self.laws.contacts.rolling
        s[UX] = 0.0
        if mode.floor and mode.wall:
            s[SPIN] = 0.0
        elif mode.floor:
            s[UY] = 0.0 if rolling == 0.0 else s[UY]
            s[SPIN] = -s[UY] if rolling else 0.0
        else:
            s[UZ] = 0.0 if rolling == 0.0 else s[UZ]
            s[SPIN] = s[UZ] if rolling else 0.0

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
                state = self.laws.unpack(mode, unknowns)
                angle = unknowns[4]
                e = (math.cos(angle), math.sin(angle)) if mode.slips else (0.0, 0.0)
                return float(getattr(self.laws.forces(phase, mode, float(state[UX]), e), contact))

            return value

        def approach(place: int, speed: int) -> Callable[[float, Array], float]:
            def value(phase: float, unknowns: Array) -> float:
                state = self.laws.unpack(mode, unknowns)
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
            add("press", 1, lambda phase, _: -self.laws.free(phase, 0.0)[1] - TOLERANCE)
        elif self.laws.contacts.wall:
            add("bump", -1, approach(Y, UY))
        if mode.floor or mode.wall:
            if mode.slips:
                add("stop", -1, lambda _, unknowns: float(unknowns[3]) - STOPPED)
            else:
                add("slip", 1, lambda phase, _: self.laws.excess(phase, mode))
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
            if mode.slips and touching and math.hypot(*self.laws.slip(mode, self.state)) <= STOPPED:
                self.begin(mode, end, asked, rows)
                opened = ""
                continue
            self.on_floor = mode.floor
            # Without slip a block stays at the wall though it does not press on it.
            held = mode.floor and not mode.slips and self.laws.contacts.rolling == 0.0
            self.on_wall = mode.wall or (self.on_wall and held)
            events = self.events(mode)
            start = self.phase
            solution = solve_ivp(
                self.laws.derivative(mode), (start, end), self.laws.pack(mode, self.state),
                method="DOP853",
                rtol=TOLERANCE, atol=1e-14, max_step=LONGEST_STEP, events=events,
                dense_output=True,
            )  # fmt: skip
            if not solution.success:
                raise FailedError
            reached = float(solution.t[-1])
            self.phase, self.state = reached, self.laws.unpack(mode, solution.y[:, -1]).copy()
            self.note(mode, solution, start)
            if asked is not None and rows is not None:
                for k in np.nonzero((asked > start) & (asked <= reached))[0]:
                    rows[k] = self.laws.unpack(mode, solution.sol(asked[k]))
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
        if self.laws.contacts.wall and s[Y] <= 0.0 and s[UY] < -STOPPED:
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
        first, second, slide, _ = self.laws.impending(self.phase, mode)
        gain = max(0.0, math.hypot(first, second) - self.laws.response * slide)
        whole = min(1e-3, 1e-7 / gain if gain > 0.0 else 1e-3, end - self.phase)
        origin, start = self.state.copy(), self.phase

        def after(phase: float) -> Array:
            state = origin.copy()
            for node, weight in zip(NODES, WEIGHTS, strict=True):
                when = start + node * phase
                e = self.laws.onset_direction(when, mode)
                rates = np.array(self.laws.forces(when, mode, 0.0, e).rates)
                state[UX:] += weight * phase * rates
                state[:UX] += weight * phase * (1.0 - node) * phase * rates[:3]
            state[:UX] += phase * origin[UX:SPIN]
            return state

        self.phase = start + whole
        self.state = after(whole)
        if math.hypot(*self.laws.slip(mode, self.state)) <= STOPPED:
            # Too slow to tell from rest: put it on its way, by less than is resolved.
            e = self.laws.onset_direction(self.phase, mode)
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
        p, rolling, s = self.laws.groups, self.laws.contacts.rolling, self.state
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
                gx, gy = self.laws.stopping(
                    s[UX] - fx,
                    s[UY] + s[SPIN] - self.laws.response * fy,
                    p.friction_kinetic * normal,
                )
                s[UX] += gx - fx
                s[UY] += gy - fy
                s[SPIN] += rolling * (gy - fy)
                fx, fy = gx, gy
            if wall:
                gx, gz = self.laws.stopping(
                    s[UX] - wx, s[UZ] - s[SPIN] - self.laws.response * wz, p.wall_friction * side
                )
                s[UX] += gx - wx
                s[UZ] += gz - wz
                s[SPIN] -= rolling * (gz - wz)
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

    # --- counting

    def note(self, mode: Mode, solution: Any, start: float) -> None:
        """Count the phase of a finished piece, by the direction along the track."""
        phases = solution.t
        states = [self.laws.unpack(mode, column) for column in solution.y.T]
        for k in range(len(phases) - 1):
            middle = 0.5 * float(states[k][UX] + states[k + 1][UX])
            self.count(mode, middle, float(phases[k + 1] - phases[k]))
        if not mode.floor:
            for k in range(len(phases) - 1):
                u, v = float(states[k][UZ]), float(states[k + 1][UZ])
                top = max(float(states[k][Z]), float(states[k + 1][Z]))
                if u > 0.0 > v:  # the top lies within
                    share = phases[k] + (phases[k + 1] - phases[k]) * u / (u - v)
                    top = max(top, float(self.laws.unpack(mode, solution.sol(share))[Z]))
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
