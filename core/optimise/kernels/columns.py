"""Columns, families and tolerances of the compiled batch solver, frozen into its code."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.optimise.codes import ACTIVE, STATUS

Numbers = NDArray[np.float64]


class PlaneThesis(NamedTuple):
    """The printed formulas of part and plane, and which contacts a study keeps."""

    floor: bool
    wall: bool


class PlanePhysical(NamedTuple):
    """The block with the friction disc, on the floor."""

    floor: bool
    wall: bool


class TrackPrinted(NamedTuple):
    """The printed forces of the track, and which contacts a study keeps.

    `side` is -1 where the source prints the balance of the wall with the other sign, else 1.
    """

    floor: bool
    wall: bool
    side: float


class TrackPhysical(NamedTuple):
    """The block on the track, on floor and wall."""

    floor: bool
    wall: bool


Kept = PlaneThesis | PlanePhysical | TrackPrinted | TrackPhysical
"""What tells compiled code the family, by its type, and the contacts that are kept."""

OPTIMAL, FLAT, NO_MOTION = STATUS["optimal"], STATUS["flat"], STATUS["no_motion"]
NOT_ATTAINED, INFEASIBLE = STATUS["not_attained"], STATUS["infeasible"]
INVALID, LIMIT_REACHED = STATUS["invalid"], STATUS["limit_reached"]

# Groups: the columns of a design's inputs, SI units and radians.
P_, ALONG, ACROSS, NORMAL, MU_K, MU_S, LIMIT, ALPHA_LO, ALPHA_HI, BETA_LO, BETA_HI = range(11)
GROUPS = 11

# The columns of the table of results.
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


class Best(NamedTuple):
    """The best angles, and whether there are any."""

    status: int
    exists: bool
    alpha: float
    beta: float


class Work(NamedTuple):
    """Arrays that a kernel fills anew for each design.

    Attributes
    ----------
    planes, levels : ndarray
        Planes a.d <= b of the drive direction d, a row of a and one of b each.
    upwards, direction : ndarray, shape (3,)
        What is climbed, and the highest direction.
    betas, heights, rises : ndarray
        Samples of beta, the largest a_x there, and its slope.
    values : ndarray, shape (4,)
        a_x or K, a_y, n0 and the margin of the wall at the answer.
    slopes : ndarray, shape (CONSTRAINTS, 2)
        Gradients over alpha and beta: of the objective, then of the constraints, by their bits.
    margins, prices : ndarray, shape (CONSTRAINTS,)
        Margins and multipliers of the constraints.
    tight : ndarray of int64
        The constraints that bind.
    """

    planes: Numbers
    levels: Numbers
    upwards: Numbers
    direction: Numbers
    betas: Numbers
    heights: Numbers
    rises: Numbers
    values: Numbers
    slopes: Numbers
    margins: Numbers
    prices: Numbers
    tight: NDArray[np.int64]
