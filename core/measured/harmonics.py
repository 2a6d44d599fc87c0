"""Least squares of harmonics with a drift, the frequency among the unknowns."""

from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray
from scipy.fft import next_fast_len

from vibrafeed.core.measured.recording import MAX_ORDERS
from vibrafeed.core.measured.times import UNEVEN

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
    longest_step = LONGEST_STEP / (samples.duration * max(orders))
    is_last = not free
    for _ in range(MAX_STEPS):
        basis = columns(samples, frequency, orders, degree)
        normal_matrix = basis.T @ basis
        coefficients = np.asarray(
            np.linalg.solve(normal_matrix, basis.T @ samples.values.T).T, np.float64
        )
        residual = samples.values - coefficients @ basis.T
        solution = Solution(frequency, orders, degree, coefficients, residual)
        if is_last:
            break
        change = _derivative_by_frequency(samples, basis, solution)
        # Without the part that the coefficients could imitate.
        change -= np.linalg.solve(normal_matrix, basis.T @ change.T).T @ basis.T
        square_of_change = weights @ (change * change).sum(axis=1)
        if square_of_change <= 0.0:  # the residual does not depend on the frequency
            break
        step = float(weights @ (change * residual).sum(axis=1) / square_of_change)
        frequency += float(np.clip(step, -longest_step, longest_step))
        is_last = abs(step) * samples.duration < CONVERGED
    return solution


def _derivative_by_frequency(samples: Samples, basis: Array, solution: Solution) -> Array:
    waves = basis[:, solution.degree + 1 :]
    sine, cosine = waves[:, 0::2], waves[:, 1::2]
    slopes = 2.0 * np.pi * np.array(solution.orders) * solution.waves
    return (slopes.real @ cosine.T - slopes.imag @ sine.T) * samples.times


# --- The errors of a fit, estimated from its residual, whatever its colour.


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

    `resolution` holds the steps of the recorder for each axis [m s-2].
    """
    count = samples.size
    # Rounding to the recorder's steps, or of numbers: a mounting mixes that of all axes.
    least_variance = np.maximum(resolution**2 / 12.0, np.mean(samples.values**2) * ROUNDING**2)
    variance = np.maximum(np.mean(solution.residual**2, axis=1), least_variance)
    variance[variance == 0.0] = 1.0  # of a recording that is nothing but zeros
    centres = np.array([0, *solution.orders]) * solution.frequency * samples.duration
    densities = []
    spectrum = np.fft.rfft(solution.residual) / np.sqrt(count)
    for centre in centres:
        density = density_near(spectrum, centre, centres, solution.degree)
        densities.append(density + np.diag(np.maximum(least_variance - np.diag(density), 0.0)))
    return Noise(np.array(densities), 1.0 / variance)


def density_near(
    spectrum: NDArray[np.complex128], centre: float, fitted_bins: Array, degree: int
) -> Array:
    """Return the spectral density of the noise around a line, shape (axes, axes) [m2 s-4].

    The mean over the bins nearest to `centre` that no fitted wave touches; off the diagonal for
    pairs of axes. `spectrum`, shape (axes, bins), is the Fourier transform of the residual over the
    root of the number of samples [m s-2]; `fitted_bins`, shape (k,), are the places of fitted waves
    in bins, `degree` that of the fitted drift, which reaches up to half as many bins.
    """
    bins = np.arange(spectrum.shape[1])
    is_free = (np.abs(bins[:, None] - fitted_bins) > TOUCHED).all(axis=1) & (bins > degree / 2.0)
    free_bins = bins[is_free]
    nearest = free_bins[
        np.argsort(np.abs(free_bins - centre), kind="stable")[
            : BINS if centre > 0.0 else LOWEST_BINS
        ]
    ]
    amplitudes = spectrum[:, nearest]
    return (amplitudes @ amplitudes.conj().T).real / max(nearest.size, 1)


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

    Shape (1 + axes size, ...): the frequency first, then the coefficients of each axis
    (drift, then sine and cosine of each order). It is right for noise of any colour: H^-1 M H^-1
    with H = sum_j w_j J_j' J_j and M = sum_g sum_jl w_j w_l S_jl(g) J_jg' J_lg, where w_j is the
    weight of axis j, J_jg the derivative of its model by all unknowns, of which g takes the drift
    or one order, and S(g) the spectral density of the noise there.

    `samples` are times and values of the recording, `solution` is the fit, `noise` holds S and w.
    """
    axes, unknowns = solution.coefficients.shape
    first_wave = solution.degree + 1
    basis = columns(samples, solution.frequency, solution.orders, solution.degree)
    waves_times_time = basis[:, first_wave:] * (samples.times / samples.half)[:, None]
    gram = np.hstack([basis, waves_times_time])
    gram = gram.T @ gram
    # The group of each column: 0 for the drift, else the position of its order, from 1.
    order_group = np.repeat(np.arange(1, len(solution.orders) + 1), 2)
    group = np.concatenate([np.zeros(first_wave, dtype=np.int64), order_group, order_group])

    # Column by unknown: the first unknown is the frequency, in turns over half of the recording.
    derivative = np.zeros((axes, group.size, 1 + axes * unknowns))
    slopes_by_frequency = 2.0 * np.pi * np.array(solution.orders) * solution.waves
    for axis in range(axes):
        derivative[axis, np.arange(unknowns), 1 + axis * unknowns + np.arange(unknowns)] = 1.0
        derivative[axis, unknowns::2, 0] = -slopes_by_frequency[axis].imag
        derivative[axis, unknowns + 1 :: 2, 0] = slopes_by_frequency[axis].real

    weighted = noise.weights[:, None, None] * derivative
    hessian = _sum_products(weighted, gram @ derivative)
    middle = np.zeros_like(hessian)
    for number, density in enumerate(noise.densities):
        of_group = group == number
        group_derivative = weighted[:, of_group]
        middle += _sum_products(
            np.tensordot(density, group_derivative, 1),
            gram[np.ix_(of_group, of_group)] @ group_derivative,
        )
    # Weights and waves differ by many powers of ten: a scaled matrix is inverted.
    scale = 1.0 / np.sqrt(np.maximum(np.diag(hessian), np.finfo(float).tiny))
    inverse = np.linalg.pinv(hessian * np.outer(scale, scale), hermitian=True)
    inverse *= np.outer(scale, scale)
    inverse[0] /= samples.half
    covariance = inverse @ middle @ inverse.T
    return (covariance + covariance.T) / 2.0


