"""A disc, coin or ring that stands on its edge in the track, its face against the wall."""

from __future__ import annotations

from vibrafeed.core.mechanics import edge_disc, round_parts, vibration, wall, yawing
from vibrafeed.core.scenes.cylinder_rolling import AXES, FORCE_AXIS
from vibrafeed.core.scenes.planar import DRIVE, FLOOR, UNILATERAL
from vibrafeed.core.scenes.scene import STANDARD_GRAVITY, Condition, Equation, Scene

SOURCE = "theory 18.1"
PHYSICAL = (
    *DRIVE,
    *UNILATERAL,
    Equation("gravity_normal", vibration.leaning_gravity_normal, "theory 0.4"),
    Equation("gravity_across", vibration.gravity_across, "theory 0.4"),
    Equation("floor_force", vibration.floor_force, SOURCE),
    Equation("centripetal_acceleration", wall.centripetal_acceleration, "theory 4.1"),
    Equation("wall_balance", wall.derived_wall_balance, "theory 4.1"),
    Equation("wall_acceleration", wall.pushing_wall_acceleration, "theory 4.1"),
    Equation("wall_force", wall.wall_force, "theory 4.1"),
    Equation("wall_friction", edge_disc.wall_as_floor, SOURCE),
    Equation("net_push", edge_disc.net_push, SOURCE),
    Equation("rolling_factor", round_parts.tube_factor, SOURCE),
    Equation("rolling_share", round_parts.rolling_share, SOURCE),
    Equation("required_friction", edge_disc.disc_friction, SOURCE),
    Equation("acceleration_x", edge_disc.disc_acceleration, SOURCE),
    Equation("angular_acceleration", edge_disc.disc_spin, SOURCE),
    Equation("rolling_friction", edge_disc.disc_floor_friction, SOURCE),
    Equation("wall_drag", edge_disc.wall_drag, SOURCE),
    Equation("floor_wrench", edge_disc.disc_floor_wrench, SOURCE),
    Equation("force_wrench", edge_disc.disc_force_wrench, SOURCE),
    Equation("floor_reduction", yawing.floor_reduction, "(4.1) to (4.7)"),
    Equation("force_reduction", yawing.force_reduction, "(4.1) to (4.7)"),
    *AXES,
)
WALL = frozenset(("wall_acceleration", "wall_force", "wall_drag", "net_push"))
MOTION = frozenset(
    (
        "acceleration_x", "angular_acceleration", "required_friction", "rolling_friction",
        *(one.gives for one in AXES), "regime",
    )
)  # fmt: skip
CONDITIONS = (
    Condition("flight", vibration.has_left_floor, FLOOR | MOTION, otherwise="contact"),
    Condition("wall_lost", edge_disc.leaves_wall, WALL | MOTION, otherwise="contact"),
    Condition("singular", yawing.has_no_force_axis, FORCE_AXIS),
    Condition("stick", edge_disc.is_held, MOTION),
    Condition("roll", round_parts.rolls, MOTION, otherwise="slip"),
)

SCENE = Scene(
    name="disc-on-edge",
    title="Disc, coin or ring on its edge, its face against the wall",
    source="",
    validity="A snapshot at the drive's peak for a disc at rest relative to the track. The wall's "
    "force passes through the centre: what would turn the face along the wall is left out, and so "
    "is rolling resistance. A coin that lies flat is a block: rectangle-on-plane.",
    variants={"physical": PHYSICAL},
    default_variant="physical",
    conditions={"physical": CONDITIONS},
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
