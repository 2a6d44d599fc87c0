"""The systems that can be computed, one file each."""

from vibrafeed.core.scenes import (
    bowl_drive_unit,
    cone_on_plane,
    cylinder_isolated,
    cylinder_on_plane,
    cylinder_pair_impact,
    cylinder_rolling,
    disc_on_edge,
    linear_drive_unit,
    orienting_line,
    rectangle_isolated,
    rectangle_on_plane,
    rectangle_on_track,
    rectangle_pair_impact,
    resting_part,
    roller_on_plane,
    row_on_plane,
    soft_contact,
    sphere_on_plane,
)
from vibrafeed.core.scenes.aliases import ALIASES
from vibrafeed.core.scenes.scene import EXACT, Condition, Constraint, Equation, Scene

SCENES: dict[str, Scene] = {
    "rectangle-isolated": rectangle_isolated.SCENE,
    "rectangle-on-plane": rectangle_on_plane.SCENE,
    "rectangle-on-track": rectangle_on_track.SCENE,
    "rectangle-pair-impact": rectangle_pair_impact.SCENE,
    "cylinder-isolated": cylinder_isolated.SCENE,
    "cylinder-on-plane": cylinder_on_plane.SCENE,
    "cylinder-pair-impact": cylinder_pair_impact.SCENE,
    "cylinder-rolling": cylinder_rolling.SCENE,
    "sphere-on-plane": sphere_on_plane.SCENE,
    "roller-on-plane": roller_on_plane.SCENE,
    "disc-on-edge": disc_on_edge.SCENE,
    "cone-on-plane": cone_on_plane.SCENE,
    "soft-contact": soft_contact.SCENE,
    "linear-drive-unit": linear_drive_unit.SCENE,
    "bowl-drive-unit": bowl_drive_unit.SCENE,
    "resting-part": resting_part.SCENE,
    "orienting-line": orienting_line.SCENE,
    "row-on-plane": row_on_plane.SCENE,
}

__all__ = ["ALIASES", "EXACT", "SCENES", "Condition", "Constraint", "Equation", "Scene"]
