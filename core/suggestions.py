"""Suggestions for an unknown name: the name in use here, or the one that was mistyped."""

import difflib
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Final

from vibrafeed.core.quantities import QUANTITIES, WORD_OF, WORDS, letter_of

_SYNONYMS: Final[Mapping[str, str]] = {
    # --- parameters
    "friction": "mu µ μ cof friction_coefficient coefficient_of_friction coulomb_friction",
    "friction_static": "mu_s friction_s mus mu_0 static_friction static_friction_coefficient "
    "stiction",
    "friction_kinetic": "mu_k friction_k friction_d muk mu_d kinetic_friction dynamic_friction "
    "sliding_friction kinetic_friction_coefficient friction_dynamic friction_sliding",
    "wall_friction": "mu_w mu_wall friction_wall",
    "frequency": "f freq hz drive_frequency driving_frequency vibration_frequency excitation_"
    "frequency",
    "amplitude": "a0 amp drive_amplitude vibration_amplitude zero_to_peak half_stroke",
    "peak_to_peak": "stroke p2p pp p_p pk_pk pk2pk peak_peak peak2peak stroke_length "
    "double_amplitude amplitude_pp amplitude_p2p amplitude_peak_to_peak",
    "vertical_amplitude": "amplitude_vertical amplitude_normal normal_amplitude amplitude_z "
    "z_amplitude v_amplitude vert_amplitude amplitude_vert",
    "vertical_peak_to_peak": "vertical_stroke stroke_vertical normal_stroke peak_to_peak_vertical "
    "peak_to_peak_normal normal_peak_to_peak vertical_p2p",
    "alpha": "α drive_azimuth",  # noqa: RUF001
    "beta": "β angle launch_angle vibration_angle throw_angle drive_angle drive_elevation "
    "throwing_angle conveying_angle spring_angle angle_of_attack direction_angle",
    "gamma": "γ climb_angle inclination incline inclination_angle slope slope_angle "  # noqa: RUF001
    "tilt "
    "track_angle helix_angle pitch_angle ramp",
    "delta": "δ lean_angle bank bank_angle banking track_lean",
    "radius": "r bowl_radius track_radius",
    "gravity": "g",
    "mass": "m part_mass",
    "restitution": "e eps epsilon cor coefficient_of_restitution bounce bounciness",
    "wall_restitution": "eps_w restitution_wall",
    "length": "l part_length size",
    "width": "part_width",
    "height": "part_height thickness",
    "diameter": "d part_diameter",
    "distance": "effective_distance travel",
    "time": "t",
    "rolling_resistance": "rolling_friction friction_rolling rolling_friction_coefficient "
    "coefficient_of_rolling_friction",
    "ring_down_frequency": "natural_frequency resonance_frequency resonant_frequency "
    "eigenfrequency",
    "moving_mass": "trough_mass mass_of_trough mass_of_bowl",
    "base_mass": "counter_mass countermass",
    "centre_of_mass": "center_of_mass centre_of_gravity center_of_gravity cog com",
    "drop_height": "height_of_drop fall_height",
    "drive_force": "force exciting_force excitation_force",
    "hold_down": "magnet vacuum",
    "hold_down_force": "magnetic_force holding_force suction_force",
    # --- outputs
    "conveying_velocity": "velocity speed conveying_speed transport_velocity transport_speed "
    "feed_speed feed_velocity mean_velocity mean_speed average_velocity average_speed v "
    "velocity_mean",
    "travel_speed": "velocity speed conveying_velocity mean_speed average_speed",
    "travel_direction": "direction heading direction_of_travel angle_of_travel",
    "oriented_feed_rate": "wanted_feed_rate",
    "feed_rate": "feedrate throughput rate parts_per_minute ppm output_rate",
    "part_gap": "gap",
    "occupancy": "fill filling degree_of_filling",
    "transport_velocity": "velocity speed conveying_velocity conveying_speed transport_speed "
    "feed_speed feed_velocity average_velocity v",
    "throw_number": "throw throw_factor throw_index throw_coefficient throwing_number "
    "throwing_factor k_v",
    "acceleration_x": "acceleration accel ax a_x",
    "acceleration_y": "ay a_y",
    "acceleration_z": "az a_z",
    "floor_force": "normal_force force contact_force reaction_force",
    "flight_fraction": "flight hopping hops",
    "stick_fraction": "sticking",
    "hop_height": "jump_height height_of_hop",
    "period_multiple": "periodicity period_doubling",
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
    "file": "recording recording_file csv path filename file_name",
    "scene": "system geometry",
    "outputs": "results",
    "parameters": "params",
    "trajectory": "course path",
    "events": "event_driven exact",
}


