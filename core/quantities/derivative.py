"""The status of a derivative: by which way it was computed, or why there is none."""

from __future__ import annotations

from vibrafeed.core.quantities.flags import Flag

DERIVATIVE_STATUSES: dict[str, Flag] = {
    "exact": Flag(0, "exact up to rounding"),
    "both_sides": Flag(1, "from both sides of a switch of the equations, which agree"),
    "differences": Flag(2, "extrapolated from differences inside one regime"),
    "kink": Flag(3, "none: a kink or a jump, where the two sides differ or cannot be separated"),
    "not_periodic": Flag(4, "none: the motion does not repeat, it is aperiodic or runs away"),
    "no_value": Flag(5, "none: the output has no finite value here"),
    "unsettled": Flag(6, "none: differences do not settle, or the regime changes too near"),
    "not_computed": Flag(7, "not computed"),
}
"""Of a cell and a parameter; what is said is the most serious of all outputs."""
