"""Carrying out a sweep: evaluate, then label."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import core
from core.dataset.table import (
    CONVENTIONS,
    REFERENCES,
    Table,
    Variable,
    quantity_attributes,
    regime_attributes,
)
from core.quantities import QUANTITIES
from core.sweep.evaluate import evaluate
from core.sweep.grid import Grid, from_si
from core.sweep.pieces import Computed, carry_out
from core.sweep.plan import Plan
from core.sweep.prepare import Prepared, Sweep, prepare
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


def tabulate(prepared: Sweep, *, watch: Watch | None = None) -> Table:
    """Return the labelled outputs of a prepared sweep."""
    return carry_out(prepared, compute, label, watch)


def compute(prepared: Sweep, watch: Watch) -> Computed:
    """Return outputs and `regime` of a prepared sweep, SI units; it cannot be stopped."""
    cells = prepared.cells
    return Computed(
        evaluate(prepared.plan, prepared.grid, progress=lambda done: watch.advance(done / cells))
    )


def label(prepared: Sweep, computed: Computed, watch: Watch) -> Table:
    """Return what was computed of a sweep, labelled; `watch` may stop verifying it."""
    plan, arrays = prepared.plan, computed.arrays
    variables = outputs_of(prepared, arrays)
    variables["regime"] = Variable(
        prepared.dims["regime"], arrays["regime"], regime_attributes(plan.regimes)
    )
    attributes = {
        **global_attributes(prepared, "closed-form equations"),
        "accuracy": accuracy(plan.scene.name),
        **verified(prepared, arrays, watch),
    }
    return Table(coordinates_of(plan, prepared.grid), variables, attributes)


def coordinates_of(plan: Plan, grid: Grid) -> dict[str, Variable]:
    """Return the axes of a grid, and the values of fixed parameters and defaults of the plan."""
    coordinates = {
        name: Variable((name,), grid.coordinate(name), quantity_attributes(name))
        for name in grid.axes
    }
    fixed = {name: value for name, value in grid.fixed.items() if name in plan.parameters}
    fixed |= {name: _edge(name, value) for name, value in plan.defaults.items()}
    return coordinates | {
        name: Variable((), np.asarray(value, dtype=np.float64), quantity_attributes(name))
        for name, value in fixed.items()
    }


def outputs_of(prepared: Prepared, arrays: Mapping[str, NDArray[Any]]) -> dict[str, Variable]:
    """Return the asked outputs, labelled; `arrays` are in the units of the code."""
    plan = prepared.plan
    equations = {equation.gives: equation for equation in plan.equations}
    return {
        name: Variable(
            prepared.dims[name],
            from_si(name, arrays[name]),
            quantity_attributes(
                name,
                equation=equations[name].source,
                **{plan.scene.choice: plan.scene.variant_of(plan.variant, name)},
            ),
        )
        for name in plan.outputs
    }


def _edge(name: str, value: float) -> float:
    return float(np.rad2deg(value)) if QUANTITIES[name].is_angle else value


def global_attributes(prepared: Prepared, how: str) -> dict[str, str]:
    """Return the attributes of a whole result; `how` says how it was made."""
    study, plan = prepared.study, prepared.plan
    attributes = {
        "Conventions": CONVENTIONS,
        "title": study.title or plan.scene.title,
        "source": f"vibrafeed {core.__version__}, {how}",
        "references": REFERENCES,
        "comment": plan.scene.validity,
        "scene": plan.scene.name,
        plan.scene.choice: plan.variant,
        "study": study.canonical(),
        "study_sha256": study.key(),
    }
    if study.notes:
        attributes["notes"] = study.notes
    return attributes
