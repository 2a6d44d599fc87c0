"""Rolling cylinders, balls, rollers, discs and cones."""

from vibrafeed.core.quantities.quantity import (
    Quantity,
    acceleration,
    angle,
    force,
    length,
    number,
    velocity,
)


def _screw(name: str, label: str, what: str) -> dict[str, Quantity]:
    pitch = Quantity(
        "m",
        "p",
        f"{label}, pitch",
        f"Pitch of the wrench of {what}: its moment along the wrench axis divided by its force.",
    )
    point = {
        f"{name}_axis_{direction}": Quantity(
            "m", f"r_{symbol}", f"{label}, axis point, {symbol}",
            f"Component along +{symbol} of the vector from the part's centre to the nearest point "
            f"of the wrench axis of {what}.",
        )
        for direction, symbol in (("normal", "n"), ("rolling", "eta"), ("axial", "sigma"))
    }  # fmt: skip
    return {f"{name}_pitch": pitch, **point}


ROLLING: dict[str, Quantity] = {
    "axis_yaw": angle(
        "theta", "Yaw of the cylinder's axis",
        "Angle by which the axis of the rolling cylinder is turned in the plane of the floor, "
        "from +x towards -y (clockwise seen from above), as in chapter 4 of the thesis.",
        180.0, "30 deg",
    ),
    "spin_rate": Quantity(
        "rad s-1", "phi.", "Spin rate",
        "Angular velocity of the rolling cylinder about its axis; a positive value rolls it along "
        "+eta.",
        parameter=True, examples=("40 rad/s", "400 rpm"),
    ),
    "yaw_rate": Quantity(
        "rad s-1", "theta.", "Yaw rate",
        "Angular velocity of the rolling cylinder about the vertical; positive in the direction "
        "of axis_yaw.",
        parameter=True, examples=("2 rad/s",),
    ),
    "drilling_moment": Quantity(
        "N m", "M_z", "Drilling moment",
        "Moment of the floor's friction about the vertical through the centre of the cylinder; "
        "positive in the direction of axis_yaw.", parameter=True, examples=("0.1 mN m",),
    ),
    "rolling_drive": acceleration(
        "D_eta", "Drive in rolling direction",
        "Peak drive acceleration along +eta, which is horizontal and normal to the cylinder's "
        "axis.",
    ),
    "axial_drive": acceleration(
        "D_sigma", "Drive along the axis",
        "Peak drive acceleration along +sigma, the axis of the cylinder.",
    ),
    "axial_friction_acceleration": acceleration(
        "F_sigma/m", "Axial friction per mass",
        "Friction force per mass along the cylinder's axis that pure rolling requires; a positive "
        "value acts along -sigma.",
    ),
    "rolling_friction": force(
        "F_eta", "Friction in rolling direction",
        "Friction force in the rolling direction that pure rolling requires; a positive value "
        "acts along -eta.",
    ),
    "axial_friction": force(
        "F_sigma", "Friction along the axis",
        "Friction force along the cylinder's axis that pure rolling requires; a positive value "
        "acts along -sigma.",
    ),
    "spin_acceleration": Quantity(
        "rad s-2", "phi..", "Spin acceleration",
        "Angular acceleration of the cylinder about its axis in pure rolling.",
    ),
    "yaw_acceleration": Quantity(
        "rad s-2", "theta..", "Yaw acceleration",
        "Angular acceleration of the cylinder about the vertical; 0 without a drilling moment.",
    ),
    "printed_yaw_rate": Quantity(
        "rad s-1", "theta. (4.20)", "Yaw rate as printed",
        "Yaw rate by equation (4.20) of the thesis, with the floor's resultant force at "
        "mid-length. It is for comparison only, because it contradicts (4.18) and (4.19) of the "
        "thesis.",
    ),
    "pressure_offset_axial": Quantity(
        "m", "e", "Centre of pressure, axial",
        "Distance along +sigma from the middle of the cylinder to the point where the floor's "
        "normal force acts.",
    ),
    "required_friction": Quantity(
        "1", "mu_req", "Required friction coefficient",
        "Least coefficient of static friction with which the round part rolls without slip.",
    ),
    "cone_margin": force(
        "mu_s N - |F|", "Margin in the friction cone",
        "Limit of static friction minus the friction force that pure rolling requires; negative "
        "if the cylinder slips.",
    ),
    "floor_wrench": Quantity(
        "1", "(F, M)", "Floor wrench",
        "Force [N] of the floor on the part and its moment [N m] about the part's centre, in the "
        "axes n, eta and sigma.",
        bundle=True,
    ),
    "floor_reduction": Quantity(
        "1", "(p, r)", "Floor wrench, reduced", "Pitch and axis of the floor wrench.", bundle=True
    ),
    "force_wrench": Quantity(
        "1", "(F, M)", "Wrench of the force system",
        "Resultant force [N] of drive, gravity and floor, and its moment [N m] about the part's "
        "centre, in the axes n, eta and sigma.", bundle=True,
    ),
    "force_reduction": Quantity(
        "1", "(p, r)", "Wrench of the force system, reduced",
        "Pitch and axis of the wrench of drive, gravity and floor.", bundle=True,
    ),
    **_screw("floor", "Floor wrench", "the floor's forces"),
    **_screw("force", "Force system", "drive, gravity and floor together"),
}  # fmt: skip


