"""Equations of both drive units: leaves, damping, the drive, and the regimes of their tuning."""

from __future__ import annotations

from vibrafeed.core.mechanics import drive_unit
from vibrafeed.core.scenes.scene import Condition, Equation

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
