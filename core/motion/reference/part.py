"""One part on its way from event to event, with its smooth motion solved between them."""

import math

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.reference.laws import SPIN, UX, UY, UZ, Mode, ReferenceLaws, Y, Z
from vibrafeed.core.motion.reference.stretch import (
    AT,
    FROM_NODES,
    MEAN,
    MEAN_TWICE,
    USUAL,
    Care,
    Stretch,
    crossings,
    fall_from_start,
    first_fall,
    solve,
    values,
)
from vibrafeed.core.scenes import soft_contact
from vibrafeed.core.watch import Watch

STOPPED = 1e-13
"""Slips and speeds off a contact below this, in g/w, are taken as zero."""

TOUCHING = 1e-14
"""A part nearer to a contact than this, in g/w^2, touches it if it is pressed on."""

PRESSED = 1e-12
"""In g: a part that friction of the floor holds at the wall presses on it above this."""

RESOLVED = 1e-16
"""In g/w: smaller last coefficients of a slip's change are rounding."""

SOFT_HOP = 1e-4
"""As `Care.hop`, where restitution falls with the speed of impact."""

MAX_CUTS = 100
"""Most cuts of a stretch that the nodes do not resolve: each leaves at most 0.9 of it, so that 1e-5
is left."""

MAX_EVENTS = 20_000
"""Most events and stretches of one period: hops at restitution 0.999 are 16,000 until they have
shrunk to 1e-7. More is a failure."""


class Tally:
    """The sums of a run: phases spent in each way, impacts, extremes, contact with the wall."""

    def __init__(self) -> None:
        self.stick = self.forward = self.backward = self.flight = 0.0
        self.impacts, self.landing_speed, self.hop_height = 0, 0.0, 0.0
        self.at_wall, self.nearest = False, math.inf
        self.events: list[str] = []


class FailedError(Exception):
    """The contact laws gave no way on, or too many events."""


