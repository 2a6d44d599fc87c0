"""Weak friction: the velocity of a part that the drive hardly changes in a period (theory 13.13).

The forces of a period are in balance,

    mean of mu n(t) r/|r| = gravity along the slope,    r = v_track(t) - v - dv(t).

Without dv this is the geometric median of the track's velocity, weighted with the load n; on a line
the weighted median. dv is the change of the velocity by these forces within the period. Motions
that do not settle within the periods that they are followed for have this velocity.
"""

from typing import NamedTuple

import numpy as np
import scipy

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion import waves
from vibrafeed.core.motion.method import STATUS, Groups, Motion, cells_of, each, groups_of

INTERVALS = 4096
"""Of a period, over which the means are taken, and again over half as many."""
ROUNDS = 3
"""Times that the change of the velocity within a period is computed; each gains its size."""
BALANCED = 1e-9
"""Of all friction: what the sum of the forces may leave."""
OFFSET = np.array([0.006, -0.008])
"""Of the drive's speed: where the search begins, as no slopes are known on a straight track."""
TINY = 1e-300  # against a division by 0
WEAK = 0.05
"""Change of the velocity within a period, over the drive's, up to which friction is weak."""


class Limit(NamedTuple):
    """Velocity along and across [g/w], its error, the share of slip forward."""

    along: float
    across: float
    error: float
    forward: float


def with_limits(motion: Motion, groups: Groups) -> Motion:
    """Return the motion with that of weak friction where `max_periods` came before a cycle.

    The slope of the groups is along x.
    """
    status = np.ravel(motion.status)
    (cells,) = np.nonzero(status == STATUS["limit_reached"])
    if not cells.size:
        return motion
    rows, shape = cells_of(groups)
    parts, _ = each(groups_of(rows[cells], groups.wave is not None)[0])
    fields = {name: np.array(field).reshape(-1) for name, field in motion._asdict().items()}
    for cell, part in zip(cells, parts, strict=True):
        limit = limit_of(part)
        if limit is None:
            continue
        values = {
            "velocity": limit.along, "across": limit.across, "error": limit.error,
            "forward": limit.forward, "backward": 1.0 - limit.forward, "multiple": 1.0,
            "status": STATUS["weak_friction"],
        }  # fmt: skip
        for name, field in fields.items():
            field[cell] = values.get(name, 0.0)
    return Motion(**{name: field.reshape(shape) for name, field in fields.items()})


