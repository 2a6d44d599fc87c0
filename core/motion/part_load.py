"""The load of conveyed parts on their drive unit, and the amplitude at which both agree.

A part that moves in time with its track is felt as a mass and as a damper (theory 13.15), which
depend on the amplitude, which depends on them. A table over amplitudes, finer where both come near,
brackets every agreement; each is then found to rounding, or, where the parts' motion does not
repeat, in a straight line between two of the table, whose means scatter by some per cent.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.motion.bowl_track import Track, in_pieces
from vibrafeed.core.motion.events import EVENTS, energy_by_events, motion_by_events
from vibrafeed.core.motion.method import Contacts, Groups
from vibrafeed.core.plan.plan import run
from vibrafeed.core.scenes.scene import Equation, between

SETTINGS: dict[str, Any] = dict(EVENTS.defaults)
"""Settings of the method `events`, by which the parts' motion is followed, whatever the study's own
method."""
STEP = 0.03
"""Step of the logarithm of the amplitude in the table before it is made finer."""
STEEP, TURNING = 10 / 3, 20.0
"""Slopes of h that the table allows for, everywhere and where |h| is least: it halves an interval
in which they reach 0, that is within 5 % of 0, or 30 % where the slope turns."""
HALVINGS = 6
"""How often it halves: to 0.05 %."""
BELOW, BEYOND = 0.1, 1.1
"""Least and largest amplitude of the table over those of a load that moves with the track. A load
pushes with at most some 3 times the force of one that sticks: the mean of its weight bounds it."""
HIGHEST = 50.0
"""Acceleration over gravity up to which the table follows a resonance between two of `SHARES`."""
SHARES = np.linspace(-0.5, 1.5, 9)
"""Shares of the parts' mass that bound what the drive feels."""
PIECE = 500
"""Cells whose tables are followed together: some 50 MB."""
PASSES = 4
"""Iterations after which angle and load agree: a load turns the vibration by some 1e-2 of
itself."""
AGREES = 1e-6
"""Relative difference of amplitudes: if more is left between drive and parts, their motion
jumps."""
THROWN, FELT = 2.0, 0.01
"""Throw number, and share of the moving mass, above which the parts' harmonics move the track by
1e-3 of its amplitude and more: 1.7e-2 of a tenth of the mass thrown at 3 to 4."""
SCATTERED = 4
"""Steps of the table within which several agreements may come from means that scatter."""


class Load(NamedTuple):
    """The load of conveyed parts on a unit; arrays of one shape.

    Attributes
    ----------
    mass, damping : ndarray
        Mass that swings with the track [kg]; damper against the ground [N s/m].
    largest : ndarray
        The largest amplitude at which drive and parts agree [m]; mass and damping are those of the
        smallest, which the unit meets first when it is switched on.
    several : ndarray of bool
        Whether there is more than one.
    hunts : ndarray of bool
        Whether the motion of the parts changes where drive and parts would agree.
    thrown : ndarray of bool
        Whether the parts are thrown so high, and weigh so much, that harmonics move the track.
    """

    mass: Array
    damping: Array
    largest: Array
    several: Mask
    hunts: Mask
    thrown: Mask


class LoadCurve(NamedTuple):
    """The load of parts over the amplitude of their track; arrays of one shape (n,).

    The rows of a cell follow each other, with growing amplitude. What stands between two rows has
    the shape (n - 1,), an interval each.

    Attributes
    ----------
    cell : ndarray of int
    logarithm : ndarray
        Logarithm of the amplitude [m].
    mass, damping : ndarray
        As in `Load`.
    excess : ndarray
        h = ln(A_unit/A), 0 where drive and parts agree.
    repeats : ndarray of bool
        Whether the motion of the parts repeats.
    """

    cell: NDArray[np.intp]
    logarithm: Array
    mass: Array
    damping: Array
    excess: Array
    repeats: Mask

    @property
    def joined(self) -> Mask:
        """True between rows of one cell."""
        return self.cell[1:] == self.cell[:-1]

    @property
    def exact(self) -> Mask:
        """True between rows whose motions repeat."""
        return self.repeats[1:] & self.repeats[:-1]

    def may_cross(self) -> Mask:
        """True where h may pass 0 between two rows, and back, as far as its slope can tell."""
        distance = np.abs(self.excess)
        nearest = np.zeros_like(self.repeats)
        nearest[1:-1] = (distance[1:-1] <= distance[:-2]) & (distance[1:-1] <= distance[2:])
        nearest[1:-1] &= self.joined[:-1] & self.joined[1:]
        slope = np.where(nearest[:-1] | nearest[1:], TURNING, STEEP)
        largest_change = slope * np.diff(self.logarithm)
        return self.joined & self.exact & (distance[1:] + distance[:-1] < largest_change)


