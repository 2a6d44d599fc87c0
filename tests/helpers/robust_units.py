"""The best spring of a drive unit whose units differ, and what many such units say of it."""

from typing import Any

import vibrafeed

UNITS = {
    "frequency": {"mean": 50.0, "deviation": 0.4},
    "load_mass": {"lower": 0.0, "upper": 0.5},
    "damping_ratio": {"lower": 0.014, "upper": 0.026},
}
DRIVE = {"moving_mass": 10.0, "base_mass": 30.0}
STUDY = {
    "scene": "linear-drive-unit", "variant": "measured", "uncertain": UNITS,
    "criterion": {"kind": "maximise", "output": "track_amplitude"},
    "variables": {"ring_down_frequency": {"lower": 44.0, "upper": 58.0}},
    "parameters": {**DRIVE, "drive_force": 60.0},
}  # fmt: skip


def optimum(**change: Any) -> Any:
    """Return the best spring."""
    return vibrafeed.optimise({**STUDY, **change})


def units_of(best: Any, **asked: Any) -> Any:
    """Return what 65,536 points of a sensitivity study say of an optimum: the witness."""
    chosen = {name[5:]: float(best[name]) for name in best.data_vars if name.startswith("best_")}
    return vibrafeed.sensitivity(
        scene="linear-drive-unit", variant="measured", outputs=["track_amplitude"],
        parameters={**STUDY["parameters"], **chosen}, samples=65_536,
        **{"uncertain": UNITS, **asked},
    )  # fmt: skip
