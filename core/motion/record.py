"""A drive as it was recorded, from rest to rest.

Accelerations, or velocities, are linear between the samples. The push of an axis is its drive
number times `Record.push`; the velocity of the track is minus its first integral over the phase,
the displacement minus its second one.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import scipy

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.method import Numbers
from vibrafeed.core.motion.waves import TURN
from vibrafeed.core.quantities.drives import AXES, WHERE
from vibrafeed.core.scenes.scene import Equation, Scene, behind

RESULTS = ("burst_displacement", "burst_coasting_time")
SCALES = ("velocity_scale", "length_scale")


@dataclass(frozen=True)
class Ramp:
    """The drive between two samples: its push at the phase `start` in rad, and the slope of that.

    Both have three axes, in g; `track` is the velocity of the track along itself at `start`.
    """

    first: Array
    slope: Array
    start: float
    track: float
    order = 1

    def push(self, phase: Numbers) -> tuple[Numbers, Numbers, Numbers]:
        """Return the push along, across and normal at a phase in rad, in g."""
        along, across, normal = (
            first + slope * (phase - self.start)
            for first, slope in zip(self.first.tolist(), self.slope.tolist(), strict=True)
        )
        return along, across, normal

    def speed(self, phase: Numbers) -> Numbers:
        """Return the velocity of the track along at a phase."""
        elapsed = phase - self.start
        return self.track - float(self.first[0]) * elapsed - float(self.slope[0]) * elapsed**2 / 2

    @property
    def steepest(self) -> float:
        """The size of the push's slope."""
        return float(np.linalg.norm(self.slope))


@dataclass(frozen=True)
class Record:
    """The drive of a recording over one turn of the phase.

    `peaks` are the largest accelerations along, across and normal [m s-2]; `push` is minus the
    acceleration over these, a piecewise polynomial of the phase from 0 to 2 pi.
    """

    peaks: Array
    push: Any

    @classmethod
    def of(cls, samples: Mapping[Any, Sequence[float]], derivative: int) -> "Record":
        """Return the drive of accelerations [m s-2] or velocities [m s-1] by axis, and `time` [s].

        `derivative` is 2 of accelerations, 1 of velocities; either is linear between the samples.
        """
        times = np.array(samples["time"])
        values = np.stack([samples.get(axis, np.zeros(times.size)) for axis in AXES], axis=-1)
        durations = np.diff(times)[:, np.newaxis]
        first, rises = values[:-1], np.diff(values, axis=0)
        if derivative == 1:
            first, rises = rises / durations, np.zeros(rises.shape)
        peaks = np.maximum(np.abs(first), np.abs(first + rises)).max(axis=0)
        scale = np.where(peaks > 0.0, peaks, 1.0)
        phases = TURN * times / times[-1]
        slopes = rises / np.diff(phases)[:, np.newaxis]
        return cls(peaks, scipy.interpolate.PPoly(-np.stack([slopes, first]) / scale, phases))

    def moved(self, axis: int, phases: Array, integrals: int) -> Array:
        """Return velocity (1) or displacement (2) of the track over the drive number of the axis.

        From rest at phase 0; later turns repeat the first.
        """
        turns, within = np.divmod(phases, TURN)
        integral = self.push.antiderivative(integrals)
        movement: Array = -(integral(within)[..., axis] + turns * integral(TURN)[axis])
        return movement

    def pieces(
        self, drive: tuple[float, float, float], begin: float, end: float
    ) -> Iterator[tuple[Ramp, float]]:
        """Yield the drive between samples from one phase to another, with the phase of each end."""
        (slopes, first), phases = np.array(drive) * self.push.c, self.push.x
        speeds = drive[0] * self.moved(0, phases[:-1], 1)
        turn, within = divmod(begin, TURN)
        index = int(np.searchsorted(phases, within, side="right")) - 1
        while True:
            for k in range(index, len(slopes)):
                start, stop = (turn * TURN + phases[k : k + 2]).tolist()
                yield Ramp(first[k], slopes[k], start, speeds[k]), min(stop, end)
                if stop >= end:
                    return
            turn, index = turn + 1, 0

    def drives(self, system: Scene, method: str) -> Scene:
        """Return a scene whose part this drive moves, once: it gives bursts and nothing else."""
        producers = system.producers(method)
        burst = producers["burst"]
        replaced = {"burst": replace(burst, function=partial(burst.function, record=self))}
        for axis, peak in zip(AXES, self.peaks.tolist(), strict=True):
            replaced[f"drive_number_{axis}"] = Equation(
                f"drive_number_{axis}", partial(_drive_number, peak), "theory 13.9",
                needs=("gravity", "drive_factor"),
                says=f"Return the largest acceleration recorded {WHERE[axis]}, over gravity [1].",
            )  # fmt: skip
        needed = behind((*RESULTS, *SCALES), {**producers, **replaced}.get).values()
        return replace(
            system,
            variants={method: tuple(equation for equation in needed if equation is not None)},
            default_variant=method,
            conditions={method: ()},
            defaults={**system.defaults, "drive_factor": 1.0},
        )


def _drive_number(peak: float, *, gravity: Array, drive_factor: Array) -> Array:
    return peak * drive_factor / gravity
