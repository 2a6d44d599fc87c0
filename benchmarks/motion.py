"""How fast and how exact the motion from event to event is; run `python -m benchmarks.motion`.

1. Cells a second over a grid that mixes sticking, sliding and hopping.
2. How long single points of a random sweep take, in processor time, and with which status.
"""

from __future__ import annotations

import os
import statistics
import time
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import numpy as np

from benchmarks.motions import planar_motion
from benchmarks.options import options
from vibrafeed.core.motion.events import solve_cells
from vibrafeed.core.motion.kernels.inputs import NEVER
from vibrafeed.core.motion.method import COLUMNS, cells_of
from vibrafeed.core.motion.method import Groups as Part
from vibrafeed.core.quantities import MOTION_STATUSES

Groups = dict[str, np.ndarray]
SETTINGS = {"tolerance": 1e-12, "max_periods": 1000.0}
LIMIT = 0.05  # s of processor time, of the slowest point


def groups(throw, friction, beta, gamma, restitution) -> Groups:
    """Return the dimensionless groups of cells; angles in degrees."""
    beta, gamma = np.radians(beta), np.radians(gamma)
    p = throw * np.cos(gamma) / np.sin(beta)
    arrays = np.broadcast_arrays(
        p * np.cos(beta), p * np.sin(beta), np.sin(gamma), np.cos(gamma), friction, friction,
        restitution, *SETTINGS.values(),
    )  # fmt: skip
    names = (
        "drive_number_along", "drive_number_normal", "gravity_number_along",
        "gravity_number_normal", "friction_static", "friction_kinetic", "restitution", *SETTINGS,
    )  # fmt: skip
    return {name: np.ravel(array).copy() for name, array in zip(names, arrays, strict=True)}


def mixed_grid(restitution: float) -> Groups:
    """Return a grid of 21,000 cells from sticking to hop after hop."""
    throw, friction, beta, gamma = np.meshgrid(
        np.linspace(0.2, 3.6, 35), np.linspace(0.1, 1, 10), np.linspace(8, 60, 12),
        np.linspace(-2, 2, 5), indexing="ij",
    )  # fmt: skip
    return groups(throw, friction, beta, gamma, restitution)


def time_grid(rounds: int) -> None:
    """Print cells per second, and errors."""
    for restitution in (0.0, 0.3):
        cells = mixed_grid(restitution)
        # Motion that does not repeat has no mean to 1e-10: it is timed with the single points.
        repeats = planar_motion(**cells).status != MOTION_STATUSES["aperiodic"].value
        cells = {name: values[repeats] for name, values in cells.items()}
        count = cells["restitution"].size
        motion = planar_motion(**cells)  # compiles
        rates = []
        for _ in range(rounds):
            start = time.perf_counter()
            planar_motion(**cells)
            rates.append(count / (time.perf_counter() - start))
        known = motion.status == MOTION_STATUSES["periodic"].value
        scale = cells["drive_number_along"]
        # The same motions reached in another way: mirrored, and started half a turn later.
        turned = {
            name: -values if name.startswith("drive_number") else values
            for name, values in cells.items()
        }
        other = planar_motion(**turned).velocity
        same = known & (np.abs(motion.velocity - other) < 1e-6 * scale)
        print(f"restitution {restitution:g}: {count:,} cells, {os.cpu_count()} cores")
        print(f"  {statistics.median(rates):12,.0f} cells a second (median of {rounds} rounds)")
        gap = np.abs(motion.velocity - other)[same] / scale[same]
        print(f"  against events started half a turn later: {gap.max():.1e} of the drive")
        share = same.sum() / known.sum()
        print(f"    ({share:.2%} of {known.sum():,} periodic cells; the rest has two motions)")
        print("  statuses:", *statuses(motion.status))


def statuses(values: np.ndarray) -> list[str]:
    """Return the counts of the statuses that occur."""
    names = {flag.value: name for name, flag in MOTION_STATUSES.items()}
    return [
        f"{names[v]} {n:,}" for v, n in zip(*np.unique(values, return_counts=True), strict=True)
    ]


def time_points(count: int) -> None:
    """Print the time of single points of a random sweep."""
    random = np.random.default_rng(2004)
    cells = groups(
        random.uniform(0.1, 6, count), random.uniform(0, 2, count), random.uniform(1, 89, count),
        random.uniform(-10, 10, count), random.uniform(0, 0.95, count),
    )  # fmt: skip
    numbers = {name: values for name, values in cells.items() if name not in SETTINGS}
    rows, _ = cells_of(Part(**numbers), **SETTINGS)
    table, status = np.empty((count, COLUMNS)), np.zeros(count, dtype=np.int8)
    taken = np.empty(count)
    solve_cells(rows[:1], table[:1], status[:1], NEVER)  # compiles

    def run(first: int, last: int) -> None:
        """Compute and time some cells."""
        for cell in range(first, last):
            here = slice(cell, cell + 1)
            start = time.thread_time()
            solve_cells(rows[here], table[here], status[here], NEVER)
            taken[cell] = time.thread_time() - start

    threads = os.cpu_count() or 1
    borders = np.linspace(0, count, 50 * threads + 1).astype(int)
    with ThreadPoolExecutor(threads) as pool:
        for done in [pool.submit(run, a, b) for a, b in pairwise(borders)]:
            done.result()
    print(f"{count:,} random points, one at a time, processor time of each:")
    for share in (0.5, 0.9, 0.99, 0.999, 0.9999):
        print(f"  {share:8.2%} within {1e3 * np.quantile(taken, share):8.3f} ms")
    worst = int(taken.argmax())
    print(f"  slowest {1e3 * taken[worst]:.1f} ms (limit {1e3 * LIMIT:.0f} ms):")
    print("   ", ", ".join(f"{name} {values[worst]:.6g}" for name, values in cells.items()))
    print("  statuses:", *statuses(status))
    velocities = table[:, 0]
    runaway = status == MOTION_STATUSES["runaway"].value
    print(f"  without a status: {(status == 0).sum()}; NaN: {np.isnan(velocities[~runaway]).sum()}")


def main() -> None:
    """Print both measurements."""
    given = options(
        __doc__,
        points=(100_000, "points of the second part"),
        rounds=(9, "rounds of the first part"),
    )
    time_grid(given.rounds)
    time_points(given.points)


if __name__ == "__main__":
    main()
