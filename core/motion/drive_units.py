"""A part on the track of a drive unit: its amplitude and angle follow from springs and masses.

Which unit a study means, its parameters tell, as they tell the kind of drive. The unit's equations
then stand before those of the part; what the parts do to the unit stands in `part_load`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple

import numpy as np

from vibrafeed.core.errors import Problem
from vibrafeed.core.mechanics import drive_unit
from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, sine
from vibrafeed.core.motion import bowl_track
from vibrafeed.core.motion.bowl_track import Track, track_of
from vibrafeed.core.motion.drives import SINE, Shape, under_wave
from vibrafeed.core.motion.groups import Contacts
from vibrafeed.core.motion.part_load import Load, PartLoad, part_load
from vibrafeed.core.motion.waves import Wave
from vibrafeed.core.quantities.drives import DRIVE, DRIVE_UNIT
from vibrafeed.core.scenes import SCENES, Condition, Equation, Scene
from vibrafeed.core.scenes.scene import fields

SOURCE = "theory 15.5"
PARAMETERS_OF_UNIT = frozenset(name for name, quantity in DRIVE_UNIT.items() if quantity.parameter)
OF_BOWLS = ("spring_radius", "moving_inertia", "base_inertia")
OF_TURNING = ("offset_along", "offset_upward", "spot_along", "spot_upward")
FOLLOWS = tuple(name for name in SINE if name != "alpha")
"""Parameters of the plain sine that a drive unit gives."""
SERIOUS = ("hits_magnet", "overstressed", "isolation_poor")
"""Regimes of a drive unit that matter beside those of the part."""


@dataclass(frozen=True)
class HalfWave:
    """The drive of a unit whose force has a second harmonic, as a magnet's on a half wave has.

    Its displacement along the line of the vibration is A (sin(tau) + s sin(2 tau) + c cos(2 tau)),
    with s and c of `track_harmonic`.
    """

    inputs = (
        *("amplitude", "beta", "alpha", "track_harmonic", "circular_frequency", "gravity"),
        "drive_factor",
    )
    defaults: ClassVar = {"alpha": 0.0, "drive_factor": 1.0}

    def wave(self, **inputs: Any) -> Wave:
        """Return the drive of a track under a force with a second harmonic, such as a magnet's.

        Its push is w^2 A sin(tau)/g, and 4 w^2 A (s, c)/g at 2 tau, along the line of vibration.
        `inputs` holds quantities by name, arrays in SI units: the amplitude A, circular frequency
        w, angles of the line, gravity, the factor of the drive by which all is multiplied, and in
        `track_harmonic` the pair (s, c), the coefficients of sin(2 tau) and cos(2 tau) of the
        displacement over A [1].
        """
        ratio = inputs.pop("track_harmonic")
        inputs = {name: np.asarray(value, dtype=float) for name, value in inputs.items()}
        rate = np.square(inputs["circular_frequency"]) / inputs["gravity"]
        size = inputs["drive_factor"] * inputs["amplitude"] * rate
        level = size * cosine(inputs["beta"])
        axes = (level * cosine(inputs["alpha"]), level * sine(inputs["alpha"]))
        parts = [
            [[one, 4.0 * one * ratio[0]], [0.0 * one, 4.0 * one * ratio[1]]]
            for one in (*axes, size * sine(inputs["beta"]))
        ]
        shape = np.broadcast_shapes(*(np.shape(n) for axis in parts for part in axis for n in part))
        harmonics = np.array(
            [[[np.broadcast_to(n, shape) for n in part] for part in axis] for axis in parts]
        )
        return Wave(harmonics, np.zeros((4, 0, *shape)))


class ChosenUnit(NamedTuple):
    """The drive unit that a study gives, and the track of a bowl on it.

    Attributes
    ----------
    scene : Scene
    variant : str
        By leaves or by a measured frequency.
    loaded : bool
        Whether parts that are conveyed act on it.
    shape : Shape or None
        Of a drive with a second harmonic; None of the plain sine.
    track : Track or None
        The stretches of a bowl's track; None of a part at one place.
    """

    scene: Scene
    variant: str
    loaded: bool
    shape: Shape | None
    track: Track | None = None


def unit_of(parameters: Iterable[str]) -> tuple[ChosenUnit | None, list[Problem]]:
    """Return the drive unit that a study's parameter names define (None if none), and problems.

    With a drive unit, the vibration follows from the unit's springs, masses and magnet. Names that
    fit no unit, or several, are the problems.
    """
    names = tuple(parameters)
    of_unit = [name for name in names if name in PARAMETERS_OF_UNIT]
    track, problems_of_track = track_of(names, of_bowl=bool({*OF_BOWLS} & {*of_unit}))
    if not of_unit:
        return None, problems_of_track
    name = "bowl-drive-unit" if {*OF_BOWLS} & {*of_unit} else "linear-drive-unit"
    variant = "measured" if "ring_down_frequency" in of_unit else "springs"
    turning = [one for one in of_unit if one in OF_TURNING]
    if turning and name == "linear-drive-unit":
        variant += "_turning"
    loaded = "conveyed_mass" in of_unit
    problems = [
        Problem(
            f"parameters.{other}",
            f"{other} is computed from the drive unit, which the study gives by {of_unit[0]}",
            f"Remove {other}, or the whole drive unit: {', '.join(of_unit)}",
        )
        for other in names
        if other in FOLLOWS or other in DRIVE
    ]
    if loaded:
        problems += _problems_of_parts(of_unit, turning)
    shape = HalfWave() if "force_harmonic" in of_unit else None
    problems += problems_of_track
    return ChosenUnit(SCENES[name], variant, loaded, shape, track), problems


def _problems_of_parts(of_unit: list[str], turning: list[str]) -> list[Problem]:
    """Return problems of a drive unit for which the load of travelling parts is not modelled.

    `of_unit` are the names of the unit's parameters, `turning` those of a unit that turns.
    """
    problems = []
    if turning:
        message = "the effect of travelling parts on a unit that turns is not modelled"
        fix = f"Give load_mass in its place, or leave out {', '.join(turning)}"
        problems.append(Problem("parameters.conveyed_mass", message, fix))
    if "force_harmonic" in of_unit:
        message = "the effect of travelling parts is modelled only for a force of one harmonic"
        fix = "Give load_mass in its place, or leave out force_harmonic"
        problems.append(Problem("parameters.conveyed_mass", message, fix))
    if "load_damping" in of_unit:
        message = (
            "load_damping follows from the motion of the parts, whose conveyed_mass the study gives"
        )
        problems.append(
            Problem("parameters.load_damping", message, "Give either load_damping or conveyed_mass")
        )
    return problems


# --- equations


def amplitude(*, track_amplitude: Array) -> Array:
    """Return the amplitude of the track, computed for its drive unit [m]."""
    return track_amplitude


def beta(*, vibration_angle: Array) -> Array:
    """Return the vibration angle above the track, computed for its drive unit [rad]."""
    return vibration_angle


def loaded_mass(*, moving_mass: Array, load_mass: Array, part_load: Load) -> Array:
    """Return the moving mass with the load and the effective mass of travelling parts [kg]."""
    return drive_unit.loaded_mass(moving_mass=moving_mass, load_mass=load_mass) + part_load.mass


def loaded_inertia(
    *, moving_inertia: Array, load_mass: Array, part_load: Load, load_radius: Array
) -> Array:
    """Return the inertia with the load and the effective mass of travelling parts [kg m2]."""
    return drive_unit.loaded_inertia(
        moving_inertia=moving_inertia, load_mass=load_mass + part_load.mass, load_radius=load_radius
    )


def load_damping(*, part_load: Load) -> Array:
    """Return the damping against the ground by which travelling parts act on the unit [N s m-1]."""
    return part_load.damping


def has_several_amplitudes(*, part_load: Load) -> Mask:
    """True where drive and parts agree on several amplitudes; the smallest is reported."""
    return part_load.several


def hunts(*, part_load: Load) -> Mask:
    """True where the parts' motion changes abruptly at the amplitude where both would agree."""
    return part_load.hunts


