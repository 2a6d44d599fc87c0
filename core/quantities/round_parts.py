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
        "m", "p", f"{label}, pitch", f"Moment along the wrench axis over force, of {what}."
    )
    point = {
        f"{name}_axis_{direction}": Quantity(
            "m", f"r_{symbol}", f"{label}, axis point, {symbol}",
            f"From the centre to the nearest point of the wrench axis of {what}, along +{symbol}.",
        )
        for direction, symbol in (("normal", "n"), ("rolling", "eta"), ("axial", "sigma"))
    }  # fmt: skip
    return {f"{name}_pitch": pitch, **point}


ROLLING: dict[str, Quantity] = {
    "axis_yaw": angle(
        "theta", "Yaw of the cylinder's axis",
        "Turn of the rolling cylinder's axis in the floor plane as chapter 4 counts it: from +x "
        "towards -y, clockwise seen from above.", 180.0, "30 deg",
    ),
    "spin_rate": Quantity(
        "rad s-1", "phi.", "Spin rate",
        "Angular velocity of the rolling cylinder about its axis; positive rolls along +eta.",
        parameter=True, examples=("40 rad/s", "400 rpm"),
    ),
    "yaw_rate": Quantity(
        "rad s-1", "theta.", "Yaw rate", "Rate of the cylinder's yaw, in the sense of axis_yaw.",
        parameter=True, examples=("2 rad/s",),
    ),
    "drilling_moment": Quantity(
        "N m", "M_z", "Drilling moment",
        "Moment of all floor friction about the vertical through the centre, in the sense of "
        "axis_yaw.", parameter=True, examples=("0.1 mN m",),
    ),
    "rolling_drive": acceleration(
        "D_eta", "Drive in rolling direction",
        "Drive acceleration at its peak, along +eta, horizontal and across the axis.",
    ),
    "axial_drive": acceleration(
        "D_sigma", "Drive along the axis",
        "Drive acceleration at its peak, along +sigma, the cylinder's axis.",
    ),
    "axial_friction_acceleration": acceleration(
        "F_sigma/m", "Axial friction per mass",
        "Friction along the axis per mass that pure rolling requires; positive acts along -sigma.",
    ),
    "rolling_friction": force(
        "F_eta", "Friction in rolling direction",
        "Friction that pure rolling requires; positive acts along -eta.",
    ),
    "axial_friction": force(
        "F_sigma", "Friction along the axis",
        "Friction that pure rolling asks for along the axis; positive acts along -sigma.",
    ),
    "spin_acceleration": Quantity(
        "rad s-2", "phi..", "Spin acceleration",
        "Angular acceleration about the cylinder's axis in pure rolling.",
    ),
    "yaw_acceleration": Quantity(
        "rad s-2", "theta..", "Yaw acceleration",
        "Angular acceleration about the vertical; 0 without a drilling moment.",
    ),
    "printed_yaw_rate": Quantity(
        "rad s-1", "theta. (4.20)", "Yaw rate as printed",
        "Yaw rate by (4.20) of the source, with the floor's resultant at mid-length. For "
        "comparison only: it contradicts the source's (4.18) and (4.19).",
    ),
    "pressure_offset_axial": Quantity(
        "m", "e", "Centre of pressure, axial",
        "Offset of the floor's normal force from mid-length, along +sigma.",
    ),
    "required_friction": Quantity(
        "1", "mu_req", "Required friction coefficient",
        "Least static friction coefficient with which the cylinder rolls without slip.",
    ),
    "cone_margin": force(
        "mu_s N - |F|", "Margin in the friction cone",
        "Static friction limit less the friction that pure rolling asks for; negative slips.",
    ),
    "floor_wrench": Quantity(
        "1", "(F, M)", "Floor wrench",
        "Force [N] of the floor and its moment [N m] about the centre, axes n, eta, sigma.",
        bundle=True,
    ),
    "floor_reduction": Quantity(
        "1", "(p, r)", "Floor wrench, reduced", "Pitch and axis of the floor wrench.", bundle=True
    ),
    "force_wrench": Quantity(
        "1", "(F, M)", "Wrench of the force system",
        "Resultant [N] of drive, gravity and floor, moment [N m] about the centre, axes n, eta, "
        "sigma.", bundle=True,
    ),
    "force_reduction": Quantity(
        "1", "(p, r)", "Wrench of the force system, reduced",
        "Pitch and axis of the force system.", bundle=True,
    ),
    **_screw("floor", "Floor wrench", "the floor's forces"),
    **_screw("force", "Force system", "drive, gravity and floor together"),
}  # fmt: skip


