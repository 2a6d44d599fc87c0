"""Motion in time: scales, settings, results; and what a search for the best values tells."""

from vibrafeed.core.quantities.flags import MOTION_STATUSES, OPTIMUM_STATUSES, Flag
from vibrafeed.core.quantities.quantity import Quantity, acceleration, flag, number, velocity

DIRECTIONS: dict[str, Flag] = {
    "rests": Flag(0, "the part does not travel: it is held, or moves to and fro on the spot"),
    "forwards": Flag(1, "the part travels forwards, along +x"),
    "backwards": Flag(2, "the part travels backwards, against x"),
    "unknown": Flag(3, "the part has no mean velocity", valid=False),
}


def _fraction(label: str, description: str) -> Quantity:
    return Quantity("1", "", label, f"Share of the period in which {description}.")


_SPENT = {
    "friction": ("Friction", "Energy that friction dissipates while contacts slip"),
    "impact": ("Impact", "Energy that impacts dissipate, with the friction in them"),
    "drive": ("Drive", "Work of the track on the part"),
}
_SPENT_PER = {
    "{}_power": ("W kg-1", "{} power per mass", "{}, per mass, mean over the cycle."),
    "{}_work": ("J kg-1 m-1", "{} work per mass and metre", "{}, per mass and metre travelled."),
    "part_{}_power": ("W", "{} power of a part", "{}, mean over the cycle."),
    "part_{}_work": ("J m-1", "{} work of a part per metre", "{}, per metre travelled."),
}

