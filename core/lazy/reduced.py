"""The section `[reduce]`: the result of a study holds statistics over some axes, and no cells."""

import math
from collections.abc import Iterator
from functools import cached_property
from typing import Any, ClassVar, Final, NamedTuple

import numpy as np

from vibrafeed.core import lazy  # whose modules load dask when they are needed
from vibrafeed.core.dataset.table import Table, TableVariable, quantity_attributes
from vibrafeed.core.errors import Problem
from vibrafeed.core.plan.labels import coordinates_of
from vibrafeed.core.plan.pieces import Computed
from vibrafeed.core.plan.plan import Verdict
from vibrafeed.core.plan.prepared import Prepared, in_words
from vibrafeed.core.quantities import FLAGS, QUANTITIES, REGIMES
from vibrafeed.core.study.reduction import QUANTILE, LevelSet, Reduction, ShareCondition
from vibrafeed.core.study.sweep_and_simulate import SimulateStudy, SweepStudy
from vibrafeed.core.system import cores
from vibrafeed.core.watch import Watch

STATISTICS: Final = {
    "max": ("Largest", "maximum"),
    "min": ("Least", "minimum"),
    "mean": ("Mean of", "mean"),
    "std": ("Standard deviation of", "standard_deviation"),
}
"""Words of a statistic in the long name and in the CF attribute `cell_methods`."""


class Statistic(NamedTuple):
    """A variable of a reduced result, before it is computed.

    Attributes
    ----------
    name : str
        Its name.
    dims : tuple of str
        Its dimensions: the axes that stay.
    attributes : dict
        Its CF attributes.
    what : str
        A statistic, or ``count``, ``quantile``, ``regime``, ``share`` or ``level``.
    of : str
        The output or verdict.
    axis : str
        The axis whose value at an extreme it has.
    conditions : tuple of ShareCondition
        The conditions that cells meet, of a share or a regime.
    level : LevelSet, optional
        The level.
    """

    name: str
    dims: tuple[str, ...]
    attributes: dict[str, Any]
    what: str
    of: str = ""
    axis: str = ""
    conditions: tuple[ShareCondition, ...] = ()
    level: LevelSet | None = None


