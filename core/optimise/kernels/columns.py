"""Columns, numbers and tolerances of the compiled batch solver, frozen into its code."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.optimise.codes import ACTIVE, ANGLE_PROBLEMS, STATUS

Numbers = NDArray[np.float64]

PLANE_THESIS, PLANE_PHYSICAL = ANGLE_PROBLEMS["plane_thesis"], ANGLE_PROBLEMS["plane_physical"]
TRACK_THESIS, TRACK_DERIVED = ANGLE_PROBLEMS["track_thesis"], ANGLE_PROBLEMS["track_derived"]
TRACK_PHYSICAL = ANGLE_PROBLEMS["track_physical"]

OPTIMAL, FLAT, NO_MOTION = STATUS["optimal"], STATUS["flat"], STATUS["no_motion"]
NOT_ATTAINED, INFEASIBLE = STATUS["not_attained"], STATUS["infeasible"]
INVALID, LIMIT_REACHED = STATUS["invalid"], STATUS["limit_reached"]

# Groups: what a design gives.
P_, ALONG, ACROSS, NORMAL, MU_K, MU_S, LIMIT, ALPHA_LO, ALPHA_HI, BETA_LO, BETA_HI = range(11)
GROUPS = 11

# The table of results.
(
    ALPHA, BETA, VALUE, CROSS, MARGIN_ACROSS, MARGIN_FLOOR, MARGIN_WALL,
    PRICE_ACROSS, PRICE_FLOOR, PRICE_WALL, RESIDUAL,
) = range(11)  # fmt: skip
COLUMNS = 11

# Rows of margins and slopes: the objective, then the constraints, the last `HELD`.
OBJECTIVE = 0
(
    ALPHA_LOWER, ALPHA_UPPER, BETA_LOWER, BETA_UPPER, ACROSS_LOWER, ACROSS_UPPER, FLOOR, WALL,
    START,
) = (bit.bit_length() for bit in ACTIVE.values())  # fmt: skip
CONSTRAINTS = 1 + len(ACTIVE)

KEPT = 1e-14  # a plane that a unit vector oversteps by less is kept: a few roundings
TINY = 1e-290  # a drive below this share of gravity is none
