"""The systems that can be computed, a family a file."""

from vibrafeed.core.scenes import (
    drive_units,
    isolated,
    on_floor,
    orienting_line,
    pair_impact,
    resting_part,
    round_parts,
    row_on_plane,
    soft_contact,
)
from vibrafeed.core.scenes.aliases import ALIASES
from vibrafeed.core.scenes.scene import EXACT, Condition, Constraint, Equation, Scene

SCENES: dict[str, Scene] = {
    "rectangle-isolated": isolated.RECTANGLE_SCENE,
    "rectangle-on-plane": on_floor.RECTANGLE_SCENE,
    "rectangle-on-track": on_floor.TRACK_SCENE,
    "rectangle-pair-impact": pair_impact.RECTANGLE_SCENE,
    "cylinder-isolated": isolated.CYLINDER_SCENE,
    "cylinder-on-plane": on_floor.CYLINDER_SCENE,
    "cylinder-pair-impact": pair_impact.CYLINDER_SCENE,
    "cylinder-rolling": round_parts.ROLLING_SCENE,
    "sphere-on-plane": round_parts.SPHERE_SCENE,
    "roller-on-plane": round_parts.ROLLER_SCENE,
    "disc-on-edge": round_parts.DISC_SCENE,
    "cone-on-plane": round_parts.CONE_SCENE,
    "soft-contact": soft_contact.SCENE,
    "linear-drive-unit": drive_units.LINEAR_SCENE,
    "bowl-drive-unit": drive_units.BOWL_SCENE,
    "resting-part": resting_part.SCENE,
    "orienting-line": orienting_line.SCENE,
    "row-on-plane": row_on_plane.SCENE,
}

__all__ = ["ALIASES", "EXACT", "SCENES", "Condition", "Constraint", "Equation", "Scene"]
