"""Balls, rollers, discs and cones."""

from __future__ import annotations

from core.quantities.quantity import Quantity, acceleration, force, number, velocity

ROUND_PARTS: dict[str, Quantity] = {
    "inner_diameter": Quantity(
        "m", "d_i", "Inner diameter",
        "Diameter of the hole of a tube or ring, or of the hollow of a ball; the part's own of a "
        "hoop or a thin shell.",
        0.0, parameter=True, examples=("6 mm",), usual=(1e-5, 5.0),
    ),
    "rolling_factor": Quantity(
        "1", "kap", "Rolling factor",
        "m r^2/I about the axis that the part rolls about: 5/2 of a ball, 3/2 of a thin shell, 2 "
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
        "a_sigma", "Acceleration along the axis", "Of the centre, along the axis."
    ),
    "rolling_acceleration": acceleration(
        "a_eta", "Acceleration across the axis",
        "Of the centre, in rolling direction, across the axis or line of contact.",
    ),
    "cone_half_angle": Quantity(
        "degree", "a", "Half angle of the cone", "Between the side of the cone and its axis."
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
    # --- motion in time
    "rolling_resistance": Quantity(
        "1", "c", "Rolling resistance",
        "Coefficient of rolling resistance: lever of the floor's force over the radius of the "
        "part. Hard steel on steel has some 0.001, plastic on a lined track some 0.02.",
        0.0, parameter=True, examples=("0.01",), usual=(1e-5, 0.2),
    ),
    "rolling_contact": Quantity(
        "1", "", "Rolling contact", "What a round part has at floor and wall.", bundle=True
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
        "Mean velocity at which the point of contact slips on the floor; 0 where the part rolls.",
    ),
}  # fmt: skip
