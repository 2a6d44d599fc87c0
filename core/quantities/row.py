"""Rows of parts in one lane: each part's own numbers, the flow, and the force on what holds it."""

from vibrafeed.core.quantities.quantity import Quantity, length, number, velocity

MAX_NUMBERED = 10
"""Parts that have numbers of their own: as many parameters each as a study has keys to spare."""
MAX_PARTS = 64
"""Parts of a row: some 200 collisions a period; longer lanes repeat the behaviour of such a row."""


def _of_part(n: int) -> str:
    return f"part {n} of a row" + (", the rearmost" if n == 1 else "")


def _platoon(n: int) -> dict[str, Quantity]:
    which = f"platoon {n}" + (", the rearmost" if n == 1 else "")
    return {
        f"platoon_size_{n}": Quantity(
            "1",
            "",
            f"Size, platoon {n}",
            f"Number of parts in {which}; 0 if there is none.",
            count=True,
        ),
        f"platoon_velocity_{n}": velocity(
            "", f"Velocity, platoon {n}", f"Mean velocity of {which}; NaN if there is none."
        ),
    }


def _stop_gap(symbol: str, label: str, says: str) -> Quantity:
    return Quantity(
        "m", symbol, label, f"Gap between the front part and a stop {says}, at the start.", 0.0,
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
            "m", f"g_{n}", f"Gap, part {n}", f"Gap in front of {_of_part(n)}, at the start.", 0.0,
            parameter=True, examples=("1 mm",),
        )
        for n in _PARTS
    },
    **{
        f"part_position_{n}": Quantity(
            "m", f"x_{n}", f"Position, part {n}",
            f"Centre of {_of_part(n)} on the track, from the start of the rearmost.",
        )
        for n in _PARTS
    },
    "part_restitution": Quantity(
        "1", "e_p", "Restitution between parts",
        "Relative velocity after a collision of two parts over that before.", 0.0, 1.0,
        parameter=True, examples=("0.3",),
    ),
    "friction_spread": Quantity(
        "1", "sigma_mu", "Spread of friction",
        "Standard deviation of the friction of the parts, drawn within three of it.", 0.0,
        parameter=True, examples=("0.03",), usual=(1e-4, 0.5),
    ),
    "friction_seed": Quantity(
        "1", "", "Seed of the friction", "Seed: each whole number samples another row.", 0.0, 1e9,
        parameter=True, examples=("1",), count=True,
    ),
    "track_stop_gap": _stop_gap("g_t", "Gap to a stop of the track", "that moves with the track"),
    "fixed_stop_gap": _stop_gap("g_f", "Gap to a fixed stop", "at rest beside the track"),
    "mass_scale": Quantity(
        "kg", "", "Mass scale", "Unit of the masses: that of one part if all are equal, else 1 kg."
    ),
    "mean_gap": Quantity(
        "m", "g", "Mean gap", "Mean gap between neighbours of one platoon, over time."
    ),
    "impact_energy": Quantity(
        "J", "", "Energy of collisions", "Energy that collisions of the parts dissipate in a "
        "period."
    ),
    "stop_force_peak": Quantity(
        "N", "F_max", "Largest force on the stop", "Largest force on the stop between strokes."
    ),
    "stop_impulse": Quantity(
        "N s", "", "Strokes against the stop",
        "Impulse of all strokes against the stop in a period of the drive.",
    ),
    **{name: one for n in _PARTS for name, one in _platoon(n).items()},
    "row": Quantity("1", "", "Row", "The parts of a row, from the rear on.", bundle=True),
    "platoons": Quantity(
        "1", "", "Platoons", "Groups of parts that have left each other for ever.", count=True
    ),
    "slowest_velocity": velocity("v_1", "Slowest velocity", "Mean velocity of the slowest part."),
    "fastest_part_velocity": velocity(
        "v_n", "Velocity of the fastest part", "Mean velocity of the fastest part."
    ),
    "contact_fraction": number(
        "", "Contact fraction", "Share of the time in which neighbours touch, mean of all contacts."
    ),
    "collisions_per_period": number(
        "", "Collisions per period", "Contacts between neighbours, and between the front part and "
        "the stop, that close with a relative velocity in a period of the drive. Parts pressed "
        "together touch as soon as their remaining bounces take less than 1e-6 rad of phase.",
    ),
    "row_velocity": Quantity(
        "m s-1", "v", "Velocity of the row",
        "Mean velocity of the parts on the free lane: measured, or of a study of their motion.",
        0.0, strict=True, parameter=True, examples=("80 mm/s",),
    ),
    "inflow": _rate("q", "Inflow", "Parts a minute that come onto the lane.", is_input=True),
    "lane_length": length("L", "Length of the lane", "Length of the lane.", "500 mm"),
    "closed_time": _time("t_c", "Closed time", "Time for which the escapement is "
    "closed.", "200 ms"),
    "open_time": _time("t_o", "Open time", "Minimum time for which the escapement is "
    "open.", "100 ms"),
    "part_width": length("a", "Width of a part", "Width of a part, across the lane.", "10 mm"),
    "bend_radius": length("R", "Radius of the bend", "Radius of the bend's outer wall.", "200 mm"),
    "bend_length": length("s", "Length of the bend", "Length of the part of a row inside the "
    "bend.", "200 mm"),
    "bend_friction": Quantity(
        "1", "mu_w", "Friction at the bend", "Coefficient of friction at the wall of the bend.",
        0.0, strict=True, parameter=True, examples=("0.3",),
    ),
    "line_push": Quantity(
        "N m-1", "q", "Push of the row", "Force per length with which the track pushes the row.",
        0.0, strict=True, parameter=True, examples=("1 N/m",),
    ),
    "forward_acceleration": _acceleration(
        "a_s", "Forward acceleration", "Acceleration of the track forwards, which carries parts."
    ),
    "return_acceleration": _acceleration(
        "a_m", "Return acceleration", "Acceleration of the track backwards, under the parts."
    ),
    "lane_pitch": Quantity("m", "l", "Pitch", "Distance from part to part of a closed row."),
    "throughput_limit": _rate("q_m", "Throughput limit",
    "Maximum number of parts per minute in the "
    "lane."),
    "throughput": _rate("", "Throughput", "Parts a minute that leave a free lane."),
    "part_spacing": Quantity("m", "", "Spacing", "Distance from part to part of a free lane."),
    "queue_velocity": velocity(
        "", "Velocity of the queue", "Velocity with which the tail of a queue comes back."
    ),
    "fill_time": _time("", "Fill time", "Time until a closed lane is full."),
    "clear_time": _time("", "Clear time", "Time until a full lane is clear, once it is opened."),
    "escapement_rate": _rate("", "Escapement rate",
    "Parts per minute through the escapement, one per "
    "stroke."),
    "bend_pitch": Quantity(
        "m", "", "Pitch in the bend",
        "Distance of neighbours along the path of their centres, touching at the inner corners.",
    ),
    "held_line_force": Quantity(
        "N", "C", "Line force, held",
        "Force at the front of a row that is held in a bend while the track slips under it.",
    ),
    "sliding_line_force": Quantity(
        "N", "C", "Line force, sliding",
        "Force at the front of a row in a bend while the row slides "
        "forward over the track."
    ),
    "row_mass": Quantity(
        "kg", "M", "Mass of the row", "Mass of all parts of the row.", 0.0, strict=True,
        parameter=True, examples=("100 g",), usual=(1e-6, 100.0),
    ),
    "row_weight": Quantity("N", "M g", "Weight of the row", "Weight of all parts."),
    "two_level_hold": Quantity(
        "s", "", "Hold", "Time away from the stop, velocity of the impact, period.", bundle=True
    ),
    "stop_force": Quantity("N", "F", "Force on the stop", "Mean force of the row on its stop."),
    "least_stop_force": Quantity(
        "N", "F", "Least force on the stop",
        "Mean of the least force of the row on a stop that moves with the track; more may be "
        "locked in.",
    ),
    "locked_stop_force": Quantity(
        "N", "F", "Locked force on the stop",
        "Mean force on a stop that moves with the track, as stiff elastic parts keep it.",
    ),
    "mean_platoons": number(
        "", "Mean number of platoons",
        "Mean number of platoons of parts with random friction that "
        "slip one way only: 1 + 1/2 + ... + 1/n.",
    ),
    "front_velocity": Quantity(
        "m s-1", "v_f", "Velocity in front", "Mean velocity of the parts in front.", 0.0,
        parameter=True, examples=("60 mm/s",),
    ),
    "closing_time": _time("", "Closing time", "Time until a gap to slower parts in front closes."),
    "pair_force": Quantity(
        "N", "c", "Force between two parts", "Force between two parts that slide forward."
    ),
    "stop_contact_fraction": number(
        "", "Contact with the stop", "Share of the time in which the row touches its stop."
    ),
    "stop_impact_share": number("", "Share of impacts", "Share of impacts in the mean force."),
}  # fmt: skip
