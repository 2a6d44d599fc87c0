"""Checks of a recording before a drive is fitted: long and fast enough, periodic, steady."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.measured.harmonics import (
    LEAST_PERIODS,
    MAX_LEFT,
    NYQUIST_SHARE,
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
    LEAST_SAMPLES,
    STANDARD_GRAVITY,
    Signal,
)
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
        raise StudyError(
            [
                *problems,
                Problem(
                    "recording",
                    f"it has {count} samples",
                    f"Record {LEAST_SAMPLES} at least, over {LEAST_PERIODS} periods or more",
                ),
            ]
        )
    problems += _out_of_range(signal)
    if not np.ptp(signal.accelerations, axis=1).any():
        problems.append(
            Problem(
                "recording",
                "all channels of the recording are constant: the sensor recorded no motion",
                "Check that the sensor was connected",
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
    problems = []
    with np.errstate(over="ignore"):
        step = float(np.ptp(signal.times)) / (signal.times.size - 1)
        size = float(np.ptp(signal.accelerations, axis=1).max())
    least, most = STEPS
    if np.isfinite(signal.times).all() and not least <= step <= most:
        problems.append(
            Problem(
                "recording",
                f"the recording has a sample every {step:.3g} s, which no recorder does",
                "Give rate = the samples per second, or the unit of the column of times",
            )
        )
    least, most = ACCELERATIONS
    if np.isfinite(signal.accelerations).all() and size and not least <= size <= most:
        problems.append(
            Problem(
                "recording",
                f"the accelerations of the recording range over {size:.3g} m s-2, which no "
                "feeder does",
                "Give the unit of the acceleration columns, or record again",
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
        raise StudyError(
            [
                Problem(
                    "harmonics",
                    f"order {wanted} of {frequency:.4g} Hz needs "
                    f"{wanted * frequency / NYQUIST_SHARE:,.0f} samples a second, the recording has "
                    f"{rate:,.0f}",
                    f"Ask for {len(able)} at most, or record faster" if able else "Record faster",
                )
            ]
        )
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
    another = ", or give frequency, if it is another" if key == "recording" else ""
    return Problem(
        key,
        f"{duration:.4g} s hold {frequency * duration:.3g} periods of {frequency:.4g} Hz",
        f"Record {LEAST_PERIODS} periods at least, {LEAST_PERIODS / frequency:.3g} s{another}",
    )


def _not_periodic(samples: Samples, solution: Solution, left: float, periodic: float) -> Problem:
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
    third = samples.size // 3
    thirds = [
        _of_part(samples, part, solution, noise) for part in (slice(third), slice(-third, None))
    ]
    problems = []
    for axis, first, last in zip(signal.axes, *thirds, strict=True):
        change = last.rms - first.rms
        allowed = CHANGE_ERRORS * np.sqrt(first.variance + last.variance)
        if abs(change) > max(MAX_CHANGE * periodic, float(allowed)):
            problems.append(
                Problem(
                    "recording",
                    f"the drive is not steady: its rms {axis} is {first.rms:.4g} m/s2 in the first "
                    f"third, {last.rms:.4g} in the last",
                    "Record when it has settled, or cut out a piece in which it is steady",
                )
            )
    return problems


def _of_part(samples: Samples, part: slice, solution: Solution, noise: Noise) -> list[_Third]:
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
    if line is None or abs(frequency / line - 1.0) <= MAX_CLOCK:
        return []
    ratio = max(frequency / line, line / frequency)
    most = f"{100 * MAX_CLOCK:.0f} %"
    fix = f"Clocks are trusted within {most}: correct the sampling rate (rate) or line_frequency"
    if abs(ratio - round(ratio)) < TWICE:
        fix = "Give as line_frequency what the drive runs at, such as 100 Hz on mains of 50 Hz"
    return [
        Problem(
            "line_frequency",
            f"the recording repeats with {frequency:.4g} Hz, the line has {line:g} Hz",
            fix,
        )
    ]


# --- Gravity in a recording: how the track stands, and whether the channels are what they are named.


Slopes = Mapping[str, tuple[float, float]]
"""Least and largest angle [rad] by which a track may rise along and across."""

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
    axes: tuple[str, ...], constant: NDArray[np.float64], rms: float, slopes: Slopes
) -> list[Problem]:
    """Return the problem of a recording whose constants contradict gravity; empty without one.

    Parameters
    ----------
    axes : tuple of str
        Which of along, across and normal.
    constant : ndarray, shape (axes,)
        Mean acceleration of each [m s-2].
    rms : float
        Of the harmonics of all axes [m s-2].
    slopes : mapping of str to tuple
        Angles of the track that the study states, by axis: along the climb, across the lean.
    """
    shown = dict(zip(axes, (constant / STANDARD_GRAVITY).tolist(), strict=True))
    limits = _limits(slopes)
    normal = shown.get("normal")
    if normal is None or abs(normal) < 0.5:
        for axis in limits:
            if abs(shown.get(axis, 0.0)) >= 1.0 - SIZE:
                return [
                    _contradicts(
                        axis,
                        shown,
                        "gravity belongs to the normal channel",
                        "Name as normal the column that shows +1 g, as along that of the transport",
                    )
                ]
    if normal is None or abs(normal) <= REMOVED:
        return _without_gravity(shown, rms, limits)
    return _size_problems(normal, shown, limits) or _direction_problems(normal, shown, limits)


def _limits(slopes: Slopes) -> dict[str, tuple[float, float]]:
    stated = {axis: slopes.get(axis, (0.0, 0.0)) for axis in AXES[:2]}
    return {
        axis: (min(-STEEPEST, least - MARGIN), max(STEEPEST, most + MARGIN))
        for axis, (least, most) in stated.items()
    }


def _steepest(limits: tuple[float, float]) -> float:
    return min(max(map(abs, limits)), np.pi / 2.0)


def _size_problems(
    normal: float, shown: Mapping[str, float], limits: Mapping[str, tuple[float, float]]
) -> list[Problem]:
    for factor, means in CONFUSED.items():
        if abs(abs(normal) / factor - 1.0) <= SIZE:
            return [
                _contradicts(
                    "normal",
                    shown,
                    means,
                    "Correct the unit of the accelerations: the key unit, or the headings",
                )
            ]
    lowest = 1.0 - SIZE
    for axis in [
        one for one in limits if one not in shown
    ]:  # what is not recorded may have a share of gravity
        lowest *= float(np.cos(_steepest(limits[axis])))
    if lowest <= float(np.linalg.norm(list(shown.values()))) <= 1.0 + SIZE:
        return []
    return [
        _contradicts(
            "normal",
            shown,
            "a sensor at rest shows 1 g, or 0 if it does not measure constant accelerations",
            "Correct the unit, the scale of the sensor, or the names of the channels",
        )
    ]


def _direction_problems(
    normal: float, shown: Mapping[str, float], limits: Mapping[str, tuple[float, float]]
) -> list[Problem]:
    if normal < 0.0:
        return [
            _contradicts(
                "normal",
                shown,
                "the channel points downwards, and the fitted drive would throw parts downwards",
                "Turn its sign: a minus sign in front of the column's name, or none if it has one; or "
                "give the mounting of a sensor that hangs upside down",
            )
        ]
    for axis in filter(shown.__contains__, limits):
        angle = float(np.arctan2(shown[axis], normal))
        least, most = limits[axis]
        if not least <= angle <= most:
            verb, parameter = ("climb", "gamma") if axis == "along" else ("lean", "delta")
            return [
                _contradicts(
                    axis,
                    shown,
                    f"the track would {verb} by {np.degrees(angle):.0f} degrees",
                    "Correct the names of the channels or the mounting, or give the study's "
                    f"{parameter}, if the track is so steep",
                )
            ]
    return []


def _without_gravity(
    shown: Mapping[str, float], rms: float, limits: Mapping[str, tuple[float, float]]
) -> list[Problem]:
    normal = shown.get("normal")
    thousandth = normal is not None and abs(abs(normal) / 0.001 - 1.0) <= SIZE
    if thousandth and rms < SMALL * STANDARD_GRAVITY:
        return [
            _contradicts(
                "normal",
                shown,
                CONFUSED[0.001],
                "Correct the unit of the accelerations, and export without separators of thousands",
            )
        ]
    for axis in filter(shown.__contains__, limits):
        most = SIZE + (np.sin(_steepest(limits[axis])) if normal is None else 0.0)
        if abs(shown[axis]) > most:
            return [
                _contradicts(
                    axis,
                    shown,
                    "a track at rest shows gravity in the normal channel",
                    "Correct the names of the channels, the unit, or the mounting",
                )
            ]
    return []


def _contradicts(axis: str, shown: Mapping[str, float], means: str, fix: str) -> Problem:
    others = ", ".join(f"{value:.2f} g {name}" for name, value in shown.items() if name != axis)
    beside = f" (and {others})" if others else ""
    return Problem(
        axis,
        f"the mean of the recording's {axis} channel is {shown[axis]:.3g} g{beside}: {means}",
        fix,
    )