def part_load(
    of_unit: Collection[Equation],
    of_part: Collection[Equation],
    contacts: Contacts,
    track: Track | None,
) -> "PartLoad":
    """Return the load of conveyed parts on their drive unit, at the amplitude at which both agree.

    The equations lead from a load to amplitude and angle of the track, and from these to the groups
    of a part; only those on this way are kept. On a bowl's `track` with stretches the load acts at
    its own place, else where the part is.
    """
    location = ("track_fraction", "stretches") if track else ()
    unit_equations = between(
        of_unit, ("part_load", *location), ("track_amplitude", "vibration_angle")
    )
    part_equations = between(of_part, ("amplitude", "beta", *location), ("groups",))
    inputs = {"conveyed_mass", "moving_mass", "circular_frequency", "gravity"}
    inputs |= {name for equation in (*unit_equations, *part_equations) for name in equation.inputs}
    inputs -= {equation.gives for equation in (*unit_equations, *part_equations)} | {
        "part_load",
        "amplitude",
        "beta",
        *location,
    }
    if not any(equation.gives == "vibration_angle" for equation in unit_equations):
        inputs.add("vibration_angle")
    inputs |= {"load_fraction", *track.inputs} if track else set()
    return PartLoad(unit_equations, part_equations, contacts, tuple(sorted(inputs)), track)


