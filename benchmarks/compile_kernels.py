"""Compile the kernels that are not compiled yet, by a point of every kind of study that has some.

    python -m benchmarks.compile_kernels space
    python -m benchmarks.compile_kernels conveying tumbling optimise reduce

Kernels of one name share hardly any with those of another, so that several processes can do them at
a time. It takes two to three minutes in all; where all is compiled, a second.
"""

from __future__ import annotations

import sys
from typing import Any

from core.kinds import prepare_content, tabulate

DRIVE = {"frequency": 50, "amplitude": "0.2 mm", "beta": 30, "friction": 0.4}
PLANE = {"scene": "rectangle-on-plane", "parameters": DRIVE}
TRACK = {"scene": "rectangle-on-track", "parameters": {**DRIVE, "alpha": 5, "radius": "0.2 m"}}
PIN = {
    "scene": "cylinder-isolated",
    "outputs": ["settling_time"],
    "parameters": {
        "length": "20 mm", "diameter": "8 mm", "drop_height": "10 mm", "pitch": 60,
        "friction": 0.3, "restitution": 0.4, "duration": "0.1 s",
    },
}  # fmt: skip
STUDIES: dict[str, list[dict[str, Any]]] = {
    "space": [
        {"kind": "simulate", **TRACK, "method": "events", **shown}
        for shown in ({}, {"trajectory": 10})
    ],
    "conveying": [
        {"kind": "simulate", **where, "method": method, **shown}
        for where, method in (
            (PLANE, "events"), (PLANE, "time-stepping"), (TRACK, "time-stepping"),
        )
        for shown in ({}, {"trajectory": 10})
    ],
    "tumbling": [
        {"kind": "simulate", **PIN, "method": "events"},
        {"kind": "simulate", **PIN, "method": "events", "trajectory": 10},
        {"kind": "simulate", **PIN, "method": "time-stepping"},
    ],
    "optimise": [
        {
            "kind": "optimise",
            "scene": "rectangle-on-track",
            "criterion": {"kind": "maximise", "output": "acceleration_x"},
            "parameters": {name: DRIVE[name] for name in ("frequency", "amplitude", "friction")},
        }
    ],
    "reduce": [
        {
            "kind": "sweep",
            **PLANE,
            "outputs": ["acceleration_x"],
            "parameters": {**DRIVE, "frequency": [40, 50], "beta": [10, 20, 30]},
            "reduce": {
                "over": [over],
                "statistics": ["max", "mean"],
                "quantiles": [0.5],
                "regimes": True,
                "shares": {"slow": ["acceleration_x < 1"]},
                "levels": {
                    "one": {"output": "acceleration_x", "level": 1, "along": over}
                },
            },
        }
        for over in ("frequency", "beta")
    ],
}  # fmt: skip


def main(names: list[str]) -> None:
    """Carry out the studies of these names."""
    for name in names:
        for study in STUDIES[name]:
            tabulate(prepare_content(study))


if __name__ == "__main__":
    main(sys.argv[1:] or list(STUDIES))
