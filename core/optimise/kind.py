"""The record of the kind `optimise`, by which the rest of the program knows it."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.optimise.prepare import choose_problem_scene, prepare
from vibrafeed.core.optimise.run import compute, label
from vibrafeed.core.plan.kind import Kind
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.study.optimise_study import OptimiseStudy

KIND: Final = Kind(
    name="optimise",
    title="Find the best drive",
    description="Finds the best angles, or other parameters, of a drive for each of many designs.",
    model=OptimiseStudy,
    scenes=(SCENES, SYSTEMS),
    example={
        "kind": "optimise",
        "scene": "rectangle-on-plane",
        "criterion": {"kind": "maximise", "output": "acceleration_x"},
        "parameters": {"frequency": "50 Hz", "amplitude": "0.5 mm", "friction": 0.3},
    },
    prepare=prepare,
    choose=lambda sketch: choose_problem_scene(
        sketch.scene, sketch.variant, sketch.outputs, sketch.names
    ),
    compute=compute,
    label=label,
    choices=MappingProxyType({"method": tuple(METHODS)}),
)
