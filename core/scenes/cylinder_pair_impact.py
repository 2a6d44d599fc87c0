"""Impact of two cylindrical parts; section 3.3.4 of the source.

The variants are laws of impact, as for rectangles: `frictionless`, the default, needs no friction
coefficient; `pfeiffer_glocker` is the law to take with friction, `moreau` is there to compare. What
the source prints, (3.44), drives the bodies into each other and is not offered (theory 8.3).
"""

from __future__ import annotations

from typing import Any

from vibrafeed.core.mechanics import cylinder_impact, cylinder_outcome
from vibrafeed.core.mechanics.cylinder_contact import cylinder_contact
from vibrafeed.core.scenes.scene import Condition, Equation, Scene, fields

# What the impact leaves of both bodies, with the way to it.
VELOCITIES: dict[str, Any] = {
    f"{field}_{axis}_{body}_after": (
        f"{field}_{body}",
        place,
        f"the {name} of body {body} after the impact, {axis} [{unit}]",
    )
    for body in (1, 2)
    for field, name, unit in (
        ("velocity", "velocity", "m s-1"),
        ("spin", "angular velocity", "rad s-1"),
    )
    for place, axis in enumerate("xyz")
}
CONTACT_STATE = (
    Equation("cylinder_1", cylinder_impact.cylinder_1, "theory 8.1"),
    Equation("cylinder_2", cylinder_impact.cylinder_2, "theory 8.1"),
    Equation("cylinder_masses", cylinder_impact.cylinder_masses, "theory 8.1"),
    Equation("spatial_motion", cylinder_impact.spatial_motion, "theory 8.1"),
    Equation("cylinder_contact", cylinder_contact, "theory 8.2"),
    *fields(
        "cylinder_contact",
        "theory 8.2",
        gap=("gap", "the gap; a lower bound of it where rims have entered each other [m]"),
        contact_form=("form", "the form of contact, 1 to 5, or 0"),
        face_body=(
            "face_body",
            "the body whose face or side is met, 1 or 2; 0 if both, or if contact_form is 0",
        ),
        normal_x=("normal", 0, "the normal from body 2 to body 1, its x component"),
        normal_y=("normal", 1, "the normal from body 2 to body 1, its y component"),
        normal_z=("normal", 2, "the normal from body 2 to body 1, its z component"),
    ),
)
REST = (
    *fields(
        "contact_frame",
        "theory 8.1",
        contact_x=("point", 0, "the point where the impulse acts, x [m]"),
        contact_y=("point", 1, "the point where the impulse acts, y [m]"),
        contact_z=("point", 2, "the point where the impulse acts, z [m]"),
    ),
    Equation("spatial_delassus", cylinder_impact.spatial_delassus, "theory 8.1"),
    *fields(
        "spatial_delassus",
        "theory 8.1",
        delassus_normal=(
            "NN",
            "the number 1/m1 + 1/m2 + (rho1 x n).J1^-1 (rho1 x n) + that of body 2 [kg-1]",
        ),
    ),
    Equation("spatial_approach", cylinder_impact.spatial_approach, "theory 8.1"),
    *fields(
        "spatial_approach",
        "theory 8.1",
        approach_normal=(
            "normal",
            "the velocity n.(v1 + w1 x rho1 - v2 - w2 x rho2) before the impact [m s-1]",
        ),
    ),
    Equation("sliding_before", cylinder_outcome.sliding_before, "theory 8.1"),
    *fields(
        "spatial_impulse",
        "theory 8.1",
        impulse_normal=("normal", "the normal impulse on body 1 [N s]"),
    ),
    Equation("impulse_friction", cylinder_outcome.impulse_friction, "theory 8.1"),
    Equation("impulse_x", cylinder_outcome.impulse_x, "theory 8.1"),
    Equation("impulse_y", cylinder_outcome.impulse_y, "theory 8.1"),
    Equation("impulse_z", cylinder_outcome.impulse_z, "theory 8.1"),
    Equation("spatial_motion_after", cylinder_impact.spatial_motion_after, "theory 8.1"),
    *fields(
        "spatial_motion_after",
        "theory 8.1",
        **VELOCITIES,
    ),
    Equation("separation_normal", cylinder_outcome.separation_normal, "theory 8.1"),
    Equation("sliding_after", cylinder_outcome.sliding_after, "theory 8.1"),
    Equation("energy_before", cylinder_outcome.energy_before, "theory 8.1"),
    Equation("energy_lost", cylinder_outcome.energy_lost, "theory 8.1"),
    Equation("momentum_residual_x", cylinder_outcome.momentum_residual_x, "theory 8.1"),
    Equation("momentum_residual_y", cylinder_outcome.momentum_residual_y, "theory 8.1"),
    Equation("momentum_residual_z", cylinder_outcome.momentum_residual_z, "theory 8.1"),
    Equation(
        "angular_momentum_residual_x", cylinder_outcome.angular_momentum_residual_x, "theory 8.1"
    ),
    Equation(
        "angular_momentum_residual_y", cylinder_outcome.angular_momentum_residual_y, "theory 8.1"
    ),
    Equation(
        "angular_momentum_residual_z", cylinder_outcome.angular_momentum_residual_z, "theory 8.1"
    ),
)
FRICTIONLESS = (
    *CONTACT_STATE,
    Equation(
        "contact_frame",
        cylinder_impact.frame_without_friction,
        "theory 1.4, theory 8.2",
        "frictionless",
    ),
    Equation("spatial_impulse", cylinder_impact.frictionless_impulse, "theory 8.1", "frictionless"),
    *REST,
)
PFEIFFER_GLOCKER = (
    *CONTACT_STATE,
    Equation("contact_frame", cylinder_impact.frame_with_friction, "theory 8.2"),
    Equation(
        "spatial_impulse",
        cylinder_impact.pfeiffer_glocker_impulse,
        "theory 8.1",
        "pfeiffer_glocker",
    ),
    *REST,
)
MOREAU = (
    *CONTACT_STATE,
    Equation("contact_frame", cylinder_impact.frame_with_friction, "theory 8.2"),
    Equation("spatial_impulse", cylinder_impact.moreau_impulse, "theory 8.1", "moreau"),
    *REST,
)

