"""A cylinder that rolls and yaws on a level plane, by screw theory; chapter 4 of the source."""

from __future__ import annotations

from vibrafeed.core.mechanics import vibration, yawing
from vibrafeed.core.scenes.scene import STANDARD_GRAVITY, Condition, Equation, Scene, fields

AXES = (
    *fields(
        "floor_reduction",
        "(4.1), theory 9.1",
        floor_pitch=("pitch", "the pitch of the floor's wrench [m]"),
    ),
    *fields(
        "floor_reduction",
        "(4.3), theory 9.1",
        floor_axis_normal=(
            "axis_point",
            (..., 0),
            "where the axis of the floor's wrench passes the centre, along n [m]",
        ),
        floor_axis_rolling=(
            "axis_point",
            (..., 1),
            "where the axis of the floor's wrench passes the centre, along eta [m]",
        ),
        floor_axis_axial=(
            "axis_point",
            (..., 2),
            "where the axis of the floor's wrench passes the centre, along sigma [m]",
        ),
    ),
    *fields(
        "force_reduction",
        "(4.1), theory 9.1",
        force_pitch=(
            "pitch",
            "the pitch of the force system: 0 up to rounding, whatever the data [m]",
        ),
    ),
    *fields(
        "force_reduction",
        "(4.3), theory 9.1",
        force_axis_normal=(
            "axis_point",
            (..., 0),
            "where the axis of the force system passes the centre, along n: r/2 [m]",
        ),
        force_axis_rolling=(
            "axis_point",
            (..., 1),
            "where the axis of the force system passes the centre, along eta [m]",
        ),
        force_axis_axial=(
            "axis_point",
            (..., 2),
            "where the axis of the force system passes the centre, along sigma [m]",
        ),
    ),
)
"""Pitch and axis of the wrenches of floor and forces."""

COMMON = (
    Equation("vibration_acceleration", vibration.vibration_acceleration, "theory 0.2"),
    Equation("drive_normal", vibration.drive_normal, "(4.13)"),
    Equation("rolling_drive", yawing.rolling_drive, "(4.13), theory 9.2"),
    Equation("axial_drive", yawing.axial_drive, "(4.13), theory 9.2"),
    Equation("gravity_normal", yawing.level_gravity, "(4.17)"),
    Equation("normal_acceleration", vibration.normal_acceleration, "(4.17)"),
    Equation("throw_number", vibration.throw_number, "theory 13.2"),
    Equation("floor_acceleration", vibration.unchecked_acceleration, "(4.17)"),
    Equation("floor_force", vibration.floor_force, "(4.17)"),
    Equation("axial_friction_acceleration", yawing.axial_friction_acceleration, "(4.16)"),
    Equation("rolling_friction", yawing.rolling_friction, "(4.15)"),
    Equation("axial_friction", yawing.axial_friction, "(4.16)"),
    Equation("spin_acceleration", yawing.spin_acceleration, "(4.19)"),
    Equation("yaw_acceleration", yawing.yaw_acceleration, "(4.18), theory 9.3"),
    Equation("printed_yaw_rate", yawing.printed_yaw_rate, "(4.20), theory 9.4"),
    Equation("pressure_offset_axial", yawing.pressure_offset_axial, "theory 9.3"),
    Equation("required_friction", yawing.required_friction, "theory 9.3"),
    Equation("cone_margin", yawing.cone_margin, "theory 9.3"),
    Equation("floor_wrench", yawing.floor_wrench, "theory 9.3"),
    Equation("force_wrench", yawing.force_wrench, "(4.12), (4.13), theory 9.3"),
    *AXES,
)
THESIS = (
    *COMMON,
    Equation("floor_reduction", yawing.printed_floor_reduction, "(4.1) to (4.7)", "thesis"),
    Equation("force_reduction", yawing.printed_force_reduction, "(4.1) to (4.7)", "thesis"),
)
DERIVED = (
    *COMMON,
    Equation("floor_reduction", yawing.floor_reduction, "(4.1) to (4.7)", "derived"),
    Equation("force_reduction", yawing.force_reduction, "(4.1) to (4.7)", "derived"),
)

FLOOR = frozenset(("normal_acceleration", "throw_number", "floor_acceleration", "floor_force"))
AXIS = ("pitch", "axis_normal", "axis_rolling", "axis_axial")
FORCE_AXIS = frozenset(f"force_{name}" for name in AXIS)
ROLLING = FORCE_AXIS | {
    *(f"floor_{name}" for name in AXIS),
    "axial_friction_acceleration",
    "rolling_friction",
    "axial_friction",
    "spin_acceleration",
    "yaw_acceleration",
    "pressure_offset_axial",
    "cone_margin",
    "regime",
}
CONDITIONS = (
    Condition(
        "flight",
        vibration.has_left_floor,
        FLOOR | ROLLING | {"required_friction", "printed_yaw_rate"},
        "contact",
    ),
    Condition("tipping", yawing.tips_along_axis, ROLLING | {"required_friction"}),
    Condition("singular", yawing.has_no_printed_yaw_rate, frozenset(("printed_yaw_rate",))),
    Condition("singular", yawing.has_no_force_axis, FORCE_AXIS),
    Condition("slip", yawing.slips, ROLLING, otherwise="roll"),
)

SCENE = Scene(
    name="cylinder-rolling",
    title="Cylindrical part that rolls and yaws on a level plane",
    source="4",
    validity="A snapshot at the drive's peak for a cylinder in pure rolling at the given spin and "
    "yaw rates. Outside the friction cone (slip), beyond the cylinder's ends (tipping) and after "
    "lift-off the values are those that pure rolling would ask for. The yaw of the axis is counted "
    "from +x towards -y. Friction acts at mid-length; its moment about the vertical is an input.",
    variants={"thesis": THESIS, "derived": DERIVED},
    default_variant="derived",
    conditions={"thesis": CONDITIONS, "derived": CONDITIONS},
    defaults={
        "alpha": 0.0,
        "axis_yaw": 0.0,
        "spin_rate": 0.0,
        "yaw_rate": 0.0,
        "drilling_moment": 0.0,
        "gravity": STANDARD_GRAVITY,
    },
    rounding_bound=8,
)
