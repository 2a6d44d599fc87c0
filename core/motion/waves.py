"""Drives that are no plain sine: the push on a part over a period, and how the track moves.

The push is minus the acceleration of the track, per weight. With phase tau = w t it is on each axis

    push(tau) = sum over k of s_k sin(k tau) + c_k cos(k tau) + level(tau),

where the level is constant from step to step. In the scales of the motion (g/w, g/w^2) the track
then has the velocity and the displacement whose second derivative is minus that, both without mean.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics.arrays import Array, ratio

TURN = 2 * np.pi
ALONG, ACROSS, NORMAL, ENDS = range(4)
"""Rows of `Wave.steps`; the first three are axes of both fields."""

TINY = 1e-14
"""Share of the largest coefficient of a slope, below which a higher order moves no extreme."""

AT_ONCE, NEAR = 4096, 0.01
"""Cells whose extremes are computed together, and the largest step of Newton's in rad."""


class Wave(NamedTuple):
    """The push of a drive per weight, in each of many cells; cells broadcast from the right.

    Attributes
    ----------
    harmonics : ndarray, shape (3, 2, orders, ...)
        Coefficients of sin(k tau) and of cos(k tau), k from 1, along, across and normal.
    steps : ndarray, shape (4, steps, ...)
        Levels along, across and normal, and the phase at which each step ends; the last at 2 pi.
        Either field may hold nothing; a wave has at least one of them.
    """

    harmonics: Array
    steps: Array

    @property
    def cells(self) -> tuple[int, ...]:
        """The shape of the cells."""
        return np.broadcast_shapes(self.harmonics.shape[3:], self.steps.shape[2:])

    def columns(self, shape: tuple[int, ...]) -> NDArray[np.float64]:
        """Return the wave as a table with one row per cell, as compiled code takes it.

        A row has the numbers of harmonics and of steps, then the coefficients of both. The wave is
        broadcast to the `shape` of the cells; the rows are in its order.
        """
        counts = np.empty((2, *shape))
        counts[0], counts[1] = self.harmonics.shape[2], self.steps.shape[1]
        parts = [counts]
        for part, own in zip(self, (3, 2), strict=True):
            axes, cells = part.shape[:own], part.shape[own:]
            aligned = part.reshape(*axes, *(1,) * (len(shape) - len(cells)), *cells)
            parts.append(np.broadcast_to(aligned, (*axes, *shape)))
        return np.concatenate([part.reshape(-1, np.prod(shape, dtype=int)) for part in parts]).T


def of_columns(rows: NDArray[np.float64]) -> Wave:
    """Return the wave of many cells, of shape (rows,), from the table of `Wave.columns`."""
    orders, steps = int(rows[0, 0]), int(rows[0, 1])
    columns = rows.T[2:]
    return Wave(
        columns[: 6 * orders].reshape(3, 2, orders, len(rows)),
        columns[6 * orders :].reshape(4, steps, len(rows)),
    )


# --- how the track moves


# `axis` is `ALONG`, `ACROSS` or `NORMAL`, `phase` in rad; phases and cells of the wave broadcast.


def push(wave: Wave, axis: int, phase: ArrayLike) -> Array:
    """Return the push at a phase along an axis, in g."""
    tau = np.asarray(phase, dtype=float)
    total = _harmonic(wave, axis, tau, 0)
    return total + _at_step(wave, wave.steps[axis], tau) if wave.steps.shape[1] else total


def speed(wave: Wave, axis: int, phase: ArrayLike) -> Array:
    """Return the velocity of the track along an axis at a phase, in g/w, w = 2 pi f; no mean."""
    return _moved(wave, axis, phase, 1)


def position_at(wave: Wave, axis: int, phase: ArrayLike) -> Array:
    """Return the displacement of the track along an axis at a phase, in g/w^2; no mean."""
    return _moved(wave, axis, phase, 2)


def _moved(wave: Wave, axis: int, phase: ArrayLike, integrals: int) -> Array:
    tau = np.asarray(phase, dtype=float)
    total = -_harmonic(wave, axis, tau, integrals)
    if wave.steps.shape[1]:
        total = total + _stepped(wave, axis, tau)[integrals - 1]
    return total


