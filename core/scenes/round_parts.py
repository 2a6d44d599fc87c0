"""Round parts that roll: rollers, balls, cones, cylinders that turn, discs on their edge."""

from dataclasses import replace

import numpy as np

from vibrafeed.core.mechanics import floor, resting, round_parts, screws, wall
from vibrafeed.core.scenes.on_floor import (
    ACCELERATIONS,
    DRIVE,
    FLOOR,
    LEVEL_GRAVITY,
    PLANE,
    PLANE_DEFAULTS,
    UNILATERAL,
    unchecked_load,
)
from vibrafeed.core.scenes.scene import (
    STANDARD_GRAVITY,
    Condition,
    Equation,
    Scene,
    fields,
    under_names,
)

# --- A roller, tube, ring or hoop that lies on a plane, its axis in any direction, from rest.

SOURCE = "theory 18.1"
ROLLER_AXIS = (
    Equation("push_across_axis", round_parts.push_across_axis, SOURCE),
    Equation("push_along_axis", round_parts.push_along_axis, SOURCE),
)
ROLLER_MOTION = (ACCELERATIONS - {"sliding_fraction"}) | {
    "axial_acceleration", "rolling_acceleration", "angular_acceleration", "required_friction",
    "roll_root",
}  # fmt: skip

ROLLER_SCENE = Scene(
    name="roller-on-plane",
    title="Roller, tube, ring or hoop lying on a plane, its axis across the track",
    source="",
    validity="The results are a snapshot at the peak of the drive, for a part that is at rest "
    "relative to the track. Its axis lies across the track unless axis_yaw turns it; at 0 the "
    "axis lies along the track, as in cylinder-on-plane. Rolling resistance and drilling "
    "friction are neglected. Closed forms describe the part only while the throw number is below "
    "1.",
    variants={
        "physical": (
            *PLANE,
            *UNILATERAL,
            *ROLLER_AXIS,
            Equation("rolling_factor", round_parts.tube_factor, SOURCE),
            Equation("rolling_share", round_parts.rolling_share, SOURCE),
            Equation("required_friction", round_parts.roller_friction, SOURCE),
            Equation("roll_root", round_parts.roller_root, SOURCE),
            Equation("axial_acceleration", round_parts.axial_acceleration, SOURCE),
            Equation("rolling_acceleration", round_parts.rolling_acceleration, SOURCE),
            Equation("acceleration_x", round_parts.roller_x, SOURCE),
            Equation("acceleration_y", round_parts.roller_y, SOURCE),
            Equation("angular_acceleration", round_parts.roller_spin, SOURCE),
        )
    },
    default_variant="physical",
    conditions={
        "physical": (
            Condition("flight", floor.has_left_floor, FLOOR | ROLLER_MOTION, otherwise="contact"),
            Condition("roll", round_parts.rolls, ROLLER_MOTION, otherwise="slip"),
        )
    },
    defaults={
        **PLANE_DEFAULTS,
        "yaw": 0.0,
        "axis_yaw": np.pi / 2,
        "inner_diameter": 0.0,
        "rolling_factor": 2.0,
    },
)


# --- A ball or a shell on a horizontal or inclined plane, from rest.

SPHERE_MOTION = (ACCELERATIONS - {"sliding_fraction"}) | {
    "moved_fraction", "angular_acceleration", "required_friction",
}  # fmt: skip

