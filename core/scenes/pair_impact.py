"""Two bodies that collide: rectangles in a plane, cylinders in space."""

from __future__ import annotations

from typing import Any

from vibrafeed.core.mechanics import cylinder_impact, rectangle_impact
from vibrafeed.core.mechanics.cylinder_contact import cylinder_contact
from vibrafeed.core.mechanics.rectangle_contact import rectangle_contact
from vibrafeed.core.scenes.scene import Condition, Equation, Scene, fields

# --- Impact of two rectangular parts on the floor plane; section 3.2.5 of the source.
#
# The variants are laws of impact. Without friction there is one law, Newton's, and it needs no
# friction coefficient: it is the default, so that a study gives friction only together with the law
# that uses it. With friction `pfeiffer_glocker` is the law to take; `moreau` is there to compare.
# What the source prints, (3.24), drives the bodies into each other and is not offered (theory 5.4).

RECTANGLE_CONTACT_STATE = (
    Equation("rectangle_1", rectangle_impact.rectangle_1, "theory 5.1"),
    Equation("rectangle_2", rectangle_impact.rectangle_2, "theory 5.1"),
    Equation("rectangle_contact", rectangle_contact, "theory 5.1"),
    *fields(
        "rectangle_contact",
        "theory 5.1",
        gap=("gap", "the largest of the four gaps between a face and the other body [m]"),
        face_body=("face_body", "the body whose face has the largest gap, 1 or 2"),
        contact_corner=(
            "corner",
            "the corner of the other body nearest to that face, 1 to 4, or 0 for an edge",
        ),
        normal_x=("normal_x", "the normal from body 2 to body 1, its x component"),
        normal_y=("normal_y", "the normal from body 2 to body 1, its y component"),
    ),
    Equation("inertia_1", rectangle_impact.inertia_1, "theory 5.1"),
    Equation("inertia_2", rectangle_impact.inertia_2, "theory 5.1"),
    Equation("rectangle_masses", rectangle_impact.rectangle_masses, "theory 5.1"),
    Equation("planar_motion", rectangle_impact.planar_motion, "theory 5.1"),
)
RECTANGLE_REST = (
    Equation("contact_x", rectangle_impact.contact_x, "theory 5.1"),
    Equation("contact_y", rectangle_impact.contact_y, "theory 5.1"),
    Equation("contact_arms", rectangle_impact.contact_arms, "theory 5.1"),
    Equation("delassus_normal", rectangle_impact.delassus_normal, "theory 5.1"),
    Equation("delassus_coupling", rectangle_impact.delassus_coupling, "theory 5.1"),
    Equation("delassus_tangential", rectangle_impact.delassus_tangential, "theory 5.1"),
    Equation("approach_normal", rectangle_impact.approach_normal, "theory 5.1"),
    Equation("approach_tangential", rectangle_impact.approach_tangential, "theory 5.1"),
    *fields(
        "planar_impulse",
        "theory 5.2, theory 5.3",
        impulse_normal=("normal", "the normal impulse on body 1 [N s]"),
    ),
    *fields(
        "planar_impulse",
        "theory 5.3",
        impulse_tangential=(
            "tangential",
            "the tangential impulse on body 1, along t = (-n_y, n_x) [N s]",
        ),
    ),
    Equation("planar_motion_after", rectangle_impact.motion_after, "theory 5.2"),
    *fields(
        "planar_motion_after",
        "theory 5.2",
        velocity_x_1_after=("velocity_x_1", "the velocity of body 1 after the impact, x [m s-1]"),
        velocity_y_1_after=("velocity_y_1", "the velocity of body 1 after the impact, y [m s-1]"),
        spin_1_after=("spin_1", "the angular velocity of body 1 after the impact [rad s-1]"),
        velocity_x_2_after=("velocity_x_2", "the velocity of body 2 after the impact, x [m s-1]"),
        velocity_y_2_after=("velocity_y_2", "the velocity of body 2 after the impact, y [m s-1]"),
        spin_2_after=("spin_2", "the angular velocity of body 2 after the impact [rad s-1]"),
    ),
    Equation("separation_normal", rectangle_impact.separation_normal, "theory 5.2"),
    Equation("separation_tangential", rectangle_impact.separation_tangential, "theory 5.3"),
    Equation("energy_before", rectangle_impact.energy_before, "theory 5.3"),
    Equation("energy_lost", rectangle_impact.energy_lost, "theory 5.3"),
    Equation("momentum_residual_x", rectangle_impact.momentum_residual_x, "theory 5.3"),
    Equation("momentum_residual_y", rectangle_impact.momentum_residual_y, "theory 5.3"),
    Equation("angular_momentum_residual", rectangle_impact.angular_momentum_residual, "theory 5.3"),
)
WITH_FRICTION = Equation("edge_action", rectangle_impact.edge_action_with_friction, "theory 5.1")
RECTANGLE_FRICTIONLESS = (
    *RECTANGLE_CONTACT_STATE,
    Equation(
        "edge_action", rectangle_impact.edge_action_without_friction, "theory 1.4", "frictionless"
    ),
    Equation("planar_impulse", rectangle_impact.frictionless_impulse, "theory 5.2", "frictionless"),
    *RECTANGLE_REST,
)
RECTANGLE_PFEIFFER_GLOCKER = (
    *RECTANGLE_CONTACT_STATE,
    WITH_FRICTION,
    Equation(
        "planar_impulse",
        rectangle_impact.pfeiffer_glocker_impulse,
        "theory 5.3",
        "pfeiffer_glocker",
    ),
    *RECTANGLE_REST,
)
RECTANGLE_MOREAU = (
    *RECTANGLE_CONTACT_STATE,
    WITH_FRICTION,
    Equation("planar_impulse", rectangle_impact.moreau_impulse, "theory 5.3", "moreau"),
    *RECTANGLE_REST,
)