def _sum_products(stack: Array, other: Array) -> Array:
    return stack.reshape(-1, stack.shape[-1]).T @ other.reshape(-1, other.shape[-1])


# --- The frequency with which a recording repeats itself, wherever its strongest line stands.


LEAST_PERIODS = 10  # periods that a recording needs
MAX_LEFT = 0.5  # largest rms of the residual, over that of the harmonics
SLOWEST = 2.0  # periods in the recording: slower waves are drift
NYQUIST_SHARE = 0.45  # of the sampling rate, below which the highest order lies
GUESS = 0.1  # share by which a guessed frequency may be off
DRIFT = 3  # degree of the polynomial that is tried for the drift
PADDING = 4  # factor by which the spectrum is padded, to find a peak between bins
LEAST_SHARE = 1e-4  # of the drive's power: weaker lines are not taken for its fundamental
LEAKAGE = 0.03  # bins by which other lines may shift a line


class Line(NamedTuple):
    """A spectral line of a recording.

    Attributes
    ----------
    frequency : float
        Its frequency [Hz].
    power : float
        Its mean square, in all axes together [m2 s-4].
    contrast : float
        Half of its square over its variance, in the axis where that is largest [1].
    """

    frequency: float
    power: float
    contrast: float


def orders_below(samples: Samples, frequency: float) -> tuple[int, ...]:
    """Return the harmonic orders that the samples can resolve, at most ten."""
    return tuple(
        range(
            1,
            min(MAX_ORDERS, int(NYQUIST_SHARE * (samples.size / samples.duration) / frequency)) + 1,
        )
    )


def fundamental(samples: Samples, guess: float | None, line: float | None) -> float:
    """Return the frequency of a recorded drive, of which all strong lines are multiples [Hz].

    From the strongest line of the spectrum downwards: if what its harmonics leave over has a line
    that stands out and is a multiple of an integer fraction of the frequency, that fraction is the
    fundamental. Lines with less than a hundredth of the drive's acceleration are taken for
    something else.

    With a `guess` [Hz] it is the integer fraction of the strongest line that lies within a tenth of
    the guess; if none does, the strongest line there. A known frequency of the drive (`line`) [Hz]
    settles it likewise, if its orders hold most of the recording: the drive may run at a fraction
    of it. `samples` are the recorded accelerations.
    """
    drift_columns = legvander(samples.times / samples.half, DRIFT)
    drift_values = (
        np.linalg.lstsq(drift_columns, samples.values.T, rcond=None)[0].T @ drift_columns.T
    )
    without_drift = samples._replace(values=samples.values - drift_values)
    frequency = strongest_line(without_drift).frequency
    if guess is not None:
        near_fraction = _fraction_near(frequency, guess)
        lowest, highest = guess * (1.0 - GUESS), guess * (1.0 + GUESS)
        return near_fraction or strongest_line(without_drift, lowest, highest).frequency
    if line is not None and (near_fraction := _fraction_near(frequency, line)) is not None:
        solution = solve_least_squares(
            samples, near_fraction, orders_below(samples, near_fraction), DRIFT
        )
        residual_power = np.mean(solution.residual**2, axis=1).sum()
        if residual_power <= MAX_LEFT**2 * (np.abs(solution.waves) ** 2).sum() / 2.0:
            return solution.frequency
    solution = solve_least_squares(samples, frequency, orders_below(samples, frequency), DRIFT)
    while (lower := _at_integer_fraction(samples, solution)) is not None:
        solution = lower
    return solution.frequency


