"""Numbers that stand for names in arrays and kernels: statuses, what binds, answered problems."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.quantities import OPTIMUM_STATUSES

STATUS: Mapping[str, int] = {name: flag.value for name, flag in OPTIMUM_STATUSES.items()}
"""The value of each `OPTIMUM_STATUSES` entry."""

ACTIVE: Mapping[str, int] = {
    "alpha_lower": 1,
    "alpha_upper": 2,
    "beta_lower": 4,
    "beta_upper": 8,
    "across_lower": 16,  # a_y = -limit
    "across_upper": 32,  # a_y = +limit
    "floor": 64,  # n0 = 0
    "wall": 128,  # wall force 0
    "start": 256,  # static friction just holds
}
"""Bits of `active`: constraints that hold with equality."""

TIGHT = 1e-10
"""A margin below this, relative to the accelerations of its formula, counts as none."""

AngleProblem = Literal[
    "plane_thesis", "plane_physical", "track_thesis", "track_derived", "track_physical"
]

ANGLE_PROBLEMS: Mapping[AngleProblem, int] = {
    "plane_thesis": 0,
    "plane_physical": 1,
    "track_thesis": 2,
    "track_derived": 3,
    "track_physical": 4,
}
"""What the batch solver answers: scene and variant, by number."""

Flags = NDArray[np.int16]
"""Sums of `ACTIVE` bits."""

Statuses = NDArray[np.int8]
"""Values of `STATUS`."""
