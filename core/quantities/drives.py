"""Drives that are no plain sine, drive units, and the track of a bowl on one."""

from vibrafeed.core.quantities.quantity import Quantity, angle, friction, length, number, velocity

# --- Drives that are no plain sine: harmonics on every axis, and steps of acceleration.


AXES = ("along", "across", "normal")
"""Of the track: +x in transport direction, +y off the wall, +z off the floor."""

MAX_ORDERS = 10
"""Harmonics of an axis."""

MAX_STEPS = 12
"""Pieces of constant acceleration in a period."""

WHERE = {"along": "along the track", "across": "across the track", "normal": "off the floor"}


def _times(order: int) -> str:
    return "the drive frequency" if order == 1 else f"{order} times the drive frequency"


_WAYS = [(letter, axis, WHERE[axis]) for letter, axis in zip("xyz", AXES, strict=True)]
_ORDERS, _STEPS = range(1, MAX_ORDERS + 1), range(1, MAX_STEPS + 1)
DRIVE: dict[str, Quantity] = {
    "drive_factor": Quantity(
        "1", "q", "Factor of the drive",
        "Factor by which every amplitude or acceleration of the drive is multiplied.", 0.0,
        parameter=True, examples=("1.2",),
    ),
    **{
        f"amplitude_{axis}_{n}": Quantity(
            "m", f"A{letter}{n}", f"Amplitude {axis}, order {n}",
            f"Amplitude of the track's motion {where} at {_times(n)}, zero to peak.", 0.0,
            parameter=True, examples=("0.1 mm",), usual=(1e-9, 0.025),
        )
        for letter, axis, where in _WAYS for n in _ORDERS
    },
    **{
        f"phase_{axis}_{n}": angle(
            f"phi{letter}{n}", f"Phase {axis}, order {n}",
            f"Lead of the track's motion {where} at {_times(n)}: the displacement is "
            f"A sin({n if n > 1 else ''} w t + phi).", 720.0, "90 deg",
        )
        for letter, axis, where in _WAYS for n in _ORDERS
    },
    "ellipse_major": Quantity(
        "m", "a", "Semi-major axis", "Semi-major axis of an elliptical drive.", 0.0,
        parameter=True, examples=("0.3 mm",), usual=(1e-9, 0.025),
    ),
    "ellipse_minor": Quantity(
        "m", "b", "Semi-minor axis",
        "Semi-minor axis of an elliptical drive: above 0 the track moves forward at the bottom, "
        "below 0 it turns the other way.", parameter=True, examples=("0.1 mm",),
    ),
    "ellipse_tilt": angle(
        "theta", "Tilt of the ellipse", "Angle of the semi-major axis above the track.", 180.0,
        "15 deg",
    ),
    **{
        f"acceleration_{axis}_{n}": Quantity(
            "m s-2", f"a{letter}{n}", f"Acceleration {axis}, step {n}",
            f"Acceleration of the track {where} during step {n} of a period.",
            parameter=True, examples=("4 m/s^2",),
        )
        for letter, axis, where in _WAYS for n in _STEPS
    },
    **{
        f"duration_{n}": Quantity(
            "1", f"T{n}", f"Duration of step {n}",
            f"Relative duration of step {n}; the durations of all steps divide the period.", 0.0,
            parameter=True, examples=("0.25",),
        )
        for n in _STEPS
    },
    "wave": Quantity("1", "", "Wave", "The push of the drive on a part, per weight.", bundle=True),
    **{
        f"{stem}_{axis}": Quantity(
            unit, symbol.format(letter), f"{label} {axis}", says.format(where)
        )
        for letter, axis, where in _WAYS
        for stem, unit, symbol, label, says in (
            ("largest_acceleration", "m s-2", "max |a_{}|", "Largest acceleration",
             "Largest acceleration of the track {} over a period."),
            ("stroke", "m", "s_{}", "Stroke", "How far the track moves {}, peak to peak."),
            ("largest_jerk", "m s-3", "max |j_{}|", "Largest jerk",
             "Largest jerk of the track {}; infinite where its acceleration jumps."),
        )
    },
}  # fmt: skip


