"""A part that is let down or thrown: how it comes to rest; and when it topples, standing."""

from collections.abc import Collection
from dataclasses import replace
from functools import lru_cache, partial

import numpy as np

from vibrafeed.core.mechanics import resting
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.scenes.scene import (
    MESH,
    STANDARD_GRAVITY,
    UNREAD,
    Condition,
    Constraint,
    Equation,
    MeshPart,
    Scene,
    field_of,
    under_names,
)

# --- The shapes of parts that come to rest: their shares, and heights and depths of their centre.
#
# A shape lists its aspects, the ways in which it may lie, in the order of their numbers.

ASPECTS: dict[str, tuple[str, ...]] = {
    "box": ("flat", "on_side", "on_end"),
    "weighted_box": ("flat", "on_side", "on_end", "inverted"),
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
    "weighted_box": (
        Equation("let_down_shares", resting.weighted_box_shares, SOURCE),
        Equation("centre_heights", resting.weighted_box_centres, SOURCE),
        Equation("depths", resting.weighted_box_depths, SOURCE),
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
    "inverted": "on the opposite end, or a box upside down",
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

    A centre of mass may be outside of the part, and a turned part, such as a screw, may have a side
    on which it does not rest. `outputs` are the quantities whose meaning that touches.
    """
    if shape == "weighted_box":
        return (
            Condition(
                "invalid_geometry",
                lambda *, height, centre_of_mass: centre_of_mass >= height,
                outputs,
                otherwise="contact",
                says="True where the centre of mass is not within the box.",
            ),
        )
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
_BOX = (
    under_names("standing_base", resting.half, SECTION,
                "half the length of a box, which is pushed along it [m]", size="length"),
    Equation("long_side_share", resting.long_side_share, SOURCE),
)  # fmt: skip
_GYRATION = field_of(
    "radius_of_gyration", (), "gyration", "the radius of gyration of a part, as measured [m]",
    SECTION,
)  # fmt: skip
POSES: dict[str, tuple[Equation, ...]] = {
    "box": (
        *_BOX,
        under_names("standing_centre", resting.half, SECTION, "half the height of a box [m]",
                    size="height"),
        Equation("gyration", resting.box_gyration, SECTION),
    ),
    "weighted_box": (
        *_BOX,
        field_of("centre_of_mass", (), "standing_centre",
                 "the height of the centre of a box that lies flat [m]", SECTION),
        _GYRATION,
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
    "turned": (*_UPRIGHT, _GYRATION),
}  # fmt: skip
"""How each shape stands: a box on its face of length by width, the others on an end."""


TOPPLING = (
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
"""What topples a standing part."""


def equations(shape: str) -> tuple[Equation, ...]:
    """Return the equations of a scene in which a part of a shape comes to rest, and stands.

    They give the shares that rest in each aspect (way of lying), and what topples the part.
    `shape` is a key of `ASPECTS`.
    """
    return (
        *shares_of(shape),
        *POSES[shape],
        *TOPPLING,
    )


TOPPLE_CONDITIONS = (
    Condition(
        "stands",
        lambda *, rocking_margin: rocking_margin <= 0,
        frozenset(("rocking_margin",)),
        "may_topple",
        says="True where a part does not even begin to rock.",
    ),
    Condition("may_topple", resting.may_topple, frozenset(("topple_margin",)), "stands"),
)
"""Whether shaking may topple a standing part."""


def conditions(shape: str) -> tuple[Condition, ...]:
    """Return the conditions of a shape at rest."""
    shares = frozenset(f"{kind}_{name}" for kind in SHARES for name in ASPECTS[shape])
    return (*lying(shape, shares), *TOPPLE_CONDITIONS)


# --- A part from a file: each cell is one of its aspects, by its number.


LYING = {
    "let_down_share": ("let_down_share", "the share of let-down parts that rest in the aspect [1]"),
    "thrown_share": ("thrown_share", "the share of thrown parts that rest in the aspect [1]"),
    "lying_height": ("height", "the height of the part in the aspect [m]"),
    "lying_length": ("length", "the longer side of the least rectangle about it, from above [m]"),
    "lying_width": ("width", "the shorter side of the least rectangle about it, from above [m]"),
    "standing_base": ("base_along", "half of its base along the longer side [m]"),
    "standing_base_across": ("base_across", "half of its base across the longer side [m]"),
    "standing_centre": ("centre_height", "the height of the centre of mass [m]"),
    "gyration": ("gyration", "the radius of gyration about a line across the longer side [m]"),
}
"""Outputs of an aspect, where they stand in it, and what they are."""
FILE = "theory 16.5"


def _number_of_aspect(numbers: tuple[float, ...], *, aspect: Array) -> Array:
    value: Array = 0 * aspect + numbers[0]
    for place, number in enumerate(numbers[1:], 2):
        value = np.where(aspect >= place, number, value)
    return value


def of_aspect(part: MeshPart, gives: str, field: str, says: str) -> Equation:
    """Return the equation of a number of each aspect, a field of `PartAspect`."""
    numbers = tuple(getattr(aspect, field) for aspect in part.aspects)
    function = partial(_number_of_aspect, numbers)
    return Equation(gives, function, FILE, needs=("aspect",), says=f"Return {says}.")


def _volume(volume: float) -> Array:
    return np.asarray(volume)


def mesh_equations(part: MeshPart) -> tuple[Equation, ...]:
    """Return the equations of a part from a file at rest; each cell is one of its aspects."""
    across = "the slope across its longer side on which it topples [rad]"
    volume = partial(_volume, part.volume)
    return (
        *(of_aspect(part, gives, *row) for gives, row in LYING.items()),
        of_aspect(part, "least_base", "base_least", "the distance of the nearest edge [m]"),
        *TOPPLING,
        under_names("topple_slope_across", resting.topple_slope, FILE, across,
                    standing_base="standing_base_across"),
        under_names("least_topple_slope", resting.topple_slope, FILE,
                    "the least slope on which it topples, over the nearest edge [rad]",
                    standing_base="least_base"),
        Equation("part_volume", volume, FILE, needs=(), says="Return the volume of the part [m3]."),
        Equation("part_mass", resting.part_mass, FILE),
    )  # fmt: skip


def number_of_aspects(name: str, part: MeshPart) -> Constraint:
    """Return the constraint that a parameter is the number of one of a part's aspects."""
    count = len(part.aspects)
    return Constraint(
        (name,),
        lambda _, largest: largest <= count,
        f"the part has {count} aspects",
        f"Give 1 to {count}",
        MESH,
    )


def fit_to_part(scene: Scene, _: Collection[str]) -> Scene:
    """Return the scene with the aspects of a study's part from a file."""
    return _fitted(scene.part)


@lru_cache(maxsize=64)
def _fitted(part: MeshPart) -> Scene:
    return replace(
        SCENE,
        variants={**SCENE.variants, MESH: mesh_equations(part)},
        constraints=(number_of_aspects("aspect", part),),
        part=part,
    )


SCENE = Scene(
    name="resting-part",
    title="How a part comes to rest, and when it topples",
    source="",
    validity="Convex parts fall on a hard, level floor, and every orientation is equally likely. "
    "The shares are two limits: for parts that are let down with negligible momentum, and for "
    "parts that are thrown. Drop height and rebound decide where the true share lies between "
    "them, so that their difference is the error of both. Turned parts have the ends of their "
    "hull, and a part from a file (mesh) rests on its hull. A standing part is rigid and does "
    "not slide, and its foot does not bounce.",
    variants={**{shape: equations(shape) for shape in SHAPES}, MESH: mesh_equations(UNREAD)},
    default_variant="box",
    conditions={**{shape: conditions(shape) for shape in SHAPES}, MESH: TOPPLE_CONDITIONS},
    defaults={"gamma": 0.0, "gravity": STANDARD_GRAVITY},
    constraints=(),
    fit=fit_to_part,
)
