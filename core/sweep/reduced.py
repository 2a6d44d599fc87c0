"""Carrying out a reduced sweep: states of all boxes, answers, labels."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from core.dataset.table import Table, Variable, quantity_attributes
from core.mechanics.arrays import Array
from core.plan.labels import coordinates_of
from core.plan.pieces import Computed
from core.plan.sample import Sample
from core.plan.tiles import Tiled
from core.reduce.state import State
from core.study.reduction import QUANTILE
from core.sweep.answers import attributes_of_answer
from core.sweep.prepare import ReducedSweep
from core.sweep.verify import verified
from core.watch import Watch


def compute(prepared: ReducedSweep, watch: Watch) -> Computed:
    """Return the answers of a reduced sweep, in the units of files.

    Raises
    ------
    StoppedError
        If `watch` stops it.
    """
    units = prepared.work
    return joined(prepared, units.states(0, len(units), watch))


def joined(prepared: ReducedSweep, states: Iterable[tuple[int, int, State]]) -> Computed:
    """Return the answers from what is known of all blocks."""
    from core.reduce.answers import answers  # numba, for those who reduce

    return Computed(answers(prepared.work, prepared.grid, prepared.asked, states))


def label(
    prepared: ReducedSweep, computed: Computed, watch: Watch, common: dict[str, str]
) -> Table:
    """Return the answers, labelled; `common` are the attributes of any sweep."""
    asked, plan = prepared.asked, prepared.plan
    tiled = Tiled(prepared.whole)

    def values_at(sample: Sample) -> dict[str, Array]:
        return tiled.at(sample.places, sample.count)

    exact = {name: one.is_exact for one in prepared.work.boxes for name in one.field.outputs}
    variables = {}
    for name, values in computed.arrays.items():
        of = name.removesuffix(f"_{QUANTILE}")
        attributes = attributes_of_answer(name, asked, plan.outputs, is_exact=exact.get(of, True))
        variables[name] = Variable(prepared.dims[name], values, attributes)
    return Table(
        _coordinates(prepared),
        variables,
        {
            **common,
            "reduced": f"over {', '.join(asked.over)}: {_which(prepared)}",
            **verified(prepared.whole, values_at, watch),
        },
    )


def _coordinates(prepared: ReducedSweep) -> dict[str, Variable]:
    """Return the axes that stay; one that went is its middle, and says from where to where.

    Bounds would say it in CF's own words, but its checker knows none of a scalar.
    """
    asked, grid = prepared.asked, prepared.grid
    found = coordinates_of(prepared.plan, grid)
    for axis in asked.over:
        ends = np.array(sorted((float(found[axis].values[0]), float(found[axis].values[-1]))))
        attributes = {**quantity_attributes(axis), "reduced_range": ends}
        found[axis] = Variable((), np.asarray(ends.mean()), attributes)
    if asked.quantiles:
        attributes = {"units": "1", "long_name": "Quantile"}
        values = np.array(asked.quantiles)
        found[QUANTILE] = Variable((QUANTILE,), values, attributes)
    return found


def _which(prepared: ReducedSweep) -> str:
    if prepared.asked.cells == "all":
        return "all cells with a value count"
    return "cells count whose regime describes a real part and that have a value"
