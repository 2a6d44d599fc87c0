"""Gravity in a recording: how the track stands, and whether the channels are what they are named.

A sensor of constant accelerations on a track at rest shows +1 g in the normal channel, and the sine
of climb and lean along and across. A sensor without them shows 0 everywhere.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import Problem
from vibrafeed.core.measured.drive import Tilt
from vibrafeed.core.measured.recording import AXES, STANDARD_GRAVITY

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


def tilt_of(axes: tuple[str, ...], constant: NDArray[np.float64]) -> Tilt | None:
    """Return the tilt of a track from the constant acceleration that a sensor shows, gravity.

    `constant`, shape (axes,) [m s-2], holds it along, across and normal to the track. None unless
    `axes` has along and normal, and it has the size of gravity within 10 %. The lean is NaN without
    a channel across.
    """
    shown = dict(zip(axes, constant.tolist(), strict=True))
    size = float(np.linalg.norm(constant))
    if not {"along", "normal"} <= shown.keys() or abs(size / STANDARD_GRAVITY - 1.0) > SIZE:
        return None
    climb, lean = (
        float(np.arctan2(shown.get(axis, np.nan), shown["normal"])) for axis in ("along", "across")
    )
    return Tilt(climb, lean, size)


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
                means = "gravity belongs to the normal channel"
                fix = "Name as normal the column that shows +1 g, as along that of the transport"
                return [_contradicts(axis, shown, means, fix)]
    if normal is None or abs(normal) <= REMOVED:
        return _without_gravity(shown, rms, limits)
    return _size_problems(normal, shown, limits) or _direction_problems(normal, shown, limits)


def _limits(slopes: Slopes) -> dict[str, tuple[float, float]]:
    """Return the least and largest angle [rad] at which a recording's track may rise, by axis.

    What the study states (`slopes`) is widened by `MARGIN`; every track may rise by `STEEPEST`.
    """
    stated = {axis: slopes.get(axis, (0.0, 0.0)) for axis in AXES[:2]}
    return {
        axis: (min(-STEEPEST, least - MARGIN), max(STEEPEST, most + MARGIN))
        for axis, (least, most) in stated.items()
    }


def _steepest(limits: tuple[float, float]) -> float:
    """Return the largest angle of a slope, whichever its sign; a right one at most [rad]."""
    return min(max(map(abs, limits)), np.pi / 2.0)


def _size_problems(
    normal: float, shown: Mapping[str, float], limits: Mapping[str, tuple[float, float]]
) -> list[Problem]:
    """Return the problem of constants that have not the size of gravity; empty without one.

    `shown` has them over gravity, by axis, `normal` that of the normal channel; `limits` are the
    angles [rad] at which the track may rise.
    """
    for factor, means in CONFUSED.items():
        if abs(abs(normal) / factor - 1.0) <= SIZE:
            fix = "Correct the unit of the accelerations: the key unit, or the headings"
            return [_contradicts("normal", shown, means, fix)]
    lowest = 1.0 - SIZE
    for axis in [
        one for one in limits if one not in shown
    ]:  # what is not recorded may have a share of gravity
        lowest *= float(np.cos(_steepest(limits[axis])))
    if lowest <= float(np.linalg.norm(list(shown.values()))) <= 1.0 + SIZE:
        return []
    means = "a sensor at rest shows 1 g, or 0 if it does not measure constant accelerations"
    fix = "Correct the unit, the scale of the sensor, or the names of the channels"
    return [_contradicts("normal", shown, means, fix)]


def _direction_problems(
    normal: float, shown: Mapping[str, float], limits: Mapping[str, tuple[float, float]]
) -> list[Problem]:
    """Return the problem of gravity that points elsewhere than the track allows.

    Empty without one; the parameters are those of `_size_problems`.
    """
    if normal < 0.0:
        means = "the channel points downwards, and the fitted drive would throw parts downwards"
        fix = (
            "Turn its sign: a minus sign in front of the column's name, or none if it has one; or "
            "give the mounting of a sensor that hangs upside down"
        )
        return [_contradicts("normal", shown, means, fix)]
    for axis in filter(shown.__contains__, limits):
        angle = float(np.arctan2(shown[axis], normal))
        least, most = limits[axis]
        if not least <= angle <= most:
            verb, parameter = ("climb", "gamma") if axis == "along" else ("lean", "delta")
            means = f"the track would {verb} by {np.degrees(angle):.0f} degrees"
            fix = (
                "Correct the names of the channels or the mounting, or give the study's "
                f"{parameter}, if the track is so steep"
            )
            return [_contradicts(axis, shown, means, fix)]
    return []


def _without_gravity(
    shown: Mapping[str, float], rms: float, limits: Mapping[str, tuple[float, float]]
) -> list[Problem]:
    """Return the problem of a recording without gravity in the normal channel; empty without one.

    `shown` has the constants over gravity, `rms` is that of the drive [m s-2]; `limits` are the
    angles [rad] at which the track may rise: if the normal channel was not recorded, the others may
    show their share of gravity.
    """
    normal = shown.get("normal")
    thousandth = normal is not None and abs(abs(normal) / 0.001 - 1.0) <= SIZE
    if thousandth and rms < SMALL * STANDARD_GRAVITY:
        fix = "Correct the unit of the accelerations, and export without separators of thousands"
        return [_contradicts("normal", shown, CONFUSED[0.001], fix)]
    for axis in filter(shown.__contains__, limits):
        most = SIZE + (np.sin(_steepest(limits[axis])) if normal is None else 0.0)
        if abs(shown[axis]) > most:
            means = "a track at rest shows gravity in the normal channel"
            fix = "Correct the names of the channels, the unit, or the mounting"
            return [_contradicts(axis, shown, means, fix)]
    return []


def _contradicts(axis: str, shown: Mapping[str, float], means: str, fix: str) -> Problem:
    """Return the problem of a channel whose constant contradicts gravity.

    `shown` has the constants of all channels over gravity; `means` says what follows from them.
    """
    others = ", ".join(f"{value:.2f} g {name}" for name, value in shown.items() if name != axis)
    beside = f" (and {others})" if others else ""
    message = f"the mean of the recording's {axis} channel is {shown[axis]:.3g} g{beside}: {means}"
    return Problem(axis, message, fix)
