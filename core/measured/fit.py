"""The harmonics of a drive, fitted to measured accelerations, with their errors."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legval
from numpy.typing import NDArray

from vibrafeed.core.measured.harmonics import (
    DRIFT,
    Array,
    Noise,
    Samples,
    Solution,
    covariance_of,
    fundamental,
    hurdle,
    noise_of,
    orders_below,
    solve_least_squares,
)
from vibrafeed.core.measured.recording import STANDARD_GRAVITY, Recording, Signal, read_signal
from vibrafeed.core.measured.validity import SIZE, check_before, check_fit, check_orders
from vibrafeed.core.tables.table import InputTable

# --- A drive as a recording tells it: harmonics, their errors, and what is left over.


class Clock(NamedTuple):
    """Error of the recorder's clock: measured frequency over the true one, less 1.

    A positive error is a slow clock, which counts too few seconds; `standard_error` is how well
    the recording tells it.
    """

    error: float
    standard_error: float


class Tilt(NamedTuple):
    """The tilt of the track, from the constant of a sensor.

    Attributes
    ----------
    climb, lean : float
        Angles [rad] by which the track rises in transport direction, and to its left; NaN without a
        channel across.
    gravity : float
        Size of the constant [m s-2].
    """

    climb: float
    lean: float
    gravity: float


class StrokeEllipse(NamedTuple):
    """The ellipse of one order in the plane of along and normal; a line if `minor` is 0.

    Attributes
    ----------
    order : int
        The lowest order that the recording tells from zero.
    major, minor : float
        Semi-axes [m]: the amplitude along the line of the stroke, and across that line.
    angle : float
        Of the line to the transport direction, upwards [rad], in (-pi/2, pi/2].
    phase : float
        By which the motion normal leads the one along [rad], in [-pi, pi).
    """

    order: int
    major: float
    minor: float
    angle: float
    phase: float


class Fold(NamedTuple):
    """All samples within one period.

    Attributes
    ----------
    phase : ndarray, shape (n,)
        w t, from 0 to 2 pi [rad], in the order of the samples.
    values, residual : ndarray, shape (axes, n)
        What was recorded without constant and drift, and what is left over.
    """

    phase: Array
    values: Array
    residual: Array


@dataclass(frozen=True, eq=False)
class Fit:
    """A drive of harmonics, and what the recording tells of its errors.

    Displacement of the track along an axis: sum_k A_k sin(k w t + phi_k). Its acceleration, which
    a sensor on the track shows beside a constant and a drift, is
    -sum_k A_k (k w)^2 sin(k w t + phi_k).

    The time origin is free: it is chosen near the middle of the recording such that the phase of
    the lowest order told, order 1 unless it is absent, is 0 in the axis where it is largest.

    Attributes
    ----------
    axes : tuple of str
        Which of along, across, normal.
    orders : tuple of int
        Orders fitted.
    frequency, frequency_error : float
        Fundamental and its standard error [Hz]; the error of a given line frequency is 0.
    clock : Clock, optional
        If a line frequency is given.
    amplitudes, phases : ndarray, shape (axes, orders)
        A_k >= 0 [m] and phi_k in [-pi, pi) [rad].
    significant : ndarray of bool, shape (axes, orders)
        Which the recording tells from zero; if their number was given, all are stated.
    covariance : ndarray, shape (1 + 2 axes orders, 1 + 2 axes orders)
        Of the frequency [Hz], then A_k cos(phi_k) and A_k sin(phi_k) [m] by axis and order.
    constant : ndarray, shape (axes,)
        Mean acceleration [m s-2]: gravity, if the sensor shows it, and its offset.
    drift : ndarray, shape (axes, degree)
        Coefficients of the Legendre polynomials 1, 2, ... over the recording [m s-2].
    left_over, drifting : ndarray, shape (axes,)
        Rms of the residual and of the drift as shares of the rms of all harmonics of all axes.
    effective_samples : ndarray, shape (axes,)
        Number of samples with white noise of the residual's size that would tell as much.
    tilt : Tilt, optional
        If there are axes along and normal, and their constant has the size of gravity.
    origin : float
        Time by the recorder's clock at which t is 0, from the first sample [s].
    signal : Signal
        What was fitted.
    """

    axes: tuple[str, ...]
    orders: tuple[int, ...]
    frequency: float
    frequency_error: float
    clock: Clock | None
    amplitudes: Array
    phases: Array
    significant: NDArray[np.bool_]
    covariance: Array = field(repr=False)
    constant: Array
    drift: Array
    left_over: Array
    drifting: Array
    effective_samples: Array
    tilt: Tilt | None
    origin: float
    signal: Signal = field(repr=False)

    @property
    def samples(self) -> int:
        """The number of samples."""
        return self.signal.times.size

    @property
    def recorded_frequency(self) -> float:
        """The fundamental frequency by the recorder's clock [Hz]."""
        return self.frequency * (1.0 + (self.clock.error if self.clock else 0.0))

    @property
    def periods(self) -> float:
        """The number of recorded periods."""
        return self.recorded_frequency * float(np.ptp(self.signal.times))

    @property
    def amplitude_errors(self) -> Array:
        """The standard errors of the amplitudes [m], shape (axes, orders)."""
        return np.sqrt(self._variance_along(0))

    @property
    def phase_errors(self) -> Array:
        """The standard errors of the phases [rad], shape (axes, orders).

        Infinite without amplitude.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            errors = np.sqrt(self._variance_along(1)) / self.amplitudes
        return np.where(self.amplitudes > 0.0, errors, np.inf)

    def _variance_along(self, part: int) -> Array:
        # Variance of each displacement along its phase (part 0), which is that of the amplitude, or
        # at a right angle to it (part 1).
        blocks = self.covariance[1:, 1:].reshape(*self.phases.shape, 2, *self.phases.shape, 2)
        own_blocks = np.einsum("jkajkb->jkab", blocks)
        cosine, sine = np.cos(self.phases), np.sin(self.phases)
        directions = np.stack([cosine, sine] if part == 0 else [-sine, cosine], axis=-1)
        return np.maximum(np.einsum("jka,jkab,jkb->jk", directions, own_blocks, directions), 0.0)

    @property
    def rest(self) -> Array:
        """The rms of what the fit does not explain, shape (axes,), in the unit of the values."""
        waves = self.amplitudes * (2.0 * np.pi * self.frequency * np.array(self.orders)) ** (
            self.signal.derivative
        )
        return np.asarray(self.left_over * np.sqrt((waves**2).sum() / 2.0))

    @property
    def stroke(self) -> StrokeEllipse | None:
        """The line of the stroke and its angle; None unless there are axes along and normal.

        With complex amplitudes a along and n normal, and D^2 = (|a|^2 - |n|^2)^2 + 4 Re(a n*)^2,
        the larger semi-axis squared is (|a|^2 + |n|^2 + D)/2, the product of both |Im(a n*)|, and
        twice the angle has the tangent 2 Re(a n*)/(|a|^2 - |n|^2): the Stokes parameters of Born
        and Wolf, Principles of Optics, section 1.4.2.
        """
        if not {"along", "normal"} <= set(self.axes):
            return None
        axis_rows = [self.axes.index(axis) for axis in ("along", "normal")]
        lowest = int(np.flatnonzero(self.significant[axis_rows].any(axis=0))[:1].sum())
        waves = np.where(self.significant, self.amplitudes * np.exp(1j * self.phases), 0.0)
        along, normal = waves[axis_rows, lowest]
        cross = complex(along * np.conj(normal))
        sizes = abs(along) ** 2, abs(normal) ** 2
        d = float(np.hypot(sizes[0] - sizes[1], 2.0 * cross.real))
        major = float(np.sqrt((sum(sizes) + d) / 2.0))
        minor = abs(cross.imag) / major if major else 0.0
        return StrokeEllipse(
            self.orders[lowest],
            major,
            minor,
            float(np.arctan2(2.0 * cross.real, sizes[0] - sizes[1]) / 2.0),
            float(wrap_angle(-np.angle(cross))),
        )

    def parameters(self) -> dict[str, float]:
        """Return the fitted drive as study parameters: SI units, phases in degrees."""
        return self._named(self.frequency, self.amplitudes * np.exp(1j * self.phases))

    def draw(self, rng: np.random.Generator, count: int) -> list[dict[str, float]]:
        """Return `count` random drives that are consistent with the recording, for error estimates.

        They are normally distributed about the fit with its covariance; each is a mapping of a
        study's parameters, such as `frequency` and `amplitude_along_1`. `rng` makes the random
        numbers.
        """
        displacement = self.amplitudes * np.exp(1j * self.phases)
        components = np.stack([displacement.real, displacement.imag], axis=-1)
        # Scaled, since frequency and displacements differ by many powers of ten; square_root times
        # its transpose is the covariance.
        scale = np.sqrt(np.maximum(np.diag(self.covariance), np.finfo(float).tiny))
        values, vectors = np.linalg.eigh(self.covariance / np.outer(scale, scale))
        square_root = scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))
        sampled = rng.standard_normal((count, scale.size)) @ square_root.T
        sampled += np.concatenate([[self.frequency], components.ravel()])
        return [
            self._named(
                float(frequency), sampled_components[..., 0] + 1j * sampled_components[..., 1]
            )
            for frequency, sampled_components in zip(
                sampled[:, 0], sampled[:, 1:].reshape(count, *components.shape), strict=True
            )
        ]

    def _named(self, frequency: float, displacement: NDArray[np.complex128]) -> dict[str, float]:
        # Parameters of a study: amplitude [m] and phase [degree] of each significant harmonic.
        named = {"frequency": frequency}
        for axis, row, significant_row in zip(
            self.axes, displacement, self.significant, strict=True
        ):
            for order, wave, is_significant in zip(self.orders, row, significant_row, strict=True):
                if is_significant:
                    named[f"amplitude_{axis}_{order}"] = float(np.abs(wave))
                    named[f"phase_{axis}_{order}"] = float(
                        np.degrees(wrap_angle(float(np.angle(wave))))
                    )
        return named

    def model(self, times: Array) -> Array:
        """Return the fit at times of the recording, shape (axes, n), in the kind of its values.

        Harmonics, constant and drift, to compare with what was recorded; `times` are by the
        recorder's clock [s].
        """
        first, last = self.signal.times[[0, -1]]
        scaled_time = 2.0 * (np.asarray(times) - first) / (last - first) - 1.0
        return np.asarray(
            legval(scaled_time, np.hstack([self.constant[:, None], self.drift]).T)
        ) + self.periodic(self._phase(times))

    def periodic(self, phase: Array) -> Array:
        """Return the fitted harmonics at phases w t, shape (axes, n), in the kind of the values.

        Without constant and drift: accelerations [m s-2], as a rule; `phase` is w t [rad], shape
        (n,), w the fundamental.
        """
        orders = np.array(self.orders)
        order = self.signal.derivative
        peaks = self.amplitudes * (2.0 * np.pi * self.frequency * orders) ** order
        angles = orders[:, None] * phase + self.phases[..., None] + order * np.pi / 2.0
        return np.einsum("jk,jkn->jn", peaks, np.sin(angles))

    def displacement(self, phase: Array) -> Array:
        """Return the displacements of the track at phases w t [rad], shape (axes, n) [m]."""
        angles = np.array(self.orders)[:, None] * phase + self.phases[..., None]
        return np.einsum("jk,jkn->jn", self.amplitudes, np.sin(angles))

    def fold(self) -> Fold:
        """Return all samples folded into one period, without constant and drift."""
        phase = np.mod(self._phase(self.signal.times), 2.0 * np.pi)
        residual = self.signal.values - self.model(self.signal.times)
        return Fold(phase, self.periodic(phase) + residual, residual)

    def _phase(self, times: Array) -> Array:
        return (
            2.0
            * np.pi
            * self.recorded_frequency
            * (np.asarray(times) - self.signal.times[0] - self.origin)
        )


def wrap_angle(angle: float | Array) -> Array:
    """Return an angle reduced to [-pi, pi)."""
    return np.mod(np.asarray(angle) + np.pi, 2.0 * np.pi) - np.pi


def fit_drive(source: str | Path | InputTable, recording: Recording) -> Fit:
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
    samples = Samples(signal.times - (signal.times[0] + signal.times[-1]) / 2.0, signal.values)
    start_frequency = fundamental(samples, signal.frequency, signal.line_frequency)
    check_orders(signal, samples, start_frequency)
    orders = orders_below(samples, start_frequency)[: signal.harmonics]
    solution, noise = _solve_weighted(samples, start_frequency, orders, DRIFT, signal.resolution)
    significant, degree = _significant(samples, solution, noise)
    if signal.harmonics is None:
        orders = tuple(np.array(orders)[significant.any(axis=0)].tolist()) or (1,)
    solution, noise = _solve_weighted(
        samples, solution.frequency, orders, degree, signal.resolution
    )
    significant, _ = _significant(samples, solution, noise)
    check_fit(signal, samples, solution, noise, bool(significant.any()))
    fit = _reported_fit(signal, samples, solution, noise, significant)
    return fit if signal.harmonics is None else replace(fit, significant=np.ones_like(significant))


def _solve_weighted(
    samples: Samples, start: float, orders: tuple[int, ...], degree: int, resolution: Array
) -> tuple[Solution, Noise]:
    # The residual of a fit with equal weights gives the weights of the final one.
    unweighted = solve_least_squares(samples, start, orders, degree)
    weights = noise_of(samples, unweighted, resolution).weights
    solution = solve_least_squares(samples, unweighted.frequency, orders, degree, weights)
    # With the weights of this fit, for its errors, not those that its residual would give.
    return solution, noise_of(samples, solution, resolution)._replace(weights=weights)


def _significant(
    samples: Samples, solution: Solution, noise: Noise
) -> tuple[NDArray[np.bool_], int]:
    # Which harmonics of each axis are significant, and the highest significant degree of the drift.
    covariance = covariance_of(samples, solution, noise)
    axes, unknowns = solution.coefficients.shape
    first_wave, threshold = solution.degree + 1, hurdle(samples.size)
    by_axis = np.einsum("jajb->jab", covariance[1:, 1:].reshape(axes, unknowns, axes, unknowns))
    wave_covariances = by_axis[:, first_wave:, first_wave:].reshape(
        axes, len(solution.orders), 2, len(solution.orders), 2
    )
    waves = np.stack([solution.waves.real, solution.waves.imag], axis=-1)
    inverse = np.linalg.pinv(np.einsum("jkakb->jkab", wave_covariances), hermitian=True)
    # Wald's statistic w' C^-1 w of both parts of a wave, against the threshold of two coefficients.
    significant = np.einsum("jka,jkab,jkb->jk", waves, inverse, waves) > 2.0 * threshold
    variance = np.diagonal(by_axis, axis1=1, axis2=2)[:, :first_wave]
    degree = int(
        np.flatnonzero((solution.drift**2 > threshold * variance).any(axis=0)).max(initial=0)
    )
    return significant, degree


def _reported_fit(
    signal: Signal,
    samples: Samples,
    solution: Solution,
    noise: Noise,
    significant: NDArray[np.bool_],
) -> Fit:
    covariance = covariance_of(samples, solution, noise)
    frequency_error = float(np.sqrt(covariance[0, 0]))
    known_frequency = signal.line_frequency
    frequency = solution.frequency if known_frequency is None else known_frequency
    orders = np.array(solution.orders)
    wave_sizes = np.abs(solution.waves)
    lowest = int(np.flatnonzero(significant.any(axis=0))[0])
    largest = int(wave_sizes[:, lowest].argmax())
    # c/(i k w)^d is the displacement; turned by k turn, that of the reference has phase 0.
    displacement = solution.waves / (2.0j * np.pi * frequency * orders) ** signal.derivative
    turn = -float(np.angle(displacement[largest, lowest])) / solution.orders[lowest]
    displacement = displacement * np.exp(1j * orders * turn)
    displacement[largest, lowest] = np.abs(displacement[largest, lowest])
    rms = np.sqrt((wave_sizes**2).sum() / 2.0)
    drift = solution.drift[:, 1:]
    drift_squares = (drift**2 / (2.0 * np.arange(1, solution.degree + 1) + 1.0)).sum(axis=1)
    return Fit(
        axes=signal.axes,
        orders=solution.orders,
        frequency=frequency,
        frequency_error=frequency_error if known_frequency is None else 0.0,
        clock=None
        if known_frequency is None
        else Clock(solution.frequency / known_frequency - 1.0, frequency_error / known_frequency),
        amplitudes=np.abs(displacement),
        phases=wrap_angle(np.angle(displacement)),
        significant=significant,
        covariance=_covariance_of_displacements(
            covariance,
            solution,
            displacement,
            turn,
            (largest, lowest),
            known_frequency,
            signal.derivative,
        ),
        constant=solution.drift[:, 0],
        drift=drift,
        left_over=np.sqrt(np.mean(solution.residual**2, axis=1)) / rms,
        drifting=np.sqrt(drift_squares) / rms,
        effective_samples=samples.size
        * np.minimum(1.0 / (noise.weights * noise.densities[1 + lowest].diagonal()), 1.0),
        tilt=_tilt_of(signal.axes, solution.drift[:, 0]) if signal.derivative == 2 else None,
        origin=samples.half + turn / (2.0 * np.pi * solution.frequency),
        signal=signal,
    )


def _tilt_of(axes: tuple[str, ...], constant: NDArray[np.float64]) -> Tilt | None:
    # The mean acceleration of a sensor at rest is gravity, if its size is near 1 g.
    mean_of_axis = dict(zip(axes, constant.tolist(), strict=True))
    magnitude = float(np.linalg.norm(constant))
    if (
        not {"along", "normal"} <= mean_of_axis.keys()
        or abs(magnitude / STANDARD_GRAVITY - 1.0) > SIZE
    ):
        return None
    climb, lean = (
        float(np.arctan2(mean_of_axis.get(axis, np.nan), mean_of_axis["normal"]))
        for axis in ("along", "across")
    )
    return Tilt(climb, lean, magnitude)


def _covariance_of_displacements(
    covariance: Array,
    solution: Solution,
    displacement: NDArray[np.complex128],
    theta: float,
    reference: tuple[int, int],
    known_frequency: float | None,
    derivative: int,
) -> Array:
    """Return the covariance of frequency [Hz] and displacements [m] of a fit.

    Shape (1 + 2 axes orders,) twice: the frequency, then real and imaginary part of each
    displacement by axis and order. The complex displacement of order k is z = c exp(i k theta)/(i k
    w)^d, with the recorded wave c, its `derivative` d, and the turn of the time origin theta by the
    harmonic `reference` (axis, order): dz = dc exp(i k theta)/(i k w)^d - i k z
    Im(dc_ref/c_ref)/k_ref - d z df/f.

    `covariance` is that of frequency and waves; `known_frequency` [Hz] has no error, or is None.
    """
    axes, unknowns = solution.coefficients.shape
    first_wave = solution.degree + 1
    orders, waves = np.array(solution.orders), solution.waves
    wave_columns = 1 + np.arange(axes)[:, None] * unknowns + first_wave + 2 * np.arange(orders.size)
    frequency = solution.frequency if known_frequency is None else known_frequency
    derivatives = np.zeros((*waves.shape, len(covariance)), dtype=np.complex128)
    scale = np.exp(1j * orders * theta) / (2.0j * np.pi * frequency * orders) ** derivative
    for axis in range(axes):
        for position in range(orders.size):
            columns = wave_columns[axis, position]
            derivatives[axis, position, columns : columns + 2] = (
                scale[position],
                1j * scale[position],
            )
    if known_frequency is None:
        derivatives[..., 0] = -derivative * displacement / frequency
    columns = wave_columns[reference]
    phase_derivative = np.array([1.0, 1j]) / waves[reference]
    order_ratios = orders / orders[reference[1]]
    derivatives[..., columns : columns + 2] -= (
        1j * (displacement * order_ratios)[..., None] * phase_derivative.imag
    )
    derivatives[reference] = derivatives[reference].real  # its phase is 0 by choice, without error
    jacobian = np.zeros((1 + 2 * waves.size, len(covariance)))
    jacobian[0, 0] = 1.0 if known_frequency is None else 0.0
    jacobian[1::2] = derivatives.real.reshape(waves.size, -1)
    jacobian[2::2] = derivatives.imag.reshape(waves.size, -1)
    return jacobian @ covariance @ jacobian.T
