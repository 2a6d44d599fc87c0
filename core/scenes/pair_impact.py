"""Two bodies that collide: rectangles in a plane, cylinders in space.

The variants are laws of impact. Without friction there is one law, Newton's, and it needs no
friction coefficient: it is the default, so that a study gives friction only together with the law
that uses it. With friction `pfeiffer_glocker` is the law to take; `moreau` is there to compare.
What the source prints, (3.24) and (3.44), drives the bodies into each other and is not offered
(theory 5.4, 8.3).
"""

from functools import partial
from types import ModuleType

from vibrafeed.core.mechanics import cylinder_impact, impact, rectangle_impact
from vibrafeed.core.mechanics.cylinder_contact import cylinder_contact
from vibrafeed.core.mechanics.rectangle_contact import rectangle_contact
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.scenes.scene import (
    Condition,
    Equation,
    Function,
    Scene,
    arguments_of,
    field_of,
    fields,
    under_names,
)

Equations = tuple[Equation, ...]


def of_body(body: int, gives: str, function: Function, source: str, says: str) -> Equation:
    """Return the equation of a quantity of one body, whose parameters end in its number."""
    names = {name: f"{name}_{body}" for name in arguments_of(function)}
    return under_names(f"{gives}_{body}", function, source, says.format(body), **names)


def conditions(
    laws: ModuleType, contact: Equations, approach: Equations, outcome: Equations
) -> dict[str, tuple[Condition, ...]]:
    """Return the conditions of each law for an impact of two bodies of a shape.

    `laws` has the functions; `contact` gives the place of contact, `approach` what closes there,
    and `outcome` what the impact leaves.
    """
    of_place, of_approach, of_outcome = (
        frozenset(each.gives for each in equations if not QUANTITIES[each.gives].bundle)
        for equations in (contact, approach, outcome)
    )
    of_outcome = of_outcome - {"energy_before"} | {"regime"}
    of_approach |= of_outcome
    common = (
        Condition("apart", laws.is_apart, of_place | of_approach, otherwise="contact"),
        Condition("overlap", laws.overlaps, of_place | of_approach),
        Condition("simultaneous", laws.lacks_single_point, of_place | of_approach),
        Condition("simultaneous", laws.lacks_single_impulse, of_outcome),
        Condition("no_impact", laws.does_not_approach, of_approach, otherwise="impact"),
    )
    stick = Condition("impact_stick", laws.ends_in_stick, of_outcome, otherwise="impact_slip")
    with_friction = (*common, stick)
    return {"frictionless": common, "pfeiffer_glocker": with_friction, "moreau": with_friction}


PFEIFFER_GLOCKER = "Return the impulse of compression and expansion with friction on body 1 [N s]."

# --- Impact of two rectangular parts on the floor plane; section 3.2.5 of the source.

