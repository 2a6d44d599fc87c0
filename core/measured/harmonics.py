"""Least squares of harmonics with a drift, the frequency among the unknowns."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

Array = NDArray[np.float64]

MAX_STEPS = 50  # steps of the frequency
CONVERGED = 1e-6  # turns over the recording; without noise, the next step is its square
LONGEST_STEP = 0.25  # turns of the highest order over the recording; more could change the minimum


class Samples(NamedTuple):
    """Accelerations at times about the middle of the recording.

    Attributes
    ----------
    times : ndarray, shape (n,)
        From ``-half`` to ``half`` [s].
    values : ndarray, shape (axes, n)
        [m s-2].
    """

    times: Array
    values: Array

    @property
    def size(self) -> int:
        """The number of times."""
        return self.times.size

    @property
    def half(self) -> float:
        """Half the duration of the recording [s]."""
        return float(self.times[-1])

    @property
    def duration(self) -> float:
        """The duration [s], counting one step per sample."""
        return 2.0 * self.half * self.size / (self.size - 1)


class Solution(NamedTuple):
    """The harmonics and the drift that fit samples best.

    Attributes
    ----------
    frequency : float
        Of the first harmonic [Hz].
    orders : tuple of int
        The harmonic orders.
    degree : int
        Of the drift, a series of Legendre polynomials over the recording.
    coefficients : ndarray, shape (axes, degree + 1 + 2 orders)
        Coefficients of the columns that `columns` gives [m s-2].
    residual : ndarray, shape (axes, n)
        Samples less the fit [m s-2].
    """

    frequency: float
    orders: tuple[int, ...]
    degree: int
    coefficients: Array
    residual: Array

    @property
    def drift(self) -> Array:
        """The coefficients of the drift, constant first, shape (axes, degree + 1)."""
        return self.coefficients[:, : self.degree + 1]

    @property
    def waves(self) -> NDArray[np.complex128]:
        """The harmonics as complex amplitudes c, each Im(c exp(i k w t)), shape (axes, orders)."""
        pairs = self.coefficients[:, self.degree + 1 :]
        return pairs[:, 0::2] + 1j * pairs[:, 1::2]


def columns(samples: Samples, frequency: float, orders: tuple[int, ...], degree: int) -> Array:
    """Return the columns of the fit: polynomials of the drift, sine and cosine of each order.

    Shape (n, degree + 1 + 2 orders); the frequency is in Hz, `degree` that of the drift.
    """
    phase = np.outer(samples.times, 2.0 * np.pi * frequency * np.array(orders))
    waves = np.stack([np.sin(phase), np.cos(phase)], axis=-1).reshape(samples.size, -1)
    return np.hstack([legvander(samples.times / samples.half, degree), waves])


def solve_least_squares(
    samples: Samples,
    frequency: float,
    orders: tuple[int, ...],
    degree: int,
    weights: Array | None = None,
    *,
    free: bool = True,
) -> Solution:
    """Return the least-squares fit of harmonics and drift to all axes, from a near frequency.

    Minimises sum_j w_j |y_j - C(f) b_j|^2 over the axes j, with samples y, columns C and
    coefficients b, by variable projection: the coefficients b follow from the frequency f, and f
    moves by Gauss-Newton steps along what C cannot imitate of the change of C(f) b (Golub and
    Pereyra 2003, doi 10.1088/0266-5611/19/2/201; Kaufman's step). Waves and Legendre polynomials
    are nearly orthogonal, so that normal equations lose no digits.

    Parameters
    ----------
    samples : Samples
        Accelerations of all axes [m s-2] and their times [s].
    frequency : float
        Of the first harmonic [Hz], within about a tenth of a turn over the recording, for the
        highest order.
    orders : tuple of int
        The harmonic orders.
    degree : int
        Degree of the drift, a series of Legendre polynomials.
    weights : ndarray, shape (axes,), optional
        One over the variance of each axis; equal if left out.
    free : bool
        False keeps the frequency.
    """
    weights = np.ones(len(samples.values)) if weights is None else weights
    limit = LONGEST_STEP / (samples.duration * max(orders))
    last = not free
    for _ in range(MAX_STEPS):
        basis = columns(samples, frequency, orders, degree)
        gram = basis.T @ basis
        coefficients = np.asarray(np.linalg.solve(gram, basis.T @ samples.values.T).T, np.float64)
        residual = samples.values - coefficients @ basis.T
        solution = Solution(frequency, orders, degree, coefficients, residual)
        if last:
            break
        change = _by_frequency(samples, basis, solution)
        change -= np.linalg.solve(gram, basis.T @ change.T).T @ basis.T
        size = weights @ (change * change).sum(axis=1)
        if size <= 0.0:  # nothing moves at this frequency
            break
        step = float(weights @ (change * residual).sum(axis=1) / size)
        frequency += float(np.clip(step, -limit, limit))
        last = abs(step) * samples.duration < CONVERGED
    return solution


def _by_frequency(samples: Samples, basis: Array, solution: Solution) -> Array:
    """Return the derivative of fitted accelerations by the frequency, shape (axes, n) [m s-2 Hz-1].

    The frequency of a fit is found with it by Gauss-Newton steps. `samples` has n times, `basis`
    are the columns of the fit, shape (n, columns): drift, then sine and cosine of each order;
    `solution` is the fit so far.
    """
    waves = basis[:, solution.degree + 1 :]
    sine, cosine = waves[:, 0::2], waves[:, 1::2]
    turned = 2.0 * np.pi * np.array(solution.orders) * solution.waves
    return (turned.real @ cosine.T - turned.imag @ sine.T) * samples.times
