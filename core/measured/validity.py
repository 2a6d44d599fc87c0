"""Checks of a recording before a drive is fitted: long and fast enough, periodic, steady."""

import math
from collections.abc import Iterator, Mapping
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem, StudyError, raise_any, refused
from vibrafeed.core.measured.harmonics import (
    LEAST_PERIODS,
    MAX_LEFT,
    NYQUIST_SHARE,
    Array,
    Noise,
    Samples,
    Solution,
    orders_below,
    solve_least_squares,
    stands_out,
    strongest_line,
)
from vibrafeed.core.measured.recording import (
    AXES,
    FREQUENCY,
    STANDARD_GRAVITY,
    Signal,
)
from vibrafeed.core.measured.times import LEAST_SAMPLES
from vibrafeed.core.study.unusual import likely_unit_of_times

STEPS = 1e-9, 1e3
"""Shortest and longest time from one sample to the next [s]: others are a wrong rate or unit."""
ACCELERATIONS = 1e-9, 1e9
"""Least and largest range of the values of a recording, in SI: their squares are floats."""
_UNITS = "m", "m/s", "m/s2"
MAX_CHANGE = 0.05
"""Largest change from the first third of a recording to the last, over the drive's rms."""
CHANGE_ERRORS = 4.0  # standard errors that the change must exceed as well
MAX_CLOCK = 0.05  # largest error of a recorder's clock, as a share
TWICE = 0.1  # a ratio so near to a whole number means another multiple of the frequency


def check_before(signal: Signal) -> None:
    """Raise `StudyError` if a recording cannot be fitted, with all reasons.

    A value may not be finite, samples may be too few, all channels constant, or a frequency that
    the study gives too low or too high for the recording.
    """
    count = signal.times.size
    values_finite, times_finite = np.isfinite(signal.values).all(), np.isfinite(signal.times).all()
    problems = []
    if not (values_finite and times_finite):
        message = "the recording has values that are not finite numbers"
        problems.append(Problem("recording", message, "Remove these values from the recording"))
    if count < LEAST_SAMPLES:
        raise StudyError(
            [
                *problems,
                Problem(
                    "recording",
                    f"the recording has only {count} samples",
                    f"Record at least {LEAST_SAMPLES} samples and {LEAST_PERIODS} periods",
                ),
            ]
        )
    with np.errstate(over="ignore"):
        step = float(np.ptp(signal.times)) / (count - 1)
        ranges = np.ptp(signal.values, axis=1)
    size = float(ranges.max())
    problems += [
        Problem("recording", message, fix)
        for is_wrong, message, fix in (
            (
                times_finite and not STEPS[0] <= step <= STEPS[1],
                f"the recording seems to have one sample every {step:.3g} s",
                "Give rate = the samples per second, or the unit of the time column",
            ),
            (
                values_finite and size and not ACCELERATIONS[0] <= size <= ACCELERATIONS[1],
                f"the recorded values vary by {size:.3g} {_UNITS[signal.derivative]}, which no "
                "feeder can do",
                "Give the right unit of the columns, or record again",
            ),
            (
                not ranges.any(),
                "all channels of the recording are constant: the sensor recorded no motion",
                "Check that the sensor was connected",
            ),
        )
        if is_wrong
    ]
    duration = float(np.ptp(signal.times)) * count / (count - 1)
    lowest, highest = LEAST_PERIODS / duration, NYQUIST_SHARE * count / duration
    for key in ("frequency", "line_frequency"):
        frequency = getattr(signal, key)
        if frequency is not None and frequency < lowest:
            problems.append(_too_short(key, frequency, duration))
        elif frequency is not None and frequency > highest:
            problems.append(
                Problem(
                    key,
                    f"the recording has {count / duration:,.4g} samples per second, which "
                    f"cannot resolve {frequency:g} Hz",
                    f"Record at least {frequency / NYQUIST_SHARE:,.4g} samples per second"
                    + (f", or write the unit in the heading, as in '{signal.assumed} [ms]'")
                    * bool(signal.assumed),
                )
            )
    raise_any(problems)


