"""The shapes of parts that come to rest: their shares, and heights and depths of their centre.

A shape lists its aspects, the ways in which it may lie, in the order of their numbers.
"""

from __future__ import annotations

from vibrafeed.core.mechanics import resting
from vibrafeed.core.scenes.scene import Condition, Equation, field_of

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
    Equation("let_down_shares", resting.turned_shares, SOURCE),
    Equation("centre_heights", resting.turned_centres, SOURCE),
    Equation("depths", resting.turned_depths, SOURCE),
)
SHAPES: dict[str, tuple[Equation, ...]] = {
    "box": (
        Equation("let_down_shares", resting.box_shares, SOURCE),
        Equation("centre_heights", resting.box_centres, SOURCE),
        Equation("depths", resting.box_depths, SOURCE),
    ),
    "cylinder": (
        Equation("let_down_shares", resting.cylinder_shares, SOURCE),
        Equation("centre_heights", resting.cylinder_centres, SOURCE),
        Equation("depths", resting.cylinder_depths, SOURCE),
    ),
    "prism": (
        Equation("let_down_shares", resting.prism_shares, SOURCE),
        Equation("centre_heights", resting.prism_centres, SOURCE),
        Equation("depths", resting.prism_depths, SOURCE),
    ),
    "truncated_cone": (Equation("mass_height", resting.cone_centre, SOURCE), *_TURNED),
    "turned": (Equation("mass_height", resting.turned_centre, SOURCE), *_TURNED),
}
"""What the shares of each shape follow from."""

THROWN = Equation("thrown_shares", resting.thrown_shares, SOURCE)
SHARES = {
    "let_down_share": ("let_down_shares", "the share of let-down parts that rest"),
    "thrown_share": ("thrown_shares", "the share of thrown parts that rest"),
}
"""Outputs of each aspect: the bundle that they stand in, and what they are."""

WORDS = {
    "flat": "flat",
    "on_side": "on its side",
    "on_end": "on an end",
    "upright": "on the end of `diameter`",
    "inverted": "on the opposite end",
}


def shares_of(shape: str) -> tuple[Equation, ...]:
    """Return the equations of both shares of each aspect: let down, and thrown.

    An aspect is a way in which a part lies; `shape` is a key of `ASPECTS`.
    """
    return (
        *SHAPES[shape],
        THROWN,
        *(
            field_of(bundle, (place,), f"{kind}_{name}", f"{says} {WORDS[name]} [1]", SOURCE)
            for place, name in enumerate(ASPECTS[shape])
            for kind, (bundle, says) in SHARES.items()
        ),
    )


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
