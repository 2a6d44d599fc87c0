"""A contact that gives: restitution over speed, damping, and whether contacts count as rigid."""

from __future__ import annotations

from vibrafeed.core.mechanics import soft_contact
from vibrafeed.core.scenes.scene import STANDARD_GRAVITY, Condition, Equation, Scene

SOURCE = "theory 18.3"
EQUATIONS = (
    Equation("impact_damping", soft_contact.impact_damping, SOURCE),
    Equation("restitution_at_impact", soft_contact.restitution_at, SOURCE),
    Equation("damping_of_restitution", soft_contact.damping_of_restitution, SOURCE),
    Equation("restitution_of_damping", soft_contact.restitution_of_damping, SOURCE),
    Equation("lining_frequency", soft_contact.lining_frequency, SOURCE),
    Equation("lining_sag", soft_contact.lining_sag, SOURCE),
    Equation("stiffness_ratio", soft_contact.stiffness_ratio, SOURCE),
    Equation("hertz_depth", soft_contact.hertz_depth, SOURCE),
    Equation("hertz_time", soft_contact.hertz_time, SOURCE),
)
CONDITIONS = (
    Condition(
        "unbounded",
        soft_contact.needs_endless_damping,
        frozenset(("damping_of_restitution", "impact_damping")),
        otherwise="contact",
    ),
    Condition(
        "soft_contact", soft_contact.is_soft, frozenset(("stiffness_ratio",)), otherwise="contact"
    ),
)

SCENE = Scene(
    name="soft-contact",
    title="A contact that gives: restitution over speed, lined tracks",
    source="",
    validity="One impact of a rigid part on a contact without adhesion. Hunt and Crossley's law "
    "has a restitution that falls with the speed, a spring with a damper that never pulls one that "
    "does not. Contacts count as rigid where the part's natural frequency on its lining is five "
    "times that of the drive, or more.",
    variants={"physical": EQUATIONS},
    default_variant="physical",
    conditions={"physical": CONDITIONS},
    defaults={"gravity": STANDARD_GRAVITY},
    constraints=(),
)
