"""The frequency with which a recording repeats itself, wherever its strongest line stands."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legvander
from scipy.fft import next_fast_len

from vibrafeed.core.measured.harmonics import Array, Samples, Solution, solve_least_squares
from vibrafeed.core.measured.noise import density_near, hurdle
from vibrafeed.core.measured.recording import MAX_ORDERS
from vibrafeed.core.measured.times import UNEVEN

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
    rate = samples.size / samples.duration
    return tuple(range(1, min(MAX_ORDERS, int(NYQUIST_SHARE * rate / frequency)) + 1))


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
    start = samples._replace(values=_without_drift(samples))
    frequency = strongest_line(start).frequency
    if guess is not None:
        near = _part_near(frequency, guess)
        lowest, highest = guess * (1.0 - GUESS), guess * (1.0 + GUESS)
        return near or strongest_line(start, lowest, highest).frequency
    if line is not None and (near := _part_near(frequency, line)) is not None:
        solution = solve_least_squares(samples, near, orders_below(samples, near), DRIFT)
        left = np.mean(solution.residual**2, axis=1).sum()
        if left <= MAX_LEFT**2 * (np.abs(solution.waves) ** 2).sum() / 2.0:
            return solution.frequency
    solution = solve_least_squares(samples, frequency, orders_below(samples, frequency), DRIFT)
    while (lower := _lower(samples, solution)) is not None:
        solution = lower
    return solution.frequency


def _part_near(frequency: float, expected: float) -> float | None:
    """Return the integer fraction of a frequency that is within a tenth of an expected one.

    None if there is none; both in Hz.
    """
    part = frequency / max(round(frequency / expected), 1)
    return part if abs(part / expected - 1.0) <= GUESS else None


def strongest_line(samples: Samples, lowest: float = 0.0, highest: float = np.inf) -> Line:
    """Return the strongest line in the spectrum of a recording, from `lowest` to `highest` Hz.

    Frequency [Hz], strength (sum of mean squares over the axes, m2 s-4) and contrast to the noise
    around it. Drift must have been removed from the `samples`; lines with fewer than two periods in
    the recording are left out.
    """
    even = _without_gaps(samples)
    count, rate = even.size, even.size / even.duration
    size = next_fast_len(PADDING * count, real=True)
    spectrum = np.fft.rfft(even.values * np.hanning(count), size)
    power = (np.abs(spectrum) ** 2).sum(axis=0)
    places = np.fft.rfftfreq(size, 1.0 / rate)
    lowest = max(lowest, SLOWEST / samples.duration)
    allowed = (places >= lowest) & (places <= min(highest, NYQUIST_SHARE * rate))
    peak = int(np.argmax(np.where(allowed, power, -1.0)))
    wave = solve_least_squares(samples, float(places[peak]), (1,), 0)
    strength = np.abs(wave.waves[:, 0]) ** 2 / 2.0
    spectrum = np.fft.rfft(wave.residual) / np.sqrt(samples.size)
    place = np.array([wave.frequency * samples.duration])
    noise = np.diag(density_near(spectrum, float(place[0]), place, DRIFT))
    with np.errstate(divide="ignore", invalid="ignore"):
        contrast = np.nan_to_num(samples.size * strength / (2.0 * noise), posinf=np.inf)
    return Line(wave.frequency, float(strength.sum()), float(contrast.max()))


def _without_gaps(samples: Samples) -> Samples:
    """Return samples at even times, straight lines where some were lost; as they are without gaps.

    A spectrum counts samples, not time: behind a gap all phases would be off.
    """
    steps = np.diff(samples.times)
    step = float(np.median(steps))
    if steps.max() <= (1.0 + UNEVEN) * step:
        return samples
    times = np.linspace(-samples.half, samples.half, round(2.0 * samples.half / step) + 1)
    return Samples(times, np.array([np.interp(times, samples.times, v) for v in samples.values]))


def stands_out(line: Line, count: int) -> bool:
    """True if a line is improbable in noise of `count` samples, anywhere in the spectrum."""
    return line.contrast > hurdle(count**2)


def _lower(samples: Samples, solution: Solution) -> Solution | None:
    """Return a fit at an integer fraction of the frequency, if that explains more of a recording.

    The strongest line of a recording may be a harmonic of the drive. If a line stands out in the
    residual of `solution`, fractions 1/2, 1/3, ... of its frequency are tried of which both are
    harmonics; the first that takes more than half of the line's power is returned. None if nothing
    stands out, or no fraction explains it. `samples` are the recording.
    """
    left = samples._replace(values=solution.residual)
    line = strongest_line(left)
    power = (np.abs(solution.waves) ** 2).sum() / 2.0
    if not stands_out(line, samples.size) or line.power < LEAST_SHARE * power:
        return None
    ratio = line.frequency / solution.frequency
    # Three standard errors of a line's place, in bins: sqrt(6/contrast)/(2 pi) each.
    error = LEAKAGE + 3.0 * np.sqrt(6.0 / line.contrast) / (2.0 * np.pi)
    error /= solution.frequency * samples.duration
    for part in range(2, MAX_ORDERS + 1):
        frequency = solution.frequency / part
        whole = round(part * ratio)
        if frequency * samples.duration < LEAST_PERIODS / 2.0 or whole > MAX_ORDERS:
            return None
        if abs(part * ratio - whole) > part * error:
            continue
        lower = solve_least_squares(samples, frequency, orders_below(samples, frequency), DRIFT)
        gained = (
            np.mean(solution.residual**2, axis=1).sum() - np.mean(lower.residual**2, axis=1).sum()
        )
        if gained > line.power / 2.0:
            return lower
    return None


def _without_drift(samples: Samples) -> Array:
    """Return the samples without their drift."""
    drift = legvander(samples.times / samples.half, DRIFT)
    return samples.values - np.linalg.lstsq(drift, samples.values.T, rcond=None)[0].T @ drift.T
