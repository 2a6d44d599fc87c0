"""`python -m benchmarks.calibrations` counts how often intervals hold the truth.

Random calibrations of 1 to 3 unknowns and 3 to 12 runs: the truth is drawn from what a study says
of it, speeds are those of the motion with random errors, and of every unknown it is counted whether
the intervals of 68 and 95 % hold the truth.

- `errors`: errors are known and explain all, as if nothing but the stopwatch were wrong.
- `discrepancy`: the same, with a discrepancy drawn from what scatter.py says of it beforehand.
- `none known`: studies that give no error, of 3 more runs than unknowns or more.

`--count` is 1,000.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.options import options
from benchmarks.timing import timed
from vibrafeed.core.calibrate.boxes import NONE_BEFORE, explore
from vibrafeed.core.calibrate.calibration import Calibration
from vibrafeed.core.calibrate.posterior import posterior_of
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.watch import Watch

RANGES: dict[str, dict[str, dict[str, Any]]] = {
    "friction": {"unknowns": {"friction": {"lower": 0.1, "upper": 0.6}}},
    "factor_amplitude": {"factors": {"amplitude": {"lower": 0.8, "upper": 1.25}}},
    "offset_beta": {"offsets": {"beta": {"lower": -5.0, "upper": 5.0}}},
}
KINDS = ("errors", "discrepancy", "none known")
POINTS = 6_000
MAX_DISCREPANCY = 10.0  # errors; the Cauchy distribution has no end, and speeds have


def random_study(random: np.random.Generator, kind: str) -> dict[str, Any]:
    """Return a study whose runs have no speeds yet."""
    count = int(random.integers(1, 4))
    names = random.permutation([*RANGES])[:count]
    runs = int(random.integers(count + 3 if kind == "none known" else 3, 13))
    tables: dict[str, Any] = {}
    for name in names:
        for table, content in RANGES[name].items():
            tables.setdefault(table, {}).update(content)
    shared = {"frequency": 50.0, "gamma": 2.0}
    if "friction" not in names:
        shared["friction"] = float(random.uniform(0.15, 0.5))
    rows = [
        {
            "amplitude": float(random.uniform(1e-4, 4e-4)),
            "beta": float(random.uniform(12.0, 45.0)),
            "conveying_velocity": 0.01,
            **({} if kind == "none known" else {"error": 1e-3}),
        }
        for _ in range(runs)
    ]
    return {
        "kind": "calibrate", "scene": "rectangle-on-plane", "parameters": shared,
        "observations": rows, "points": POINTS, **tables,
    }  # fmt: skip


def drawn(random: np.random.Generator, kind: str) -> tuple[Calibration, np.ndarray]:
    """Return a random calibration study and the true values."""
    content = random_study(random, kind)
    prepared = prepare_content(content)
    model = prepared.model
    truth = model.lower + random.random(len(model.unknowns)) * model.width
    speeds = model.predict(truth[np.newaxis], Watch()).value[0]
    error = 10.0 ** random.uniform(-3.7, -2.5)  # 0.2 to 3 mm/s
    size = 0.0
    if kind == "discrepancy" and random.random() > NONE_BEFORE:
        size = min(abs(random.standard_cauchy()), MAX_DISCREPANCY) * error
    noise = random.normal(size=speeds.size) * np.hypot(error, size)
    for row, speed in zip(content["observations"], speeds + noise, strict=True):
        row["conveying_velocity"] = float(speed)
        if kind != "none known":
            row["error"] = error
    again = prepare_content(content)
    return again, truth


def held(prepared: Calibration, truth: np.ndarray) -> np.ndarray:
    """Return a mask: the intervals of 68 and 95 % hold each unknown; shape (2, unknowns)."""
    found = posterior_of(
        prepared.likelihood, explore(prepared.likelihood, prepared.study.points, Watch())
    )
    low68, high68, low95, high95 = found.quantiles(found.points, (0.16, 0.84, 0.025, 0.975))
    return np.array([(low68 <= truth) & (truth <= high68), (low95 <= truth) & (truth <= high95)])


def covered(count: int, kind: str, seed: int) -> tuple[float, float, int]:
    """Return the shares of true values inside 68 and 95 % intervals, and the number of cases."""
    random = np.random.default_rng([seed, KINDS.index(kind)])
    found = np.concatenate([held(*drawn(random, kind)) for _ in range(count)], axis=1)
    return float(found[0].mean()), float(found[1].mean()), found.shape[1]


if __name__ == "__main__":
    asked = options(__doc__, count=1000, seed=0)
    for one in KINDS:
        (few, many, truths), seconds = timed(covered, asked.count, one, asked.seed)
        print(
            f"{one}: {asked.count:,} calibrations, {truths:,} unknowns: 68 % hold "
            f"{100 * few:.1f} %, 95 % hold {100 * many:.1f} %; {seconds:.0f} s",
            flush=True,
        )
