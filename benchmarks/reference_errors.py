"""Prints how the reference's true errors compare with those it states; `python -m benchmarks.reference_errors`.

Random planar motions with a restitution of at most 0.4, judged by the exact method, `events`: those that repeat by
both, and those that the reference could not show to repeat, with as many periods as given and with few.
"""  # noqa: E501

from __future__ import annotations

import numpy as np

from benchmarks.honest_estimates import REPEATS, by_events, random_groups
from benchmarks.motions import reference_motion
from benchmarks.options import options
from benchmarks.timing import timed
from vibrafeed.core.motion.method import STATUS

PERIODS = (100, 12, 3, 1)
"""Most periods followed: of all motions, and of a quarter of them."""


def main() -> None:
    """Print a table row for each number of periods and each status."""
    arguments = options(__doc__, motions=400, seed=3)
    groups = random_groups(
        arguments.motions, arguments.seed, throw=(0.1, 4.0), most_restitution=0.4
    )
    exact = by_events(groups)
    print(
        "| most periods | found | motions | median true | median stated | exceeded | "
        "worst true/stated | other multiples | s a motion |"
    )
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for most in PERIODS:
        count = arguments.motions if most == PERIODS[0] else max(1, arguments.motions // 4)
        alone = [{n: float(v[cell]) for n, v in groups.items()} for cell in range(count)]
        found, took = timed(
            lambda alone=alone, most=most: [
                reference_motion(**one, max_periods=most) for one in alone
            ]
        )
        velocity, error, status, multiple = (
            np.array([float(getattr(one, name)) for one in found])
            for name in ("velocity", "error", "status", "multiple")
        )
        true = np.abs(velocity - exact.velocity[:count])
        said = error + exact.error[:count]
        repeat = np.isin(status, REPEATS) & np.isin(exact.status[:count], REPEATS)
        answered = np.isin(exact.status[:count], (*REPEATS, STATUS["aperiodic"]))
        not_shown = answered & (status == STATUS["aperiodic"])
        for name, which in (("repeats", repeat), ("not shown to repeat", not_shown)):
            if not which.any():
                continue
            ratio = true[which] / np.maximum(said[which], 1e-300)
            other = (multiple != exact.multiple[:count])[which].sum() if name == "repeats" else "-"
            print(
                f"| {most} | {name} | {which.sum()} | {np.median(true[which]):.1e} | "
                f"{np.median(error[which]):.1e} | {np.mean(ratio > 1.0):.2%} | "
                f"{ratio.max():.2g} | {other} | {took / count:.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