RECTANGLE_WHERE = fields(
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
)
RECTANGLE_STATE = (
    *(
        of_body(body, "rectangle", rectangle_impact.rectangle, "theory 5.1",
                "the place and shape of body {}")
        for body in (1, 2)
    ),
    Equation("rectangle_contact", rectangle_contact, "theory 5.1"),
    *RECTANGLE_WHERE,
    *(
        of_body(body, "inertia", rectangle_impact.inertia, "theory 5.1",
                "the moment of inertia of body {}, m (a^2 + h^2)/12 [kg m2]")
        for body in (1, 2)
    ),
    Equation("rectangle_masses", rectangle_impact.rectangle_masses, "theory 5.1"),
    Equation("planar_motion", rectangle_impact.planar_motion, "theory 5.1"),
)  # fmt: skip
RECTANGLE_BEFORE = (
    *(
        Equation(f"contact_{axis}", partial(rectangle_impact.contact_point, place), "theory 5.1",
                 says=f"Return the point where the impulse acts, {axis} [m].")
        for place, axis in enumerate("xy")
    ),
    Equation("contact_arms", rectangle_impact.contact_arms, "theory 5.1"),
    Equation("delassus_normal", rectangle_impact.delassus_normal, "theory 5.1"),
    Equation("delassus_coupling", rectangle_impact.delassus_coupling, "theory 5.1"),
    Equation("delassus_tangential", rectangle_impact.delassus_tangential, "theory 5.1"),
    Equation("approach_normal", rectangle_impact.approach_normal, "theory 5.1"),
    Equation("approach_tangential", rectangle_impact.approach_tangential, "theory 5.1"),
)  # fmt: skip
RECTANGLE_AFTER = (
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
    under_names(
        "separation_normal", rectangle_impact.approach_normal, "theory 5.2",
        "the normal velocity at the contact after the impact, positive if it opens [m s-1]",
        planar_motion="planar_motion_after",
    ),
    under_names(
        "separation_tangential", rectangle_impact.approach_tangential, "theory 5.3",
        "the tangential velocity at the contact after the impact, 0 if it sticks [m s-1]",
        planar_motion="planar_motion_after",
    ),
    Equation("energy_before", rectangle_impact.energy_before, "theory 5.3"),
    Equation("energy_lost", rectangle_impact.energy_lost, "theory 5.3"),
    *(
        Equation(
            f"momentum_residual_{axis}", partial(rectangle_impact.momentum_residual, place),
            "theory 5.3",
            says=f"Return the change of the total linear momentum by the impact, {axis}: 0 up to "
            "rounding [N s].",
        )
        for place, axis in enumerate("xy")
    ),
    Equation(
        "angular_momentum_residual", rectangle_impact.angular_momentum_residual, "theory 5.3"
    ),
)  # fmt: skip
RECTANGLE_SCENE = Scene(
    name="rectangle-pair-impact",
    title="Impact of two rectangular parts on the floor plane",
    source="3.2.5",
    validity="The parts are rigid and lie flat. The impact is instantaneous, and the only "
    "impulse is that of the contact. An edge on an edge is solved only without friction. The "
    "bodies must touch where they are placed, within the contact tolerance; the program does not "
    "move them into contact.",
    variants={
        "frictionless": (
            *RECTANGLE_STATE,
            Equation(
                "edge_action",
                rectangle_impact.edge_action_without_friction,
                "theory 1.4",
                "frictionless",
            ),
            Equation(
                "planar_impulse",
                rectangle_impact.frictionless_impulse,
                "theory 5.2",
                "frictionless",
            ),
            *RECTANGLE_BEFORE,
            *RECTANGLE_AFTER,
        ),
        **{
            name: (
                *RECTANGLE_STATE,
                Equation("edge_action", rectangle_impact.edge_action_with_friction, "theory 5.1"),
                Equation(
                    "planar_impulse",
                    partial(rectangle_impact.impulse_with_friction, law),
                    "theory 5.3",
                    name,
                    says=says,
                ),
                *RECTANGLE_BEFORE,
                *RECTANGLE_AFTER,
            )
            for name, law, says in (
                ("pfeiffer_glocker", impact.pfeiffer_glocker, PFEIFFER_GLOCKER),
                (
                    "moreau",
                    impact.moreau,
                    "Return the impulse on body 1 in an impact with "
                    "friction, by Moreau's law [N s].",
                ),
            )
        },
    },
    default_variant="frictionless",
    conditions=conditions(rectangle_impact, RECTANGLE_WHERE, RECTANGLE_BEFORE, RECTANGLE_AFTER),
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

CYLINDER_WHERE = fields(
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
)
CYLINDER_STATE = (
    *(
        of_body(body, "cylinder", cylinder_impact.cylinder, "theory 8.1",
                "centre, unit axis, radius and half length of body {} from its parameters")
        for body in (1, 2)
    ),
    Equation("cylinder_masses", cylinder_impact.cylinder_masses, "theory 8.1"),
    Equation("spatial_motion", cylinder_impact.spatial_motion, "theory 8.1"),
    Equation("cylinder_contact", cylinder_contact, "theory 8.2"),
    *CYLINDER_WHERE,
)  # fmt: skip
CYLINDER_BEFORE = (
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
)
CYLINDER_AFTER = (
    *fields(
        "spatial_impulse",
        "theory 8.1",
        impulse_normal=("normal", "the normal impulse on body 1 [N s]"),
    ),
    Equation("impulse_friction", cylinder_impact.impulse_friction, "theory 8.1"),
    *(
        Equation(f"impulse_{axis}", partial(cylinder_impact.impulse_component, place), "theory 8.1",
                 says=f"Return the impulse on body 1, {axis} [N s].")
        for place, axis in enumerate("xyz")
    ),
    Equation("spatial_motion_after", cylinder_impact.spatial_motion_after, "theory 8.1"),
    *(
        field_of(
            "spatial_motion_after", (f"{field}_{body}", place), f"{field}_{axis}_{body}_after",
            f"the {name} of body {body} after the impact, {axis} [{unit}]", "theory 8.1",
        )
        for body in (1, 2)
        for field, name, unit in (
            ("velocity", "velocity", "m s-1"),
            ("spin", "angular velocity", "rad s-1"),
        )
        for place, axis in enumerate("xyz")
    ),
    Equation("separation_normal", cylinder_impact.separation_normal, "theory 8.1"),
    Equation("sliding_after", cylinder_impact.sliding_after, "theory 8.1"),
    Equation("energy_before", cylinder_impact.energy_before, "theory 8.1"),
    Equation("energy_lost", cylinder_impact.energy_lost, "theory 8.1"),
    *(
        Equation(
            f"{gives}_{axis}", partial(function, place), "theory 8.1",
            says=f"Return the change of {says.format(axis)}.",
        )
        for gives, function, says in (
            ("momentum_residual", cylinder_impact.momentum_residual,
             "the total momentum along {} by an impact: 0 up to rounding [N s]"),
            ("angular_momentum_residual", cylinder_impact.angular_momentum_residual,
             "the angular momentum about the origin by the impact, {} [kg m2 s-1]"),
        )
        for place, axis in enumerate("xyz")
    ),
)  # fmt: skip
CYLINDER_SCENE = Scene(
    name="cylinder-pair-impact",
    title="Impact of two cylindrical parts",
    source="3.3.4",
    validity="The cylinders are rigid and homogeneous. The impact is instantaneous, and the only "
    "impulse is that of the contact. Lines of contact are solved only without friction; face on "
    "face and rim on rim are not solved. The bodies must touch where they are placed, within the "
    "contact tolerance; the program does not move them into contact.",
    variants={
        "frictionless": (
            *CYLINDER_STATE,
            Equation(
                "contact_frame",
                cylinder_impact.frame_without_friction,
                "theory 1.4, theory 8.2",
                "frictionless",
            ),
            Equation(
                "spatial_impulse",
                cylinder_impact.frictionless_impulse,
                "theory 8.1",
                "frictionless",
            ),
            *CYLINDER_BEFORE,
            *CYLINDER_AFTER,
        ),
        **{
            name: (
                *CYLINDER_STATE,
                Equation("contact_frame", cylinder_impact.frame_with_friction, "theory 8.2"),
                Equation(
                    "spatial_impulse",
                    partial(cylinder_impact.impulse_with_friction, law),
                    "theory 8.1",
                    name,
                    says=says,
                ),
                *CYLINDER_BEFORE,
                *CYLINDER_AFTER,
            )
            for name, law, says in (
                ("pfeiffer_glocker", impact.pfeiffer_glocker_in_space, PFEIFFER_GLOCKER),
                (
                    "moreau",
                    impact.moreau_in_space,
                    "Return the impulse on body 1 in an impact of "
                    "two cylinders, by Moreau's law [N s].",
                ),
            )
        },
    },
    default_variant="frictionless",
    conditions=conditions(cylinder_impact, CYLINDER_WHERE, CYLINDER_BEFORE, CYLINDER_AFTER),
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
