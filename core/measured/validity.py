"""Checks of a recording before a drive is fitted: long and fast enough, periodic, steady."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.measured.fundamental import (
    LEAST_PERIODS,
    MAX_LEFT,
    NYQUIST_SHARE,
    orders_below,
    stands_out,
    strongest_line,
)
from vibrafeed.core.measured.gravity import gravity_problems
from vibrafeed.core.measured.harmonics import Samples, Solution, solve_least_squares
from vibrafeed.core.measured.noise import Noise
from vibrafeed.core.measured.recording import FREQUENCY, LEAST_SAMPLES, Signal
from vibrafeed.core.study.unusual import likely_unit_of_times

STEPS = 1e-9, 1e3
"""Shortest and longest time from one sample to the next [s]: others are a wrong rate or unit."""
ACCELERATIONS = 1e-9, 1e9
"""Least and largest range of the values of a recording [m s-2]: their squares are floats."""
MAX_CHANGE = 0.05
"""Largest change from the first third of a recording to the last, over the drive's rms."""
CHANGE_ERRORS = 4.0  # standard errors that the change must exceed as well
MAX_CLOCK = 0.05  # largest error of a recorder's clock, as a share
TWICE = 0.1  # a ratio so near to a whole number means another multiple of the frequency


def check_before(signal: Signal) -> None:
    """Raise `StudyError` if a recording cannot be fitted, with all reasons.

    `signal` holds times, accelerations and the frequencies that the study gives.

    Raises
    ------
    StudyError
        If a value is not finite, samples are too few, all channels are constant, or a frequency is
        too low or too high for the recording.
    """
    problems = []
    count = signal.times.size
    if not (np.isfinite(signal.accelerations).all() and np.isfinite(signal.times).all()):
        problems.append(
            Problem(
                "recording",
                "the recording holds values that are not finite numbers",
                "Remove these values from the recording",
            )
        )
    if count < LEAST_SAMPLES:
        fix = f"Record {LEAST_SAMPLES} at least, over {LEAST_PERIODS} periods or more"
        raise StudyError([*problems, Problem("recording", f"it has {count} samples", fix)])
    problems += _out_of_range(signal)
    if not np.ptp(signal.accelerations, axis=1).any():
        fix = "Check that the sensor was connected"
        problems.append(
            Problem(
                "recording",
                "all channels of the recording are constant: the sensor recorded no motion",
                fix,
            )
        )
    duration = float(np.ptp(signal.times)) * count / (count - 1)
    lowest, highest = LEAST_PERIODS / duration, NYQUIST_SHARE * count / duration
    for key in ("frequency", "line_frequency"):
        asked = getattr(signal, key)
        if asked is None:
            continue
        if asked < lowest:
            problems.append(_too_short(key, asked, duration))
        elif asked > highest:
            problems.append(
                Problem(
                    key,
                    f"the recording has {count / duration:,.4g} samples per second, which "
                    f"cannot resolve {asked:g} Hz",
                    f"Record at least {asked / NYQUIST_SHARE:,.4g} samples per second"
                    + (f", or write the unit in the heading, as in '{signal.assumed} [ms]'")
                    * bool(signal.assumed),
                )
            )
    if problems:
        raise StudyError(problems)


def _out_of_range(signal: Signal) -> list[Problem]:
    """Return the problems of a recording whose sampling step or values no recorder gives.

    Its cause is usually a wrong unit. `signal` holds the times [s] and the accelerations [m s-2],
    shape (axes, samples); the mean step must lie within `STEPS` and the largest range of an axis
    within `ACCELERATIONS`. Empty if both do; values that are not finite are left to other checks.
    """
    problems = []
    with np.errstate(over="ignore"):
        step = float(np.ptp(signal.times)) / (signal.times.size - 1)
        size = float(np.ptp(signal.accelerations, axis=1).max())
    least, most = STEPS
    if np.isfinite(signal.times).all() and not least <= step <= most:
        fix = "Give rate = the samples per second, or the unit of the column of times"
        problems.append(
            Problem(
                "recording",
                f"the recording has a sample every {step:.3g} s, which no recorder does",
                fix,
            )
        )
    least, most = ACCELERATIONS
    if np.isfinite(signal.accelerations).all() and size and not least <= size <= most:
        fix = "Give the unit of the acceleration columns, or record again"
        problems.append(
            Problem(
                "recording",
                f"the accelerations of the recording range over {size:.3g} m s-2, which no "
                "feeder does",
                fix,
            )
        )
    return problems


