"""How often each regime occurs."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.quantities import REGIMES


def regime_shares(regime: NDArray[Any]) -> dict[str, float]:
    """Return the share of cells in each regime that occurs, from 0 to 1, by the order of flags."""
    counts = np.bincount(np.ravel(regime), minlength=len(REGIMES))
    names = {flag.value: name for name, flag in REGIMES.items()}
    return {names[value]: float(n) / np.size(regime) for value, n in enumerate(counts) if n}