SCALES: dict[str, Quantity] = {
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
    "hold_down": Quantity(
        "m s-2", "F/m", "Hold-down",
        "Force per mass that presses the part onto the floor, of a magnet or a vacuum.",
        0.0, parameter=True, examples=("20 m/s^2",),
    ),
    "hold_down_force": Quantity(
        "N", "F", "Hold-down force",
        "Force that presses the part onto the floor, of a magnet or a vacuum; with the mass of the "
        "part it gives hold_down.",
        0.0, parameter=True, examples=("0.5 N",),
    ),
    "hold_down_number": number(
        "F/(m g)", "Hold-down number", "Force that holds the part down, over its weight."
    ),
    "load_number": number(
        "cg cd + F/(m g)", "Load number",
        "Mean load on the floor over the weight, from gravity and the hold-down force.",
    ),
    "curvature_number": number(
        "g/(w^2 R)", "Curvature number", "Length scale g/w^2 over the bowl radius."
    ),
    "acceleration_scale": acceleration("g", "Acceleration scale", "Gravity."),
    "velocity_scale": velocity("g/w", "Velocity scale", "Gravity over circular frequency."),
    "length_scale": Quantity(
        "m", "g/w^2", "Length scale", "Gravity over circular frequency squared."
    ),
    "groups": Quantity("1", "", "Groups", "The dimensionless numbers of a part.", bundle=True),
    "energy": Quantity(
        "1", "", "Energy", "Work of friction, impacts and the drive over a cycle.", bundle=True
    ),
    "motion": Quantity(
        "1", "", "Motion", "Motion over a period, in the scales of the drive.", bundle=True
    ),
}  # fmt: skip
SETTINGS: dict[str, Quantity] = {
    "tolerance": number(
        "tol", "Tolerance", "Largest error of a periodic state, as a share of the drive."
    ),
    "max_periods": number(
        "N",
        "Largest number of periods",
        "Maximum number of drive periods that are simulated for one point.",
    ),
}
RESULTS: dict[str, Quantity] = {
    "conveying_velocity": velocity(
        "v", "Conveying velocity", "Mean velocity along the track once the motion repeats."
    ),
    "conveying_velocity_spread": Quantity(
        "m s-1", "s(v)", "Spread of the conveying velocity",
        "Standard deviation of the means of runs from several phases, or of batches of periods; 0 "
        "where the motion repeats.", error_of="conveying_velocity",
    ),
    "conveying_velocity_error": Quantity(
        "m s-1", "e(v)", "Error of the conveying velocity",
        "Error of the conveying velocity, estimated by the "
        "method.", error_of="conveying_velocity", compared=False,
    ),
    "velocity_across": velocity(
        "v_y", "Velocity across",
        "Mean velocity across the track, towards +y: away from the wall, if there is one. 0 where "
        "the part comes back to the wall.",
    ),
    "efficiency": number(
        "v/v_b", "Transport efficiency",
        "Conveying velocity over the largest speed of the track along x.",
    ),
    "fastest_velocity": velocity(
        "v_O", "Fastest velocity",
        "Largest mean velocity that a drive along the track gives with this largest acceleration, "
        "of whatever form; NaN where something drives the part off the floor or across, or the "
        "track falls.",
    ),
    "share_of_fastest": number(
        "v/v_O", "Share of the fastest velocity",
        "Conveying velocity over the largest that such an acceleration of the track allows.",
    ),
    "stick_fraction": _fraction("Sticking share", "friction holds the part"),
    "forward_fraction": _fraction("Forward sliding share", "the part slides forward"),
    "backward_fraction": _fraction("Backward sliding share", "the part slides backward"),
    "flight_fraction": _fraction("Flight share", "the part is off the floor"),
    "impacts_per_period": Quantity(
        "1", "", "Impacts per period",
        "Impacts on the floor per period of the drive; a run of ever smaller hops counts as "
        "those resolved.", count=True, compared=False,
    ),
    "period_multiple": Quantity(
        "1", "", "Period multiple",
        "Periods of the drive after which the motion repeats; 0 where it does not.", count=True,
        words={0: "does not repeat", 1: "repeats every period"},
        other_words="repeats every {} periods",
    ),
    "landing_speed": velocity(
        "u_N", "Landing speed", "Largest speed normal to the floor before an impact."
    ),
    "hop_height": Quantity("m", "z", "Hop height", "Largest distance from the floor."),
    **{
        name.format(kind): Quantity(unit, "", label.format(title), says.format(what))
        for name, (unit, label, says) in _SPENT_PER.items()
        for kind, (title, what) in _SPENT.items()
    },
    "effective_mass_ratio": number(
        "m_e/m", "Effective mass ratio",
        "Effective mass of a part, as the drive feels it, over its "
        "mass: 1 if it sticks, less if it hops.",
    ),
    "motion_status": flag("Status of the motion", "Status of the motion: how the simulation "
    "ended.", MOTION_STATUSES),
}  # fmt: skip
FEEDING: dict[str, Quantity] = {
    "part_gap": Quantity(
        "m", "", "Gap between parts", "Free length between two parts on the track.", 0.0,
        parameter=True, examples=("5 mm",),
    ),
    "occupancy": Quantity(
        "1", "", "Occupancy",
        "Share of the track's length that parts cover, 1 where each touches the next; follows from "
        "part_gap unless given.", 0.0, 1.0, strict=True, parameter=True, examples=("0.6",),
    ),
    "feed_rate": Quantity(
        "min-1", "", "Feed rate",
        "Parts a minute past a place, touching unless part_gap is given; negative backwards.",
    ),
    "direction": flag(
        "Direction of travel", "Direction in which the part travels: forwards, backwards, "
        "or at rest.",
        DIRECTIONS,
    ),
}  # fmt: skip
TUMBLING: dict[str, Quantity] = {
    "duration": Quantity(
        "s", "t_e", "Duration", "Time after which the run ends.", 0.0, strict=True,
        parameter=True, examples=("2 s",),
    ),
    "drop_height": Quantity(
        "m", "z_0", "Drop height",
        "Height of the part's lowest corner above the plane at the start.", 0.0,
        parameter=True, examples=("10 mm",),
    ),
    "tumble": Quantity("1", "", "Tumble", "Motion of the tumbling part.", bundle=True),
    "final_pitch": Quantity(
        "degree", "xi_e", "Final pitch", "Pitch at the end, clockwise, with all its turns."
    ),
    "resting_side": Quantity(
        "1", "", "Resting side",
        "Side on the plane at the end: 1 as at pitch 0, 2 at 90 degrees, 3 at 180, "
        "4 at 270; 0 if none does.",
        words={
            0: "no side", 1: "the side at pitch 0°", 2: "the side at pitch 90°",
            3: "the side at pitch 180°", 4: "the side at pitch 270°",
        }, other_words="{}",
    ),
    "settling_time": Quantity(
        "s", "t_s", "Settling time", "Time after which the part stays at rest."
    ),
    "impact_count": Quantity(
        "1", "", "Impacts", "Impacts until the end; both ends of a side at once count as one.",
        count=True, compared=False,
    ),
    "largest_bounce": Quantity(
        "m", "z_b", "Largest bounce",
        "Largest height of the lowest corner above the plane after the first impact.",
    ),
    "drift_velocity": velocity(
        "x/t", "Drift velocity", "Displacement along the plane over the duration."
    ),
    "specific_energy_lost": Quantity(
        "J kg-1", "e_l", "Energy lost per mass", "Energy that impacts and friction took."
    ),
    "part_energy_lost": Quantity(
        "J", "E_l", "Energy that a part loses", "Energy that impacts and friction took from a part."
    ),
    "tumbling_part": Quantity("1", "", "Tumbling part",
    "Shape and size of the tumbling part.", bundle=True),
    "throw": Quantity("1", "", "Throw", "The tumbling part, the plane, the start.", bundle=True),
    "path_along": Quantity("m", "x", "Centre along the plane", "Position of the part's centre."),
    "path_height": Quantity("m", "y", "Height of the centre", "Height of the centre."),
    "path_pitch": Quantity("degree", "xi", "Pitch", "Pitch, clockwise, with all its turns."),
    "path_gap": Quantity("m", "g_N", "Lowest gap", "Height of the lowest corner."),
    "path_corners": Quantity(
        "1", "", "Corners in contact", "Corners that carry the part.", other_words="corners: {}"
    ),
}  # fmt: skip
TRAJECTORY: dict[str, Quantity] = {
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
    "relative_velocity_along": velocity(
        "u_x", "Velocity relative to the track", "Velocity along the track, relative to it."
    ),
    "relative_velocity_normal": velocity(
        "u_z", "Velocity off the floor", "Velocity normal to the floor, relative to it."
    ),
    "track_along": Quantity(
        "m", "A0 cb sin(wt)", "Displacement of the track along x", "Displacement of the track."
    ),
    "track_normal": Quantity(
        "m", "A0 sb sin(wt)", "Displacement of the track along z", "Displacement of the track."
    ),
    "motion_mode": number("", "Mode of the motion",
    "Mode of the part's motion: stick, forward, backward or "
    "flight."),
}  # fmt: skip

