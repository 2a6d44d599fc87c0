"""Random parts under random drives, and the same drive later."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.motion import waves
from vibrafeed.core.motion.method import Groups
from vibrafeed.core.motion.waves import Wave


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
