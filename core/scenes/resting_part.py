"""A part that is let down in any orientation: how it lies; and when it topples, standing."""

from __future__ import annotations

from core.mechanics import resting, toppling
from core.scenes.scene import STANDARD_GRAVITY, Condition, Equation, Field, Scene
from core.scenes.shapes import ASPECTS, SHAPES, SOURCE, WORDS, lying

STANDING = "theory 16.2"
_ROUND = (Equation("standing_base", toppling.round_base, STANDING),)
_ON_END = (Equation("standing_centre", toppling.end_centre, STANDING),)
_UPRIGHT = (*_ROUND, Equation("standing_centre", toppling.upright_centre, STANDING))
POSES: dict[str, tuple[Equation, ...]] = {
    "box": (
        Equation("standing_base", toppling.box_base, STANDING),
        Equation("standing_centre", toppling.box_centre, STANDING),
        Equation("gyration", toppling.box_gyration, STANDING),
        Equation("long_side_share", resting.long_side_share, SOURCE),
    ),
    "cylinder": (
        *_ROUND, *_ON_END, Equation("gyration", toppling.cylinder_gyration, STANDING),
    ),
    "prism": (
        Equation("standing_base", toppling.prism_base, STANDING),
        *_ON_END,
        Equation("gyration", toppling.prism_gyration, STANDING),
    ),
    "truncated_cone": (*_UPRIGHT, Equation("gyration", toppling.cone_gyration, STANDING)),
    "turned": (*_UPRIGHT, Equation("gyration", toppling.turned_gyration, STANDING)),
}  # fmt: skip
"""How each shape stands: a box on its face of length by width, the others on an end."""

TOPPLING = (
    Equation("edge_distance", toppling.edge_distance, STANDING),
    Equation("topple_slope", toppling.topple_slope, STANDING),
    Equation("rocking_friction", toppling.rocking_friction, STANDING),
    Equation("rocking_rate", toppling.rocking_rate, STANDING),
    Equation("topple_speed", toppling.topple_speed, STANDING),
    Equation("pulse_angle", toppling.pulse_angle, STANDING),
    Equation("topple_acceleration", toppling.topple_acceleration, STANDING),
    Equation("topple_margin", toppling.topple_margin, STANDING),
    Equation("push_over_load", toppling.push_over_load, STANDING),
    Equation("rocking_margin", toppling.rocking_margin, STANDING),
)
ESTIMATES = (
    Equation("second_shares", resting.second_shares, SOURCE),
    Equation("share_errors", resting.share_errors, SOURCE),
)
SHARES = {
    "resting_share": ("resting_shares", "the share that rests"),
    "second_share": ("second_shares", "the second estimate of the share that rests"),
    "share_error": ("share_errors", "how far apart both estimates are"),
}
"""Outputs of each aspect: the bundle that they stand in, and what they are."""

STANDS = (
    Condition("stands", toppling.never_rocks, frozenset(("rocking_margin",)), "may_topple"),
    Condition("may_topple", toppling.may_topple, frozenset(("topple_margin",)), "stands"),
)


def equations(shape: str) -> tuple[Equation, ...]:
    """Return all equations of a shape."""
    rows = [
        Equation(
            f"{kind}_{name}", Field(bundle, (place,), f"Return {says} {WORDS[name]} [1]."), SOURCE
        )
        for place, name in enumerate(ASPECTS[shape])
        for kind, (bundle, says) in SHARES.items()
    ]
    return (*SHAPES[shape], *ESTIMATES, *rows, *POSES[shape], *TOPPLING)


def conditions(shape: str) -> tuple[Condition, ...]:
    """Return the conditions of a shape."""
    shares = frozenset(f"{kind}_{name}" for kind in SHARES for name in ASPECTS[shape])
    return (*lying(shape, shares), *STANDS)


SCENE = Scene(
    name="resting-part",
    title="How a part comes to rest, and when it topples",
    source="",
    validity="Convex parts let down in any orientation, each as likely, with negligible momentum, "
    "on a hard level floor: high drops favour flat sides more, so that the "
    "flattest has at least its share. Ends of turned parts are those of the hull. A standing "
    "part is rigid, does not slide, and its foot does not bounce.",
    variants={shape: equations(shape) for shape in SHAPES},
    default_variant="box",
    conditions={shape: conditions(shape) for shape in SHAPES},
    defaults={"gamma": 0.0, "gravity": STANDARD_GRAVITY},
    constraints=(),
)
