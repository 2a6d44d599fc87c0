"""A linear feeder's drive unit: trough and base on leaf springs, the base on feet."""

from __future__ import annotations

from core.mechanics import drive_unit
from core.scenes.drive_units import DEFAULTS, LIMITS, MEASURED, SHARED, SPRINGS, tuning
from core.scenes.scene import Condition, Equation, Scene

LINEAR = (
    *SHARED,
    Equation("generalised_mass", drive_unit.reduced_mass, "theory 15.2"),
    Equation("natural_frequency", drive_unit.natural_frequency, "theory 15.2"),
    Equation("foot_frequency", drive_unit.foot_frequency, "theory 15.2"),
    Equation("stroke_response", drive_unit.stroke_response, "theory 15.2"),
    Equation("track_amplitude", drive_unit.linear_amplitude, "theory 15.2"),
    Equation("vibration_angle", drive_unit.linear_angle, "theory 15.2"),
    Equation("foot_force", drive_unit.floor_force, "theory 15.2"),
)
CONDITIONS = (
    *LIMITS,
    Condition("isolation_poor", drive_unit.is_poorly_isolated, frozenset(("foot_force",))),
    *tuning("foot_force"),
)

SCENE = Scene(
    name="linear-drive-unit",
    title="Drive unit of a linear feeder",
    source="",
    validity="Two rigid masses, small harmonic motion in its steady state, below a third of the "
    "first mode of a leaf or of the trough. The force acts through both mass centres: amplitude "
    "and angle are the same along the track. A load lies still on it.",
    variants={"springs": (*LINEAR, *SPRINGS), "measured": (*LINEAR, *MEASURED)},
    default_variant="springs",
    conditions={"springs": CONDITIONS, "measured": CONDITIONS},
    defaults={**DEFAULTS, "foot_stiffness": 0.0, "foot_damping": 0.0},
    constraints=(),
)
