"""Carrying out a study of uncertain parameters: points, outputs, what is told of them."""

import json
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.table import Table, TableVariable, is_valid
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.plan import statistics
from vibrafeed.core.plan.grid import from_si
from vibrafeed.core.plan.labels import coordinates_of, global_attributes, verdict_variables
from vibrafeed.core.plan.pieces import Computed, Kind
from vibrafeed.core.plan.plan import regimes, run_equations
from vibrafeed.core.plan.statistics import LEVELS, REPLICATES, values_at
from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.sensitivity.indices import design, indices_of
from vibrafeed.core.sensitivity.prepare import (
    LEVEL,
    QUANTILE,
    UNCERTAIN,
    Sensitivity,
    choose,
    prepare,
)
from vibrafeed.core.study.sensitivity_study import Demand, SensitivityStudy
from vibrafeed.core.watch import Watch

BLOCK = 1 << 18
"""Evaluations at a time: a bound on memory, and often enough to report progress."""

Arrays = dict[str, NDArray[Any]]


def compute(prepared: Sensitivity, watch: Watch) -> Computed:
    """Return all variables of a study with uncertain parameters, in the units of studies.

    Every design, a cell of the grid, is evaluated at many points of the uncertain parameters, and
    the statistics over them are variables over the grid; some have a dimension of their own before
    it. Designs are taken in blocks that fit the memory.
    """
    shape = tuple(prepared.grid.shape.values())
    designs = {
        name: np.broadcast_to(values, shape).reshape(-1, 1)
        for name, values in prepared.grid.si().items()
        if name in prepared.plan.parameters
    }
    designs_at_a_time = max(1, BLOCK // prepared.evaluations)
    blocks: dict[str, list[NDArray[Any]]] = defaultdict(list)
    for start in range(0, prepared.cells, designs_at_a_time):
        block_designs = {
            name: values[start : start + designs_at_a_time] for name, values in designs.items()
        }
        count = min(designs_at_a_time, prepared.cells - start)
        part_watch = watch.part(count / prepared.cells / prepared.evaluations)
        for name, values in _variables(
            _Evaluator(prepared, block_designs, count, part_watch)
        ).items():
            blocks[name].append(values)
    # Designs are the last axis; a dimension of an answer stands before it.
    arrays = {name: np.concatenate(parts, axis=-1) for name, parts in blocks.items()}
    return Computed(
        {name: values.reshape((*values.shape[:-1], *shape)) for name, values in arrays.items()}
    )


class _Evaluator:
    """Computes outputs and verdicts of some designs, and tells a watch of each evaluation."""

    def __init__(
        self, prepared: Sensitivity, designs: Mapping[str, Array], count: int, watch: Watch
    ):
        self.prepared, self.designs, self.count, self.watch = prepared, designs, count, watch
        self.long = sum(equation.takes_long for equation in prepared.plan.equations)

    def of(self, samples: Mapping[str, Array]) -> Arrays:
        """Return outputs and regimes of all designs at values of the uncertain parameters.

        `samples` has the values, SI units, each of shape (n,); the results have the shape (designs,
        n), in the units of studies; outputs are NaN where there is no sound value. Raises
        `StoppedError` if the watch stops it.
        """
        points = next(iter(samples.values())).size
        points_at_a_time = max(1, BLOCK // self.count)
        parts = []
        for start in range(0, points, points_at_a_time):
            parts.append(
                self._evaluate(
                    {name: part[start : start + points_at_a_time] for name, part in samples.items()}
                )
            )
            if self.watch.stopped():
                raise StoppedError(
                    "the study was stopped before all its points were computed; run it again"
                )
        return {name: np.concatenate([part[name] for part in parts], -1) for name in parts[0]}

    def _evaluate(self, samples: Mapping[str, Array]) -> Arrays:
        # Outputs, NaN where a regime is not valid, and regimes, shape (designs, points).
        plan, points = self.prepared.plan, next(iter(samples.values())).size
        shape = (self.count, points)
        with np.errstate(all="ignore"):
            part_watch = self.watch.part(points / self.long) if self.long else None
            results = run_equations(plan, {**self.designs, **samples}, part_watch)
            arrays: Arrays = {
                name: np.broadcast_to(verdict_values, shape)
                for name, verdict_values in regimes(plan, results).items()
            }
        if not self.long:
            self.watch.advance(points)
        valid = {name: is_valid(verdict) for name, verdict in arrays.items()}
        for name in plan.outputs:
            values = np.asarray(from_si(name, np.asarray(results[name], dtype=np.float64)))
            verdict = plan.verdict_on(name)
            is_sound = valid[verdict.name] if verdict is not None else True
            values = np.where(is_sound & np.isfinite(values), values, np.nan)
            arrays[name] = np.broadcast_to(values, shape)
        return arrays


def _variables(evaluator: _Evaluator) -> Arrays:
    prepared = evaluator.prepared
    study = prepared.study
    points = prepared.budget.values()
    nominal = evaluator.of({name: numbers[:1] for name, numbers in points.items()})
    statistics_of = {name: nominal[name][..., 0] for name in prepared.plan.verdict_names}
    statistics_of |= dict(_statistics_of_points(evaluator))
    if "budget" in study.analyses:
        at_points = evaluator.of(points)
        for name in prepared.outputs:
            budget = prepared.budget.budget_of(at_points[name])
            statistics_of |= {
                f"{name}_{statistic}": numbers for statistic, numbers in vars(budget).items()
            }
    return {name: statistics_of[name] for name in prepared.dims}


def _statistics_of_points(evaluator: _Evaluator) -> Iterator[tuple[str, NDArray[Any]]]:
    prepared, study = evaluator.prepared, evaluator.prepared.study
    if not ({"distribution", "sobol"} & set(study.analyses) or study.demands):
        unknown = np.full(evaluator.count, np.nan)
        yield from ((f"{name}_left_out", unknown) for name in prepared.outputs)
        return
    unit_points = design(len(prepared.uncertain), study.samples // REPLICATES, study.seed)
    if "sobol" not in study.analyses:
        unit_points = unit_points[:, :1]  # distributions use these, with Sobol indices or without
    evaluated = evaluator.of(
        values_at(prepared.uncertain, unit_points.reshape(len(unit_points), -1))
    )
    values = {
        name: values_of_output.reshape(-1, *unit_points.shape[1:])
        for name, values_of_output in evaluated.items()
    }
    for demand in study.demands:
        estimate = statistics.probability(_is_met(demand, values, prepared.plan.verdict_names))
        yield f"probability_{demand.name}", estimate.value
        yield f"probability_{demand.name}_error", estimate.error
    for name in prepared.outputs:
        output = values[name]
        sampled = output[:, 0]
        yield f"{name}_left_out", statistics.fraction_of(np.isnan(sampled))
        if "distribution" in study.analyses:
            mean, deviation = statistics.mean_and_deviation(sampled)
            quantiles = statistics.quantiles(sampled, np.array(study.quantiles))
            pairs = (("mean", mean), ("deviation", deviation), ("quantile", quantiles))
            for part, estimate in pairs:
                yield f"{name}_{part}", estimate.value
                yield f"{name}_{part}_error", estimate.error
            levels = np.linspace(0.0, 1.0, statistics.LEVELS)
            yield (
                f"{name}_distribution",
                statistics.quantile(sampled.reshape(len(output), -1), levels),
            )
        if "sobol" in study.analyses:
            for part, estimate in indices_of(output)._asdict().items():
                yield f"{name}_{part}", estimate.T


def _is_met(demand: Demand, values: Arrays, verdicts: Iterable[str]) -> Mask:
    if demand.regime is not None:
        regime_value = REGIMES[demand.regime].value
        return np.any([values[name][:, 0] == regime_value for name in verdicts], axis=0)
    output = values[str(demand.output)][:, 0]
    is_met = np.isfinite(output)
    if demand.at_least is not None:
        is_met = is_met & (output >= demand.at_least)
    if demand.at_most is not None:
        is_met = is_met & (output <= demand.at_most)
    return np.asarray(is_met)


def label(prepared: Sensitivity, computed: Computed, _: Watch) -> Table:
    """Return the results of a study with uncertain parameters as a table.

    The table has coordinates and attributes. `computed` has the bare arrays by name. The watch is
    not used; kinds of studies are called alike.
    """
    arrays, dims = computed.arrays, prepared.dims
    variables = {
        name: TableVariable(dims[name], arrays[name], variable.attributes)
        for name, variable in prepared.result_variables.items()
    }
    for name, verdict in verdict_variables(prepared.plan, dims, arrays).items():
        attributes = {
            **verdict.attributes,
            "comment": f"{verdict.attributes['comment']}; of the nominal values",
        }
        variables[name] = replace(verdict, attributes=attributes)
    return Table(
        {**coordinates_of(prepared.plan, prepared.grid), **_coordinates(prepared)},
        variables,
        {
            **global_attributes(prepared, "over uncertain parameters"),
            "uncertain_parameters": json.dumps(
                {
                    name: distribution.canonical()
                    for name, distribution in prepared.uncertain.items()
                }
            ),
            "evaluations": float(prepared.evaluations) * prepared.cells,
            "accuracy": f"errors are half the widths of 95 % intervals, from {REPLICATES} "
            f"scramblings of {prepared.study.samples // REPLICATES:,} Sobol points",
            **computed.notes,
        },
    )


def _coordinates(prepared: Sensitivity) -> dict[str, TableVariable]:
    names = [*prepared.uncertain]
    levels = np.linspace(0.0, 1.0, LEVELS)
    uncertain = {
        "long_name": "Uncertain parameter",
        "flag_values": np.arange(len(names), dtype=np.int8),
        "flag_meanings": " ".join(names),
        "comment": "; ".join(f"{name}: {QUANTITIES[name].label}" for name in names),
    }
    attributes = {"units": "1", "comment": "Share of the points below the value."}
    coordinates = {
        UNCERTAIN: TableVariable((UNCERTAIN,), np.arange(len(names), dtype=np.int8), uncertain),
        QUANTILE: TableVariable(
            (QUANTILE,), np.array(prepared.study.quantiles), {**attributes, "long_name": "Quantile"}
        ),
        LEVEL: TableVariable(
            (LEVEL,), levels, {**attributes, "long_name": "Level of the distribution"}
        ),
    }
    used = {dim for dims in prepared.dims.values() for dim in dims}
    return {name: coordinate for name, coordinate in coordinates.items() if name in used}


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
