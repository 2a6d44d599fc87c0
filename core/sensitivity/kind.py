"""The record of the kind `sensitivity`, by which the rest of the program knows it."""

from __future__ import annotations

from typing import Final

from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.plan.kind import Kind
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.sensitivity.prepare import choose, prepare
from vibrafeed.core.sensitivity.run import compute, label
from vibrafeed.core.study.sensitivity_study import SensitivityStudy

KIND: Final = Kind(
    name="sensitivity",
    title="Show the effect of uncertain parameters",
    description="Shows how outputs vary with uncertain parameters: probabilities, "
    "quantiles, Sobol indices, tolerance budgets, for each of many designs.",
    model=SensitivityStudy,
    scenes=(SCENES, SYSTEMS),
    example={
        "kind": "sensitivity",
        "scene": "rectangle-on-plane",
        "outputs": ["acceleration_x"],
        "uncertain": {"friction": {"mean": 0.3, "deviation": 0.03}},
        "parameters": {"frequency": "50 Hz", "amplitude": "0.5 mm", "beta": 30},
    },
    prepare=prepare,
    choose=choose,
    compute=compute,
    label=label,
)