class Part:
    """One part on its way: its state, the contacts that touch, and the phase in rad.

    The `watch` may stop it.
    """

    def __init__(
        self, laws: ReferenceLaws, state: Array, care: Care = USUAL, watch: Watch | None = None
    ) -> None:
        self.laws, self.state, self.phase, self.tally = laws, state, 0.0, Tally()
        self.care, self.reach, self.watch = care, care.longest, watch or Watch()
        self.until = math.inf  # the phase at which the push may jump
        # Touching: no distance and no speed off the contact.
        self.on_floor = bool(state[Z] == 0.0 and state[UZ] == 0.0)
        self.on_wall = bool(laws.contacts.wall and state[Y] == 0.0 and state[UY] == 0.0)

    # --- modes

    def choose_mode(self, lost_contact: str) -> Mode:
        """Return the contact mode in which the part continues: what carries it, and if it slips.

        `lost_contact` is the contact just lost ("floor", "wall"), "slip" if friction has just given
        way, or "". Raises `FailedError` if no mode fits.
        """
        self.put_on_contacts()
        for _ in range(3):
            _, free_y, free_z = self.laws.free(self.phase, float(self.state[UX]))
            floor = self.on_floor and lost_contact != "floor" and free_z < 0.0
            wall = self.on_wall and lost_contact != "wall" and free_y < 0.0
            if not (floor or wall):
                return Mode(False, False, True)
            mode = Mode(floor, wall, True)
            slip = self.laws.slip(mode, self.state)
            if math.hypot(*slip) <= STOPPED:
                self.stop(mode)
                # An event found at its threshold is one: the slip starts.
                begins = lost_contact == "slip" or self.laws.excess(self.phase, mode) > 0.0
                return Mode(floor, wall, bool(begins))
            size = math.hypot(*slip)
            direction = (slip[0] / size, slip[1] / size)
            forces = self.laws.forces(self.phase, mode, float(self.state[UX]), direction)
            if floor and forces.normal < 0.0:
                lost_contact = "floor"
            elif wall and forces.side < 0.0:
                lost_contact = "wall"
            else:
                return mode
        raise FailedError

    def put_on_contacts(self) -> None:
        """Put a part that has stopped beside floor or wall onto it, if it is pressed towards it.

        A slip along the wall may stop during the last hops on the floor: it would otherwise begin
        anew for ever, with a stretch longer than a hop.
        """
        state = self.state
        _, free_y, free_z = self.laws.free(self.phase, float(state[UX]))
        if (
            not self.on_floor
            and free_z < 0.0
            and abs(state[Z]) <= TOUCHING
            and abs(state[UZ]) <= STOPPED
        ):
            state[Z], state[UZ], self.on_floor = 0.0, 0.0, True
        if not self.laws.contacts.wall or self.on_wall:
            return
        if free_y < 0.0 and abs(state[Y]) <= TOUCHING and abs(state[UY]) <= STOPPED:
            state[Y], state[UY], self.on_wall = 0.0, 0.0, True

    def stop(self, mode: Mode) -> None:
        """Set a slip that has come to zero within rounding to exactly zero.

        `mode` holds the contacts that carry the part. A block loses its velocity along the contact;
        a cylinder that does not touch both floor and wall keeps the second component, and gets the
        spin with which it rolls.
        """
        state, rolling = self.state, self.laws.contacts.rolling
        state[UX] = 0.0
        if mode.floor and mode.wall:
            state[SPIN] = 0.0
        elif mode.floor:
            state[UY] = 0.0 if rolling == 0.0 else state[UY]
            state[SPIN] = -state[UY] if rolling else 0.0
        else:
            state[UZ] = 0.0 if rolling == 0.0 else state[UZ]
            state[SPIN] = state[UZ] if rolling else 0.0

    # --- events

    def first_event(self, mode: Mode, stretch: Stretch, begins: bool) -> tuple[float, str]:
        """Return the first event of a stretch of motion: its point from 0 to 1, and its name.

        (1, "") if there is none. Each event is the first root of a condition, such as a gap, a
        load, or what static friction has left. `begins` is True if a slip starts from rest.
        """
        events = [(1.0, "")]
        phases = stretch.start + stretch.length * AT
        if mode.floor:
            events.append((fall_from_start(stretch.normal), "lift"))
        else:
            events.append((self.strike_point(stretch, Z, UZ), "land"))
        if mode.wall:
            events.append((fall_from_start(stretch.side), "leave"))
        elif self.on_wall:  # still touching: held by the floor
            pressed = FROM_NODES @ (self.laws.free(phases, 0.0)[1] + PRESSED)
            events.append((fall_from_start(pressed), "press"))
        elif self.laws.contacts.wall:
            events.append((self.strike_point(stretch, Y, UY), "bump"))
        if mode.floor or mode.wall:
            if not mode.slips:
                first, second, _, _ = self.laws.impending(phases, mode)
                if np.any(first) or np.any(second):  # else what floats off does not slip before
                    friction_left = FROM_NODES @ -self.laws.excess(phases, mode)
                    events.append((fall_from_start(friction_left), "slip"))
            elif begins:  # it is 0 at the start: what is left without that root
                events.append((first_fall(MEAN @ stretch.growth), "stop"))
            else:
                events.append((fall_from_start(stretch.size), "stop"))
        return min(events, key=lambda event: event[0])

    def strike_point(self, stretch: Stretch, axis: int, speed: int) -> float:
        """Return the point of a stretch, 0 to 1, at which the part strikes a contact; else inf.

        `axis` and `speed` are the places of the distance and of its velocity in the state. If the
        part starts at the contact, the distance is divided by its root at the start, a double one
        if it has no speed there: so small hops and grazes differ from none.
        """
        if self.state[axis] > TOUCHING:
            return first_fall(stretch.states[axis])
        if self.state[speed] > STOPPED:
            return first_fall(MEAN @ stretch.states[speed])
        return fall_from_start(MEAN_TWICE @ stretch.rates[speed - UX])

    def due_impact(self) -> str:
        """Return the impact ("land", "bump") that is due at once, or "" if there is none.

        The search for events finds only conditions that change sign later on, so that an impact at
        the very phase of another event would be missed.
        """
        state = self.state
        if state[Z] <= 0.0 and state[UZ] < -STOPPED:
            return "land"
        if self.laws.contacts.wall and state[Y] <= 0.0 and state[UY] < -STOPPED:
            return "bump"
        return ""

    def apply_event(self, event: str, mode: Mode) -> str:
        """Change the state of the part by an event; return the contact lost, "slip", or "".

        `event` is "lift" (off the floor), "leave" (the wall), "slip" (static friction gives way),
        "stop", "land", "bump" (against the wall), or "" for none. The next mode must not undo what
        is returned. `mode` holds the contacts before the event.
        """
        if event:
            self.tally.events.append(event)
        if event == "stop":
            self.stop(mode)
        elif event == "land":
            self.tally.impacts += 1
            self.tally.landing_speed = max(self.tally.landing_speed, -float(self.state[UZ]))
            self.state[Z] = 0.0
            self.impact(True, self.on_wall)
        elif event == "bump":
            self.tally.at_wall = True
            self.state[Y] = 0.0
            self.impact(self.on_floor, True)
        return {"lift": "floor", "leave": "wall", "slip": "slip"}.get(event, "")

    # --- going on

    def advance(
        self, end: float, sample_phases: Array | None = None, rows: Array | None = None
    ) -> None:
        """Advance the part to the phase `end` in rad, event by event; fill states at asked phases.

        Where the push jumps a stretch ends, and the mode is chosen anew. `rows`, shape (n, 7), gets
        the states at `sample_phases`, ascending. Raises `FailedError` after too many events.
        """
        if sample_phases is not None and rows is not None:
            rows[sample_phases <= self.phase] = self.state
        wave = self.laws.groups.wave
        jumps = self.laws.record is not None or (wave is not None and wave.steps.shape[1] > 0)
        for laws, reached in self.laws.pieces(self.phase, end):
            self.laws, self.until = laws, reached if jumps else math.inf
            self.advance_without_jump(reached, sample_phases, rows)

    def set_contacts(self, mode: Mode) -> bool:
        """Record the contacts of a mode that carry the part; True if a slip begins from rest."""
        self.on_floor = mode.floor
        # Without slip a block stays at the wall though it does not press on it.
        stays_at_wall = mode.floor and not mode.slips and self.laws.contacts.rolling == 0.0
        self.on_wall = mode.wall or (self.on_wall and stays_at_wall)
        touching = mode.floor or mode.wall
        return mode.slips and touching and math.hypot(*self.laws.slip(mode, self.state)) == 0.0

    def advance_without_jump(
        self, end: float, sample_phases: Array | None, rows: Array | None
    ) -> None:
        """Advance the part to the phase `end` in rad, event by event; no jump comes before it.

        `rows` gets the states at the phases `sample_phases`.
        """
        lost_contact, events_at_phase = "", 0
        for _ in range(MAX_EVENTS):
            if self.phase >= end:
                return
            self.watch.check()
            if impact := self.due_impact():
                lost_contact = self.apply_event(impact, Mode(False, False, True))
                continue
            mode = self.choose_mode(lost_contact)
            if self.stop_straight(mode, end):
                lost_contact = ""
                continue
            begins = self.set_contacts(mode)
            stretch = self.follow(mode, end, begins)
            point, event = self.first_event(mode, stretch, begins)
            self.tally_stretch(mode, stretch, point)
            reached = stretch.start + point * stretch.length
            if point == 1.0 and end - reached < 1e-15 * (1.0 + end):
                reached = end
            if sample_phases is not None and rows is not None:
                stretch.sample(sample_phases, reached, rows)
            self.phase, self.state = reached, stretch.state(point)
            lost_contact = self.apply_event(event, mode)
            events_at_phase = events_at_phase + 1 if reached == stretch.start else 0
            if events_at_phase > 20:  # round in a circle at one phase
                raise FailedError
        raise FailedError

    def follow(self, mode: Mode, end: float, begins: bool) -> Stretch:
        """Return a stretch of the motion in one contact mode, short enough to be resolved.

        It ends at phase `end` in rad at the latest; it is cut until the last coefficients of its
        polynomials are within the tolerance. A slip turns the faster the smaller it is: the length
        of the next stretch is set in proportion to its size.
        """
        length = min(self.care.longest / max(1, self.laws.drive.order), end - self.phase)
        slips = mode.slips and (mode.floor or mode.wall)
        if slips:
            length = min(length, self.reach)
        for _ in range(MAX_CUTS):
            stretch = solve(self.laws, mode, self.state, self.phase, length, begins)
            tail = math.inf if stretch is None else max(stretch.tail, RESOLVED)
            growth_limit = 0.9 * (self.care.tail / tail) ** (1.0 / len(AT))
            if stretch is not None and tail <= self.care.tail:
                break
            length *= max(0.3, growth_limit)
        else:
            raise FailedError
        if slips:
            first_size, last_size = (
                abs(float(values(stretch.size, 0.0))),
                abs(float(stretch.size.sum())),
            )
            size_ratio = last_size / first_size if first_size > 0.0 and not begins else 1.0
            self.reach = length * growth_limit * min(3.0, max(0.1, size_ratio))
        return stretch

    def stop_straight(self, mode: Mode, end: float) -> bool:
        """Follow a turning, nearly zero slip along a straight line to its stop; True if it did.

        The stop must lie before phase `end` in rad. Only if friction takes more than the push:
        between what a slip takes and what friction holds, a slip may turn away from zero.
        """
        if not mode.slips or not (mode.floor or mode.wall):
            return False
        first, second = self.laws.slip(mode, self.state)
        size = math.hypot(first, second)
        limit = self.care.closing if self.laws.contacts.rolling == 0.0 else 1e-5 * self.care.closing
        if not 0.0 < size < limit:
            return False
        push, across, kinetic_friction, _ = self.laws.impending(self.phase, mode)
        if math.hypot(push, across / self.laws.response) > 0.999 * kinetic_friction:
            return False
        rate = self.laws.sliding(self.phase, mode, size, math.atan2(second, first))[0]
        longest = min(1e-3, end - self.phase)
        if -float(rate) * longest <= size:
            return False
        duration = -size / float(rate)
        state_before = self.state.copy()
        self.stop(mode)
        self.state[:UX] += 0.5 * duration * (state_before[UX:SPIN] + self.state[UX:SPIN])
        self.state[Y] = max(0.0, self.state[Y]) if self.laws.contacts.wall else self.state[Y]
        self.state[Z] = max(0.0, self.state[Z])
        self.phase += duration
        self.tally.events.append("stop")
        self.tally_phase(mode, float(state_before[UX]), duration)
        return True

    def impact(self, floor: bool, wall: bool) -> None:
        """Change the state by the impulses of an impact on the `floor`, on the `wall`, or on both.

        Newton's law of restitution normal to each, Coulomb friction along it, which stops the slip
        if it can; one contact after the other, repeated until the impulses stand still (theory
        13.1). Contacts without velocity off them carry the part afterwards. Raises `FailedError` if
        500 rounds do not suffice.
        """
        groups, rolling, state = self.laws.groups, self.laws.contacts.rolling, self.state
        _, free_y, free_z = self.laws.free(self.phase, float(state[UX]))
        target_z = (
            self.soft_rebound(-float(state[UZ]), groups.impact_damping, -float(free_z))
            if groups.impact_damping > 0.0
            else self.rebound(-float(state[UZ]), groups.restitution, -float(free_z))
        )
        target_y = self.rebound(-float(state[UY]), groups.wall_restitution, -float(free_y))
        floor_impulse = wall_impulse = floor_x = floor_y = wall_x = wall_z = 0.0
        for _ in range(500):
            impulses_before = (floor_impulse, wall_impulse, floor_x, floor_y, wall_x, wall_z)
            if floor:
                new_impulse = max(0.0, floor_impulse - (state[UZ] - target_z))
                state[UZ] += new_impulse - floor_impulse
                floor_impulse = new_impulse
            if wall:
                new_impulse = max(0.0, wall_impulse - (state[UY] - target_y))
                state[UY] += new_impulse - wall_impulse
                wall_impulse = new_impulse
            if floor:
                new_x, new_y = self.laws.stopping(
                    state[UX] - floor_x,
                    state[UY] + state[SPIN] - self.laws.response * floor_y,
                    groups.friction_kinetic * floor_impulse,
                )
                state[UX] += new_x - floor_x
                state[UY] += new_y - floor_y
                state[SPIN] += rolling * (new_y - floor_y)
                floor_x, floor_y = new_x, new_y
            if wall:
                new_x, new_z = self.laws.stopping(
                    state[UX] - wall_x,
                    state[UZ] - state[SPIN] - self.laws.response * wall_z,
                    groups.wall_friction * wall_impulse,
                )
                state[UX] += new_x - wall_x
                state[UZ] += new_z - wall_z
                state[SPIN] -= rolling * (new_z - wall_z)
                wall_x, wall_z = new_x, new_z
            impulses = (floor_impulse, wall_impulse, floor_x, floor_y, wall_x, wall_z)
            if (
                max(
                    abs(impulse - previous)
                    for impulse, previous in zip(impulses, impulses_before, strict=True)
                )
                < 1e-15
            ):
                break
        else:
            raise FailedError
        if floor:
            self.on_floor = abs(state[UZ]) <= STOPPED
            state[UZ] = 0.0 if self.on_floor else state[UZ]
        if wall:
            self.on_wall = abs(state[UY]) <= STOPPED
            state[UY] = 0.0 if self.on_wall else state[UY]

    def rebound(self, approach: float, restitution: float, load: float) -> float:
        """Return the speed of a part after an impact in g/w; 0 if a run of hops ends here.

        `approach` is the speed before (w = 2 pi f), `restitution` eps, `load` the acceleration in
        g that presses the part onto the contact. Hops that last less than the settings resolve are
        left out: their run ends with an impact without rebound, with which the impulses add up
        exactly (theory 13.5).
        """
        speed = restitution * approach
        if restitution < 1.0 and load > 0.0:
            hop_time = 2.0 * speed / (load * (1.0 - restitution))
            is_steady = 1e3 * self.laws.drive.steepest * hop_time < load
            if (
                speed * hop_time < self.care.hop
                and is_steady
                and self.phase + hop_time < self.until
            ):
                return 0.0
        return speed if speed > STOPPED else 0.0

    def soft_rebound(self, approach: float, damping: float, load: float) -> float:
        """Return the speed after an impact whose restitution falls with speed; 0 if tiny.

        `approach` is the speed before in g/w (w = 2 pi f), `damping` b that of a Hunt-Crossley
        contact, `load` the load n in g. Such hops never end by themselves: their speed falls as
        exp(-b n t/3), and what is left is taken as a contact (theory 18.3).
        """
        speed = approach * float(soft_contact.hunt_crossley(np.asarray(damping * approach)))
        if load > 0.0 and 3.0 * speed / (damping * load) < SOFT_HOP:
            return 0.0
        return speed if speed > STOPPED else 0.0

    # --- counting

    def tally_stretch(self, mode: Mode, stretch: Stretch, end_point: float) -> None:
        """Add a stretch of motion, up to `end_point` from 0 to 1, to the sums of the period."""
        tally, duration = self.tally, end_point * stretch.length
        if self.laws.contacts.wall:
            y = stretch.states[Y]
            tally.nearest = min(tally.nearest, float(y[0] - np.abs(y[1:]).sum()))
            tally.at_wall = tally.at_wall or self.on_wall
        if not mode.floor:
            tally.flight += duration
            tops = [
                top for top, sense in crossings(stretch.states[UZ]) if sense < 0 and top < end_point
            ]
            for point in (*tops, end_point):
                tally.hop_height = max(tally.hop_height, float(stretch.state(point)[Z]))
        elif not mode.slips:
            tally.stick += duration
        else:
            turns = [turn for turn, _ in crossings(stretch.states[UX]) if turn < end_point]
            for low, high in zip([0.0, *turns], [*turns, end_point], strict=True):
                middle = float(stretch.state(0.5 * (low + high))[UX])
                self.tally_phase(mode, middle, (high - low) * stretch.length)

    def tally_phase(self, mode: Mode, ux: float, duration: float) -> None:
        """Add a duration in rad to the sums of a period, by contacts and velocity along."""
        mode_name = "forward" if ux > STOPPED else "backward" if ux < -STOPPED else "stick"
        mode_name = mode_name if mode.floor else "flight"
        setattr(self.tally, mode_name, getattr(self.tally, mode_name) + duration)