ROUND_PARTS: dict[str, Quantity] = {
    "inner_diameter": Quantity(
        "m", "d_i", "Inner diameter",
        "Inner diameter of a tube, a ring or a hollow ball; equal to the diameter for a hoop or a "
        "thin shell.",
        0.0, parameter=True, examples=("6 mm",), usual=(1e-5, 5.0),
    ),
    "rolling_factor": Quantity(
        "1", "kap", "Rolling factor",
        "Ratio m r^2/I about the rolling axis: 5/2 for a solid ball, 3/2 for a thin shell, 2 for "
        "a cylinder or disc, 1 for a hoop. By default it follows from the diameters.",
        0.0, strict=True, parameter=True, examples=("2.5",),
    ),
    "rolling_share": number(
        "kap/(1+kap)", "Rolling share",
        "Acceleration of a rolling part divided by the push on it (drive minus gravity)."
    ),
    "moved_fraction": number(
        "|a|/|D|", "Moved fraction",
        "Acceleration of the ball's centre divided by the push on the ball (drive minus gravity)."
    ),
    "push_across_axis": acceleration(
        "D_eta", "Push across the axis",
        "Peak drive acceleration minus gravity in the plane of the floor, in the rolling "
        "direction.",
    ),
    "push_along_axis": acceleration(
        "D_sigma", "Push along the axis",
        "Peak drive acceleration minus gravity in the plane of the floor, along the axis or the "
        "line of contact.",
    ),
    "axial_acceleration": acceleration(
        "a_sigma", "Acceleration along the axis",
        "Acceleration of the part's centre along the axis of the part."
    ),
    "rolling_acceleration": acceleration(
        "a_eta", "Acceleration across the axis",
        "Acceleration of the part's centre in the rolling direction, normal to the axis or the "
        "line of contact.",
    ),
    "cone_half_angle": Quantity(
        "degree", "a", "Half angle of the cone", "Angle between the side of the cone and its axis."
    ),
    "centre_radius": Quantity(
        "m", "rho", "Radius at the centre", "Radius of the cone at its centre of mass."
    ),
    "axial_gyration": Quantity(
        "m", "k_a", "Gyration about the axis", "Radius of gyration of the cone about its axis."
    ),
    "cone_factor": number(
        "F", "Factor of the cone",
        "Acceleration of a rolling cone's centre divided by the push on the cone (drive minus "
        "gravity)."
    ),
    "turning_acceleration": Quantity(
        "rad s-2", "", "Turning acceleration",
        "Angular acceleration of a rolling cone about the vertical through its apex.",
    ),
    "net_push": acceleration(
        "D - w", "Net push",
        "Peak drive acceleration minus gravity along the track, reduced by the friction of the "
        "wall."
    ),
    "wall_drag": force(
        "m w", "Wall drag",
        "Friction force of the wall on the disc; a positive value acts along -x."
    ),
    # --- contacts that give
    "restitution_speed": Quantity(
        "m s-1", "v_e", "Speed of the restitution",
        "Impact speed at which the coefficient of restitution was measured.", 0.0, strict=True,
        parameter=True, examples=("0.1 m/s",), usual=(1e-3, 20.0),
    ),
    "impact_speed": Quantity(
        "m s-1", "v", "Impact speed",
        "Speed of approach normal to the contact, just before the impact.", 0.0,
        strict=True, parameter=True, examples=("0.2 m/s",), usual=(1e-4, 20.0),
    ),
    "contact_damping_ratio": Quantity(
        "1", "zeta", "Damping ratio of the contact",
        "Damping ratio of a contact that is modelled as a spring and a damper that never pull.",
        0.0, parameter=True,
        examples=("0.2",),
    ),
    "lining_stiffness": Quantity(
        "N m-1", "k", "Stiffness of the lining",
        "Force on a part divided by the depth to which it sinks into the lining of a track, such "
        "as brush or urethane.", 0.0,
        strict=True, parameter=True, examples=("20 N/mm",),
    ),
    "contact_modulus": Quantity(
        "Pa", "E", "Modulus of the contact",
        "Reduced elastic modulus E of the two materials: 1/E is the sum of (1 - nu^2)/E of each.",
        0.0,
        strict=True, parameter=True, examples=("115 GPa",),
    ),
    "contact_radius": length(
        "R", "Radius of the contact",
        "Radius of a ball, or of a rounded part at the place where it strikes.",
        "4 mm",
    ),
    "impact_damping": Quantity(
        "s m-1", "b", "Damping of Hunt and Crossley",
        "Damping b in the contact law of Hunt and Crossley, F = k x^n (1 + b x'), from the "
        "restitution at one impact speed."
    ),
    "restitution_at_impact": number(
        "e(v)", "Restitution at the impact speed",
        "Coefficient of restitution at the impact speed, by the contact law of Hunt and Crossley."
    ),
    "damping_of_restitution": number(
        "zeta(e)", "Damping ratio of the restitution",
        "Damping ratio of a spring-damper contact without adhesion that has the given "
        "restitution. It is above 1 for a restitution below 0.135, and infinite for 0.",
    ),
    "restitution_of_damping": number(
        "e(zeta)", "Restitution of the damping ratio",
        "Coefficient of restitution of a spring-damper contact without adhesion; it is the same "
        "at every impact speed.",
    ),
    "lining_frequency": Quantity(
        "Hz", "f_c", "Natural frequency on the lining",
        "Natural frequency of a part on the lining of the track."
    ),
    "lining_sag": Quantity(
        "m", "m g/k", "Sag", "Depth to which a part at rest sinks into the lining by its weight."
    ),
    "stiffness_ratio": number(
        "f_c/f", "Lining over drive",
        "Natural frequency of the part on the lining divided by the drive frequency."
    ),
    "hertz_depth": Quantity("m", "x_max", "Depth of the impact",
        "Largest indentation of a Hertz contact during the impact."),
    "hertz_time": Quantity(
        "s", "t_c", "Time of the impact",
        "Duration of the impact in a Hertz contact without energy loss."
    ),
    # --- motion in time
    "rolling_resistance": Quantity(
        "1", "c", "Rolling resistance",
        "Coefficient of rolling resistance: the lever arm of the floor's force divided by the "
        "radius of the part. It is about 0.001 for hard steel on steel and 0.02 for plastic on a "
        "lined track.",
        0.0, parameter=True, examples=("0.01",), usual=(1e-5, 0.2),
    ),
    "rolling_contact": Quantity(
        "1", "", "Rolling contact", "Contacts of a round part with floor and wall.", bundle=True
    ),
    "slip_groups": Quantity(
        "1", "", "Groups of the slip",
        "Dimensionless numbers of the slip of a round part.", bundle=True
    ),
    "slip_motion": Quantity(
        "1", "", "Slip", "Motion of the contact point over the floor.", bundle=True
    ),
    "mean_acceleration": acceleration(
        "", "Mean acceleration",
        "Long-term mean acceleration along the track if the part runs away; otherwise 0.",
    ),
    "slip_velocity": velocity(
        "s", "Slip velocity",
        "Mean velocity at which the contact point slips on the floor; 0 if the part rolls. "
        "Rolling resistance is neglected unless the part runs away downhill.",
    ),
}  # fmt: skip
