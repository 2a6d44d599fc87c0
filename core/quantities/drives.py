"""Drives that are no plain sine, drive units, and the track of a bowl on one."""

from vibrafeed.core.quantities.quantity import Quantity, angle, friction, length, number, velocity

# --- Drives that are no plain sine: harmonics on every axis, and steps of acceleration.


AXES = ("along", "across", "normal")
"""Of the track: +x in transport direction, +y off the wall, +z off the floor."""

MAX_ORDERS = 10
"""Harmonics of an axis."""

MAX_STEPS = 12
"""Pieces of constant acceleration in a period."""

WHERE = {"along": "along the track", "across": "across the track", "normal": "normal to the floor"}


def _times(order: int) -> str:
    return "the drive frequency" if order == 1 else f"{order} times the drive frequency"


_WAYS = [(letter, axis, WHERE[axis]) for letter, axis in zip("xyz", AXES, strict=True)]
_ORDERS, _STEPS = range(1, MAX_ORDERS + 1), range(1, MAX_STEPS + 1)
DRIVE: dict[str, Quantity] = {
    "drive_factor": Quantity(
        "1", "q", "Factor of the drive",
        "Factor that multiplies every amplitude and every acceleration of the drive.", 0.0,
        parameter=True, examples=("1.2",),
    ),
    **{
        f"amplitude_{axis}_{n}": Quantity(
            "m", f"A{letter}{n}", f"Amplitude {axis}, order {n}",
            f"Amplitude of the drive {where} at {_times(n)}, zero to peak.", 0.0,
            parameter=True, examples=("0.1 mm",), usual=(1e-9, 0.025),
        )
        for letter, axis, where in _WAYS for n in _ORDERS
    },
    **{
        f"phase_{axis}_{n}": angle(
            f"phi{letter}{n}", f"Phase {axis}, order {n}",
            f"Phase phi of the drive {where} at {_times(n)}. The displacement is "
            f"A sin({f'{n} ' if n > 1 else ''}w t + phi).", 720.0, "90 deg",
        )
        for letter, axis, where in _WAYS for n in _ORDERS
    },
    "ellipse_major": Quantity(
        "m", "a", "Semi-major axis",
        "Semi-major axis of the ellipse on which the track moves.", 0.0,
        parameter=True, examples=("0.3 mm",), usual=(1e-9, 0.025),
    ),
    "ellipse_minor": Quantity(
        "m", "b", "Semi-minor axis",
        "Semi-minor axis of the ellipse on which the track moves. With a positive value the track "
        "moves forward at the bottom of the ellipse, with a negative value backward.",
        parameter=True, examples=("0.1 mm",),
    ),
    "ellipse_tilt": angle(
        "theta", "Tilt of the ellipse",
        "Angle above the track of the major axis of the ellipse on which the track moves.", 180.0,
        "15 deg",
    ),
    **{
        f"acceleration_{axis}_{n}": Quantity(
            "m s-2", f"a{letter}{n}", f"Acceleration {axis}, step {n}",
            f"Acceleration of the drive {where} during step {n} of a period.",
            parameter=True, examples=("4 m/s^2",),
        )
        for letter, axis, where in _WAYS for n in _STEPS
    },
    **{
        f"duration_{n}": Quantity(
            "1", f"T{n}", f"Duration of step {n}",
            f"Duration of step {n} of the drive, relative to the other steps. All steps together "
            "fill the period.", 0.0, parameter=True, examples=("0.25",),
        )
        for n in _STEPS
    },
    "wave": Quantity("1", "", "Wave",
        "Push of the drive on a part, divided by the weight of the part.", bundle=True),
    **{
        f"{stem}_{axis}": Quantity(
            unit, symbol.format(letter), f"{label} {axis}", says.format(where)
        )
        for letter, axis, where in _WAYS
        for stem, unit, symbol, label, says in (
            ("largest_acceleration", "m s-2", "max |a_{}|", "Largest acceleration",
             "Largest acceleration of the drive {} in a period."),
            ("stroke", "m", "s_{}", "Stroke", "Stroke of the drive {}, peak to peak."),
            ("largest_jerk", "m s-3", "max |j_{}|", "Largest jerk",
             "Largest jerk of the drive {}; infinite if its acceleration jumps."),
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
        "Position of the part on the track, as a share of the track's length: 0 at its start, 1 "
        "at the exit.", "0.5",
    ),
    "start_radius": length("R_0", "Radius at the start", "Radius of the track at its start.",
                           "100 mm"),
    **{
        f"stretch_turns_{n}": Quantity(
            "1", f"n_{n}", f"Turns, stretch {n}",
            f"Number of turns about the bowl's axis in stretch {n} of the track.", 0.0,
            strict=True, parameter=True, examples=("1.5",), usual=(1e-3, 20.0),
        )
        for n in _STRETCHES
    },
    **{
        f"stretch_radius_{n}": length(
            f"R_{n}", f"Radius, end of stretch {n}",
            f"Radius of the track at the end of stretch {n}.", "150 mm"
        )
        for n in _STRETCHES
    },
    **{
        f"stretch_climb_{n}": angle(
            f"gamma_{n}", f"Climb, stretch {n}",
            f"Climb angle of stretch {n} of the track; by default that of the stretch before.",
            80.0, "3 deg",
            (-15.0, 15.0),
        )
        for n in _STRETCHES
    },
    **{
        f"stretch_friction_{n}": friction(
            f"mu_{n}", f"Friction, stretch {n}",
            f"Coefficient of friction on stretch {n} of the track; by default that of the stretch "
            "before.",
        )
        for n in _STRETCHES
    },
    "load_radius": length(
        "R_l", "Radius of the load",
        "Distance from the bowl's axis at which the load acts; by default the radius of the track "
        "at the part.", "180 mm",
    ),
    "load_fraction": _fraction(
        "Share of the track, load",
        "Position on the track, as a share of the track's length, where the load of all parts on "
        "the track is assumed to act.", "0.5",
    ),
    "stretches": Quantity("1", "", "Stretches", "Stretches of the track.", bundle=True),
    "passage": Quantity("1", "", "Passage", "Passage of parts along the whole track.", bundle=True),
    "track_length": Quantity("m", "L", "Length of the track",
    "Length of the track from its start to the exit."),
    "track_radius": Quantity("m", "R", "Radius of the track",
        "Radius of the track at the position track_fraction."),
    "transit_time": Quantity(
        "s", "T", "Transit time",
        "Time that a part needs from the start of the track to the exit; infinite if the part "
        "stops on the way.",
    ),
    "transit_time_error": Quantity(
        "s", "e(T)", "Error of the transit time",
        "Error of the transit time: the time that a part may lose between the places of the track "
        "at which its motion is simulated.",
        error_of="transit_time",
    ),
    "bottleneck_velocity": velocity(
        "v_b", "Velocity at the bottleneck",
        "Mean velocity of the parts at the slowest place of the track."
    ),
    "bottleneck_velocity_error": Quantity(
        "m s-1", "e(v_b)", "Error of the velocity at the bottleneck",
        "Error of the velocity at the bottleneck: a part may be slower by this amount between the "
        "places of the track at which its motion is simulated.",
        error_of="bottleneck_velocity",
    ),
    "bottleneck_fraction": Quantity(
        "1", "x_b", "Share of the track, bottleneck",
        "Position on the track, as a share of the track's length, where the parts are slowest.",
    ),
    "bottleneck_radius": Quantity(
        "m", "R_b", "Radius of the bottleneck",
        "Radius of the track at the place where the parts are slowest."
    ),
    "track_feed_rate": Quantity(
        "min-1", "F", "Feed rate of the track",
        "Number of parts per minute that can pass the whole track; the slowest place of the track "
        "sets the limit.",
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
        "kg", "m_1", "Moving mass",
        "Mass of the trough or bowl with everything that is fixed to it.", "10 kg",
        strict=True,
    ),
    "base_mass": _input(
        "kg", "m_2", "Base mass", "Mass of the base or counter-mass.", "30 kg", strict=True
    ),
    "load_mass": _input(
        "kg", "m_l", "Load",
        "Mass of the parts that move with the track and neither slide nor hop.",
        "0.5 kg", strict=False,
    ),
    "load_damping": _input(
        "N s m-1", "c_l", "Damping by the load",
        "Damping between track and ground that sliding and hopping parts cause.", "40 N s/m",
        strict=False,
    ),
    "conveyed_mass": _input(
        "kg", "m_p", "Conveyed mass",
        "Mass of all parts that travel on the track. Their motion and the amplitude of the track "
        "are computed together.",
        "0.5 kg", strict=False,
    ),
    "moving_inertia": _input(
        "kg m2", "I_1", "Inertia of the bowl",
        "Moment of inertia of the bowl about its axis, or of a trough about its mass centre.",
        "0.25 kg m^2", strict=True,
    ),
    "base_inertia": _input(
        "kg m2", "I_2", "Inertia of the base",
        "Moment of inertia of the base about the bowl's axis, or about its own mass centre in a "
        "linear unit.",
        "0.9 kg m^2", strict=True,
    ),
    "spring_radius": length(
        "r_s", "Radius of the springs",
        "Distance of the leaf springs from the bowl's axis.", "150 mm"
    ),
    "spring_angle": angle(
        "th", "Tilt of the springs",
        "Angle by which the leaf springs lean from the vertical; in a linear unit it equals the "
        "angle of the drive.", 89.0,
        "20 deg", (1.0, 60.0),
    ),
    "spring_count": Quantity(
        "1", "n", "Number of leaves",
        "Total number of leaf springs in all packs, with spacers between the leaves.",
        0.0, strict=True,
        parameter=True, examples=("8",), count=True,
    ),
    "spring_width": length("b", "Width of a leaf", "Width of a leaf spring.", "40 mm"),
    "spring_thickness": length("t", "Thickness of a leaf", "Thickness of a leaf spring.", "3 mm"),
    "spring_length": length(
        "L", "Free length of a leaf", "Free length of a leaf spring between its clamps.", "100 mm"
    ),
    "elastic_modulus": _input(
        "Pa", "E", "Elastic modulus",
        "Elastic modulus of the leaf springs, for example 206 GPa for spring steel.", "206 GPa",
        strict=True,
    ),
    "spring_density": _input(
        "kg m-3", "rho", "Density of the leaves",
        "Density of the leaf springs, for example 7850 kg/m^3 for spring steel.",
        "7850 kg/m^3", strict=True,
    ),
    "clamp_factor": _input(
        "1", "c_k", "Clamp factor",
        "Stiffness of the leaf springs divided by their stiffness with rigid clamps.", "0.9",
        strict=True,
    ),
    "allowable_stress": _input(
        "Pa", "sigma_a", "Allowable stress",
        "Bending stress that the leaf springs endure permanently.",
        "250 MPa", strict=True,
    ),
    "ring_down_frequency": _input(
        "Hz", "f_0", "Measured natural frequency",
        "Frequency at which the empty unit vibrates freely after a knock.", "53 Hz", strict=True,
    ),
    "damping_ratio": _input(
        "1", "zeta", "Damping ratio",
        "Damping ratio of the empty unit: the logarithmic decrement of its free vibration divided "
        "by 2 pi.", "0.02",
        strict=True,
    ),
    "drive_force": _input(
        "N", "F", "Force of the drive",
        "Amplitude of the force between moving mass and base at the drive frequency. The force of "
        "a magnet follows from flux_density and pole_area, or from drive_voltage and one measured "
        "amplitude; that of an unbalance follows from unbalance.",
        "100 N", strict=True,
    ),
    "flux_density": _input(
        "T", "B", "Flux density", "Peak of the flux density in the gap of the magnet.", "0.5 T",
        strict=True,
    ),
    "pole_area": _input(
        "m2", "A", "Pole area",
        "Total area of all poles of the magnet that pull.", "12 cm^2", strict=True
    ),
    "drive_voltage": _input(
        "V", "U", "Voltage of the drive",
        "Voltage of the controller. The force follows from the amplitude that was measured at "
        "measured_voltage.",
        "180 V", strict=True,
    ),
    "measured_voltage": _input(
        "V", "U_m", "Measured voltage", "Voltage at which measured_amplitude was measured.",
        "150 V", strict=True,
    ),
    "measured_amplitude": length(
        "A_m", "Measured amplitude",
        "Amplitude of the empty track, zero to peak (half of the stroke), at measured_voltage and "
        "measured_frequency.", "0.15 mm",
    ),
    "measured_frequency": _input(
        "Hz", "f_m", "Measured frequency", "Frequency at which measured_amplitude was measured.",
        "50 Hz", strict=True,
    ),
    "measured_radius": length(
        "R_m", "Measured radius",
        "Distance from the bowl's axis at which measured_amplitude was measured.", "200 mm",
    ),
    "force_exponent": _input(
        "1", "n", "Exponent of the force",
        "Exponent with which the force grows with the voltage: 2 for a magnet without saturation.",
        "2", strict=True,
    ),
    "measured_response": Quantity(
        "m", "", "Measured response",
        "Amplitude of the empty track per newton of the force.", bundle=True
    ),
    "force_harmonic": Quantity(
        "1", "F_2/F_1", "Second harmonic of the force",
        "Second harmonic of the force divided by the first: 0 for a full-wave magnet, 0.25 for a "
        "half-wave magnet that pulls the track back and down, -0.25 for one that pulls it forward "
        "and up.",
        -1.0, 1.0, parameter=True, examples=("0.25",),
    ),
    "offset_along": _offset("d_x", "Mass centres along",
        "Distance by which the trough's mass centre is ahead of the base's mass centre."),
    "offset_upward": _offset("d_z", "Mass centres upward",
        "Distance by which the trough's mass centre is above the base's mass centre."),
    "spot_along": _offset("p_x", "Place along",
        "Distance by which the place of interest on the track is ahead of the trough's mass "
        "centre."),
    "spot_upward": _offset("p_z", "Place upward",
        "Distance by which the place of interest on the track is above the trough's mass centre."),
    "unbalance": _input(
        "kg m", "m_u r", "Unbalance",
        "Mass of the unbalance times the radius at which it rotates.", "0.002 kg m",
        strict=True,
    ),
    "air_gap": length("g_0", "Air gap",
        "Air gap of the magnet at rest, measured along the stroke.", "2 mm"),
    "foot_stiffness": _input(
        "N m-1", "k_f", "Stiffness of the feet",
        "Stiffness of all feet together; 0 if the base is free.",
        "50000 N/m", strict=False,
    ),
    "foot_damping": _input(
        "N s m-1", "c_f", "Damping of the feet",
        "Damping coefficient of all feet together.", "100 N s/m", strict=False
    ),
    "circular_frequency": Quantity(
        "rad s-1", "w", "Circular frequency",
        "Circular frequency of the drive: 2 pi times its frequency."
    ),
    "spring_stiffness": _input(
        "N m-1", "k", "Stiffness of the springs",
        "Stiffness of all leaf springs along the stroke; by default it follows from their sizes.",
        "1000 N/mm", strict=True,
    ),
    "generalised_mass": Quantity(
        "kg", "m", "Mass of the stroke",
        "Effective mass in the vibration of the empty unit along its stroke, if the base is free."
    ),
    "loaded_mass": Quantity("kg", "m_1", "Moving mass with load", "Moving mass with the load."),
    "loaded_inertia": Quantity(
        "kg m2", "I_1", "Inertia with load",
        "Moment of inertia of the bowl with the load on its track."
    ),
    "bowl_mass": Quantity(
        "kg", "m", "Mass of the stroke with load",
        "Effective mass in the vibration of the loaded unit along its stroke, if the base is free."
    ),
    "damping": Quantity("N s m-1", "c", "Damping of the springs",
    "Damping coefficient between moving mass and base, in parallel with the leaf springs."),
    "stroke_response": Quantity("m", "", "Response",
        "Strokes of the masses with their phases.", bundle=True),
    "natural_frequency": Quantity(
        "Hz", "f_n", "Natural frequency",
        "Natural frequency of the loaded unit on its leaf springs."
    ),
    "foot_frequency": Quantity(
        "Hz", "f_f", "Frequency on the feet",
        "Natural frequency of the whole unit on its feet; 0 if the base is free."
    ),
    "stroke": Quantity(
        "m", "s", "Stroke between the masses",
        "Amplitude of the relative motion of moving mass and base at the leaf springs, zero to "
        "peak.",
    ),
    "phase": Quantity(
        "degree", "phi", "Phase",
        "Phase of the stroke relative to the force; -90 degrees at resonance."
    ),
    "amplification": number("k s/F", "Amplification",
    "Stroke divided by the static deflection of the springs under the same force."),
    "second_harmonic": number(
        "4 A_2/A_1", "Second harmonic",
        "Amplitude of the second harmonic of the track's acceleration, divided by that of the "
        "first harmonic."
    ),
    "track_harmonic": Quantity(
        "1", "", "Second harmonic of the track",
        "Sine and cosine components of the track's second harmonic, divided by the first.",
        bundle=True,
    ),
    "turning_mass": Quantity(
        "kg", "m", "Mass of the turning stroke",
        "Effective mass in the vibration of the loaded unit along its stroke, if trough and base "
        "also rotate."
    ),
    "trough_turn": Quantity(
        "rad", "phi", "Turn of the trough",
        "Amplitude of the trough's rotation; a positive value lifts the front."
    ),
    "track_motion": Quantity("m", "", "Motion of a place",
    "Amplitudes of a point of the trough, along the floor and upward.", bundle=True),
    "track_amplitude": Quantity(
        "m", "A_0", "Amplitude of the track",
        "Amplitude of the track, zero to peak. A motion study uses it as amplitude.",
    ),
    "vibration_angle": Quantity(
        "degree", "beta", "Vibration angle",
        "Angle of the vibration above the track. A motion study uses it as beta.",
    ),
    "bowl_turn": Quantity("rad", "Theta_1", "Turn of the bowl",
        "Amplitude of the bowl's rotation about its axis."),
    "bowl_lift": Quantity("m", "z_1", "Lift of the bowl",
        "Amplitude of the bowl's vertical motion."),
    "part_load": Quantity("1", "", "Load by parts",
    "Effective mass and damping of the parts on the track.", bundle=True),
    "effective_mass": Quantity(
        "kg", "m_e", "Effective mass of the parts",
        "Mass of the parts on the track as the drive feels it."
    ),
    "effective_damping": Quantity(
        "N s m-1", "c_e", "Effective damping by the parts",
        "Damping of the track by the parts on it, as that of a damper between track and ground.",
    ),
    "largest_amplitude": Quantity(
        "m", "A_0", "Largest amplitude",
        "Largest track amplitude at which drive and parts agree. A unit that starts from rest "
        "reaches the smallest such amplitude.",
    ),
    "leaf_frequency": Quantity(
        "Hz", "f_1", "Natural frequency of a leaf",
        "Natural frequency of a single leaf clamped at both ends. The drive frequency must stay "
        "below a third of it.",
    ),
    "leaf_mass": Quantity(
        "kg", "", "Moving mass of the leaves",
        "Mass of the leaf springs that moves with one of their ends while the other end is held.",
    ),
    "spring_stress": Quantity(
        "Pa", "sigma", "Stress of the leaves",
        "Bending stress of the leaf springs at their clamps, zero to peak."
    ),
    "stress_margin": Quantity(
        "Pa", "", "Margin of stress",
        "Allowable stress minus the bending stress of the leaf springs."
    ),
    "air_gap_margin": Quantity(
        "m", "", "Margin of the air gap",
        "Air gap of the magnet that remains at the end of the stroke."
    ),
    "foot_force": Quantity(
        "N", "F_f", "Force on the floor", "Amplitude of the force of all feet on the floor."
    ),
    "drive_unit_power": Quantity(
        "W", "", "Power of the drive", "Mean power of the drive's force, which the dampers absorb."
    ),
}  # fmt: skip
