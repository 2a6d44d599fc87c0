"""A ball that rolls on an inclined plane, from rest."""

from __future__ import annotations

from vibrafeed.core.mechanics import floor
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.scenes.on_floor import DRIVE, PLANE_DEFAULTS
from vibrafeed.core.scenes.scene import Condition, Equation, Scene


def rolling_acceleration_x(*, in_plane_drive_x: Array) -> Array:
    """Return a_x = 5/7 D_x of a solid ball that rolls without slip [m s-2]."""
    return in_plane_drive_x * (5 / 7)


EQUATIONS = (
    *DRIVE,
    Equation("gravity_normal", floor.gravity_normal, "(3.11)"),
    Equation("acceleration_x", rolling_acceleration_x, "textbook", "physical"),
)
FLIGHT = Condition("flight", floor.has_left_floor, frozenset(("acceleration_x",)), otherwise="roll")

SCENE = Scene(
    name="ball-on-plane",
    title="Ball on an inclined plane",
    source="none",
    validity="Rolls without slip while in contact.",
    variants={"physical": EQUATIONS},
    default_variant="physical",
    conditions={"physical": (FLIGHT,)},
    defaults=PLANE_DEFAULTS,
)
