"""Carrying out a study of uncertain parameters: points, outputs, what is told of them."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.regimes import is_valid
from vibrafeed.core.dataset.table import Table, TableVariable
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.plan import statistics
from vibrafeed.core.plan.equations import regimes, run_equations
from vibrafeed.core.plan.grid import from_si
from vibrafeed.core.plan.labels import coordinates_of, global_attributes, verdict_variables
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.plan.statistics import LEVELS, REPLICATES, values_at
from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.sensitivity.indices import design, indices_of
from vibrafeed.core.sensitivity.prepare import Sensitivity
from vibrafeed.core.sensitivity.variables import LEVEL, QUANTILE, UNCERTAIN
from vibrafeed.core.study.sensitivity_study import Demand
from vibrafeed.core.watch import Watch

BLOCK = 1 << 18
"""Evaluations at a time: a bound on memory, and often enough to report progress."""

Arrays = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class SampledOutputs:
    """Outputs of some designs at points, in the units of studies.

    Attributes
    ----------
    outputs : mapping of str to ndarray
        Shape (designs, ...); NaN where there is no sound value.
    regimes : mapping of str to ndarray of int8
        The regimes by each verdict, of the same shape.
    """

    outputs: Mapping[str, Array]
    regimes: Mapping[str, NDArray[np.int8]]

    def shaped(self, *shape: int) -> SampledOutputs:
        """Return the sampled outputs with points in another shape; designs stay first.

        `shape` is that of the points, without the axis of designs.
        """
        return SampledOutputs(
            {name: one.reshape(-1, *shape) for name, one in self.outputs.items()},
            {name: one.reshape(-1, *shape) for name, one in self.regimes.items()},
        )


def compute(prepared: Sensitivity, watch: Watch) -> Computed:
    """Return all variables of a study with uncertain parameters, in the units of studies.

    Every design, a cell of the grid, is evaluated at many points of the uncertain parameters, and
    the statistics over them are variables over the grid; some have a dimension of their own before
    it. Designs are taken in blocks that fit the memory.

    Raises
    ------
    StoppedError
        If `watch` stops it; there is no result of some points only.
    """
    shape = tuple(prepared.grid.shape.values())
    designs = {
        name: np.broadcast_to(values, shape).reshape(-1, 1)
        for name, values in prepared.grid.si().items()
        if name in prepared.plan.parameters
    }
    step = max(1, BLOCK // prepared.evaluations)
    blocks: dict[str, list[NDArray[Any]]] = defaultdict(list)
    for start in range(0, prepared.cells, step):
        some = {name: values[start : start + step] for name, values in designs.items()}
        count = min(step, prepared.cells - start)
        part = watch.part(count / prepared.cells / prepared.evaluations)
        for name, values in _variables(_Evaluator(prepared, some, count, part)).items():
            blocks[name].append(values)
    # Designs are the last axis; a dimension of an answer stands before it.
    arrays = {name: np.concatenate(parts, axis=-1) for name, parts in blocks.items()}
    return Computed({n: one.reshape((*one.shape[:-1], *shape)) for n, one in arrays.items()})


class _Evaluator:
    """Computes the outputs of some designs at points, and tells a watch of each evaluation."""

    def __init__(
        self, prepared: Sensitivity, designs: Mapping[str, Array], count: int, watch: Watch
    ):
        self.prepared, self.designs, self.count, self.watch = prepared, designs, count, watch
        self.long = sum(one.takes_long for one in prepared.plan.equations)

    def at(self, shares: Array) -> SampledOutputs:
        """Return the outputs at points of the unit box, shape (parameters, ...).

        A coordinate is the share of the parameter's distribution below its value.
        """
        drawn = values_at(self.prepared.uncertain, shares.reshape(len(shares), -1))
        return self.of(drawn).shaped(*shares.shape[1:])

    def of(self, samples: Mapping[str, Array]) -> SampledOutputs:
        """Return outputs and regimes of all designs at values of the uncertain parameters.

        `samples` has the values, SI units, each of shape (n,); the results have the shape (designs,
        n), in the units of studies. Raises `StoppedError` if the watch stops it.
        """
        number = next(iter(samples.values())).size
        step = max(1, BLOCK // self.count)
        parts = []
        for start in range(0, number, step):
            parts.append(self._some({n: part[start : start + step] for n, part in samples.items()}))
            if self.watch.stopped():
                raise StoppedError(
                    "the study was stopped before all its points were computed; run it again"
                )
        return SampledOutputs(
            {n: np.concatenate([part.outputs[n] for part in parts], -1) for n in parts[0].outputs},
            {n: np.concatenate([part.regimes[n] for part in parts], -1) for n in parts[0].regimes},
        )

    def _some(self, samples: Mapping[str, Array]) -> SampledOutputs:
        """Return outputs and regimes of all designs at some points of the uncertain parameters.

        `samples` has the values of these parameters, SI units, shape (points,); the results have
        the shape (designs, points), in the units of studies, NaN where an output has no valid
        value.
        """
        plan, number = self.prepared.plan, next(iter(samples.values())).size
        shape = (self.count, number)
        with np.errstate(all="ignore"):
            part = self.watch.part(number / self.long) if self.long else None
            known = run_equations(plan, {**self.designs, **samples}, part)
            verdicts = {n: np.broadcast_to(one, shape) for n, one in regimes(plan, known).items()}
            valid = {n: is_valid(one) for n, one in verdicts.items()}
        if not self.long:
            self.watch.advance(number)
        outputs = {}
        for name in plan.outputs:
            values = np.asarray(from_si(name, np.asarray(known[name], dtype=np.float64)))
            values = np.broadcast_to(values, shape)
            verdict = plan.verdict_on(name)
            holds = valid[verdict.name] if verdict is not None else True
            outputs[name] = np.where(holds & np.isfinite(values), values, np.nan)
        return SampledOutputs(outputs, verdicts)


def _variables(evaluator: _Evaluator) -> Arrays:
    """Return all variables of a study with uncertain parameters for some designs, by name.

    Designs are the last axis of each array. `evaluator` computes the outputs of these designs at
    points of the uncertain parameters; the variables are statistics over the points, in the units
    of studies.
    """
    prepared = evaluator.prepared
    study = prepared.study
    nominal = evaluator.of(_first(prepared.budget.values()))
    statistics_of: Arrays = {name: one[..., 0] for name, one in nominal.regimes.items()}
    for name, values in _of_points(evaluator):
        statistics_of[name] = values
    if "budget" in study.analyses:
        placed = evaluator.of(prepared.budget.values())
        for name in prepared.outputs:
            told = prepared.budget.budget_of(placed.outputs[name])
            statistics_of |= {f"{name}_{part}": one for part, one in vars(told).items()}
    return {name: statistics_of[name] for name in prepared.dims}


def _first(values: Mapping[str, Array]) -> dict[str, Array]:
    return {name: one[:1] for name, one in values.items()}


def _of_points(evaluator: _Evaluator) -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield name and values of each statistic of points that are sampled from the distributions.

    They are probabilities of demands, then for each output the share of points without a value,
    distribution and Sobol indices. `evaluator` computes outputs of some designs, the last axis of
    each array.
    """
    prepared, study = evaluator.prepared, evaluator.prepared.study
    drawn = {"distribution", "sobol"} & set(study.analyses) or study.demands
    if not drawn:
        none = np.full(evaluator.count, np.nan)
        yield from ((f"{name}_left_out", none) for name in prepared.outputs)
        return
    at = design(len(prepared.uncertain), study.samples // REPLICATES, study.seed)
    # The points a alone tell of distributions, so that they do not hang on what else is asked.
    values = evaluator.at(at if "sobol" in study.analyses else at[:, :1])
    for demand in study.demands:
        estimate = statistics.probability(_met(demand, values))
        yield f"probability_{demand.name}", estimate.value
        yield f"probability_{demand.name}_error", estimate.error
    for name in prepared.outputs:
        output = values.outputs[name]
        first = output[:, 0]
        yield f"{name}_left_out", statistics.share(np.isnan(first))
        if "distribution" in study.analyses:
            mean, deviation = statistics.mean_and_deviation(first)
            shares = statistics.quantiles(first, np.array(study.quantiles))
            pairs = (("mean", mean), ("deviation", deviation), ("quantile", shares))
            for part, estimate in pairs:
                yield f"{name}_{part}", estimate.value
                yield f"{name}_{part}_error", estimate.error
            levels = np.linspace(0.0, 1.0, statistics.LEVELS)
            yield (
                f"{name}_distribution",
                statistics.quantile(first.reshape(len(output), -1), levels),
            )
        if "sobol" in study.analyses:
            for part, estimate in indices_of(output)._asdict().items():
                yield f"{name}_{part}", estimate.T


def _met(demand: Demand, values: SampledOutputs) -> Mask:
    """True where a demand of a study is met, shape (designs, sets, points of a set).

    A demand is a regime, or bounds of an output in the unit of studies. `values` has outputs and
    regimes at the points, with an axis for Sobol's samples after that of the designs, of which the
    first counts. A missing value does not meet a demand.
    """
    if demand.regime is not None:
        wanted = REGIMES[demand.regime].value
        return np.any([one[:, 0] == wanted for one in values.regimes.values()], axis=0)
    output = values.outputs[str(demand.output)][:, 0]
    met = np.isfinite(output)
    if demand.at_least is not None:
        met = met & (output >= demand.at_least)
    if demand.at_most is not None:
        met = met & (output <= demand.at_most)
    return np.asarray(met)


def label(prepared: Sensitivity, computed: Computed, _: Watch) -> Table:
    """Return the results of a study with uncertain parameters as a table.

    The table has coordinates and attributes. `computed` has the bare arrays by name. The watch is
    not used; kinds of studies are called alike.
    """
    arrays, dims = computed.arrays, prepared.dims
    variables = {
        name: TableVariable(dims[name], arrays[name], one.attributes)
        for name, one in prepared.result_variables.items()
    }
    for name, verdict in verdict_variables(prepared.plan, dims, arrays).items():
        comment = f"{verdict.attributes['comment']}; of the nominal values"
        attributes = {**verdict.attributes, "comment": comment}
        variables[name] = replace(verdict, attributes=attributes)
    return Table(
        {**coordinates_of(prepared.plan, prepared.grid), **_coordinates(prepared)},
        variables,
        {
            **global_attributes(prepared, "over uncertain parameters"),
            "uncertain_parameters": _distributions(prepared),
            "evaluations": float(prepared.evaluations) * prepared.cells,
            "accuracy": f"errors are half the widths of 95 % intervals, from {REPLICATES} "
            f"scramblings of {prepared.study.samples // REPLICATES:,} Sobol points",
            **computed.notes,
        },
    )


def _coordinates(prepared: Sensitivity) -> dict[str, TableVariable]:
    """Return the coordinates of a study with uncertain parameters besides the axes of its grid.

    These are the uncertain parameters, the quantiles and the levels of the distribution, shares
    from 0 to 1 at which a value is given; only those that some variable has as a dimension.
    """
    names = [*prepared.uncertain]
    ends = np.linspace(0.0, 1.0, LEVELS)
    uncertain = {
        "long_name": "Uncertain parameter",
        "flag_values": np.arange(len(names), dtype=np.int8),
        "flag_meanings": " ".join(names),
        "comment": "; ".join(f"{name}: {QUANTITIES[name].label}" for name in names),
    }
    share = {"units": "1", "comment": "Share of the points below the value."}
    coordinates = {
        UNCERTAIN: TableVariable((UNCERTAIN,), np.arange(len(names), dtype=np.int8), uncertain),
        QUANTILE: TableVariable(
            (QUANTILE,), np.array(prepared.study.quantiles), {**share, "long_name": "Quantile"}
        ),
        LEVEL: TableVariable((LEVEL,), ends, {**share, "long_name": "Level of the distribution"}),
    }
    used = {dim for dims in prepared.dims.values() for dim in dims}
    return {name: one for name, one in coordinates.items() if name in used}


def _distributions(prepared: Sensitivity) -> str:
    return json.dumps({name: one.canonical() for name, one in prepared.uncertain.items()})
