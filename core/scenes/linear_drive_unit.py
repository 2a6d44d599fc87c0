"""A linear feeder's drive unit: trough and base on leaf springs, the base on feet."""

from __future__ import annotations

from vibrafeed.core.mechanics import drive_unit, linear_drive_unit, turning_drive_unit
from vibrafeed.core.scenes.drive_units import DEFAULTS, LIMITS, MEASURED, SHARED, SPRINGS, tuning
from vibrafeed.core.scenes.scene import Condition, Equation, Scene

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
    Equation("generalised_mass", turning_drive_unit.turning_mass_empty, "theory 15.2"),
    Equation("turning_mass", turning_drive_unit.turning_mass, "theory 15.2"),
    Equation("natural_frequency", turning_drive_unit.turning_frequency, "theory 15.2"),
    Equation("stroke_response", turning_drive_unit.turning_response, "theory 15.2"),
    Equation("track_harmonic", turning_drive_unit.turning_harmonic, "theory 15.2"),
    Equation("trough_turn", turning_drive_unit.trough_turn, "theory 15.2"),
    Equation("track_motion", turning_drive_unit.turning_track, "theory 15.2"),
    Equation("track_amplitude", turning_drive_unit.turning_amplitude, "theory 15.2"),
    Equation("vibration_angle", turning_drive_unit.turning_angle, "theory 15.2"),
)
_RESONANCE, *_SIDES = tuning("foot_force")
CONDITIONS = (
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

SCENE = Scene(
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
        "springs": CONDITIONS,
        "measured": CONDITIONS,
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
