"""Kernels compiled before anybody waits for them: when an image is built, or a service starts.

Each group of studies has kernels of its own, so that several processes can do them at a time. Where
everything is compiled already, it takes seconds.
"""

from __future__ import annotations

import multiprocessing
import os
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
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
GROUPS: dict[str, list[dict[str, Any]]] = {
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
    ]
    + [{"kind": "simulate", **PLANE, "sensitivities": True}],
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


def warm(processes: int) -> Path | None:
    """Compile every kernel that is not compiled yet for this processor.

    Parameters
    ----------
    processes : int
        Most processes at a time.

    Returns
    -------
    Path or None
        Where compiled code is kept; None if no folder can be written.
    """
    from core.compiled import folder

    place = folder()
    if place is None or is_warm():
        return place
    if not os.access(place, os.W_OK):  # an image ships it, for another processor
        return None
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(processes, len(GROUPS)), mp_context=spawn) as pool:
        list(pool.map(carry_out, GROUPS))
    _mark(place).touch()
    return place


def is_warm() -> bool:
    """Return whether every kernel has been compiled for this processor, and kept."""
    from core.compiled import folder

    place = folder()
    return place is not None and _mark(place).exists()


def carry_out(group: str) -> None:
    """Carry out the studies of a group."""
    for study in GROUPS[group]:
        tabulate(prepare_content(study))


def _mark(place: Path) -> Path:
    """Return the file that says so; it goes with the code that it speaks of."""
    from core.compiled import processor

    return place / f"warm-{processor()}"