SPHERE_SCENE = Scene(
    name="sphere-on-plane",
    title="Ball or hollow ball on a horizontal or inclined plane",
    source="",
    validity="The results are a snapshot at the peak of the drive, for a ball that is at rest "
    "relative to the track, on a floor without a wall. Rolling resistance is neglected; a "
    "simulation includes it. Closed forms describe the ball only while the throw number is below "
    "1.",
    variants={
        "physical": (
            *PLANE,
            *UNILATERAL,
            Equation("rolling_factor", round_parts.ball_factor, SOURCE),
            Equation("rolling_share", round_parts.rolling_share, SOURCE),
            under_names(
                "required_friction",
                round_parts.least_friction,
                SOURCE,
                "the least static friction with which a ball rolls, |D|/((1 + kap) n) [1]",
                push="in_plane_drive",
            ),
            Equation("moved_fraction", round_parts.ball_fraction, SOURCE),
            *(
                under_names(
                    f"acceleration_{axis}",
                    floor.disc_acceleration_x,
                    SOURCE,
                    f"the acceleration of the centre along {axis} [m s-2]",
                    in_plane_drive_x=f"in_plane_drive_{axis}",
                    sliding_fraction="moved_fraction",
                )
                for axis in "xy"
            ),
            Equation("angular_acceleration", round_parts.ball_spin, SOURCE),
        )
    },
    default_variant="physical",
    conditions={
        "physical": (
            Condition("flight", floor.has_left_floor, FLOOR | SPHERE_MOTION, otherwise="contact"),
            Condition("roll", round_parts.rolls, SPHERE_MOTION, otherwise="slip"),
        )
    },
    defaults={**PLANE_DEFAULTS, "yaw": 0.0, "inner_diameter": 0.0, "rolling_factor": 2.5},
)


# --- A truncated cone on its side, which rolls about the vertical through its apex, from rest.

CONE_MOTION = frozenset(
    ("rolling_acceleration", "turning_acceleration", "required_friction", "regime")
)  # fmt: skip

CONE_SCENE = Scene(
    name="cone-on-plane",
    title="Truncated cone on its side, rolling about its apex",
    source="",
    validity="The results are a snapshot at the peak of the drive, for a cone that is at rest "
    "relative to the track and rolls about the vertical through its apex. Its line of contact "
    "lies across the track unless axis_yaw turns it. If the cone slips, the values are those "
    "that pure rolling would require. The required friction follows from the resultant force of "
    "the floor. Rolling resistance is neglected.",
    variants={
        "physical": (
            *(each for each in PLANE if not each.gives.startswith("rotated")),
            *UNILATERAL,
            *ROLLER_AXIS,
            Equation("mass_height", resting.cone_centre, "theory 16.1"),
            Equation("side_foot", resting.side_foot, "theory 16.1"),
            Equation("gyration", resting.cone_gyration, "theory 16.2"),
            Equation("axial_gyration", round_parts.axial_gyration, SOURCE),
            Equation("cone_half_angle", round_parts.cone_half_angle, SOURCE),
            Equation("centre_radius", round_parts.centre_radius, SOURCE),
            Equation("cone_factor", round_parts.cone_factor, SOURCE),
            Equation("rolling_acceleration", round_parts.cone_acceleration, SOURCE),
            Equation("turning_acceleration", round_parts.cone_turning, SOURCE),
            Equation("required_friction", round_parts.cone_friction, SOURCE),
        )
    },
    default_variant="physical",
    conditions={
        "physical": (
            Condition("flight", floor.has_left_floor, FLOOR | CONE_MOTION, otherwise="contact"),
            Condition(
                "unstable_side",
                resting.is_side_unstable,
                frozenset(("cone_factor",)) | CONE_MOTION,
                otherwise="contact",
            ),
            Condition("roll", round_parts.rolls, CONE_MOTION, otherwise="slip"),
        )
    },
    defaults={**PLANE_DEFAULTS, "axis_yaw": np.pi / 2},
)


# --- A cylinder that rolls and yaws on a level plane, by screw theory; chapter 4 of the source.

