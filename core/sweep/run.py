"""Carrying out a sweep: evaluate, then label."""

from __future__ import annotations

from typing import TYPE_CHECKING

from core.dataset.table import (
    Table,
    Variable,
    regime_attributes,
)
from core.mechanics.arrays import Array
from core.plan.derived import cells_of
from core.plan.evaluate import evaluate
from core.plan.labels import coordinates_of, global_attributes, outputs_of
from core.plan.pieces import Computed, carry_out
from core.plan.sample import Sample
from core.sweep.prepare import DerivedSweep, ReducedSweep, Sweep, prepare
from core.sweep.verify import accuracy, verified
from core.watch import Watch

if TYPE_CHECKING:
    import xarray

    from core.study import SweepStudy


def sweep(study: SweepStudy) -> xarray.Dataset:
    """Return the dataset of a sweep study.

    Examples
    --------
    >>> from pathlib import Path
    >>> from core.study import load_study
    >>> from core.sweep import sweep
    >>> dataset = sweep(load_study(Path("configs/figures/fig-5-1.toml")))
    """
    return tabulate(prepare(study)).to_xarray()


def tabulate(prepared: Sweep | DerivedSweep | ReducedSweep, *, watch: Watch | None = None) -> Table:
    """Return the labelled outputs of a prepared sweep."""
    return carry_out(prepared, compute, label, watch)


def compute(prepared: Sweep | DerivedSweep | ReducedSweep, watch: Watch) -> Computed:
    """Return outputs and `regime` of a prepared sweep, SI units; it cannot be stopped.

    Of a reduced one, its answers; that can be stopped, and raises `StoppedError` then.
    """
    if isinstance(prepared, ReducedSweep):
        from core.sweep import reduced  # loads the compiler

        return reduced.compute(prepared, watch)
    plan, grid, asked = prepared.plan, prepared.grid, prepared.derived
    arrays = evaluate(plan, grid, threads=watch.threads, progress=watch.advance)
    if asked is not None:
        from core.plan.derivatives import derivatives

        part = plan.part(asked.outputs, ())
        found = derivatives(part, cells_of(part, grid), asked.parameters)
        arrays = {**arrays, **asked.arrays(plan, grid, prepared.dims, found)}
    return Computed(arrays)


def label(prepared: Sweep | DerivedSweep | ReducedSweep, computed: Computed, watch: Watch) -> Table:
    """Return what was computed of a sweep, labelled; `watch` may stop verifying it."""
    if isinstance(prepared, ReducedSweep):
        from core.sweep import reduced

        return reduced.label(prepared, computed, watch, attributes_of(prepared))
    plan, arrays, dims = prepared.plan, computed.arrays, prepared.dims

    def values_at(sample: Sample) -> dict[str, Array]:
        return {name: sample.at(arrays[name], dims[name]) for name in plan.outputs}

    variables = outputs_of(prepared, arrays)
    variables["regime"] = Variable(
        dims["regime"], arrays["regime"], regime_attributes(plan.regimes)
    )
    if prepared.derived is not None:
        variables |= prepared.derived.variables(prepared.dims, arrays)
    attributes = {**attributes_of(prepared), **verified(prepared, values_at, watch)}
    return Table(coordinates_of(plan, prepared.grid), variables, attributes)


def attributes_of(prepared: Sweep | DerivedSweep | ReducedSweep) -> dict[str, str]:
    """Return the attributes of a whole sweep that are known before anything is computed."""
    told = accuracy(prepared.plan.scene)
    if isinstance(prepared, Sweep) and prepared.is_single:
        told += "; then rounded to 32-bit floats, by at most 6e-8 of each value"
    return {**global_attributes(prepared, "closed-form equations"), "accuracy": told}
