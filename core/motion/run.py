"""Carrying out a simulation: scales, motion, and the labelled results."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from numpy.typing import NDArray

from core.dataset.table import (
    Table,
    TableVariable,
    flag_attributes,
    quantity_attributes,
    regime_attributes,
)
from core.motion.course import TRAJECTORY_FLAGS, TrajectoryRequest, TrajectoryValues
from core.motion.derivatives import derivatives_at
from core.motion.groups import Contacts
from core.motion.prepare import Simulation
from core.motion.reduced import ReducedSimulation
from core.motion.systems import CONTACTS
from core.motion.verify import accuracy, verified
from core.plan.derived import cells_of
from core.plan.equations import regimes, run_equations
from core.plan.labels import coordinates_of, global_attributes, outputs_of
from core.plan.pieces import Computed
from core.quantities import FLAGS
from core.watch import Watch

TIME = "cycle_time"
"""The axis of a trajectory."""


def compute(prepared: Simulation, watch: Watch) -> Computed:
    """Return outputs and `regime` of a prepared simulation, and its trajectory if asked for.

    A reduced simulation gives its statistics instead of its cells.
    """
    if isinstance(prepared, ReducedSimulation):
        return prepared.compute(watch)
    known = _evaluate(prepared, watch)
    plan = prepared.plan
    arrays = {name: _drop_unused_axes(prepared, name, known[name]) for name in plan.outputs}
    arrays["regime"] = _drop_unused_axes(prepared, "regime", regimes(plan, known))
    if prepared.derived is not None:
        asked, part = prepared.derived, plan.part(prepared.derived.outputs, ())
        found = derivatives_at(part, cells_of(part, prepared.grid), asked.parameters, watch)
        arrays |= asked.arrays(plan, prepared.grid, prepared.dims, found)
    if prepared.study.trajectory is not None:
        path = _trajectory(prepared, known, watch)
        arrays |= {TIME: path.times, **path.values, **path.flags}
    return Computed(arrays)


def label(prepared: Simulation, computed: Computed, watch: Watch) -> Table:
    """Return the results of a simulation as a labelled table; cells are verified if asked for.

    `computed` holds the arrays by name; `watch` may stop the verification.
    """
    if isinstance(prepared, ReducedSimulation):
        return prepared.label(computed, watch)
    plan, arrays = prepared.plan, computed.arrays
    variables = outputs_of(prepared, arrays)
    for name, states in FLAGS.items():
        if name in variables:
            told = flag_attributes(name, states, tuple(states))
            variables[name] = replace(variables[name], attributes=told)
    variables["regime"] = TableVariable(
        prepared.dims["regime"], arrays["regime"], regime_attributes(plan.regimes)
    )
    if prepared.derived is not None:
        variables |= prepared.derived.variables(prepared.dims, arrays)
    coordinates = coordinates_of(plan, prepared.grid)
    for name in arrays:
        if name == TIME:
            coordinates[name] = TableVariable((TIME,), arrays[name], quantity_attributes(name))
        elif name in TRAJECTORY_FLAGS:
            flags = TRAJECTORY_FLAGS[name]
            attributes = flag_attributes(name, flags, tuple(flags))
            variables[name] = TableVariable((TIME,), arrays[name], attributes)
        elif name not in variables:
            variables[name] = TableVariable((TIME,), arrays[name], quantity_attributes(name))
    attributes = {
        **global_attributes(prepared, f"motion in time, method {plan.variant}"),
        "accuracy": accuracy(plan),
        **verified(prepared, arrays, watch),
    }
    return Table(coordinates, variables, attributes)


def _evaluate(prepared: Simulation, watch: Watch) -> dict[str, Any]:
    """Return every quantity of the plan, each over the axes that it depends on.

    The scales before the motion have few axes, and the motion itself is shared out among threads
    by cells: there is nothing to gain from blocks.
    """
    plan, given = prepared.plan, prepared.grid.si()
    return run_equations(plan, {name: given[name] for name in plan.parameters}, watch)


def _trajectory(prepared: Simulation, known: dict[str, Any], watch: Watch) -> TrajectoryValues:
    """Return the trajectory of the part at the times of the study.

    `known` holds every quantity of the plan.
    """
    samples, scene = prepared.study.trajectory, prepared.plan.scene.name
    follow = prepared.method.course
    assert samples is not None
    assert follow is not None  # the study would have been refused
    motion = next(equation for equation in prepared.plan.equations if equation.takes_long)
    arguments = {name: known[name] for name in motion.inputs}
    return follow(CONTACTS.get(scene, Contacts()))(
        TrajectoryRequest(samples, arguments, known, watch)
    )


def _drop_unused_axes(prepared: Simulation, name: str, values: NDArray[Any]) -> NDArray[Any]:
    """Return values without the grid axes that the quantity `name` does not depend on."""
    if not values.ndim:
        return values
    dims = prepared.dims[name]
    positions = enumerate(prepared.grid.axes)
    return values.squeeze(axis=tuple(p for p, axis in positions if axis not in dims))
