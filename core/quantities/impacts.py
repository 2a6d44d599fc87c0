"""Isolated parts on a plane, and two bodies, 1 and 2, that collide."""

from vibrafeed.core.quantities.quantity import Quantity, acceleration, angle, force, velocity

ISOLATED: dict[str, Quantity] = {
    # --- parameters
    "pitch": angle(
        "xi", "Pitch", "Turn of the part in its plane of motion, clockwise: its right corner dips.",
        180.0, "20 deg",
    ),
    "pitch_rate": Quantity(
        "rad s-1", "xi.", "Pitch rate", "Rate of the pitch, clockwise.", parameter=True,
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
        "Velocity of the part's centre along the plane, to the right.", parameter=True,
        examples=("0.1 m/s",),
    ),
    "velocity_upward": Quantity(
        "m s-1", "y.", "Upward velocity", "Velocity of the part's centre off the plane.",
        parameter=True, examples=("-0.1 m/s",),
    ),
    # --- outputs
    "corner_angle": Quantity(
        "degree", "zeta", "Corner angle", "Angle between the part's diagonal and its length."
    ),
    "corner_direction": Quantity(
        "1", "sin, cos zeta", "Corner direction", "Sine and cosine of the corner angle.",
        bundle=True,
    ),
    "diagonal_angle": Quantity(
        "degree", "s", "Diagonal angle",
        "Angle above the plane of the line from the touching corner to the centre.",
    ),
    "diagonal_direction": Quantity(
        "1", "sin, cos s", "Diagonal direction", "Sine and cosine of the diagonal angle.",
        bundle=True,
    ),
    "half_diagonal": Quantity("m", "rho", "Half diagonal", "Distance from the centre to the "
    "corner."),
    "inertia_ratio": Quantity(
        "1", "kappa", "Inertia ratio",
        "Mass times squared half diagonal over the moment of inertia about the centre.",
    ),
    "touching_height": Quantity(
        "m", "rho sin(s)", "Touching height", "Height of the centre at which the corner touches."
    ),
    "pivot_velocity_along": velocity(
        "rho xi. sin(s)", "Pivot velocity along the plane",
        "Velocity of the centre along the plane at which the corner is at rest.",
    ),
    "pivot_velocity_upward": velocity(
        "rho xi. cos(s)", "Upward pivot velocity",
        "Upward velocity of the centre at which the corner keeps its height.",
    ),
    "gap_normal": Quantity("m", "g_N", "Gap", "Height of the corner above the plane."),
    "gap_tangential": Quantity("m", "g_T", "Corner place", "Position of the corner along the "
    "plane."),
    "gap_normal_rate": velocity("g_N.", "Gap rate", "Velocity of the corner off the plane."),
    "gap_tangential_rate": velocity(
        "g_T.", "Slip velocity", "Velocity of the corner along the plane, to the right."
    ),
    "gap_normal_acceleration": acceleration(
        "g_N..", "Second gap rate", "Acceleration of the corner off the plane."
    ),
    "gap_tangential_acceleration": acceleration(
        "g_T..", "Slip acceleration", "Acceleration of the corner along the plane."
    ),
    "free_normal_acceleration": acceleration(
        "chi", "Free acceleration off the plane",
        "Acceleration of the corner off the plane without contact force.",
    ),
    "free_tangential_acceleration": acceleration(
        "-rho xi.^2 cos(s)", "Free acceleration along the plane",
        "Acceleration of the corner along the plane without contact force.",
    ),
    "normal_response_right": Quantity(
        "1", "m tau", "Normal response, right slip",
        "Acceleration of the corner off the plane per normal force per mass, in slip to the right.",
    ),
    "normal_response_left": Quantity(
        "1", "m tau", "Normal response, left slip",
        "Acceleration of the corner off the plane per normal force per mass, in slip to the left.",
    ),
    "normal_response": Quantity(
        "1", "m tau", "Normal response",
        "Acceleration of the corner off the plane per normal force per mass, in the slip direction "
        "of the cell; that without friction where nothing slips.",
    ),
    "holding_normal_acceleration": acceleration(
        "n_0", "Holding normal force per mass",
        "Normal force per mass that keeps the corner at rest; negative where it had to pull.",
    ),
    "holding_tangential_acceleration": acceleration(
        "t_0", "Holding friction per mass", "Friction force per mass that keeps the corner at rest."
    ),
    "slip_direction": Quantity(
        "1", "sigma_s", "Slip direction",
        "1 where the corner slips, or starts to slip, to the right, -1 to the left, else 0.",
    ),
    "contact_case": Quantity(
        "1", "case", "Contact case", "Number of the case of the contact.", bundle=True
    ),
    "friction_force": force(
        "lambda_T", "Friction force", "Friction force of the plane on the corner, to the right."
    ),
    "acceleration_along": acceleration(
        "x..", "Centre acceleration along the plane",
        "Acceleration of the part's centre along the plane.",
    ),
    "acceleration_upward": acceleration(
        "y..", "Upward centre acceleration", "Acceleration of the part's centre off the plane."
    ),
    "pitch_acceleration": Quantity(
        "rad s-2", "xi..", "Pitch acceleration", "Second rate of the pitch, clockwise."
    ),
    "inverse_limiting_friction": Quantity(
        "1", "1/mu_c", "Inverse limiting friction",
        "Inverse of the friction at which slip to the right loses its only solution; for slip to "
        "the left its negative. Not positive where there is none.",
    ),
    "limiting_friction_right": Quantity(
        "1", "mu_c", "Limiting friction, right slip",
        "Least kinetic friction at which slip to the right may have two solutions or none.",
    ),
    "limiting_friction_left": Quantity(
        "1", "mu_c", "Limiting friction, left slip",
        "Least kinetic friction at which slip to the left may have two solutions or none.",
    ),
    "least_limiting_friction": Quantity(
        "1", "mu_min", "Least limiting friction",
        "Least limiting friction over all pitches; below it every contact has one solution.",
    ),
    "least_limiting_pitch": Quantity(
        "degree", "xi_min", "Pitch of the least limiting friction",
        "Pitch at which the limiting friction of slip to the right is least.",
    ),
    "impact_impulse_normal": Quantity(
        "N s", "Lambda_N", "Normal impulse without collision",
        "Normal impulse that ends a slip for which no force is a solution; else 0.",
    ),
    "impact_impulse_tangential": Quantity(
        "N s", "Lambda_T", "Friction impulse without collision",
        "Friction impulse that ends a slip for which no force is a solution; else 0.",
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
            "m", "x", "Position x", "Centre of body {}, x.", "5 mm"
        ),
        f"position_y_{body}": quantity(
            "m", "y", "Position y", "Centre of body {}, y.", "5 mm"
        ),
        f"angle_{body}": quantity(
            "degree", "th", "Angle", "Angle of the length of body {}, from +x towards +y.",
            "30 deg",
        ),
        f"velocity_x_{body}": quantity(
            "m s-1", "vx", "Velocity x", "Velocity of body {} before the impact, x.", "0.2 m/s"
        ),
        f"velocity_y_{body}": quantity(
            "m s-1", "vy", "Velocity y", "Velocity of body {} before the impact, y.", "0.2 m/s"
        ),
        f"spin_{body}": quantity(
            "rad s-1", "w", "Spin",
            "Angular velocity of body {} before the impact, from +x towards +y.", "3 rad/s",
        ),
        f"position_z_{body}": quantity(
            "m", "z", "Position z", "Centre of body {}, z.", "5 mm"
        ),
        f"azimuth_{body}": quantity(
            "degree", "az", "Azimuth of the axis",
            "Angle of the axis of body {} in the floor plane, from +x towards +y.", "30 deg",
        ),
        f"elevation_{body}": quantity(
            "degree", "el", "Elevation of the axis",
            "Angle of the axis of body {} above the floor plane.", "10 deg",
        ),
        f"velocity_z_{body}": quantity(
            "m s-1", "vz", "Velocity z", "Velocity of body {} before the impact, z.", "0.2 m/s"
        ),
        f"spin_x_{body}": quantity(
            "rad s-1", "wx", "Spin x", "Angular velocity of body {} before the impact, x.",
            "3 rad/s",
        ),
        f"spin_y_{body}": quantity(
            "rad s-1", "wy", "Spin y", "Angular velocity of body {} before the impact, y.",
            "3 rad/s",
        ),
        f"spin_z_{body}": quantity(
            "rad s-1", "wz", "Spin z", "Angular velocity of body {} before the impact, z.",
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
            f"Moment of inertia of body {body} about its centre, normal to the floor.",
        ),
        f"velocity_x_{body}_after": velocity(
            f"vx{body}'", f"Velocity x after, body {body}",
            f"Velocity of body {body} after the impact, x.",
        ),
        f"velocity_y_{body}_after": velocity(
            f"vy{body}'", f"Velocity y after, body {body}",
            f"Velocity of body {body} after the impact, y.",
        ),
        f"velocity_z_{body}_after": velocity(
            f"vz{body}'", f"Velocity z after, body {body}",
            f"Velocity of body {body} after the impact, z.",
        ),
        **{
            f"spin_{axis}_{body}_after": Quantity(
                "rad s-1", f"w{axis}{body}'", f"Spin {axis} after, body {body}",
                f"Angular velocity of body {body} after the impact, {axis}.",
            )
            for axis in "xyz"
        },
        f"spin_{body}_after": Quantity(
            "rad s-1", f"w{body}'", f"Spin after, body {body}",
            f"Angular velocity of body {body} after the impact, from +x towards +y.",
        ),
    }  # fmt: skip
    return {**parameters, **results}


