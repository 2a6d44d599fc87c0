"""The map of a part's state from one period of the drive to the next, and where it stands still.

The part is followed from rest until its state comes back after some periods. How a small change of
the state grows or shrinks over a cycle is measured: it tells whether the cycle attracts, where it
lies exactly (Newton's iteration), and what errors do to the mean velocity.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.reference.laws import SPIN, UX, UY, UZ, ReferenceLaws, X, Y, Z
from vibrafeed.core.motion.reference.part import FailedError, Part, Tally
from vibrafeed.core.motion.reference.stretch import FINER, USUAL, Care
from vibrafeed.core.motion.waves import size
from vibrafeed.core.watch import Watch

PERIOD = 2.0 * math.pi
MAX_MULTIPLE = 32
"""Periods of a cycle, as many as the kernels look for."""

SAME = 1e-13
"""Distance over the drive's size, below which two states are the same."""

NOISE = 1e-10
"""As `SAME`, if the distance of states does not shrink any more."""

DISTINCT = 1e-7
"""As `SAME`: a state that comes back this nearly after a part of a cycle does not tell yet how long
the cycle is."""

SLOWEST = 0.999
"""Largest ratio of a distance to that a cycle before that counts as shrinking."""

NEAR = 0.02
"""As `SAME`: below this distance the cycle is looked for by Newton's iteration."""

CHANGE = 1e-8
"""As `SAME`: size of the changes by which the growth over a cycle is measured."""

LOOKS = 20
"""Periods that looking for a cycle may take beyond as many as were followed."""

ATTRACTS = 1.0 - 1e-5
"""Largest share of a change that a cycle leaves; nearer to 1 nobody could tell it from 1."""

ROUNDING = 4.0 * 2.0**-52
"""Rounding of a state after one event, over the drive's size."""

FEWEST_CYCLES = 6
"""Fewest cycles in the last quarter of the periods, to tell if a motion is on its way."""

SAFE = 3.0
"""Factor from the estimated error to the stated one."""


@dataclass
class Growth:
    """The map of small changes of the state from the start of a cycle to its end.

    Attributes
    ----------
    indices
        Places in the state that may change, n of them.
    map
        Changes at the end over changes at the start, shape (n, n).
    travel
        Change of the distance travelled over the cycle, over changes at the start; shape (n,).
    """

    indices: list[int]
    map: Array
    travel: Array

    @property
    def radius(self) -> float:
        """The factor by which a small change of the state shrinks in one cycle, in the long run.

        The largest eigenvalue's size of `map`; infinite if the map is not known.
        """
        if not np.all(np.isfinite(self.map)):
            return math.inf
        return float(np.abs(np.linalg.eigvals(self.map)).max(initial=0.0))

    @property
    def attracts(self) -> bool:
        """True if small changes of the state die out."""
        return self.radius < ATTRACTS

    def weights(self) -> Array:
        """Return the change of the cycle's travel per change of the state in every round.

        Shape (n,); for changes that are added to the state anew in each round.
        """
        one_minus_map = np.eye(len(self.indices)) - self.map.T
        return np.asarray(np.linalg.solve(one_minus_map, self.travel), np.float64)


