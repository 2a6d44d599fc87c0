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
        for part, own_axes in zip(self, (3, 2), strict=True):
            axes, cells = part.shape[:own_axes], part.shape[own_axes:]
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
    total = _harmonic_integral(wave, axis, tau, 0)
    return total + _at_step(wave, wave.steps[axis], tau) if wave.steps.shape[1] else total


def speed(wave: Wave, axis: int, phase: ArrayLike) -> Array:
    """Return the velocity of the track along an axis at a phase, in g/w, w = 2 pi f; no mean."""
    return _track_integral(wave, axis, phase, 1)


def position_at(wave: Wave, axis: int, phase: ArrayLike) -> Array:
    """Return the displacement of the track along an axis at a phase, in g/w^2; no mean."""
    return _track_integral(wave, axis, phase, 2)


def velocity_at(wave: Wave, axis: int, phase: ArrayLike) -> Array:
    """Return the velocity of the track along an axis at a phase, in g/w; no mean."""
    return _track_integral(wave, axis, phase, 1)


def _track_integral(wave: Wave, axis: int, phase: ArrayLike, integrals: int) -> Array:
    tau = np.asarray(phase, dtype=float)
    total = -_harmonic_integral(wave, axis, tau, integrals)
    if wave.steps.shape[1]:
        total = total + _step_motion(wave, axis, tau)[integrals - 1]
    return total


def _harmonic_integral(wave: Wave, axis: int, tau: Array, integrals: int) -> Array:
    # The sines of the push, integrated over the phase so often; -1 is the derivative.
    total = np.zeros(np.broadcast_shapes(tau.shape, wave.harmonics.shape[3:]))
    for k, (sine, cosine) in enumerate(zip(*wave.harmonics[axis], strict=True), start=1):
        angle = k * tau - integrals * np.pi / 2
        total += (sine * np.sin(angle) + cosine * np.cos(angle)) / k**integrals
    return total


def _at_step(wave: Wave, values: Array, tau: Array) -> Array:
    # Of values of all steps, shape (steps, ...), those in force at phases of any turn.
    phase = np.mod(tau, TURN)
    ends = wave.steps[ENDS]
    shape = np.broadcast_shapes(phase.shape, ends.shape[1:])
    step = np.zeros(shape, dtype=np.intp)
    for end in ends[:-1]:
        step += phase >= end
    missing = (1,) * (len(shape) - values.ndim + 1)
    spread_values = values.reshape(len(values), *missing, *values.shape[1:])
    spread_values = np.broadcast_to(spread_values, (len(values), *shape))
    return np.take_along_axis(spread_values, step[np.newaxis], axis=0)[0]


def _step_motion(wave: Wave, axis: int, tau: Array) -> tuple[Array, Array]:
    # Velocity and displacement by the steps, without mean.
    level, ends = wave.steps[axis], wave.steps[ENDS]
    starts = np.concatenate([np.zeros_like(ends[:1]), ends[:-1]])
    duration = ends - starts
    speeds = step_speeds(wave, axis)
    displacements = np.cumsum(speeds * duration - level * duration**2 / 2, axis=0)
    start_places = np.concatenate([np.zeros_like(displacements[:1]), displacements[:-1]])
    mean = (start_places * duration + speeds * duration**2 / 2 - level * duration**3 / 6).sum(
        axis=0
    ) / TURN
    step_start, level_now, velocity_now, place_now = (
        _at_step(wave, values, tau) for values in (starts, level, speeds, start_places - mean)
    )
    elapsed = np.mod(tau, TURN) - step_start
    return (
        velocity_now - level_now * elapsed,
        place_now + velocity_now * elapsed - level_now * elapsed**2 / 2,
    )


