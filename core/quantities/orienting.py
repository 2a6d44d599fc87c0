"""Resting parts, and the devices of a line that orient them."""

from dataclasses import dataclass

from vibrafeed.core.quantities.quantity import Quantity, length, number

ASPECTS = {
    "flat": ("flat", "flat (on a face of length by width)"),
    "on_side": ("on a side", "on their side"),
    "on_end": ("on an end", "on an end"),
    "upright": ("upright", "upright (on their first end)"),
    "inverted": ("inverted", "inverted (on their second end, or a box upside down)"),
}
"""How parts lie; those of one shape are numbered in the order in which its scene lists them."""

MAX_ASPECTS = 20
"""Aspects of a part from a file."""
NUMBERED = 9
"""Aspects that `turn` and the counts of a drop test can name."""


@dataclass(frozen=True)
class PartAspect:
    """A way in which a part from a file lies.

    Attributes
    ----------
    let_down_share, thrown_share : float
        The shares of parts that come to rest in it [1]: the ends of the bracket.
    height, length, width : float
        Of the part: its height, and the sides of the least rectangle about it from above [m].
    centre_height : float
        Height of the centre of mass [m].
    base_along, base_across, base_least : float
        Distance from the foot of the centre of mass to the end of the base: the shorter one along
        the length, across it, and the one to the nearest edge [m].
    gyration : float
        Radius of gyration about the horizontal line across the length [m].
    down, along : tuple of float
        The directions down and along the length, in the axes of the file.
    """

    let_down_share: float
    thrown_share: float
    height: float
    length: float
    width: float
    centre_height: float
    base_along: float
    base_across: float
    base_least: float
    gyration: float
    down: tuple[float, float, float]
    along: tuple[float, float, float]


def _resting_shares() -> dict[str, Quantity]:
    quantities = {}
    for name, (words, where) in ASPECTS.items():
        quantities[f"let_down_share_{name}"] = number(
            f"s_{name}", f"Share that rests {words}, let down",
            f"Share of parts that come to rest {where} after they are let down with negligible "
            f"momentum. The true share is between this value and thrown_share_{name}; their "
            "difference is the error.",
        )  # fmt: skip
        quantities[f"thrown_share_{name}"] = number(
            f"t_{name}", f"Share that rests {words}, thrown",
            f"Share of parts that come to rest {where} after they are thrown. The true share is "
            f"between this value and let_down_share_{name}; their difference is the error.",
        )  # fmt: skip
        quantities[f"counted_share_{name}"] = number(
            f"p_{name}", f"Share that rests {words}, counted",
            f"Share of parts that come to rest {where}, estimated by a drop test.",
        )  # fmt: skip
    return quantities