RECTANGLE_WHERE = frozenset(("gap", "face_body", "contact_corner", "normal_x", "normal_y"))
RECTANGLE_BEFORE = frozenset(
    (
        "contact_x",
        "contact_y",
        "delassus_normal",
        "delassus_coupling",
        "delassus_tangential",
        "approach_normal",
        "approach_tangential",
    )
)
RECTANGLE_AFTER = frozenset(
    (
        "impulse_normal",
        "impulse_tangential",
        "velocity_x_1_after",
        "velocity_y_1_after",
        "spin_1_after",
        "velocity_x_2_after",
        "velocity_y_2_after",
        "spin_2_after",
        "separation_normal",
        "separation_tangential",
        "energy_lost",
        "momentum_residual_x",
        "momentum_residual_y",
        "angular_momentum_residual",
        "regime",
    )
)
RECTANGLE_CONDITIONS = (
    Condition(
        "apart",
        rectangle_impact.is_apart,
        RECTANGLE_WHERE | RECTANGLE_BEFORE | RECTANGLE_AFTER,
        otherwise="contact",
    ),
    Condition(
        "overlap", rectangle_impact.overlaps, RECTANGLE_WHERE | RECTANGLE_BEFORE | RECTANGLE_AFTER
    ),
    Condition(
        "simultaneous",
        rectangle_impact.is_corner_on_corner,
        RECTANGLE_WHERE | RECTANGLE_BEFORE | RECTANGLE_AFTER,
    ),
    Condition("simultaneous", rectangle_impact.is_edge_on_edge, RECTANGLE_AFTER),
    Condition(
        "no_impact",
        rectangle_impact.does_not_approach,
        RECTANGLE_BEFORE | RECTANGLE_AFTER,
        otherwise="impact",
    ),
)
RECTANGLE_FRICTION_CONDITIONS = (
    *RECTANGLE_CONDITIONS,
    Condition(
        "impact_stick", rectangle_impact.ends_in_stick, RECTANGLE_AFTER, otherwise="impact_slip"
    ),
)

RECTANGLE_SCENE = Scene(
    name="rectangle-pair-impact",
    title="Impact of two rectangular parts on the floor plane",
    source="3.2.5",
    validity="Rigid parts that lie flat, one instant, no other impulse than that of the contact. "
    "An edge on an edge is solved without friction only. The bodies have to touch as placed, to "
    "within the contact tolerance; nothing moves them there.",
    variants={
        "frictionless": RECTANGLE_FRICTIONLESS,
        "pfeiffer_glocker": RECTANGLE_PFEIFFER_GLOCKER,
        "moreau": RECTANGLE_MOREAU,
    },
    default_variant="frictionless",
    conditions={
        "frictionless": RECTANGLE_CONDITIONS,
        "pfeiffer_glocker": RECTANGLE_FRICTION_CONDITIONS,
        "moreau": RECTANGLE_FRICTION_CONDITIONS,
    },
    defaults={
        "contact_tolerance": 1e-9,
        "position_x_2": 0.0,
        "position_y_2": 0.0,
        "angle_1": 0.0,
        "angle_2": 0.0,
        **{
            f"{name}_{body}": 0.0
            for name in ("velocity_x", "velocity_y", "spin")
            for body in (1, 2)
        },
    },
    constraints=(),
    seconds_a_cell=1e-6,
)