def check_orders(signal: Signal, samples: Samples, frequency: float) -> None:
    """Raise `StudyError` if a recording cannot resolve its harmonics, or has too few periods.

    `signal` says how many harmonics the study asks for, `samples` are the recording, `frequency` is
    the fundamental [Hz].
    """
    resolvable = orders_below(samples, frequency)
    requested = signal.harmonics or 1
    if len(resolvable) < requested:
        raise refused(
            "harmonics",
            f"harmonic {requested} of {frequency:.4g} Hz needs "
            f"{requested * frequency / NYQUIST_SHARE:,.0f} samples per second, and the recording "
            f"has {samples.size / samples.duration:,.0f}",
            f"Give harmonics = {len(resolvable)} at most, or record faster"
            if resolvable
            else "Record faster",
        )
    if frequency * samples.duration < LEAST_PERIODS:
        raise StudyError([_too_short("recording", frequency, samples.duration)])


def check_fit(
    signal: Signal, samples: Samples, solution: Solution, noise: Noise, is_significant: bool
) -> None:
    """Raise `StudyError` if the fit of a recording does not determine a drive.

    That is unless `is_significant`, or if the residual is too large, the drive changes from
    the first third to the last, the recorder's clock is too far off the line frequency, the unit of
    times had to be guessed and cannot be seconds, or the constants contradict gravity.
    """
    problems = []
    periodic = np.sqrt((np.abs(solution.waves) ** 2).sum() / 2.0)
    residual_rms = np.sqrt(np.mean(solution.residual**2, axis=1).sum())
    if not is_significant or residual_rms > MAX_LEFT * periodic:
        problems.append(_problem_of_periodicity(samples, solution, residual_rms, periodic))
    if is_significant:  # an unsteady drive has a large residual, too
        problems += _steadiness_problems(signal, samples, solution, noise, periodic)
    if not problems:
        problems += _time_unit_problems(signal, solution.frequency)
    if not problems:
        problems += _clock_problems(signal.line_frequency, solution.frequency)
    if not problems and signal.derivative == 2:
        problems += gravity_problems(
            signal.axes, solution.drift[:, 0], float(periodic), signal.slopes
        )
    raise_any(problems)


def _too_short(key: str, frequency: float, duration: float) -> Problem:
    another = ", or give the frequency if this one is wrong" if key == "recording" else ""
    return Problem(
        key,
        f"the recording of {duration:.4g} s has only {frequency * duration:.3g} periods of "
        f"{frequency:.4g} Hz",
        f"Record at least {LEAST_PERIODS} periods, {LEAST_PERIODS / frequency:.3g} s{another}",
    )


def _problem_of_periodicity(
    samples: Samples, solution: Solution, residual_rms: float, periodic: float
) -> Problem:
    line = strongest_line(samples._replace(values=solution.residual))
    if stands_out(line, samples.size) and line.frequency * samples.duration < LEAST_PERIODS:
        return _too_short("recording", line.frequency, samples.duration)
    share = f"{100 * residual_rms / periodic:.0f} % of" if residual_rms < periodic else "more than"
    strongest = f", mostly at {line.frequency:.4g} Hz" if stands_out(line, samples.size) else ""
    return Problem(
        "recording",
        f"the recording is not periodic: a fit of {solution.frequency:.4g} Hz and its harmonics "
        f"leaves a residual with {share} their rms{strongest}",
        "Record the empty feeder at a steady drive (a residual of at most "
        f"{100 * MAX_LEFT:.0f} % is accepted), or correct frequency or harmonics",
    )


def _steadiness_problems(
    signal: Signal, samples: Samples, solution: Solution, noise: Noise, periodic: float
) -> list[Problem]:
    third = samples.size // 3
    first, first_variance = _rms_of_part(samples, slice(third), solution, noise)
    last, last_variance = _rms_of_part(samples, slice(-third, None), solution, noise)
    allowed_change = np.maximum(
        MAX_CHANGE * periodic, CHANGE_ERRORS * np.sqrt(first_variance + last_variance)
    )
    return [
        Problem(
            "recording",
            f"the drive is not steady: its rms {axis} is {before:.4g} "
            f"{_UNITS[signal.derivative]} in the first third and {after:.4g} in the last third",
            "Record after the drive has settled, or keep only a steady part of the recording",
        )
        for axis, before, after, allowed in zip(
            signal.axes, first, last, allowed_change, strict=True
        )
        if abs(after - before) > allowed
    ]