def step_speeds(wave: Wave, axis: int) -> Array:
    """Return the velocity of the track at the start of each step, shape (steps, ...), in g/w."""
    level, ends = wave.steps[axis], wave.steps[ENDS]
    duration = np.diff(ends, axis=0, prepend=0.0)
    speed_after = -np.cumsum(level * duration, axis=0)
    speed_before = np.concatenate([np.zeros_like(speed_after[:1]), speed_after[:-1]])
    mean = (speed_before * duration - level * duration**2 / 2).sum(axis=0) / TURN
    return speed_before - mean


# --- how much


def largest_over_period(wave: Wave, axis: int, of: str) -> Array:
    """Return the largest value over a period of a quantity of the drive, shape (cells,).

    `of` is a key of `COURSES`. Every extreme is looked at, so the value is exact to rounding: of
    sines those where the derivative, a polynomial in exp(i tau), is 0; of steps their ends, and
    where the track turns between them. A wave of both sines and steps has extremes that are not
    looked at.
    """
    function, _ = COURSES[of]
    largest = np.full(wave.cells, -np.inf)
    for phase in _extremes(wave, axis, of):
        largest = np.fmax(largest, function(wave, axis, phase))
    return np.where(largest > -np.inf, largest, np.nan)


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
    "jerk size": (
        lambda wave, axis, at: np.abs(_harmonic_integral(wave, axis, np.asarray(at), -1)),
        -1,
    ),
}
"""Quantities that have a largest value: a function of wave, axis and phase, and how often it
integrates the push."""


def _extremes(wave: Wave, axis: int, of: str) -> Iterator[Array]:
    # Phases at which the quantity may be largest: turns of the sines, ends of steps, and within a
    # step the phase at which the track stands still.
    if wave.harmonics.shape[2]:
        yield from _turning_phases(wave, axis, COURSES[of][1])
    start = np.zeros(())
    for step, end in enumerate(wave.steps[ENDS]):
        yield start
        if of.startswith("place"):  # the track turns where its speed is 0
            elapsed = ratio(step_speeds(wave, axis)[step], wave.steps[axis][step], 0.0)
            yield start + np.clip(elapsed, 0.0, end - start)
        start = end


def _turning_phases(wave: Wave, axis: int, integrals: int) -> Array:
    # Phases at which the derivative of the sines, integrated so often, is 0: twice the highest
    # order of them a cell, of cells of equal order together.
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
        for chunk in np.array_split(cells, len(cells) // AT_ONCE + 1):
            phases[chunk, : 2 * order] = _root_angles(slopes[chunk, :order])
    return phases.T.reshape(-1, *shape)


def _root_angles(slopes: NDArray[np.complex128]) -> Array:
    # Roots of sum of slopes_k exp(i k tau) + conjugate as a polynomial in exp(i tau), from its
    # companion matrix; then two steps of Newton's method in tau.
    count, order = slopes.shape
    polynomials = np.concatenate([slopes[:, ::-1], np.zeros((count, 1)), slopes.conj()], axis=1)
    matrices = np.zeros((count, 2 * order, 2 * order), dtype=np.complex128)
    matrices[:, np.arange(1, 2 * order), np.arange(2 * order - 1)] = 1.0
    matrices[:, 0] = -polynomials[:, 1:] / polynomials[:, :1]
    angles = np.angle(np.linalg.eigvals(matrices))
    k = np.arange(1, order + 1)
    for _ in range(2):
        terms = slopes[:, np.newaxis] * np.exp(1j * k * angles[..., np.newaxis])
        value, slope = terms.real.sum(axis=-1), -(k * terms.imag).sum(axis=-1)
        angles = angles - np.clip(ratio(value, slope, 0.0), -NEAR, NEAR)
    return angles


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
        largest_speed = (np.hypot(*wave.harmonics[axis]) / orders).sum(axis=0)
        if wave.steps.shape[1]:
            largest_speed = largest_speed + np.abs(step_speeds(wave, axis)).max(axis=0)
        squares = squares + largest_speed**2
    return np.sqrt(squares)
