"""The shapes of parts that come to rest: their shares and the heights of their centre.

A shape lists its aspects, the ways in which it may lie, in the order of their numbers.
"""

from __future__ import annotations

from core.mechanics import resting
from core.scenes.scene import Condition, Equation

ASPECTS: dict[str, tuple[str, ...]] = {
    "box": ("flat", "on_side", "on_end"),
    "cylinder": ("on_side", "on_end"),
    "prism": ("on_side", "on_end"),
    "truncated_cone": ("upright", "on_side", "inverted"),
    "turned": ("upright", "on_side", "inverted"),
}
"""The aspects of each shape."""

SOURCE = "theory 16.1"
_TURNED = (
    Equation("side_foot", resting.side_foot, SOURCE),
    Equation("resting_shares", resting.turned_shares, SOURCE),
    Equation("centre_heights", resting.turned_centres, SOURCE),
)
SHAPES: dict[str, tuple[Equation, ...]] = {
    "box": (
        Equation("resting_shares", resting.box_shares, SOURCE),
        Equation("centre_heights", resting.box_centres, SOURCE),
    ),
    "cylinder": (
        Equation("resting_shares", resting.cylinder_shares, SOURCE),
        Equation("centre_heights", resting.cylinder_centres, SOURCE),
    ),
    "prism": (
        Equation("resting_shares", resting.prism_shares, SOURCE),
        Equation("centre_heights", resting.prism_centres, SOURCE),
    ),
    "truncated_cone": (Equation("mass_height", resting.cone_centre, SOURCE), *_TURNED),
    "turned": (Equation("mass_height", resting.turned_centre, SOURCE), *_TURNED),
}
"""What the shares of each shape follow from."""

WORDS = {
    "flat": "flat",
    "on_side": "on its side",
    "on_end": "on an end",
    "upright": "on the end of `diameter`",
    "inverted": "on the opposite end",
}


def lying(shape: str, outputs: frozenset[str]) -> tuple[Condition, ...]:
    """Return the conditions under which parts of a shape cannot lie as assumed, for some outputs.

    Only turned parts, such as screws, have any: a centre of mass outside of the part, and a side on
    which they do not rest. `outputs` are the quantities whose meaning that touches.
    """
    if ASPECTS[shape][0] != "upright":
        return ()
    return (
        Condition("invalid_geometry", resting.has_centre_outside, outputs),
        Condition("unstable_side", resting.is_side_unstable, outputs, otherwise="contact"),
    )
