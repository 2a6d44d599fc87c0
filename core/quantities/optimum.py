"""The best values: what a search for them tells."""

from __future__ import annotations

from vibrafeed.core.quantities.flags import OPTIMUM_STATUSES
from vibrafeed.core.quantities.quantity import Quantity, flag, number

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
"""Outputs that tell how an optimum was found, in place of what it is."""
