"""Isolated parts on a plane, and two bodies, 1 and 2, that collide."""

from vibrafeed.core.quantities.quantity import Quantity, acceleration, angle, force, velocity

ISOLATED: dict[str, Quantity] = {
    # --- parameters
    "pitch": angle(
        "xi", "Pitch",
        "Rotation of the part in its plane of motion; a positive angle is clockwise and lowers "
        "the right corner.",
        180.0, "20 deg",
    ),
    "pitch_rate": Quantity(
        "rad s-1", "xi.", "Pitch rate",
        "Angular velocity of the part's pitch; clockwise is positive.", parameter=True,
        examples=("2 rad/s", "-90 deg/s"),
    ),
    "centre_along": Quantity(
        "m", "x", "Centre along the plane", "Position of the part's centre along the plane.",
        parameter=True, examples=("12 mm",),
    ),
    "centre_height": Quantity(
        "m", "y", "Centre height", "Height of the part's centre above the plane.", parameter=True,
        examples=("8 mm",),
    ),
    "velocity_along": Quantity(
        "m s-1", "x.", "Velocity along the plane",
        "Velocity of the part's centre along the plane; positive to the right.", parameter=True,
        examples=("0.1 m/s",),
    ),
    "velocity_upward": Quantity(
        "m s-1", "y.", "Upward velocity", "Velocity of the part's centre away from the plane.",
        parameter=True, examples=("-0.1 m/s",),
    ),
    # --- outputs
    "corner_angle": Quantity(
        "degree", "zeta", "Corner angle", "Angle between the diagonal and the length of the part."
    ),
    "corner_direction": Quantity(
        "1", "sin, cos zeta", "Corner direction", "Sine and cosine of the corner angle.",
        bundle=True,
    ),
    "diagonal_angle": Quantity(
        "degree", "s", "Diagonal angle",
        "Angle above the plane of the line from the touching corner to the part's centre.",
    ),
    "diagonal_direction": Quantity(
        "1", "sin, cos s", "Diagonal direction", "Sine and cosine of the diagonal angle.",
        bundle=True,
    ),
    "half_diagonal": Quantity("m", "rho", "Half diagonal",
        "Distance from the part's centre to the touching corner."),
    "inertia_ratio": Quantity(
        "1", "kappa", "Inertia ratio",
        "Mass times the square of the half diagonal, divided by the moment of inertia about the "
        "part's centre.",
    ),
    "touching_height": Quantity(
        "m", "rho sin(s)", "Touching height",
        "Height of the part's centre above the plane at which the corner touches the plane."
    ),
    "pivot_velocity_along": velocity(
        "rho xi. sin(s)", "Pivot velocity along the plane",
        "Velocity along the plane that the part's centre has while the part turns about a corner "
        "at rest.",
    ),
    "pivot_velocity_upward": velocity(
        "rho xi. cos(s)", "Upward pivot velocity",
        "Upward velocity that the part's centre has while the part turns about a corner at rest.",
    ),
    "gap_normal": Quantity("m", "g_N", "Gap", "Height of the corner above the plane."),
    "gap_tangential": Quantity("m", "g_T", "Corner place",
        "Position of the corner along the plane."),
    "gap_normal_rate": velocity("g_N.", "Gap rate", "Velocity of the corner away from the plane."),
    "gap_tangential_rate": velocity(
        "g_T.", "Slip velocity", "Velocity of the corner along the plane; positive to the right."
    ),
    "gap_normal_acceleration": acceleration(
        "g_N..", "Second gap rate", "Acceleration of the corner away from the plane."
    ),
    "gap_tangential_acceleration": acceleration(
        "g_T..", "Slip acceleration",
        "Acceleration of the corner along the plane; positive to the right."
    ),
    "free_normal_acceleration": acceleration(
        "chi", "Free acceleration off the plane",
        "Acceleration that the corner would have away from the plane without a contact force.",
    ),
    "free_tangential_acceleration": acceleration(
        "-rho xi.^2 cos(s)", "Free acceleration along the plane",
        "Acceleration that the corner would have along the plane without a contact force.",
    ),
    "normal_response_right": Quantity(
        "1", "m tau", "Normal response, right slip",
        "Acceleration of the corner away from the plane, divided by the normal force per mass "
        "that causes it, while the corner slips to the right.",
    ),
    "normal_response_left": Quantity(
        "1", "m tau", "Normal response, left slip",
        "Acceleration of the corner away from the plane, divided by the normal force per mass "
        "that causes it, while the corner slips to the left.",
    ),
    "normal_response": Quantity(
        "1", "m tau", "Normal response",
        "Acceleration of the corner away from the plane, divided by the normal force per mass "
        "that causes it. It includes the friction of a corner that slips.",
    ),
    "holding_normal_acceleration": acceleration(
        "n_0", "Holding normal force per mass",
        "Normal force per mass that keeps the corner at rest; negative if the plane would have to "
        "pull.",
    ),
    "holding_tangential_acceleration": acceleration(
        "t_0", "Holding friction per mass", "Friction force per mass that keeps the corner at rest."
    ),
    "slip_direction": Quantity(
        "1", "sigma_s", "Slip direction",
        "Direction in which the corner slips or starts to slip: 1 to the right, -1 to the left, 0 "
        "if it does not slip.",
    ),
    "contact_case": Quantity(
        "1", "case", "Contact case",
        "Case of the contact: 0 separation, 1 sliding, 2 stick, 3 two solutions, 4 no solution.",
        bundle=True
    ),
    "friction_force": force(
        "lambda_T", "Friction force",
        "Friction force of the plane on the corner; positive to the right."
    ),
    "acceleration_along": acceleration(
        "x..", "Centre acceleration along the plane",
        "Acceleration of the part's centre along the plane.",
    ),
    "acceleration_upward": acceleration(
        "y..", "Upward centre acceleration",
        "Acceleration of the part's centre away from the plane."
    ),
    "pitch_acceleration": Quantity(
        "rad s-2", "xi..", "Pitch acceleration",
        "Angular acceleration of the part's pitch; clockwise is positive."
    ),
    "inverse_limiting_friction": Quantity(
        "1", "1/mu_c", "Inverse limiting friction",
        "Inverse of the limiting friction coefficient for slip to the right; its negative is the "
        "inverse for slip to the left. If the value is not positive, there is no limiting "
        "friction.",
    ),
    "limiting_friction_right": Quantity(
        "1", "mu_c", "Limiting friction, right slip",
        "Least coefficient of kinetic friction at which a slip of the corner to the right may "
        "have two solutions or none.",
    ),
    "limiting_friction_left": Quantity(
        "1", "mu_c", "Limiting friction, left slip",
        "Least coefficient of kinetic friction at which a slip of the corner to the left may have "
        "two solutions or none.",
    ),
    "least_limiting_friction": Quantity(
        "1", "mu_min", "Least limiting friction",
        "Least limiting friction over all pitches; with less friction every contact has exactly "
        "one solution.",
    ),
    "least_limiting_pitch": Quantity(
        "degree", "xi_min", "Pitch of the least limiting friction",
        "Pitch at which the limiting friction for slip to the right is least.",
    ),
    "impact_impulse_normal": Quantity(
        "N s", "Lambda_N", "Normal impulse without collision",
        "Normal impulse that ends a slip if no contact force satisfies the model; otherwise 0.",
    ),
    "impact_impulse_tangential": Quantity(
        "N s", "Lambda_T", "Friction impulse without collision",
        "Friction impulse that ends a slip if no contact force satisfies the model; otherwise 0.",
    ),
}  # fmt: skip


