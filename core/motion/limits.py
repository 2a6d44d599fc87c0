"""The demands of a drive on the machine, by axis: largest acceleration, stroke, largest jerk.

Of the plain sine in closed form; of any other wave as `vibrafeed.core.motion.waves` finds it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion import waves
from vibrafeed.core.motion.waves import Wave
from vibrafeed.core.quantities.drive import AXES, WHERE
from vibrafeed.core.scenes.scene import Equation, arguments_of


@dataclass(frozen=True)
class Limit:
    """A demand of a drive on the machine along one axis, such as its stroke.

    Attributes
    ----------
    says
        Its description, with {} for the axis, and its unit.
    scale
        Function that gives its scale from quantities by name, SI units.
    of_sine
        Its value for a sine in that scale, over the drive number of the axis.
    of_wave
        Function that gives its value in that scale from a wave and an axis.
    """

    says: str
    scale: Callable[..., Array]
    of_sine: float
    of_wave: Callable[[Wave, int], Array]


LIMITS = {
    "largest_acceleration": Limit(
        "largest acceleration of the track {} over a period [m s-2]",
        lambda *, gravity: gravity,
        1.0,
        lambda wave, axis: waves.largest_over_period(wave, axis, "push size"),
    ),
    "stroke": Limit(
        "stroke of the drive {}, peak to peak [m]",
        lambda *, length_scale: length_scale,
        2.0,
        waves.stroke,
    ),
    "largest_jerk": Limit(
        "largest jerk of the drive {}, infinite where its acceleration jumps [m s-3]",
        lambda *, gravity, frequency: gravity * (waves.TURN * frequency),
        1.0,
        waves.jerk,
    ),
}


def equations(drive: str, axes: tuple[str, ...] = AXES) -> tuple[Equation, ...]:
    """Return the equations of the limits of the drive, such as its stroke, for a sine or a wave.

    `drive` is "sine" or "wave"; there is one equation for each limit and each of the `axes` (along,
    across, normal), by which a study may ask for it.
    """
    return tuple(
        _equation(name, limit, axis, drive) for name, limit in LIMITS.items() for axis in axes
    )


def _equation(name: str, limit: Limit, axis: str, drive: str) -> Equation:
    number, place = f"drive_number_{axis}", AXES.index(axis)
    drive_input = "wave" if drive == "wave" else number

    def value(**known: Array) -> Array:
        drive_value = known.pop(drive_input)
        scale = limit.scale(**known)
        if isinstance(drive_value, Wave):
            return limit.of_wave(drive_value, place) * scale
        return limit.of_sine * np.abs(drive_value) * scale

    needs = (drive_input, *arguments_of(limit.scale))
    says = f"Return the {limit.says.format(WHERE[axis])}."
    return Equation(f"{name}_{axis}", value, "theory 13.14", needs=needs, says=says)