def _rms_of_part(
    samples: Samples, part: slice, solution: Solution, noise: Noise
) -> tuple[Array, Array]:
    # The rms of the harmonics in a part of the samples, and its variance, for each axis.
    times = samples.times[part]
    piece = Samples(times - (times[0] + times[-1]) / 2.0, samples.values[:, part])
    fit = solve_least_squares(
        piece, solution.frequency, solution.orders, solution.degree, free=False
    )
    squares = np.abs(fit.waves) ** 2
    rms = np.sqrt(squares.sum(axis=1) / 2.0)
    # rms^2 = sum(p^2 + q^2)/2, and p and q have the variance 2 S/n.
    density = np.einsum("kjj->jk", noise.densities[1:])
    variance_of_square = (squares * 2.0 * density / piece.size).sum(axis=1)
    return rms, variance_of_square / np.maximum(4.0 * rms**2, np.finfo(float).tiny)


def _time_unit_problems(signal: Signal, frequency: float) -> list[Problem]:
    usual = FREQUENCY.usual
    if not signal.assumed or usual is None or usual[0] <= frequency <= usual[1]:
        return []
    unit = likely_unit_of_times(frequency)
    reason = f", so the unit is probably {unit}" if unit else ""
    return [
        Problem(
            "time",
            f"column '{signal.assumed}' has no unit of time; in seconds, its times would mean a "
            f"drive of {frequency:.3g} Hz, and feeders have {usual[0]:g} to {usual[1]:,g} Hz"
            f"{reason}",
            f"Write the unit in the heading, as in '{signal.assumed} [{unit or 'ms'}]', or give "
            "rate = the samples per second and leave time out",
        )
    ]


def _clock_problems(line_frequency: float | None, frequency: float) -> list[Problem]:
    if line_frequency is None or abs(frequency / line_frequency - 1.0) <= MAX_CLOCK:
        return []
    ratio = max(frequency / line_frequency, line_frequency / frequency)
    return [
        Problem(
            "line_frequency",
            f"the recorded drive has {frequency:.4g} Hz, but line_frequency is "
            f"{line_frequency:g} Hz",
            "Give the frequency of the drive as line_frequency, such as 100 Hz on mains of 50 Hz"
            if abs(ratio - round(ratio)) < TWICE
            else "Correct the sampling rate (rate) or line_frequency: a recorder's clock is not "
            f"off by more than {100 * MAX_CLOCK:.0f} %",
        )
    ]


# --- Gravity in a recording: whether the channels are what they are named.


SIZE = 0.1  # share of gravity by which a constant acceleration may differ from it
REMOVED = 0.08  # of gravity: smaller constants are offsets of a sensor that does not show it
STEEPEST = float(np.radians(20.0))  # slope of a track of which the study says nothing
MARGIN = float(np.radians(10.0))  # of a stated slope: the sensor's mounting and offset
SMALL = 0.03  # rms of a drive, over gravity, that is too small to move parts
CONFUSED = {
    1.0 / STANDARD_GRAVITY: "it would be 1 g if the values were in g rather than in m s-2",
    STANDARD_GRAVITY: "it would be 1 g if the values were in m s-2 rather than in g",
    1000.0: "it would be 1 g if the values were a thousandth (mg, mm s-2)",
    0.001: "it would be 1 g if the values were a thousand times as large (m s-2 for mm s-2, or "
    "commas that separate thousands)",
}
"""Gravity in a wrong unit, over gravity: what a reader thinks of it."""


