"""Labels of what is told of uncertain parameters."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np

from vibrafeed.core.dataset.table import Table, TableVariable
from vibrafeed.core.plan.labels import coordinates_of, global_attributes, verdict_variables
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.plan.replicates import REPLICATES
from vibrafeed.core.plan.statistics import LEVELS
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.sensitivity.prepare import Sensitivity
from vibrafeed.core.sensitivity.variables import LEVEL, QUANTILE, UNCERTAIN
from vibrafeed.core.watch import Watch


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
    """Return the distributions as JSON text, in the units of studies."""
    return json.dumps({name: one.canonical() for name, one in prepared.uncertain.items()})
