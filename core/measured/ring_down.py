"""The free vibration of a struck feeder: natural frequency and damping ratio, with their errors."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from vibrafeed.core.errors import StudyError, refused
from vibrafeed.core.measured.harmonics import Array, density_near
from vibrafeed.core.measured.recording import Recording, Signal, read_signal
from vibrafeed.core.measured.times import LEAST_SAMPLES
from vibrafeed.core.measured.validity import check_before
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.units import UnitError, problem, read_number
from vibrafeed.core.tables.table import InputTable

MAX_MODES = 4  # of a feeder that rocks and bends beside its stroke
LEAST_PERIODS = 5.0  # of the ring-down
KNOCK = 0.25  # periods after the largest sample, within which the knock ends
LONGEST = 5_000  # samples: what comes later is rest
MAX_LEFT = 0.3  # rms of the residual over that of the recording, above which it is no ring-down
STANDS_OUT = 0.02  # share of the amplitude of the strongest mode that makes another one
DAMPING_RATIOS = (0.002, 0.006, 0.02, 0.06, 0.15)  # that are tried at the start
FAR = 7.0
LEAST_DAMPING, MOST_DAMPING = 1e-5, 0.5  # that are looked for
APART = 0.2  # share by which a frequency may differ from the line of the spectrum
DECAYED = 4.0  # time constants after which a mode is rest


@dataclass(frozen=True)
class RingDown:
    """A free vibration, fitted to the recording of a struck feeder.

    Attributes
    ----------
    natural_frequency, natural_frequency_error : float
        Of the strongest mode, undamped, and its standard error [Hz].
    damping_ratio, damping_ratio_error : float
        Of that mode, and its standard error.
    other_frequencies : tuple of float
        Natural frequencies of other modes that the recording shows [Hz].
    start : float
        Time by the recorder's clock at which the fit begins, from the first sample [s].
    samples : int
        Number of samples that are fitted.
    left_over : float
        Rms of the residual, as a share of that of the samples.
    """

    natural_frequency: float
    natural_frequency_error: float
    damping_ratio: float
    damping_ratio_error: float
    other_frequencies: tuple[float, ...]
    start: float
    samples: int
    left_over: float

    def parameters(self) -> dict[str, float]:
        """Return the parameters of a drive unit that the ring-down gives."""
        return {
            "ring_down_frequency": self.natural_frequency,
            "damping_ratio": self.damping_ratio,
        }


def fit_ring_down(source: str | Path | InputTable, recording: Recording) -> RingDown:
    """Return the free vibration in a recording that begins at rest or with the knock.

    Each channel is a constant and the sum of A exp(-zeta w t) cos(w sqrt(1 - zeta^2) t + phi) of
    its modes, w the natural angular frequency, zeta the damping ratio, which all channels share;
    they follow by least squares, amplitudes and phases by variable projection. The fit begins a
    quarter of a period after the largest sample. Errors take the residual's spectral density near
    the mode.

    Raises
    ------
    StudyError
        If the recording cannot be read, is too short, or does not decay as a struck feeder does.
    """
    signal = read_signal(source, recording)
    check_before(signal)
    return _fit(signal)


def moving_mass(empty: RingDown, loaded: RingDown, added_mass: float | str) -> tuple[float, float]:
    """Return the moving mass of a feeder and its standard error [kg], from an added mass.

    A bare number is in kg.

    m = m_a/((f_0/f_1)^2 - 1), f_0 empty, f_1 with the added mass. Raises `StudyError` if the added
    mass does not lower the frequency by more than five of its errors.
    """
    frequency_empty, frequency_loaded = empty.natural_frequency, loaded.natural_frequency
    error = float(np.hypot(empty.natural_frequency_error, loaded.natural_frequency_error))
    if frequency_empty - frequency_loaded < 5.0 * error or frequency_loaded >= frequency_empty:
        raise refused(
            "added_mass",
            f"with the added mass the feeder rings at {frequency_loaded:.5g} Hz, without it at "
            f"{frequency_empty:.5g} Hz",
            "Give the recording without the mass first, or add more",
        )
    try:
        added_kilograms = read_number("added_mass", QUANTITIES["moving_mass"], added_mass)
    except UnitError as error:
        raise StudyError([problem("added_mass", error)]) from None
    ratio = (frequency_empty / frequency_loaded) ** 2
    mass = added_kilograms / (ratio - 1.0)
    relative = np.hypot(
        empty.natural_frequency_error / frequency_empty,
        loaded.natural_frequency_error / frequency_loaded,
    )
    return mass, float(mass * 2.0 * ratio / (ratio - 1.0) * relative)


def _fit(signal: Signal) -> RingDown:
    values = signal.values - np.median(signal.values, axis=1, keepdims=True)
    # The free vibration begins after the largest sample, which is the knock.
    knock = int((values**2).sum(axis=0).argmax())
    times, values = signal.times[knock:], signal.values[:, knock:]
    if times.size < LEAST_SAMPLES:
        raise refused(
            "recording",
            f"{times.size} samples follow the knock, which is too few",
            f"Record at least {LEAST_SAMPLES} samples after the knock",
        )
    frequency = _strongest_line(times, values)[0]
    start = int(np.searchsorted(times, times[0] + KNOCK / frequency))
    times, values = times[start : start + LONGEST], values[:, start : start + LONGEST]
    poles, residual = _fitted_poles(times, values)
    strongest = int(_mode_sizes(times, values, poles).argmax())
    decayed = int(np.searchsorted(times, times[0] + DECAYED / max(-poles[strongest].real, 1e-9)))
    left_over = float(
        np.sqrt(np.mean(residual[:, :decayed] ** 2) / np.mean(_centred(values)[:, :decayed] ** 2))
    )
    pole = poles[strongest]
    natural, ratio = abs(pole) / (2.0 * np.pi), -pole.real / abs(pole)
    _check_decay(times, natural, float(ratio), left_over)
    covariance = _covariance(times, values, poles, residual)[2 * strongest : 2 * strongest + 2][
        :, 2 * strongest : 2 * strongest + 2
    ]
    # f = |s|/(2 pi) and zeta = -Re(s)/|s| of a pole s, differentiated by Re(s) and Im(s).
    natural_gradient = np.array([pole.real, pole.imag]) / (2.0 * np.pi * abs(pole))
    ratio_gradient = np.array([-(pole.imag**2), pole.real * pole.imag]) / abs(pole) ** 3
    return RingDown(
        natural_frequency=float(natural),
        natural_frequency_error=float(np.sqrt(natural_gradient @ covariance @ natural_gradient)),
        damping_ratio=float(ratio),
        damping_ratio_error=float(np.sqrt(ratio_gradient @ covariance @ ratio_gradient)),
        other_frequencies=tuple(
            float(abs(other_pole) / (2.0 * np.pi))
            for number, other_pole in enumerate(poles)
            if number != strongest
        ),
        start=float(times[0] - signal.times[0]),
        samples=times.size,
        left_over=left_over,
    )


def _fitted_poles(times: Array, values: Array) -> tuple[NDArray[np.complex128], Array]:
    # The poles of the modes, one by one from the strongest, and the residual of the fit.
    frequency, strongest = _strongest_line(times, values)
    poles = _best_start(times, values, frequency)
    # Further modes show as lines of the residual that noise would not have.
    for _ in range(MAX_MODES):
        poles, residual = _refined_poles(times, values, poles)
        next_frequency, power = _strongest_line(times, residual)
        # The power that a line of noise exceeds once in a thousand spectra.
        noise = (residual**2).sum() * (np.log(times.size) + FAR)
        is_weak = power < max(STANDS_OUT**2 * strongest, noise)
        if is_weak or len(poles) == MAX_MODES:
            break
        poles = np.concatenate([poles, _best_start(times, residual, next_frequency)])
    return _refined_poles(times, values, poles)  # with the weights of the residual


def _check_decay(times: Array, natural: float, ratio: float, left_over: float) -> None:
    periods = natural * float(np.ptp(times))
    if periods < LEAST_PERIODS:
        raise refused(
            "recording",
            f"the ring-down is only {periods:.2g} periods of {natural:.4g} Hz long",
            f"Record at least {LEAST_PERIODS:g} periods after the knock",
        )
    if left_over > MAX_LEFT or ratio <= 0.0:
        raise refused(
            "recording",
            f"the recording does not decay as a struck feeder does: {100 * left_over:.0f} % of it "
            f"is not explained by a free vibration at {natural:.4g} Hz",
            "Record a single knock on the feeder with the drive off, or cut out one",
        )


def _centred(values: Array) -> Array:
    return values - values.mean(axis=1, keepdims=True)


def _strongest_line(times: Array, values: Array) -> tuple[float, float]:
    # Frequency and power of the strongest line; a decaying signal needs no window.
    even_times = np.linspace(times[0], times[-1], times.size)
    resampled = np.array([np.interp(even_times, times, channel) for channel in _centred(values)])
    step = float(even_times[1] - even_times[0])
    power = (np.abs(np.fft.rfft(resampled, 4 * times.size)) ** 2).sum(axis=0)
    frequencies = np.fft.rfftfreq(4 * times.size, step)
    power[frequencies < 2.0 / np.ptp(times)] = 0.0
    strongest = int(power.argmax())
    return float(frequencies[strongest]), float(power[strongest])


def _columns(times: Array, poles: NDArray[np.complex128]) -> Array:
    waves = np.exp(np.outer(times - times[0], poles))
    parts = np.stack([waves.real, waves.imag], axis=-1).reshape(times.size, -1)
    return np.hstack([np.ones((times.size, 1)), parts])


def _residual(times: Array, values: Array, poles: NDArray[np.complex128]) -> Array:
    basis = np.linalg.qr(_columns(times, poles))[0]
    return np.asarray(values - (values @ basis) @ basis.T)


def _mode_sizes(times: Array, values: Array, poles: NDArray[np.complex128]) -> Array:
    coefficients = np.linalg.lstsq(_columns(times, poles), values.T, rcond=None)[0][1:]
    # The energy of a decaying wave: its square over the rate of its decay.
    return np.sqrt((coefficients.reshape(len(poles), -1) ** 2).sum(axis=1) / -poles.real)


def _best_start(times: Array, values: Array, frequency: float) -> NDArray[np.complex128]:
    angular_frequency = 2.0 * np.pi * frequency
    candidates = [np.array([angular_frequency * complex(-ratio, 1.0)]) for ratio in DAMPING_RATIOS]
    return min(candidates, key=lambda poles: float((_residual(times, values, poles) ** 2).sum()))


def _refined_poles(
    times: Array, values: Array, poles: NDArray[np.complex128]
) -> tuple[NDArray[np.complex128], Array]:
    # Least squares over damping ratios and frequencies; channels are weighted by their noise.
    noise = np.sqrt(np.mean(_residual(times, values, poles) ** 2, axis=1, keepdims=True))
    root_weights = np.median(noise) / np.maximum(noise, np.finfo(float).tiny)
    frequencies = np.abs(poles)

    def residual(parameters: Array) -> Array:
        return np.asarray(
            root_weights * _residual(times, values, _poles(parameters, frequencies))
        ).ravel()

    ratios = np.clip(-poles.real / frequencies, 2.0 * LEAST_DAMPING, 0.5 * MOST_DAMPING)
    start = np.stack([ratios, np.ones(len(poles))], axis=1).ravel()
    bounds = [LEAST_DAMPING, 1.0 - APART] * len(poles), [MOST_DAMPING, 1.0 + APART] * len(poles)
    optimum = least_squares(residual, start, bounds=bounds, x_scale="jac", xtol=1e-10, ftol=1e-10)
    poles = _poles(optimum.x, frequencies)
    return poles, _residual(times, values, poles)


def _poles(parts: Array, turns: Array) -> NDArray[np.complex128]:
    ratios, frequencies = parts[0::2], parts[1::2]
    return np.asarray(turns * frequencies * (-ratios + 1j * np.sqrt(1.0 - ratios**2)))


def _covariance(
    times: Array, values: Array, poles: NDArray[np.complex128], residual: Array
) -> Array:
    # Of real and imaginary part of each pole: (sum_j J_j' J_j/S_j)^-1, J_j the derivatives of the
    # model without what its amplitudes can imitate, S_j the spectral density of the residual of
    # channel j near the strongest mode.
    columns = _columns(times, poles)
    basis = np.linalg.qr(columns)[0]
    coefficients = np.linalg.lstsq(columns, values.T, rcond=None)[0][1:]
    elapsed = (times - times[0])[:, None]
    strongest = int(_mode_sizes(times, values, poles).argmax())
    duration = float(np.ptp(times)) * times.size / (times.size - 1)
    spectrum = np.fft.rfft(residual) / np.sqrt(times.size)
    line_bins = np.abs(poles.imag) / (2.0 * np.pi) * duration
    density = np.diag(density_near(spectrum, float(line_bins[strongest]), line_bins, 0))
    noise = np.maximum(density, np.mean(residual**2, axis=1))
    information = np.zeros((2 * len(poles),) * 2)
    for channel, variance in zip(coefficients.T, noise, strict=True):
        pairs = channel.reshape(-1, 2)
        waves = columns[:, 1:].reshape(times.size, -1, 2)
        # d/ds of a Re(e) + b Im(e), e = exp((s + i w) t), is t times it; d/dw turns it.
        real_slope = elapsed * (waves * pairs).sum(axis=2)
        imaginary_slope = elapsed * (waves[..., 0] * pairs[:, 1] - waves[..., 1] * pairs[:, 0])
        slopes = np.stack([real_slope, imaginary_slope], axis=2).reshape(times.size, -1)
        slopes -= basis @ (basis.T @ slopes)
        information += slopes.T @ slopes / max(float(variance), float(np.finfo(float).tiny))
    scale = 1.0 / np.sqrt(np.diag(information))
    return np.asarray(np.linalg.inv(information * np.outer(scale, scale)) * np.outer(scale, scale))
