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
    "friction": ("Friction", "friction dissipates while contacts slip"),
    "impact": ("Impact", "impacts dissipate, including friction during impacts"),
    "drive": ("Drive", "the track supplies"),
}
_SPENT_PER = {
    "{}_power": ("W kg-1", "{} power per mass", "Power per mass that {}, averaged over the cycle."),
    "{}_work": (
        "J kg-1 m-1",
        "{} work per mass and metre",
        "Energy per mass and metre of travel that {}.",
    ),
    "part_{}_power": (
        "W",
        "{} power of a part",
        "Power per part that {}, averaged over the cycle.",
    ),
    "part_{}_work": (
        "J m-1",
        "{} work of a part per metre",
        "Energy per part and metre of travel that {}.",
    ),
}

SCALES: dict[str, Quantity] = {
    "drive_number": number(
        "p", "Drive number", "Amplitude of the drive acceleration divided by gravity."
    ),
    "drive_number_along": number(
        "p cb ca", "Drive number along the track",
        "Peak drive acceleration in the direction of the track (+x), divided by gravity."
    ),
    "drive_number_across": number(
        "p cb sa", "Drive number across the track",
        "Peak drive acceleration across the track (+y), divided by gravity."
    ),
    "drive_number_normal": number(
        "p sb", "Drive number off the floor",
        "Peak drive acceleration normal to the floor (+z), divided by gravity."
    ),
    "gravity_number_along": number(
        "sin(gamma)", "Share of gravity along the track",
        "Component of gravity down the track (along -x), divided by gravity."
    ),
    "gravity_number_across": number(
        "cg sd", "Share of gravity towards the wall",
        "Component of gravity across the track towards the wall (along -y), divided by gravity."
    ),
    "gravity_number_normal": number(
        "cg cd", "Share of gravity onto the floor",
        "Component of gravity normal to the floor, towards the floor (along -z), divided by "
        "gravity."
    ),
    "hold_down": Quantity(
        "m s-2", "F/m", "Hold-down",
        "Force per mass with which a magnet or a vacuum presses the part onto the floor.",
        0.0, parameter=True, examples=("20 m/s^2",),
    ),
    "hold_down_force": Quantity(
        "N", "F", "Hold-down force",
        "Force with which a magnet or a vacuum presses the part onto the floor. With the mass of "
        "the part it gives hold_down.",
        0.0, parameter=True, examples=("0.5 N",),
    ),
    "hold_down_number": number(
        "F/(m g)", "Hold-down number",
        "Force that holds the part down, divided by the weight of the part."
    ),
    "load_number": number(
        "cg cd + F/(m g)", "Load number",
        "Mean load of the part on the floor, from gravity and the hold-down force, divided by the "
        "weight of the part.",
    ),
    "curvature_number": number(
        "g/(w^2 R)", "Curvature number",
        "Length scale g/w^2 divided by the radius of the bowl; w is the circular frequency of the "
        "drive."
    ),
    "acceleration_scale": acceleration("g", "Acceleration scale",
        "Unit of acceleration in the simulation: gravity."),
    "velocity_scale": velocity("g/w", "Velocity scale",
        "Unit of velocity in the simulation: gravity divided by the circular frequency of the "
        "drive."),
    "length_scale": Quantity(
        "m", "g/w^2", "Length scale",
        "Unit of length in the simulation: gravity divided by the square of the circular "
        "frequency of the drive."
    ),
    "groups": Quantity("1", "", "Groups",
        "Dimensionless numbers of the part and its drive.", bundle=True),
    "energy": Quantity(
        "1", "", "Energy", "Work of friction, impacts and the drive over a cycle.", bundle=True
    ),
    "motion": Quantity(
        "1", "", "Motion",
        "Motion of the part over a period, in the units of the simulation.", bundle=True
    ),
}  # fmt: skip
SETTINGS: dict[str, Quantity] = {
    "tolerance": number(
        "tol",
        "Tolerance",
        "Largest accepted error of a periodic motion, relative to the motion of the drive.",
    ),
    "max_periods": number(
        "N",
        "Largest number of periods",
        "Maximum number of drive periods that are simulated for one set of values.",
    ),
}
RESULTS: dict[str, Quantity] = {
    "conveying_velocity": velocity(
        "v", "Conveying velocity",
        "Mean velocity of the part along the track once the motion repeats."
    ),
    "conveying_velocity_spread": Quantity(
        "m s-1", "s(v)", "Spread of the conveying velocity",
        "Standard deviation of the mean velocity between runs from several phases of the drive, "
        "or between batches of periods; 0 if the motion repeats.", error_of="conveying_velocity",
    ),
    "conveying_velocity_error": Quantity(
        "m s-1", "e(v)", "Error of the conveying velocity",
        "Error of the conveying velocity, as the simulation method estimates it.",
        error_of="conveying_velocity", compared=False,
    ),
    "velocity_across": velocity(
        "v_y", "Velocity across",
        "Mean velocity of the part across the track, towards +y and away from a wall; 0 if the "
        "part comes back to the wall.",
    ),
    "efficiency": number(
        "v/v_b", "Transport efficiency",
        "Conveying velocity divided by the largest speed of the track along x.",
    ),
    "fastest_velocity": velocity(
        "v_O", "Fastest velocity",
        "Largest mean velocity that any drive along the track could give with the largest "
        "acceleration of this drive. NaN if something drives the part off the floor or across the "
        "track, or if the track descends.",
    ),
    "share_of_fastest": number(
        "v/v_O", "Share of the fastest velocity",
        "Conveying velocity divided by the largest velocity that any drive with the same largest "
        "acceleration could give.",
    ),
    "stick_fraction": _fraction("Sticking share", "friction holds the part"),
    "forward_fraction": _fraction("Forward sliding share", "the part slides forward"),
    "backward_fraction": _fraction("Backward sliding share", "the part slides backward"),
    "flight_fraction": _fraction("Flight share", "the part is off the floor"),
    "impacts_per_period": Quantity(
        "1", "", "Impacts per period",
        "Number of impacts on the floor in one period of the drive. In a run of ever smaller "
        "hops, only the impacts that the simulation resolves count.", count=True, compared=False,
    ),
    "period_multiple": Quantity(
        "1", "", "Period multiple",
        "Number of drive periods after which the motion repeats; 0 if it does not repeat.",
        count=True,
        words={0: "does not repeat", 1: "repeats every period"},
        other_words="repeats every {} periods",
    ),
    "landing_speed": velocity(
        "u_N", "Landing speed",
        "Largest speed of the part normal to the floor just before an impact."
    ),
    "hop_height": Quantity("m", "z", "Hop height", "Largest distance of the part from the floor."),
    **{
        name.format(kind): Quantity(unit, "", label.format(title), says.format(what))
        for name, (unit, label, says) in _SPENT_PER.items()
        for kind, (title, what) in _SPENT.items()
    },
    "effective_mass_ratio": number(
        "m_e/m", "Effective mass ratio",
        "Mass of the part as the drive feels it, divided by its own mass: 1 if it sticks, less if "
        "it hops.",
    ),
    "motion_status": flag("Status of the motion",
        "Status of the motion: how the simulation ended.", MOTION_STATUSES),
}  # fmt: skip
FEEDING: dict[str, Quantity] = {
    "part_gap": Quantity(
        "m", "", "Gap between parts",
        "Free distance between two neighbouring parts on the track.", 0.0,
        parameter=True, examples=("5 mm",),
    ),
    "occupancy": Quantity(
        "1", "", "Occupancy",
        "Share of the track's length that parts cover: 1 if neighbouring parts touch. By default "
        "it follows from part_gap.", 0.0, 1.0, strict=True, parameter=True, examples=("0.6",),
    ),
    "feed_rate": Quantity(
        "min-1", "", "Feed rate",
        "Number of parts per minute that pass a place on the track; negative if they travel "
        "backwards. Without part_gap, the parts are assumed to touch.",
    ),
    "direction": flag(
        "Direction of travel",
        "Direction in which the part travels: forwards, backwards, or at rest.",
        DIRECTIONS,
    ),
}  # fmt: skip
TUMBLING: dict[str, Quantity] = {
    "duration": Quantity(
        "s", "t_e", "Duration", "Time after which the simulation ends.", 0.0, strict=True,
        parameter=True, examples=("2 s",),
    ),
    "drop_height": Quantity(
        "m", "z_0", "Drop height",
        "Height of the part's lowest corner above the plane at the start.", 0.0,
        parameter=True, examples=("10 mm",),
    ),
    "tumble": Quantity("1", "", "Tumble", "Motion of the tumbling part.", bundle=True),
    "final_pitch": Quantity(
        "degree", "xi_e", "Final pitch",
        "Pitch of the part at the end, clockwise, including full turns."
    ),
    "resting_side": Quantity(
        "1", "", "Resting side",
        "Side on which the part lies at the end: 1 for the side that is down at pitch 0, 2 at 90 "
        "degrees, 3 at 180, 4 at 270; 0 if it lies on none.",
        words={
            0: "no side", 1: "the side at pitch 0°", 2: "the side at pitch 90°",
            3: "the side at pitch 180°", 4: "the side at pitch 270°",
        }, other_words="{}",
    ),
    "settling_time": Quantity(
        "s", "t_s", "Settling time", "Time after which the part stays at rest."
    ),
    "impact_count": Quantity(
        "1", "", "Impacts",
        "Number of impacts until the end. An impact on both ends of a side at once counts as one.",
        count=True, compared=False,
    ),
    "largest_bounce": Quantity(
        "m", "z_b", "Largest bounce",
        "Largest height of the part's lowest corner above the plane after the first impact.",
    ),
    "drift_velocity": velocity(
        "x/t", "Drift velocity", "Displacement of the part along the plane divided by the duration."
    ),
    "specific_energy_lost": Quantity(
        "J kg-1", "e_l", "Energy lost per mass",
        "Energy per mass that the part loses in impacts and by friction."
    ),
    "part_energy_lost": Quantity(
        "J", "E_l", "Energy that a part loses",
        "Energy that the part loses in impacts and by friction."
    ),
    "tumbling_part": Quantity("1", "", "Tumbling part",
    "Shape and size of the tumbling part.", bundle=True),
    "throw": Quantity("1", "", "Throw",
        "Tumbling part, plane, and state of the part at the start.", bundle=True),
    "path_along": Quantity("m", "x", "Centre along the plane",
        "Position of the part's centre along the plane."),
    "path_height": Quantity("m", "y", "Height of the centre",
        "Height of the part's centre above the plane."),
    "path_pitch": Quantity("degree", "xi", "Pitch",
        "Pitch of the part, clockwise, including full turns."),
    "path_gap": Quantity("m", "g_N", "Lowest gap",
        "Height of the part's lowest corner above the plane."),
    "path_corners": Quantity(
        "1", "", "Corners in contact",
        "Number of corners on which the part stands.", other_words="corners: {}"
    ),
}  # fmt: skip
TRAJECTORY: dict[str, Quantity] = {
    "cycle_time": Quantity(
        "s", "t", "Time in the cycle",
        "Time since the start of a drive period; for a tumbling part, time since the start of the "
        "simulation.",
    ),
    "position_along": Quantity(
        "m", "x", "Position on the track",
        "Position of the part along the track, relative to the track; 0 at the first time.",
    ),
    "height_above_floor": Quantity(
        "m", "z", "Height above the floor", "Distance of the part from the moving floor."
    ),
    "distance_from_wall": Quantity(
        "m", "y", "Distance from the wall", "Distance of the part from the moving wall."
    ),
    "relative_velocity_along": velocity(
        "u_x", "Velocity relative to the track",
        "Velocity of the part along the track, relative to the track."
    ),
    "relative_velocity_normal": velocity(
        "u_z", "Velocity off the floor",
        "Velocity of the part off the floor, relative to the floor."
    ),
    "track_along": Quantity(
        "m", "A0 cb sin(wt)", "Displacement of the track along x",
        "Displacement of the track along x."
    ),
    "track_normal": Quantity(
        "m", "A0 sb sin(wt)", "Displacement of the track along z",
        "Displacement of the track along z, normal to the floor."
    ),
    "motion_mode": number("", "Mode of the motion",
    "Mode of the part's motion: stick, forward, backward or flight."),
}  # fmt: skip