REDUCTIONS = tuple(
    under_names(
        f"{force}_reduction", screws.reduction, "(4.1) to (4.7)",
        f"pitch F.M/F^2 and axis F x M/F^2 of {whose} wrench, force F and moment M",
        wrench=f"{force}_wrench",
    )
    for force, whose in (("floor", "the floor's"), ("force", "all forces'"))
)  # fmt: skip
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
    Equation("vibration_acceleration", floor.vibration_acceleration, "theory 0.2"),
    Equation("drive_normal", floor.drive_normal, "(4.13)"),
    Equation("rolling_drive", screws.rolling_drive, "(4.13), theory 9.2"),
    Equation("axial_drive", screws.axial_drive, "(4.13), theory 9.2"),
    LEVEL_GRAVITY,
    Equation("normal_acceleration", floor.normal_acceleration, "(4.17)"),
    Equation("throw_number", floor.throw_number, "theory 13.2"),
    *unchecked_load("(4.17)"),
    Equation("floor_force", floor.floor_force, "(4.17)"),
    Equation("axial_friction_acceleration", screws.axial_friction_acceleration, "(4.16)"),
    Equation("rolling_friction", screws.rolling_friction, "(4.15)"),
    Equation("axial_friction", screws.axial_friction, "(4.16)"),
    Equation("spin_acceleration", screws.spin_acceleration, "(4.19)"),
    Equation("yaw_acceleration", screws.yaw_acceleration, "(4.18), theory 9.3"),
    Equation("printed_yaw_rate", screws.printed_yaw_rate, "(4.20), theory 9.4"),
    Equation("pressure_offset_axial", screws.pressure_offset_axial, "theory 9.3"),
    Equation("required_friction", screws.required_friction, "theory 9.3"),
    Equation("cone_margin", screws.cone_margin, "theory 9.3"),
    Equation("floor_wrench", screws.floor_wrench, "theory 9.3"),
    Equation("force_wrench", screws.force_wrench, "(4.12), (4.13), theory 9.3"),
    *AXES,
)

LOADS = frozenset(("normal_acceleration", "throw_number", "floor_acceleration", "floor_force"))
ROLLING_AXIS = ("pitch", "axis_normal", "axis_rolling", "axis_axial")
FORCE_AXIS = frozenset(f"force_{name}" for name in ROLLING_AXIS)
ROLLING = FORCE_AXIS | {
    *(f"floor_{name}" for name in ROLLING_AXIS),
    "axial_friction_acceleration",
    "rolling_friction",
    "axial_friction",
    "spin_acceleration",
    "yaw_acceleration",
    "pressure_offset_axial",
    "cone_margin",
    "regime",
}
ROLLING_CONDITIONS = (
    Condition(
        "flight",
        floor.has_left_floor,
        LOADS | ROLLING | {"required_friction", "printed_yaw_rate"},
        "contact",
    ),
    Condition(
        "tipping",
        lambda *, pressure_offset_axial, length: np.abs(pressure_offset_axial) > length / 2,
        ROLLING | {"required_friction"},
        says="True where the floor's normal force would leave the cylinder: |e| > L/2, it tips.",
    ),
    Condition(
        "singular",
        lambda *, printed_yaw_rate: ~np.isfinite(printed_yaw_rate),
        frozenset(("printed_yaw_rate",)),
        says="True where (4.20) has no value: without spin, or too little for a float.",
    ),
    Condition("singular", screws.has_no_force_axis, FORCE_AXIS),
    Condition("slip", screws.slips, ROLLING, otherwise="roll"),
)

