"""Types of the arrays that kernels take."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Statuses = NDArray[np.int8]
Flags = NDArray[np.int64]
