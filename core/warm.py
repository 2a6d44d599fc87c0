"""Kernels compiled before anybody waits for them: when an image is built, or a service starts.

Each package of kernels has studies that need all of it. The first of them needs what the first
study of a user does; these come before the rest. Packages are compiled in several processes at a
time. Where everything is compiled already, it takes no time.
"""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

from core.kinds import prepare_content, tabulate

SINE = {"frequency": 50, "amplitude": "0.2 mm", "beta": 30, "friction": 0.4}
WAVE = {
    "frequency": 50, "friction": 0.4, "amplitude_along_1": "0.2 mm", "amplitude_normal_1": "0.1 mm",
    "amplitude_normal_2": "0.05 mm", "phase_normal_2": 30,
}  # fmt: skip
RESTLESS = {"restitution": [0.2, 0.4, 0.6, 0.8]}
SPEED = {"outputs": ["conveying_velocity"]}
ENERGY = {"outputs": ["conveying_velocity", "friction_power"]}
PATH = {"trajectory": 10}


def _motion(scene: str, parameters: Mapping[str, Any], method: str, **more: Any) -> dict[str, Any]:
    track = {"radius": "0.2 m"} if scene == "rectangle-on-track" else {}
    return {
        "kind": "simulate", "scene": scene, "parameters": {**track, **parameters}, "method": method,
        "most_periods": 20, **more,
    }  # fmt: skip


def _all(scene: str, method: str) -> list[dict[str, Any]]:
    asked = (SPEED, ENERGY, PATH) if method == "events" else (SPEED, PATH)  # steps tell no energy
    return [_motion(scene, drive, method, **more) for drive in (SINE, WAVE) for more in asked]


PIN = {
    "kind": "simulate",
    "scene": "cylinder-isolated",
    "outputs": ["settling_time"],
    "parameters": {
        "length": "20 mm", "diameter": "8 mm", "drop_height": "10 mm", "pitch": 60,
        "friction": 0.3, "restitution": 0.4, "duration": "0.1 s",
    },
}  # fmt: skip
PLANE, TRACK, ROLLING = "rectangle-on-plane", "rectangle-on-track", "cylinder-on-plane"

STUDIES: dict[str, list[dict[str, Any]]] = {
    "motion-planar": [
        *_all(PLANE, "events"),
        _motion(PLANE, {**SINE, "amplitude": "0.6 mm", **RESTLESS}, "events"),
        _motion(PLANE, {**WAVE, "amplitude_normal_1": "0.5 mm", **RESTLESS}, "events"),
        _motion(PLANE, SINE, "events", sensitivities=True),
    ],
    "optimise": [
        {
            "kind": "optimise",
            "scene": TRACK,
            "criterion": {"kind": "maximise", "output": "acceleration_x"},
            "parameters": {name: SINE[name] for name in ("frequency", "amplitude", "friction")},
        }
    ],
    "motion-track": [*_all(TRACK, "events"), *_all(ROLLING, "events")],
    "motion-tumbling": [
        {**PIN, "method": "events"},
        {**PIN, "method": "events", "trajectory": 10},
        {**PIN, "method": "time-stepping"},
    ],
    "motion-stepping": [
        study for scene in (PLANE, TRACK, ROLLING) for study in _all(scene, "time-stepping")
    ],
    "reduce": [
        {
            "kind": "sweep",
            "scene": PLANE,
            "outputs": ["acceleration_x"],
            "parameters": {**SINE, "frequency": [40, 50], "beta": [10, 20, 30]},
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
"""Studies that need all kernels, by package."""

FIRST, REST = slice(1), slice(1, None)
"""The study of a package that comes first, and the others."""


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
    from core.kernel_cache import root

    marks = {package: _mark(package) for package in STUDIES}
    left = {package: mark for package, mark in marks.items() if mark is None or not mark.exists()}
    for mark in left.values():
        if mark is None or not os.access(mark.parent, os.W_OK):  # an image's, of another processor
            return None
    if left:
        spawn = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(min(processes, len(left)), mp_context=spawn) as pool:
            for part in (FIRST, REST):
                list(pool.map(carry_out, left, len(left) * [part]))
        for mark in left.values():
            assert mark is not None
            mark.touch()
    return root()


def is_warm() -> bool:
    """Return whether every kernel has been compiled for this processor, and kept."""
    marks = [_mark(package) for package in STUDIES]
    return all(mark is not None and mark.exists() for mark in marks)


def carry_out(package: str, part: slice = slice(None)) -> None:
    """Carry out studies of a package."""
    for study in STUDIES[package][part]:
        tabulate(prepare_content(study))


def _mark(package: str) -> Path | None:
    """Return the file that says so; it goes with the code that it speaks of."""
    from core.kernel_cache import folder, processor

    place = folder(package)
    return None if place is None else place / f"warm-{processor()}"
