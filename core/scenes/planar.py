"""Equations of all scenes of a part on a plane: drive, gravity, and a floor without a wall."""

from __future__ import annotations

from vibrafeed.core.mechanics import friction, vibration
from vibrafeed.core.scenes.scene import STANDARD_GRAVITY, Equation

DRIVE = (
    Equation("vibration_acceleration", vibration.vibration_acceleration, "theory 0.2"),
    Equation("drive_along", vibration.drive_along, "(3.8)"),
    Equation("drive_across", vibration.drive_across, "(3.8)"),
    Equation("drive_normal", vibration.drive_normal, "(3.8)"),
    Equation("gravity_along", vibration.gravity_along, "(3.11)"),
    Equation("normal_acceleration", vibration.normal_acceleration, "(3.9), (3.11)"),
    Equation("throw_number", vibration.throw_number, "theory 13.2"),
    Equation("in_plane_drive_x", vibration.in_plane_drive_x, "theory 3"),
)

PLANE = (
    *DRIVE,
    Equation("gravity_normal", vibration.gravity_normal, "(3.11)"),
    Equation("in_plane_drive_y", vibration.in_plane_drive_y, "theory 3"),
    Equation("in_plane_drive", vibration.in_plane_drive, "theory 3.2"),
    Equation("rotated_acceleration_x", vibration.rotated_acceleration_x, "(3.10), (3.12)"),
    Equation("rotated_acceleration_y", vibration.rotated_acceleration_y, "(3.10), (3.12)"),
    Equation("floor_force", vibration.floor_force, "(3.9), (3.11)"),
)

PER_AXIS = (
    Equation("acceleration_x", friction.per_axis_acceleration_x, "(3.9), (3.11)", "thesis"),
    Equation("acceleration_y", friction.per_axis_acceleration_y, "(3.9), (3.11)", "thesis"),
    Equation("acceleration_z", vibration.no_acceleration_z, "(3.9), (3.11)", "thesis"),
    Equation("floor_acceleration", vibration.unchecked_acceleration, "(3.9), (3.11)", "thesis"),
)

UNILATERAL = (
    Equation("floor_acceleration", vibration.supported_acceleration, "theory 3.2", "physical"),
    Equation("acceleration_z", vibration.lift_off_acceleration, "theory 3.2", "physical"),
)

PLANE_DEFAULTS = {"alpha": 0.0, "gamma": 0.0, "gravity": STANDARD_GRAVITY}

ACCELERATIONS = frozenset(
    (
        "acceleration_x",
        "acceleration_y",
        "rotated_acceleration_x",
        "rotated_acceleration_y",
        "sliding_fraction",
        "regime",
    )
)
FLOOR = frozenset(
    ("normal_acceleration", "throw_number", "floor_acceleration", "floor_force", "acceleration_z")
)
