"""What a motion that does not repeat costs, by tolerance; `python -m benchmarks.aperiodic_means`.

1. Over the grid of `benchmarks.motion` at restitution 0.3, a part of it: microseconds a cell of
   processor time, of all cells and of those that do not repeat, without a tolerance and at 1, 3 and
   10 % of the mean velocity (least of some runs).
2. Over those cells, and over random ones: in which share the stated error is exceeded, beside runs
   forty times as long, and which share is known to within the tolerance.
"""

from __future__ import annotations

import time
from functools import partial

import numpy as np

from benchmarks.honest_estimates import Groups, random_groups
from benchmarks.motion import SETTINGS, mixed_grid
from benchmarks.motions import planar_motion
from benchmarks.options import options
from benchmarks.timing import least
from vibrafeed.core.motion.method import STATUS, Motion

TOLERANCES = (1e-12, 0.01, 0.03, 0.1)
LONG = 40_000.0  # periods of the drive that tell the mean


def followed(groups: Groups, tolerance: float, max_periods: float = 1000.0) -> Motion:
    """Return the motion of cells at a tolerance."""
    return planar_motion(**groups, tolerance=tolerance, max_periods=max_periods)


def some(groups: Groups, where: np.ndarray) -> Groups:
    """Return a selection of the cells."""
    return {name: values[where] for name, values in groups.items()}


def main() -> None:
    """Print the cost and the accuracy of means of aperiodic motions."""
    given = options(
        __doc__, thin=(6, "one in so many cells of the grid"), runs=(5, "runs of each"),
        random=(3000, "random cells, of which a fifth do not repeat"),
    )  # fmt: skip
    grid = {n: v[:: given.thin] for n, v in mixed_grid(0.3).items() if n not in SETTINGS}
    wild = np.flatnonzero(followed(grid, TOLERANCES[0]).status == STATUS["aperiodic"])
    cells, count = some(grid, wild), grid["restitution"].size
    print(f"{count:,} cells at restitution 0.3, of which {wild.size:,} do not repeat")
    for tolerance in TOLERANCES:
        every, own = (
            least(given.runs, partial(followed, those, tolerance), time.process_time)
            for those in (grid, cells)
        )
        print(
            f"  tolerance {tolerance:<6g} {1e6 * every / count:7.1f} us a cell, "
            f"{1e6 * own / wild.size:7.0f} us one that does not repeat"
        )
    random = random_groups(given.random, 41)
    random = some(random, followed(random, TOLERANCES[0]).status == STATUS["aperiodic"])
    for name, groups in (("the grid's", cells), ("random", random)):
        long = followed(groups, TOLERANCES[0], LONG)
        print(f"{name} cells, beside {LONG:,.0f} periods:")
        for tolerance in TOLERANCES:
            found = followed(groups, tolerance)
            both = (found.status == STATUS["aperiodic"]) & (long.status == STATUS["aperiodic"])
            off = np.abs(found.velocity - long.velocity) > found.error
            within = found.error <= tolerance * np.abs(found.velocity)
            print(
                f"  tolerance {tolerance:<6g} error exceeded in {np.mean(off[both]):5.1%} of "
                f"{both.sum()}, within the tolerance {np.mean(within[both]):4.0%}"
            )


if __name__ == "__main__":
    main()
