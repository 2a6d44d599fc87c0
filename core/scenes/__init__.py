"""The systems of the source, one file each."""

from core.scenes import (
    cylinder_isolated,
    cylinder_on_plane,
    cylinder_rolling,
    rectangle_isolated,
    rectangle_on_plane,
    rectangle_on_track,
)
from core.scenes.scene import ALIASES, Condition, Constraint, Equation, Scene

SCENES: dict[str, Scene] = {
    "rectangle-on-plane": rectangle_on_plane.SCENE,
    "rectangle-on-track": rectangle_on_track.SCENE,
    "cylinder-on-plane": cylinder_on_plane.SCENE,
    "cylinder-rolling": cylinder_rolling.SCENE,
    "rectangle-isolated": rectangle_isolated.SCENE,
    "cylinder-isolated": cylinder_isolated.SCENE,
}

__all__ = ["ALIASES", "SCENES", "Condition", "Constraint", "Equation", "Scene"]