_RELATIONS: Final = (
    ("frequency", "omega w circular_frequency angular_frequency angular_velocity angular_speed",
     "Write frequency = omega/(2 pi), in Hz"),
    ("frequency", "rpm vpm cpm speed_of_rotation rotational_speed motor_speed",
     'Write the unit with the value: frequency = "3000 rpm"'),
    ("frequency", "period period_time time_period drive_period vibration_period",
     "Write frequency = 1/period"),
    ("frequency", "line_frequency mains_frequency grid_frequency supply_frequency",
     "Write the frequency of the vibration: a magnet pulls once or twice in a period of the mains"),
    ("amplitude", "displacement",
     "Write amplitude from zero to peak, or peak_to_peak, the whole stroke"),
    ("amplitude", "horizontal_amplitude amplitude_horizontal amplitude_along along_amplitude "
     "amplitude_x x_amplitude longitudinal_amplitude",
     "Write amplitude = horizontal amplitude/cos(beta)"),
    ("vertical_amplitude", "amplitude_y y_amplitude",
     "Write vertical_amplitude, and beta, if y is normal to the track"),
    ("amplitude", "angular_amplitude torsional_amplitude amplitude_angle",
     "Write amplitude = angle in radians times radius/cos(beta)"),
    ("phase_normal_1", "phase phase_lag phase_angle phase_shift phase_difference",
     "Write phase_normal_1 = lead of the normal motion over that along (a lag is negative), beside "
     "amplitude_along_1 and amplitude_normal_1"),
    ("peak_to_peak", "horizontal_stroke stroke_horizontal horizontal_peak_to_peak "
     "peak_to_peak_horizontal", "Write peak_to_peak = horizontal stroke/cos(beta)"),
    ("amplitude", "rms_amplitude amplitude_rms rms displacement_rms rms_displacement",
     "Write amplitude = sqrt(2) times the rms value of a sine"),
    ("amplitude", "acceleration_amplitude amplitude_acceleration drive_acceleration "
     "peak_acceleration vibration_acceleration acceleration",
     "Write amplitude = acceleration/(2 pi frequency)^2, along the drive"),
    ("amplitude", "machine_number g_level g_force",
     "Write amplitude = machine number times gravity/(2 pi frequency)^2, along the drive"),
    ("vertical_amplitude", "vertical_acceleration acceleration_vertical normal_acceleration "
     "acceleration_normal",
     "Write vertical_amplitude = acceleration/(2 pi frequency)^2, and beta"),
    ("amplitude", "rms_acceleration acceleration_rms grms g_rms",
     "Write amplitude = sqrt(2) rms/(2 pi frequency)^2, along the drive"),
    ("amplitude", "velocity_amplitude vibration_velocity peak_velocity drive_velocity",
     "Write amplitude = velocity/(2 pi frequency), along the drive"),
    ("amplitude", "rms_velocity velocity_rms",
     "Write amplitude = sqrt(2) rms/(2 pi frequency), along the drive"),
    ("beta", "angle_to_horizontal angle_from_horizontal horizontal_angle",
     "Write beta = angle above the horizontal less gamma: it counts from the track"),
    ("beta", "angle_to_vertical angle_from_vertical vertical_angle",
     "Write beta = 90 degrees less the angle from the normal of the track"),
    ("gamma", "track_pitch helix_pitch rise rise_per_turn climb_per_turn lead climb_height",
     "Write gamma = atan(rise per turn/(2 pi radius))"),
    ("gamma", "slope_percent gamma_percent incline_percent grade gradient",
     "Write gamma = atan(per cent/100)"),
    ("radius", "bowl_diameter track_diameter",
     "Write radius = diameter/2, at the wall of the track"),
    ("diameter", "part_radius cylinder_radius ball_radius roller_radius",
     "Write diameter = 2 times the radius"),
    ("mass", "weight part_weight weight_force",
     'Write mass = weight/gravity of a weight in newtons; of one in grams, mass = "5 g"'),
    ("mass", "density part_density volume part_volume", "Write mass = density times volume"),
    ("friction", "friction_angle angle_of_friction angle_of_repose slip_angle",
     "Write friction = tan(angle at which the part begins to slide)"),
    ("part_gap", "spacing part_spacing pitch_of_parts",
     "Write part_gap = spacing from part to part less the length of a part"),
    ("hold_down_force", "vacuum_pressure suction holding_pressure",
     "Write hold_down_force = pressure times area"),
    ("drive_voltage", "voltage volts drive_volts supply_voltage controller_voltage magnet_voltage "
     "coil_voltage drive_current current coil_current amperes amps",
     "A magnet's force goes with the square of voltage and current: give drive_voltage, and one "
     "measured point by measured_voltage, measured_amplitude and measured_frequency"),
    ("drive_force", "static_force mean_force magnet_mean_force",
     "Write drive_force = amplitude of the alternating part of the force"),
    ("damping_ratio", "quality_factor q_factor", "Write damping_ratio = 1/(2 Q)"),
    ("damping_ratio", "loss_factor", "Write damping_ratio = loss factor/2"),
    ("damping_ratio", "logarithmic_decrement log_decrement decrement",
     "Write damping_ratio = logarithmic decrement/(2 pi)"),
    ("damping_ratio", "damping_coefficient damping_constant damping",
     "Write damping_ratio = c/(2 sqrt(stiffness times mass))"),
    ("spring_stiffness", "spring_rate spring_rates spring_constant stiffness",
     "Write spring_stiffness = stiffness of all springs together, along the stroke"),
    ("spring_angle", "spring_angle_horizontal angle_of_springs_to_horizontal",
     "Write spring_angle = 90 degrees less the angle from the horizontal"),
    ("throw_number", "machine_number",
     "Ask for throw_number: machine number times sin(beta)/cos(gamma)"),
    ("feed_rate", "parts_per_hour pph parts_per_second",
     "Ask for feed_rate, in parts a minute"),
    ("flight_fraction", "flight_time airtime time_of_flight",
     "Ask for flight_fraction: flight time times frequency"),
    ("period_multiple", "period", "Ask for period_multiple: period times frequency"),
    *(
        (name, " ".join(name.replace("let_down", old) for old in ("resting", "second")),
         f"Ask for {name} and {name.replace('let_down', 'thrown')}: the share is between them")
        for name in QUANTITIES if name.startswith("let_down_share_")
    ),
)  # fmt: skip
"""Quantities that are not a parameter or an output, but make one: that, their names, and how."""

