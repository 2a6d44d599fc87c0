"""A drive in pieces: cut where its push jumps, so that each piece is smooth up to both its ends."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.groups import Groups, Numbers
from vibrafeed.core.motion.waves import ALONG, ENDS, TURN, Wave, step_speeds

Three = tuple[Numbers, Numbers, Numbers]


@dataclass(frozen=True)
class Sine:
    """The plain sine of a drive; `numbers` are its amplitudes along, across and normal, in g."""

    numbers: tuple[float, float, float]

    def push(self, phase: Numbers) -> Three:
        """Return the push along, across and normal at a phase in rad, in g."""
        sine = np.sin(phase)
        along, across, normal = self.numbers
        return along * sine, across * sine, normal * sine

    def speed(self, phase: Numbers) -> Numbers:
        """Return the velocity of the track along at a phase."""
        return self.numbers[ALONG] * np.cos(phase)

    @property
    def order(self) -> int:
        """The highest harmonic order of the drive."""
        return 1

    @property
    def steepest(self) -> float:
        """An upper bound of the push's slope."""
        return math.hypot(*self.numbers)


@dataclass(frozen=True)
class Piece:
    """A stretch of a wave without a jump: its harmonics, and one level of its steps.

    Attributes
    ----------
    harmonics
        Coefficients of sin(k tau) and cos(k tau) on three axes in g, shape (3, 2, orders).
    level
        Push of the step on three axes in g.
    start, track
        A phase in rad, and the velocity that the steps give the track along there, in g/w.
    """

    harmonics: Array
    level: tuple[float, float, float] = (0.0, 0.0, 0.0)
    start: float = 0.0
    track: float = 0.0

    @cached_property
    def orders(self) -> Array:
        """The harmonic orders in the drive."""
        return np.arange(1.0, self.order + 1.0)

    def push(self, phase: Numbers) -> Three:
        """Return the drive acceleration along, across and normal at a phase in rad, in g.

        Of one smooth piece of the drive: sums of sines, plus its constant level. `phase` may be an
        array; the three results have its shape.
        """
        if not self.order:
            along, across, normal = (level + 0.0 * phase for level in self.level)
            return along, across, normal
        turned = np.multiply.outer(self.orders, phase)
        waves = np.tensordot(self.harmonics, [np.sin(turned), np.cos(turned)], ([1, 2], [0, 1]))
        along, across, normal = (
            wave + level for wave, level in zip(waves, self.level, strict=True)
        )
        return along, across, normal

    def speed(self, phase: Numbers) -> Numbers:
        """Return the velocity of the track along itself at a phase in rad, in g/w.

        Here w = 2 pi f, f being the frequency of the drive.
        """
        turned = np.multiply.outer(self.orders, phase)
        sine, cosine = self.harmonics[ALONG] / self.orders
        waves = np.tensordot(sine, np.cos(turned), 1) - np.tensordot(cosine, np.sin(turned), 1)
        return waves + self.track - self.level[ALONG] * (phase - self.start)

    @property
    def order(self) -> int:
        """The highest harmonic order of the drive."""
        return int(self.harmonics.shape[2])

    @property
    def steepest(self) -> float:
        """An upper bound of the push's slope."""
        return float(np.hypot(*np.moveaxis(self.harmonics, 1, 0)).sum(axis=0) @ self.orders)


def pieces(groups: Groups, begin: float, end: float) -> Iterator[tuple[Sine | Piece, float]]:
    """Yield the drive of one part between its jumps, with the phase of each end.

    From the phase `begin` to `end` in rad; each piece is smooth up to both its ends, as an
    integrator needs it. `groups` are the part's dimensionless numbers; a sine is a single piece.
    """
    p = groups
    if p.wave is None:
        yield Sine((p.drive_number_along, p.drive_number_across, p.drive_number_normal)), end
    else:
        yield from pieces_of(p.wave, begin, end)


def pieces_of(wave: Wave, begin: float, end: float) -> Iterator[tuple[Piece, float]]:
    """Yield the smooth pieces of the drive of one cell, each with the phase at its end in rad.

    A drive in steps jumps between its levels; integrators must stop there. `wave` is the drive, and
    the pieces cover the phases from `begin` to `end` in rad. A drive without steps is one piece.
    """
    if not wave.steps.shape[1]:
        yield Piece(wave.harmonics), end
        return
    ends, speeds = wave.steps[ENDS].tolist(), step_speeds(wave, ALONG).tolist()
    levels = [tuple(level) for level in wave.steps[:ENDS].T.tolist()]
    turn = math.floor(begin / TURN)
    while True:
        for number, level in enumerate(levels):
            start = turn * TURN + (ends[number - 1] if number else 0.0)
            stop = turn * TURN + ends[number]
            if stop > max(begin, start):
                yield Piece(wave.harmonics, level, start, speeds[number]), min(stop, end)
                if stop >= end:
                    return
        turn += 1
