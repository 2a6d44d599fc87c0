"""Morris's screening: what changing one input does, from many places, by few evaluations.

A path starts at a random point of a lattice and changes one input after the other, each by half of
its distribution. The change of the output over that half is an elementary effect of the input. The
mean of their sizes (mu*) tells how much the input matters, their deviation (sigma) whether that
depends on where one is, by curvature or by other inputs: M. Morris, Technometrics 33 (1991) 161;
mu* by F. Campolongo et al., Environmental Modelling & Software 22 (2007) 1509. SALib has the same,
and brings pandas and matplotlib with it for these few lines.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.arrays import Array

LEVELS = 4
"""Levels of each input, in the middles of quarters of its distribution: none at an end, which may
be infinite."""
STEP = 0.5
"""Share of the distribution that a step moves through: from a level to the one two further on."""


class Effects(NamedTuple):
    """Elementary effects of each input, in the unit of the output; arrays of shape (..., inputs).

    Attributes
    ----------
    size : ndarray
        The mean of their absolute values, mu*; NaN without a value.
    deviation : ndarray
        Their standard deviation, sigma.
    """

    size: Array
    deviation: Array


class Paths(NamedTuple):
    """The points of the paths of Morris's screening.

    Attributes
    ----------
    points : ndarray, shape (inputs, paths, inputs + 1)
        Above 0 and below 1.
    changed : ndarray of int, shape (paths, inputs)
        The input that each step changes.
    signs : ndarray, shape (paths, inputs)
        1 for a step up, -1 for a step down.
    """

    points: Array
    changed: Array
    signs: Array


def paths(inputs: int, count: int, seed: int) -> Paths:
    """Return `count` random paths through the unit box for Morris's screening of inputs.

    Each begins at a random point of a grid and changes one of the inputs, by a fixed step, at each
    of its steps; the changes of the outputs are the effects of that input. Equal seeds give equal
    paths. `seed` is that of the random numbers. The result has the points, shape (inputs, paths,
    inputs + 1), the input that each step changes, and the sign of the step, shape (paths, inputs).
    """
    random = np.random.default_rng((seed, 1991))
    level = random.integers(LEVELS, size=(count, inputs))
    start = (level + 0.5) / LEVELS
    changed = random.permuted(np.tile(np.arange(inputs), (count, 1)), axis=1)
    up = np.where(level < LEVELS / 2, 1.0, -1.0)
    points = np.repeat(start[:, None, :], inputs + 1, axis=1)
    rows = np.arange(count)
    for step in range(inputs):
        which = changed[:, step]
        points[rows, step + 1 :, which] += (STEP * up[rows, which])[:, None]
    signs = np.take_along_axis(up, changed, axis=1)
    return Paths(np.moveaxis(points, 2, 0), changed, signs)


def effects_of(values: Array, along: Paths) -> Effects:
    """Return size and deviation of the effect of each input on outputs, by Morris's screening.

    Each step of a path changes one input; the change of the output over the step is its effect.
    Size is the mean of its absolute value, deviation its standard deviation over the paths.

    Parameters
    ----------
    values : ndarray, shape (..., paths, inputs + 1)
        The outputs at the points of the paths; NaN where there is none: then the steps from and to
        that point are left out.
    along : Paths
        The paths, as `paths` gives them.

    Returns
    -------
    Effects
        Arrays of shape (..., inputs).
    """
    steps = np.diff(values, axis=-1) * along.signs / STEP
    order = np.broadcast_to(np.argsort(along.changed, axis=-1), steps.shape)
    effects = np.take_along_axis(steps, order, axis=-1)
    known = np.isfinite(effects)
    count = known.sum(axis=-2)
    effects = np.where(known, effects, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        size = np.abs(effects).sum(axis=-2) / count
        mean = effects.sum(axis=-2) / count
        away = np.where(known, effects - mean[..., None, :], 0.0)
        deviation = np.sqrt((away**2).sum(axis=-2) / (count - 1))
    return Effects(np.where(count > 0, size, np.nan), np.where(count > 1, deviation, np.nan))
