"""Impact of two rectangular parts on the floor plane; section 3.2.5 of the source.

The variants are laws of impact. Without friction there is one law, Newton's, and it needs no
friction coefficient: it is the default, so that a study gives friction only together with the law
that uses it. With friction `pfeiffer_glocker` is the law to take; `moreau` is there to compare.
What the source prints, (3.24), drives the bodies into each other and is not offered (theory 5.4).
"""

from __future__ import annotations

from vibrafeed.core.mechanics import rectangle_impact, rectangle_outcome
from vibrafeed.core.mechanics.rectangle_contact import rectangle_contact
from vibrafeed.core.scenes.scene import Condition, Equation, Scene, fields

CONTACT_STATE = (
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
REST = (
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
    Equation("planar_motion_after", rectangle_outcome.motion_after, "theory 5.2"),
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
    Equation("separation_normal", rectangle_outcome.separation_normal, "theory 5.2"),
    Equation("separation_tangential", rectangle_outcome.separation_tangential, "theory 5.3"),
    Equation("energy_before", rectangle_outcome.energy_before, "theory 5.3"),
    Equation("energy_lost", rectangle_outcome.energy_lost, "theory 5.3"),
    Equation("momentum_residual_x", rectangle_outcome.momentum_residual_x, "theory 5.3"),
    Equation("momentum_residual_y", rectangle_outcome.momentum_residual_y, "theory 5.3"),
    Equation(
        "angular_momentum_residual", rectangle_outcome.angular_momentum_residual, "theory 5.3"
    ),
)
WITH_FRICTION = Equation("edge_action", rectangle_impact.edge_action_with_friction, "theory 5.1")
FRICTIONLESS = (
    *CONTACT_STATE,
    Equation(
        "edge_action", rectangle_impact.edge_action_without_friction, "theory 1.4", "frictionless"
    ),
    Equation("planar_impulse", rectangle_impact.frictionless_impulse, "theory 5.2", "frictionless"),
    *REST,
)
PFEIFFER_GLOCKER = (
    *CONTACT_STATE,
    WITH_FRICTION,
    Equation(
        "planar_impulse",
        rectangle_impact.pfeiffer_glocker_impulse,
        "theory 5.3",
        "pfeiffer_glocker",
    ),
    *REST,
)
MOREAU = (
    *CONTACT_STATE,
    WITH_FRICTION,
    Equation("planar_impulse", rectangle_impact.moreau_impulse, "theory 5.3", "moreau"),
    *REST,
)

WHERE = frozenset(("gap", "face_body", "contact_corner", "normal_x", "normal_y"))
BEFORE = frozenset(
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
AFTER = frozenset(
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
CONDITIONS = (
    Condition("apart", rectangle_impact.is_apart, WHERE | BEFORE | AFTER, otherwise="contact"),
    Condition("overlap", rectangle_impact.overlaps, WHERE | BEFORE | AFTER),
    Condition("simultaneous", rectangle_impact.is_corner_on_corner, WHERE | BEFORE | AFTER),
    Condition("simultaneous", rectangle_impact.is_edge_on_edge, AFTER),
    Condition("no_impact", rectangle_impact.does_not_approach, BEFORE | AFTER, otherwise="impact"),
)
FRICTION_CONDITIONS = (
    *CONDITIONS,
    Condition("impact_stick", rectangle_impact.ends_in_stick, AFTER, otherwise="impact_slip"),
)

SCENE = Scene(
    name="rectangle-pair-impact",
    title="Impact of two rectangular parts on the floor plane",
    source="3.2.5",
    validity="Rigid parts that lie flat, one instant, no other impulse than that of the contact. "
    "An edge on an edge is solved without friction only. The bodies have to touch as placed, to "
    "within the contact tolerance; nothing moves them there.",
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