RESTING: dict[str, Quantity] = {
    "small_diameter": Quantity(
        "m", "d_2", "Diameter of the other end",
        "Diameter of the second end of the part, opposite the first; 0 for a full cone.",
        0.0, parameter=True,
        examples=("12 mm",), usual=(1e-5, 5.0),
    ),
    "centre_of_mass": length(
        "z_c", "Height of the centre of mass",
        "Distance of the centre of mass from the first end of the part; for a weighted box, its "
        "height while the box lies flat.", "8 mm",
    ),
    "radius_of_gyration": length(
        "k", "Radius of gyration",
        "Radius of gyration of the part about a line through its centre, normal to its axis.",
        "7 mm",
    ),
    "mass_height": Quantity(
        "m", "z_c", "Height of the centre",
        "Height of the centre of mass above the first end of the part."
    ),
    "gyration": Quantity(
        "m", "k", "Gyration",
        "Radius of gyration of the standing part about a horizontal line, normal to the push."
    ),
    "sides": Quantity(
        "1", "n", "Sides of the prism",
        "Number of sides of a regular prism; the parameter diameter is that of the circle through "
        "its corners.",
        3.0,
        parameter=True, examples=("6",), usual=(3.0, 100.0),
    ),
    "let_down_shares": Quantity(
        "1", "s", "Shares, let down", "Share of let-down parts in each aspect.", bundle=True
    ),
    "thrown_shares": Quantity(
        "1", "t", "Shares, thrown", "Share of thrown parts in each aspect.", bundle=True
    ),
    "counted_shares": Quantity(
        "1", "p", "Shares by a test",
        "Share of the parts in each aspect by the drop test.", bundle=True
    ),
    "centre_heights": Quantity(
        "m", "z", "Heights of the centre",
        "Height of the centre of mass in each aspect.", bundle=True
    ),
    "depths": Quantity(
        "m", "R - h", "Depths of the aspects",
        "Distance by which the centre of mass in each aspect is below its highest possible place.",
        bundle=True,
    ),
    **_resting_shares(),
    "aspect": Quantity(
        "1", "o", "Aspect",
        "Number of an aspect of a part from a file; aspect 1 has the lowest centre of mass.",
        1.0, float(MAX_ASPECTS), parameter=True, examples=("1",),
    ),
    "part_density": Quantity(
        "kg m-3", "rho", "Density of the part",
        "Density of a part whose shape comes from a file.", 0.0, strict=True,
        parameter=True, examples=("7850 kg/m^3",), usual=(10.0, 23000.0),
    ),
    "part_volume": Quantity("m3", "V", "Volume of the part",
        "Volume of a part whose shape comes from a file."),
    "part_mass": Quantity("kg", "m", "Mass of the part",
        "Mass of a part whose shape comes from a file."),
    "let_down_share": number(
        "s", "Share that rests, let down",
        "Share of parts that come to rest in the aspect after they are let down with negligible "
        "momentum. The true share is between this value and thrown_share; their difference is the "
        "error.",
    ),
    "thrown_share": number(
        "t", "Share that rests, thrown",
        "Share of parts that come to rest in the aspect after they are thrown. The true share is "
        "between this value and let_down_share; their difference is the error.",
    ),
    "lying_height": Quantity("m", "h", "Height as it lies",
        "Height of the part when it lies in the aspect."),
    "lying_length": Quantity(
        "m", "l", "Length as it lies",
        "Longer side of the smallest rectangle around the part in the aspect, as seen from above.",
    ),
    "lying_width": Quantity(
        "m", "w", "Width as it lies",
        "Width of the lane that the part needs in the aspect, with its longer side along the lane.",
    ),
    "least_base": Quantity(
        "m", "b_0", "Least half base",
        "Least horizontal distance from the centre of mass to an edge of the base."
    ),
    "standing_base_across": Quantity(
        "m", "b_y", "Half base across",
        "Half of the base across the part's length: the shorter horizontal distance from the "
        "centre of mass to an edge.",
    ),
    "topple_slope_across": Quantity(
        "degree", "alpha_y", "Toppling slope across",
        "Slope across the part's length on which the part topples, unless it slides first.",
    ),
    "least_topple_slope": Quantity(
        "degree", "alpha_0", "Least toppling slope",
        "Least slope, in any direction, on which the part topples, unless it slides first.",
    ),
    "side_foot": number(
        "s/L_g", "Foot of the centre on the side",
        "Place on the part's side that is below the centre of mass: 0 at the first end, 1 at the "
        "second end. Outside of this range the part does not lie on its side.",
    ),
    "long_side_share": number(
        "p_w", "Share with the long side along the wall",
        "Share of flat parts that turn their long side to a wall when they are pushed against it "
        "without friction.",
    ),
    "standing_base": Quantity(
        "m", "b", "Half base", "Half of the standing part's base, measured along the push."
    ),
    "standing_centre": Quantity(
        "m", "z_c", "Height of the standing part's centre",
        "Height of the standing part's centre of mass."
    ),
    "edge_distance": Quantity("m", "R", "Edge to centre",
        "Distance of the centre of mass from the edge about which the part topples."),
    "topple_slope": Quantity(
        "degree", "alpha_c", "Toppling slope",
        "Slope on which the standing part topples, unless it slides first.",
    ),
    "rocking_friction": number(
        "b/z_c", "Least friction of rocking",
        "Coefficient of friction below which the standing part slides and never rocks.",
    ),
    "rocking_rate": Quantity(
        "s-1", "p", "Rocking rate",
        "Rate p at which a part falls when it is balanced on its edge: small tilts grow as exp(p "
        "t)."
    ),
    "topple_speed": Quantity(
        "m s-1", "V", "Toppling speed",
        "Least speed at which the standing part topples if its foot is stopped suddenly.",
    ),
    "pulse_angle": Quantity(
        "rad", "psi", "Start of rocking",
        "Phase of the half-sine pulse at which the part starts to rock."
    ),
    "topple_acceleration": Quantity(
        "m s-2", "a", "Toppling acceleration",
        "Peak of a half-sine acceleration pulse, at the drive frequency, that topples the "
        "standing part.",
    ),
    "push_over_load": number(
        "|D|/n", "Largest push over load",
        "Largest ratio of the push along the track to the load on the floor in a period of the "
        "drive.",
    ),
    "rocking_margin": number(
        "", "Margin of rocking",
        "The smaller of the friction coefficient and push_over_load, minus the friction that "
        "rocking requires. At 0 or below, the standing part never rocks.",
    ),
    "topple_margin": Quantity(
        "m s-1", "", "Margin of toppling",
        "Half of the toppling speed minus the largest speed of the track along the floor.",
    ),
}  # fmt: skip


MAX_DEVICES = 6
"""Places of a line."""

