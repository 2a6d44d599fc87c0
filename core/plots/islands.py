"""Islands of a regime on a plane, and what becomes of very small ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, label

FEW = 16  # islands that a picture takes, however small
SPECK = 0.005  # of the plane: where there are more, the border of a smaller one would hide it


def without_specks(regimes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the regimes of a map with tiny islands, if many, merged into their neighbours.

    It is for borders and names in pictures; fills and shares show every cell. `regimes` has the
    number of the regime of each cell, in two dimensions; the result has the same shape.
    """
    sizes = np.zeros(regimes.shape, dtype=np.int64)
    count = 0
    for value in np.unique(regimes):
        islands, found = label(regimes == value)
        cells = np.bincount(islands.ravel())
        cells[0] = 0
        sizes += cells[islands]
        count += found
    specks = sizes < SPECK * regimes.size
    if count <= FEW or specks.all():
        return regimes
    row, column = distance_transform_edt(specks, return_distances=False, return_indices=True)
    return np.asarray(regimes[row, column])
