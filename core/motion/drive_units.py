"""A part on the track of a drive unit: its amplitude and angle follow from springs and masses.

Which unit a study means, its parameters tell, as they tell the kind of drive. The unit's equations
then stand before those of the part; what the parts do to the unit stands in `part_load`.
"""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

from vibrafeed.core.errors import Problem
from vibrafeed.core.mechanics import drive_unit
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion import bowl_track
from vibrafeed.core.motion.drives import SINE, HalfWave, Shape, under_wave
from vibrafeed.core.motion.method import Contacts, where
from vibrafeed.core.motion.part_load import Load, part_load
from vibrafeed.core.motion.scales import product
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


class ChosenUnit(NamedTuple):
    """The drive unit that a study gives, and the track of a bowl on it.

    `variant` is by leaves or by a measured frequency; `loaded` if parts that are conveyed act on
    it; `shape` that of a drive with a second harmonic, None of the plain sine; `track` None of a
    part at one place.
    """

    scene: Scene
    variant: str
    loaded: bool
    shape: Shape | None
    track: bowl_track.Track | None


def unit_of(parameters: Iterable[str]) -> tuple[ChosenUnit | None, list[Problem]]:
    """Return the drive unit that a study's parameter names define (None if none), and problems.

    The problems are of names that fit no unit, or several.
    """
    names = tuple(parameters)
    of_unit = [name for name in names if name in PARAMETERS_OF_UNIT]
    track, problems_of_track = bowl_track.track_of(names, of_bowl=bool({*OF_BOWLS} & {*of_unit}))
    if not of_unit:
        return None, problems_of_track
    name = "bowl-drive-unit" if {*OF_BOWLS} & {*of_unit} else "linear-drive-unit"
    variant = "measured" if "ring_down_frequency" in of_unit else "springs"
    turning = [parameter for parameter in of_unit if parameter in OF_TURNING]
    if turning and name == "linear-drive-unit":
        variant += "_turning"
    loaded = "conveyed_mass" in of_unit
    is_line = "spring_angle" in of_unit and name == "linear-drive-unit"
    line = " and write beta = the spring angle less the climb (gamma)" * is_line
    problems = [
        Problem(
            f"parameters.{other}",
            f"{other} is computed from the drive unit, which {of_unit[0]} belongs to",
            f"Remove {other}, or the whole drive unit ({', '.join(of_unit)})" + line,
        )
        for other in names
        if other in FOLLOWS or other in DRIVE
    ]
    if loaded:
        problems += _problems_of_parts(of_unit, turning)
    shape = HalfWave() if "force_harmonic" in of_unit else None
    unit = ChosenUnit(SCENES[name], variant, loaded, shape, track)
    return unit, [*problems, *problems_of_track]


def _problems_of_parts(of_unit: list[str], turning: list[str]) -> Iterator[Problem]:
    # Parameters that exclude `conveyed_mass`: the effect of the parts on the unit is not modelled
    # beside them.
    if turning:
        yield Problem(
            "parameters.conveyed_mass",
            "conveyed_mass cannot be used for a drive unit that also turns",
            f"Give load_mass instead, or remove {', '.join(turning)}",
        )
    if "force_harmonic" in of_unit:
        yield Problem(
            "parameters.conveyed_mass",
            "conveyed_mass cannot be used together with force_harmonic",
            "Give load_mass instead, or remove force_harmonic",
        )
    if "load_damping" in of_unit:
        yield Problem(
            "parameters.load_damping",
            "load_damping is computed from the motion of the parts if conveyed_mass is given",
            "Give either load_damping or conveyed_mass",
        )


# --- equations


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