class Reduced(Prepared):
    """A study whose result holds statistics over some axes in place of all cells.

    `cells` is the number of cells that are evaluated, `stored` that of the points of the result.
    """

    study: SweepStudy | SimulateStudy
    keeps_some: ClassVar[bool] = False

    @property
    def whole(self) -> Prepared:
        """The study of all cells."""
        raise NotImplementedError

    @property
    def not_lazy(self) -> Problem | None:
        """The problem with computing cells on reading: a reduction has none."""
        message = "the result of a study with [reduce] has statistics, but no single cells"
        return Problem("reduce", message, "Remove [reduce]")

    @property
    def reduction(self) -> Reduction:
        """The reduction that the study asks for."""
        assert self.study.reduce is not None
        return self.study.reduce

    def attributes(self) -> dict[str, str]:
        """Return the attributes of the result that are known before computing."""
        raise NotImplementedError

    def verified(self, watch: Watch) -> dict[str, str | int]:
        """Return the verification result as attributes; `watch` may stop it."""
        raise NotImplementedError

    @cached_property
    def cell_dims(self) -> dict[str, tuple[str, ...]]:
        """The axes of each output and verdict before they are reduced."""
        depends = self.plan.depends_on(self.grid.along)
        names = (*self.plan.outputs, *self.plan.verdict_names)
        return {name: self.grid.dims(depends[name]) for name in names}

    def judge(self, output: str) -> Verdict | None:
        """Return the verdict that keeps cells of an output from counting; None if all count."""
        verdict = self.plan.verdict_on(output) if output in self.plan.outputs else None
        return verdict if verdict and verdict.doubts and self.reduction.cells == "valid" else None

    def remaining_dims(self, *names: str) -> tuple[str, ...]:
        """Return the axes that stay of some variables together, with the verdicts on them."""
        judges = [judge.name for name in names if (judge := self.judge(name))]
        dims = {dim for name in (*names, *judges) for dim in self.cell_dims[name]}
        return self.grid.dims(dims - {*self.reduction.over})

    @cached_property
    def statistics(self) -> tuple[Statistic, ...]:
        """The variables of the result."""
        return tuple(statistics_of(self))

    @cached_property
    def dims(self) -> dict[str, tuple[str, ...]]:
        """The dimensions of each variable."""
        return {statistic.name: statistic.dims for statistic in self.statistics}

    @cached_property
    def units(self) -> dict[str, str]:
        """The unit of each variable."""
        return {statistic.name: statistic.attributes["units"] for statistic in self.statistics}

    @property
    def sizes(self) -> dict[str, int]:
        """The length of each dimension."""
        return {**self.grid.shape, QUANTILE: len(self.reduction.quantiles)}

    @property
    def stored(self) -> int:
        """The number of points of the largest variable."""
        return max(math.prod(self.sizes[dim] for dim in dims) for dims in self.dims.values())

    @property
    def cut_axes(self) -> tuple[str, ...]:
        """The axes along which the study can be cut: those that stay."""
        return tuple(axis for axis in self.grid.axes if axis not in self.reduction.over)

    def what_fits(self, fraction: float) -> str:
        """Return a sentence that says how to shrink the study to a share of its size."""
        return f"It fits over more axes, or with fewer values of {', '.join(self.cut_axes)}"

    def compute(self, watch: Watch) -> Computed:
        """Return the variables in the units of files.

        Raises
        ------
        StoppedError
            If `watch` stops it.
        """
        return Computed(lazy.statistics.compute(self, watch))

    @property
    def needed(self) -> set[str]:
        """The outputs and verdicts that the answers need."""
        names = {statistic.of for statistic in self.statistics if statistic.of}
        return names | {
            condition.name for statistic in self.statistics for condition in statistic.conditions
        }

    def label(self, computed: Computed, watch: Watch) -> Table:
        """Return the results of a reduction as a table: arrays with coordinates and attributes.

        Some cells of the study are verified here by other means, which `watch` may stop.
        """
        variables = {
            statistic.name: TableVariable(
                statistic.dims, computed.arrays[statistic.name], statistic.attributes
            )
            for statistic in self.statistics
        }
        counting_cells = (
            "all cells with a value count"
            if self.reduction.cells == "all"
            else "cells count whose regime describes a real part and that have a value"
        )
        attributes = {
            **self.attributes(),
            "reduced": f"over {', '.join(self.reduction.over)}: {counting_cells}",
            **self.verified(watch),
        }
        return Table(_coordinates(self), variables, attributes)

    @property
    def seconds_here(self) -> float:
        """The price of the study on this machine [s]: that of its cells over all cores."""
        return self.seconds / cores()

    @property
    def size_in_words(self) -> str:
        """A text with cells, values of the result and time, to show before a study is run."""
        return (
            f"{self.cells:,} cells reduced to {self.bytes // 8:,} values, {self.bytes:,} bytes; "
            f"some {in_words(self.seconds_here)} here"
        )


def _coordinates(prepared: Reduced) -> dict[str, TableVariable]:
    # Ranges are attributes: CF has bounds for them, which its checker does not accept of scalars.
    reduction, grid = prepared.reduction, prepared.grid
    coordinates = coordinates_of(prepared.plan, grid)
    paired_names = [name for name, axis in grid.along.items() if axis in reduction.over]
    for axis in dict.fromkeys((*reduction.over, *paired_names)):
        values = coordinates[axis].values
        ends = np.array([values.min(), values.max()])
        attributes = {**quantity_attributes(axis), "reduced_range": ends}
        coordinates[axis] = TableVariable((), np.asarray(ends.mean()), attributes)
    if reduction.quantiles:
        attributes = {"units": "1", "long_name": "Quantile"}
        values = np.array(reduction.quantiles)
        coordinates[QUANTILE] = TableVariable((QUANTILE,), values, attributes)
    return coordinates