def _quantities_of_body(body: str) -> dict[str, Quantity]:
    def quantity(unit: str, symbol: str, label: str, description: str, example: str) -> Quantity:
        return Quantity(
            unit, f"{symbol}{body}", f"{label}, body {body}", description.format(body),
            parameter=True, examples=(example,),
        )  # fmt: skip

    def size(unit: str, symbol: str, label: str, description: str, example: str) -> Quantity:
        return Quantity(
            unit, f"{symbol}{body}", f"{label}, body {body}", description.format(body), 0.0,
            strict=True, parameter=True, examples=(example,),
        )  # fmt: skip

    parameters = {
        f"position_x_{body}": quantity(
            "m", "x", "Position x", "Position of the centre of body {} along x.", "5 mm"
        ),
        f"position_y_{body}": quantity(
            "m", "y", "Position y", "Position of the centre of body {} along y.", "5 mm"
        ),
        f"angle_{body}": quantity(
            "degree", "th", "Angle",
            "Angle from +x to the lengthwise direction of body {}, positive towards +y.",
            "30 deg",
        ),
        f"velocity_x_{body}": quantity(
            "m s-1", "vx", "Velocity x", "Velocity of body {} along x before the impact.", "0.2 m/s"
        ),
        f"velocity_y_{body}": quantity(
            "m s-1", "vy", "Velocity y", "Velocity of body {} along y before the impact.", "0.2 m/s"
        ),
        f"spin_{body}": quantity(
            "rad s-1", "w", "Spin",
            "Angular velocity of body {} before the impact, positive from +x towards +y.",
            "3 rad/s",
        ),
        f"position_z_{body}": quantity(
            "m", "z", "Position z", "Position of the centre of body {} along z.", "5 mm"
        ),
        f"azimuth_{body}": quantity(
            "degree", "az", "Azimuth of the axis",
            "Angle in the floor plane from +x to the axis of body {}, positive towards +y.",
            "30 deg",
        ),
        f"elevation_{body}": quantity(
            "degree", "el", "Elevation of the axis",
            "Angle of the axis of body {} above the floor plane.", "10 deg",
        ),
        f"velocity_z_{body}": quantity(
            "m s-1", "vz", "Velocity z", "Velocity of body {} along z before the impact.", "0.2 m/s"
        ),
        f"spin_x_{body}": quantity(
            "rad s-1", "wx", "Spin x", "Angular velocity of body {} about x before the impact.",
            "3 rad/s",
        ),
        f"spin_y_{body}": quantity(
            "rad s-1", "wy", "Spin y", "Angular velocity of body {} about y before the impact.",
            "3 rad/s",
        ),
        f"spin_z_{body}": quantity(
            "rad s-1", "wz", "Spin z", "Angular velocity of body {} about z before the impact.",
            "3 rad/s",
        ),
        f"diameter_{body}": size("m", "d", "Diameter", "Diameter of body {}.", "8 mm"),
        f"length_{body}": size("m", "h", "Length", "Length of body {}.", "20 mm"),
        f"width_{body}": size("m", "a", "Width", "Width of body {}.", "10 mm"),
        f"mass_{body}": size("kg", "m", "Mass", "Mass of body {}.", "5 g"),
    }  # fmt: skip
    results = {
        f"inertia_{body}": Quantity(
            "kg m2", f"I{body}", f"Moment of inertia, body {body}",
            f"Moment of inertia of body {body} about the floor normal through its centre.",
        ),
        f"velocity_x_{body}_after": velocity(
            f"vx{body}'", f"Velocity x after, body {body}",
            f"Velocity of body {body} along x after the impact.",
        ),
        f"velocity_y_{body}_after": velocity(
            f"vy{body}'", f"Velocity y after, body {body}",
            f"Velocity of body {body} along y after the impact.",
        ),
        f"velocity_z_{body}_after": velocity(
            f"vz{body}'", f"Velocity z after, body {body}",
            f"Velocity of body {body} along z after the impact.",
        ),
        **{
            f"spin_{axis}_{body}_after": Quantity(
                "rad s-1", f"w{axis}{body}'", f"Spin {axis} after, body {body}",
                f"Angular velocity of body {body} about {axis} after the impact.",
            )
            for axis in "xyz"
        },
        f"spin_{body}_after": Quantity(
            "rad s-1", f"w{body}'", f"Spin after, body {body}",
            f"Angular velocity of body {body} after the impact, positive from +x towards +y.",
        ),
    }  # fmt: skip
    return {**parameters, **results}