def _harmonic(wave: Wave, axis: int, tau: Array, integrals: int) -> Array:
    # The sines of the push, integrated over the phase so often; -1 is the derivative.
    total = np.zeros(np.broadcast_shapes(tau.shape, wave.harmonics.shape[3:]))
    for k, (sine, cosine) in enumerate(zip(*wave.harmonics[axis], strict=True), start=1):
        turned = k * tau - integrals * np.pi / 2
        total += (sine * np.sin(turned) + cosine * np.cos(turned)) / k**integrals
    return total


def _at_step(wave: Wave, values: Array, tau: Array) -> Array:
    # Of values of all steps, shape (steps, ...), those in force at phases of any turn.
    within = np.mod(tau, TURN)
    ends = wave.steps[ENDS]
    shape = np.broadcast_shapes(within.shape, ends.shape[1:])
    step = np.zeros(shape, dtype=np.intp)
    for end in ends[:-1]:
        step += within >= end
    missing = (1,) * (len(shape) - values.ndim + 1)
    shown = values.reshape(len(values), *missing, *values.shape[1:])
    shown = np.broadcast_to(shown, (len(values), *shape))
    return np.take_along_axis(shown, step[np.newaxis], axis=0)[0]


def _stepped(wave: Wave, axis: int, tau: Array) -> tuple[Array, Array]:
    # Velocity and displacement by the steps, without mean.
    level, ends = wave.steps[axis], wave.steps[ENDS]
    starts = np.concatenate([np.zeros_like(ends[:1]), ends[:-1]])
    last = ends - starts
    speeds = step_speeds(wave, axis)
    moved = np.cumsum(speeds * last - level * last**2 / 2, axis=0)
    places = np.concatenate([np.zeros_like(moved[:1]), moved[:-1]])
    mean = (places * last + speeds * last**2 / 2 - level * last**3 / 6).sum(axis=0) / TURN
    start, here, velocity, at = (
        _at_step(wave, one, tau) for one in (starts, level, speeds, places - mean)
    )
    since = np.mod(tau, TURN) - start
    return velocity - here * since, at + velocity * since - here * since**2 / 2


def step_speeds(wave: Wave, axis: int) -> Array:
    """Return the velocity of the track at the start of each step, shape (steps, ...), in g/w."""
    level, ends = wave.steps[axis], wave.steps[ENDS]
    last = np.diff(ends, axis=0, prepend=0.0)
    after = -np.cumsum(level * last, axis=0)
    before = np.concatenate([np.zeros_like(after[:1]), after[:-1]])
    mean = (before * last - level * last**2 / 2).sum(axis=0) / TURN
    return before - mean


# --- how much


def largest_over_period(wave: Wave, axis: int, of: str) -> Array:
    """Return the largest value over a period of a quantity of the drive, shape (cells,).

    `of` is a key of `COURSES`. Every extreme is looked at, so the value is exact to rounding: of
    sines those where the derivative, a polynomial in exp(i tau), is 0; of steps their ends, and
    where the track turns between them. A wave of both sines and steps has extremes that are not
    looked at.
    """
    function, _ = COURSES[of]
    best = np.full(wave.cells, -np.inf)
    for phase in _extremes(wave, axis, of):
        best = np.fmax(best, function(wave, axis, phase))
    return np.where(best > -np.inf, best, np.nan)


def stroke(wave: Wave, axis: int) -> Array:
    """Return the stroke of the track along an axis, peak to peak, in g/w^2, w = 2 pi f."""
    return largest_over_period(wave, axis, "place") + largest_over_period(wave, axis, "place back")


def jerk(wave: Wave, axis: int) -> Array:
    """Return the largest jerk along an axis, in g per rad of phase; infinite if the push jumps."""
    if wave.steps.shape[1]:
        jumps = largest_over_period(wave, axis, "push") + largest_over_period(
            wave, axis, "push back"
        )
        return np.where(jumps > 0.0, np.inf, jumps)
    return largest_over_period(wave, axis, "jerk size")


