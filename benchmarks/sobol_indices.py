"""`python -m benchmarks.sobol_indices` counts how often intervals hold Sobol indices.

For the Ishigami function and the g-function, whose indices are known in closed form, it estimates
them again and again with other scramblings, and counts how often each interval holds the index.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.options import options
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.plan.statistics import REPLICATES
from vibrafeed.core.sensitivity.indices import Indices, design, indices_of

SAMPLES = (256, 1024, 4096)


def sobol_indices(
    function: Callable[[Array], Array], inputs: int, samples: int, seed: int = 0
) -> Indices:
    """Return the Sobol indices of a function of inputs uniform between 0 and 1.

    The function takes points (inputs, n), and returns values (n,) or (m, n) of m functions. Of
    `samples`, a power of two, it is evaluated at (inputs + 2) times as many.
    """
    at = design(inputs, samples // REPLICATES, seed)
    values = np.asarray(function(at.reshape(inputs, -1)), dtype=np.float64)
    return indices_of(values.reshape(*values.shape[:-1], *at.shape[1:]))


@dataclass(frozen=True)
class Known:
    """A function of the unit box with its indices.

    Attributes
    ----------
    values : callable
        Takes points (inputs, n), returns values (n,).
    first, total : ndarray, shape (inputs,)
        The indices.
    """

    values: Callable[[Array], Array]
    first: Array
    total: Array

    @property
    def inputs(self) -> int:
        """The number of inputs."""
        return len(self.first)


def _ishigami() -> Known:
    """Return the function of Ishigami and Homma (1990), a = 7 and b = 0.1, with its indices."""
    a, b = 7.0, 0.1

    def values(points: Array) -> Array:
        """Return the function's values."""
        x, y, z = np.pi * (2 * points - 1)
        return np.asarray(np.sin(x) + a * np.sin(y) ** 2 + b * z**4 * np.sin(x))

    alone = (1 + b * np.pi**4 / 5) ** 2 / 2
    second, both = a**2 / 8, 8 * b**2 * np.pi**8 / 225
    whole = alone + second + both
    first = np.array([alone, second, 0.0])
    return Known(values, first / whole, (first + np.array([both, 0.0, both])) / whole)


def _g_function() -> Known:
    """Return Sobol's g-function of eight inputs, a = 0, 1, 4.5, 9 and 4 x 99, with indices."""
    a = np.array([0, 1, 4.5, 9, 99, 99, 99, 99])

    def values(points: Array) -> Array:
        """Return the function's values."""
        return np.asarray(np.prod((np.abs(4 * points - 2) + a[:, None]) / (1 + a[:, None]), axis=0))

    parts = 1 / (3 * (1 + a) ** 2)
    whole = np.prod(1 + parts) - 1
    return Known(values, parts / whole, parts * np.prod(1 + parts) / (1 + parts) / whole)


FUNCTIONS = {"ishigami": _ishigami(), "g-function": _g_function()}


def coverage(one: Known, samples: int, repeats: int) -> Mask:
    """Return a mask of intervals that contain their index, (repeats, first and total, inputs)."""
    held = []
    for seed in range(repeats):
        found = sobol_indices(one.values, one.inputs, samples, seed)
        held.append(
            [
                np.abs(found.first - one.first) <= found.first_error,
                np.abs(found.total - one.total) <= found.total_error,
            ]
        )
    return np.array(held)


def main(repeats: int) -> None:
    """Print how often intervals contain their index."""
    for name, one in FUNCTIONS.items():
        for samples in SAMPLES:
            held = coverage(one, samples, repeats)
            each = 100 * held.mean(axis=0)
            print(f"{name}, {samples:,} samples, {repeats} repeats: {100 * held.mean():.1f} % hold")
            for which, row in zip(("first", "total"), each, strict=True):
                print(f"  {which}: {' '.join(f'{share:.0f}' for share in row)}")


if __name__ == "__main__":
    main(options(__doc__, repeats=100).repeats)
