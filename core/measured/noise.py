"""The errors of a fit, estimated from its residual, whatever its colour.

A wave hears only the noise about its own frequency: the errors of a harmonic depend on the
residual's spectral density there (Grenander and Rosenblatt, Statistical Analysis of Stationary
Time Series, 1957, chapter 7; Quinn and Hannan, The Estimation and Tracking of Frequency, 2001,
chapter 3). It is estimated by the mean of the periodogram over the bins nearest to the harmonic
that no fitted wave touches, for all axes and pairs of axes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.measured.harmonics import Array, Samples, Solution, columns

BINS = 20  # bins whose mean estimates a density within a fifth; more reach too far in red noise
LOWEST_BINS = 12  # about zero, where noise is steep and the drift hears the lowest bins only
TOUCHED = 1.0  # bins beside a fitted wave that the fit has changed
ROUNDING = 1e-10  # least noise, as a share of the rms of the values


class Noise(NamedTuple):
    """Noise of the drift and of each order.

    Attributes
    ----------
    densities : ndarray, shape (1 + orders, axes, axes)
        Spectral density of the residual about zero and about each order, scaled so that white
        noise has its variance in it [m2 s-4].
    weights : ndarray, shape (axes,)
        One over the variance of the residual.
    """

    densities: Array
    weights: Array


def noise_of(samples: Samples, solution: Solution, resolution: Array) -> Noise:
    """Return the noise of a fit, at least the rounding of the values.

    As spectral densities near the harmonics, and a weight for each axis. `samples` are the recorded
    accelerations, `solution` is the fit of harmonics to them, `resolution` the steps of the
    recorder for each axis [m s-2].
    """
    count = samples.size
    # Rounding to the recorder's steps, or of numbers: a mounting mixes that of all axes.
    floor = np.maximum(resolution**2 / 12.0, np.mean(samples.values**2) * ROUNDING**2)
    variance = np.maximum(np.mean(solution.residual**2, axis=1), floor)
    variance[variance == 0.0] = 1.0  # of a recording that is nothing but zeros
    centres = np.array([0, *solution.orders]) * solution.frequency * samples.duration
    densities = []
    spectrum = np.fft.rfft(solution.residual) / np.sqrt(count)
    for centre in centres:
        density = density_near(spectrum, centre, centres, solution.degree)
        lacking = np.maximum(floor - np.diag(density), 0.0)
        densities.append(density + np.diag(lacking))
    return Noise(np.array(densities), 1.0 / variance)


def density_near(
    spectrum: NDArray[np.complex128], centre: float, fitted: Array, degree: int
) -> Array:
    """Return the spectral density of the noise around a line, shape (axes, axes) [m2 s-4].

    The mean over the nearest bins that no fitted wave touches; off the diagonal for pairs of axes.

    Parameters
    ----------
    spectrum : ndarray, shape (axes, bins)
        Fourier transform of the residual over the root of the number of samples [m s-2].
    centre : float
        Place of the line, in bins.
    fitted : ndarray, shape (k,)
        Places of the waves that have been fitted, in bins.
    degree : int
        Degree of the fitted drift, which reaches up to half as many bins.
    """
    bins = np.arange(spectrum.shape[1])
    free = (np.abs(bins[:, None] - fitted) > TOUCHED).all(axis=1) & (bins > degree / 2.0)
    places = bins[free]
    near = places[
        np.argsort(np.abs(places - centre), kind="stable")[: BINS if centre > 0.0 else LOWEST_BINS]
    ]
    part = spectrum[:, near]
    return (part @ part.conj().T).real / max(near.size, 1)


def hurdle(count: int) -> float:
    """Return the threshold that a wave's square over its variance, halved, must exceed.

    m (n^(1/m) - 1) for n (`count`) samples or waves, and the number m of bins from which a density
    is estimated: noise exceeds it with the probability 1/n, since the square of a wave is
    exponential, and its variance the mean of m such squares. For many bins it is ln(n), the price
    of a coefficient in Schwarz's criterion (1978, doi 10.1214/aos/1176344136).
    """
    return float(BINS * (count ** (1.0 / BINS) - 1.0))


def covariance_of(samples: Samples, solution: Solution, noise: Noise) -> Array:
    """Return the covariance matrix of a fit: frequency [Hz] and coefficients of harmonics [m s-2].

    Shape (1 + axes size, ...): the frequency first, then the `size` coefficients of each axis
    (drift, then sine and cosine of each order). It is right for noise of any colour: H^-1 M H^-1
    with H = sum_j w_j J_j' J_j and M = sum_g sum_jl w_j w_l S_jl(g) J_jg' J_lg, where w_j is the
    weight of axis j, J_jg the derivative of its model by all unknowns, of which g takes the drift
    or one order, and S(g) the spectral density of the noise there.

    `samples` are times and values of the recording, `solution` is the fit, `noise` holds S and w.
    """
    axes, size = solution.coefficients.shape
    first = solution.degree + 1
    basis = columns(samples, solution.frequency, solution.orders, solution.degree)
    slanted = basis[:, first:] * (samples.times / samples.half)[:, None]
    gram = np.hstack([basis, slanted])
    gram = gram.T @ gram
    order = np.repeat(np.arange(1, len(solution.orders) + 1), 2)
    group = np.concatenate([np.zeros(first, dtype=np.int64), order, order])

    # Column by unknown: the first unknown is the frequency, in turns over half of the recording.
    derivative = np.zeros((axes, group.size, 1 + axes * size))
    turned = 2.0 * np.pi * np.array(solution.orders) * solution.waves
    for axis in range(axes):
        derivative[axis, np.arange(size), 1 + axis * size + np.arange(size)] = 1.0
        derivative[axis, size::2, 0] = -turned[axis].imag
        derivative[axis, size + 1 :: 2, 0] = turned[axis].real

    weighted = noise.weights[:, None, None] * derivative
    bread = _sum_products(weighted, gram @ derivative)
    meat = np.zeros_like(bread)
    for index, density in enumerate(noise.densities):
        own = group == index
        part = weighted[:, own]
        meat += _sum_products(np.tensordot(density, part, 1), gram[np.ix_(own, own)] @ part)
    # Weights and waves differ by many powers of ten: a scaled matrix is inverted.
    scale = 1.0 / np.sqrt(np.maximum(np.diag(bread), np.finfo(float).tiny))
    inverse = np.linalg.pinv(bread * np.outer(scale, scale), hermitian=True)
    inverse *= np.outer(scale, scale)
    inverse[0] /= samples.half
    covariance = inverse @ meat @ inverse.T
    return (covariance + covariance.T) / 2.0


def _sum_products(stack: Array, other: Array) -> Array:
    """Return the sum of A_j' B_j over two stacks of matrices."""
    return stack.reshape(-1, stack.shape[-1]).T @ other.reshape(-1, other.shape[-1])