def _fraction_near(frequency: float, expected: float) -> float | None:
    fraction = frequency / max(round(frequency / expected), 1)
    return fraction if abs(fraction / expected - 1.0) <= GUESS else None


def strongest_line(samples: Samples, lowest: float = 0.0, highest: float = np.inf) -> Line:
    """Return the strongest line in the spectrum of a recording, from `lowest` to `highest` Hz.

    Frequency [Hz], strength (sum of mean squares over the axes, m2 s-4) and contrast to the noise
    around it. Drift must have been removed from the `samples`; lines with fewer than two periods in
    the recording are left out.
    """
    evenly_sampled = _without_gaps(samples)
    count, rate = evenly_sampled.size, evenly_sampled.size / evenly_sampled.duration
    size = next_fast_len(PADDING * count, real=True)
    spectrum = np.fft.rfft(evenly_sampled.values * np.hanning(count), size)
    power = (np.abs(spectrum) ** 2).sum(axis=0)
    frequencies = np.fft.rfftfreq(size, 1.0 / rate)
    lowest = max(lowest, SLOWEST / samples.duration)
    is_allowed = (frequencies >= lowest) & (frequencies <= min(highest, NYQUIST_SHARE * rate))
    peak = int(np.argmax(np.where(is_allowed, power, -1.0)))
    fit = solve_least_squares(samples, float(frequencies[peak]), (1,), 0)
    strength = np.abs(fit.waves[:, 0]) ** 2 / 2.0
    spectrum = np.fft.rfft(fit.residual) / np.sqrt(samples.size)
    bin_of_wave = np.array([fit.frequency * samples.duration])
    noise = np.diag(density_near(spectrum, float(bin_of_wave[0]), bin_of_wave, DRIFT))
    with np.errstate(divide="ignore", invalid="ignore"):
        contrast = np.nan_to_num(samples.size * strength / (2.0 * noise), posinf=np.inf)
    return Line(fit.frequency, float(strength.sum()), float(contrast.max()))


def _without_gaps(samples: Samples) -> Samples:
    # A spectrum counts samples, not time: behind a gap all phases would be off.
    steps = np.diff(samples.times)
    step = float(np.median(steps))
    if steps.max() <= (1.0 + UNEVEN) * step:
        return samples
    times = np.linspace(-samples.half, samples.half, round(2.0 * samples.half / step) + 1)
    return Samples(
        times, np.array([np.interp(times, samples.times, channel) for channel in samples.values])
    )


def stands_out(line: Line, count: int) -> bool:
    """True if a line is improbable in noise of `count` samples, anywhere in the spectrum."""
    return line.contrast > hurdle(count**2)


def _at_integer_fraction(samples: Samples, solution: Solution) -> Solution | None:
    # The strongest line may be a harmonic of the drive: the fit at the largest integer fraction of
    # its frequency of which the strongest line of the residual is a multiple, too; None if none is.
    line = strongest_line(samples._replace(values=solution.residual))
    power = (np.abs(solution.waves) ** 2).sum() / 2.0
    if not stands_out(line, samples.size) or line.power < LEAST_SHARE * power:
        return None
    ratio = line.frequency / solution.frequency
    # Three standard errors of a line's place, in bins: sqrt(6/contrast)/(2 pi) each.
    ratio_error = LEAKAGE + 3.0 * np.sqrt(6.0 / line.contrast) / (2.0 * np.pi)
    ratio_error /= solution.frequency * samples.duration
    for divisor in range(2, MAX_ORDERS + 1):
        frequency = solution.frequency / divisor
        multiple = round(divisor * ratio)
        if frequency * samples.duration < LEAST_PERIODS / 2.0 or multiple > MAX_ORDERS:
            return None
        if abs(divisor * ratio - multiple) > divisor * ratio_error:
            continue
        fit = solve_least_squares(samples, frequency, orders_below(samples, frequency), DRIFT)
        power_before = np.mean(solution.residual**2, axis=1).sum()
        if power_before - np.mean(fit.residual**2, axis=1).sum() > line.power / 2.0:
            return fit
    return None