class ReferenceRun:
    """A part followed from rest, period by period.

    Attributes
    ----------
    before, after
        The states at the start and at the end of each period, shape (7,).
    tallies
        What happened in each period, `Tally`.
    refused
        How often a state came back to the last digit in a cycle that does not attract.
    lingers
        If one of those cycles let a change neither grow nor die out visibly.
    """

    def __init__(self, laws: ReferenceLaws, watch: Watch) -> None:
        self.laws, self.watch = laws, watch
        self.part = Part(laws, np.zeros(7), watch=watch)
        groups = laws.groups
        self.scale = (
            math.hypot(*groups.drive) if groups.wave is None else float(size(groups.wave))
        ) or 1.0
        self.before: list[Array] = []
        self.after: list[Array] = []
        self.flags: list[tuple[bool, bool]] = []
        self.tallies: list[Tally] = []
        self.plain_since, self.looks, self.look_at, self.looked = 0, 0, 2, 0
        self.refused, self.lingers = 0, False

    def follow(self) -> None:
        """Follow the motion for one more period of the drive, and record its states and sums.

        States at the start and end, the contacts that touched at the start, and the `Tally` of
        times and events are appended to the lists of the run.
        """
        part = self.part
        part.tally, part.phase = Tally(), 0.0
        self.before.append(part.state.copy())
        self.flags.append((part.on_floor, part.on_wall))
        part.advance(PERIOD)
        self.after.append(part.state.copy())
        self.tallies.append(part.tally)

    @property
    def rests(self) -> bool:
        """True if friction held the part for the whole last period."""
        tally = self.tallies[-1]
        moved = tally.forward + tally.backward + tally.flight
        return moved == 0.0 and self.distance(1, self.indices(1)) == 0.0

    @property
    def slides_free(self) -> bool:
        """True if there is no friction, so that the part keeps its speed along the track."""
        p = self.laws.groups
        at_wall = self.laws.contacts.wall and p.wall_friction > 0.0
        return p.friction_static == 0.0 == p.friction_kinetic and not at_wall

    # --- coming back

    def indices(self, multiple: int) -> list[int]:
        """Return the indices of the state that must come back after `multiple` periods.

        The distance from the wall is among them, unless the wall was untouched over the cycle and
        the part does not near it. Without a wall no place across counts; of a cylinder there only
        the slip across does.
        """
        indices = [Z, UX, UY, UZ]
        if not self.laws.contacts.wall:
            return indices
        if self.laws.contacts.rolling:
            indices.append(SPIN)
        return (
            indices
            if self.is_off_wall(multiple) and self.nearing(multiple) <= 0.0
            else [*indices, Y]
        )

    def is_off_wall(self, multiple: int) -> bool:
        """True if the last `multiple` periods did not touch the wall."""
        return not any(tally.at_wall for tally in self.tallies[-multiple:])

    def nearing(self, multiple: int) -> float:
        """Return the distance by which the part neared the wall in the last `multiple` periods.

        In g/w^2 (w = 2 pi f); 0 if it did not.
        """
        change = float(self.before[-multiple][Y] - self.after[-1][Y])
        return change if change > SAME * self.scale else 0.0

    def drifts(self, periods: int) -> bool:
        """True if the part has approached the wall, without touching it, for so many periods."""
        return self.laws.contacts.wall and self.is_off_wall(periods) and self.nearing(1) > 0.0

    def comparable(self, state: Array) -> Array:
        """Return a state in the form in which two states are compared, to see if a motion repeats.

        `state` has 7 numbers: position, velocity, spin. For a cylinder without a wall its slip,
        velocity plus spin, takes the place of the velocity across: at which speed it rolls does not
        matter.
        """
        if self.laws.contacts.rolling and not self.laws.contacts.wall:
            state = state.copy()
            state[UY] += state[SPIN]
        return state

    def distance(self, multiple: int, indices: list[int], back: int = 0) -> float:
        """Return the distance of the state from coming back, relative to the drive's size.

        After `multiple` periods that end `back` periods before the last one, over the `indices` of
        the state; infinite before a whole cycle.
        """
        last = len(self.after) - back
        first = last - multiple
        if first < self.plain_since:
            return math.inf
        change = self.comparable(self.after[last - 1]) - self.comparable(self.before[first])
        return float(np.abs(change[indices]).max()) / self.scale

    def touches_alike(self, multiple: int) -> bool:
        """True if the same contacts touch at both ends of the last `multiple` periods."""
        return (self.part.on_floor, self.part.on_wall) == self.flags[-multiple]

    def cycle(self) -> int:
        """Return the number of periods after which the motion repeats; 0 if not known yet.

        It is the first, up to 32, after which the state comes back and no longer comes nearer, and
        of which no divisor nearly repeats.
        """
        for multiple in range(1, min(MAX_MULTIPLE, len(self.after) - self.plain_since) + 1):
            indices = self.indices(multiple)
            distance = self.distance(multiple, indices)
            if distance > NOISE or not self.touches_alike(multiple):
                continue
            if distance > SAME and distance < SLOWEST * self.distance(
                multiple, indices, back=multiple
            ):
                return 0  # still on its way: not to be told as a multiple of what it is
            divisors = (divisor for divisor in range(1, multiple) if multiple % divisor == 0)
            nearest = min(
                (self.distance(divisor, self.indices(divisor)) for divisor in divisors),
                default=math.inf,
            )
            return 0 if nearest < DISTINCT else multiple
        return 0

    @property
    def is_on_its_way(self) -> bool:
        """True if the motion was still approaching a cycle, or leaving an unstable one.

        Its means are then no means of a motion that does not repeat. Over the last quarter of the
        periods the same events came again and again, and the state came back ever more nearly, or
        ever less so.
        """
        quarter = (len(self.after) - self.plain_since) // 4
        for multiple in range(1, min(MAX_MULTIPLE, quarter // FEWEST_CYCLES) + 1):
            last = [tally.events for tally in self.tallies[-quarter:]]
            if last[multiple:] != last[:-multiple]:
                continue
            indices = self.indices(multiple)
            distances = [
                self.distance(multiple, indices, back) for back in range(quarter - multiple)
            ]
            comes_nearer = all(new < old for new, old in itertools.pairwise(distances))
            goes_away = all(new > old for new, old in itertools.pairwise(distances))
            return comes_nearer or goes_away
        return False

    # --- looking ahead

    def approach_cycle(self) -> None:
        """Move the state nearer to where the motion repeats, if it slowly approaches that.

        By a step of Newton's method (`newton_step`) or, for a part on its way to the wall whose
        motion repeats otherwise, by skipping cycles (`skip_cycles`). Only if the last two cycles
        had the same events.
        """
        if len(self.after) < self.look_at or self.slides_free:
            return
        for multiple in range(1, min(MAX_MULTIPLE, (len(self.after) - self.plain_since) // 2) + 1):
            events = [tally.events for tally in self.tallies[-2 * multiple :]]
            if not self.touches_alike(multiple) or events[multiple:] != events[:multiple]:
                continue
            indices = self.indices(multiple)
            if Y in indices and self.is_off_wall(multiple):  # on its way to the wall
                indices.remove(Y)
                if self.distance(multiple, indices) < SAME:
                    self.skip_cycles(multiple)
                    return
            distance = self.distance(multiple, indices)
            earlier = self.distance(multiple, indices, back=multiple)
            if SAME < distance < min(NEAR, SLOWEST * earlier):
                if distance > 0.01 * earlier:  # else it is there soon without
                    self.newton_step(multiple)
                return

    def skip_cycles(self, multiple: int) -> None:
        """Skip cycles of a part on its way to the wall whose motion repeats otherwise.

        Each cycle of `multiple` periods brings it nearer to the wall by the same distance: the
        state is moved by as many of them as leave it short of the wall.
        """
        nearing = self.nearing(multiple)
        cycles = math.floor(min(tally.nearest for tally in self.tallies[-multiple:]) / nearing) - 1
        if cycles > 0:
            self.part.state[Y] -= cycles * nearing
            self.plain_since = len(self.after)

    def newton_step(self, multiple: int) -> None:
        """Take one step of Newton's method towards the state with which the motion repeats.

        The cycle has `multiple` periods. The step is kept if the cycle attracts and, followed from
        the new state, comes back more nearly; else the next try waits longer. Nothing if it costs
        more than it may.
        """
        if not self.affords(multiple):
            return
        self.looks += 1
        self.look_at = len(self.after) + 2 * multiple
        growth = self.measured_growth(multiple)
        start = self.part.state
        if growth.attracts:
            change = self.comparable(self.after[-1]) - self.comparable(self.before[-multiple])
            state = start.copy()
            # The shift of the cycle is (1 - M)^-1 times the change, with the map M.
            one_minus_map = np.eye(len(growth.indices)) - growth.map
            state[growth.indices] += np.linalg.solve(
                one_minus_map, growth.map @ change[growth.indices]
            )
            if self.comes_back(state, multiple, growth.indices, 0.5 * np.abs(change)):
                self.part.state, self.plain_since = state, len(self.after)
                return
        self.look_at += min(16, 2**self.looks)

    def affords(self, multiple: int) -> bool:
        """True if measuring a cycle of `multiple` periods is worth its cost; then counts it.

        That follows the cycle again for each number of the state, and once more. It may take as
        many periods in all as were followed, and 20 more.
        """
        cost = multiple * (len(self.indices(multiple)) + 1)
        if self.looked + cost > len(self.after) + LOOKS:
            return False
        self.looked += cost
        return True

    def comes_back(self, state: Array, multiple: int, indices: list[int], within: Array) -> bool:
        """True if a cycle of `multiple` periods from a state comes back to it closely.

        The state (7 numbers) is a guess, by Newton's method, of where the motion repeats. It must
        not lie in floor or wall. At the end the largest difference over the `indices` of the state
        may be no more than the largest entry of `within` there. False if the part cannot be
        followed.
        """
        if state[Z] < 0.0 or (self.laws.contacts.wall and state[Y] < 0.0):
            return False
        try:
            part = self.part_after_cycle(state, self.flags[-multiple], multiple, USUAL)
        except FailedError:
            return False
        difference = np.abs(self.comparable(part.state) - self.comparable(state))
        return float(difference[indices].max(initial=0.0)) <= float(
            within[indices].max(initial=0.0)
        )

    def part_after_cycle(
        self, state: Array, flags: tuple[bool, bool], multiple: int, care: Care
    ) -> Part:
        """Return the part after one cycle of `multiple` periods that starts from a given state.

        `state` has 7 numbers, `flags` say if floor and wall touch at the start, `care` holds the
        accuracy settings. Raises `FailedError` if the part cannot be followed.
        """
        part = Part(self.laws, state.copy(), care, self.watch)
        part.on_floor, part.on_wall = flags
        part.reach = self.part.reach
        for _ in range(multiple):
            part.phase = 0.0
            part.advance(PERIOD)
        return part

    def measured_growth(self, multiple: int) -> Growth:
        """Return the map of small changes of the state from the start of the last cycle to its end.

        The map M of changes over `multiple` periods, measured by following each change through
        them: it tells if the cycle attracts, and what errors do to the mean velocity. NaN in a
        column that failed.
        """
        start, end, flags = self.before[-multiple], self.after[-1], self.flags[-multiple]
        # A part on floor or wall stays there, and nothing moves one across that nothing pushes.
        fixed = ([Z, UZ] if flags[0] else []) + ([Y, UY] if flags[1] else [])
        groups = self.laws.groups
        if not (groups.drive_number_across or groups.gravity_number_across):
            fixed += [Y, UY]
        indices = [index for index in self.indices(multiple) if index not in fixed]
        growth = np.zeros((len(indices), len(indices)))
        travel = np.zeros(len(indices))
        for column, index in enumerate(indices):
            state, size = start.copy(), CHANGE * self.scale
            state[index] += size
            try:
                part = self.part_after_cycle(state, flags, multiple, USUAL)
            except FailedError:
                growth[:, column] = math.nan
                continue
            change = self.comparable(part.state) - self.comparable(end)
            growth[:, column] = change[indices] / size
            travel[column] = (part.state[X] - end[X]) / size
        return Growth(indices, growth, travel)

    # --- the mean velocity

    def mean(self, multiple: int) -> tuple[float, float]:
        """Return the mean velocity over the last cycle of `multiple` periods, and its error.

        NaN and infinite if the cycle does not attract. The rest of the transient, what the cycle
        changes if it is followed more finely, and rounding at every event shift the state by a
        little in each round: the cycle moves by (1 - M)^-1 of it, M the map of small changes over a
        round. The first two are known: they are counted in the velocity, and in the error
        nevertheless. Both in g/w, w = 2 pi f.
        """
        if self.refused and not self.affords(multiple):
            return math.nan, math.inf
        growth = self.measured_growth(multiple)
        if not (growth.attracts or self.slides_free):
            self.refused += 1
            self.lingers = self.lingers or growth.radius < 2.0
            return math.nan, math.inf
        start, flags = self.before[-multiple], self.flags[-multiple]
        end = self.comparable(self.after[-1])
        finer = self.comparable(self.part_after_cycle(start, flags, multiple, FINER).state)
        transient = (end - self.comparable(start))[growth.indices]
        shift = (finer - end)[growth.indices]
        # Without friction nothing dies out: what went wrong in every period so far stays.
        weights = growth.travel * len(self.after) if self.slides_free else growth.weights()
        travel_shift = 0.0 if self.slides_free else float(weights @ (transient + shift))
        events = sum(len(tally.events) for tally in self.tallies[-multiple:]) + 2 * multiple
        rounding = ROUNDING * self.scale * events
        error = (
            abs(float(weights @ transient))
            + abs(float(finer[X] - end[X]))
            + float(np.abs(weights) @ np.abs(shift))
            + rounding * (PERIOD * multiple + float(np.abs(weights).sum()))
        )
        travel = float(finer[X] - start[X]) + travel_shift
        return travel / (PERIOD * multiple), SAFE * error / (PERIOD * multiple)
