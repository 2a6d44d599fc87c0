"""The cells of a sweep: evaluated, then labelled."""

from __future__ import annotations

import numpy as np

from vibrafeed.core.dataset.table import Table
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.derived import cells_of
from vibrafeed.core.plan.differences import derivatives
from vibrafeed.core.plan.evaluate import evaluate
from vibrafeed.core.plan.labels import (
    coordinates_of,
    global_attributes,
    outputs_of,
    verdict_variables,
)
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plan.sample import Sample
from vibrafeed.core.sweep.verify import accuracy, verified
from vibrafeed.core.watch import Watch


def compute(prepared: Prepared, watch: Watch) -> Computed:
    """Return the outputs and verdicts of a sweep in SI units, with derivatives if the study asks.

    `watch` has the number of threads and takes the progress.
    """
    plan, grid, asked = prepared.plan, prepared.grid, prepared.derived
    arrays = evaluate(plan, grid, threads=watch.threads, progress=watch.advance)
    if asked is not None:
        part = plan.part(asked.outputs)
        found = derivatives(part, cells_of(part, grid), asked.parameters)
        arrays = {**arrays, **asked.arrays(plan, grid, prepared.dims, found)}
    return Computed(arrays)


def label(prepared: Prepared, computed: Computed, watch: Watch) -> Table:
    """Return the results of a sweep as a table, verified if the study asks for it.

    `computed` has the bare arrays by name; `watch` may stop the verification.
    """
    plan, arrays, dims = prepared.plan, computed.arrays, prepared.dims

    def values_at(sample: Sample) -> dict[str, Array]:
        """Return the outputs at sampled cells."""
        return {name: sample.at(arrays[name], dims[name]) for name in plan.outputs}

    variables = outputs_of(prepared, arrays) | verdict_variables(plan, dims, arrays)
    if prepared.derived is not None:
        variables |= prepared.derived.variables(prepared.dims, arrays)
    attributes = {**attributes_of(prepared), **verified(prepared, values_at, watch)}
    return Table(coordinates_of(plan, prepared.grid), variables, attributes)


def verified_alone(prepared: Prepared, watch: Watch) -> dict[str, str | int]:
    """Return the verification of random cells as attributes; the cells are computed alone."""

    def values_at(sample: Sample) -> dict[str, Array]:
        boxes = [
            {dim: (int(at[k]), int(at[k]) + 1) for dim, at in sample.positions.items()}
            for k in range(sample.count)
        ]
        plan = prepared.plan
        cells = [evaluate(plan, prepared.grid.piece(box, plan.parameters)) for box in boxes]
        return {name: np.array([cell[name].item() for cell in cells]) for name in plan.outputs}

    return verified(prepared, values_at, watch)


def attributes_of(prepared: Prepared) -> dict[str, str]:
    """Return attributes of a sweep's result known before computing: study, source and accuracy."""
    told = accuracy(prepared.plan.scene)
    if getattr(prepared.study, "precision", None) == "single":
        told += "; then rounded to 32-bit floats, by at most 6e-8 of each value"
    return {**global_attributes(prepared, "closed-form equations"), "accuracy": told}
