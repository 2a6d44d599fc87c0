"""Random drives of any wave, for tests and `benchmarks.missed_events`.

Drives of one to eight harmonics on each axis, and of two to twelve steps, with random parts; parts
that bounce.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.motion import waves
from vibrafeed.core.motion.method import Groups
from vibrafeed.core.motion.waves import ENDS, TURN, Wave

PLANAR = {"tolerance": 1e-12, "max_periods": 1000.0}
SPATIAL = {"tolerance": 1e-10, "max_periods": 400.0}

Pick = np.random.Generator


def sizes(pick: Pick, cells: int) -> NDArray[np.float64]:
    """Return random accelerations along and normal, from 0.3 to 3 g."""
    return np.exp(pick.uniform(np.log(0.3), np.log(3.0), (2, cells)))


def harmonics(pick: Pick, cells: int, orders: int) -> Wave:
    """Return random waves of sines with phases, along and normal."""
    found = np.zeros((3, 2, orders, cells))
    for axis, size in zip((0, 2), sizes(pick, cells), strict=True):
        share = pick.dirichlet(np.ones(orders), cells).T * size
        phase = pick.uniform(0.0, TURN, (orders, cells))
        found[axis] = share * np.cos(phase), share * np.sin(phase)
    return Wave(found, np.zeros((4, 0, cells)))


def steps(pick: Pick, cells: int, count: int) -> Wave:
    """Return random waves of steps, along and normal."""
    last = pick.dirichlet(np.full(count, 2.0), cells).T
    found = np.zeros((4, count, cells))
    for axis, size in zip((0, 2), sizes(pick, cells), strict=True):
        levels = size * pick.normal(size=(count, cells))
        found[axis] = levels - (levels * last).sum(axis=0)
    found[ENDS] = TURN * np.cumsum(last, axis=0)
    found[ENDS, -1] = TURN
    return Wave(np.zeros((3, 2, 0, cells)), found)


def parts(pick: Pick, wave: Wave) -> Groups:
    """Return random parts; some with larger static friction, some with restitution."""
    cells = wave.cells[0]
    gamma, kinetic = np.radians(pick.uniform(-5, 5, cells)), pick.uniform(0.1, 0.8, cells)
    more = np.where(pick.random(cells) < 0.4, pick.uniform(1, 1.5, cells), 1.0)
    bounce = np.where(pick.random(cells) < 0.3, pick.uniform(0, 0.7, cells), 0.0)
    along, _, normal = (waves.bound(wave, axis) for axis in range(3))
    return Groups(
        along, normal, np.sin(gamma), np.cos(gamma), more * kinetic, kinetic, bounce, wave=wave
    )


def bouncing(pick: Pick, cells: int, *, clean: bool) -> Groups:
    """Return hopping parts under a plain sine, two in three with rebounds, on numbers as typed or not.

    Throw numbers from 1 to 9; of some static friction is the larger.
    """  # noqa: E501
    if clean:
        throw, beta = pick.integers(11, 81, cells) / 10, pick.integers(2, 16, cells) * 5.0
        gamma = pick.choice([0.0, 0.0, 2.0, 5.0, -3.0], cells)
        kinetic, more = pick.integers(1, 10, cells) / 10, pick.choice([1.0, 1.0, 1.2, 1.5], cells)
        bounce = pick.choice([0.0, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5], cells)
    else:
        throw, beta = (
            np.exp(pick.uniform(np.log(1.02), np.log(9), cells)),
            pick.uniform(8, 75, cells),
        )
        gamma, kinetic = pick.uniform(-5, 5, cells), pick.uniform(0.1, 0.9, cells)
        more = np.where(pick.random(cells) < 0.4, pick.uniform(1, 1.5, cells), 1.0)
        bounce = np.where(pick.random(cells) < 0.65, pick.uniform(0, 0.7, cells), 0.0)
    beta, gamma = np.radians(beta), np.radians(gamma)
    normal = throw * np.cos(gamma)
    return Groups(
        normal / np.tan(beta), normal, np.sin(gamma), np.cos(gamma), more * kinetic, kinetic, bounce
    )


def as_harmonic(sine: Groups) -> Groups:
    """Return the same parts with the same drive as a wave of one harmonic."""
    pushes = np.broadcast_arrays(sine.drive_number_along, sine.drive_number_normal)
    found = np.zeros((3, 2, 1, pushes[0].size))
    found[0, 0, 0], found[2, 0, 0] = (np.ravel(push) for push in pushes)
    wave = Wave(found, np.zeros((4, 0, pushes[0].size)))
    return sine._replace(wave=wave)


def lifting(pick: Pick, wave: Wave, *, clean: bool) -> Groups:
    """Return random parts, two in three with restitution, under a wave that lifts them."""
    size, cells = pick.uniform(1.5, 5.0, wave.cells), wave.cells[0]
    size = np.round(size, 1) if clean else size
    found, steps_of = wave.harmonics.copy(), wave.steps.copy()
    scale = size / waves.bound(wave, 2)
    found[2] *= scale
    steps_of[2] *= scale
    groups = parts(pick, Wave(found, steps_of))
    bounce = np.where(pick.random(cells) < 0.65, pick.uniform(0.0, 0.7, cells), 0.0)
    if not clean:
        return groups._replace(restitution=bounce)
    kinetic = pick.integers(1, 10, cells) / 10
    level = {"gravity_number_along": 0.0, "gravity_number_normal": 1.0}
    more = pick.choice([1.0, 1.0, 1.2, 1.5], cells)
    return groups._replace(
        **level, friction_static=more * kinetic, friction_kinetic=kinetic,
        restitution=np.round(bounce, 1),
    )  # fmt: skip


def feeder_parts(cells: int, seed: int, across: float) -> Groups:
    """Return random parts of a feeder's track under a sine, azimuth up to `across`."""
    pick = np.random.default_rng(seed)
    beta, alpha = np.radians(pick.uniform(10, 50, cells)), np.radians(pick.uniform(5, 35, cells))
    gamma, friction = np.radians(pick.uniform(0, 4, cells)), pick.uniform(0.15, 0.8, cells)
    drive = pick.uniform(0.2, 2.5, cells) / np.sin(beta)
    return Groups(
        drive * np.cos(beta) * np.cos(across * alpha), drive * np.sin(beta), np.sin(gamma),
        np.cos(gamma), friction, friction, wall_friction=friction,
        drive_number_across=across * drive * np.cos(beta) * np.sin(alpha),
        gravity_number_across=0.1 * across,
    )  # fmt: skip
