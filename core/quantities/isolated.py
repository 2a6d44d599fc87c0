"""An isolated part with one corner on a plane."""

from __future__ import annotations

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