def check_orders(signal: Signal, samples: Samples, frequency: float) -> None:
    """Raise `StudyError` if a recording cannot resolve its harmonics, or has too few periods.

    `signal` says how many harmonics the study asks for, `samples` are the recording, `frequency` is
    the fundamental [Hz].
    """
    able = orders_below(samples, frequency)
    wanted = signal.harmonics or 1
    rate = samples.size / samples.duration
    if len(able) < wanted:
        message = (
            f"order {wanted} of {frequency:.4g} Hz needs "
            f"{wanted * frequency / NYQUIST_SHARE:,.0f} samples a second, the recording has "
            f"{rate:,.0f}"
        )
        fix = f"Ask for {len(able)} at most, or record faster" if able else "Record faster"
        raise StudyError([Problem("harmonics", message, fix)])
    if frequency * samples.duration < LEAST_PERIODS:
        raise StudyError([_too_short("recording", frequency, samples.duration)])


def check_fit(
    signal: Signal, samples: Samples, solution: Solution, noise: Noise, stated: bool
) -> None:
    """Raise `StudyError` if the fit of a recording does not determine a drive.

    Parameters
    ----------
    signal, samples : Signal, Samples
        The recording as it was read, and with times about its middle.
    solution, noise : Solution, Noise
        The fit, and the spectral density of its residual.
    stated : bool
        True if any harmonic is significant.

    Raises
    ------
    StudyError
        If no order is significant, the residual is too large, the drive changes from the first
        third to the last, the recorder's clock is too far off the line frequency, the unit of times
        had to be guessed and cannot be seconds, or the constants contradict gravity.
    """
    problems = []
    periodic = np.sqrt((np.abs(solution.waves) ** 2).sum() / 2.0)
    left = np.sqrt(np.mean(solution.residual**2, axis=1).sum())
    if not stated or left > MAX_LEFT * periodic:
        problems.append(_not_periodic(samples, solution, left, periodic))
    if stated:  # a drive that grows leaves much over as well
        problems += _unsteady(signal, samples, solution, noise, periodic)
    if not problems:
        problems += _not_seconds(signal, solution.frequency)
    if not problems:
        problems += _off(signal.line_frequency, solution.frequency)
        constant = solution.drift[:, 0]
        problems += gravity_problems(signal.axes, constant, float(periodic), signal.slopes)
    if problems:
        raise StudyError(problems)


def _too_short(key: str, frequency: float, duration: float) -> Problem:
    """Return the problem of a recording that holds too few periods of a frequency.

    `key` is the place in the study that the problem names, `frequency` in Hz, `duration` that of
    the recording in s; the advice says how long to record.
    """
    another = ", or give frequency, if it is another" if key == "recording" else ""
    return Problem(
        key,
        f"{duration:.4g} s hold {frequency * duration:.3g} periods of {frequency:.4g} Hz",
        f"Record {LEAST_PERIODS} periods at least, {LEAST_PERIODS / frequency:.3g} s{another}",
    )


def _not_periodic(samples: Samples, solution: Solution, left: float, periodic: float) -> Problem:
    """Return the problem of a recording whose signal is not periodic enough for a fit.

    `solution` is the fit of the `samples`, `left` and `periodic` are the rms of its residual and of
    its harmonics [m s-2]. If the strongest line of the residual has too few periods, that is the
    problem instead.
    """
    line = strongest_line(samples._replace(values=solution.residual))
    if stands_out(line, samples.size) and line.frequency * samples.duration < LEAST_PERIODS:
        return _too_short("recording", line.frequency, samples.duration)
    share = f"{100 * left / periodic:.0f} % of" if left < periodic else "more than"
    strongest = f", most at {line.frequency:.4g} Hz" if stands_out(line, samples.size) else ""
    return Problem(
        "recording",
        "the recording is not periodic: the residual of a fit of "
        f"{solution.frequency:.4g} Hz and its multiples has {share} their "
        f"rms{strongest}",
        "Record the empty feeder at a steady drive (a residual of at most "
        f"{100 * MAX_LEFT:.0f} % is accepted), or correct frequency or harmonics",
    )