def limit_of(part: Groups) -> Limit | None:
    """Return the velocity of one part under weak friction; None where it is not known.

    It is not of a part that hops or runs away, and of friction that is not weak.
    """
    if not np.isfinite(sum(part.numbers)) or part.friction_kinetic <= 0.0:
        return None
    fine, coarse = _AveragedFriction.of(part, INTERVALS), _AveragedFriction.of(part, INTERVALS // 2)
    if fine.pull.min() <= 0.0:
        return None
    # Means have errors of the second order in the length of the intervals.
    fine_velocity, coarse_velocity = fine.balance(np.zeros(1)), coarse.balance(np.zeros(1))
    correction = (fine_velocity - coarse_velocity) / 3.0
    velocity, previous = np.zeros(2), np.zeros(2)
    velocity_change = np.zeros((2, fine.pull.size))
    for _ in range(ROUNDS):
        previous, velocity = velocity, fine.balance(velocity_change)
        force = fine.force(velocity, velocity_change)
        velocity_change = waves.TURN * (np.cumsum(force, axis=1) - 0.5 * force)
        velocity_change -= (velocity_change * fine.fraction).sum(axis=1, keepdims=True)
    largest_change = float(np.hypot(*np.ptp(velocity_change, axis=1)))
    if not (largest_change <= WEAK * fine.size and np.isfinite(correction).all()):
        return None
    error = (
        float(np.abs(velocity - previous).max() + np.abs(correction).max())
        + largest_change**2 / fine.size
    )
    relative = fine.track[0, 1:] - velocity[0] - velocity_change[0]
    along, across = map(float, velocity + correction)
    return Limit(along, across, error, float(fine.fraction[relative < 0.0].sum()))


class _AveragedFriction(NamedTuple):
    """Friction on one part over a period: `track` at the ends of intervals, `pull` mu n in each."""

    track: Array
    fraction: Array
    pull: Array
    slope: float
    size: float

    @classmethod
    def of(cls, part: Groups, intervals: int) -> "_AveragedFriction":
        # From the drive of a part, at the ends of equal intervals and at those of its steps.
        wave = part.wave
        if wave is None:
            harmonics = np.zeros((3, 2, 1))
            harmonics[:, 0, 0] = part.drive
            wave = waves.Wave(harmonics, np.zeros((4, 0)))
        ends = np.union1d(np.linspace(0.0, waves.TURN, intervals + 1), wave.steps[waves.ENDS])
        fraction = np.diff(ends) / waves.TURN
        push = waves.push(wave, waves.NORMAL, 0.5 * (ends[1:] + ends[:-1]))
        return cls(
            np.stack([waves.speed(wave, axis, ends) for axis in (waves.ALONG, waves.ACROSS)]),
            fraction,
            fraction * part.friction_kinetic * (part.gravity_number_normal - push),
            float(part.gravity_number_along),
            float(waves.size(wave)),
        )

    def force(self, velocity: Array, velocity_change: Array) -> Array:
        """Return friction less slope in each interval, at a velocity and what it moves by."""
        slope = np.array([[self.slope], [0.0]]) * self.fraction
        ends = self.track - velocity[:, np.newaxis]
        return (
            self.pull
            * _mean_direction(ends[:, :-1] - velocity_change, ends[:, 1:] - velocity_change)
            - slope
        )

    def balance(self, velocity_change: Array) -> Array:
        """Return the velocity at which all forces of a period are in balance; NaN without any."""

        def total(velocity: Array) -> Array:
            return np.asarray(self.force(velocity, velocity_change).sum(axis=1))

        if self.track[1].any():
            middle = 0.5 * (self.track[:, 1:] + self.track[:, :-1])
            start = (middle * self.pull).sum(axis=1) / self.pull.sum() + OFFSET * self.size
            solution = scipy.optimize.root(total, start, tol=1e-13)
            is_balanced = np.abs(solution.fun).max() <= BALANCED * self.pull.sum()
            return np.where(is_balanced, solution.x, np.nan)

        def on_line(velocity: float) -> float:
            return float(total(np.array([velocity, 0.0]))[0])

        low, high = float(self.track.min()), float(self.track.max())
        if not on_line(low) > 0.0 > on_line(high):
            return np.full(2, np.nan)
        return np.array(
            [scipy.optimize.brentq(on_line, low, high, xtol=1e-15 * max(high, -low)), 0.0]
        )


def _mean_direction(start: Array, end: Array) -> Array:
    # The mean of r/|r| over straight chords from `start` to `end`, shape (2, intervals). With the
    # unit vector d along a chord, r = s d + h: the mean of s/|r| is (s1 + s0)/(|r1| + |r0|), that
    # of h/|r| is h (asinh(s1/h) - asinh(s0/h))/(s1 - s0).
    chord = end - start
    length = _size(chord)
    d = chord / length
    s0, s1 = (d * start).sum(axis=0), (d * end).sum(axis=0)
    along_mean = (s1 + s0) / (_size(start) + _size(end))
    offset = start - s0 * d
    h = _size(offset)
    offset_mean = (np.arcsinh(s1 / h) - np.arcsinh(s0 / h)) / length
    return np.asarray(along_mean * d + offset_mean * offset)


def _size(vectors: Array) -> Array:
    return np.sqrt(np.square(vectors).sum(axis=0)) + TINY