# --- Drive units, and the track of a bowl on one.


MAX_STRETCHES = 6
"""Stretches of a track: the inner turns, a lined part, a steeper one, the exit, and two more."""


OF_STRETCHES = ("stretch_turns", "stretch_radius", "stretch_climb", "stretch_friction")
"""What each stretch of a track has, by the stem of its name."""


def _fraction(label: str, says: str, example: str) -> Quantity:
    return Quantity("1", "x", label, says, 0.0, 1.0, parameter=True, examples=(example,))


_STRETCHES = range(1, MAX_STRETCHES + 1)
BOWL_TRACK: dict[str, Quantity] = {
    "track_fraction": _fraction(
        "Share of the track",
        "Share of the track's length behind the part: 0 at its start, 1 at the exit.", "0.5",
    ),
    "start_radius": length("R_0", "Radius at the start", "Radius at which the track starts.",
                           "100 mm"),
    **{
        f"stretch_turns_{n}": Quantity(
            "1", f"n_{n}", f"Turns, stretch {n}", f"Turns of stretch {n} of the track.", 0.0,
            strict=True, parameter=True, examples=("1.5",), usual=(1e-3, 20.0),
        )
        for n in _STRETCHES
    },
    **{
        f"stretch_radius_{n}": length(
            f"R_{n}", f"Radius, end of stretch {n}", f"Radius at the end of stretch {n}.", "150 mm"
        )
        for n in _STRETCHES
    },
    **{
        f"stretch_climb_{n}": angle(
            f"gamma_{n}", f"Climb, stretch {n}",
            f"Climb of stretch {n}; that of the stretch before unless given.", 80.0, "3 deg",
            (-15.0, 15.0),
        )
        for n in _STRETCHES
    },
    **{
        f"stretch_friction_{n}": friction(
            f"mu_{n}", f"Friction, stretch {n}",
            f"Coefficient of friction on stretch {n}; that of the stretch before unless given.",
        )
        for n in _STRETCHES
    },
    "load_radius": length(
        "R_l", "Radius of the load",
        "Radius of the load; by default that of the part.", "180 mm",
    ),
    "load_fraction": _fraction(
        "Share of the track, load",
        "Share of the track's length at which the load of all its parts is taken to act.", "0.5",
    ),
    "stretches": Quantity("1", "", "Stretches", "The stretches of a track.", bundle=True),
    "passage": Quantity("1", "", "Passage", "Passage of parts along the whole track.", bundle=True),
    "track_length": Quantity("m", "L", "Length of the track",
    "Length of the track from its start to the "
    "exit."),
    "track_radius": Quantity("m", "R", "Radius of the track", "Radius of the track at its place."),
    "transit_time": Quantity(
        "s", "T", "Transit time", "Time of a part on the track, start to exit; infinite if it "
        "stops on the way.",
    ),
    "transit_time_error": Quantity(
        "s", "e(T)", "Error of the transit time",
        "Time that the speeds between the places where the motion is followed may add.",
        error_of="transit_time",
    ),
    "bottleneck_velocity": velocity(
        "v_b", "Velocity at the bottleneck", "Least mean velocity along the track."
    ),
    "bottleneck_velocity_error": Quantity(
        "m s-1", "e(v_b)", "Error of the velocity at the bottleneck",
        "How much slower a part may be between the places where the motion is followed.",
        error_of="bottleneck_velocity",
    ),
    "bottleneck_fraction": Quantity(
        "1", "x_b", "Share of the track, bottleneck",
        "Share of the track's length at which parts are slowest.",
    ),
    "bottleneck_radius": Quantity(
        "m", "R_b", "Radius of the bottleneck", "Radius at which parts are slowest."
    ),
    "track_feed_rate": Quantity(
        "min-1", "F", "Feed rate of the track",
        "Parts per minute that can pass the whole track, limited by its bottleneck.",
    ),
}  # fmt: skip


