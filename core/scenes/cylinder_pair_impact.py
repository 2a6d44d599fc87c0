"""Impact of two cylindrical parts; section 3.3.4 of the source.

The variants are laws of impact, as for rectangles: `frictionless`, the default, needs no friction
coefficient; `pfeiffer_glocker` is the law to take with friction, `moreau` is there to compare. What
the source prints, (3.44), drives the bodies into each other and is not offered (theory 8.3).
"""

from __future__ import annotations

from core.mechanics import cylinder_impact, cylinder_outcome
from core.mechanics.cylinder_contact import cylinder_contact
from core.scenes.scene import Condition, Equation, Scene

PLACE = (
    Equation("cylinder_1", cylinder_impact.cylinder_1, "theory 8.1"),
    Equation("cylinder_2", cylinder_impact.cylinder_2, "theory 8.1"),
    Equation("cylinder_masses", cylinder_impact.cylinder_masses, "theory 8.1"),
    Equation("spatial_motion", cylinder_impact.spatial_motion, "theory 8.1"),
    Equation("cylinder_contact", cylinder_contact, "theory 8.2"),
    Equation("gap", cylinder_outcome.gap, "theory 8.2"),
    Equation("contact_form", cylinder_outcome.contact_form, "theory 8.2"),
    Equation("face_body", cylinder_outcome.face_body, "theory 8.2"),
    Equation("normal_x", cylinder_outcome.normal_x, "theory 8.2"),
    Equation("normal_y", cylinder_outcome.normal_y, "theory 8.2"),
    Equation("normal_z", cylinder_outcome.normal_z, "theory 8.2"),
)
REST = (
    Equation("contact_x", cylinder_outcome.contact_x, "theory 8.1"),
    Equation("contact_y", cylinder_outcome.contact_y, "theory 8.1"),
    Equation("contact_z", cylinder_outcome.contact_z, "theory 8.1"),
    Equation("spatial_delassus", cylinder_impact.spatial_delassus, "theory 8.1"),
    Equation("delassus_normal", cylinder_outcome.delassus_normal, "theory 8.1"),
    Equation("spatial_approach", cylinder_impact.spatial_approach, "theory 8.1"),
    Equation("approach_normal", cylinder_outcome.approach_normal, "theory 8.1"),
    Equation("sliding_before", cylinder_outcome.sliding_before, "theory 8.1"),
    Equation("impulse_normal", cylinder_outcome.impulse_normal, "theory 8.1"),
    Equation("impulse_friction", cylinder_outcome.impulse_friction, "theory 8.1"),
    Equation("impulse_x", cylinder_outcome.impulse_x, "theory 8.1"),
    Equation("impulse_y", cylinder_outcome.impulse_y, "theory 8.1"),
    Equation("impulse_z", cylinder_outcome.impulse_z, "theory 8.1"),
    Equation("spatial_motion_after", cylinder_impact.spatial_motion_after, "theory 8.1"),
    Equation("velocity_x_1_after", cylinder_outcome.velocity_x_1_after, "theory 8.1"),
    Equation("velocity_y_1_after", cylinder_outcome.velocity_y_1_after, "theory 8.1"),
    Equation("velocity_z_1_after", cylinder_outcome.velocity_z_1_after, "theory 8.1"),
    Equation("spin_x_1_after", cylinder_outcome.spin_x_1_after, "theory 8.1"),
    Equation("spin_y_1_after", cylinder_outcome.spin_y_1_after, "theory 8.1"),
    Equation("spin_z_1_after", cylinder_outcome.spin_z_1_after, "theory 8.1"),
    Equation("velocity_x_2_after", cylinder_outcome.velocity_x_2_after, "theory 8.1"),
    Equation("velocity_y_2_after", cylinder_outcome.velocity_y_2_after, "theory 8.1"),
    Equation("velocity_z_2_after", cylinder_outcome.velocity_z_2_after, "theory 8.1"),
    Equation("spin_x_2_after", cylinder_outcome.spin_x_2_after, "theory 8.1"),
    Equation("spin_y_2_after", cylinder_outcome.spin_y_2_after, "theory 8.1"),
    Equation("spin_z_2_after", cylinder_outcome.spin_z_2_after, "theory 8.1"),
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
    *PLACE,
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
    *PLACE,
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
    *PLACE,
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
    seconds_a_verified_cell=8.0,
)
