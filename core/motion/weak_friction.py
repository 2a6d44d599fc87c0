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
        known = {
            "velocity": limit.along, "across": limit.across, "error": limit.error,
            "forward": limit.forward, "backward": 1.0 - limit.forward, "multiple": 1.0,
            "status": STATUS["weak_friction"],
        }  # fmt: skip
        for name, field in fields.items():
            field[cell] = known.get(name, 0.0)
    return Motion(**{name: field.reshape(shape) for name, field in fields.items()})


def limit_of(part: Groups) -> Limit | None:
    """Return the velocity of one part under weak friction; None where it is not known.

    It is not of a part that hops or runs away, and of friction that is not weak.
    """
    if not np.isfinite(sum(part.numbers)) or part.friction_kinetic <= 0.0:
        return None
    cell, coarse = _Averaged.of(part, INTERVALS), _Averaged.of(part, INTERVALS // 2)
    if cell.pull.min() <= 0.0:
        return None
    # Means have errors of the second order in the length of the intervals.
    first, half = cell.balance(np.zeros(1)), coarse.balance(np.zeros(1))
    refined = (first - half) / 3.0
    velocity, before = np.zeros(2), np.zeros(2)
    moved = np.zeros((2, cell.pull.size))
    for _ in range(ROUNDS):
        before, velocity = velocity, cell.balance(moved)
        force = cell.force(velocity, moved)
        moved = waves.TURN * (np.cumsum(force, axis=1) - 0.5 * force)
        moved -= (moved * cell.share).sum(axis=1, keepdims=True)
    swing = float(np.hypot(*np.ptp(moved, axis=1)))
    if not (swing <= WEAK * cell.size and np.isfinite(refined).all()):
        return None
    error = float(np.abs(velocity - before).max() + np.abs(refined).max()) + swing**2 / cell.size
    relative = cell.track[0, 1:] - velocity[0] - moved[0]
    along, across = map(float, velocity + refined)
    return Limit(along, across, error, float(cell.share[relative < 0.0].sum()))


class _Averaged(NamedTuple):
    """Friction on one part over a period: `track` at the ends of intervals, `pull` mu n in each."""

    track: Array
    share: Array
    pull: Array
    slope: float
    size: float

    @classmethod
    def of(cls, part: Groups, intervals: int) -> "_Averaged":
        wave = part.wave
        if wave is None:
            harmonics = np.zeros((3, 2, 1))
            harmonics[:, 0, 0] = part.drive
            wave = waves.Wave(harmonics, np.zeros((4, 0)))
        ends = np.union1d(np.linspace(0.0, waves.TURN, intervals + 1), wave.steps[waves.ENDS])
        share = np.diff(ends) / waves.TURN
        push = waves.push(wave, waves.NORMAL, 0.5 * (ends[1:] + ends[:-1]))
        return cls(
            np.stack([waves.speed(wave, axis, ends) for axis in (waves.ALONG, waves.ACROSS)]),
            share,
            share * part.friction_kinetic * (part.gravity_number_normal - push),
            float(part.gravity_number_along),
            float(waves.size(wave)),
        )

    def force(self, velocity: Array, moved: Array) -> Array:
        """Return friction less slope in each interval, at a velocity and what it moves by."""
        slope = np.array([[self.slope], [0.0]]) * self.share
        ends = self.track - velocity[:, np.newaxis]
        return self.pull * _mean_direction(ends[:, :-1] - moved, ends[:, 1:] - moved) - slope

    def balance(self, moved: Array) -> Array:
        """Return the velocity at which all forces of a period are in balance; NaN without any."""

        def total(velocity: Array) -> Array:
            return np.asarray(self.force(velocity, moved).sum(axis=1))

        if self.track[1].any():
            middle = 0.5 * (self.track[:, 1:] + self.track[:, :-1])
            start = (middle * self.pull).sum(axis=1) / self.pull.sum() + OFFSET * self.size
            found = scipy.optimize.root(total, start, tol=1e-13)
            is_balanced = np.abs(found.fun).max() <= BALANCED * self.pull.sum()
            return np.where(is_balanced, found.x, np.nan)

        def on_line(velocity: float) -> float:
            return float(total(np.array([velocity, 0.0]))[0])

        low, high = float(self.track.min()), float(self.track.max())
        if not on_line(low) > 0.0 > on_line(high):
            return np.full(2, np.nan)
        return np.array(
            [scipy.optimize.brentq(on_line, low, high, xtol=1e-15 * max(high, -low)), 0.0]
        )


def _mean_direction(start: Array, end: Array) -> Array:
    """Return the mean of r/|r| over straight ways from `start` to `end`, shape (2, intervals).

    With the unit vector d along a way, r = s d + h: the mean of s/|r| is (s1 + s0)/(|r1| + |r0|),
    that of h/|r| is h (asinh(s1/h) - asinh(s0/h))/(s1 - s0).
    """
    way = end - start
    length = _size(way)
    d = way / length
    s0, s1 = (d * start).sum(axis=0), (d * end).sum(axis=0)
    along = (s1 + s0) / (_size(start) + _size(end))
    offset = start - s0 * d
    h = _size(offset)
    off = (np.arcsinh(s1 / h) - np.arcsinh(s0 / h)) / length
    return np.asarray(along * d + off * offset)


def _size(vectors: Array) -> Array:
    return np.sqrt(np.square(vectors).sum(axis=0)) + TINY