ROLLING_SCENE = Scene(
    name="cylinder-rolling",
    title="Cylindrical part that rolls and yaws on a level plane",
    source="4",
    validity="The results are a snapshot at the peak of the drive, for a cylinder in pure "
    "rolling at the given spin and yaw rates. If the cylinder slips (outside the friction cone), "
    "tips (beyond its ends) or lifts off, the values are those that pure rolling would require. "
    "The yaw of the axis is measured from +x towards -y. Friction acts at mid-length; its moment "
    "about the vertical is an input.",
    variants={
        "thesis": (
            *COMMON,
            *(
                under_names(
                    f"{force}_reduction",
                    screws.printed_reduction,
                    "(4.1) to (4.7)",
                    f"pitch and axis of {whose} with the sign of (4.3), (4.5), (4.6)",
                    "thesis",
                    wrench=f"{force}_wrench",
                )
                for force, whose in (
                    ("floor", "the floor's wrench"),
                    ("force", "the force system"),
                )
            ),
        ),
        "derived": (
            *COMMON,
            *(replace(one, variant="derived") for one in REDUCTIONS),
        ),
    },
    default_variant="derived",
    conditions={"thesis": ROLLING_CONDITIONS, "derived": ROLLING_CONDITIONS},
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


# --- A disc, coin or ring that stands on its edge in the track, its face against the wall.

WALL = frozenset(("wall_acceleration", "wall_force", "wall_drag", "net_push"))
DISC_MOTION = frozenset(
    (
        "acceleration_x", "angular_acceleration", "required_friction", "rolling_friction",
        *(one.gives for one in AXES), "regime",
    )
)  # fmt: skip

DISC_SCENE = Scene(
    name="disc-on-edge",
    title="Disc, coin or ring on its edge, its face against the wall",
    source="",
    validity="The results are a snapshot at the peak of the drive, for a disc that is at rest "
    "relative to the track. The force of the wall passes through the centre of the disc: moments "
    "that would turn its face along the wall are neglected, as is rolling resistance. A coin "
    "that lies flat is a block; use rectangle-on-plane.",
    variants={
        "physical": (
            *DRIVE,
            *UNILATERAL,
            Equation("gravity_normal", floor.leaning_gravity_normal, "theory 0.4"),
            Equation("gravity_across", floor.gravity_across, "theory 0.4"),
            Equation("floor_force", floor.floor_force, SOURCE),
            Equation("centripetal_acceleration", wall.centripetal_acceleration, "theory 4.1"),
            Equation("wall_balance", wall.derived_wall_balance, "theory 4.1"),
            Equation("wall_acceleration", wall.pushing_wall_acceleration, "theory 4.1"),
            Equation("wall_force", wall.wall_force, "theory 4.1"),
            *fields(
                "friction_kinetic",
                SOURCE,
                wall_friction=(
                    "the floor's kinetic friction, for a wall of the same material [1]",
                ),
            ),
            Equation("net_push", round_parts.net_push, SOURCE),
            Equation("rolling_factor", round_parts.tube_factor, SOURCE),
            Equation("rolling_share", round_parts.rolling_share, SOURCE),
            under_names(
                "required_friction",
                round_parts.least_friction,
                SOURCE,
                "the least static friction with which the disc rolls, |D - w|/((1 + kap) n) [1]",
                push="net_push",
            ),
            Equation("acceleration_x", round_parts.disc_acceleration, SOURCE),
            Equation("angular_acceleration", round_parts.disc_spin, SOURCE),
            Equation("rolling_friction", round_parts.disc_floor_friction, SOURCE),
            Equation("wall_drag", round_parts.wall_drag, SOURCE),
            Equation("floor_wrench", round_parts.disc_floor_wrench, SOURCE),
            Equation("force_wrench", round_parts.disc_force_wrench, SOURCE),
            *REDUCTIONS,
            *AXES,
        )
    },
    default_variant="physical",
    conditions={
        "physical": (
            Condition("flight", floor.has_left_floor, LOADS | DISC_MOTION, otherwise="contact"),
            Condition(
                "wall_lost",
                lambda *, wall_balance: wall_balance < 0,
                WALL | DISC_MOTION,
                otherwise="contact",
                says="True where nothing presses the disc onto the wall: its load is below 0.",
            ),
            Condition("singular", screws.has_no_force_axis, FORCE_AXIS),
            Condition("stick", round_parts.is_held, DISC_MOTION),
            Condition("roll", round_parts.rolls, DISC_MOTION, otherwise="slip"),
        )
    },
    defaults={
        "alpha": 0.0,
        "gamma": 0.0,
        "delta": 0.0,
        "gravity": STANDARD_GRAVITY,
        "centripetal_acceleration": 0.0,
        "inner_diameter": 0.0,
        "rolling_factor": 2.0,
    },
)
