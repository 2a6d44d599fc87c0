"""Suggestions for an unknown name: the name in use here, or the one that was mistyped."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Final

_SYNONYMS: Final[Mapping[str, str]] = {
    # --- parameters
    "friction": "mu µ μ cof friction_coefficient coefficient_of_friction coulomb_friction",
    "friction_static": "mu_s mus mu_0 static_friction static_friction_coefficient stiction",
    "friction_kinetic": "mu_k muk mu_d kinetic_friction dynamic_friction sliding_friction "
    "kinetic_friction_coefficient friction_dynamic friction_sliding",
    "wall_friction": "mu_w mu_wall friction_wall",
    "frequency": "f freq hz drive_frequency driving_frequency vibration_frequency excitation_"
    "frequency rpm vpm omega",
    "amplitude": "a0 amp drive_amplitude vibration_amplitude displacement zero_to_peak",
    "peak_to_peak": "stroke p2p pp p_p pk_pk peak_peak peak2peak stroke_length double_amplitude",
    "alpha": "α azimuth drive_azimuth",  # noqa: RUF001
    "beta": "β angle launch_angle vibration_angle throw_angle drive_angle drive_elevation "
    "elevation throwing_angle conveying_angle spring_angle angle_of_attack direction_angle",
    "gamma": "γ climb climb_angle inclination incline inclination_angle slope slope_angle "  # noqa: RUF001
    "tilt "
    "track_angle helix_angle pitch_angle ramp",
    "delta": "δ lean lean_angle bank bank_angle banking track_lean",
    "radius": "r bowl_radius track_radius",
    "gravity": "g",
    "mass": "m weight part_mass",
    "restitution": "e eps epsilon cor coefficient_of_restitution bounce bounciness",
    "wall_restitution": "eps_w restitution_wall",
    "length": "l part_length size",
    "width": "part_width",
    "height": "part_height thickness",
    "diameter": "d part_diameter",
    "distance": "effective_distance travel",
    "time": "t",
    "drop_height": "height_of_drop fall_height",
    "hold_down": "magnet magnetic_force vacuum",
    # --- outputs
    "conveying_velocity": "velocity speed conveying_speed transport_velocity transport_speed "
    "feed_speed feed_velocity mean_velocity mean_speed average_velocity average_speed v "
    "velocity_mean",
    "feed_rate": "feedrate throughput rate parts_per_minute ppm output_rate",
    "part_gap": "gap spacing part_spacing",
    "occupancy": "fill filling degree_of_filling",
    "transport_velocity": "velocity speed conveying_velocity conveying_speed transport_speed "
    "feed_speed feed_velocity average_velocity v",
    "throw_number": "throw throw_factor throw_index throw_coefficient throwing_number "
    "throwing_factor machine_number k_v",
    "acceleration_x": "acceleration accel ax a_x",
    "acceleration_y": "ay a_y",
    "acceleration_z": "az a_z",
    "floor_force": "normal_force force contact_force reaction_force",
    "flight_fraction": "flight airtime flight_time hopping hops",
    "stick_fraction": "sticking",
    "hop_height": "jump_height height_of_hop",
    "period_multiple": "period periodicity period_doubling",
    "landing_speed": "impact_velocity impact_speed landing_velocity",
    # --- scenes
    "rectangle-on-track": "bowl track bowl_feeder block_on_track part_on_track rectangle_in_bowl "
    "rectangle_on_bowl",
    "rectangle-on-plane": "plane linear linear_feeder straight block block_on_plane "
    "part_on_plane rectangle box_on_plane",
    "cylinder-on-plane": "cylinder round cylinder_on_track roller disc disk",
    # --- answers to `vibrafeed new`
    "rectangle": "block box plate cuboid brick nut rectangular",
    "cylinder": "round rod pin roller disc disk shaft cylindrical",
    "straight": "linear plane trough rail",
    "bowl": "circular curved spiral helix round",
    "speed": "velocity fast motion",
    "drive": "best optimise optimize angle",
    "forces": "force acceleration accelerations load",
    # --- keys and their words
    "simulate": "simulation motion",
    "optimise": "optimize optimization optimisation",
    "sensitivity": "uncertainty monte_carlo tolerances",
    "calibrate": "calibration fit estimate identify inverse",
    "observations": "measurements measured data runs",
    "unknowns": "unknown priors",
    "maximise": "maximize max",
    "minimise": "minimize min",
    "scene": "system geometry",
    "outputs": "results",
    "parameters": "params",
    "trajectory": "course path",
    "events": "event_driven exact",
    "time-stepping": "timestepping stepping",
}


def _names_by_synonym() -> dict[str, tuple[str, ...]]:
    """Return the names of quantities that each synonym stands for, the most likely first.

    Users who write a synonym are told the name in use here.
    """
    spoken: dict[str, tuple[str, ...]] = {}
    for name, others in _SYNONYMS.items():
        for other in others.split():
            spoken[other] = (*spoken.get(other, ()), name)
    return spoken


OTHER_NAMES: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(_names_by_synonym())
"""Each of the other names, in small letters and with underscores, and what may be meant by it.

