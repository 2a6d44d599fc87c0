"""The kind `simulate`: its record, carrying it out, and the labelled results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import (
    Table,
    TableVariable,
    flag_attributes,
    quantity_attributes,
)
from vibrafeed.core.lazy.reduced import Reduced
from vibrafeed.core.motion.groups import Contacts
from vibrafeed.core.motion.method import TIME, TrajectoryRequest
from vibrafeed.core.motion.prepare import Simulation, choose_system, prepare
from vibrafeed.core.motion.systems import CONTACTS, SYSTEMS
from vibrafeed.core.motion.verify import accuracy, verified, verified_alone
from vibrafeed.core.plan.differences import cells_of, derivatives
from vibrafeed.core.plan.equations import regimes, run_equations
from vibrafeed.core.plan.kind import Kind
from vibrafeed.core.plan.labels import (
    coordinates_of,
    global_attributes,
    outputs_of,
    verdict_variables,
)
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.quantities import FLAGS, MOTION_MODES
from vibrafeed.core.study.sweep_and_simulate import SimulateStudy
from vibrafeed.core.watch import Watch


def compute(prepared: Simulation, watch: Watch) -> Computed:
    """Return the arrays of a simulation by name: outputs, regimes, derivatives and trajectory.

    A reduced simulation has its statistics instead. `watch` may stop the work.
    """
    if isinstance(prepared, ReducedSimulation):
        return prepared.compute(watch)
    plan, grid = prepared.plan, prepared.grid
    # No blocks: the scales have few axes, and the motion itself is shared out by cells.
    given = grid.si()
    known = run_equations(plan, {name: given[name] for name in plan.parameters}, watch)
    asked = {name: known[name] for name in plan.outputs} | regimes(plan, known)
    arrays = {name: _over_own_axes(prepared, name, values) for name, values in asked.items()}
    if prepared.derived is not None:
        derived, part = prepared.derived, plan.part(prepared.derived.outputs)
        found = derivatives(part, cells_of(part, grid), derived.parameters, watch)
        arrays |= derived.arrays(plan, grid, prepared.dims, found)
    samples, follow = prepared.study.trajectory, prepared.method.course
    if samples is not None:
        assert follow is not None  # the study would have been refused
        motion = next(equation for equation in plan.equations if equation.takes_long)
        arguments = {name: known[name] for name in motion.inputs}
        contacts = CONTACTS.get(plan.scene.name, Contacts())
        arrays |= follow(TrajectoryRequest(samples, arguments, known, watch), contacts)
    return Computed(arrays)


def _over_own_axes(prepared: Simulation, name: str, values: NDArray[Any]) -> NDArray[Any]:
    # A quantity that is the same along one of its own axes is spread over it.
    dims, grid = prepared.dims[name], prepared.grid
    if values.ndim:
        unused = tuple(p for p, axis in enumerate(grid.axes) if axis not in dims)
        values = values.squeeze(axis=unused)
    shape = tuple(grid.shape[axis] for axis in dims)
    return values if values.shape == shape else np.broadcast_to(values, shape).copy()


def label(prepared: Simulation, computed: Computed, watch: Watch) -> Table:
    """Return the results of a simulation as a labelled table; cells are verified if asked for.

    `watch` may stop the verification by another method.
    """
    if isinstance(prepared, ReducedSimulation):
        return prepared.label(computed, watch)
    plan, arrays = prepared.plan, computed.arrays
    variables = outputs_of(prepared, arrays)
    for name in FLAGS.keys() & variables.keys():
        variables[name] = replace(variables[name], attributes=_attributes(name))
    variables |= verdict_variables(plan, prepared.dims, arrays)
    if prepared.derived is not None:
        variables |= prepared.derived.variables(prepared.dims, arrays)
    coordinates = coordinates_of(plan, prepared.grid)
    for name in [name for name in arrays if name not in variables]:
        of_trajectory = coordinates if name == TIME else variables
        of_trajectory[name] = TableVariable((TIME,), arrays[name], _attributes(name))
    attributes = {
        **global_attributes(prepared, f"motion in time, method {plan.variant}"),
        "accuracy": accuracy(plan),
        **verified(prepared, arrays, watch),
    }
    return Table(coordinates, variables, attributes)


def _attributes(name: str) -> Any:
    states = MOTION_MODES if name == "motion_mode" else FLAGS.get(name)
    return flag_attributes(name, states, tuple(states)) if states else quantity_attributes(name)


# --- statistics in place of the cells


class ReducedSimulation(Reduced, Simulation):
    """A study of motion of which statistics are reported instead of its cells."""

    study: SimulateStudy

    @property
    def whole(self) -> Simulation:
        """The simulation of all cells."""
        return Simulation(self.study, self.plan, self.grid)

    def attributes(self) -> dict[str, str]:
        """Return the attributes of the result, known before computing."""
        told = global_attributes(self, f"motion in time, method {self.plan.variant}")
        return {**told, "accuracy": accuracy(self.plan)}

    def verified(self, watch: Watch) -> dict[str, str | int]:
        """Return the verification of random cells as attributes; they are followed anew."""
        return verified_alone(self, watch)


def _prepare(study: SimulateStudy) -> Simulation:
    prepared = prepare(study)
    if study.reduce is None:
        return prepared
    return ReducedSimulation(prepared.study, prepared.plan, prepared.grid)


# --- the record


_SINE: Final = {"frequency": 50, "amplitude": "0.2 mm", "beta": 30, "friction": 0.4}
_WAVE: Final = {
    "frequency": 50, "friction": 0.4, "amplitude_along_1": "0.2 mm", "amplitude_normal_1": "0.1 mm",
    "amplitude_normal_2": "0.05 mm", "phase_normal_2": 30,
}  # fmt: skip
_RESTLESS: Final = {"restitution": [0.2, 0.4, 0.6, 0.8]}
_PLANE: Final = "rectangle-on-plane"
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
_PIN: Final = {
    "kind": "simulate",
    "scene": "cylinder-isolated",
    "outputs": ["settling_time"],
    "parameters": {
        "length": "20 mm", "diameter": "8 mm", "drop_height": "10 mm", "pitch": 60,
        "friction": 0.3, "restitution": 0.4, "duration": "0.1 s",
    },
}  # fmt: skip


def _motion(scene: str, parameters: Mapping[str, Any], **more: Any) -> dict[str, Any]:
    # A study of few periods, whose run compiles kernels.
    return {
        "kind": "simulate", "scene": scene, "parameters": parameters,
        "max_periods": 20, **more,
    }  # fmt: skip


def _all(scene: str, **parameters: Any) -> list[dict[str, Any]]:
    # Together they run, and so compile, all kernels of a scene's motion, for sines and waves.
    asked: list[dict[str, Any]] = [
        {"outputs": ["conveying_velocity"]},
        {"outputs": ["conveying_velocity", "friction_power"]},
        {"trajectory": 10},
    ]
    drives = (_SINE, _WAVE)
    return [_motion(scene, {**parameters, **drive}, **more) for drive in drives for more in asked]


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
    prepare=_prepare,
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
            "motion-track": (
                *_all("rectangle-on-track", radius="0.2 m"),
                *_all("cylinder-on-plane"),
            ),
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