BOTH: dict[str, Quantity] = {
    "contact_tolerance": Quantity(
        "1", "g_tol/size", "Contact tolerance",
        "Largest gap or overlap at which the bodies count as touching, as a share of their size "
        "(the sum of their half diagonals). With 1, the impact happens wherever the bodies are "
        "placed.", 0.0,
        parameter=True, examples=("1e-6",),
    ),
    "gap": Quantity(
        "m", "g_N", "Gap",
        "Distance between the nearest points of the two bodies; negative if the bodies overlap.",
    ),
    "face_body": Quantity(
        "1", "C", "Body with the face", "Number of the body whose face is touched, 1 or 2."
    ),
    "contact_corner": Quantity(
        "1", "A", "Touching corner",
        "Number of the corner that touches the face of the other body: 1 to 4, counterclockwise "
        "from the corner at +length/2, +width/2; 0 if an edge lies on the face.",
    ),
    "contact_x": Quantity("m", "P_x", "Contact point, x",
        "Position along x of the point where the impulse acts."),
    "contact_y": Quantity("m", "P_y", "Contact point, y",
        "Position along y of the point where the impulse acts."),
    "normal_x": Quantity("1", "n_x", "Normal, x",
        "Component along x of the unit normal from body 2 to body 1."),
    "normal_y": Quantity("1", "n_y", "Normal, y",
        "Component along y of the unit normal from body 2 to body 1."),
    "contact_form": Quantity(
        "1", "form", "Contact form",
        "Form of the contact: 0 none of these forms, 1 rim on face, 2 rim on side, 3 face on "
        "face, 4 side on side, 5 side on face.",
        words={
            0: "no form", 1: "rim on face", 2: "rim on side", 3: "face on face",
            4: "side on side", 5: "side on face",
        }, other_words="{}",
    ),
    "contact_z": Quantity("m", "P_z", "Contact point, z",
        "Position along z of the point where the impulse acts."),
    "normal_z": Quantity("1", "n_z", "Normal, z",
        "Component along z of the unit normal from body 2 to body 1."),
    "sliding_before": velocity(
        "|u_T|", "Sliding velocity before",
        "Speed at which the bodies slide on each other at the contact, before the impact."
    ),
    "sliding_after": velocity(
        "|u_T'|", "Sliding velocity after",
        "Speed at which the bodies slide on each other at the contact, after the impact."
    ),
    "impulse_friction": Quantity(
        "N s", "|Lambda_T|", "Impulse of friction",
        "Magnitude of the impulse of friction, tangential to the contact."
    ),
    "impulse_x": Quantity("N s", "Lambda_x", "Impulse, x",
        "Component along x of the impulse on body 1."),
    "impulse_y": Quantity("N s", "Lambda_y", "Impulse, y",
        "Component along y of the impulse on body 1."),
    "impulse_z": Quantity("N s", "Lambda_z", "Impulse, z",
        "Component along z of the impulse on body 1."),
    "momentum_residual_z": Quantity(
        "N s", "dp_z", "Residual of the momentum, z",
        "Change of the total linear momentum along z in the impact; 0 except for rounding.",
    ),
    "angular_momentum_residual_x": Quantity(
        "kg m2 s-1", "dL_x", "Residual of the angular momentum, x",
        "Change of the total angular momentum about the x axis in the impact; 0 except for "
        "rounding.",
    ),
    "angular_momentum_residual_y": Quantity(
        "kg m2 s-1", "dL_y", "Residual of the angular momentum, y",
        "Change of the total angular momentum about the y axis in the impact; 0 except for "
        "rounding.",
    ),
    "angular_momentum_residual_z": Quantity(
        "kg m2 s-1", "dL_z", "Residual of the angular momentum, z",
        "Change of the total angular momentum about the z axis in the impact; 0 except for "
        "rounding.",
    ),
    "delassus_normal": Quantity(
        "kg-1", "G_NN", "Delassus number, normal",
        "Relative normal velocity at the contact that a unit normal impulse causes.",
    ),
    "delassus_coupling": Quantity(
        "kg-1", "G_NT", "Delassus number, coupling",
        "Relative tangential velocity at the contact that a unit normal impulse causes.",
    ),
    "delassus_tangential": Quantity(
        "kg-1", "G_TT", "Delassus number, tangential",
        "Relative tangential velocity at the contact that a unit tangential impulse causes.",
    ),
    "approach_normal": velocity(
        "u_N", "Normal velocity before",
        "Velocity of body 1 away from body 2 at the contact, before the impact; negative if the "
        "bodies approach each other.",
    ),
    "approach_tangential": velocity(
        "u_T", "Tangential velocity before",
        "Velocity of body 1 along the contact, relative to body 2, before the impact.",
    ),
    "separation_normal": velocity(
        "u_N'", "Normal velocity after",
        "Velocity of body 1 away from body 2 at the contact, after the impact.",
    ),
    "separation_tangential": velocity(
        "u_T'", "Tangential velocity after",
        "Velocity of body 1 along the contact, relative to body 2, after the impact.",
    ),
    "impulse_normal": Quantity(
        "N s", "Lambda_N", "Normal impulse", "Impulse on body 1 along the normal of the contact."
    ),
    "impulse_tangential": Quantity(
        "N s", "Lambda_T", "Tangential impulse",
        "Impulse of friction on body 1, along the normal of the contact turned by +90 degrees.",
    ),
    "energy_before": Quantity(
        "J", "T_A", "Energy before", "Kinetic energy of both bodies before the impact."
    ),
    "energy_lost": Quantity(
        "J", "T_A - T_E", "Energy lost", "Kinetic energy that both bodies lose in the impact."
    ),
    "momentum_residual_x": Quantity(
        "N s", "dp_x", "Residual of the momentum, x",
        "Change of the total linear momentum along x in the impact; 0 except for rounding.",
    ),
    "momentum_residual_y": Quantity(
        "N s", "dp_y", "Residual of the momentum, y",
        "Change of the total linear momentum along y in the impact; 0 except for rounding.",
    ),
    "angular_momentum_residual": Quantity(
        "kg m2 s-1", "dL_z", "Residual of the angular momentum",
        "Change of the total angular momentum about the origin in the impact; 0 except for "
        "rounding.",
    ),
}  # fmt: skip
BUNDLES = {
    name: Quantity("1", "", label, description, bundle=True)
    for name, label, description in (
        ("rectangle_1", "Rectangle 1", "Centre, angle, length and width of the rectangle."),
        ("rectangle_2", "Rectangle 2", "Centre, angle, length and width of the rectangle."),
        ("rectangle_masses", "Masses", "Masses and moments of inertia of both bodies."),
        (
            "planar_motion",
            "Planar motion before",
            "All six velocities of both bodies before the impact.",
        ),
        (
            "rectangle_contact",
            "Contact of two rectangles",
            "Gap, normal and ends of the contact of two rectangles.",
        ),
        ("contact_arms", "Lever arms", "Moments of unit impulses at the contact."),
        ("edge_action", "Action on an edge", "Point on a touching edge at which the impulse acts."),
        (
            "planar_impulse",
            "Planar impulse",
            "Normal and tangential impulse, with a flag for a contact that sticks.",
        ),
        (
            "planar_motion_after",
            "Planar motion after",
            "All six velocities of both bodies after the impact.",
        ),
        ("cylinder_1", "Cylinder 1", "Centre, axis, radius and half length of the cylinder."),
        ("cylinder_2", "Cylinder 2", "Centre, axis, radius and half length of the cylinder."),
        ("cylinder_masses", "Masses", "Masses and moments of inertia of both bodies."),
        ("spatial_motion", "Motion before", "Velocities and spins of both bodies."),
        (
            "cylinder_contact",
            "Contact of two cylinders",
            "Gap, form, normal and ends of the contact of two cylinders.",
        ),
        ("contact_frame", "Contact frame", "Contact point, normal and two tangents."),
        (
            "spatial_delassus",
            "Delassus numbers in space",
            "The six Delassus numbers of a contact in space.",
        ),
        (
            "spatial_approach",
            "Contact velocity before",
            "Velocity of the contact before the impact: components along "
            "the normal and the tangents.",
        ),
        (
            "spatial_impulse",
            "Impulse in space",
            "Components of the impulse, with a flag for a contact that sticks.",
        ),
        ("spatial_motion_after", "Motion after", "Velocities and spins after the impact."),
    )
}

IMPACTS = {**_quantities_of_body("1"), **_quantities_of_body("2"), **BOTH, **BUNDLES}
