"""Numbers that stand for names in arrays and kernels: statuses, and what binds."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.quantities import OPTIMUM_STATUSES

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

Flags = NDArray[np.int16]
"""Sums of `ACTIVE` bits."""

Statuses = NDArray[np.int8]
"""Values of `STATUS`."""
