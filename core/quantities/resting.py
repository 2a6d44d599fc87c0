"""Parts that come to rest and stand: shares of their aspects, and what makes them topple."""

from __future__ import annotations

from vibrafeed.core.quantities.quantity import Quantity, length, number

ASPECTS = {
    "flat": ("flat", "on a face of length by width"),
    "on_side": ("on a side", "on its side"),
    "on_end": ("on an end", "on an end"),
    "upright": ("upright", "on the end of `diameter`"),
    "inverted": ("inverted", "on the end of `small_diameter`"),
}
"""How parts lie; those of one shape are numbered in the order in which its scene lists them."""


def _shares() -> dict[str, Quantity]:
    """Return the declarations of the shares in which parts rest, by name.

    For each aspect, the way in which a part lies, there are the shares of let-down and of thrown
    parts, between which the truth lies, and that by the counts of a drop test.
    """
    quantities = {}
    for name, (words, where) in ASPECTS.items():
        plain = where.replace("`", "")
        quantities[f"let_down_share_{name}"] = number(
            f"s_{name}", f"Share that rests {words}, let down",
            f"Share of parts that come to rest {plain}, let down with negligible momentum. The "
            f"truth lies between this and thrown_share_{name}: their distance is the error.",
        )  # fmt: skip
        quantities[f"thrown_share_{name}"] = number(
            f"t_{name}", f"Share that rests {words}, thrown",
            f"Share of parts that come to rest {plain}, thrown. The truth lies between this and "
            f"let_down_share_{name}: their distance is the error.",
        )  # fmt: skip
        quantities[f"counted_share_{name}"] = number(
            f"p_{name}", f"Share that rests {words}, counted",
            f"Share of parts that come to rest {plain}, by the counts of a drop test.",
        )  # fmt: skip
    return quantities


RESTING: dict[str, Quantity] = {
    "small_diameter": Quantity(
        "m", "d_2", "Diameter of the other end",
        "Diameter of the end opposite to that of diameter; 0 of a full cone.", 0.0, parameter=True,
        examples=("12 mm",), usual=(1e-5, 5.0),
    ),
    "centre_of_mass": length(
        "z_c", "Height of the centre of mass",
        "Distance of the centre of mass from the end of diameter.", "8 mm",
    ),
    "radius_of_gyration": length(
        "k", "Radius of gyration",
        "Root of moment of inertia over mass, about a line across the part through its centre.",
        "7 mm",
    ),
    "mass_height": Quantity(
        "m", "z_c", "Height of the centre", "Height of the centre of mass above the end of "
        "diameter."
    ),
    "gyration": Quantity(
        "m", "k", "Gyration", "Radius of gyration of the standing part across the push."
    ),
    "sides": Quantity(
        "1", "n", "Sides of the prism",
        "Sides of a regular prism; diameter is that of the circle through its corners.", 3.0,
        parameter=True, examples=("6",), usual=(3.0, 100.0),
    ),
    "let_down_shares": Quantity(
        "1", "s", "Shares, let down", "Share of let-down parts in each aspect.", bundle=True
    ),
    "thrown_shares": Quantity(
        "1", "t", "Shares, thrown", "Share of thrown parts in each aspect.", bundle=True
    ),
    "counted_shares": Quantity(
        "1", "p", "Shares by a test", "Posterior shares, one per aspect.", bundle=True
    ),
    "centre_heights": Quantity(
        "m", "z", "Heights of the centre", "Height of the centre in each aspect.", bundle=True
    ),
    "depths": Quantity(
        "m", "R - h", "Depths of the aspects",
        "Height of the centre in each aspect below the highest that it can have.", bundle=True,
    ),
    **_shares(),
    "side_foot": number(
        "s/L_g", "Foot of the centre on the side",
        "Place of the centre's foot along the side, from the end of diameter; outside of 0 to 1 "
        "the part does not lie on its side.",
    ),
    "long_side_share": number(
        "p_w", "Share with the long side along the wall",
        "Share of flat parts that turn their long side to a wall "
        "when pushed against it, without friction.",
    ),
    "standing_base": Quantity(
        "m", "b", "Half base", "Half of the base of the standing part, along the push."
    ),
    "standing_centre": Quantity(
        "m", "z_c", "Height of the standing part's centre", "Height of its centre of mass."
    ),
    "edge_distance": Quantity("m", "R", "Edge to centre", "Distance of the centre from the edge."),
    "topple_slope": Quantity(
        "degree", "alpha_c", "Toppling slope",
        "Slope on which the standing part topples, unless it slides before.",
    ),
    "rocking_friction": number(
        "b/z_c", "Least friction of rocking",
        "Friction below which the standing part slides and never rocks.",
    ),
    "rocking_rate": Quantity(
        "s-1", "p", "Rocking rate", "Rate at which the part falls from its edge."
    ),
    "topple_speed": Quantity(
        "m s-1", "V", "Toppling speed",
        "Speed from which the standing part topples if its foot stops at once.",
    ),
    "pulse_angle": Quantity(
        "rad", "psi", "Start of rocking", "Phase of the half sine at which rocking starts."
    ),
    "topple_acceleration": Quantity(
        "m s-2", "a", "Toppling acceleration",
        "Peak of a half-sine pulse of the frequency that topples the standing part.",
    ),
    "push_over_load": number(
        "|D|/n", "Largest push over load",
        "Largest push along the track over the load on the floor, in a period of the drive.",
    ),
    "rocking_margin": number(
        "", "Margin of rocking",
        "The smaller of friction and the largest push over load, less the friction that rocking "
        "needs. At 0 or below, the standing part never rocks.",
    ),
    "topple_margin": Quantity(
        "m s-1", "", "Margin of toppling",
        "Half of the toppling speed less the largest speed of the track along the floor.",
    ),
}  # fmt: skip