_ALIKE: Final = 0.81
"""Similarity of two words from which on one may be the other, misspelt."""
_JOINED: Final = 0.9
"""Similarity of two names from which on only the breaks between words, or a letter, differ."""

_UNITS: Final = {
    "m": {"m": "m", "mm": "mm", "um": "um", "micron": "um", "microns": "um", "cm": "cm",
          "inch": "inch", "in": "inch", "mil": "mil", "mils": "mil"},
    "Hz": {"hz": "Hz", "rpm": "rpm", "vpm": "vpm", "cpm": "cpm"},
    "degree": {"deg": "deg", "degree": "deg", "degrees": "deg", "rad": "rad"},
    "kg": {"kg": "kg", "g": "g", "mg": "mg"},
    "s": {"s": "s", "sec": "s", "ms": "ms"},
    "N": {"n": "N", "mn": "mN", "kn": "kN"},
    "Pa": {"pa": "Pa", "mpa": "MPa", "gpa": "GPa"},
}  # fmt: skip
"""Last words of names that say in which unit a value is meant, by the unit of the quantity."""


def _names_by_synonym() -> dict[str, tuple[str, ...]]:
    spoken: dict[str, tuple[str, ...]] = {word: (name,) for word, name in WORDS.items()}
    for name, others in _SYNONYMS.items():
        for other in others.split():
            spoken[other] = (*spoken.get(other, ()), name)
    return spoken


OTHER_NAMES: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(_names_by_synonym())
"""Each of the other names, in small letters and with underscores, and what may be meant by it.

What comes first is meant where several are known.
"""


def by_synonym(name: str, known: Iterable[str]) -> str | None:
    """Return the known name for which a typed word is a synonym; None if there is none."""
    known_names = frozenset(known)
    return next(
        (candidate for candidate in OTHER_NAMES.get(_plain(name), ()) if candidate in known_names),
        None,
    )


def _plain(name: str) -> str:
    return name.strip().casefold().replace("-", "_").replace(" ", "_")