def _outputs(prepared: Reduced) -> tuple[str, ...]:
    reduction, plan = prepared.reduction, prepared.plan
    if not (reduction.statistics or reduction.quantiles):
        return ()
    wanted = reduction.of or plan.outputs
    return tuple(name for name in plan.outputs if name in wanted and name not in FLAGS)


def statistics_of(prepared: Reduced) -> Iterator[Statistic]:
    """Yield the variables of a reduced result."""
    reduction, plan = prepared.reduction, prepared.plan
    for output in _outputs(prepared):
        yield from _statistics_of_output(prepared, output)
    for verdict in plan.verdicts if reduction.regimes else ():
        for regime in verdict.regimes:
            attributes = {
                "units": "1",
                "long_name": f"Cells in the regime {regime}",
                "comment": REGIMES[regime].description,
            }
            name, dims = f"{verdict.name}_{regime}_count", prepared.remaining_dims(verdict.name)
            conditions_met = (ShareCondition(verdict.name, "==", regime),)
            yield Statistic(name, dims, attributes, "regime", conditions=conditions_met)
    for name, conditions in reduction.shares.items():
        attributes = {
            "units": "1",
            "long_name": f"Share of cells: {name}",
            "comment": " and ".join(map(str, conditions)),
        }
        dims = prepared.remaining_dims(*(condition.name for condition in conditions))
        yield Statistic(f"share_{name}", dims, attributes, "share", conditions=conditions)
    for name, level in reduction.levels.items():
        along, unit = QUANTITIES[level.along], QUANTITIES[level.output].unit
        attributes = {
            "units": along.unit,
            "long_name": f"{along.label} of {name}",
            "comment": (
                f"the {level.take} value at which {level.output} is {level.level:g}"
                f"{'' if unit == '1' else f' {unit}'}, by a straight line between neighbours that "
                "count"
            ),
        }
        dims = prepared.remaining_dims(level.output)
        yield Statistic(f"level_{name}", dims, attributes, "level", level.output, level=level)


def _statistics_of_output(prepared: Reduced, output: str) -> Iterator[Statistic]:
    reduction, quantity = prepared.reduction, QUANTITIES[output]
    dims = prepared.remaining_dims(output)
    label, over_axes = quantity.label.lower(), "".join(f"{axis}: " for axis in reduction.over)
    count_link = {"ancillary_variables": f"{output}_count"}
    attributes = {
        "long_name": f"Cells that count for {label}",
        "standard_name": "number_of_observations",
    }
    yield Statistic(f"{output}_count", dims, {"units": "1", **attributes}, "count", output)
    for statistic in reduction.statistics:
        if statistic in STATISTICS:
            statistic_word, method = STATISTICS[statistic]
            attributes = {
                "long_name": f"{statistic_word} {label}",
                "cell_methods": over_axes + method,
                **count_link,
            }
            yield Statistic(
                f"{output}_{statistic}",
                dims,
                {"units": quantity.unit, **attributes},
                statistic,
                output,
            )
            continue
        for axis in reduction.over:
            extreme_word = "largest" if statistic == "argmax" else "least"
            attributes = {
                "units": QUANTITIES[axis].unit,
                "long_name": f"{QUANTITIES[axis].label} where {label} is {extreme_word}",
                "comment": "of equal values that of the first cell, the last axis fastest",
                **count_link,
            }
            yield Statistic(
                f"{output}_{statistic}_{axis}", dims, attributes, statistic, output, axis
            )
    if reduction.quantiles:
        attributes = {
            "units": quantity.unit,
            "long_name": f"Quantiles of {label}",
            "comment": "exact, of all cells that count; linear between neighbouring values",
            **count_link,
        }
        yield Statistic(f"{output}_{QUANTILE}", (QUANTILE, *dims), attributes, QUANTILE, output)
