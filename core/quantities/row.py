"""Rows of parts in one lane: each part's own numbers, the flow, and the force on what holds it."""

from vibrafeed.core.quantities.quantity import Quantity, length, number, velocity

MAX_NUMBERED = 10
"""Parts that have numbers of their own: as many parameters each as a study has keys to spare."""
MAX_PARTS = 64
"""Parts of a row: some 200 collisions a period; longer lanes repeat the behaviour of such a row."""


def _of_part(n: int) -> str:
    return f"part {n} of the row" + (", the rearmost" if n == 1 else ", counted from the rear")


def _platoon(n: int) -> dict[str, Quantity]:
    which = f"platoon {n}" + (", the rearmost" if n == 1 else ", counted from the rear")
    return {
        f"platoon_size_{n}": Quantity(
            "1",
            "",
            f"Size, platoon {n}",
            f"Number of parts in {which}; 0 if this platoon does not exist.",
            count=True,
        ),
        f"platoon_velocity_{n}": velocity(
            "",
            f"Velocity, platoon {n}",
            f"Mean velocity of {which}; NaN if this platoon does not exist.",
        ),
    }


def _stop_gap(symbol: str, label: str, says: str) -> Quantity:
    return Quantity(
        "m", symbol, label,
        f"Initial gap between the front part of the row and a stop {says}.", 0.0,
        parameter=True, examples=("0 mm",),
    )  # fmt: skip


def _time(symbol: str, label: str, says: str, example: str = "") -> Quantity:
    return Quantity(
        "s", symbol, label, says, 0.0, parameter=bool(example),
        examples=(example,) if example else (),
    )  # fmt: skip


def _rate(symbol: str, label: str, says: str, *, is_input: bool = False) -> Quantity:
    return Quantity(
        "min-1", symbol, label, says, 0.0, parameter=is_input,
        examples=("120 1/min",) if is_input else (),
    )  # fmt: skip


def _acceleration(symbol: str, label: str, says: str) -> Quantity:
    return Quantity(
        "m s-2", symbol, label, says, 0.0, strict=True, parameter=True, examples=("2 m/s^2",)
    )


NUMBERS = ("part_friction", "part_mass", "part_gap")
"""What each part of a row may have of its own, by the stem of its name."""