PAIRS = {
    10 * i + j: f"{i} to {j}"
    for i in range(1, NUMBERED + 1)
    for j in range(1, NUMBERED + 1)
    if i != j
}
"""What `turn` may be: from one aspect to another."""


def _device(position: int) -> dict[str, Quantity]:
    at = f", place {position}"

    def size(symbol: str, label: str, says: str, example: str) -> Quantity:
        return length(f"{symbol}{position}", label + at, says, example)

    return {
        "wiper_height": size(
            "h", "Height of the wiper",
            "Height of the edge of a wiper above the track; lower parts pass.", "12 mm",
        ),
        "ledge_width": size(
            "w", "Width of the ledge",
            "Width of a narrow track along the wall; parts pass if their centre of mass is above "
            "it.", "9 mm",
        ),
        "gap_length": size(
            "s", "Length of the gap",
            "Length of a gap in the track; parts longer than twice the gap pass.", "8 mm",
        ),
        "passed_aspect": Quantity(
            "1", f"p{position}", f"Passing aspect{at}",
            "Number of the only aspect that passes the device.", 1.0,
            float(MAX_ASPECTS), parameter=True, examples=("1",),
        ),
        "rail_width": size(
            "r", "Width of the rails",
            "Distance between two rails; parts pass if they hang by their head, with the shank "
            "between the rails.", "5 mm",
        ),
        "outlet_capacity": Quantity(
            "min-1", f"c{position}", f"Capacity{at}",
            "Maximum number of parts per minute that pass a pressure break or an outlet.",
            0.0, strict=True,
            parameter=True, examples=("120 1/min",),
        ),
        "turned_share": Quantity(
            "1", f"t{position}", f"Share turned{at}",
            "Share of the parts in one aspect that a riser, a step or a wiper turns into another "
            "aspect.",
            0.0, 1.0, parameter=True, examples=("0.6",),
        ),
        "turn": Quantity(
            "1", f"o{position}", f"Turn{at}",
            "Aspects before and after turning, as two digits: 21 turns aspect 2 into aspect 1.",
            12.0, 98.0,
            parameter=True, examples=("21",), words=PAIRS, other_words="{}",
        ),
    }  # fmt: skip


END = (
    "In orienting-line this is the value for let-down parts, or that of a drop test if the study "
    "has one. The outputs with _lower and _upper are its limits."
)
"""What a single number of a line stands for."""

DEVICES = tuple(_device(1))
"""What a study may give of a device, without its place."""


def _shares() -> dict[str, Quantity]:
    quantities = {}
    for name, (words, _) in ASPECTS.items():
        quantities[f"passing_share_{name}"] = number(
            f"v_{name}", f"Share that passes, {words}",
            f"Share of the parts arriving {words} that leave the line in any aspect.",
        )  # fmt: skip
        quantities[f"leaving_share_{name}"] = number(
            f"e_{name}", f"Share that leaves, {words}",
            f"Share of all arriving parts that are {words} when they leave the line.",
        )  # fmt: skip
    return quantities


def _rate(symbol: str, label: str, says: str) -> Quantity:
    return Quantity("min-1", symbol, label, says)


def _ends() -> dict[str, Quantity]:
    quantities = {}
    for name, (unit, symbol, words) in {
        "yield": ("1", "eta", "yield"),
        "laps": ("1", "1/eta", "number of laps"),
        "line_feed_rate": ("min-1", "q eta", "feed rate of the line"),
        "purity": ("1", "e*/eta", "purity"),
        "oriented_feed_rate": ("min-1", "q e*", "oriented feed rate"),
        "return_rate": ("min-1", "q (1 - eta)", "return rate"),
    }.items():
        for end, sign, which, of_both in (
            ("lower", "-", "Least", "smaller"),
            ("upper", "+", "Largest", "larger"),
        ):
            quantities[f"{name}_{end}"] = Quantity(
                unit, f"({symbol}){sign}", f"{which} {words}",
                f"The {of_both} of two values of the {words}: for let-down parts and for thrown "
                f"parts. With a drop test, it is the {end} end of the 95 % confidence interval.",
            )  # fmt: skip
    return quantities


