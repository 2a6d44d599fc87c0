"""The record of the kind `calibrate`, by which the rest of the program knows it."""

from __future__ import annotations

from typing import Final

from vibrafeed.core.calibrate.prepare import prepare
from vibrafeed.core.calibrate.run import compute, label
from vibrafeed.core.motion.prepare import choose_system
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.plan.kind import Kind
from vibrafeed.core.study.calibrate_study import CalibrateStudy

KIND: Final = Kind(
    name="calibrate",
    title="Find parameters from measured speeds",
    description="Finds, from measured speeds or from what parts were seen to do, friction and "
    "other unknown parameters, and which run would add most.",
    model=CalibrateStudy,
    scenes=(SYSTEMS,),
    example={
        "kind": "calibrate",
        "scene": "rectangle-on-plane",
        "parameters": {"frequency": "50 Hz", "beta": 20},
        "observations": [
            {"amplitude": "0.2 mm", "conveying_velocity": "13 mm/s", "error": "1 mm/s"},
            {"amplitude": "0.3 mm", "conveying_velocity": "33 mm/s", "error": "1 mm/s"},
        ],
        "unknowns": {"friction": {"lower": 0.1, "upper": 0.6}},
        "points": 1_000,
    },
    prepare=prepare,
    choose=lambda sketch: choose_system(sketch.scene, sketch.method, sketch.names),
    compute=compute,
    label=label,
)