def gravity_problems(
    axes: tuple[str, ...],
    constant: NDArray[np.float64],
    rms: float,
    slopes: Mapping[str, tuple[float, float]],
) -> Iterator[Problem]:
    """Yield the problem of a recording whose constants contradict gravity, if they do.

    `constant` is the mean acceleration of each axis, shape (axes,), and `rms` that of the harmonics
    of all axes [m s-2]; `slopes` are the angles of the track that the study states [rad], by axis:
    along the climb, across the lean.
    """
    in_g = dict(zip(axes, (constant / STANDARD_GRAVITY).tolist(), strict=True))
    stated_slopes = {axis: slopes.get(axis, (0.0, 0.0)) for axis in AXES[:2]}
    limits = {
        axis: (min(-STEEPEST, lower - MARGIN), max(STEEPEST, upper + MARGIN))
        for axis, (lower, upper) in stated_slopes.items()
    }
    for axis, meaning, fix in islice(_gravity_faults(in_g, rms, limits), 1):
        others = ", ".join(f"{value:.2f} g {name}" for name, value in in_g.items() if name != axis)
        others_in_words = f" (and {others})" if others else ""
        size = f"the mean of the recording's {axis} channel is {in_g[axis]:.3g} g{others_in_words}"
        yield Problem(axis, f"{size}: {meaning}", fix)


def _faults_without_gravity(
    in_g: Mapping[str, float], rms: float, steepest: Mapping[str, float]
) -> Iterator[tuple[str, str, str]]:
    # As `_gravity_faults`, for a recording that does not show gravity in the normal channel.
    normal = in_g.get("normal")
    is_thousandth = normal is not None and abs(abs(normal) / 0.001 - 1.0) <= SIZE
    if is_thousandth and rms < SMALL * STANDARD_GRAVITY:
        yield (
            "normal",
            CONFUSED[0.001],
            "Correct the unit of the accelerations, and export without separators of thousands",
        )
    for axis in filter(in_g.__contains__, steepest):
        if abs(in_g[axis]) > SIZE + (np.sin(steepest[axis]) if normal is None else 0.0):
            yield (
                axis,
                "a track at rest shows gravity in the normal channel",
                "Correct the names of the channels, the unit, or the mounting",
            )


def _gravity_faults(
    in_g: Mapping[str, float], rms: float, limits: Mapping[str, tuple[float, float]]
) -> Iterator[tuple[str, str, str]]:
    # Yields channel, meaning of its constant `in_g`, and fix; `limits` are angles [rad].
    normal = in_g.get("normal")
    recorded = [axis for axis in limits if axis in in_g]
    steepest = {axis: min(max(map(abs, ends)), np.pi / 2.0) for axis, ends in limits.items()}
    if normal is None or abs(normal) < 0.5:
        for axis in recorded:
            if abs(in_g[axis]) >= 1.0 - SIZE:
                yield (
                    axis,
                    "gravity belongs to the normal channel",
                    "Name as normal the column that shows +1 g, as along that of the transport",
                )
    if normal is None or abs(normal) <= REMOVED:
        yield from _faults_without_gravity(in_g, rms, steepest)
        return
    for factor, meaning in CONFUSED.items():
        if abs(abs(normal) / factor - 1.0) <= SIZE:
            yield (
                "normal",
                meaning,
                "Correct the unit of the accelerations: the key unit, or the headings",
            )
    # Axes that were not recorded may have a part of gravity.
    cosines = (float(np.cos(steepest[axis])) for axis in limits if axis not in in_g)
    least_size = math.prod(cosines, start=1.0 - SIZE)
    if not least_size <= float(np.linalg.norm(list(in_g.values()))) <= 1.0 + SIZE:
        yield (
            "normal",
            "a sensor at rest shows 1 g, or 0 if it does not measure constant accelerations",
            "Correct the unit, the scale of the sensor, or the names of the channels",
        )
    if normal < 0.0:
        yield (
            "normal",
            "the channel points downwards, and the fitted drive would throw parts downwards",
            "Turn its sign: a minus sign in front of the column's name, or none if it has one; or "
            "give the mounting of a sensor that is upside down",
        )
    for axis in recorded:
        angle = float(np.arctan2(in_g[axis], normal))
        if not limits[axis][0] <= angle <= limits[axis][1]:
            verb, parameter = ("climb", "gamma") if axis == "along" else ("lean", "delta")
            yield (
                axis,
                f"the track would {verb} by {np.degrees(angle):.0f} degrees",
                "Correct the names of the channels or the mounting, or give the study's "
                f"{parameter}, if the track is so steep",
            )
