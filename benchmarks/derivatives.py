"""Errors of the derivatives of planar motion at random cells, and their cost.

Run `python -m benchmarks.derivatives`. The judge is the law of scaling: with v = g/w times a
function of A w^2/g, angles and friction, d ln v/d ln f + 2 d ln v/d ln g = 1 and
d ln v/d ln A + d ln v/d ln g = 1 (theory 13.16). Beside how far they miss it stands the error that
they state.
"""

from __future__ import annotations

from collections import Counter
from functools import partial

import numpy as np

from benchmarks.options import options
from benchmarks.timing import in_turns
from vibrafeed.core.motion.prepare import choose_system
from vibrafeed.core.plan.differences import STATUS, derivatives
from vibrafeed.core.plan.plan import plan_scene, run_equations

OUTPUT = "conveying_velocity"
NAMES = ("frequency", "gravity", "amplitude", "beta", "friction_kinetic")


def random_cells(count: int, seed: int) -> dict[str, np.ndarray]:
    """Return parameters of parts that slide, stick and hop, half of them with restitution."""
    rng = np.random.default_rng(seed)
    kinetic, half = rng.uniform(0.1, 0.8, count), rng.random(count) < 0.5
    frequency, gravity = rng.uniform(30.0, 100.0, count), np.full(count, 9.80665)
    strength = rng.uniform(0.2, 4.0, count)  # A w^2/g
    return {
        "frequency": frequency,
        "gravity": gravity,
        "amplitude": strength * gravity / np.square(2 * np.pi * frequency),
        "beta": np.deg2rad(rng.uniform(2.0, 60.0, count)),
        "gamma": np.deg2rad(rng.uniform(-5.0, 5.0, count)),
        "friction_kinetic": kinetic,
        "friction_static": kinetic * rng.uniform(1.01, 1.4, count),
        "restitution": np.where(half, 0.0, rng.uniform(0.01, 0.6, count)),
    }


def main() -> None:
    """Print the errors and the cost of derivatives."""
    cells = random_cells(options(__doc__, cells=4_000).cells, 2026)
    scene, method, _ = choose_system("rectangle-on-plane", None, cells)
    plan = plan_scene(scene, method, (OUTPUT,), cells)
    found = {name: one for (_, name), one in derivatives(plan, cells, NAMES).items()}
    words = {value: name for name, value in STATUS.items()}
    for name, one in found.items():
        told = Counter(words[value] for value in one.status.tolist())
        print(f"by {name:17s}" + ", ".join(f"{n:,} {word}" for word, n in told.most_common()))
    f, g, a = (found[name].logarithmic(cells[name]) for name in NAMES[:3])
    size = np.abs(f) + np.abs(g) + np.abs(a)
    value = np.where(found["beta"].value == 0, np.nan, np.abs(found["beta"].value))
    stated = sum(found[name].error * cells[name] for name in NAMES[:3]) / value
    for words_, errors in (
        ("misses of the law for f", np.abs(f + 2 * g - 1) / size),
        ("misses of the law for A", np.abs(a + g - 1) / size),
        ("stated errors", stated / size),
    ):
        known = errors[np.isfinite(errors)]
        shares = (f"{100 * q:g} % {np.quantile(known, q):.1e}" for q in (0.5, 0.95, 0.99, 1.0))
        print(f"{words_:24s}{known.size:6,}: {', '.join(shares)}")
    ways = partial(run_equations, plan, cells), partial(derivatives, plan, cells, NAMES)
    alone, derived = map(min, in_turns(3, *ways))
    print(
        f"{derived / alone:.1f} times the time of the velocities alone, for {len(NAMES)} parameters"
    )


if __name__ == "__main__":
    main()
