"""Random drives of any wave for tests, and what harmonics cost; `python -m benchmarks.waves`.

Drives of one to eight harmonics on each axis, and of two to twelve steps, with random parts; parts
that bounce. The program prints the time of a cell under more and more harmonics as a ratio to the
plain sine, both measured in turns in one run, on one thread. That ways of following them agree is
tested in tests/laws/test_waves.py and test_planar_means.py.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from benchmarks.options import options
from vibrafeed.core.motion import planar, waves
from vibrafeed.core.motion.groups import Groups, cells_of
from vibrafeed.core.motion.kernels import track
from vibrafeed.core.motion.kernels.arrays import NEVER
from vibrafeed.core.motion.result import COLUMNS
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


def more_orders(pick: Pick, sine: Groups, orders: int) -> Groups:
    """Return the parts with so many harmonics on each axis in place of the sine."""
    pushes = (sine.drive_number_along, sine.drive_number_across, sine.drive_number_normal)
    cells = np.size(sine.drive_number_along)
    found = np.zeros((3, 2, orders, cells))
    for axis, push in enumerate(np.broadcast_to(push, cells) for push in pushes):
        share = np.ones((orders, cells))
        share[1:] = pick.uniform(0, 0.5, (orders - 1, cells))
        share[1:] /= np.sqrt(np.arange(2, orders + 1))[:, np.newaxis]
        phase = pick.uniform(0, TURN, (orders, cells))
        phase[0] = 0.0
        share *= push / share.sum(axis=0)
        found[axis] = share * np.cos(phase), share * np.sin(phase)
    return sine._replace(wave=Wave(found, np.zeros((4, 0, cells))))


def times(name: str, sine: Groups, run: Callable, rounds: int) -> None:
    """Print the time per cell by harmonic order, relative to the sine."""
    pick = np.random.default_rng(1)
    sets = {"sine": sine} | {k: more_orders(pick, sine, k) for k in (1, 2, 5, 10)}
    settings = PLANAR if run is planar.solve_cells else SPATIAL
    rows = {k: np.ascontiguousarray(cells_of(g, **settings)[0]) for k, g in sets.items()}
    cells = len(rows["sine"])
    table, status = np.empty((cells, COLUMNS)), np.empty(cells, dtype=np.int8)
    best = np.full((len(sets), cells), np.inf)
    for _ in range(rounds):
        for number, one in enumerate(rows.values()):
            for cell in range(cells):
                piece = slice(cell, cell + 1)
                begin = time.perf_counter()
                run(one[piece], table[piece], status[piece], NEVER)
                best[number, cell] = min(best[number, cell], time.perf_counter() - begin)
    print(f"{name}, {cells} cells, microseconds with the call; ratio to the sine cell by cell:")
    for number, key in enumerate(sets):
        ratio = np.median(best[number] / best[0])
        median, mean = np.median(best[number]), best[number].mean()
        label = key if key == "sine" else f"{key} orders"
        print(
            f"   {label:9}: median {1e6 * median:8.1f}, mean {1e6 * mean:8.1f}; median ratio "
            f"{ratio:.2f}, ratio of means {mean / best[0].mean():.2f}"
        )


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


def main() -> None:
    """Print the times in the plane and in space."""
    given = options(__doc__, timed=300, rounds=15, seed=7)
    flat = feeder_parts(given.timed, given.seed, 0.0)
    times("In the plane", flat, planar.solve_cells, given.rounds)

    def in_space(rows: NDArray, table: NDArray, status: NDArray, stop: NDArray) -> None:
        """Run the kernel of motions in space."""
        track.solve_cells(True, 0.0, rows, table, status, stop)

    aslant = feeder_parts(given.timed, given.seed, 1.0)
    times("On the track", aslant, in_space, max(3, given.rounds // 4))


if __name__ == "__main__":
    main()
