"""Drive, track, contact and part, and what the closed forms of a track give."""

from vibrafeed.core.quantities.flags import REGIMES
from vibrafeed.core.quantities.quantity import (
    Quantity,
    acceleration,
    angle,
    flag,
    force,
    friction,
    length,
    velocity,
)

TRACK: dict[str, Quantity] = {
    # --- parameters: the drive
    "frequency": Quantity(
        "Hz", "f", "Frequency", "Frequency of the drive.", 0.0, parameter=True,
        examples=("50 Hz", "3000 rpm", "3000 vpm"), usual=(1.0, 1000.0),
    ),
    "amplitude": Quantity(
        "m", "A0", "Amplitude",
        "Amplitude of the drive, zero to peak, in the direction of the drive.", 0.0,
        parameter=True, examples=("0.5 mm",), usual=(1e-7, 0.025),
    ),
    "peak_to_peak": Quantity(
        "m", "2 A0", "Peak-to-peak stroke",
        "Stroke of the drive from end to end: twice the amplitude.", 0.0, parameter=True,
        examples=("1 mm",), usual=(2e-7, 0.05),
    ),
    "vertical_amplitude": Quantity(
        "m", "A_v", "Vertical amplitude",
        "Amplitude of the drive normal to the floor of the track, zero to peak: A0 sin(beta).", 0.0,
        parameter=True, examples=("0.2 mm",), usual=(1e-9, 0.025),
    ),
    "vertical_peak_to_peak": Quantity(
        "m", "2 A_v", "Vertical peak-to-peak stroke",
        "Stroke of the drive normal to the floor of the track, from end to end: twice the "
        "vertical amplitude.", 0.0,
        parameter=True, examples=("0.4 mm",), usual=(2e-9, 0.05),
    ),
    "alpha": angle(
        "alpha", "Drive azimuth",
        "Angle in the plane of the floor between the track (+x) and the drive direction; positive "
        "towards +y, away from a wall.", 180.0, "15 deg",
        (1.0, 180.0),
    ),
    "beta": angle(
        "beta", "Drive elevation",
        "Angle of the drive direction above the floor of the track.", 180.0, "20 deg",
        (1.0, 180.0),
    ),
    # --- parameters: the track
    "gamma": angle(
        "gamma", "Climb angle",
        "Angle at which the track climbs in the transport direction (+x); negative if it "
        "descends.", 90.0, "3 deg",
        (0.2, 90.0),
    ),
    "delta": angle(
        "delta", "Lean angle",
        "Angle at which the track or plate leans sideways: +y points uphill, and a wall is on the "
        "downhill side.",
        90.0, "2 deg",
        (0.2, 90.0),
    ),
    "yaw": angle(
        "theta", "Yaw of the axes",
        "Angle by which the part's own axes are turned about the floor normal, from +x towards "
        "+y.", 180.0,
        "30 deg",
    ),
    "radius": length("R", "Bowl radius",
        "Radius of the bowl at the outer wall of the track.", "0.3 m"),
    "gravity": Quantity(
        "m s-2", "g", "Gravity", "Acceleration due to gravity.", 0.0, strict=True, parameter=True,
        examples=("9.80665 m/s^2",), usual=(1.0, 30.0),
    ),
    # --- parameters: the contact
    "friction": friction(
        "mu", "Friction coefficient",
        "Coefficient of Coulomb friction, the same at rest and in sliding."
    ),
    "friction_static": friction(
        "mu_s", "Static friction coefficient",
        "Coefficient of Coulomb friction while the part is at rest."
    ),
    "friction_kinetic": friction(
        "mu_k", "Kinetic friction coefficient",
        "Coefficient of Coulomb friction while the part slides."
    ),
    "wall_friction": friction(
        "mu_w", "Wall friction coefficient",
        "Coefficient of Coulomb friction between the part and the wall of the track; by default "
        "that of the floor.",
    ),
    # --- parameters: the part
    "width": length("a", "Part width",
        "Width of the rectangular part, measured across the track.", "10 mm"),
    "height": length("b", "Part height",
        "Height of the part; for a cone, the distance between its ends.", "1.5 mm"),
    "length": length("h", "Part length", "Length of the part, measured along the track.", "50 mm"),
    "diameter": length("d", "Part diameter",
        "Diameter of the round part, or of its first end if its two ends differ.", "8 mm"),
    "mass": Quantity(
        "kg", "m", "Part mass", "Mass of the part.", 0.0, strict=True, parameter=True,
        examples=("5 g",), usual=(1e-9, 10.0),
    ),
    "restitution": Quantity(
        "1", "eps", "Restitution",
        "Coefficient of restitution in an impact: 0 for no rebound, 1 for full rebound.", 0.0, 1.0,
        parameter=True, examples=("0.5",),
    ),
    "wall_restitution": Quantity(
        "1", "eps_w", "Wall restitution",
        "Coefficient of restitution in an impact on the wall of the track; by default that of the "
        "floor.", 0.0, 1.0,
        parameter=True, examples=("0.3",),
    ),
    # --- parameters: the motion
    "speed": Quantity(
        "m s-1", "v0", "Speed", "Speed of the part along the track at the start.", 0.0,
        parameter=True, examples=("0.1 m/s",), usual=(1e-6, 10.0),
    ),
    "distance": Quantity(
        "m", "x", "Effective distance",
        "Distance over which the closed forms hold the drive at its peak; the thesis gives no "
        "value for it.", 0.0,
        parameter=True, examples=("0.2 mm",),
    ),
    "time": Quantity(
        "s", "t", "Time", "Time since the start, during which the drive stays at its peak.", 0.0,
        parameter=True, examples=("20 ms",),
    ),
    # --- drive and gravity in track axes
    "vibration_acceleration": acceleration(
        "P", "Vibration acceleration",
        "Amplitude of the drive acceleration in the direction of the drive."
    ),
    "drive_along": acceleration(
        "P cb ca", "Drive along the track",
        "Peak drive acceleration in the direction of the track (+x)."
    ),
    "drive_across": acceleration(
        "W", "Drive across the track",
        "Peak drive acceleration across the track (+y), away from the wall."
    ),
    "drive_normal": acceleration(
        "P sb", "Drive normal to the floor",
        "Peak drive acceleration normal to the floor (+z), upwards."
    ),
    "gravity_along": acceleration(
        "g sin(gamma)", "Gravity along the track", "Component of gravity down the track (along -x)."
    ),
    "gravity_across": acceleration(
        "g_y", "Gravity towards the wall",
        "Component of gravity across the track, towards the wall (along -y)."
    ),
    "gravity_normal": acceleration(
        "g_z", "Gravity onto the floor",
        "Component of gravity normal to the floor, towards the floor (along -z)."
    ),
    "throw_number": Quantity(
        "1", "Gamma", "Throw number",
        "Peak drive acceleration over gravity, both normal to the floor; above 1 the part lifts "
        "off.",
    ),
    "normal_acceleration": acceleration(
        "n0", "Normal acceleration",
        "Normal force of the floor on a part that stays on the floor, divided by the mass of the "
        "part. A negative value means that the part lifts off.",
    ),
    "floor_acceleration": acceleration(
        "n", "Floor normal force per mass",
        "Normal force of the floor on the part, divided by the mass of the part, as the chosen "
        "variant computes it."
    ),
    "centripetal_acceleration": acceleration(
        "v^2/R", "Centripetal acceleration",
        "Acceleration towards the bowl's axis that a part needs to follow the curved track."
    ),
    # --- accelerations
    "in_plane_drive_x": acceleration(
        "D_x", "Drive less gravity, x",
        "Peak drive acceleration minus gravity, along the track (x)."
    ),
    "in_plane_drive_y": acceleration(
        "D_y", "Drive less gravity, y",
        "Peak drive acceleration minus gravity, across the track (y) in the plane of the floor."
    ),
    "in_plane_drive": acceleration(
        "|D|", "Drive less gravity in the plane",
        "Magnitude of the peak drive acceleration minus gravity in the plane of the floor."
    ),
    "sliding_fraction": Quantity(
        "1", "1 - mu n/|D|", "Sliding fraction",
        "Share of the push on the part (drive minus gravity) that friction leaves to accelerate "
        "it: 0 if the part sticks, 1 in flight.",
    ),
    "roll_root": acceleration(
        "z", "Root of the slip balance",
        "Acceleration with which the contact of a round part slips on the floor; 0 if the part "
        "rolls.",
    ),
    "acceleration_x": acceleration(
        "a_x", "Acceleration along the track",
        "Acceleration of the part along the track, relative to the track, at the peak of the "
        "drive.",
    ),
    "acceleration_y": acceleration(
        "a_y", "Acceleration across the track",
        "Acceleration of the part across the track, relative to the track, at the peak of the "
        "drive.",
    ),
    "acceleration_z": acceleration(
        "a_z", "Acceleration off the floor",
        "Acceleration of the part off the floor, relative to the track, at the peak of the drive.",
    ),
    "rotated_acceleration_x": acceleration(
        "a_x'", "Acceleration along the turned x axis",
        "Acceleration of the part in the plane of the floor, along the x axis turned by yaw."
    ),
    "rotated_acceleration_y": acceleration(
        "a_y'", "Acceleration along the turned y axis",
        "Acceleration of the part in the plane of the floor, along the y axis turned by yaw."
    ),
    "angular_acceleration": Quantity(
        "rad s-2", "psi..", "Angular acceleration",
        "Angular acceleration of a round part about its axis. If a cylinder lies along the track, "
        "a positive value rolls it towards +y.",
    ),
    # --- travel on the track
    "starting_acceleration": acceleration(
        "K", "Starting acceleration",
        "Acceleration of the part along the track at zero speed, at the peak of the drive."
    ),
    "transport_velocity": velocity(
        "v(x)", "Velocity after the effective distance",
        "Speed of the part after the effective distance if the drive stays at its peak: a "
        "kinematic estimate, not an average over the period.",
    ),
    "terminal_velocity": velocity(
        "v_inf", "Terminal velocity",
        "Speed at which the friction of the wall balances the drive at its peak."
    ),
    "travel_time": Quantity(
        "s", "t(x)", "Travel time",
        "Time in which the part covers the effective distance if the drive stays at its peak."
    ),
    "mean_velocity": velocity(
        "x/t(x)", "Mean velocity over the distance",
        "Effective distance divided by the travel time; not an average over the period.",
    ),
    "velocity_at_time": velocity(
        "v(t)", "Velocity at the time",
        "Speed of the part after the given time if the drive stays at its peak."
    ),
    "distance_at_time": Quantity(
        "m", "x(t)", "Distance at the time",
        "Distance that the part covers in the given time if the drive stays at its peak."
    ),
    "stopping_distance": Quantity(
        "m", "x_s", "Stopping distance",
        "Distance that the part covers until it stops; infinite if it never stops."
    ),
    "stopping_time": Quantity(
        "s", "t_s", "Stopping time", "Time until the part stops; infinite if it never stops."
    ),
    "velocity_bound": velocity(
        "v_b", "Track speed bound",
        "Largest speed of the track along x; friction cannot carry the part faster than this.",
    ),
    "suggested_distance": Quantity(
        "m", "(A0/2) cb ca", "Suggested effective distance",
        "Effective distance at which, without friction, the estimated speed equals the largest "
        "speed of the track.",
    ),
    "distance_bound": Quantity(
        "m", "x_max", "Largest effective distance",
        "Effective distance at which the estimated speed equals the largest speed of the track.",
    ),
    # --- forces
    "floor_force": force("N", "Floor normal force", "Normal force of the floor on the part."),
    "wall_balance": acceleration(
        "B", "Wall load",
        "Load of the part on the wall, divided by the mass of the part; negative if the part "
        "leaves the wall."
    ),
    "wall_acceleration": acceleration(
        "s", "Wall force per mass",
        "Total normal force of the wall on the part, across the track, divided by the mass of the "
        "part."
    ),
    "wall_force": force("S", "Wall force",
        "Total normal force of the wall on the part, across the track."),
    "wall_force_rear": force("lambda1", "Wall force, rear",
        "Force of the wall on the rear corner of the part."),
    "wall_force_front": force("lambda2", "Wall force, front",
        "Force of the wall on the front corner of the part."),
    "chord_cosine": Quantity(
        "1", "cos(sigma)", "Chord cosine",
        "Cosine of the angle between the part and the wall at a corner that touches the wall."
    ),
    "wall_speed": velocity("v_wall", "Wall contact speed",
        "Least speed at which the part stays in contact with the wall."),
    "z_residual": acceleration(
        "az_residual", "Residual of the vertical balance",
        "Force normal to the floor that the model leaves unbalanced, divided by the mass of the "
        "part.",
    ),
    "pressure_offset_x": Quantity(
        "m", "e_x", "Centre of pressure, x",
        "Distance along the track (+x) from the part's centre to the point where the resultant "
        "force of the floor acts."
    ),
    "pressure_offset_y": Quantity(
        "m", "e_y", "Centre of pressure, y",
        "Distance across the track (+y) from the part's centre to the point where the resultant "
        "force of the floor acts."
    ),
    "regime": flag("Regime",
        "State of the part's contacts in each cell, such as stick, slip or flight.",
        REGIMES, "regime"),
}  # fmt: skip
