"""Carrying out a simulation: scales, motion, and the labelled results."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import (
    Table,
    TableVariable,
    flag_attributes,
    quantity_attributes,
)
from vibrafeed.core.lazy.reduced import Reduced
from vibrafeed.core.motion.course import TRAJECTORY_FLAGS, TrajectoryRequest, TrajectoryValues
from vibrafeed.core.motion.groups import Contacts
from vibrafeed.core.motion.prepare import Simulation, prepare
from vibrafeed.core.motion.systems import CONTACTS
from vibrafeed.core.motion.verify import accuracy, verified, verified_alone
from vibrafeed.core.plan.derived import cells_of
from vibrafeed.core.plan.differences import derivatives
from vibrafeed.core.plan.equations import regimes, run_equations
from vibrafeed.core.plan.labels import (
    coordinates_of,
    global_attributes,
    outputs_of,
    verdict_variables,
)
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.quantities import FLAGS
from vibrafeed.core.study.simulate_study import SimulateStudy
from vibrafeed.core.watch import Watch

TIME = "cycle_time"
"""The axis of a trajectory."""


def compute(prepared: Simulation, watch: Watch) -> Computed:
    """Return the computed arrays of a prepared simulation by name: outputs, regimes and more.

    Derivatives and a trajectory are among them if the study asks for them; a reduced simulation has
    its statistics instead of its cells. `watch` may stop the work.
    """
    if isinstance(prepared, ReducedSimulation):
        return prepared.compute(watch)
    known = _evaluate(prepared, watch)
    plan = prepared.plan
    arrays = {name: _over_own_axes(prepared, name, known[name]) for name in plan.outputs}
    arrays |= {n: _over_own_axes(prepared, n, v) for n, v in regimes(plan, known).items()}
    if prepared.derived is not None:
        asked, part = prepared.derived, plan.part(prepared.derived.outputs)
        found = derivatives(part, cells_of(part, prepared.grid), asked.parameters, watch)
        arrays |= asked.arrays(plan, prepared.grid, prepared.dims, found)
    if prepared.study.trajectory is not None:
        path = _trajectory(prepared, known, watch)
        arrays |= {TIME: path.times, **path.values, **path.flags}
    return Computed(arrays)


def label(prepared: Simulation, computed: Computed, watch: Watch) -> Table:
    """Return the results of a simulation as a labelled table; cells are verified if asked for.

    The table has outputs, regimes, derivatives and trajectory with their dimensions, units and flag
    meanings, and the attributes of the study. `prepared` is the planned simulation, `computed`
    holds its arrays by name; `watch` may stop the verification by another method.
    """
    if isinstance(prepared, ReducedSimulation):
        return prepared.label(computed, watch)
    plan, arrays = prepared.plan, computed.arrays
    variables = outputs_of(prepared, arrays)
    for name, states in FLAGS.items():
        if name in variables:
            told = flag_attributes(name, states, tuple(states))
            variables[name] = replace(variables[name], attributes=told)
    variables |= verdict_variables(plan, prepared.dims, arrays)
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
    """Return the trajectory of the one part of a study, at the times that the study asks for.

    `prepared` is the planned simulation, `known` holds every quantity of its plan by name, with the
    means of the motion; `watch` may stop the work.
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


def _over_own_axes(prepared: Simulation, name: str, values: NDArray[Any]) -> NDArray[Any]:
    """Return `values` over the axes of the grid that the quantity `name` depends on, and no others.

    The others have length 1. A quantity that is the same along one of its own axes is spread over
    it. `prepared` is the simulation, with its grid and the dimensions of each quantity.
    """
    dims, grid = prepared.dims[name], prepared.grid
    if values.ndim:
        unused = tuple(p for p, axis in enumerate(grid.axes) if axis not in dims)
        values = values.squeeze(axis=unused)
    shape = tuple(grid.shape[axis] for axis in dims)
    return values if values.shape == shape else np.broadcast_to(values, shape).copy()


# --- statistics in place of the cells


class ReducedSimulation(Reduced, Simulation):
    """A study of motion of which statistics are reported instead of its cells."""

    study: SimulateStudy

    @property
    def whole(self) -> Simulation:
        """The simulation of all cells."""
        return Simulation(self.study, self.plan, self.grid, known_price=self.price)

    def attributes(self) -> dict[str, str]:
        """Return the attributes of the result, known before computing."""
        plan = self.plan
        told = global_attributes(self, f"motion in time, method {plan.variant}")
        return {**told, "accuracy": accuracy(plan)}

    def verified(self, watch: Watch) -> dict[str, str | int]:
        """Return the verification of random cells as attributes; they are followed anew."""
        return verified_alone(self, watch)


def prepare_reduced(study: SimulateStudy) -> Simulation:
    """Return the prepared simulation of a study: of statistics in place of cells with `reduce`.

    Raises
    ------
    StudyError
        With every problem of scene, method, outputs, settings and parameters.
    """
    prepared = prepare(study)
    if study.reduce is None:
        return prepared
    return ReducedSimulation(prepared.study, prepared.plan, prepared.grid)