ORIENTING: dict[str, Quantity] = {
    "arrival_rate": Quantity(
        "min-1", "q", "Arriving parts",
        "Number of parts per minute that arrive at the first device.", 0.0,
        strict=True, parameter=True, examples=("300 1/min",),
    ),
    "arrival_speed": Quantity(
        "m s-1", "v", "Arriving speed",
        "Conveying velocity of the parts ahead of the first device.",
        0.0, strict=True, parameter=True, examples=("60 mm/s",), usual=(1e-4, 2.0),
    ),
    "part_pitch": length("l_p", "Pitch of the parts",
    "Distance between the centres of neighbouring parts in a row.", "22 mm"),
    "wanted_aspect": Quantity(
        "1", "o*", "Wanted aspect",
        "Number of the aspect in which the parts are to leave the line.", 1.0,
        float(MAX_ASPECTS), parameter=True, examples=("1",),
    ),
    "shank_diameter": length(
        "d_s", "Diameter of the shank",
        "Diameter of the shank of a part with a head; the parameter diameter is that of the head.",
        "4 mm"
    ),
    "device_order": Quantity(
        "1", "m", "Order of the devices",
        "Number of the order of the devices. The orders are sorted alphabetically: 1 is the order "
        "of their places, the last number is the reverse order.",
        1.0, 720.0, parameter=True, examples=("1",), count=True,
    ),
    **{
        f"drop_count_{k}": Quantity(
            "1", f"n{k}", f"Count of aspect {k}",
            f"Number of parts in a drop test that came to rest in aspect {k}.", 0.0, parameter=True,
            examples=("129",),
        )
        for k in range(1, NUMBERED + 1)
    },
    **{
        f"{name}_{place}": quantity
        for place in range(1, MAX_DEVICES + 1)
        for name, quantity in _device(place).items()
    },
    "aspect_sizes": Quantity("m", "", "Sizes", "Sizes of the part in each aspect.", bundle=True),
    "devices": Quantity("1", "D", "Devices", "Devices of a line.", bundle=True),
    "line": Quantity("1", "e", "Line", "Shares of parts that pass the devices of a "
    "line.", bundle=True),
    "thrown_line": Quantity(
        "1", "e", "Line, thrown", "Shares of thrown parts that pass the devices of a line.",
        bundle=True,
    ),
    "counted_line": Quantity(
        "1", "e", "Line by a test",
        "Shares of parts that pass the devices of a line, by the drop test.", bundle=True
    ),
    "line_ends": Quantity(
        "1", "e", "Ends of the line",
        "Shares of parts that pass a line at both limits of the shares that arrive.",
        bundle=True,
    ),
    "drop_count": number("A", "Counts",
        "Number of parts in the drop test, plus half a part for each aspect."),
    "yield": number(
        "eta", "Yield", f"Share of all arriving parts that leave the line, in any aspect. {END}"
    ),
    **_shares(),
    "leaving_wanted": number(
        "e*", "Share that leaves as wanted",
        "Share of all arriving parts that leave the line in the wanted aspect."
    ),
    "purity": number(
        "e*/eta", "Purity", f"Share of the leaving parts that are in the wanted aspect. {END}"
    ),
    "laps": number(
        "1/eta", "Laps",
        f"Mean number of laps that a part needs to leave the line, in any aspect. {END}",
    ),
    "laps_variance": number("var", "Variance of the laps",
    "Variance of the number of laps that a part needs to leave the line."),
    "laps_99": number(
        "n_99", "Laps of 99 %",
        "Number of laps within which 99 of 100 parts leave the line, in any aspect."
    ),
    "lap_time": Quantity(
        "s", "T", "Time of a lap",
        "Time that a part needs from the bowl to the first device and back.", 0.0,
        strict=True, parameter=True, examples=("40 s",),
    ),
    "time_per_part": Quantity(
        "s", "T/eta", "Time in the bowl",
        "Mean time for which a part circulates in the bowl until it leaves the line, in any "
        "aspect.",
    ),
    "line_yield": Quantity(
        "1", "eta", "Yield of the line",
        "Share of the parts that pass the devices after the track, in any aspect: the yield of "
        "orienting-line.",
        0.0, 1.0, parameter=True, examples=("0.79",),
    ),
    "line_purity": Quantity(
        "1", "e*/eta", "Purity of the line",
        "Share of the parts leaving the devices after the track that are in the wanted aspect: "
        "the purity of orienting-line.",
        0.0, 1.0, parameter=True, examples=("1.0",),
    ),
    "line_feed_rate": _rate(
        "q eta", "Feed rate of the line",
        f"Number of parts per minute that leave the line, in any aspect. {END}",
    ),
    "oriented_feed_rate": _rate(
        "q e*", "Oriented feed rate",
        "Number of parts per minute that leave the line in the wanted aspect: the feed rate of the "
        f"line times the purity. {END}",
    ),
    "return_rate": _rate(
        "q (1 - eta)", "Return rate",
        "Number of parts per minute that do not leave the line and fall back into the bowl. "
        f"{END}",
    ),
    "yield_deviation": Quantity(
        "1", "s(eta)", "Deviation of the yield",
        "Standard deviation of the yield, estimated from a drop test.",
        error_of="yield",
    ),
    **_ends(),
}  # fmt: skip