_PARTS = range(1, MAX_NUMBERED + 1)
ROW: dict[str, Quantity] = {
    "parts": Quantity(
        "1", "n", "Parts", "Number of parts in the row.", 2.0, float(MAX_PARTS), parameter=True,
        examples=("8",),
    ),
    **{
        f"part_friction_{n}": Quantity(
            "1", f"mu_{n}", f"Friction, part {n}",
            f"Coefficient of friction between the track and {_of_part(n)}.", 0.0, parameter=True,
            examples=("0.3",), usual=(1e-3, 2.0),
        )
        for n in _PARTS
    },
    **{
        f"part_mass_{n}": Quantity(
            "kg", f"m_{n}", f"Mass, part {n}", f"Mass of {_of_part(n)}.", 0.0, strict=True,
            parameter=True, examples=("4 g",), usual=(1e-7, 10.0),
        )
        for n in _PARTS
    },
    **{
        f"part_gap_{n}": Quantity(
            "m", f"g_{n}", f"Gap, part {n}", f"Initial gap ahead of {_of_part(n)}.", 0.0,
            parameter=True, examples=("1 mm",),
        )
        for n in _PARTS
    },
    **{
        f"part_position_{n}": Quantity(
            "m", f"x_{n}", f"Position, part {n}",
            "Distance along the track from the starting point of the rearmost part to the centre "
            f"of {_of_part(n)}.",
        )
        for n in _PARTS
    },
    "part_restitution": Quantity(
        "1", "e_p", "Restitution between parts",
        "Coefficient of restitution in a collision of two neighbouring parts: their relative "
        "velocity after the collision divided by that before it.", 0.0, 1.0,
        parameter=True, examples=("0.3",),
    ),
    "friction_spread": Quantity(
        "1", "sigma_mu", "Spread of friction",
        "Standard deviation of the friction coefficients of the parts, which are sampled at "
        "random within three standard deviations.", 0.0,
        parameter=True, examples=("0.03",), usual=(1e-4, 0.5),
    ),
    "friction_seed": Quantity(
        "1", "", "Seed of the friction",
        "Seed of the random friction coefficients: each whole number samples another row.",
        0.0, 1e9,
        parameter=True, examples=("1",), count=True,
    ),
    "track_stop_gap": _stop_gap("g_t", "Gap to a stop of the track", "that moves with the track"),
    "fixed_stop_gap": _stop_gap("g_f", "Gap to a fixed stop", "at rest beside the track"),
    "mass_scale": Quantity(
        "kg", "", "Mass scale",
        "Unit of mass in the simulation of a row: the mass of one part if all parts are equal, "
        "otherwise 1 kg."
    ),
    "mean_gap": Quantity(
        "m", "g", "Mean gap", "Mean gap over time between neighbouring parts of one platoon."
    ),
    "impact_energy": Quantity(
        "J", "", "Energy of collisions",
        "Energy that collisions between the parts dissipate in one period of the drive."
    ),
    "stop_force_peak": Quantity(
        "N", "F_max", "Largest force on the stop",
        "Largest force of the row on the stop between two impacts."
    ),
    "stop_impulse": Quantity(
        "N s", "", "Strokes against the stop",
        "Sum of the impulses of all impacts of the row on the stop in one period of the drive.",
    ),
    **{name: one for n in _PARTS for name, one in _platoon(n).items()},
    "row": Quantity("1", "", "Row", "Parts of a row, from the rear to the front.", bundle=True),
    "platoons": Quantity(
        "1", "", "Platoons",
        "Number of platoons: groups of parts that have separated for good.", count=True
    ),
    "slowest_velocity": velocity("v_1", "Slowest velocity",
        "Mean velocity of the slowest part of the row."),
    "fastest_part_velocity": velocity(
        "v_n", "Velocity of the fastest part", "Mean velocity of the fastest part of the row."
    ),
    "contact_fraction": number(
        "", "Contact fraction",
        "Share of the time in which two neighbouring parts touch, averaged over all pairs of "
        "neighbours."
    ),
    "collisions_per_period": number(
        "", "Collisions per period",
        "Number of collisions in one period of the drive, between neighbouring parts and between "
        "the front part and the stop. Parts that are pressed together count as touching once "
        "their remaining bounces take less than 1e-6 rad of phase.",
    ),
    "row_velocity": Quantity(
        "m s-1", "v", "Velocity of the row",
        "Mean velocity of the parts on the free lane, from a measurement or from a motion study.",
        0.0, strict=True, parameter=True, examples=("80 mm/s",),
    ),
    "inflow": _rate("q", "Inflow",
        "Number of parts per minute that enter the lane.", is_input=True),
    "lane_length": length("L", "Length of the lane", "Length of the lane.", "500 mm"),
    "closed_time": _time("t_c", "Closed time",
        "Time for which the escapement is closed in each cycle.", "200 ms"),
    "open_time": _time("t_o", "Open time",
        "Minimum time for which the escapement is open in each cycle.", "100 ms"),
    "part_width": length("a", "Width of a part",
        "Width of a part, measured across the lane.", "10 mm"),
    "bend_radius": length("R", "Radius of the bend",
        "Radius of the outer wall of the bend.", "200 mm"),
    "bend_length": length("s", "Length of the bend",
        "Length of the row inside the bend.", "200 mm"),
    "bend_friction": Quantity(
        "1", "mu_w", "Friction at the bend",
        "Coefficient of friction between the parts and the wall of the bend.",
        0.0, strict=True, parameter=True, examples=("0.3",),
    ),
    "line_push": Quantity(
        "N m-1", "q", "Push of the row",
        "Force with which the track pushes the row forward, per length of the row.",
        0.0, strict=True, parameter=True, examples=("1 N/m",),
    ),
    "forward_acceleration": _acceleration(
        "a_s", "Forward acceleration",
        "Acceleration of the track during the forward step of the drive, in which friction "
        "carries the parts along."
    ),
    "return_acceleration": _acceleration(
        "a_m", "Return acceleration",
        "Acceleration of the track during the return step of the drive, in which the track slips "
        "back under the parts."
    ),
    "lane_pitch": Quantity("m", "l", "Pitch",
        "Distance between the centres of neighbouring parts in a closed row."),
    "throughput_limit": _rate("q_m", "Throughput limit",
    "Maximum number of parts per minute that the lane can convey."),
    "throughput": _rate("", "Throughput",
        "Number of parts per minute that leave a lane with a free exit."),
    "part_spacing": Quantity("m", "", "Spacing",
        "Distance between the centres of neighbouring parts on a free lane."),
    "queue_velocity": velocity(
        "", "Velocity of the queue",
        "Velocity at which the tail of a queue moves back along the lane."
    ),
    "fill_time": _time("", "Fill time", "Time in which a lane with a closed exit fills up."),
    "clear_time": _time("", "Clear time",
        "Time in which a full lane empties once its exit is open."),
    "escapement_rate": _rate("", "Escapement rate",
    "Number of parts per minute that pass the escapement, one part in each cycle."),
    "bend_pitch": Quantity(
        "m", "", "Pitch in the bend",
        "Distance between the centres of neighbouring parts along the bend, if the parts touch at "
        "their inner corners.",
    ),
    "held_line_force": Quantity(
        "N", "C", "Line force, held",
        "Force at the front of a row that is held in a bend while the track slips under it.",
    ),
    "sliding_line_force": Quantity(
        "N", "C", "Line force, sliding",
        "Force at the front of a row in a bend while the row slides forward over the track."
    ),
    "row_mass": Quantity(
        "kg", "M", "Mass of the row", "Total mass of the parts of the row.", 0.0, strict=True,
        parameter=True, examples=("100 g",), usual=(1e-6, 100.0),
    ),
    "row_weight": Quantity("N", "M g", "Weight of the row",
        "Total weight of the parts of the row."),
    "two_level_hold": Quantity(
        "s", "", "Hold",
        "Time without contact, velocity of the impact, and period of a row at its stop.",
        bundle=True
    ),
    "stop_force": Quantity("N", "F", "Force on the stop",
        "Mean force of the row on the stop in front of it."),
    "least_stop_force": Quantity(
        "N", "F", "Least force on the stop",
        "Least force of the row on a stop that moves with the track, averaged over the period. "
        "Friction can lock in a larger force.",
    ),
    "locked_stop_force": Quantity(
        "N", "F", "Locked force on the stop",
        "Mean force of a row of stiff elastic parts on a stop that moves with the track, "
        "including the force that friction locks in.",
    ),
    "mean_platoons": number(
        "", "Mean number of platoons",
        "Mean number of platoons if the parts have random friction and slip in one direction "
        "only: 1 + 1/2 + ... + 1/n.",
    ),
    "front_velocity": Quantity(
        "m s-1", "v_f", "Velocity in front", "Mean velocity of the parts ahead of the row.", 0.0,
        parameter=True, examples=("60 mm/s",),
    ),
    "closing_time": _time("", "Closing time",
        "Time in which the row closes the gap to slower parts ahead of it."),
    "pair_force": Quantity(
        "N", "c", "Force between two parts",
        "Force between two neighbouring parts that slide forward."
    ),
    "stop_contact_fraction": number(
        "", "Contact with the stop", "Share of the time in which the row touches its stop."
    ),
    "stop_impact_share": number("", "Share of impacts",
        "Share of the mean force on the stop that comes from impacts."),
}  # fmt: skip
