"""Drives that are no plain sine: harmonics on every axis, and steps of acceleration."""

from __future__ import annotations

from vibrafeed.core.quantities.quantity import Quantity, angle

AXES = ("along", "across", "normal")
"""Of the track: +x in transport direction, +y off the wall, +z off the floor."""

MAX_ORDERS = 10
"""Harmonics of an axis."""

MAX_STEPS = 12
"""Pieces of constant acceleration in a period."""

_LETTERS = dict(zip(AXES, "xyz", strict=True))
WHERE = {"along": "along the track", "across": "across the track", "normal": "off the floor"}


def _amplitude(axis: str, order: int) -> Quantity:
    return Quantity(
        "m", f"A{_LETTERS[axis]}{order}", f"Amplitude {axis}, order {order}",
        f"Amplitude of the track's motion {WHERE[axis]} at {_times(order)}, zero to peak.", 0.0,
        parameter=True, examples=("0.1 mm",), usual=(1e-9, 0.025),
    )  # fmt: skip


def _phase(axis: str, order: int) -> Quantity:
    return angle(
        f"phi{_LETTERS[axis]}{order}", f"Phase {axis}, order {order}",
        f"Lead of the track's motion {WHERE[axis]} at {_times(order)}: the displacement is "
        f"A sin({order if order > 1 else ''} w t + phi).", 720.0, "90 deg",
    )  # fmt: skip


def _times(order: int) -> str:
    return "the drive frequency" if order == 1 else f"{order} times the drive frequency"


def _level(axis: str, step: int) -> Quantity:
    return Quantity(
        "m s-2", f"a{_LETTERS[axis]}{step}", f"Acceleration {axis}, step {step}",
        f"Acceleration of the track {WHERE[axis]} during step {step} of a period.",
        parameter=True, examples=("4 m/s^2",),
    )  # fmt: skip


def _duration(step: int) -> Quantity:
    return Quantity(
        "1", f"T{step}", f"Duration of step {step}",
        f"Relative duration of step {step}; the durations of all steps divide the period.", 0.0,
        parameter=True, examples=("0.25",),
    )  # fmt: skip


def _limits(axis: str) -> dict[str, Quantity]:
    letter, where = _LETTERS[axis], WHERE[axis]
    return {
        f"largest_acceleration_{axis}": Quantity(
            "m s-2", f"max |a_{letter}|", f"Largest acceleration {axis}",
            f"Largest acceleration of the track {where} over a period.",
        ),
        f"stroke_{axis}": Quantity(
            "m", f"s_{letter}", f"Stroke {axis}",
            f"How far the track moves {where}, peak to peak.",
        ),
        f"largest_jerk_{axis}": Quantity(
            "m s-3", f"max |j_{letter}|", f"Largest jerk {axis}",
            f"Largest jerk of the track {where}; infinite where its acceleration jumps.",
        ),
    }  # fmt: skip


DRIVE: dict[str, Quantity] = {
    "drive_factor": Quantity(
        "1", "q", "Factor of the drive",
        "Factor by which every amplitude or acceleration of the drive is multiplied.", 0.0,
        parameter=True, examples=("1.2",),
    ),
    **{f"amplitude_{axis}_{n}": _amplitude(axis, n)
       for axis in AXES for n in range(1, MAX_ORDERS + 1)},
    **{f"phase_{axis}_{n}": _phase(axis, n) for axis in AXES for n in range(1, MAX_ORDERS + 1)},
    **{f"acceleration_{axis}_{n}": _level(axis, n)
       for axis in AXES for n in range(1, MAX_STEPS + 1)},
    **{f"duration_{n}": _duration(n) for n in range(1, MAX_STEPS + 1)},
    "wave": Quantity("1", "", "Wave", "The push of the drive on a part, per weight.", bundle=True),
    **{name: limit for axis in AXES for name, limit in _limits(axis).items()},
}  # fmt: skip