_LOADED = {
    "loaded_mass": Equation("loaded_mass", loaded_mass, SOURCE),
    "loaded_inertia": Equation("loaded_inertia", loaded_inertia, SOURCE),
}
_RESULTS = (
    *fields(
        "part_load",
        SOURCE,
        load_damping=(
            "damping",
            "the damping against the ground by which travelling parts act on the unit [N s m-1]",
        ),
        effective_mass=("mass", "the mass that the drive feels of the conveyed parts [kg]"),
        effective_damping=("damping", "the damper that the conveyed parts are [N s m-1]"),
        largest_amplitude=("largest", "the largest amplitude at which drive and parts agree [m]"),
    ),
)
_ON_TRACK = {"load_radius": Equation("load_radius", bowl_track.load_radius, bowl_track.SOURCE)}
_GIVES_WAY = (
    product(
        "amplitude", "track_amplitude", source=SOURCE,
        says="the amplitude of the track, computed for its drive unit [m]",
    ),
    product(
        "beta", "vibration_angle", source=SOURCE,
        says="the vibration angle above the track, computed for its drive unit [rad]",
    ),
)  # fmt: skip


def _equations(
    unit: ChosenUnit, contacts: Contacts, of_part: Collection[Equation]
) -> tuple[Equation, ...]:
    # Those of the track first, then of the unit, then of the part, whose amplitude and angle the
    # unit gives.
    of_unit = unit.scene.variants[unit.variant]
    if unit.shape is not None:
        of_part = under_wave(unit.shape, of_part)
    of_track: tuple[Equation, ...] = ()
    if unit.track is not None:
        of_track = bowl_track.along_track(unit.track)
        of_unit = tuple(_ON_TRACK.get(equation.gives, equation) for equation in of_unit)
    if unit.loaded:
        of_unit = (*(_LOADED.get(equation.gives, equation) for equation in of_unit), *_RESULTS)
        unit_and_part = ((*of_track, *of_unit), (*of_track, *of_part))
        load = part_load(*unit_and_part, contacts, unit.track)
        says = "Return what the unit feels of the parts, at the amplitude at which both agree."
        load_of_parts = Equation("part_load", load.load, SOURCE, needs=load.needs, says=says)
        of_unit = (load_of_parts, *of_unit)
    equations = (*of_track, *of_unit, *_GIVES_WAY, *of_part)
    return (
        equations if unit.track is None else (*equations, *bowl_track.along(unit.track, equations))
    )


def _conditions(unit: ChosenUnit, of_part: tuple[Condition, ...]) -> tuple[Condition, ...]:
    # Serious regimes of unit and track come before all of the part; those of its load come behind
    # the part's first, which says that no motion was found.
    of_unit = unit.scene.conditions[unit.variant]
    conditions = [condition for condition in of_unit if condition.regime in SERIOUS]
    if unit.track is not None:
        conditions += bowl_track.CONDITIONS
    if not unit.loaded:
        return (*conditions, *of_part)
    any_result = {name for condition in of_part for name in condition.outputs}
    return (
        *conditions,
        *of_part[:1],
        where(
            "hunting",
            "the parts' motion changes abruptly at the amplitude where both would agree",
            lambda *, part_load: part_load.hunts,
            any_result,
        ),
        where(
            "several_amplitudes",
            "drive and parts agree on several amplitudes; the smallest is reported",
            lambda *, part_load: part_load.several,
            any_result,
        ),
        where(
            "thrown_load",
            "thrown parts disturb the track, whose motion is assumed to be a sine",
            lambda *, part_load: part_load.thrown,
            any_result,
        ),
        *of_part[1:],
    )


def on_unit(system: Scene, unit: ChosenUnit, contacts: Contacts) -> Scene:
    """Return a copy of a scene of motion whose sine drive is computed from a drive unit.

    `contacts` are the surfaces that its parts can touch, for the load by which they change the
    amplitude.
    """
    computed = {equation.gives for equation in _RESULTS} if unit.loaded else set()
    of_unit = unit.scene.defaults_of(unit.variant)
    defaults = {name: value for name, value in of_unit.items() if name not in computed}
    of_part = dict(system.defaults)
    if unit.track is not None:
        defaults |= bowl_track.DEFAULTS
        of_part.pop("curvature_number", None)  # it follows from the radius
    return replace(
        system,
        validity=f"{system.validity} Drive unit: {unit.scene.validity}",
        variants={
            name: _equations(unit, contacts, known) for name, known in system.variants.items()
        },
        conditions={name: _conditions(unit, known) for name, known in system.conditions.items()},
        defaults={**defaults, **of_part, **(unit.shape.defaults if unit.shape else {})},
    )
