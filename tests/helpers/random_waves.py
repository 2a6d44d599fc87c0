"""Random drives: sums of sines with phases, and steps, along, across and normal to the floor."""

from __future__ import annotations

import numpy as np

from core.motion import waves
from core.motion.groups import Groups
from core.motion.waves import TURN, Wave


def harmonics(pick: np.random.Generator, cells: int, orders: int, across: float = 0.0) -> Wave:
    """Return waves of so many orders on each axis; `across` is how strong they are there."""
    found = np.zeros((3, 2, orders, cells))
    for axis, most in enumerate((1.0, across, 1.0)):
        size = most * np.exp(pick.uniform(np.log(0.3), np.log(3.0), cells))
        share = pick.dirichlet(np.ones(orders), cells).T * size
        phase = pick.uniform(0.0, TURN, (orders, cells))
        found[axis] = share * np.cos(phase), share * np.sin(phase)
    return Wave(found, np.zeros((4, 0, cells)))


def steps(pick: np.random.Generator, cells: int, count: int, across: float = 0.0) -> Wave:
    """Return waves of so many steps, of the same sizes."""
    last = pick.dirichlet(np.full(count, 2.0), cells).T
    found = np.zeros((4, count, cells))
    for axis, most in enumerate((1.0, across, 1.0)):
        size = most * np.exp(pick.uniform(np.log(0.3), np.log(3.0), cells))
        levels = size * pick.normal(size=(count, cells))
        found[axis] = levels - (levels * last).sum(axis=0)
    found[waves.ENDS] = TURN * np.cumsum(last, axis=0)
    found[waves.ENDS, -1] = TURN
    return Wave(np.zeros((3, 2, 0, cells)), found)


def parts(pick: np.random.Generator, wave: Wave, *, rebounds: bool = False) -> Groups:
    """Return random parts under waves; every other has a larger static friction."""
    (cells,) = wave.cells
    gamma, kinetic = np.radians(pick.uniform(-5, 5, cells)), pick.uniform(0.1, 0.8, cells)
    more = np.where(np.arange(cells) % 2, pick.uniform(1.0, 1.5, cells), 1.0)
    bounce = np.where(np.arange(cells) % 3, 0.0, pick.uniform(0.0, 0.7, cells))
    along, across, normal = (waves.bound(wave, axis) for axis in range(3))
    return Groups(
        drive_number_along=along,
        drive_number_across=across,
        drive_number_normal=normal,
        gravity_number_along=np.sin(gamma),
        gravity_number_normal=np.cos(gamma),
        friction_static=more * kinetic,
        friction_kinetic=kinetic,
        restitution=bounce if rebounds else 0.0,
        wave=wave,
    )


def shifted(wave: Wave, phase: float) -> Wave:
    """Return waves of sines that start later by a phase."""
    orders = np.arange(1, wave.harmonics.shape[2] + 1)[:, np.newaxis]
    sine, cosine = wave.harmonics[:, 0], wave.harmonics[:, 1]
    turn = orders * phase
    turned = (
        sine * np.cos(turn) - cosine * np.sin(turn),
        sine * np.sin(turn) + cosine * np.cos(turn),
    )
    return Wave(np.stack(turned, axis=1), wave.steps)