WHERE = frozenset(("gap", "contact_form", "face_body", "normal_x", "normal_y", "normal_z"))
BEFORE = frozenset(
    (
        "contact_x",
        "contact_y",
        "contact_z",
        "delassus_normal",
        "approach_normal",
        "sliding_before",
    )
)
AFTER = frozenset(
    (
        "impulse_normal",
        "impulse_friction",
        "impulse_x",
        "impulse_y",
        "impulse_z",
        "velocity_x_1_after",
        "velocity_y_1_after",
        "velocity_z_1_after",
        "spin_x_1_after",
        "spin_y_1_after",
        "spin_z_1_after",
        "velocity_x_2_after",
        "velocity_y_2_after",
        "velocity_z_2_after",
        "spin_x_2_after",
        "spin_y_2_after",
        "spin_z_2_after",
        "separation_normal",
        "sliding_after",
        "energy_lost",
        "momentum_residual_x",
        "momentum_residual_y",
        "momentum_residual_z",
        "angular_momentum_residual_x",
        "angular_momentum_residual_y",
        "angular_momentum_residual_z",
        "regime",
    )
)
CONDITIONS = (
    Condition("apart", cylinder_impact.is_apart, WHERE | BEFORE | AFTER, otherwise="contact"),
    Condition("overlap", cylinder_impact.overlaps, WHERE | BEFORE | AFTER),
    Condition("simultaneous", cylinder_impact.is_no_single_point, WHERE | BEFORE | AFTER),
    Condition("simultaneous", cylinder_impact.is_line, AFTER),
    Condition("no_impact", cylinder_impact.does_not_approach, BEFORE | AFTER, otherwise="impact"),
)
FRICTION_CONDITIONS = (
    *CONDITIONS,
    Condition("impact_stick", cylinder_impact.ends_in_stick, AFTER, otherwise="impact_slip"),
)

SCENE = Scene(
    name="cylinder-pair-impact",
    title="Impact of two cylindrical parts",
    source="3.3.4",
    validity="Rigid homogeneous cylinders, one instant, no other impulse than that of the contact. "
    "Lines of contact are solved without friction only; face on face and rim on rim are not. The "
    "bodies have to touch as placed, to within the contact tolerance; nothing moves them there.",
    variants={
        "frictionless": FRICTIONLESS,
        "pfeiffer_glocker": PFEIFFER_GLOCKER,
        "moreau": MOREAU,
    },
    default_variant="frictionless",
    conditions={
        "frictionless": CONDITIONS,
        "pfeiffer_glocker": FRICTION_CONDITIONS,
        "moreau": FRICTION_CONDITIONS,
    },
    defaults={
        "contact_tolerance": 1e-9,
        "position_x_2": 0.0,
        "position_y_2": 0.0,
        "position_z_2": 0.0,
        **{
            f"{name}_{body}": 0.0
            for name in (
                *("azimuth", "elevation"),
                *("velocity_x", "velocity_y", "velocity_z", "spin_x", "spin_y", "spin_z"),
            )
            for body in (1, 2)
        },
    },
    constraints=(),
    seconds_a_cell=2e-5,
)
