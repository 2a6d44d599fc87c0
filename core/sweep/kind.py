"""The record of the kind `sweep`, by which the rest of the program knows it."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from vibrafeed.core.plan.kind import Kind
from vibrafeed.core.plan.plan import choose_scene
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.study.sweep_study import SweepStudy
from vibrafeed.core.sweep.prepare import prepare
from vibrafeed.core.sweep.run import compute, label

_DRIVE: Final = {
    "frequency": [40, 50],
    "amplitude": "0.2 mm",
    "beta": [10, 20, 30],
    "friction": 0.4,
}

KIND: Final = Kind(
    name="sweep",
    title="Sweep closed-form equations",
    description="Evaluates the closed-form equations of a scene over a grid of parameters.",
    model=SweepStudy,
    scenes=(SCENES,),
    example={
        "kind": "sweep",
        "scene": "rectangle-on-plane",
        "outputs": ["throw_number"],
        "parameters": {
            "frequency": "50 Hz",
            "amplitude": ["0.5 mm", "1 mm"],
            "beta": {"start": 0, "stop": 60, "num": 7},
        },
    },
    prepare=prepare,
    choose=lambda sketch: choose_scene(sketch.scene, sketch.variant),
    compute=compute,
    label=label,
    is_measured=True,
    compiles=MappingProxyType(
        {
            "reduce": tuple(
                {
                    "kind": "sweep",
                    "scene": "rectangle-on-plane",
                    "outputs": ["acceleration_x"],
                    "parameters": _DRIVE,
                    "reduce": {
                        "over": [over],
                        "statistics": ["max", "mean"],
                        "quantiles": [0.5],
                        "regimes": True,
                        "shares": {"slow": ["acceleration_x < 1"]},
                        "levels": {"one": {"output": "acceleration_x", "level": 1, "along": over}},
                    },
                }
                for over in ("frequency", "beta")
            )
        }
    ),
)
