"""What the impacts of two bodies share."""

from __future__ import annotations

import numpy as np

from core.mechanics.arrays import Array, Mask


def only_in_impact(value: Array, nothing: Mask, unknown: Mask) -> Array:
    """Return `value`, 0 where nothing happens, and NaN where the law does not tell."""
    return np.where(unknown, np.nan, np.where(nothing, 0.0, value))