BURST: dict[str, Quantity] = {
    "burst_periods": Quantity(
        "1", "n", "Periods of the burst",
        "Whole number of periods for which the drive runs; the track starts and ends at rest.",
        1.0, 1000.0,
        parameter=True, examples=("10",),
    ),
    "burst": Quantity(
        "1", "", "Burst",
        "Motion of the part in a burst, in the units of the simulation.", bundle=True
    ),
    "burst_displacement": Quantity(
        "m", "", "Displacement in a burst",
        "Distance that the part travels along the track in a burst, from rest to rest; NaN if the "
        "part does not come to rest.", compared=False,
    ),
    "burst_coasting_time": Quantity(
        "s", "", "Coasting time",
        "Time from the end of the burst until the part is at rest.", compared=False,
    ),
}  # fmt: skip
MOTION = {**SCALES, **SETTINGS, **RESULTS, **FEEDING, **BURST, **TUMBLING, **TRAJECTORY}


OPTIMUM: dict[str, Quantity] = {
    "front": number(
        "", "Place on the front",
        "Position of a point on the Pareto front: 0 at the largest output, 1 at the least "
        "absolute value of the other output.",
    ),
    "objective": number("", "Objective", "Value of the objective at the optimum."),
    "objective_error": number(
        "", "Error of the objective",
        "Uncertainty of the objective: the error that the method states for the mean velocity or, "
        "if it is larger, the scatter of motions that depend on rounding.",
    ),
    "objective_left_out": number(
        "", "Share left out of the objective",
        "Share of the points of the uncertain parameters at which the objective has no value.",
    ),
    "optimum_status": flag(
        "Status of the optimum", "Status of the optimum: how the search ended.", OPTIMUM_STATUSES
    ),
    "optimum_gap": number(
        "", "Gap of the optimum",
        "Objective of a second method minus the objective found, divided by the size of the "
        "outputs. The second method is the closed form, or a search of points all over the "
        "bounds.",
    ),
    "evaluations": number("", "Evaluations",
        "Number of points at which the search computed the outputs."),
    "front_points": number(
        "", "Distinct points of the front",
        "Number of different points on the front. It is 1 if one choice is best in both outputs.",
    ),
    "knee": number("", "Knee of the front",
        "Mark of the knee, the point of the front that is farthest from the chord between its "
        "ends: 1 at the knee, 0 elsewhere."),
}  # fmt: skip

OF_THE_SEARCH = ("objective_error", "optimum_gap", "evaluations")
"""Outputs that tell how an optimum was found."""