class _Third(NamedTuple):
    """Rms of the harmonics of one axis, and its variance."""

    rms: float
    variance: float


def _unsteady(
    signal: Signal, samples: Samples, solution: Solution, noise: Noise, periodic: float
) -> list[Problem]:
    """Return a problem for each axis whose harmonics grow or fade during the recording.

    The first third of the `samples` is compared with the last, beyond what `noise` explains.
    `signal` names the axes, `solution` is the fit to the whole recording, `periodic` the rms of the
    harmonics of all axes [m s-2].
    """
    third = samples.size // 3
    thirds = [
        _of_part(samples, part, solution, noise) for part in (slice(third), slice(-third, None))
    ]
    problems = []
    for axis, first, last in zip(signal.axes, *thirds, strict=True):
        change = last.rms - first.rms
        allowed = CHANGE_ERRORS * np.sqrt(first.variance + last.variance)
        if abs(change) > max(MAX_CHANGE * periodic, float(allowed)):
            message = (
                f"the drive is not steady: its rms {axis} is {first.rms:.4g} m/s2 in the first "
                f"third, {last.rms:.4g} in the last"
            )
            fix = "Record when it has settled, or cut out a piece in which it is steady"
            problems.append(Problem("recording", message, fix))
    return problems


def _of_part(samples: Samples, part: slice, solution: Solution, noise: Noise) -> list[_Third]:
    """Return, for each axis, the rms of the harmonics in a part of the samples, and its variance.

    For comparing thirds of a recording, to see if its drive is steady. `part` is the slice of the
    `samples`, which are fitted anew with frequency and orders of `solution`; `noise` holds the
    spectral density of the residual. In m s-2 and its square.
    """
    times = samples.times[part]
    piece = Samples(times - (times[0] + times[-1]) / 2.0, samples.values[:, part])
    fit = solve_least_squares(
        piece, solution.frequency, solution.orders, solution.degree, free=False
    )
    squares = np.abs(fit.waves) ** 2
    rms = np.sqrt(squares.sum(axis=1) / 2.0)
    # rms^2 = sum(p^2 + q^2)/2, and p and q have the variance 2 S/n.
    density = np.einsum("kjj->jk", noise.densities[1:])
    above = (squares * 2.0 * density / piece.size).sum(axis=1)
    variance = above / np.maximum(4.0 * rms**2, np.finfo(float).tiny)
    return [_Third(*pair) for pair in zip(rms.tolist(), variance.tolist(), strict=True)]


def _not_seconds(signal: Signal, frequency: float) -> list[Problem]:
    """Return the problem of times without a unit, which as seconds give no feeder's frequency [Hz].

    Empty if the unit of the `signal`'s times was stated, or if they may be seconds.
    """
    usual = FREQUENCY.usual
    if not signal.assumed or usual is None or usual[0] <= frequency <= usual[1]:
        return []
    unit = likely_unit_of_times(frequency)
    reason = f": they look like {unit}" if unit else ""
    example = f"{signal.assumed} [{unit or 'ms'}]"
    return [
        Problem(
            "time",
            f"column '{signal.assumed}' does not say the unit of its times, and as seconds they "
            f"give a drive of {frequency:.3g} Hz, where feeders have {usual[0]:g} to "
            f"{usual[1]:,g} Hz{reason}",
            f"Write the unit in the heading, as in '{example}', or give rate = the samples per "
            "second and leave time out",
        )
    ]


def _off(line: float | None, frequency: float) -> list[Problem]:
    """Return a problem if measured and given frequency [Hz] differ by more than clocks do.

    `line` is the given frequency of the drive, None if not given; `frequency` that of the
    recording.
    """
    if line is None or abs(frequency / line - 1.0) <= MAX_CLOCK:
        return []
    ratio = max(frequency / line, line / frequency)
    most = f"{100 * MAX_CLOCK:.0f} %"
    fix = f"Clocks are trusted within {most}: correct the sampling rate (rate) or line_frequency"
    if abs(ratio - round(ratio)) < TWICE:
        fix = "Give as line_frequency what the drive runs at, such as 100 Hz on mains of 50 Hz"
    message = f"the recording repeats with {frequency:.4g} Hz, the line has {line:g} Hz"
    return [Problem("line_frequency", message, fix)]
