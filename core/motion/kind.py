"""What a simulation is to the rest of the program."""

from __future__ import annotations

from types import MappingProxyType
from typing import Any, Final

from core.motion.prepare import choose_system, prepare
from core.motion.run import compute, label
from core.motion.systems import SYSTEMS
from core.plan.kind import Kind
from core.study.simulate_study import SimulateStudy

_DRIVE: Final = {"frequency": 50, "amplitude": "0.2 mm", "beta": 30, "friction": 0.4}
_PLANE: Final = {"kind": "simulate", "scene": "rectangle-on-plane", "parameters": _DRIVE}
_TRACK: Final = {
    "kind": "simulate",
    "scene": "rectangle-on-track",
    "parameters": {**_DRIVE, "alpha": 5, "radius": "0.2 m"},
}
_PIN: Final = {
    "kind": "simulate",
    "scene": "cylinder-isolated",
    "outputs": ["settling_time"],
    "parameters": {
        "length": "20 mm", "diameter": "8 mm", "drop_height": "10 mm", "pitch": 60,
        "friction": 0.3, "restitution": 0.4, "duration": "0.1 s",
    },
}  # fmt: skip


def _alone_and_shown(study: dict[str, Any], method: str) -> tuple[dict[str, Any], ...]:
    """Return a study by a method, and the same with its motion in time."""
    return {**study, "method": method}, {**study, "method": method, "trajectory": 10}


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
    prepare=prepare,
    choose=lambda sketch: choose_system(sketch.scene, sketch.method, sketch.names),
    compute=compute,
    label=label,
    measures=("motion", "storage"),
    compiles=MappingProxyType(
        {
            "space": _alone_and_shown(_TRACK, "events"),
            "conveying": (
                *_alone_and_shown(_PLANE, "events"),
                *_alone_and_shown(_PLANE, "time-stepping"),
                *_alone_and_shown(_TRACK, "time-stepping"),
                {**_PLANE, "sensitivities": True},
            ),
            "tumbling": (
                *_alone_and_shown(_PIN, "events"),
                {**_PIN, "method": "time-stepping"},
            ),
        }
    ),
)