# --- Impact of two cylindrical parts; section 3.3.4 of the source.
#
# The variants are laws of impact, as for rectangles: `frictionless`, the default, needs no friction
# coefficient; `pfeiffer_glocker` is the law to take with friction, `moreau` is there to compare.
# What the source prints, (3.44), drives the bodies into each other and is not offered (theory 8.3).

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
CYLINDER_CONTACT_STATE = (
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
CYLINDER_REST = (
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
    Equation("sliding_before", cylinder_impact.sliding_before, "theory 8.1"),
    *fields(
        "spatial_impulse",
        "theory 8.1",
        impulse_normal=("normal", "the normal impulse on body 1 [N s]"),
    ),
    Equation("impulse_friction", cylinder_impact.impulse_friction, "theory 8.1"),
    Equation("impulse_x", cylinder_impact.impulse_x, "theory 8.1"),
    Equation("impulse_y", cylinder_impact.impulse_y, "theory 8.1"),
    Equation("impulse_z", cylinder_impact.impulse_z, "theory 8.1"),
    Equation("spatial_motion_after", cylinder_impact.spatial_motion_after, "theory 8.1"),
    *fields(
        "spatial_motion_after",
        "theory 8.1",
        **VELOCITIES,
    ),
    Equation("separation_normal", cylinder_impact.separation_normal, "theory 8.1"),
    Equation("sliding_after", cylinder_impact.sliding_after, "theory 8.1"),
    Equation("energy_before", cylinder_impact.energy_before, "theory 8.1"),
    Equation("energy_lost", cylinder_impact.energy_lost, "theory 8.1"),
    Equation("momentum_residual_x", cylinder_impact.momentum_residual_x, "theory 8.1"),
    Equation("momentum_residual_y", cylinder_impact.momentum_residual_y, "theory 8.1"),
    Equation("momentum_residual_z", cylinder_impact.momentum_residual_z, "theory 8.1"),
    Equation(
        "angular_momentum_residual_x", cylinder_impact.angular_momentum_residual_x, "theory 8.1"
    ),
    Equation(
        "angular_momentum_residual_y", cylinder_impact.angular_momentum_residual_y, "theory 8.1"
    ),
    Equation(
        "angular_momentum_residual_z", cylinder_impact.angular_momentum_residual_z, "theory 8.1"
    ),
)
CYLINDER_FRICTIONLESS = (
    *CYLINDER_CONTACT_STATE,
    Equation(
        "contact_frame",
        cylinder_impact.frame_without_friction,
        "theory 1.4, theory 8.2",
        "frictionless",
    ),
    Equation("spatial_impulse", cylinder_impact.frictionless_impulse, "theory 8.1", "frictionless"),
    *CYLINDER_REST,
)
CYLINDER_PFEIFFER_GLOCKER = (
    *CYLINDER_CONTACT_STATE,
    Equation("contact_frame", cylinder_impact.frame_with_friction, "theory 8.2"),
    Equation(
        "spatial_impulse",
        cylinder_impact.pfeiffer_glocker_impulse,
        "theory 8.1",
        "pfeiffer_glocker",
    ),
    *CYLINDER_REST,
)
CYLINDER_MOREAU = (
    *CYLINDER_CONTACT_STATE,
    Equation("contact_frame", cylinder_impact.frame_with_friction, "theory 8.2"),
    Equation("spatial_impulse", cylinder_impact.moreau_impulse, "theory 8.1", "moreau"),
    *CYLINDER_REST,
)

CYLINDER_WHERE = frozenset(("gap", "contact_form", "face_body", "normal_x", "normal_y", "normal_z"))
CYLINDER_BEFORE = frozenset(
    (
        "contact_x",
        "contact_y",
        "contact_z",
        "delassus_normal",
        "approach_normal",
        "sliding_before",
    )
)
CYLINDER_AFTER = frozenset(
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
CYLINDER_CONDITIONS = (
    Condition(
        "apart",
        cylinder_impact.is_apart,
        CYLINDER_WHERE | CYLINDER_BEFORE | CYLINDER_AFTER,
        otherwise="contact",
    ),
    Condition(
        "overlap", cylinder_impact.overlaps, CYLINDER_WHERE | CYLINDER_BEFORE | CYLINDER_AFTER
    ),
    Condition(
        "simultaneous",
        cylinder_impact.is_no_single_point,
        CYLINDER_WHERE | CYLINDER_BEFORE | CYLINDER_AFTER,
    ),
    Condition("simultaneous", cylinder_impact.is_line, CYLINDER_AFTER),
    Condition(
        "no_impact",
        cylinder_impact.does_not_approach,
        CYLINDER_BEFORE | CYLINDER_AFTER,
        otherwise="impact",
    ),
)
CYLINDER_FRICTION_CONDITIONS = (
    *CYLINDER_CONDITIONS,
    Condition(
        "impact_stick", cylinder_impact.ends_in_stick, CYLINDER_AFTER, otherwise="impact_slip"
    ),
)

CYLINDER_SCENE = Scene(
    name="cylinder-pair-impact",
    title="Impact of two cylindrical parts",
    source="3.3.4",
    validity="Rigid homogeneous cylinders, one instant, no other impulse than that of the contact. "
    "Lines of contact are solved without friction only; face on face and rim on rim are not. The "
    "bodies have to touch as placed, to within the contact tolerance; nothing moves them there.",
    variants={
        "frictionless": CYLINDER_FRICTIONLESS,
        "pfeiffer_glocker": CYLINDER_PFEIFFER_GLOCKER,
        "moreau": CYLINDER_MOREAU,
    },
    default_variant="frictionless",
    conditions={
        "frictionless": CYLINDER_CONDITIONS,
        "pfeiffer_glocker": CYLINDER_FRICTION_CONDITIONS,
        "moreau": CYLINDER_FRICTION_CONDITIONS,
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
