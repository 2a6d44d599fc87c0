"""Equations of both drive units: leaves, damping, the drive, and the regimes of their tuning."""

from __future__ import annotations

from vibrafeed.core.mechanics import bowl_drive_unit, drive_unit, linear_drive_unit
from vibrafeed.core.scenes.scene import Condition, Equation, Scene

SPRINGS = (Equation("spring_stiffness", drive_unit.leaf_stiffness, "theory 15.1", "springs"),)
MEASURED = (Equation("spring_stiffness", drive_unit.tuned_stiffness, "theory 15.1", "measured"),)
SHARED = (
    Equation("circular_frequency", drive_unit.circular_frequency, "theory 15.1"),
    Equation("damping", drive_unit.damping, "theory 15.1"),
    Equation("loaded_mass", drive_unit.loaded_mass, "theory 15.1"),
    Equation("stroke", drive_unit.stroke, "theory 15.2"),
    Equation("phase", drive_unit.phase, "theory 15.2"),
    Equation("amplification", drive_unit.amplification, "theory 15.2"),
    Equation("drive_unit_power", drive_unit.drive_unit_power, "theory 15.2"),
    Equation("spring_stress", drive_unit.spring_stress, "theory 15.1"),
    Equation("stress_margin", drive_unit.stress_margin, "theory 15.1"),
    Equation("leaf_frequency", drive_unit.leaf_frequency, "theory 15.1"),
    Equation("leaf_mass", drive_unit.leaf_mass, "theory 15.1"),
    Equation("air_gap_margin", drive_unit.air_gap_margin, "theory 15.2"),
    Equation("second_harmonic", drive_unit.second_harmonic, "theory 15.2"),
)
DEFAULTS = {
    "load_mass": 0.0,
    "load_damping": 0.0,
    "gamma": 0.0,
    "clamp_factor": 1.0,
    "force_harmonic": 0.0,
}

STROKES = frozenset(
    (
        *("stroke", "phase", "amplification", "drive_unit_power", "spring_stress"),
        *("stress_margin", "air_gap_margin", "track_amplitude", "second_harmonic"),
    )
)
LIMITS = (
    Condition("hits_magnet", drive_unit.hits_magnet, frozenset(("air_gap_margin",))),
    Condition("overstressed", drive_unit.is_overstressed, frozenset(("stress_margin",))),
)


def tuning(*outputs: str) -> tuple[Condition, ...]:
    """Return the conditions for a drive unit at resonance, tuned stiff or tuned soft.

    A unit is tuned stiff if its natural frequency is above that of the drive. The regime is looked
    at if a study asks for a stroke or one of the given `outputs`.
    """
    concerned = STROKES | frozenset(outputs)
    return (
        Condition("resonance", drive_unit.is_at_resonance, concerned),
        Condition("tuned_stiff", drive_unit.is_tuned_stiff, concerned, otherwise="tuned_soft"),
    )


# --- A linear feeder's drive unit: trough and base on leaf springs, the base on feet.

LINEAR = (
    *SHARED,
    Equation("generalised_mass", drive_unit.reduced_mass, "theory 15.2"),
    Equation("natural_frequency", linear_drive_unit.natural_frequency, "theory 15.2"),
    Equation("foot_frequency", linear_drive_unit.foot_frequency, "theory 15.2"),
    Equation("stroke_response", linear_drive_unit.stroke_response, "theory 15.2"),
    Equation("track_amplitude", linear_drive_unit.linear_amplitude, "theory 15.2"),
    Equation("vibration_angle", linear_drive_unit.linear_angle, "theory 15.2"),
    Equation("foot_force", linear_drive_unit.floor_force, "theory 15.2"),
    Equation("track_harmonic", linear_drive_unit.track_harmonic, "theory 15.2"),
)
TURNING = (
    *SHARED,
    Equation("generalised_mass", linear_drive_unit.turning_mass_empty, "theory 15.2"),
    Equation("turning_mass", linear_drive_unit.turning_mass, "theory 15.2"),
    Equation("natural_frequency", linear_drive_unit.turning_frequency, "theory 15.2"),
    Equation("stroke_response", linear_drive_unit.turning_response, "theory 15.2"),
    Equation("track_harmonic", linear_drive_unit.turning_harmonic, "theory 15.2"),
    Equation("trough_turn", linear_drive_unit.trough_turn, "theory 15.2"),
    Equation("track_motion", linear_drive_unit.turning_track, "theory 15.2"),
    Equation("track_amplitude", linear_drive_unit.turning_amplitude, "theory 15.2"),
    Equation("vibration_angle", linear_drive_unit.turning_angle, "theory 15.2"),
)
_RESONANCE, *_SIDES = tuning("foot_force")
LINEAR_CONDITIONS = (
    *LIMITS,
    _RESONANCE,
    Condition("isolation_poor", drive_unit.is_poorly_isolated, frozenset(("foot_force",))),
    *_SIDES,
)
OF_TURNING = (*LIMITS, *tuning("trough_turn"))
STRAIGHT_DEFAULTS = {"foot_stiffness": 0.0, "foot_damping": 0.0}
TURNING_DEFAULTS = dict.fromkeys(
    ("offset_along", "offset_upward", "spot_along", "spot_upward"), 0.0
)