BURST: dict[str, Quantity] = {
    "burst_periods": Quantity(
        "1", "n", "Periods of the burst",
        "Whole number of periods for which the drive runs, from rest to rest.", 1.0, 1000.0,
        parameter=True, examples=("10",),
    ),
    "burst": Quantity(
        "1", "", "Burst", "Motion in a burst, in the scales of the drive.", bundle=True
    ),
    "burst_displacement": Quantity(
        "m", "", "Displacement in a burst",
        "Way of the part along the track from rest to rest, under a drive of some periods; NaN "
        "where the part does not come to rest.", compared=False,
    ),
    "burst_coasting_time": Quantity(
        "s", "", "Coasting time",
        "Time from the end of a burst until the part rests.", compared=False,
    ),
}  # fmt: skip
MOTION = {**SCALES, **SETTINGS, **RESULTS, **FEEDING, **BURST, **TUMBLING, **TRAJECTORY}


OPTIMUM: dict[str, Quantity] = {
    "front": number(
        "", "Place on the front",
        "0 at the largest output, 1 at the least absolute value of the other one.",
    ),
    "objective": number("", "Objective", "Value of the objective at the optimum."),
    "objective_error": number(
        "", "Error of the objective",
        "Uncertainty of the objective: the larger of the error that the method states of the "
        "mean velocity, and of the scatter that chance leaves where rounding decides.",
    ),
    "objective_left_out": number(
        "", "Share left out of the objective",
        "Points of the uncertain parameters at which the objective has no value.",
    ),
    "optimum_status": flag(
        "Status of the optimum", "Status of the optimum: how the search ended.", OPTIMUM_STATUSES
    ),
    "optimum_gap": number(
        "", "Gap of the optimum",
        "Objective of the closed form, or of points all over the bounds, less the one found, as a "
        "share of the outputs' scale.",
    ),
    "evaluations": number("", "Evaluations", "Points at which the outputs were computed."),
    "front_points": number(
        "", "Distinct points of the front",
        "1 where there is no trade-off: one choice is best in both outputs.",
    ),
    "knee": number("", "Knee of the front", "The point farthest from the chord of the front."),
}  # fmt: skip

OF_THE_SEARCH = ("objective_error", "optimum_gap", "evaluations")
"""Outputs that tell how an optimum was found."""