def is_thrown_hard(*, part_load: Load) -> Mask:
    """True where thrown parts disturb the track, whose motion is assumed to be a sine."""
    return part_load.thrown


_LOADED = {
    "loaded_mass": Equation("loaded_mass", loaded_mass, SOURCE),
    "loaded_inertia": Equation("loaded_inertia", loaded_inertia, SOURCE),
}
_RESULTS = (
    Equation("load_damping", load_damping, SOURCE),
    *fields(
        "part_load",
        SOURCE,
        effective_mass=("mass", "the mass that the drive feels of the conveyed parts [kg]"),
        effective_damping=("damping", "the damper that the conveyed parts are [N s m-1]"),
        largest_amplitude=("largest", "the largest amplitude at which drive and parts agree [m]"),
    ),
)
_ON_TRACK = {"load_radius": Equation("load_radius", bowl_track.load_radius, bowl_track.SOURCE)}
_GIVES_WAY = (Equation("amplitude", amplitude, SOURCE), Equation("beta", beta, SOURCE))


@dataclass(frozen=True)
class _Spliced:
    """The equations of a part on a drive unit."""

    unit: ChosenUnit
    contacts: Contacts

    def equations(self, of_part: Collection[Equation]) -> tuple[Equation, ...]:
        """Return all equations of a part on a drive unit: those of unit, part, and whole track.

        The amplitude and angle of the track, which the equations `of_part` take as given under a
        sine, follow from the unit. If it is loaded by conveyed parts, an equation for their load is
        added, and those of the unit are changed to count it.
        """
        unit = self.unit
        of_unit = unit.scene.variants[unit.variant]
        if unit.shape is not None:
            of_part = under_wave(unit.shape, of_part)
        of_track: tuple[Equation, ...] = ()
        if unit.track is not None:
            of_track = bowl_track.along_track(unit.track)
            of_unit = tuple(_ON_TRACK.get(one.gives, one) for one in of_unit)
        if unit.loaded:
            of_unit = (*(_LOADED.get(one.gives, one) for one in of_unit), *_RESULTS)
            load = self._load((*of_track, *of_unit), (*of_track, *of_part))
            says = "Return what the unit feels of the parts, at the amplitude at which both agree."
            load_of_parts = Equation("part_load", load.load, SOURCE, needs=load.needs, says=says)
            of_unit = (load_of_parts, *of_unit)
        found = (*of_track, *of_unit, *_GIVES_WAY, *of_part)
        return found if unit.track is None else (*found, *bowl_track.along(unit.track, found))

    def _load(self, of_unit: Collection[Equation], of_part: Collection[Equation]) -> PartLoad:
        """Return the load of conveyed parts on the drive unit.

        `of_unit` and `of_part` are the equations of the unit and of a part on it. On a bowl's track
        with stretches the load acts at its own place, else where the part is.
        """
        if self.unit.track is None:
            return part_load(of_unit, of_part, self.contacts)
        place = bowl_track.AtLoad(self.unit.track)
        return part_load(of_unit, of_part, self.contacts, place)

    def conditions(self, of_part: tuple[Condition, ...]) -> tuple[Condition, ...]:
        """Return the conditions of regimes of a part on a drive unit, in the order of trial.

        The first condition that holds names the regime of a cell. First come the serious ones of
        the unit (such as overstressed springs) and a stall on the track, then `of_part`, those of
        the part alone. If the parts load the unit, those of this load follow the first of
        `of_part`, and concern all outputs of the part.
        """
        unit = self.unit
        kept = tuple(
            condition
            for condition in unit.scene.conditions[unit.variant]
            if condition.regime in SERIOUS
        )
        if unit.track is not None:
            kept = (*kept, *bowl_track.CONDITIONS)
        if not unit.loaded:
            return (*kept, *of_part)
        any_result = frozenset().union(*(condition.outputs for condition in of_part))
        unresolved, rest = of_part[:1], of_part[1:]
        return (
            *kept,
            *unresolved,
            Condition("hunting", hunts, any_result),
            Condition("several_amplitudes", has_several_amplitudes, any_result),
            Condition("thrown_load", is_thrown_hard, any_result),
            *rest,
        )


def on_unit(system: Scene, unit: ChosenUnit, contacts: Contacts) -> Scene:
    """Return a copy of a scene of motion whose sine drive is computed from a drive unit.

    Amplitude and angle of the track then follow from masses, springs and force of the `unit`.
    `system` is the scene, `contacts` are the surfaces that its parts can touch, for the load by
    which they change the amplitude.
    """
    spliced = _Spliced(unit, contacts)
    follows = {equation.gives for equation in _RESULTS} if unit.loaded else set()
    of_unit = unit.scene.defaults_of(unit.variant)
    defaults = {name: value for name, value in of_unit.items() if name not in follows}
    of_part = dict(system.defaults)
    if unit.track is not None:
        defaults |= bowl_track.DEFAULTS
        of_part.pop("curvature_number", None)  # it follows from the radius
    return replace(
        system,
        validity=f"{system.validity} Drive unit: {unit.scene.validity}",
        variants={name: spliced.equations(known) for name, known in system.variants.items()},
        conditions={name: spliced.conditions(known) for name, known in system.conditions.items()},
        defaults={**defaults, **of_part, **(unit.shape.defaults if unit.shape else {})},
    )
