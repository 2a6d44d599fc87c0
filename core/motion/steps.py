"""The drive as time stepping takes it: by the steps of a period, with no jump inside a step."""

from __future__ import annotations

import math

import numpy as np

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.waves import ALONG, ENDS, TURN, Wave, level, push, speed

NEAR = 1e-8
"""Share of a step: if a jump of the push is nearer to the end of a step, both are moved apart. In a
step so short the rounding of the velocities would look like no solution."""

MAX_MOVES = 32
"""Most moves of the ends of steps to get them apart; more than there are jumps."""


def sines_at(steps: int, shift: float) -> Array:
    """Return sine and cosine at the middle of each step of a period, shape (1, 2, steps).

    `shift` moves the steps, in steps: -0.5 begins half a step earlier.
    """
    phases = (np.arange(steps) + 0.5 + shift) * (2.0 * math.pi / steps)
    return np.stack([np.sin(phases), np.cos(phases)])[np.newaxis]


def drives_of(wave: Wave, steps: int, begin: float) -> Array:
    """Return the drives of cells over a period, sampled for time stepping without jumps in a step.

    Shape (cells, rows, steps and jumps), with the rows of the kernels' `Drive`: push along, across
    and normal in g, speed of the track in g/w (w = 2 pi f), length of the step and its share of a
    usual one, and the number of axes on which the push jumps at its start. From the phase `begin`
    in rad; `steps` equal steps, cut where the push of the `wave` jumps.
    """
    step, jumps = TURN / steps, wave.steps[ENDS]
    starts = begin + step * np.arange(float(steps))[:, np.newaxis]
    lengths = np.full_like(starts, step)
    if jumps.size:
        parts = np.broadcast_arrays(starts, jumps[0])[0], begin + np.mod(jumps - begin, TURN)
        starts = _apart(np.sort(np.concatenate(parts), axis=0), NEAR * step, begin + TURN)
        lengths = np.diff(starts, axis=0, append=begin + TURN)
    middles, axes = starts + 0.5 * lengths, range(ENDS)
    pushes, track = [push(wave, axis, middles) for axis in axes], speed(wave, ALONG, middles)
    jumped = np.zeros(starts.shape)
    for axis in axes if jumps.size else ():
        here = level(wave, axis, middles)
        jumped += here != np.roll(here, 1, axis=0)
    rows = np.broadcast_arrays(*pushes, track, lengths, lengths / step, jumped)
    return np.ascontiguousarray(np.stack(rows).transpose(2, 0, 1))


def _apart(starts: Array, least: float, end: float) -> Array:
    """Return the phases at which time steps begin, moved so that no step is too short.

    `starts` are ascending phases in rad, shape (steps, cells); any that follows the one before by
    less than `least` is moved half-way to the next. `end` is the end of the period.
    """
    starts = starts.copy()
    for _ in range(MAX_MOVES):
        gaps = np.diff(starts, axis=0, append=end)
        near = gaps < least
        if not near.any():
            break
        starts[1:] += np.where(near[:-1], 0.5 * gaps[1:], 0.0)
        starts[-1] -= np.where(near[-1], 0.5 * gaps[-2], 0.0)
    return starts
