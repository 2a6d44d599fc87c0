"""Every quantity and every regime, declared once.

Units, bounds, labels and descriptions that the study, the dataset, the catalogue and the documents
show are read from here. Inside the code all values are SI and angles are radians; at the edge
(studies, files, replies) angles are degrees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Quantity:
    """A named physical variable.

    Attributes
    ----------
    unit : str
        UDUNITS name of the unit in studies, files and replies.
    symbol : str
        The source's symbol.
    label : str
        Short name for axes and tables; `long_name` in files.
    description : str
        What it is, in one sentence.
    lower, upper : float
        Bounds, in `unit`; both included.
    strict : bool
        True if the lower bound itself is excluded.
    parameter : bool
        True if a study may give it a value.
    examples : tuple of str
        How a user may write it.
    bundle : bool
        True for several arrays that one equation hands on together, such as both components of an
        impulse; equations read them, files do not hold them.
    """

    unit: str
    symbol: str
    label: str
    description: str
    lower: float = -math.inf
    upper: float = math.inf
    strict: bool = False
    parameter: bool = False
    examples: tuple[str, ...] = ()
    bundle: bool = False

    @property
    def is_angle(self) -> bool:
        """Whether the value is degrees at the edge and radians inside."""
        return self.unit == "degree"


def _length(symbol: str, label: str, description: str, example: str) -> Quantity:
    return Quantity(
        "m", symbol, label, description, 0.0, strict=True, parameter=True, examples=(example,)
    )


def _angle(symbol: str, label: str, description: str, limit: float, example: str) -> Quantity:
    return Quantity(
        "degree", symbol, label, description, -limit, limit, parameter=True, examples=(example,)
    )


def _friction(symbol: str, label: str, description: str) -> Quantity:
    return Quantity("1", symbol, label, description, 0.0, parameter=True, examples=("0.3",))


def _acceleration(symbol: str, label: str, description: str) -> Quantity:
    return Quantity("m s-2", symbol, label, description)


def _velocity(symbol: str, label: str, description: str) -> Quantity:
    return Quantity("m s-1", symbol, label, description)


def _force(symbol: str, label: str, description: str) -> Quantity:
    return Quantity("N", symbol, label, description)


def _screw(name: str, label: str, what: str) -> dict[str, Quantity]:
    """Return pitch and axis point of a wrench, components n (up), eta (rolling), sigma (axis)."""
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


def _motion() -> dict[str, Quantity]:
    """Return the quantities of motion in time: scales, settings, results."""

    def number(symbol: str, label: str, description: str) -> Quantity:
        return Quantity("1", symbol, label, description)

    def fraction(label: str, description: str) -> Quantity:
        return Quantity("1", "", label, f"Part of the period in which {description}.")

    scales = {
        "drive_number": number(
            "p", "Drive number", "Amplitude of the drive acceleration over gravity."
        ),
        "drive_number_along": number(
            "p cb ca", "Drive number along the track", "Drive acceleration along +x over gravity."
        ),
        "drive_number_across": number(
            "p cb sa", "Drive number across the track", "Drive acceleration along +y over gravity."
        ),
        "drive_number_normal": number(
            "p sb", "Drive number off the floor", "Drive acceleration along +z over gravity."
        ),
        "gravity_number_along": number(
            "sin(gamma)", "Share of gravity along the track", "Gravity along -x over gravity."
        ),
        "gravity_number_across": number(
            "cg sd", "Share of gravity towards the wall", "Gravity along -y over gravity."
        ),
        "gravity_number_normal": number(
            "cg cd", "Share of gravity onto the floor", "Gravity along -z over gravity."
        ),
        "curvature_number": number(
            "g/(w^2 R)", "Curvature number", "Length scale g/w^2 over the bowl radius."
        ),
        "velocity_scale": _velocity("g/w", "Velocity scale", "Gravity over circular frequency."),
        "length_scale": Quantity(
            "m", "g/w^2", "Length scale", "Gravity over circular frequency squared."
        ),
        "motion": Quantity(
            "1", "", "Motion", "Motion over a period, in the scales of the drive.", bundle=True
        ),
    }
    settings = {
        "tolerance": number(
            "tol", "Tolerance", "Largest error of a periodic state, as a share of the drive."
        ),
        "most_periods": number(
            "N", "Most periods", "Most periods of the drive that one point is followed for."
        ),
        "steps_per_period": number(
            "n", "Steps per period", "Time steps in a period of the drive, of the coarser run."
        ),
        "slip_speed": number(
            "u_s", "Slip speed", "Speed below which regularised friction gives way, in g/w."
        ),
        "contact_stiffness": number(
            "k", "Contact stiffness", "Stiffness of the regularised floor, over m w^2."
        ),
    }
    results = {
        "conveying_velocity": _velocity(
            "v", "Conveying velocity", "Mean velocity along the track once the motion repeats."
        ),
        "conveying_velocity_spread": _velocity(
            "s(v)", "Spread of the conveying velocity",
            "Standard deviation of the means of runs from several phases; 0 where the motion "
            "repeats.",
        ),
        "conveying_velocity_error": _velocity(
            "e(v)", "Error of the conveying velocity", "The method's own estimate of its error."
        ),
        "efficiency": number(
            "v/v_b", "Transport efficiency",
            "Conveying velocity over the largest speed of the track along x.",
        ),
        "stick_fraction": fraction("Sticking share", "friction holds the part"),
        "forward_fraction": fraction("Forward sliding share", "the part slides forward"),
        "backward_fraction": fraction("Backward sliding share", "the part slides backward"),
        "flight_fraction": fraction("Flight share", "the part is off the floor"),
        "impacts_per_period": number(
            "", "Impacts per period",
            "Impacts on the floor per period of the drive; a run of ever smaller hops counts as "
            "those resolved.",
        ),
        "period_multiple": number(
            "", "Period multiple",
            "Periods of the drive after which the motion repeats; 0 where it does not.",
        ),
        "landing_speed": _velocity(
            "u_N", "Landing speed", "Largest speed normal to the floor before an impact."
        ),
        "hop_height": Quantity("m", "z", "Hop height", "Largest distance from the floor."),
        "motion_status": number("", "Status of the motion", "How the motion ended."),
    }  # fmt: skip
    tumbling = {
        "duration": Quantity(
            "s", "t_e", "Duration", "Time after which the run ends.", 0.0, strict=True,
            parameter=True, examples=("2 s",),
        ),
        "drop_height": Quantity(
            "m", "z_0", "Drop height",
            "Height of the part's lowest corner above the plane at the start.", 0.0,
            parameter=True, examples=("10 mm",),
        ),
        "tumble": Quantity("1", "", "Tumble", "How the part tumbled.", bundle=True),
        "final_pitch": Quantity(
            "degree", "xi_e", "Final pitch", "Pitch at the end, clockwise, with all its turns."
        ),
        "resting_side": number(
            "", "Resting side",
            "Side that lies on the plane at the end: 1 as at pitch 0, 2 at 90 degrees, 3 at 180, "
            "4 at 270; 0 if none does.",
        ),
        "settling_time": Quantity(
            "s", "t_s", "Settling time", "Time from which the part lies at rest for good."
        ),
        "impact_count": number(
            "", "Impacts", "Impacts until the end; both ends of a side at once count as one."
        ),
        "largest_bounce": Quantity(
            "m", "z_b", "Largest bounce",
            "Largest height of the lowest corner above the plane after the first impact.",
        ),
        "drift_velocity": _velocity(
            "x/t", "Drift velocity", "Displacement along the plane over the duration."
        ),
        "specific_energy_lost": Quantity(
            "J kg-1", "e_l", "Energy lost per mass", "Energy that impacts and friction took."
        ),
    }  # fmt: skip
    tumbling |= {
        "tumbling_part": Quantity("1", "", "Tumbling part", "Its shape and size.", bundle=True),
        "path_along": Quantity("m", "x", "Centre along the plane", "Place of the centre."),
        "path_height": Quantity("m", "y", "Height of the centre", "Height of the centre."),
        "path_pitch": Quantity("degree", "xi", "Pitch", "Pitch, clockwise, with all its turns."),
        "path_gap": Quantity("m", "g_N", "Lowest gap", "Height of the lowest corner."),
        "path_corners": number("", "Corners in contact", "Corners that carry the part."),
    }
    trajectory = {
        "cycle_time": Quantity(
            "s", "t", "Time in the cycle",
            "Time since the start of a period of the drive; of a tumbling part, since the start.",
        ),
        "position_along": Quantity(
            "m", "x", "Position on the track",
            "Position along the track, relative to it, from that at the first time.",
        ),
        "height_above_floor": Quantity(
            "m", "z", "Height above the floor", "Distance of the part from the moving floor."
        ),
        "distance_from_wall": Quantity(
            "m", "y", "Distance from the wall", "Distance of the part from the moving wall."
        ),
        "relative_velocity_along": _velocity(
            "u_x", "Velocity relative to the track", "Velocity along the track, relative to it."
        ),
        "relative_velocity_normal": _velocity(
            "u_z", "Velocity off the floor", "Velocity normal to the floor, relative to it."
        ),
        "track_along": Quantity(
            "m", "A0 cb sin(wt)", "Displacement of the track along x", "Displacement of the track."
        ),
        "track_normal": Quantity(
            "m", "A0 sb sin(wt)", "Displacement of the track along z", "Displacement of the track."
        ),
        "motion_mode": number("", "Mode of the motion", "What the part does on the track."),
    }  # fmt: skip
    return {**scales, **settings, **results, **tumbling, **trajectory}


def _optimum() -> dict[str, Quantity]:
    """Return the quantities of an optimum."""

    def number(symbol: str, label: str, description: str) -> Quantity:
        return Quantity("1", symbol, label, description)

    return {
        "front": number(
            "", "Place on the front",
            "0 at the largest output, 1 at the least absolute value of the other one.",
        ),
        "objective": number("", "Objective", "What was looked for, at the optimum."),
        "optimum_status": number("", "Status of the optimum", "How the search ended."),
        "optimality_residual": number(
            "", "Optimality residual",
            "What the first-order conditions of an optimum leave of the objective's gradient, as "
            "a share of the outputs' scale, each variable over its range.",
        ),
        "optimum_gap": number(
            "", "Gap of the optimum",
            "Objective of the exact answer, or of a dense grid, less the one found, as a share of "
            "the outputs' scale.",
        ),
        "evaluations": number("", "Evaluations", "Points at which the outputs were computed."),
        "knee": number("", "Knee of the front", "The point farthest from the chord of the front."),
    }  # fmt: skip


def _pair_impact() -> dict[str, Quantity]:
    """Return the quantities of two bodies, 1 and 2, that collide."""
    several = {
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
            "0 none of the five, 1 rim on face, 2 rim on side, 3 face on face, 4 side on side, "
            "5 side on face.",
        ),
        "contact_z": Quantity("m", "P_z", "Contact point, z", "Point where the impulse acts, z."),
        "normal_z": Quantity("1", "n_z", "Normal, z", "Unit normal from body 2 to body 1, z."),
        "sliding_before": _velocity(
            "|u_T|", "Sliding velocity before", "Speed of sliding at the contact, before."
        ),
        "sliding_after": _velocity(
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
            "Linear momentum after less before; 0 but for rounding.",
        ),
        "angular_momentum_residual_x": Quantity(
            "kg m2 s-1", "dL_x", "Residual of the angular momentum, x",
            "Angular momentum about the origin, after less before; 0 but for rounding.",
        ),
        "angular_momentum_residual_y": Quantity(
            "kg m2 s-1", "dL_y", "Residual of the angular momentum, y",
            "Angular momentum about the origin, after less before; 0 but for rounding.",
        ),
        "angular_momentum_residual_z": Quantity(
            "kg m2 s-1", "dL_z", "Residual of the angular momentum, z",
            "Angular momentum about the origin, after less before; 0 but for rounding.",
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
        "approach_normal": _velocity(
            "u_N", "Normal velocity before", "Velocity of body 1 off body 2 at the contact, before "
            "the impact; negative where they approach.",
        ),
        "approach_tangential": _velocity(
            "u_T", "Tangential velocity before",
            "Velocity of body 1 along the contact, relative to body 2, before the impact.",
        ),
        "separation_normal": _velocity(
            "u_N'", "Normal velocity after",
            "Velocity of body 1 off body 2 at the contact, after the impact.",
        ),
        "separation_tangential": _velocity(
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
            "Linear momentum after less before; 0 but for rounding.",
        ),
        "momentum_residual_y": Quantity(
            "N s", "dp_y", "Residual of the momentum, y",
            "Linear momentum after less before; 0 but for rounding.",
        ),
        "angular_momentum_residual": Quantity(
            "kg m2 s-1", "dL_z", "Residual of the angular momentum",
            "Angular momentum about the origin, after less before; 0 but for rounding.",
        ),
    }  # fmt: skip
    bundles = {
        name: Quantity("1", "", label, description, bundle=True)
        for name, label, description in (
            ("rectangle_contact", "Contact of two rectangles", "Gap, normal, ends of the contact."),
            ("contact_arms", "Lever arms", "Moments of unit impulses at the contact."),
            ("edge_action", "Action on an edge", "Where on a touching edge the impulse acts."),
            ("planar_impulse", "Planar impulse", "Both components, and whether they stick."),
            ("planar_motion_after", "Planar motion after", "All six velocities after."),
            ("cylinder_1", "Cylinder 1", "Centre, axis, radius and half length."),
            ("cylinder_2", "Cylinder 2", "Centre, axis, radius and half length."),
            ("cylinder_masses", "Masses", "Masses and moments of inertia of both bodies."),
            ("spatial_motion", "Motion before", "Velocities and spins of both bodies."),
            ("cylinder_contact", "Contact of two cylinders", "Gap, form, normal, ends."),
            ("contact_frame", "Contact frame", "Contact point, normal and two tangents."),
            ("spatial_delassus", "Delassus numbers in space", "All six of them."),
            ("spatial_approach", "Contact velocity before", "Components along n and tangents."),
            ("spatial_impulse", "Impulse in space", "Components, and whether they stick."),
            ("spatial_motion_after", "Motion after", "Velocities and spins after the impact."),
        )
    }
    return {**_pair_body("1"), **_pair_body("2"), **several, **bundles}


def _pair_body(body: str) -> dict[str, Quantity]:
    """Return the parameters and velocities of one of two bodies."""

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
        f"velocity_x_{body}_after": _velocity(
            f"vx{body}'", f"Velocity x after, body {body}",
            f"Velocity of body {body} after the impact, x.",
        ),
        f"velocity_y_{body}_after": _velocity(
            f"vy{body}'", f"Velocity y after, body {body}",
            f"Velocity of body {body} after the impact, y.",
        ),
        f"velocity_z_{body}_after": _velocity(
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


QUANTITIES: dict[str, Quantity] = {
    # --- parameters: the drive
    "frequency": Quantity(
        "Hz", "f", "Frequency", "Drive frequency.", 0.0, parameter=True,
        examples=("50 Hz", "3000 rpm", "3000 vpm"),
    ),
    "amplitude": Quantity(
        "m", "A0", "Amplitude", "Drive amplitude, zero to peak, along the drive direction.", 0.0,
        parameter=True, examples=("0.5 mm",),
    ),
    "peak_to_peak": Quantity(
        "m", "2 A0", "Peak-to-peak stroke", "Twice the drive amplitude.", 0.0, parameter=True,
        examples=("1 mm",),
    ),
    "alpha": _angle(
        "alpha", "Drive azimuth",
        "Azimuth of the drive in the floor plane, from the track (+x) towards +y.", 180.0, "15 deg",
    ),
    "beta": _angle(
        "beta", "Drive elevation", "Elevation of the drive above the floor plane.", 180.0, "20 deg"
    ),
    # --- parameters: the track
    "gamma": _angle(
        "gamma", "Climb angle", "Climb angle of the track; +x goes uphill.", 90.0, "3 deg"
    ),
    "delta": _angle(
        "delta", "Lean angle", "Lean of the track; the part leans on the wall.", 90.0, "2 deg"
    ),
    "yaw": _angle(
        "theta", "Yaw of the axes", "Turn of the part's axes about the floor normal.", 180.0,
        "30 deg",
    ),
    "radius": _length("R", "Bowl radius", "Radius of the bowl's track wall.", "0.3 m"),
    "gravity": Quantity(
        "m s-2", "g", "Gravity", "Acceleration of gravity.", 0.0, strict=True, parameter=True,
        examples=("9.80665 m/s^2",),
    ),
    # --- parameters: the contact
    "friction": _friction(
        "mu", "Friction coefficient", "Coulomb friction coefficient, static and kinetic alike."
    ),
    "friction_static": _friction(
        "mu_s", "Static friction coefficient", "Coulomb friction coefficient at rest."
    ),
    "friction_kinetic": _friction(
        "mu_k", "Kinetic friction coefficient", "Coulomb friction coefficient in sliding."
    ),
    # --- parameters: the part
    "width": _length("a", "Part width", "Width of the rectangular part, across.", "10 mm"),
    "height": _length("b", "Part height", "Height of the rectangular part.", "1.5 mm"),
    "length": _length("h", "Part length", "Length of the part, along the track.", "50 mm"),
    "diameter": _length("d", "Part diameter", "Diameter of the cylindrical part.", "8 mm"),
    "mass": Quantity(
        "kg", "m", "Part mass", "Mass of the part.", 0.0, strict=True, parameter=True,
        examples=("5 g",),
    ),
    "restitution": Quantity(
        "1", "eps", "Restitution",
        "Coefficient of restitution: 0 for no rebound, 1 for full rebound.", 0.0, 1.0,
        parameter=True, examples=("0.5",),
    ),
    # --- parameters: the motion
    "speed": Quantity(
        "m s-1", "v0", "Speed", "Speed of the part along the track at the start.", 0.0,
        parameter=True, examples=("0.1 m/s",),
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
    "vibration_acceleration": _acceleration(
        "P", "Vibration acceleration", "Amplitude of the drive acceleration."
    ),
    "drive_along": _acceleration(
        "P cb ca", "Drive along the track", "Drive acceleration at its peak, along +x."
    ),
    "drive_across": _acceleration(
        "W", "Drive across the track", "Drive acceleration at its peak, along +y, off the wall."
    ),
    "drive_normal": _acceleration(
        "P sb", "Drive normal to the floor", "Drive acceleration at its peak, along +z, upwards."
    ),
    "gravity_along": _acceleration(
        "g sin(gamma)", "Gravity along the track", "Gravity component along -x, downhill."
    ),
    "gravity_across": _acceleration(
        "g_y", "Gravity towards the wall", "Gravity component along -y, towards the wall."
    ),
    "gravity_normal": _acceleration(
        "g_z", "Gravity onto the floor", "Gravity component along -z, onto the floor."
    ),
    "throw_number": Quantity(
        "1", "Gamma", "Throw number",
        "Drive normal to the floor over gravity normal to the floor; above 1 the part lifts off.",
    ),
    "normal_acceleration": _acceleration(
        "n0", "Normal acceleration",
        "Floor normal force per mass that keeps the part on the floor; negative after lift-off.",
    ),
    "floor_acceleration": _acceleration(
        "n", "Floor normal force per mass", "Floor normal force per mass that the variant uses."
    ),
    "centripetal_acceleration": _acceleration(
        "v^2/R", "Centripetal acceleration", "Acceleration that the curve asks for."
    ),
    # --- accelerations
    "in_plane_drive_x": _acceleration(
        "D_x", "Drive less gravity, x", "Drive less gravity along the track."
    ),
    "in_plane_drive_y": _acceleration(
        "D_y", "Drive less gravity, y", "Drive less gravity across the track, in the floor plane."
    ),
    "in_plane_drive": _acceleration(
        "|D|", "Drive less gravity in the plane", "Magnitude of drive less gravity in the floor."
    ),
    "sliding_fraction": Quantity(
        "1", "1 - mu n/|D|", "Sliding fraction",
        "Part of drive less gravity that friction leaves: 0 in stick, 1 in flight.",
    ),
    "roll_root": _acceleration(
        "z", "Root of the slip balance", "Positive root of the slip balance of a cylinder; 0 if it "
        "rolls.",
    ),
    "acceleration_x": _acceleration(
        "a_x", "Acceleration along the track",
        "Acceleration of the part relative to the track at the drive's peak, along the track.",
    ),
    "acceleration_y": _acceleration(
        "a_y", "Acceleration across the track",
        "Acceleration of the part relative to the track at the drive's peak, across the track.",
    ),
    "acceleration_z": _acceleration(
        "a_z", "Acceleration off the floor",
        "Acceleration of the part relative to the track at the drive's peak, off the floor.",
    ),
    "rotated_acceleration_x": _acceleration(
        "a_x'", "Acceleration along the turned x axis", "In-plane acceleration along the turned x."
    ),
    "rotated_acceleration_y": _acceleration(
        "a_y'", "Acceleration along the turned y axis", "In-plane acceleration along the turned y."
    ),
    "angular_acceleration": Quantity(
        "rad s-2", "psi..", "Angular acceleration",
        "Angular acceleration of the cylinder about its axis; positive rolls towards +y.",
    ),
    # --- travel on the track
    "starting_acceleration": _acceleration(
        "K", "Starting acceleration", "Acceleration along the track at zero speed."
    ),
    "transport_velocity": _velocity(
        "v(x)", "Velocity after the effective distance",
        "Kinematic estimate: speed after the effective distance with the drive held at its peak; "
        "not an average over the period.",
    ),
    "terminal_velocity": _velocity(
        "v_inf", "Terminal velocity", "Speed at which wall friction balances the peak drive."
    ),
    "travel_time": Quantity(
        "s", "t(x)", "Travel time", "Time to cover the effective distance, drive held at its peak."
    ),
    "mean_velocity": _velocity(
        "x/t(x)", "Mean velocity over the distance",
        "Effective distance over travel time; not an average over the period.",
    ),
    "velocity_at_time": _velocity(
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
    "velocity_bound": _velocity(
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
    "floor_force": _force("N", "Floor normal force", "Normal force of the floor on the part."),
    "wall_balance": _acceleration(
        "B", "Wall load", "Load on the wall per mass; negative where the part leaves the wall."
    ),
    "wall_acceleration": _acceleration(
        "s", "Wall force per mass", "Sum of the wall normal forces across the track, per mass."
    ),
    "wall_force": _force("S", "Wall force", "Sum of the wall normal forces, across the track."),
    "wall_force_rear": _force("lambda1", "Wall force, rear", "Wall force at the rear corner."),
    "wall_force_front": _force("lambda2", "Wall force, front", "Wall force at the front corner."),
    "chord_cosine": Quantity(
        "1", "cos(sigma)", "Chord cosine", "Cosine of the angle between part and wall at a corner."
    ),
    "wall_speed": _velocity("v_wall", "Wall contact speed", "Least speed with wall contact."),
    "z_residual": _acceleration(
        "az_residual", "Residual of the vertical balance",
        "What the model leaves in the force balance normal to the floor, per mass.",
    ),
    "pressure_offset_x": Quantity(
        "m", "e_x", "Centre of pressure, x", "Offset of the floor resultant along the track."
    ),
    "pressure_offset_y": Quantity(
        "m", "e_y", "Centre of pressure, y", "Offset of the floor resultant across the track."
    ),
    # --- rolling cylinder (chapter 4)
    "axis_yaw": _angle(
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
    "rolling_drive": _acceleration(
        "D_eta", "Drive in rolling direction",
        "Drive acceleration at its peak, along +eta, horizontal and across the axis.",
    ),
    "axial_drive": _acceleration(
        "D_sigma", "Drive along the axis",
        "Drive acceleration at its peak, along +sigma, the cylinder's axis.",
    ),
    "axial_friction_acceleration": _acceleration(
        "F_sigma/m", "Axial friction per mass",
        "Friction along the axis per mass that pure rolling asks for; positive acts along -sigma.",
    ),
    "rolling_friction": _force(
        "F_eta", "Friction in rolling direction",
        "Friction that pure rolling asks for; positive acts along -eta.",
    ),
    "axial_friction": _force(
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
        "Yaw rate that the source asks for: the one with the floor resultant at mid-length. A "
        "diagnostic; it contradicts (4.18) and (4.19).",
    ),
    "pressure_offset_axial": Quantity(
        "m", "e", "Centre of pressure, axial",
        "Offset of the floor's normal force from mid-length, along +sigma.",
    ),
    "required_friction": Quantity(
        "1", "mu_req", "Required friction coefficient",
        "Least static friction coefficient with which the cylinder rolls without slip.",
    ),
    "cone_margin": _force(
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
    # --- an isolated part with one corner on a plane: parameters
    "pitch": _angle(
        "xi", "Pitch", "Turn of the part in its plane of motion, clockwise: its right corner dips.",
        180.0, "20 deg",
    ),
    "pitch_rate": Quantity(
        "rad s-1", "xi.", "Pitch rate", "Rate of the pitch, clockwise.", parameter=True,
        examples=("2 rad/s", "-90 deg/s"),
    ),
    "centre_along": Quantity(
        "m", "x", "Centre along the plane", "Place of the part's centre along the plane.",
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
    # --- an isolated part with one corner on a plane: outputs
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
    "half_diagonal": Quantity("m", "rho", "Half diagonal", "From the centre to the corner."),
    "inertia_ratio": Quantity(
        "1", "kappa", "Inertia ratio",
        "Mass times squared half diagonal over the moment of inertia about the centre.",
    ),
    "touching_height": Quantity(
        "m", "rho sin(s)", "Touching height", "Height of the centre at which the corner touches."
    ),
    "pivot_velocity_along": _velocity(
        "rho xi. sin(s)", "Pivot velocity along the plane",
        "Velocity of the centre along the plane at which the corner is at rest.",
    ),
    "pivot_velocity_upward": _velocity(
        "rho xi. cos(s)", "Upward pivot velocity",
        "Upward velocity of the centre at which the corner keeps its height.",
    ),
    "gap_normal": Quantity("m", "g_N", "Gap", "Height of the corner above the plane."),
    "gap_tangential": Quantity("m", "g_T", "Corner place", "Place of the corner along the plane."),
    "gap_normal_rate": _velocity("g_N.", "Gap rate", "Velocity of the corner off the plane."),
    "gap_tangential_rate": _velocity(
        "g_T.", "Slip velocity", "Velocity of the corner along the plane, to the right."
    ),
    "gap_normal_acceleration": _acceleration(
        "g_N..", "Second gap rate", "Acceleration of the corner off the plane."
    ),
    "gap_tangential_acceleration": _acceleration(
        "g_T..", "Slip acceleration", "Acceleration of the corner along the plane."
    ),
    "free_normal_acceleration": _acceleration(
        "chi", "Free acceleration off the plane",
        "Acceleration of the corner off the plane without contact force.",
    ),
    "free_tangential_acceleration": _acceleration(
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
    "holding_normal_acceleration": _acceleration(
        "n_0", "Holding normal force per mass",
        "Normal force per mass that keeps the corner at rest; negative where it had to pull.",
    ),
    "holding_tangential_acceleration": _acceleration(
        "t_0", "Holding friction per mass", "Friction force per mass that keeps the corner at rest."
    ),
    "slip_direction": Quantity(
        "1", "sigma_s", "Slip direction",
        "1 where the corner slips, or starts to slip, to the right, -1 to the left, else 0.",
    ),
    "contact_case": Quantity(
        "1", "case", "Contact case", "Number of the case of the contact.", bundle=True
    ),
    "friction_force": _force(
        "lambda_T", "Friction force", "Friction force of the plane on the corner, to the right."
    ),
    "acceleration_along": _acceleration(
        "x..", "Centre acceleration along the plane",
        "Acceleration of the part's centre along the plane.",
    ),
    "acceleration_upward": _acceleration(
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
    "regime": Quantity("1", "regime", "Regime", "State of the contacts in each cell."),
    # --- impacts of two bodies
    **_pair_impact(),
    # --- motion in time
    **_motion(),
    # --- the best values
    **_optimum(),
}  # fmt: skip


@dataclass(frozen=True)
class Flag:
    """A value of a flag variable, such as a state that a cell can be in.

    Attributes
    ----------
    value : int
        The number that stands in files.
    description : str
        What it says to the user.
    valid : bool
        False where the values of the cell do not describe a real part.
    """

    value: int
    description: str
    valid: bool = True


REGIMES: dict[str, Flag] = {
    "not_assessed": Flag(0, "the asked outputs do not depend on any contact"),
    "contact": Flag(1, "the part is in contact; stick or slip does not matter here"),
    "stick": Flag(2, "friction holds the part; it does not move"),
    "slip": Flag(3, "the part slides"),
    "roll": Flag(4, "the cylinder rolls without slip"),
    "flight": Flag(5, "the part has left the floor", valid=False),
    "wall_lost": Flag(6, "the part has left the wall", valid=False),
    "flight_and_wall_lost": Flag(7, "the part has left floor and wall", valid=False),
    "no_motion": Flag(8, "the drive is too weak to start forward motion"),
    "stopped": Flag(9, "the part stops before the distance or time is reached"),
    "outside_cone": Flag(10, "the forces lie outside the friction cone", valid=False),
    "invalid_geometry": Flag(11, "the part does not fit the track or the model", valid=False),
    "tipping": Flag(12, "the centre of pressure leaves the base: the part tips", valid=False),
    "faster_than_track": Flag(13, "the estimate exceeds the largest track speed", valid=False),
    "unbounded": Flag(14, "no finite value exists: nothing limits it"),
    "separation": Flag(15, "the corner leaves the plane"),
    "sliding": Flag(16, "the corner slides on the plane, or starts to"),
    "two_solutions": Flag(17, "more than one contact force satisfies the model", valid=False),
    "no_solution": Flag(18, "no contact force satisfies the model", valid=False),
    # --- impacts of two bodies
    "apart": Flag(19, "the bodies do not touch; nothing happens"),
    "overlap": Flag(20, "the bodies overlap: no such placement is possible", valid=False),
    "no_impact": Flag(21, "the bodies touch but do not approach; nothing happens"),
    "impact_stick": Flag(22, "they collide and do not slide on each other at the end"),
    "impact_slip": Flag(23, "they collide and slide on each other at the end"),
    "simultaneous": Flag(
        24, "they meet at several points at once, or edge to edge: the law does not tell more",
        valid=False,
    ),
    "impact": Flag(25, "they collide"),
    "singular": Flag(26, "the formula divides by zero here: it has no value", valid=False),
    # --- motion in time
    "stick_slip": Flag(27, "the part sticks for a part of the period and slides for the rest"),
    "hopping": Flag(28, "the part hops once a period or more often, and touches the floor between"),
    "hop_after_hop": Flag(29, "the part hops without touching the floor between"),
    "period_doubled": Flag(30, "the motion repeats after two periods of the drive or more"),
    "aperiodic": Flag(31, "the motion does not repeat; values are means over many periods"),
    "runaway": Flag(32, "the part gains speed for ever; it has no mean velocity", valid=False),
    "unresolved": Flag(
        33, "no answer: the study was stopped, or a limit came first", valid=False
    ),
    "rests": Flag(34, "the part has come to rest on a side"),
    "tumbles": Flag(35, "the part still moves at the end of the duration"),
}  # fmt: skip

MOTION_STATUSES: dict[str, Flag] = {
    "not_computed": Flag(0, "the study was stopped before this cell", valid=False),
    "periodic": Flag(1, "the motion repeats after a whole number of periods"),
    "at_rest": Flag(2, "friction holds the part; it does not move"),
    "aperiodic": Flag(3, "the motion does not repeat; mean and spread over many periods"),
    "runaway": Flag(4, "the part gains speed for ever; it has no mean velocity", valid=False),
    "neutral": Flag(5, "no friction: the speed is that of the start, at rest on the track"),
    "limit_reached": Flag(6, "a limit, or rounding, came before an answer", valid=False),
    "no_solution": Flag(7, "the contact laws had no solution, or several", valid=False),
    "settled": Flag(8, "the part has come to rest on a side"),
    "moving": Flag(9, "the part still moves at the end of the duration"),
}

MOTION_MODES: dict[str, Flag] = {
    "stick": Flag(0, "friction holds the part on the track"),
    "forward": Flag(1, "the part slides forward"),
    "backward": Flag(2, "the part slides backward"),
    "flight": Flag(3, "the part is off the floor"),
    "unknown": Flag(4, "no motion was found for this time", valid=False),
}
