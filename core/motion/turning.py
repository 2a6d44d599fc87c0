"""Axes in which a part without a wall is followed: friction turns with the drive.

Where drive and slope lie on one line, x is along it, and the motion is one in the plane.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, sine
from vibrafeed.core.motion.method import Groups
from vibrafeed.core.motion.waves import ACROSS, ALONG, Wave, bound

ON_A_LINE = 1e-14
"""Distance of a push from a line, over the size of all, up to which it counts as on the line."""


def turned(groups: Groups) -> tuple[Groups, Array]:
    """Return the groups in turned axes, and the angle by which these are turned [rad].

    Where all pushes are along one line, x is along it and nothing pushes across; else x is along
    the slope.
    """
    pairs = [*_pushes(groups)]
    squares = sum((x - y) * (x + y) for x, y in pairs)
    line_angle = 0.5 * np.arctan2(2.0 * sum(x * y for x, y in pairs), squares)
    size = np.sqrt(sum(x * x + y * y for x, y in pairs))
    offsets = [turn(x, y, line_angle)[1] for x, y in pairs]
    is_line = np.logical_and.reduce([np.abs(offset) <= ON_A_LINE * size for offset in offsets])
    angle = np.where(is_line, line_angle, np.arctan2(pairs[0][1], pairs[0][0]))
    return _in_axes(groups, angle, is_line), angle


def _pushes(groups: Groups) -> Iterator[tuple[Any, Any]]:
    # Components along and across of the slope, and of every number of the drive.
    yield np.asarray(groups.gravity_number_along), np.asarray(groups.gravity_number_across)
    if groups.wave is None:
        yield np.asarray(groups.drive_number_along), np.asarray(groups.drive_number_across)
        return
    harmonics, steps = groups.wave
    yield from zip(*harmonics[: ACROSS + 1].reshape(2, -1, *harmonics.shape[3:]), strict=True)
    yield from zip(steps[ALONG], steps[ACROSS], strict=True)


def turn(x: Any, y: Any, angle: Array) -> tuple[Array, Array]:
    """Return the components of vectors in axes that are turned by an angle [rad]."""
    c, s = cosine(angle), sine(angle)
    return c * x + s * y, c * y - s * x


def _in_axes(groups: Groups, angle: Array, is_line: Mask) -> Groups:
    # The groups with slope and drive turned by `angle`; on a line nothing is left across.
    slope, _ = turn(groups.gravity_number_along, groups.gravity_number_across, angle)
    part = groups._replace(gravity_number_along=slope, gravity_number_across=0.0)
    if groups.wave is None:
        along, across = turn(groups.drive_number_along, groups.drive_number_across, angle)
        across = np.where(is_line, 0.0, across)
    else:
        fields = []
        for field, own_axes in zip(groups.wave, (3, 2), strict=True):
            missing = (1,) * (angle.ndim + own_axes - field.ndim)
            x, y, *others = field.reshape(
                *field.shape[:own_axes], *missing, *field.shape[own_axes:]
            )
            x, y = turn(x, y, angle)
            fields.append(np.stack(np.broadcast_arrays(x, np.where(is_line, 0.0, y), *others)))
        wave = Wave(*fields)
        part = part._replace(wave=wave)
        along, across = bound(wave, ALONG), bound(wave, ACROSS)
    return part._replace(drive_number_along=along, drive_number_across=across)
