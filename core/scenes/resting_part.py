"""A part that is let down or thrown: how it comes to rest; and when it topples, standing."""

from vibrafeed.core.mechanics import resting
from vibrafeed.core.scenes.scene import (
    STANDARD_GRAVITY,
    Condition,
    Equation,
    Scene,
    field_of,
    under_names,
)

# --- The shapes of parts that come to rest: their shares, and heights and depths of their centre.
#
# A shape lists its aspects, the ways in which it may lie, in the order of their numbers.

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
    "turned": (
        field_of(
            "centre_of_mass",
            (),
            "mass_height",
            "the height of a turned part's centre above the end of `diameter`, as measured [m]",
            SOURCE,
        ),
        *_TURNED,
    ),
}
"""What the shares of each shape follow from."""

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
        Equation("thrown_shares", resting.thrown_shares, SOURCE),
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
        Condition(
            "invalid_geometry",
            lambda *, height, mass_height: mass_height >= height,
            outputs,
            says="True where the centre of mass is not between both ends.",
        ),
        Condition("unstable_side", resting.is_side_unstable, outputs, otherwise="contact"),
    )


SECTION = "theory 16.2"
_ROUND = (
    under_names(
        "standing_base", resting.half, SECTION, "the radius of a round end [m]", size="diameter"
    ),
)
_ON_END = (
    under_names(
        "standing_centre",
        resting.half,
        SECTION,
        "half the length of a part that stands on its end [m]",
        size="length",
    ),
)
_UPRIGHT = (
    *_ROUND,
    field_of(
        "mass_height",
        (),
        "standing_centre",
        "the height of the centre of a part that stands on the end of `diameter` [m]",
        SECTION,
    ),
)
POSES: dict[str, tuple[Equation, ...]] = {
    "box": (
        under_names("standing_base", resting.half, SECTION,
                    "half the length of a box, which is pushed along it [m]", size="length"),
        under_names("standing_centre", resting.half, SECTION, "half the height of a box [m]",
                    size="height"),
        Equation("gyration", resting.box_gyration, SECTION),
        Equation("long_side_share", resting.long_side_share, SOURCE),
    ),
    "cylinder": (
        *_ROUND, *_ON_END, Equation("gyration", resting.cylinder_gyration, SECTION),
    ),
    "prism": (
        Equation("standing_base", resting.prism_base, SECTION),
        *_ON_END,
        Equation("gyration", resting.prism_gyration, SECTION),
    ),
    "truncated_cone": (*_UPRIGHT, Equation("gyration", resting.cone_gyration, SECTION)),
    "turned": (*_UPRIGHT, field_of("radius_of_gyration", (), "gyration",
                                    "the radius of gyration of a turned part, as measured [m]",
                                    SECTION)),
}  # fmt: skip
"""How each shape stands: a box on its face of length by width, the others on an end."""


def equations(shape: str) -> tuple[Equation, ...]:
    """Return the equations of a scene in which a part of a shape comes to rest, and stands.

    They give the shares that rest in each aspect (way of lying), and what topples the part.
    `shape` is a key of `ASPECTS`.
    """
    return (
        *shares_of(shape),
        *POSES[shape],
        Equation("edge_distance", resting.edge_distance, SECTION),
        Equation("topple_slope", resting.topple_slope, SECTION),
        Equation("rocking_friction", resting.rocking_friction, SECTION),
        Equation("rocking_rate", resting.rocking_rate, SECTION),
        Equation("topple_speed", resting.topple_speed, SECTION),
        Equation("pulse_angle", resting.pulse_angle, SECTION),
        Equation("topple_acceleration", resting.topple_acceleration, SECTION),
        Equation("topple_margin", resting.topple_margin, SECTION),
        Equation("push_over_load", resting.push_over_load, SECTION),
        Equation("rocking_margin", resting.rocking_margin, SECTION),
    )


def conditions(shape: str) -> tuple[Condition, ...]:
    """Return the conditions of a shape at rest."""
    shares = frozenset(f"{kind}_{name}" for kind in SHARES for name in ASPECTS[shape])
    return (
        *lying(shape, shares),
        Condition(
            "stands",
            lambda *, rocking_margin: rocking_margin <= 0,
            frozenset(("rocking_margin",)),
            "may_topple",
            says="True where a part does not even begin to rock.",
        ),
        Condition("may_topple", resting.may_topple, frozenset(("topple_margin",)), "stands"),
    )


SCENE = Scene(
    name="resting-part",
    title="How a part comes to rest, and when it topples",
    source="",
    validity="Convex parts on a hard level floor, in any orientation, each as likely. Shares are a "
    "bracket: parts that are let down with negligible momentum, and parts that are thrown; drop "
    "height and rebound decide where between both a part is, so that their distance is the error "
    "of either. Ends of turned parts are those of the hull. A standing "
    "part is rigid, does not slide, and its foot does not bounce.",
    variants={shape: equations(shape) for shape in SHAPES},
    default_variant="box",
    conditions={shape: conditions(shape) for shape in SHAPES},
    defaults={"gamma": 0.0, "gravity": STANDARD_GRAVITY},
    constraints=(),
)
