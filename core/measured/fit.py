"""The harmonics of a drive, fitted to measured accelerations, with their errors."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.measured.drive import Clock, Fit, wrap_angle
from vibrafeed.core.measured.fundamental import DRIFT, fundamental, orders_below
from vibrafeed.core.measured.gravity import tilt_of
from vibrafeed.core.measured.harmonics import Array, Samples, Solution, solve_least_squares
from vibrafeed.core.measured.noise import Noise, covariance_of, hurdle, noise_of
from vibrafeed.core.measured.read import RecordingTable
from vibrafeed.core.measured.recording import Recording, Signal, read_signal
from vibrafeed.core.measured.validity import check_before, check_fit, check_orders


def fit_drive(source: str | Path | RecordingTable, recording: Recording) -> Fit:
    """Return the drive fitted to a recording: reads the signal, then fits it."""
    return fit_signal(read_signal(source, recording))


def fit_signal(signal: Signal) -> Fit:
    """Return the harmonics of a recorded signal, by least squares of all axes with one frequency.

    `signal` holds times, accelerations and the wishes of the study. A harmonic of an axis is
    significant, and a term of the drift kept, if it lowers Schwarz's information criterion: if its
    square over its variance, as the coloured residual states it, exceeds `hurdle` for each of its
    coefficients. Noise passes for a given order once in n recordings of n samples. Orders that are
    significant in no axis and higher terms of the drift are left out, and the rest is fitted again.

    Raises
    ------
    StudyError
        With every problem: too short, too slow, not periodic, not steady, a clock that is off by
        more than 5 %.
    """
    check_before(signal)
    middle = (signal.times[0] + signal.times[-1]) / 2.0
    samples = Samples(signal.times - middle, signal.accelerations)
    start = fundamental(samples, signal.frequency, signal.line_frequency)
    orders = orders_below(samples, start)
    check_orders(signal, samples, start)
    if signal.harmonics is not None:
        orders = orders[: signal.harmonics]
    solution, noise = _solve_weighted(samples, start, orders, DRIFT, signal.resolution)
    significant, degree = _significant(samples, solution, noise)
    if signal.harmonics is None:
        orders = tuple(np.array(orders)[significant.any(axis=0)].tolist()) or (1,)
    solution, noise = _solve_weighted(
        samples, solution.frequency, orders, degree, signal.resolution
    )
    significant, _ = _significant(samples, solution, noise)
    check_fit(signal, samples, solution, noise, bool(significant.any()))
    fit = _stated(signal, samples, solution, noise, significant)
    return fit if signal.harmonics is None else replace(fit, significant=np.ones_like(significant))


def _solve_weighted(
    samples: Samples, start: float, orders: tuple[int, ...], degree: int, resolution: Array
) -> tuple[Solution, Noise]:
    """Return the fit of harmonics with each axis weighted by its noise, and that noise.

    A fit with equal weights tells the noise of each axis first. `start` is a near frequency [Hz],
    `orders` are the harmonics, `degree` that of the drift, `resolution` the steps of the recorder
    for each axis [m s-2].
    """
    even = solve_least_squares(samples, start, orders, degree)
    weights = noise_of(samples, even, resolution).weights
    solution = solve_least_squares(samples, even.frequency, orders, degree, weights)
    # The weights that were used, not those that would be next: the errors are those of this fit.
    return solution, noise_of(samples, solution, resolution)._replace(weights=weights)


def _significant(
    samples: Samples, solution: Solution, noise: Noise
) -> tuple[NDArray[np.bool_], int]:
    """Return a mask of the significant harmonics, shape (axes, orders), and the drift's degree.

    A harmonic is significant if its square over its variance passes the threshold that noise passes
    with a probability of 1/n, n the number of samples; the degree is the highest of a significant
    coefficient of the drift. `solution` is the fit of the `samples`, `noise` the spectral density
    of its residual.
    """
    covariance = covariance_of(samples, solution, noise)
    axes, size = solution.coefficients.shape
    first, fine = solution.degree + 1, hurdle(samples.size)
    own = np.einsum("jajb->jab", covariance[1:, 1:].reshape(axes, size, axes, size))
    pairs = own[:, first:, first:].reshape(axes, len(solution.orders), 2, len(solution.orders), 2)
    waves = np.stack([solution.waves.real, solution.waves.imag], axis=-1)
    inverse = np.linalg.pinv(np.einsum("jkakb->jkab", pairs), hermitian=True)
    significant = np.einsum("jka,jkab,jkb->jk", waves, inverse, waves) > 2.0 * fine
    variance = np.diagonal(own, axis1=1, axis2=2)[:, :first]
    degree = int(np.flatnonzero((solution.drift**2 > fine * variance).any(axis=0)).max(initial=0))
    return significant, degree


def _stated(
    signal: Signal,
    samples: Samples,
    solution: Solution,
    noise: Noise,
    significant: NDArray[np.bool_],
) -> Fit:
    """Return the drive of a recording, as displacements of the track with errors, from its fit.

    `signal` and `samples` are the recording, before and after preparation, `solution` the fit of
    accelerations, `noise` the spectral density of its residual. `significant` is the mask of the
    harmonics that the recording tells from zero, shape (axes, orders): the origin of time is chosen
    such that the first of them has phase 0 in the axis where it is largest. A line frequency given
    by the study takes the place of the fitted one, and shows the error of the recorder's clock.
    """
    covariance = covariance_of(samples, solution, noise)
    error = float(np.sqrt(covariance[0, 0]))
    line = signal.line_frequency
    frequency = solution.frequency if line is None else line
    orders = np.array(solution.orders)
    strength = np.abs(solution.waves)
    lowest = int(np.flatnonzero(significant.any(axis=0))[0])
    largest = int(strength[:, lowest].argmax())
    # -c/(k w)^2 is the displacement; turned by k theta, the reference has phase 0.
    displacement = -solution.waves / (2.0 * np.pi * frequency * orders) ** 2
    theta = -float(np.angle(displacement[largest, lowest])) / solution.orders[lowest]
    displacement = displacement * np.exp(1j * orders * theta)
    displacement[largest, lowest] = np.abs(displacement[largest, lowest])
    periodic = np.sqrt((strength**2).sum() / 2.0)
    drift = solution.drift[:, 1:]
    drift_squares = (drift**2 / (2.0 * np.arange(1, solution.degree + 1) + 1.0)).sum(axis=1)
    density = noise.densities[1 + lowest].diagonal()
    return Fit(
        axes=signal.axes,
        orders=solution.orders,
        frequency=frequency,
        frequency_error=error if line is None else 0.0,
        clock=None if line is None else Clock(solution.frequency / line - 1.0, error / line),
        amplitudes=np.abs(displacement),
        phases=wrap_angle(np.angle(displacement)),
        significant=significant,
        covariance=_covariance_of_displacements(
            covariance, solution, displacement, theta, (largest, lowest), line
        ),
        constant=solution.drift[:, 0],
        drift=drift,
        left_over=np.sqrt(np.mean(solution.residual**2, axis=1)) / periodic,
        drifting=np.sqrt(drift_squares) / periodic,
        effective_samples=samples.size * np.minimum(1.0 / (noise.weights * density), 1.0),
        tilt=tilt_of(signal.axes, solution.drift[:, 0]),
        origin=samples.half + theta / (2.0 * np.pi * solution.frequency),
        signal=signal,
    )


def _covariance_of_displacements(
    covariance: Array,
    solution: Solution,
    displacement: NDArray[np.complex128],
    theta: float,
    reference: tuple[int, int],
    line: float | None,
) -> Array:
    """Return the covariance of frequency [Hz] and displacements [m] of a fit of accelerations.

    Shape (1 + 2 axes orders,) twice: the frequency, then real and imaginary part of each
    displacement by axis and order. The complex displacement of order k is z = -c exp(i k theta)/(k
    w)^2, with the acceleration c [m s-2] and the turn of the time origin theta = -arg(-c_ref)/k_ref
    by the harmonic `reference` (axis, order): dz = -dc exp(i k theta)/(k w)^2 - i k z
    Im(dc_ref/c_ref)/k_ref - 2 z df/f.

    `covariance` is that of frequency and accelerations; `line` is a known frequency [Hz], which has
    no error, or None.
    """
    axes, size = solution.coefficients.shape
    first = solution.degree + 1
    orders, waves = np.array(solution.orders), solution.waves
    pairs = 1 + np.arange(axes)[:, None] * size + first + 2 * np.arange(orders.size)
    frequency = solution.frequency if line is None else line
    change = np.zeros((*waves.shape, len(covariance)), dtype=np.complex128)
    scale = -np.exp(1j * orders * theta) / (2.0 * np.pi * frequency * orders) ** 2
    for axis in range(axes):
        for place in range(orders.size):
            own = pairs[axis, place]
            change[axis, place, own : own + 2] = scale[place], 1j * scale[place]
    if line is None:
        change[..., 0] = -2.0 * displacement / frequency
    own = pairs[reference]
    turn = np.array([1.0, 1j]) / waves[reference]
    share = orders / orders[reference[1]]
    change[..., own : own + 2] -= 1j * (displacement * share)[..., None] * turn.imag
    change[reference] = change[reference].real  # its phase is 0 by choice, without error
    rows = np.zeros((1 + 2 * waves.size, len(covariance)))
    rows[0, 0] = 1.0 if line is None else 0.0
    rows[1::2] = change.real.reshape(waves.size, -1)
    rows[2::2] = change.imag.reshape(waves.size, -1)
    return rows @ covariance @ rows.T