def _input(
    unit: str, symbol: str, label: str, says: str, example: str, *, strict: bool
) -> Quantity:
    return Quantity(
        unit, symbol, label, says, 0.0, strict=strict, parameter=True, examples=(example,)
    )


def _offset(symbol: str, label: str, says: str) -> Quantity:
    return Quantity("m", symbol, label, says, parameter=True, examples=("0 mm",), usual=(1e-5, 5.0))


DRIVE_UNIT: dict[str, Quantity] = {
    "moving_mass": _input(
        "kg", "m_1", "Moving mass", "Mass of the trough or bowl and its fixtures.", "10 kg",
        strict=True,
    ),
    "base_mass": _input(
        "kg", "m_2", "Base mass", "Mass of the base, or counter-mass.", "30 kg", strict=True
    ),
    "load_mass": _input(
        "kg", "m_l", "Load", "Mass of parts that move with the track, neither sliding nor hopping.",
        "0.5 kg", strict=False,
    ),
    "load_damping": _input(
        "N s m-1", "c_l", "Damping by the load",
        "Damping between track and ground by parts that slide and hop.", "40 N s/m",
        strict=False,
    ),
    "conveyed_mass": _input(
        "kg", "m_p", "Conveyed mass",
        "Mass of all parts that travel on the track; amplitude and motion are found together.",
        "0.5 kg", strict=False,
    ),
    "moving_inertia": _input(
        "kg m2", "I_1", "Inertia of the bowl", "Moment of inertia of the bowl about its axis.",
        "0.25 kg m^2", strict=True,
    ),
    "base_inertia": _input(
        "kg m2", "I_2", "Inertia of the base", "Moment of inertia of the base about the same axis.",
        "0.9 kg m^2", strict=True,
    ),
    "spring_radius": length(
        "r_s", "Radius of the springs", "Radius from the bowl's axis to the leaf springs.", "150 mm"
    ),
    "spring_angle": angle(
        "th", "Tilt of the springs",
        "Tilt of the leaf springs from the vertical; equals the "
        "drive's angle of a linear unit.", 89.0,
        "20 deg", (1.0, 60.0),
    ),
    "spring_count": Quantity(
        "1", "n", "Number of leaves",
        "Number of leaf springs in all packs, separated by spacers.", 0.0, strict=True,
        parameter=True, examples=("8",), count=True,
    ),
    "spring_width": length("b", "Width of a leaf", "Width of a leaf spring.", "40 mm"),
    "spring_thickness": length("t", "Thickness of a leaf", "Thickness of a leaf spring.", "3 mm"),
    "spring_length": length(
        "L", "Free length of a leaf", "Length of a leaf spring between its clamps.", "100 mm"
    ),
    "elastic_modulus": _input(
        "Pa", "E", "Elastic modulus", "Elastic modulus of the leaf springs: 206 GPa for spring "
        "steel.", "206 GPa",
        strict=True,
    ),
    "spring_density": _input(
        "kg m-3", "rho", "Density of the leaves",
        "Density of the leaf springs: 7850 kg/m^3 for spring "
        "steel.",
        "7850 kg/m^3", strict=True,
    ),
    "clamp_factor": _input(
        "1", "c_k", "Clamp factor", "Stiffness of the leaf springs relative to rigid "
        "clamps.", "0.9",
        strict=True,
    ),
    "allowable_stress": _input(
        "Pa", "sigma_a", "Allowable stress", "Bending stress that the leaf springs endure "
        "permanently.",
        "250 MPa", strict=True,
    ),
    "ring_down_frequency": _input(
        "Hz", "f_0", "Measured natural frequency",
        "Frequency at which the empty unit vibrates freely after a knock.", "53 Hz", strict=True,
    ),
    "damping_ratio": _input(
        "1", "zeta", "Damping ratio", "Logarithmic decrement of the ring-down over 2 pi.", "0.02",
        strict=True,
    ),
    "drive_force": _input(
        "N", "F", "Force of the drive",
        "Amplitude of the force between both masses, at the drive's frequency; a magnet's follows "
        "from flux_density and pole_area, or from drive_voltage and one measured amplitude; an "
        "unbalance's from unbalance.",
        "100 N", strict=True,
    ),
    "flux_density": _input(
        "T", "B", "Flux density", "Peak of the flux density in the magnet's gap.", "0.5 T",
        strict=True,
    ),
    "pole_area": _input(
        "m2", "A", "Pole area", "Area of all poles of the magnet that pull.", "12 cm^2", strict=True
    ),
    "drive_voltage": _input(
        "V", "U", "Voltage of the drive",
        "Voltage of the controller; the force follows from the amplitude measured at another one.",
        "180 V", strict=True,
    ),
    "measured_voltage": _input(
        "V", "U_m", "Measured voltage", "Voltage at which measured_amplitude was measured.",
        "150 V", strict=True,
    ),
    "measured_amplitude": length(
        "A_m", "Measured amplitude",
        "Amplitude of the empty track at measured_voltage and measured_frequency, zero to peak: "
        "half of the stroke.", "0.15 mm",
    ),
    "measured_frequency": _input(
        "Hz", "f_m", "Measured frequency", "Frequency at which measured_amplitude was measured.",
        "50 Hz", strict=True,
    ),
    "measured_radius": length(
        "R_m", "Measured radius",
        "Radius of a bowl at which measured_amplitude was measured.", "200 mm",
    ),
    "force_exponent": _input(
        "1", "n", "Exponent of the force",
        "Exponent by which the force grows with the voltage: 2 of a magnet without saturation.",
        "2", strict=True,
    ),
    "measured_response": Quantity(
        "m", "", "Measured response", "Amplitude of the empty track per newton.", bundle=True
    ),
    "force_harmonic": Quantity(
        "1", "F_2/F_1", "Second harmonic of the force",
        "Second harmonic over the first: 0.25 of a magnet on a half "
        "wave that pulls the track back and down, -0.25 "
        "of one that pulls it forward and up, 0 on a full wave.",
        -1.0, 1.0, parameter=True, examples=("0.25",),
    ),
    "offset_along": _offset("d_x", "Mass centres along", "Moving mass centre ahead of the base's."),
    "offset_upward": _offset("d_z", "Mass centres upward", "Moving mass centre above the base's."),
    "spot_along": _offset("p_x", "Place along", "Place on the track ahead of the mass centre."),
    "spot_upward": _offset("p_z", "Place upward", "Place on the track above the mass centre."),
    "unbalance": _input(
        "kg m", "m_u r", "Unbalance", "Mass of an unbalance times its radius.", "0.002 kg m",
        strict=True,
    ),
    "air_gap": length("g_0", "Air gap", "Air gap of the magnet at rest, along the stroke.", "2 mm"),
    "foot_stiffness": _input(
        "N m-1", "k_f", "Stiffness of the feet", "Stiffness of all feet together; 0 if the base is "
        "free.",
        "50000 N/m", strict=False,
    ),
    "foot_damping": _input(
        "N s m-1", "c_f", "Damping of the feet",
        "Damping of all feet together.", "100 N s/m", strict=False
    ),
    "circular_frequency": Quantity(
        "rad s-1", "w", "Circular frequency", "2 pi times the drive's frequency."
    ),
    "spring_stiffness": _input(
        "N m-1", "k", "Stiffness of the springs",
        "Stiffness of all leaf springs along the stroke; computed from their sizes by default.",
        "1000 N/mm", strict=True,
    ),
    "generalised_mass": Quantity(
        "kg", "m", "Mass of the stroke", "Mass that the stroke of the empty unit moves, base free."
    ),
    "loaded_mass": Quantity("kg", "m_1", "Moving mass with load", "Moving mass and load."),
    "loaded_inertia": Quantity(
        "kg m2", "I_1", "Inertia with load", "Inertia of the bowl and of the load on its track."
    ),
    "bowl_mass": Quantity(
        "kg", "m", "Mass of the stroke with load", "Mass that the stroke moves, base free."
    ),
    "damping": Quantity("N s m-1", "c", "Damping of the springs",
    "Damping coefficient that acts beside the "
    "springs."),
    "stroke_response": Quantity("m", "", "Response", "Strokes of the masses with their "
    "phases.", bundle=True),
    "natural_frequency": Quantity(
        "Hz", "f_n", "Natural frequency", "Natural frequency of the spring mode, with the load."
    ),
    "foot_frequency": Quantity(
        "Hz", "f_f", "Frequency on the feet",
        "Natural frequency of the whole unit on its feet; 0 if it is "
        "free."
    ),
    "stroke": Quantity(
        "m", "s", "Stroke between the masses",
        "Amplitude of the relative stroke at the leaves, zero to peak.",
    ),
    "phase": Quantity(
        "degree", "phi", "Phase", "Phase of the stroke relative to the force: -90 degrees at "
        "resonance."
    ),
    "amplification": number("k s/F", "Amplification",
    "Stroke relative to the static deflection by the same "
    "force."),
    "second_harmonic": number(
        "4 A_2/A_1", "Second harmonic", "Second harmonic of the track's acceleration over the "
        "first."
    ),
    "track_harmonic": Quantity(
        "1", "", "Second harmonic of the track",
        "Sine and cosine of the track's second harmonic, over the "
        "first.",
        bundle=True,
    ),
    "turning_mass": Quantity(
        "kg", "m", "Mass of the turning stroke", "Effective mass of the stroke of a unit that "
        "turns."
    ),
    "trough_turn": Quantity(
        "rad", "phi", "Turn of the trough", "Amplitude of the turning; positive lifts the front."
    ),
    "track_motion": Quantity("m", "", "Motion of a place",
    "Amplitudes along the floor and upward at a point of the "
    "trough.", bundle=True),
    "track_amplitude": Quantity(
        "m", "A_0", "Amplitude of the track",
        "Amplitude of the track itself, zero to peak: the amplitude of a study of motion.",
    ),
    "vibration_angle": Quantity(
        "degree", "beta", "Vibration angle",
        "Angle of the vibration above the track: beta of a study of motion.",
    ),
    "bowl_turn": Quantity("rad", "Theta_1", "Turn of the bowl", "Amplitude of the bowl's turning."),
    "bowl_lift": Quantity("m", "z_1", "Lift of the bowl", "Amplitude of the bowl's lift."),
    "part_load": Quantity("1", "", "Load by parts",
    "Effective mass and damping of the parts on the "
    "track.", bundle=True),
    "effective_mass": Quantity(
        "kg", "m_e", "Effective mass of the parts",
        "Effective mass of the parts, as the drive feels "
        "it."
    ),
    "effective_damping": Quantity(
        "N s m-1", "c_e", "Effective damping by the parts",
        "Effective damping between track and ground by the parts.",
    ),
    "largest_amplitude": Quantity(
        "m", "A_0", "Largest amplitude",
        "Largest amplitude at which drive and parts agree; the smallest is the one from rest.",
    ),
    "leaf_frequency": Quantity(
        "Hz", "f_1", "Natural frequency of a leaf",
        "Natural frequency of a leaf clamped at both ends; the "
        "drive's must stay below a third of it.",
    ),
    "leaf_mass": Quantity(
        "kg", "", "Moving mass of the leaves",
        "Mass of the leaf springs that moves with either end while the other is held.",
    ),
    "spring_stress": Quantity(
        "Pa", "sigma", "Stress of the leaves", "Bending stress at the clamps, zero to peak."
    ),
    "stress_margin": Quantity(
        "Pa", "", "Margin of stress", "Allowable stress minus the stress of the leaf springs."
    ),
    "air_gap_margin": Quantity(
        "m", "", "Margin of the air gap", "Remaining air gap at the end of the stroke."
    ),
    "foot_force": Quantity(
        "N", "F_f", "Force on the floor", "Amplitude of the force of all feet on the floor."
    ),
    "drive_unit_power": Quantity(
        "W", "", "Power of the drive", "Mean power of the force, which the dampers take."
    ),
}  # fmt: skip