ROUND_PARTS: dict[str, Quantity] = {
    "inner_diameter": Quantity(
        "m", "d_i", "Inner diameter",
        "Diameter of the hole of a tube or ring, or of the hollow of a ball; the part's own of a "
        "hoop or a thin shell.",
        0.0, parameter=True, examples=("6 mm",), usual=(1e-5, 5.0),
    ),
    "rolling_factor": Quantity(
        "1", "kap", "Rolling factor",
        "Ratio m r^2/I about the rolling axis: 5/2 of a ball, 3/2 of a thin shell, 2 "
        "of a cylinder or disc, 1 of a hoop; follows from the diameters unless given.",
        0.0, strict=True, parameter=True, examples=("2.5",),
    ),
    "rolling_share": number(
        "kap/(1+kap)", "Rolling share", "Acceleration over push of a part that rolls."
    ),
    "moved_fraction": number(
        "|a|/|D|", "Moved fraction", "Acceleration of the ball's centre over the push on it."
    ),
    "push_across_axis": acceleration(
        "D_eta", "Push across the axis",
        "Drive at its peak less gravity along the floor, in rolling direction.",
    ),
    "push_along_axis": acceleration(
        "D_sigma", "Push along the axis",
        "Drive at its peak less gravity along the floor, along the axis or line of contact.",
    ),
    "axial_acceleration": acceleration(
        "a_sigma", "Acceleration along the axis", "Acceleration of the centre along the axis."
    ),
    "rolling_acceleration": acceleration(
        "a_eta", "Acceleration across the axis",
        "Acceleration of the centre in rolling direction, across the axis or line of contact.",
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
        "F", "Factor of the cone", "Acceleration of a rolling cone's centre over the push on it."
    ),
    "turning_acceleration": Quantity(
        "rad s-2", "", "Turning acceleration",
        "Angular acceleration of a rolling cone about the vertical through its apex.",
    ),
    "net_push": acceleration(
        "D - w", "Net push", "Push along the track less the friction of the wall."
    ),
    "wall_drag": force(
        "m w", "Wall drag", "Friction force of the wall; positive acts along -x."
    ),
    # --- contacts that give
    "restitution_speed": Quantity(
        "m s-1", "v_e", "Speed of the restitution",
        "Speed of impact at which the restitution was measured.", 0.0, strict=True,
        parameter=True, examples=("0.1 m/s",), usual=(1e-3, 20.0),
    ),
    "impact_speed": Quantity(
        "m s-1", "v", "Impact speed", "Speed of approach normal to the contact.", 0.0,
        strict=True, parameter=True, examples=("0.2 m/s",), usual=(1e-4, 20.0),
    ),
    "contact_damping_ratio": Quantity(
        "1", "zeta", "Damping ratio of the contact",
        "Damping ratio of the spring and damper of a contact that "
        "never pulls.", 0.0, parameter=True,
        examples=("0.2",),
    ),
    "lining_stiffness": Quantity(
        "N m-1", "k", "Stiffness of the lining",
        "Force over depth of a part on a lined track, such as brush or urethane.", 0.0,
        strict=True, parameter=True, examples=("20 N/mm",),
    ),
    "contact_modulus": Quantity(
        "Pa", "E", "Modulus of the contact",
        "Reduced modulus of both materials: 1/E is the sum of (1 - nu^2)/E of each.", 0.0,
        strict=True, parameter=True, examples=("115 GPa",),
    ),
    "contact_radius": length(
        "R", "Radius of the contact", "Radius of a ball, or of a rounded part where it strikes.",
        "4 mm",
    ),
    "impact_damping": Quantity(
        "s m-1", "b", "Damping of Hunt and Crossley",
        "Damping b of Hunt and Crossley's law, F = k x^n (1 + b x'), "
        "from a restitution at one speed."
    ),
    "restitution_at_impact": number(
        "e(v)", "Restitution at the impact speed",
        "Restitution at the impact speed by Hunt and Crossley's "
        "law."
    ),
    "damping_of_restitution": number(
        "zeta(e)", "Damping ratio of the restitution",
        "Damping ratio of a spring and damper without adhesion that gives the restitution: above 1 "
        "for a restitution below 0.135, infinite for 0.",
    ),
    "restitution_of_damping": number(
        "e(zeta)", "Restitution of the damping ratio",
        "Restitution of a spring and damper without adhesion, at any speed.",
    ),
    "lining_frequency": Quantity(
        "Hz", "f_c", "Natural frequency on the lining", "Natural frequency of a part on its lining."
    ),
    "lining_sag": Quantity(
        "m", "m g/k", "Sag", "Depth to which a part at rest sinks into its lining by its weight."
    ),
    "stiffness_ratio": number(
        "f_c/f", "Lining over drive", "Natural frequency on the lining over that of the drive."
    ),
    "hertz_depth": Quantity("m", "x_max", "Depth of the impact", "Depth of a Hertz contact at the "
    "impact."),
    "hertz_time": Quantity(
        "s", "t_c", "Time of the impact", "Duration of a Hertz contact without loss."
    ),
    # --- motion in time
    "rolling_resistance": Quantity(
        "1", "c", "Rolling resistance",
        "Coefficient of rolling resistance: lever of the floor's force over the radius of the "
        "part. Hard steel on steel has some 0.001, plastic on a lined track some 0.02.",
        0.0, parameter=True, examples=("0.01",), usual=(1e-5, 0.2),
    ),
    "rolling_contact": Quantity(
        "1", "", "Rolling contact", "Contacts of a round part with floor and wall.", bundle=True
    ),
    "slip_groups": Quantity(
        "1", "", "Groups of the slip", "The dimensionless numbers of the slip.", bundle=True
    ),
    "slip_motion": Quantity(
        "1", "", "Slip", "Motion of the contact over the floor.", bundle=True
    ),
    "mean_acceleration": acceleration(
        "", "Mean acceleration",
        "Mean acceleration of the part over a period of the drive, in the long run: 0 where it "
        "has a conveying velocity, or none.",
    ),
    "slip_velocity": velocity(
        "s", "Slip velocity",
        "Mean velocity at which the point of contact slips on the floor; 0 where the part rolls. "
        "Rolling resistance is left out while the part turns to and fro.",
    ),
}  # fmt: skip
