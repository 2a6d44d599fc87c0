"""The systems of the source, one file each."""

from core.scenes import (
    cylinder_on_plane,
    cylinder_pair_impact,
    rectangle_on_plane,
    rectangle_on_track,
    rectangle_pair_impact,
)
from core.scenes.scene import ALIASES, Condition, Constraint, Equation, Scene

SCENES: dict[str, Scene] = {
    "rectangle-on-plane": rectangle_on_plane.SCENE,
    "rectangle-on-track": rectangle_on_track.SCENE,
    "cylinder-on-plane": cylinder_on_plane.SCENE,
    "rectangle-pair-impact": rectangle_pair_impact.SCENE,
    "cylinder-pair-impact": cylinder_pair_impact.SCENE,
}

__all__ = ["ALIASES", "SCENES", "Condition", "Constraint", "Equation", "Scene"]