PREFIX = 4  # letters of a name that tell which is meant
SHORT = 3  # letters from which on a word of a name may be misspelt
LONGEST = 60  # letters of a name that are looked at; no name of ours has more


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Return the known name most similar to a mistyped or shortened one; None if none is similar.

    Synonyms come first, then names that begin with the typed one, then similar spellings. Another
    quantity, such as `amplitude` for `rms_amplitude`, is not similar.
    """
    candidates, name = sorted(known), name[:LONGEST]
    synonym = by_synonym(name, candidates)
    if synonym is not None:
        return synonym
    candidates = [word for word, letter in WORDS.items() if letter in candidates] + candidates
    completions = [known for known in candidates if len(name) >= PREFIX and known.startswith(name)]
    similar = completions or difflib.get_close_matches(name, candidates, n=3, cutoff=0.6)
    return next(
        (
            letter_of(each)
            for each in similar
            if letter_of(each) not in QUANTITIES or _may_mean(_plain(name), each)
        ),
        None,
    )


def _may_mean(typed: str, name: str) -> bool:
    # True for the start of a name, nearly its spelling, or its words, each perhaps misspelt; not
    # with a short word added, which may be a unit.
    name = _plain(name)
    added_words = {*typed.split("_")} - {*name.split("_")}
    if not name.startswith(typed) and any(
        0 < len(word) < SHORT and word.isalpha() for word in added_words
    ):
        return False
    if (
        name.startswith(typed)
        or difflib.SequenceMatcher(None, typed.replace("_", ""), name.replace("_", "")).ratio()
        >= _JOINED
    ):
        return True
    typed_words = typed.split("_")
    name_words = [word for word in name.split("_") if not word.isdecimal()]
    if len(typed_words) == len(name_words) == 1:
        return True

    def has_all(among: list[str], wanted: list[str]) -> bool:
        return all(difflib.get_close_matches(word, among, n=1, cutoff=_ALIKE) for word in wanted)

    typed_words = [word for word in typed_words if not word.isdecimal()]
    return has_all(typed_words, name_words) and has_all(name_words, typed_words)


def relation(name: str, known: Iterable[str]) -> tuple[str, str] | None:
    """Return the known name that a typed quantity makes, and a sentence that says how, or None.

    Of `angular_frequency` it is `frequency`, and the factor of 2 pi; of `amplitude_mm` it is
    `amplitude`, and where to write the unit.
    """
    known_names, typed = frozenset(known), _plain(name[:LONGEST])
    for target, names, sentence in _RELATIONS:
        if target in known_names and typed in names.split():
            return target, sentence
    stem, _, ending = typed.rpartition("_")
    target = stem if stem in known_names else by_synonym(stem, known_names) or ""
    unit = _UNITS.get(QUANTITIES[target].unit, {}).get(ending) if target in QUANTITIES else None
    if unit is not None:
        return target, f'Write the unit with the value, as in {target} = "1 {unit}"'
    return None


def intended(name: str, known: Iterable[str]) -> str | None:
    """Return the known name that a user probably intended or has a quantity for; None without."""
    known_names = [*known]
    related = relation(name, known_names)
    return related[0] if related is not None else nearest(name, known_names)


FEWEST_OF_A_FAMILY = 3
SEARCHED = 8  # names of one request that are worth a search for what was meant


def suggestion(name: str, known: Iterable[str], shown_names: Iterable[str] | None = None) -> str:
    """Return a sentence that helps with an unknown name.

    It says how a known quantity follows, asks ``Did you mean ...?``, or lists the known names.
    """
    known_names = sorted(known)
    related = relation(name, known_names)
    if related is not None:
        return related[1]
    similar = nearest(name, known_names)
    if similar:
        return f"Did you mean '{similar}'{f' ({WORD_OF[similar]})' if similar in WORD_OF else ''}?"
    return "Known: " + ", ".join(
        _in_families(known_names if shown_names is None else sorted(shown_names))
    )


class Suggestions:
    """Searches for similar names, for the first eight names only, since each search takes time."""

    def __init__(self) -> None:
        self.left = SEARCHED

    def __call__(self, name: str, known: Iterable[str], listed: Iterable[str] | None = None) -> str:
        """Return a suggestion; after several calls only a plain text."""
        return self.within(lambda: suggestion(name, known, listed))

    def within(self, search: Callable[[], str]) -> str:
        """Return the result of a search, unless several were made already."""
        self.left -= 1
        return search() if self.left >= 0 else "Fix the ones before it first"


def _in_families(names: Iterable[str]) -> list[str]:
    # Names that differ by a number alone are one text, such as `gap_1 to _9`.
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
