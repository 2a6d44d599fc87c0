"""Drives that are no plain sine: the push on a part over a period, and how the track moves.

The push is minus the acceleration of the track, per weight. With phase tau = w t it is on each axis

    push(tau) = sum over k of s_k sin(k tau) + c_k cos(k tau) + level(tau),

where the level is constant from step to step. In the scales of the motion (g/w, g/w^2) the track
then has the velocity and the displacement whose second derivative is minus that, both without mean.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.mechanics.arrays import Array

TURN = 2 * np.pi
ALONG, ACROSS, NORMAL, ENDS = range(4)
"""Rows of `Wave.steps`; the first three are axes of both fields."""

LOOKS = 16
"""At a wave's values, a period of its highest order, before the largest is closed in on."""


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
        """Shape of the cells."""
        return np.broadcast_shapes(self.harmonics.shape[3:], self.steps.shape[2:])

    def columns(self, shape: tuple[int, ...]) -> NDArray[np.float64]:
        """Return one row a cell of a shape: the two counts, then harmonics and steps."""
        parts = [np.broadcast_to(part, (*part.shape[: 3 - i], *shape)) for i, part in
                 enumerate(self)]  # fmt: skip
        counts = np.empty((2, *shape))
        counts[0], counts[1] = self.harmonics.shape[2], self.steps.shape[1]
        flat = [part.reshape(-1, np.prod(shape, dtype=int)) for part in (counts, *parts)]
        return np.concatenate(flat).T


def of_columns(rows: NDArray[np.float64]) -> Wave:
    """Return the wave of rows as `Wave.columns` gives them, its cells one row."""
    orders, steps = int(rows[0, 0]), int(rows[0, 1])
    columns = rows.T[2:]
    return Wave(
        columns[: 6 * orders].reshape(3, 2, orders, len(rows)),
        columns[6 * orders :].reshape(4, steps, len(rows)),
    )


def is_still(wave: Wave, axis: int) -> NDArray[np.bool_]:
    """Return in which cells the track does not move along an axis."""
    moves = np.any(wave.harmonics[axis] != 0.0, axis=(0, 1)) | np.any(
        wave.steps[axis] != 0.0, axis=0
    )
    return np.asarray(~moves)


# --- how the track moves


def push(wave: Wave, axis: int, phase: ArrayLike) -> Array:
    """Return the push at a phase; phases and cells broadcast."""
    tau = np.asarray(phase, dtype=float)
    total = _harmonic(wave, axis, tau, 0)
    return total + level(wave, axis, tau) if wave.steps.shape[1] else total


def level(wave: Wave, axis: int, phase: ArrayLike) -> Array:
    """Return what the steps of a wave add to the push at a phase."""
    tau = np.asarray(phase, dtype=float)
    if not wave.steps.shape[1]:
        return np.zeros(np.broadcast_shapes(tau.shape, wave.cells))
    return np.take_along_axis(*_at_step(wave, wave.steps[axis], tau), axis=0)[0]


def speed(wave: Wave, axis: int, phase: ArrayLike) -> Array:
    """Return the velocity of the track, in g/w."""
    tau = np.asarray(phase, dtype=float)
    total = -_harmonic(wave, axis, tau, 1)
    if wave.steps.shape[1]:
        total = total + _stepped(wave, axis, tau)[0]
    return total


def place(wave: Wave, axis: int, phase: ArrayLike) -> Array:
    """Return the displacement of the track, in g/w^2."""
    tau = np.asarray(phase, dtype=float)
    total = -_harmonic(wave, axis, tau, 2)
    if wave.steps.shape[1]:
        total = total + _stepped(wave, axis, tau)[1]
    return total


def _harmonic(wave: Wave, axis: int, tau: Array, integrals: int) -> Array:
    """Return the harmonics of the push, integrated so many times without a constant."""
    total = np.zeros(np.broadcast_shapes(tau.shape, wave.harmonics.shape[3:]))
    for k, (sine, cosine) in enumerate(zip(*wave.harmonics[axis], strict=True), start=1):
        turned = k * tau - integrals * np.pi / 2
        total += (sine * np.sin(turned) + cosine * np.cos(turned)) / k**integrals
    return total