LINEAR_SCENE = Scene(
    name="linear-drive-unit",
    title="Drive unit of a linear feeder",
    source="",
    validity="Two rigid masses, small harmonic motion in its steady state, below a third of the "
    "first mode of a leaf or of the trough. The force acts through both mass centres: amplitude "
    "and angle are the same along the track; where it misses them both masses turn (variants "
    "springs_turning and measured_turning, the base free). A load lies still on the track.",
    variants={
        "springs": (*LINEAR, *SPRINGS),
        "measured": (*LINEAR, *MEASURED),
        "springs_turning": (*TURNING, *SPRINGS),
        "measured_turning": (*TURNING, *MEASURED),
    },
    default_variant="springs",
    conditions={
        "springs": LINEAR_CONDITIONS,
        "measured": LINEAR_CONDITIONS,
        "springs_turning": OF_TURNING,
        "measured_turning": OF_TURNING,
    },
    defaults=DEFAULTS,
    variant_defaults={
        "springs": STRAIGHT_DEFAULTS,
        "measured": STRAIGHT_DEFAULTS,
        "springs_turning": TURNING_DEFAULTS,
        "measured_turning": TURNING_DEFAULTS,
    },
    constraints=(),
)


# --- A bowl feeder's drive unit: bowl and base on tilted leaf springs around their axis.

BOWL = (
    *SHARED,
    Equation("generalised_mass", bowl_drive_unit.bowl_mass_empty, "theory 15.3"),
    Equation("load_radius", bowl_drive_unit.load_radius, "theory 15.3"),
    Equation("loaded_inertia", bowl_drive_unit.loaded_inertia, "theory 15.3"),
    Equation("bowl_mass", bowl_drive_unit.bowl_mass, "theory 15.3"),
    Equation("natural_frequency", bowl_drive_unit.bowl_frequency, "theory 15.3"),
    Equation("stroke_response", bowl_drive_unit.bowl_response, "theory 15.3"),
    Equation("track_harmonic", bowl_drive_unit.bowl_harmonic, "theory 15.3"),
    Equation("bowl_turn", bowl_drive_unit.bowl_turn, "theory 15.3"),
    Equation("bowl_lift", bowl_drive_unit.bowl_lift, "theory 15.3"),
    Equation("track_amplitude", bowl_drive_unit.bowl_amplitude, "theory 15.3"),
    Equation("vibration_angle", bowl_drive_unit.bowl_angle, "theory 15.3"),
)
BOWL_CONDITIONS = (*LIMITS, *tuning("bowl_turn", "bowl_lift"))

BOWL_SCENE = Scene(
    name="bowl-drive-unit",
    title="Drive unit of a bowl feeder",
    source="",
    validity="Two rigid bodies that turn about one axis and lift along it, small harmonic motion "
    "in its steady state, the base free to move. Leaves bend, and do not twist: real ones are "
    "stiffer. The force acts along the stroke of the leaves. A load lies still on the track.",
    variants={"springs": (*BOWL, *SPRINGS), "measured": (*BOWL, *MEASURED)},
    default_variant="springs",
    conditions={"springs": BOWL_CONDITIONS, "measured": BOWL_CONDITIONS},
    defaults=DEFAULTS,
    constraints=(),
)
