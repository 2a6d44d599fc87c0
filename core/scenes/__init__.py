"""The systems that can be computed, a family a file; and other ways of giving a parameter."""

import numpy as np

from vibrafeed.core.mechanics.drive_unit import magnet_force, unbalance_force, voltage_force
from vibrafeed.core.mechanics.floor import (
    amplitude,
    amplitude_of_vertical,
    amplitude_of_vertical_stroke,
)
from vibrafeed.core.mechanics.orienting import rate_by_pitch
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
from vibrafeed.core.scenes.scene import EXACT, Condition, Constraint, Equation, Scene, fields

SCENES: dict[str, Scene] = {
    "rectangle-isolated": isolated.RECTANGLE_SCENE,
    "rectangle-on-plane": on_floor.RECTANGLE_SCENE,
    "rectangle-on-track": on_floor.TRACK_SCENE,
    "part-on-plate": on_floor.PLATE_SCENE,
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

VERTICAL = ("vertical_amplitude", "vertical_peak_to_peak")

ALIASES = (
    Equation("amplitude", amplitude, "theory 0.2"),
    Equation("amplitude", amplitude_of_vertical, "theory 0.2"),
    Equation("amplitude", amplitude_of_vertical_stroke, "theory 0.2"),
    *fields(
        "friction",
        "theory 11.2",
        friction_static=("the static coefficient where one coefficient serves for both [1]",),
        friction_kinetic=("the kinetic coefficient where one coefficient serves for both [1]",),
    ),
    Equation("drive_force", magnet_force, "theory 15.1"),
    Equation("drive_force", unbalance_force, "theory 15.1"),
    Equation("drive_force", voltage_force, "theory 15.1"),
    Equation("arrival_rate", rate_by_pitch, "theory 16.3"),
)
"""They serve only where the parameter itself is not given."""

BESIDE = frozenset(("beta", "measured_voltage", "measured_amplitude", "force_exponent"))
"""Inputs of `ALIASES` that stand for nothing themselves."""


def instead_of(name: str) -> tuple[str, ...]:
    """Return the quantities that a parameter can be given for; none for most parameters."""
    replaced = (alias.gives for alias in ALIASES if name in alias.inputs)
    return () if name in BESIDE else tuple(replaced)


ALTERNATIVES = (
    ("friction", ("friction_static", "friction_kinetic")),
    ("peak_to_peak", ("amplitude",)),
    *((name, (other,)) for name in VERTICAL for other in ("amplitude", "peak_to_peak")),
    (VERTICAL[1], (VERTICAL[0],)),
    ("occupancy", ("part_gap",)),
    ("hold_down", ("hold_down_force",)),
)
"""Parameters that stand for others; a study gives either."""

WRITTEN_AS = {"friction_static": "friction", "friction_kinetic": "friction"}
"""Which of both ways the error for a missing parameter names."""

NEEDS = {
    "hold_down_force": ("mass", "the mass of the part that it presses on is missing", '"5 g"'),
    **dict.fromkeys(VERTICAL, ("beta", "the angle of the drive above the floor is missing", 20)),
}
"""Parameters that say nothing without another: that one, what is wrong, and an example of it."""

CONSTRAINTS = tuple(
    Constraint(
        ("beta", name),
        lambda least, largest, *_: 0 < least <= largest < np.pi or -np.pi < least <= largest < 0,
        f"beta reaches 0 or 180 degrees, where the drive has no vertical part and {name} says "
        "nothing about its amplitude",
        f"Keep beta between 0 and 180 degrees, or give amplitude instead of {name}",
    )
    for name in VERTICAL
)
"""Relations between other ways of giving a parameter and what they need, in every scene."""

NOT_OF_SHAPE = {
    (shape, "centre_of_mass"): (
        f"a {shape} has its mass in the middle, so that centre_of_mass is not used",
        'Remove it, or set variant = "weighted_box". Of other parts count a drop test: scene '
        '"orienting-line" takes drop_count_1, drop_count_2 and so on',
    )
    for shape in ("box", "prism")
}
"""Of a variant and a parameter that only parts of quite another shape have: what to say of it."""

__all__ = [
    "ALIASES",
    "ALTERNATIVES",
    "BESIDE",
    "CONSTRAINTS",
    "EXACT",
    "NEEDS",
    "NOT_OF_SHAPE",
    "SCENES",
    "VERTICAL",
    "WRITTEN_AS",
    "Condition",
    "Constraint",
    "Equation",
    "Scene",
    "instead_of",
]