def _at_step(wave: Wave, values: Array, tau: Array) -> tuple[Array, NDArray[np.intp]]:
    """Return values by step, broadcast over phases, and the number of the step of each."""
    within = np.mod(tau, TURN)
    ends = wave.steps[ENDS]
    shape = np.broadcast_shapes(within.shape, ends.shape[1:])
    step = np.zeros(shape, dtype=np.intp)
    for end in ends[:-1]:
        step += within >= end
    shown = values.reshape(values.shape[:1] + (1,) * (len(shape) - values.ndim + 1)
                           + values.shape[1:])  # fmt: skip
    return np.broadcast_to(shown, (values.shape[0], *shape)), step[np.newaxis]


def _stepped(wave: Wave, axis: int, tau: Array) -> tuple[Array, Array]:
    """Return velocity and displacement of a track that moves in steps, both without mean."""
    level, ends = wave.steps[axis], wave.steps[ENDS]
    starts = np.concatenate([np.zeros_like(ends[:1]), ends[:-1]])
    last = ends - starts
    speeds = step_speeds(wave, axis)
    moved = np.cumsum(speeds * last - level * last**2 / 2, axis=0)
    places = np.concatenate([np.zeros_like(moved[:1]), moved[:-1]])
    mean = (places * last + speeds * last**2 / 2 - level * last**3 / 6).sum(axis=0) / TURN
    values = [_at_step(wave, one, tau) for one in (starts, level, speeds, places - mean)]
    start, here, velocity, at = (np.take_along_axis(*one, axis=0)[0] for one in values)
    since = np.mod(tau, TURN) - start
    return velocity - here * since, at + velocity * since - here * since**2 / 2


def step_speeds(wave: Wave, axis: int) -> Array:
    """Return the velocity of the track at the start of each step, shape (steps, ...)."""
    level, ends = wave.steps[axis], wave.steps[ENDS]
    last = np.diff(ends, axis=0, prepend=0.0)
    after = -np.cumsum(level * last, axis=0)
    before = np.concatenate([np.zeros_like(after[:1]), after[:-1]])
    mean = (before * last - level * last**2 / 2).sum(axis=0) / TURN
    return before - mean


# --- how much


def largest(wave: Wave, axis: int, of: str) -> Array:
    """Return the largest value over a period of the ``"push"``, or of the ``"speed"`` either way.

    To some 1e-12 of it: the best of many looks, closed in on by parabolas.
    """
    function = {"push": push, "speed": lambda *at: np.abs(speed(*at))}[of]
    looks = max(64, LOOKS * max(1, wave.harmonics.shape[2]))
    best, at = np.full(wave.cells, -np.inf), np.zeros(wave.cells)
    for number in range(looks):
        phase = TURN * number / looks
        value = function(wave, axis, phase)
        at = np.where(value > best, phase, at)
        best = np.maximum(best, value)
    width = TURN / looks
    for _ in range(6):
        left, right = function(wave, axis, at - width), function(wave, axis, at + width)
        bend = left - 2 * best + right
        shift = np.where(bend < 0, 0.5 * width * (left - right) / np.where(bend < 0, bend, 1), 0.0)
        tried = at + np.clip(shift, -width, width)
        value = function(wave, axis, tried)
        at, best = np.where(value > best, tried, at), np.maximum(best, value)
        width = width / 8
    for step in range(wave.steps.shape[1]):  # its extremes are at its ends
        start = wave.steps[ENDS][step - 1] if step else np.zeros_like(best)
        best = np.maximum(best, function(wave, axis, start))
    return best


def bound(wave: Wave, axis: int) -> Array:
    """Return what the push never exceeds, either way: the sum of its amplitudes."""
    amplitudes = np.hypot(*wave.harmonics[axis]).sum(axis=0)
    return amplitudes + np.abs(wave.steps[axis]).max(axis=0, initial=0.0)


def size(wave: Wave) -> Array:
    """Return what the speed of the track never exceeds, in g/w: the sum of its amplitudes."""
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
