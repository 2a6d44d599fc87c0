"""The kind `simulate`: its record, carrying it out, labelled results, and their verification."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
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
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.feeding import RESOLVED
from vibrafeed.core.motion.method import ANSWERED, STATUS, TIME, Contacts, TrajectoryRequest
from vibrafeed.core.motion.prepare import (
    ERROR,
    Simulation,
    choose_system,
    other_method,
    prepare,
    record_of,
)
from vibrafeed.core.motion.reference.burst import burst_trajectory
from vibrafeed.core.motion.systems import CONTACTS, SYSTEMS, methods_of
from vibrafeed.core.plan.differences import cells_of, derivatives
from vibrafeed.core.plan.grid import from_si
from vibrafeed.core.plan.labels import (
    Sample,
    chosen_positions,
    coordinates_of,
    global_attributes,
    outputs_of,
    sample_of,
    verdict_variables,
)
from vibrafeed.core.plan.pieces import Computed, Kind
from vibrafeed.core.plan.plan import Plan, plan_scene, regimes, run_equations, scene_parameters
from vibrafeed.core.quantities import FLAGS, MOTION_MODES, QUANTITIES
from vibrafeed.core.scenes import Scene
from vibrafeed.core.study.sweep_and_simulate import SimulateStudy
from vibrafeed.core.watch import Watch

EXACT_MEANS = [STATUS[name] for name in ("periodic", "at_rest", "neutral", "settled")]
"""Statuses of motions all of whose outputs two methods should agree on."""

MEANS = [STATUS[name] for name in ANSWERED]
"""Statuses of motions that have a mean velocity, on which two methods agree within their errors."""

VELOCITIES = {
    "conveying_velocity": ERROR,
    **dict.fromkeys(("velocity_x", "velocity_y"), "velocity_error"),
}
"""Mean velocities, and the outputs that state their errors."""

SPEED = ("drive_number", "velocity_scale")


def accuracy(plan: Plan) -> str:
    """Return the known error of a plan's method as a sentence, for the attributes of a result.

    It tells, too, if an output states the error of each cell.
    """
    text = methods_of(plan.scene.name)[plan.variant].accuracy
    gives = plan.scene.outputs(plan.variant)
    error = next((name for name in VELOCITIES.values() if name in gives), None)
    if error is None:
        return text
    statement = error if error in plan.outputs else f"the output {error}, if asked for,"
    return f"{text}; {statement} states it for each cell"


NOT_JUDGED = "verified_not_judged"
"""The attribute that counts the cells of which two methods tell nothing to compare; none if all
are judged. `verified_worst` says why."""


@dataclass(frozen=True)
class Comparison:
    """Outputs of some cells by two methods.

    Attributes
    ----------
    method : str
        The other method.
    evaluated : ndarray of bool
        The cells that the other method followed before a stop.
    compared : ndarray of bool
        The cells that are judged: by all outputs where both methods find the motion to repeat, rest
        or settle, else by their mean velocities.
    output : str
        The output of largest difference, over the largest size of that output, in the former.
    cell : int
        Where it is.
    error, share : float
        The difference [unit of studies], and the same over that size.
    stated : float
        The other method's own estimate of its error there; NaN where it has none.
    means : int
        Cells that are judged by their mean velocities alone.
    strain : float
        The largest difference of these, over what both methods state.
    failed : int
        Cells that are further apart than both methods state, or that repeat after other numbers of
        periods.
    silent : mapping of str to int
        Why cells could not be judged, and how many.
    """

    method: str
    evaluated: NDArray[np.bool_]
    compared: NDArray[np.bool_]
    output: str = ""
    cell: int = -1
    error: float = 0.0
    share: float = 0.0
    stated: float = np.nan
    means: int = 0
    strain: float = 0.0
    failed: int = 0
    silent: Mapping[str, int] = field(default_factory=dict)

    def in_words(self, where: str) -> str:
        """Return the comparison of two methods as a sentence, for the user.

        `where` is the position of the largest difference, in words.
        """
        parts = []
        if self.output:
            unit = QUANTITIES[self.output].unit
            unit = "" if unit == "1" else f" {unit}"
            parts.append(
                f"{self.output} {where}: difference {self.error:.2g}{unit}, {self.share:.2g} of "
                f"its largest size in these cells; {self.compared.sum() - self.means} repeat, rest "
                "or settle by both methods and are compared"
            )
            if np.isfinite(self.stated):
                parts.append(
                    f"the method {self.method} states an error of {self.stated:.2g}{unit} there"
                )
        if self.means:
            parts.append(
                f"{self.means} do not repeat by both, and their mean velocities differ by "
                f"{self.strain:.2g} of both stated errors at most"
            )
        if self.failed:
            parts.append(f"{self.failed} are further apart than both methods state: NOT VERIFIED")
        if self.silent:
            reasons = ", ".join(f"{count} {reason}" for reason, count in self.silent.items())
            parts.append(f"{sum(self.silent.values())} could not be judged: {reasons}")
        return "; ".join(parts)


def compare(
    plan: Plan,
    cells: Mapping[str, Array],
    computed: Mapping[str, Array],
    method: str,
    watch: Watch | None = None,
) -> Comparison:
    """Return the comparison of computed outputs of some cells with those of another method.

    `cells` are parameters in SI units, shape (n,), as all; `computed` are outputs, in the units of
    studies, computed by `plan`. Status, velocity and error are computed again if they are missing.
    `watch` may stop the other method; cells that were not reached are not `evaluated`.
    """
    scene = plan.scene
    available = scene.outputs(method)
    outputs = [name for name in computed if name in available and QUANTITIES[name].compared]
    names = dict.fromkeys([*VELOCITIES, *VELOCITIES.values(), "motion_status"])
    judging = [name for name in names if name in available]
    count = next(iter(computed.values())).size
    theirs = _follow_cells(scene, method, (*outputs, *judging, *SPEED), cells, count, watch)
    ours = computed
    if not set(judging) <= set(computed):  # what was not asked for is computed again
        quiet_watch = None if watch is None else replace(watch, progress=None)
        ours = {
            **_follow_cells(scene, plan.variant, tuple(judging), cells, count, quiet_watch),
            **computed,
        }
    statuses = ours["motion_status"], theirs["motion_status"]
    evaluated = statuses[1] != STATUS["not_computed"]
    is_exact = np.isin(statuses[0], EXACT_MEANS) & np.isin(statuses[1], EXACT_MEANS)
    difference, stated = _velocity_difference(ours, theirs)
    has_means = (
        np.isin(statuses[0], MEANS) & np.isin(statuses[1], MEANS) & ~is_exact & np.isfinite(stated)
    )
    no_periods = np.zeros(statuses[1].shape)
    periods = [
        outputs_of_method.get("period_multiple", no_periods)
        for outputs_of_method in (computed, theirs)
    ]
    differs_in_periods = is_exact & (np.minimum(*periods) > 0) & (periods[0] != periods[1])
    return Comparison(
        method,
        evaluated,
        is_exact | has_means,
        means=int(has_means.sum()),
        strain=float(np.max((difference / stated)[has_means], initial=0.0)),
        failed=int(((is_exact | has_means) & ~(difference <= stated) | differs_in_periods).sum()),
        silent=_reasons(
            method, *(status[evaluated & ~is_exact & ~has_means] for status in statuses)
        ),
        **(_worst(outputs, computed, theirs, is_exact) if is_exact.any() else {}),
    )


def _worst(
    outputs: Sequence[str],
    computed: Mapping[str, Array],
    theirs: Mapping[str, Array],
    is_exact: NDArray[np.bool_],
) -> dict[str, Any]:
    # The output that differs most in the cells that count, over its largest size.
    worst: dict[str, Any] = {}
    for name in outputs:
        reference = np.where(is_exact, theirs[name], 0.0)
        size = float(np.abs(reference).max()) or 1.0
        error = np.where(is_exact, np.abs(computed[name] - reference), 0.0)
        error = np.where(np.isnan(error), np.inf, error)  # a value that only one method has
        cell = int(np.argmax(error))
        relative = float(error[cell]) / size
        if not worst or relative > worst["share"]:
            states = VELOCITIES.get(name, "") in theirs
            stated = float(theirs[VELOCITIES[name]][cell]) if states else np.nan
            worst = {
                "output": name, "cell": cell, "error": float(error[cell]), "share": relative,
                "stated": stated,
            }  # fmt: skip
    return worst


def _reasons(method: str, ours: Array, theirs: Array) -> dict[str, int]:
    # Why cells were not judged, and how many for each reason, most frequent first.
    names = {value: name for name, value in STATUS.items()}
    reasons = Counter[str]()
    for our_status, their_status in zip(ours.tolist(), theirs.tolist(), strict=True):
        if our_status not in EXACT_MEANS and our_status not in MEANS:
            reasons[names[our_status]] += 1
        elif their_status not in EXACT_MEANS and their_status not in MEANS:
            reasons[f"{names[their_status]} by {method}"] += 1
        else:
            reasons["without a stated error"] += 1
    return dict(reasons.most_common())


def _follow_cells(
    scene: Scene,
    method: str,
    outputs: tuple[str, ...],
    cells: Mapping[str, Array],
    count: int,
    watch: Watch | None,
) -> dict[str, Array]:
    # Outputs of given cells by a method, in the units of studies; those that the scene has not are
    # left out, and parameters that only such outputs use are allowed.
    requested = tuple(name for name in outputs if name in scene.outputs(method))
    parameters = [name for name in cells if name in scene_parameters(scene, method)]
    plan = plan_scene(scene, method, requested, parameters, parameters)
    results = run_equations(plan, {name: cells[name] for name in plan.parameters}, watch)
    return {
        name: np.broadcast_to(from_si(name, np.asarray(results[name], dtype=np.float64)), count)
        for name in requested
    }


def _velocity_difference(
    ours: Mapping[str, Array], theirs: Mapping[str, Array]
) -> tuple[Array, Array]:
    # The largest difference of the mean velocities, and what both methods state of their errors; 0
    # and infinity where one of both has no velocity.
    both = [name for name, error in VELOCITIES.items() if {name, error} <= {*ours} & {*theirs}]
    if not both:
        zero = np.zeros_like(theirs["motion_status"])
        return zero, zero + np.inf
    error = VELOCITIES[both[0]]
    drive = theirs["drive_number"] * theirs["velocity_scale"]
    difference = np.maximum.reduce([np.abs(ours[name] - theirs[name]) for name in both])
    return difference, ours[error] + theirs[error] + RESOLVED * drive


def verified(
    prepared: Simulation, arrays: Mapping[str, NDArray[np.generic]], watch: Watch
) -> dict[str, str | int]:
    """Return the outcome of following some cells again by another method; empty if not asked for.

    `arrays` are the computed outputs, SI units; cells that were not computed are not chosen.
    """
    if prepared.study.verify is None:
        return {}
    sample = sample_of(prepared, arrays, ("motion_status", STATUS["not_computed"]))
    return verified_at(prepared, sample, arrays, watch)


def verified_alone(prepared: Simulation, watch: Watch) -> dict[str, str | int]:
    """Return the outcome of following some cells by two methods; empty if not asked for."""
    if prepared.study.verify is None:
        return {}
    places, count = chosen_positions(prepared)
    return verified_at(prepared, Sample(prepared.grid, places, count, count), None, watch)


def verified_at(
    prepared: Simulation,
    sample: Sample,
    arrays: Mapping[str, NDArray[np.generic]] | None,
    watch: Watch,
) -> dict[str, str | int]:
    """Return the outcome of following given cells again by another method, as attributes by name.

    `arrays` are the computed outputs, SI units; if None, the cells are simulated again.
    """
    plan = prepared.plan
    other = other_method(plan, prepared.grid)
    assert other is not None  # the study would have been refused
    against = f"the method {other.name}"
    if not sample.count or watch.stopped():
        return sample.verification_attributes(against)
    cells = prepared.grid.at(sample.positions, sample.count, plan.parameters)
    if arrays is None:
        quantities = run_equations(plan, cells, replace(watch, progress=None))
        values_at_cells = {
            name: np.broadcast_to(quantities[name], sample.count) for name in plan.outputs
        }
    else:
        values_at_cells = {
            name: sample.at(arrays[name], prepared.dims[name]) for name in plan.outputs
        }
    computed = {name: np.asarray(from_si(name, values)) for name, values in values_at_cells.items()}
    comparison = compare(plan, cells, computed, other.name, watch)
    not_judged = sum(comparison.silent.values())
    attributes: dict[str, str | int] = {NOT_JUDGED: not_judged} if not_judged else {}
    evaluated, compared = int(comparison.evaluated.sum()), int(comparison.compared.sum())
    worst = comparison.in_words(sample.where(comparison.cell)) if evaluated else ""
    return attributes | sample.verification_attributes(
        against, worst, evaluated=evaluated, compared=compared, failed=comparison.failed
    )


def compute(prepared: Simulation, watch: Watch) -> Computed:
    """Return the arrays of a simulation by name: outputs, regimes, derivatives and trajectory.

    A reduced simulation has its statistics instead. `watch` may stop the work.
    """
    if isinstance(prepared, ReducedSimulation):
        return prepared.compute(watch)
    plan, grid = prepared.plan, prepared.grid
    # No blocks: the scales have few axes, and the motion itself is shared out by cells.
    parameters = grid.si()
    quantities = run_equations(plan, {name: parameters[name] for name in plan.parameters}, watch)
    results = {name: quantities[name] for name in plan.outputs} | regimes(plan, quantities)
    arrays = {name: _over_own_axes(prepared, name, values) for name, values in results.items()}
    if prepared.derived is not None:
        derived, part = prepared.derived, plan.part(prepared.derived.outputs)
        derived_values = derivatives(part, cells_of(part, grid), derived.parameters, watch)
        arrays |= derived.arrays(plan, grid, prepared.dims, derived_values)
    if prepared.bands is not None:
        arrays |= prepared.bands.arrays(plan, grid, prepared.dims, watch)
    samples, follow = prepared.study.trajectory, prepared.method.course
    if samples is not None:
        assert follow is not None  # the study would have been refused
        long_equations = {
            equation.gives: equation for equation in plan.equations if equation.takes_long
        }
        followed = long_equations.get("burst") or next(iter(long_equations.values()))
        arguments = {name: quantities[name] for name in followed.inputs}
        contacts = CONTACTS.get(plan.scene.name, Contacts())
        if "burst" in long_equations:
            follow = partial(burst_trajectory, record=record_of(prepared.study))
        arrays |= follow(TrajectoryRequest(samples, arguments, quantities, watch), contacts)
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
    for added in prepared.added:
        variables |= added.variables(prepared.dims, arrays)
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
        known = global_attributes(self, f"motion in time, method {self.plan.variant}")
        return {**known, "accuracy": accuracy(self.plan)}

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
    "kind": "simulate", "scene": "row-on-plane", "outputs": ["conveying_velocity"],
    "parameters": {
        "frequency": 50, "amplitude": "0.2 mm", "beta": 30, "part_friction_1": 0.3,
        "part_friction_2": 0.4,
    },
}  # fmt: skip
_WAVED_ROW: Final = {**_ROW, "parameters": {"parts": 2, "part_friction_1": 0.3, **_WAVE}}
_PIN: Final = {
    "kind": "simulate", "scene": "cylinder-isolated", "outputs": ["settling_time"],
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
    requests: list[dict[str, Any]] = [
        {"outputs": ["conveying_velocity"]},
        {"outputs": ["conveying_velocity", "friction_power"]},
        {"trajectory": 10},
    ]
    drives = (_SINE, _WAVE)
    return [
        _motion(scene, {**parameters, **drive}, **request)
        for drive in drives
        for request in requests
    ]


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
            "motion-tumbling": (_PIN, {**_PIN, "trajectory": 10}),
            "motion-rows": (
                *({**row, "trajectory": 10} for row in (_ROW, _WAVED_ROW)),
                *(_ROW, _WAVED_ROW),
            ),
        }
    ),
)