BOTH: dict[str, Quantity] = {
    "contact_tolerance": Quantity(
        "1", "g_tol/size", "Contact tolerance",
        "Largest gap or overlap that counts as touching, as a share of the bodies' size, the "
        "sum of their half diagonals. 1 lets the impact happen as the bodies are placed.", 0.0,
        parameter=True, examples=("1e-6",),
    ),
    "gap": Quantity(
        "m", "g_N", "Gap",
        "Distance of the bodies where they are nearest to each other; negative in overlap.",
    ),
    "face_body": Quantity(
        "1", "C", "Body with the face", "The body whose face is touched, 1 or 2."
    ),
    "contact_corner": Quantity(
        "1", "A", "Touching corner",
        "The corner of the other body, 1 to 4 counterclockwise from the one at +length/2, "
        "+width/2; 0 where an edge lies on the face.",
    ),
    "contact_x": Quantity("m", "P_x", "Contact point, x", "Point where the impulse acts, x."),
    "contact_y": Quantity("m", "P_y", "Contact point, y", "Point where the impulse acts, y."),
    "normal_x": Quantity("1", "n_x", "Normal, x", "Unit normal from body 2 to body 1, x."),
    "normal_y": Quantity("1", "n_y", "Normal, y", "Unit normal from body 2 to body 1, y."),
    "contact_form": Quantity(
        "1", "form", "Contact form",
        "Form of contact: 0 none of these, 1 rim on face, 2 rim on "
        "side, 3 face on face, 4 side on side, "
        "5 side on face.",
        words={
            0: "no form", 1: "rim on face", 2: "rim on side", 3: "face on face",
            4: "side on side", 5: "side on face",
        }, other_words="{}",
    ),
    "contact_z": Quantity("m", "P_z", "Contact point, z", "Point where the impulse acts, z."),
    "normal_z": Quantity("1", "n_z", "Normal, z", "Unit normal from body 2 to body 1, z."),
    "sliding_before": velocity(
        "|u_T|", "Sliding velocity before", "Speed of sliding at the contact, before."
    ),
    "sliding_after": velocity(
        "|u_T'|", "Sliding velocity after", "Speed of sliding at the contact, after."
    ),
    "impulse_friction": Quantity(
        "N s", "|Lambda_T|", "Impulse of friction", "Magnitude of the tangential impulse."
    ),
    "impulse_x": Quantity("N s", "Lambda_x", "Impulse, x", "Impulse on body 1, x."),
    "impulse_y": Quantity("N s", "Lambda_y", "Impulse, y", "Impulse on body 1, y."),
    "impulse_z": Quantity("N s", "Lambda_z", "Impulse, z", "Impulse on body 1, z."),
    "momentum_residual_z": Quantity(
        "N s", "dp_z", "Residual of the momentum, z",
        "Linear momentum after less before; 0 up to rounding.",
    ),
    "angular_momentum_residual_x": Quantity(
        "kg m2 s-1", "dL_x", "Residual of the angular momentum, x",
        "Angular momentum about the origin, after less before; 0 up to rounding.",
    ),
    "angular_momentum_residual_y": Quantity(
        "kg m2 s-1", "dL_y", "Residual of the angular momentum, y",
        "Angular momentum about the origin, after less before; 0 up to rounding.",
    ),
    "angular_momentum_residual_z": Quantity(
        "kg m2 s-1", "dL_z", "Residual of the angular momentum, z",
        "Angular momentum about the origin, after less before; 0 up to rounding.",
    ),
    "delassus_normal": Quantity(
        "kg-1", "G_NN", "Delassus number, normal", "Normal velocity that a unit normal impulse "
        "gives.",
    ),
    "delassus_coupling": Quantity(
        "kg-1", "G_NT", "Delassus number, coupling",
        "Tangential velocity that a unit normal impulse gives.",
    ),
    "delassus_tangential": Quantity(
        "kg-1", "G_TT", "Delassus number, tangential",
        "Tangential velocity that a unit tangential impulse gives.",
    ),
    "approach_normal": velocity(
        "u_N", "Normal velocity before", "Velocity of body 1 off body 2 at the contact, before "
        "the impact; negative where they approach.",
    ),
    "approach_tangential": velocity(
        "u_T", "Tangential velocity before",
        "Velocity of body 1 along the contact, relative to body 2, before the impact.",
    ),
    "separation_normal": velocity(
        "u_N'", "Normal velocity after",
        "Velocity of body 1 off body 2 at the contact, after the impact.",
    ),
    "separation_tangential": velocity(
        "u_T'", "Tangential velocity after",
        "Velocity of body 1 along the contact, relative to body 2, after the impact.",
    ),
    "impulse_normal": Quantity(
        "N s", "Lambda_N", "Normal impulse", "Impulse on body 1 along the normal."
    ),
    "impulse_tangential": Quantity(
        "N s", "Lambda_T", "Tangential impulse",
        "Impulse of friction on body 1, along the normal turned by +90 degrees.",
    ),
    "energy_before": Quantity(
        "J", "T_A", "Energy before", "Kinetic energy of both bodies before the impact."
    ),
    "energy_lost": Quantity(
        "J", "T_A - T_E", "Energy lost", "Kinetic energy that the impact takes away."
    ),
    "momentum_residual_x": Quantity(
        "N s", "dp_x", "Residual of the momentum, x",
        "Linear momentum after less before; 0 up to rounding.",
    ),
    "momentum_residual_y": Quantity(
        "N s", "dp_y", "Residual of the momentum, y",
        "Linear momentum after less before; 0 up to rounding.",
    ),
    "angular_momentum_residual": Quantity(
        "kg m2 s-1", "dL_z", "Residual of the angular momentum",
        "Angular momentum about the origin, after less before; 0 up to rounding.",
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
            "Normal and tangential impulse, with a flag that says if the contact sticks.",
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
            "Impulse components, with a flag that says if the contact sticks.",
        ),
        ("spatial_motion_after", "Motion after", "Velocities and spins after the impact."),
    )
}

IMPACTS = {**_quantities_of_body("1"), **_quantities_of_body("2"), **BOTH, **BUNDLES}