What comes first is meant where several are known.
"""


def by_synonym(name: str, known: Iterable[str]) -> str | None:
    """Return the known name for which a typed word is a synonym; None if there is none.

    `known` are the names to choose from.
    """
    choice = frozenset(known)
    spoken = name.strip().casefold().replace("-", "_").replace(" ", "_")
    return next((one for one in OTHER_NAMES.get(spoken, ()) if one in choice), None)


PREFIX = 4  # letters of a name that tell which is meant
LONGEST = 60  # letters of a name that are looked at; no name of ours has more


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Return the known name most similar to a mistyped or shortened one; None if none is similar.

    Synonyms come first, then names that begin with the typed one, then similar spellings.
    """
    choice, name = sorted(known), name[:LONGEST]
    said = by_synonym(name, choice)
    if said is not None:
        return said
    longer = [known for known in choice if len(name) >= PREFIX and known.startswith(name)]
    near = longer or difflib.get_close_matches(name, choice, n=1, cutoff=0.6)
    return near[0] if near else None


FEWEST_OF_A_FAMILY = 3
SEARCHED = 8  # names of one request that are worth a search for what was meant


def suggestion(name: str, known: Iterable[str], listed: Iterable[str] | None = None) -> str:
    """Return a sentence that helps with an unknown name: ``Did you mean ...?``, or the known names.

    `name` is the unknown name, `known` are all known ones; `listed` are those to list where none is
    similar, if not all of them.
    """
    choice = sorted(known)
    near = nearest(name, choice)
    if near:
        return f"Did you mean '{near}'?"
    return "Known: " + ", ".join(_in_families(choice if listed is None else sorted(listed)))


class Suggestions:
    """Searches for similar names, for the first eight names only, since each search takes time."""

    def __init__(self) -> None:
        self.left = SEARCHED

    def __call__(self, name: str, known: Iterable[str], listed: Iterable[str] | None = None) -> str:
        """Return a suggestion; after several calls only a plain text, as searching takes time."""
        return self.within(lambda: suggestion(name, known, listed))

    def within(self, search: Callable[[], str]) -> str:
        """Return the result of a search, unless several were made already."""
        self.left -= 1
        return search() if self.left >= 0 else "Fix the ones before it first"


def _in_families(names: Iterable[str]) -> list[str]:
    """Return sorted names; those differing in a last number are joined, as in `spin_1 to _3`.

    A list of known names in a message is shorter so.
    """
    families: dict[str, list[str]] = {}
    for name in names:
        stem, _, number = name.rpartition("_")
        families.setdefault(f"{stem}_" if number.isdecimal() else name, []).append(name)
    texts = []
    for stem, family in families.items():
        if len(family) >= FEWEST_OF_A_FAMILY:
            numbers = [int(name.removeprefix(stem)) for name in family]
            texts.append(f"{stem}{min(numbers)} to _{max(numbers)}")
        else:
            texts += family
    return texts