COURSES: dict[str, tuple[Callable[[Wave, int, ArrayLike], Array], int]] = {
    "push": (push, 0),
    "push back": (lambda *at: -push(*at), 0),
    "push size": (lambda *at: np.abs(push(*at)), 0),
    "speed": (lambda *at: np.abs(speed(*at)), 1),
    "place": (position_at, 2),
    "place back": (lambda *at: -position_at(*at), 2),
    "jerk size": (lambda wave, axis, at: np.abs(_harmonic(wave, axis, np.asarray(at), -1)), -1),
}
"""Quantities that have a largest value: a function of wave, axis and phase, and how often it
integrates the push."""


def _extremes(wave: Wave, axis: int, of: str) -> Iterator[Array]:
    if wave.harmonics.shape[2]:
        yield from _turns(wave, axis, COURSES[of][1])
    start = np.zeros(())
    for number, end in enumerate(wave.steps[ENDS]):
        yield start
        if of.startswith("place"):  # the track turns where its speed is 0
            since = ratio(step_speeds(wave, axis)[number], wave.steps[axis][number], 0.0)
            yield start + np.clip(since, 0.0, end - start)
        start = end


def _turns(wave: Wave, axis: int, integrals: int) -> Array:
    sines, cosines = wave.harmonics[axis]
    orders = np.arange(1, len(sines) + 1).reshape(-1, *(1,) * (sines.ndim - 1))
    shape = wave.cells
    slopes = (cosines - 1j * sines) * (-1j) ** (integrals - 1) * orders ** (1.0 - integrals)
    slopes = np.broadcast_to(slopes, (len(sines), *shape)).reshape(len(sines), -1).T
    sizes = np.abs(slopes)
    counts = (sizes > TINY * sizes.max(axis=1, keepdims=True)) * orders.ravel()
    highest = counts.max(axis=1)
    phases = np.zeros((len(slopes), 2 * len(sines)))
    for order in set(highest[highest > 0].tolist()):
        (cells,) = np.nonzero(highest == order)
        for some in np.array_split(cells, len(cells) // AT_ONCE + 1):
            phases[some, : 2 * order] = _angles(slopes[some, :order])
    return phases.T.reshape(-1, *shape)


def _angles(slopes: NDArray[np.complex128]) -> Array:
    count, order = slopes.shape
    rows = np.concatenate([slopes[:, ::-1], np.zeros((count, 1)), slopes.conj()], axis=1)
    matrices = np.zeros((count, 2 * order, 2 * order), dtype=np.complex128)
    matrices[:, np.arange(1, 2 * order), np.arange(2 * order - 1)] = 1.0
    matrices[:, 0] = -rows[:, 1:] / rows[:, :1]
    at = np.angle(np.linalg.eigvals(matrices))
    k = np.arange(1, order + 1)
    for _ in range(2):
        turning = slopes[:, np.newaxis] * np.exp(1j * k * at[..., np.newaxis])
        value, slope = turning.real.sum(axis=-1), -(k * turning.imag).sum(axis=-1)
        at = at - np.clip(ratio(value, slope, 0.0), -NEAR, NEAR)
    return at


def bound(wave: Wave, axis: int) -> Array:
    """Return an upper bound of the push along an axis, in g: the sum of its amplitudes."""
    amplitudes = np.hypot(*wave.harmonics[axis]).sum(axis=0)
    return amplitudes + np.abs(wave.steps[axis]).max(axis=0, initial=0.0)


def size(wave: Wave) -> Array:
    """Return an upper bound of the speed of the track over a period, in g/w, with w = 2 pi f.

    The root of the sum of squares of bounds on the three axes; on each, the sum of the amplitudes
    of all sines and the largest speed of the steps.
    """
    squares = np.zeros(wave.cells)
    orders = np.arange(1, wave.harmonics.shape[2] + 1).reshape(
        -1, *(1,) * (wave.harmonics.ndim - 3)
    )
    for axis in (ALONG, ACROSS, NORMAL):
        most = (np.hypot(*wave.harmonics[axis]) / orders).sum(axis=0)
        if wave.steps.shape[1]:
            most = most + np.abs(step_speeds(wave, axis)).max(axis=0)
        squares = squares + most**2
    return np.sqrt(squares)