@dataclass(frozen=True)
class PartLoad:
    """The load at which drive and parts agree.

    Attributes
    ----------
    unit_equations : tuple of Equation
        From a `Load` to amplitude and angle of the track.
    part_equations : tuple of Equation
        From amplitude and angle to the groups of a part.
    contacts : Contacts
        What a part can touch.
    needs : tuple of str
        Quantities that both need from outside.
    track : Track or None
        Of a bowl, with stretches.
    """

    unit_equations: tuple[Equation, ...]
    part_equations: tuple[Equation, ...]
    contacts: Contacts
    needs: tuple[str, ...]
    track: Track | None

    def load(self, **inputs: Any) -> Load:
        """Return the load of the parts in every cell, from the quantities of `needs` by name."""
        return in_pieces(self._of_cells, {name: inputs[name] for name in self.needs}, PIECE)

    def amplitude(
        self, quantities: Mapping[str, Array], mass: Array, damping: Array
    ) -> tuple[Any, Any]:
        """Return amplitude [m] and angle [rad] of the track under a mass and damper of parts."""
        false = np.zeros(mass.shape, dtype=bool)
        load = Load(mass, damping, mass, false, false, false)
        results = run(self.unit_equations, {**self._with_location(quantities), "part_load": load})
        return results["track_amplitude"], results["vibration_angle"]

    def mass_and_damper(
        self, quantities: Mapping[str, Array], amplitude: Array
    ) -> tuple[Array, Array, Mask]:
        """Return mass and damper [kg, N s m-1] that parts are on a track, and if they repeat.

        At given amplitudes [m]: the mass m (1 + 2 <u.b'>/p^2) and the damper 2 m w drive/p^2 (w = 2
        pi f), with the mass m of the parts, the drive number p, and the mean `swing` <u.b'> and
        power `drive` of a part's motion, which is followed for this (theory 13.15).
        """
        mass, damping = quantities["conveyed_mass"], np.zeros_like(quantities["conveyed_mass"])
        turns_vibration = any(
            equation.gives == "vibration_angle" for equation in self.unit_equations
        )
        for _ in range(PASSES if turns_vibration else 1):
            _, angle = self.amplitude(quantities, mass, damping)
            groups = self._groups(quantities, amplitude, angle)
            drive_squared = sum(np.square(number) for number in groups.drive)
            motion = motion_by_events(groups, self.contacts, **SETTINGS)
            energy = energy_by_events(groups, self.contacts, motion, **SETTINGS, averages=True)
            mass = quantities["conveyed_mass"] * (1.0 + 2.0 * energy.swing / drive_squared)
            rate = quantities["circular_frequency"] * quantities["conveyed_mass"]
            damping = rate * 2.0 * energy.drive / drive_squared
        return mass, damping, motion.multiple > 0

    def _with_location(self, quantities: Mapping[str, Array]) -> dict[str, Any]:
        if self.track is None:
            return {**quantities}
        stretches = self.track.stretches(**{name: quantities[name] for name in self.track.inputs})
        return {**quantities, "track_fraction": quantities["load_fraction"], "stretches": stretches}

    def _groups(self, quantities: Mapping[str, Array], amplitude: Array, angle: Array) -> Groups:
        quantities = {**self._with_location(quantities), "amplitude": amplitude, "beta": angle}
        return run(self.part_equations, quantities)["groups"]

    def _of_cells(self, quantities: dict[str, Array]) -> Load:
        # The smallest amplitude at which the excess falls through 0 is where a unit comes to rest
        # when it is switched on. NaN where there is none.
        curve = self._curve(quantities)
        falls = (curve.excess[:-1] > 0.0) & (curve.excess[1:] <= 0.0) & curve.joined
        rises = (curve.excess[:-1] <= 0.0) & (curve.excess[1:] > 0.0) & curve.joined
        falling = np.flatnonzero(falls)
        cells, start = np.unique(curve.cell[falling], return_index=True)
        first, last = falling[start], falling[np.append(start[1:], len(falling))[: len(start)] - 1]
        crossings = np.bincount(
            curve.cell[:-1][falls | rises], minlength=len(quantities["moving_mass"])
        )
        is_distinct = curve.exact[first] | (
            curve.logarithm[last] - curve.logarithm[first] > SCATTERED * STEP
        )
        several = (crossings[cells] > 1) & is_distinct

        has_several = last > first
        index = np.concatenate([first, last[has_several]])
        quantities_there = {name: value[curve.cell[index]] for name, value in quantities.items()}
        amplitude, mass, damping, hunts = self._agreement(quantities_there, curve, index)
        count = len(cells)
        largest = amplitude[:count].copy()
        largest[has_several] = amplitude[count:]
        results = (mass[:count], damping[:count], largest)
        thrown = self._thrown(
            {name: value[cells] for name, value in quantities.items()}, *results[:2]
        )
        load = Load._make(
            np.full(len(crossings), empty)
            for empty in (np.nan, np.nan, np.nan, False, False, False)
        )
        for column, values in zip(load, (*results, several, hunts[:count], thrown), strict=True):
            column[cells] = values
        return load

    def _curve(self, quantities: dict[str, Array]) -> LoadCurve:
        # A table over amplitudes at equal steps of the logarithm, halved where the excess may pass
        # 0.
        lowest, highest = self._extremes(quantities)
        # A unit that is too heavy or too stiff to move at all meets no load: one amplitude tells.
        moves = (lowest > 0.0) & np.isfinite(highest)
        lowest, highest = np.where(moves, lowest, 1.0), np.where(moves, highest, 1.0)
        # Cells that differ in what the motion does not know share its amplitudes, and its motions.
        bottom, top = np.floor(np.log(lowest) / STEP), np.ceil(np.log(highest) / STEP)
        count = (top - bottom).astype(np.int64) + 1
        cell = np.repeat(np.arange(len(count)), count)
        step = np.arange(len(cell)) - (np.cumsum(count) - count)[cell]
        curve = self._curve_points(quantities, cell, STEP * (bottom[cell] + step))
        for _ in range(HALVINGS):
            crossing = np.flatnonzero(curve.may_cross())
            if not crossing.size:
                break
            middle = 0.5 * (curve.logarithm[crossing] + curve.logarithm[crossing + 1])
            refined = self._curve_points(quantities, curve.cell[crossing], middle)
            curve = LoadCurve._make(
                np.insert(old, crossing + 1, new) for old, new in zip(curve, refined, strict=True)
            )
        return curve

    def _curve_points(
        self, quantities: dict[str, Array], cell: NDArray[np.intp], logarithm: Array
    ) -> LoadCurve:
        # The load of the parts at given amplitudes, and h = ln(A_unit/A) there.
        quantities_there = {name: value[cell] for name, value in quantities.items()}
        mass, damping, repeats = self.mass_and_damper(quantities_there, np.exp(logarithm))
        return LoadCurve(
            cell,
            logarithm,
            mass,
            damping,
            self._log_excess(quantities_there, mass, damping, logarithm),
            repeats,
        )

    def _thrown(self, quantities: dict[str, Array], mass: Array, damping: Array) -> Mask:
        # The track is taken to move as a sine: parts thrown far, and heavy, disturb that.
        amplitude, angle = self.amplitude(quantities, mass, damping)
        groups = self._groups(quantities, amplitude, angle)
        high = np.abs(groups.drive_number_normal) > THROWN * groups.gravity_number_normal
        heavy = quantities["conveyed_mass"] > FELT * quantities["moving_mass"]
        return np.asarray(high & heavy)

    def _agreement(
        self, quantities: dict[str, Array], curve: LoadCurve, index: NDArray[np.intp]
    ) -> tuple[Array, Array, Array, Mask]:
        # The root of the excess between the rows `index` and `index + 1` of the curve. Where the
        # load still differs at the root, the motion jumps there: it is found again on the straight
        # line. Return amplitude, mass and damping, and True where the motion jumps.
        low, mass, damping = (values[index] for values in curve[1:4])
        high, next_mass, next_damping = (values[index + 1] for values in curve[1:4])
        exact = curve.exact[index]
        columns = tuple(quantities[name] for name in self.needs)
        neighbours = (low, mass, damping, high, next_mass, next_damping)
        jumps = np.zeros_like(exact)
        for _ in range(2):
            bracket = (exact & ~jumps, *neighbours)
            root = (
                _elementwise()
                .find_root(self._log_excess_at, (low, high), args=(*bracket, *columns))
                .x
            )
            mass, damping = self._load_between(root, quantities, *bracket)
            remainder = np.abs(self._log_excess(quantities, mass, damping, root))
            jumps |= remainder > AGREES
            if not jumps.any():
                break
        return np.exp(root), mass, damping, jumps

    def _load_between(
        self, logarithm: Array, quantities: Mapping[str, Array], exact: Mask, low: Array,
        mass: Array, damping: Array, high: Array, next_mass: Array, next_damping: Array,
    ) -> tuple[Array, Array]:  # fmt: skip
        # Between two known amplitudes: motions that repeat (`exact`) are followed anew, the means
        # of others scatter.
        fraction = (logarithm - low) / (high - low)
        mass = mass + fraction * (next_mass - mass)
        damping = damping + fraction * (next_damping - damping)
        if exact.any():
            exact_quantities = {name: value[exact] for name, value in quantities.items()}
            mass[exact], damping[exact], _ = self.mass_and_damper(
                exact_quantities, np.exp(logarithm[exact])
            )
        return mass, damping

    def _log_excess_at(self, logarithm: Array, *columns: Array) -> Array:
        neighbours: Any = columns[: -len(self.needs)]
        quantities = dict(zip(self.needs, columns[len(neighbours) :], strict=True))
        return self._log_excess(
            quantities, *self._load_between(logarithm, quantities, *neighbours), logarithm
        )

    def _log_excess(
        self, quantities: Mapping[str, Array], mass: Array, damping: Array, logarithm: Array
    ) -> Array:
        with np.errstate(invalid="ignore"):
            return np.asarray(np.log(self.amplitude(quantities, mass, damping)[0]) - logarithm)

    def _extremes(self, quantities: dict[str, Array]) -> tuple[Array, Array]:
        # Least and largest amplitude that a load between the bounds `SHARES` of its mass can leave.
        def amplitude(mass_fraction: Array, *columns: Array) -> Array:
            quantities_there = dict(zip(self.needs, columns, strict=True))
            mass = mass_fraction * quantities_there["conveyed_mass"]
            return np.asarray(self.amplitude(quantities_there, mass, np.zeros_like(mass))[0])

        def softness(mass_fraction: Array, largest: Array, *columns: Array) -> Array:
            return np.square(largest / amplitude(mass_fraction, *columns))

        columns = tuple(quantities[name] for name in self.needs)
        table = np.array([amplitude(mass_fraction, *columns) for mass_fraction in SHARES])
        nearest, largest = np.clip(np.argmax(table, axis=0), 1, len(SHARES) - 2), table.max(axis=0)
        bracket = (SHARES[nearest - 1], SHARES[nearest], SHARES[nearest + 1])
        peak = (
            _elementwise()
            .find_minimum(softness, bracket, args=(largest, *columns), tolerances={"frtol": 0.01})
            .f_x
        )
        highest = HIGHEST * quantities["gravity"] / np.square(quantities["circular_frequency"])
        resonant = np.minimum(largest / np.sqrt(peak), highest)
        return BELOW * table.min(axis=0), BEYOND * np.fmax(largest, resonant)


def _elementwise() -> ModuleType:
    from scipy.optimize import elementwise

    return elementwise
