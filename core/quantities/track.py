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
        "Hz", "f", "Frequency", "Drive frequency.", 0.0, parameter=True,
        examples=("50 Hz", "3000 rpm", "3000 vpm"), usual=(1.0, 1000.0),
    ),
    "amplitude": Quantity(
        "m", "A0", "Amplitude", "Drive amplitude, zero to peak, along the drive direction.", 0.0,
        parameter=True, examples=("0.5 mm",), usual=(1e-7, 0.025),
    ),
    "peak_to_peak": Quantity(
        "m", "2 A0", "Peak-to-peak stroke", "Twice the drive amplitude.", 0.0, parameter=True,
        examples=("1 mm",), usual=(2e-7, 0.05),
    ),
    "vertical_amplitude": Quantity(
        "m", "A_v", "Vertical amplitude",
        "Amplitude of the drive's part normal to the floor, zero to peak: A0 sin(beta).", 0.0,
        parameter=True, examples=("0.2 mm",), usual=(1e-9, 0.025),
    ),
    "vertical_peak_to_peak": Quantity(
        "m", "2 A_v", "Vertical peak-to-peak stroke", "Twice the vertical amplitude.", 0.0,
        parameter=True, examples=("0.4 mm",), usual=(2e-9, 0.05),
    ),
    "alpha": angle(
        "alpha", "Drive azimuth",
        "Azimuth of the drive in the floor plane, from the track (+x) towards +y.", 180.0, "15 deg",
        (1.0, 180.0),
    ),
    "beta": angle(
        "beta", "Drive elevation", "Elevation of the drive above the floor plane.", 180.0, "20 deg",
        (1.0, 180.0),
    ),
    # --- parameters: the track
    "gamma": angle(
        "gamma", "Climb angle", "Climb angle of the track; +x goes uphill.", 90.0, "3 deg",
        (0.2, 90.0),
    ),
    "delta": angle(
        "delta", "Lean angle", "Lean of track or plate; +y goes uphill, and a wall is downhill.",
        90.0, "2 deg",
        (0.2, 90.0),
    ),
    "yaw": angle(
        "theta", "Yaw of the axes", "Turn of the part's axes about the floor normal.", 180.0,
        "30 deg",
    ),
    "radius": length("R", "Bowl radius", "Radius of the bowl's track wall.", "0.3 m"),
    "gravity": Quantity(
        "m s-2", "g", "Gravity", "Acceleration of gravity.", 0.0, strict=True, parameter=True,
        examples=("9.80665 m/s^2",), usual=(1.0, 30.0),
    ),
    # --- parameters: the contact
    "friction": friction(
        "mu", "Friction coefficient", "Coulomb friction coefficient, static and kinetic alike."
    ),
    "friction_static": friction(
        "mu_s", "Static friction coefficient", "Coulomb friction coefficient at rest."
    ),
    "friction_kinetic": friction(
        "mu_k", "Kinetic friction coefficient", "Coulomb friction coefficient in sliding."
    ),
    "wall_friction": friction(
        "mu_w", "Wall friction coefficient",
        "Coulomb friction coefficient at the wall of the track; the floor's unless given.",
    ),
    # --- parameters: the part
    "width": length("a", "Part width", "Width of the rectangular part, across.", "10 mm"),
    "height": length("b", "Part height", "Height of the rectangular part.", "1.5 mm"),
    "length": length("h", "Part length", "Length of the part, along the track.", "50 mm"),
    "diameter": length("d", "Part diameter", "Diameter of the cylindrical part.", "8 mm"),
    "mass": Quantity(
        "kg", "m", "Part mass", "Mass of the part.", 0.0, strict=True, parameter=True,
        examples=("5 g",), usual=(1e-9, 10.0),
    ),
    "restitution": Quantity(
        "1", "eps", "Restitution",
        "Coefficient of restitution: 0 for no rebound, 1 for full rebound.", 0.0, 1.0,
        parameter=True, examples=("0.5",),
    ),
    "wall_restitution": Quantity(
        "1", "eps_w", "Wall restitution",
        "Coefficient of restitution at the wall of the track; the floor's unless given.", 0.0, 1.0,
        parameter=True, examples=("0.3",),
    ),
    # --- parameters: the motion
    "speed": Quantity(
        "m s-1", "v0", "Speed", "Speed of the part along the track at the start.", 0.0,
        parameter=True, examples=("0.1 m/s",), usual=(1e-6, 10.0),
    ),
    "distance": Quantity(
        "m", "x", "Effective distance",
        "Distance over which the drive is taken to act; the source gives no value for it.", 0.0,
        parameter=True, examples=("0.2 mm",),
    ),
    "time": Quantity(
        "s", "t", "Time", "Time since the start, with the drive held at its peak.", 0.0,
        parameter=True, examples=("20 ms",),
    ),
    # --- drive and gravity in track axes
    "vibration_acceleration": acceleration(
        "P", "Vibration acceleration", "Amplitude of the drive acceleration."
    ),
    "drive_along": acceleration(
        "P cb ca", "Drive along the track", "Drive acceleration at its peak, along +x."
    ),
    "drive_across": acceleration(
        "W", "Drive across the track", "Drive acceleration at its peak, along +y, off the wall."
    ),
    "drive_normal": acceleration(
        "P sb", "Drive normal to the floor", "Drive acceleration at its peak, along +z, upwards."
    ),
    "gravity_along": acceleration(
        "g sin(gamma)", "Gravity along the track", "Gravity component along -x, downhill."
    ),
    "gravity_across": acceleration(
        "g_y", "Gravity towards the wall", "Gravity component along -y, towards the wall."
    ),
    "gravity_normal": acceleration(
        "g_z", "Gravity onto the floor", "Gravity component along -z, onto the floor."
    ),
    "throw_number": Quantity(
        "1", "Gamma", "Throw number",
        "Drive normal to the floor over gravity normal to the floor; above 1 the part lifts off.",
    ),
    "normal_acceleration": acceleration(
        "n0", "Normal acceleration",
        "Floor normal force per mass that keeps the part on the floor; negative after lift-off.",
    ),
    "floor_acceleration": acceleration(
        "n", "Floor normal force per mass", "Floor normal force per mass that the variant uses."
    ),
    "centripetal_acceleration": acceleration(
        "v^2/R", "Centripetal acceleration", "Acceleration that the curve of the track requires."
    ),
    # --- accelerations
    "in_plane_drive_x": acceleration(
        "D_x", "Drive less gravity, x", "Drive less gravity along the track."
    ),
    "in_plane_drive_y": acceleration(
        "D_y", "Drive less gravity, y", "Drive less gravity across the track, in the floor plane."
    ),
    "in_plane_drive": acceleration(
        "|D|", "Drive less gravity in the plane", "Magnitude of drive less gravity in the floor."
    ),
    "sliding_fraction": Quantity(
        "1", "1 - mu n/|D|", "Sliding fraction",
        "Share of the drive less gravity that remains after friction: 0 in stick, 1 in flight.",
    ),
    "roll_root": acceleration(
        "z", "Root of the slip balance", "Positive root of the slip balance of a cylinder; 0 if it "
        "rolls.",
    ),
    "acceleration_x": acceleration(
        "a_x", "Acceleration along the track",
        "Acceleration of the part relative to the track at the drive's peak, along the track.",
    ),
    "acceleration_y": acceleration(
        "a_y", "Acceleration across the track",
        "Acceleration of the part relative to the track at the drive's peak, across the track.",
    ),
    "acceleration_z": acceleration(
        "a_z", "Acceleration off the floor",
        "Acceleration of the part relative to the track at the drive's peak, off the floor.",
    ),
    "rotated_acceleration_x": acceleration(
        "a_x'", "Acceleration along the turned x axis", "In-plane acceleration along the turned x."
    ),
    "rotated_acceleration_y": acceleration(
        "a_y'", "Acceleration along the turned y axis", "In-plane acceleration along the turned y."
    ),
    "angular_acceleration": Quantity(
        "rad s-2", "psi..", "Angular acceleration",
        "Angular acceleration of the cylinder about its axis; positive rolls towards +y.",
    ),
    # --- travel on the track
    "starting_acceleration": acceleration(
        "K", "Starting acceleration", "Acceleration along the track at zero speed."
    ),
    "transport_velocity": velocity(
        "v(x)", "Velocity after the effective distance",
        "Kinematic estimate: speed after the effective distance with the drive held at its peak; "
        "not an average over the period.",
    ),
    "terminal_velocity": velocity(
        "v_inf", "Terminal velocity", "Speed at which wall friction balances the peak drive."
    ),
    "travel_time": Quantity(
        "s", "t(x)", "Travel time", "Time to cover the effective distance, drive held at its peak."
    ),
    "mean_velocity": velocity(
        "x/t(x)", "Mean velocity over the distance",
        "Effective distance over travel time; not an average over the period.",
    ),
    "velocity_at_time": velocity(
        "v(t)", "Velocity at the time", "Speed after the given time, drive held at its peak."
    ),
    "distance_at_time": Quantity(
        "m", "x(t)", "Distance at the time", "Distance after the given time, drive at its peak."
    ),
    "stopping_distance": Quantity(
        "m", "x_s", "Stopping distance", "Distance until the part stops, if it does."
    ),
    "stopping_time": Quantity(
        "s", "t_s", "Stopping time", "Time until the part stops, if it does."
    ),
    "velocity_bound": velocity(
        "v_b", "Track speed bound",
        "Largest speed of the track along x; friction cannot carry the part faster.",
    ),
    "suggested_distance": Quantity(
        "m", "(A0/2) cb ca", "Suggested effective distance",
        "Effective distance at which the estimate reaches the track speed bound without friction.",
    ),
    "distance_bound": Quantity(
        "m", "x_max", "Largest effective distance",
        "Effective distance at which the estimate reaches the track speed bound.",
    ),
    # --- forces
    "floor_force": force("N", "Floor normal force", "Normal force of the floor on the part."),
    "wall_balance": acceleration(
        "B", "Wall load", "Load on the wall per mass; negative where the part leaves the wall."
    ),
    "wall_acceleration": acceleration(
        "s", "Wall force per mass", "Sum of the wall normal forces across the track, per mass."
    ),
    "wall_force": force("S", "Wall force", "Sum of the wall normal forces, across the track."),
    "wall_force_rear": force("lambda1", "Wall force, rear", "Wall force at the rear corner."),
    "wall_force_front": force("lambda2", "Wall force, front", "Wall force at the front corner."),
    "chord_cosine": Quantity(
        "1", "cos(sigma)", "Chord cosine", "Cosine of the angle between part and wall at a corner."
    ),
    "wall_speed": velocity("v_wall", "Wall contact speed", "Least speed with wall contact."),
    "z_residual": acceleration(
        "az_residual", "Residual of the vertical balance",
        "Residual of the model in the force balance normal to the floor, per mass.",
    ),
    "pressure_offset_x": Quantity(
        "m", "e_x", "Centre of pressure, x", "Offset of the floor resultant along the track."
    ),
    "pressure_offset_y": Quantity(
        "m", "e_y", "Centre of pressure, y", "Offset of the floor resultant across the track."
    ),
    "regime": flag("Regime", "State of the contacts in each cell.", REGIMES, "regime"),
}  # fmt: skip
