"""The record of the kind `simulate`, by which the rest of the program knows it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

from vibrafeed.core.motion.prepare import choose_system
from vibrafeed.core.motion.run import compute, label, prepare_reduced
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.motion.verify import verified_alone
from vibrafeed.core.plan.kind import Kind
from vibrafeed.core.study.simulate_study import SimulateStudy

_SINE: Final = {"frequency": 50, "amplitude": "0.2 mm", "beta": 30, "friction": 0.4}
_WAVE: Final = {
    "frequency": 50, "friction": 0.4, "amplitude_along_1": "0.2 mm", "amplitude_normal_1": "0.1 mm",
    "amplitude_normal_2": "0.05 mm", "phase_normal_2": 30,
}  # fmt: skip
_RESTLESS: Final = {"restitution": [0.2, 0.4, 0.6, 0.8]}
_PLANE, _TRACK, _ROLLING = "rectangle-on-plane", "rectangle-on-track", "cylinder-on-plane"
_PIN: Final = {
    "kind": "simulate",
    "scene": "cylinder-isolated",
    "outputs": ["settling_time"],
    "parameters": {
        "length": "20 mm", "diameter": "8 mm", "drop_height": "10 mm", "pitch": 60,
        "friction": 0.3, "restitution": 0.4, "duration": "0.1 s",
    },
}  # fmt: skip


_ROW: Final = {
    "kind": "simulate",
    "scene": "row-on-plane",
    "outputs": ["conveying_velocity"],
    "parameters": {
        "frequency": 50, "amplitude": "0.2 mm", "beta": 30, "part_friction_1": 0.3,
        "part_friction_2": 0.4,
    },
}  # fmt: skip
_WAVED_ROW: Final = {**_ROW, "parameters": {"parts": 2, "part_friction_1": 0.3, **_WAVE}}


def _motion(scene: str, parameters: Mapping[str, Any], **more: Any) -> dict[str, Any]:
    """Return a study of few periods, whose run compiles kernels; `more` are its keys."""
    track = {"radius": "0.2 m"} if scene == _TRACK else {}
    return {
        "kind": "simulate", "scene": scene, "parameters": {**track, **parameters},
        "max_periods": 20, **more,
    }  # fmt: skip


def _all(scene: str) -> list[dict[str, Any]]:
    """Return studies of a scene that together run, and so compile, all kernels of its motion.

    Under a sine and another wave, with means, energy and a trajectory.
    """
    asked: list[dict[str, Any]] = [
        {"outputs": ["conveying_velocity"]},
        {"outputs": ["conveying_velocity", "friction_power"]},
        {"trajectory": 10},
    ]
    return [_motion(scene, drive, **more) for drive in (_SINE, _WAVE) for more in asked]


KIND: Final = Kind(
    name="simulate",
    title="Simulate the motion in time",
    description="Follows parts in time, with stick, slide and hop, over a grid of parameters.",
    model=SimulateStudy,
    scenes=(SYSTEMS,),
    example={
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "parameters": {
            "frequency": "50 Hz",
            "amplitude": "0.5 mm",
            "beta": 30,
            "friction": [0.2, 0.4],
        },
    },
    prepare=prepare_reduced,
    choose=lambda sketch: choose_system(sketch.scene, sketch.method, sketch.names),
    compute=compute,
    label=label,
    verified=verified_alone,
    is_measured=True,
    compiles=MappingProxyType(
        {
            "motion-planar": (
                *_all(_PLANE),
                _motion(_PLANE, {**_SINE, "amplitude": "0.6 mm", **_RESTLESS}),
                _motion(_PLANE, {**_WAVE, "amplitude_normal_1": "0.5 mm", **_RESTLESS}),
            ),
            "motion-track": (*_all(_TRACK), *_all(_ROLLING)),
            "motion-tumbling": (
                _PIN,
                {**_PIN, "trajectory": 10},
            ),
            "motion-rows": (
                *({**row, "trajectory": 10} for row in (_ROW, _WAVED_ROW)),
                *(_ROW, _WAVED_ROW),
            ),
        }
    ),
)
