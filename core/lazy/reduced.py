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
    def asked(self) -> Reduction:
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
        return verdict if verdict and verdict.doubts and self.asked.cells == "valid" else None

    def kept(self, *names: str) -> tuple[str, ...]:
        """Return the axes that stay of some variables together, with the verdicts on them."""
        judges = [judge.name for name in names if (judge := self.judge(name))]
        dims = {dim for name in (*names, *judges) for dim in self.cell_dims[name]}
        return self.grid.dims(dims - {*self.asked.over})

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
        return {**self.grid.shape, QUANTILE: len(self.asked.quantiles)}

    @property
    def stored(self) -> int:
        """The number of points of the largest variable."""
        return max(math.prod(self.sizes[dim] for dim in dims) for dims in self.dims.values())

    @property
    def cut_axes(self) -> tuple[str, ...]:
        """The axes along which the study can be cut: those that stay."""
        return tuple(axis for axis in self.grid.axes if axis not in self.asked.over)

    def what_fits(self, share: float) -> str:
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
        names = {one.of for one in self.statistics if one.of}
        return names | {one.name for statistic in self.statistics for one in statistic.conditions}

    def label(self, computed: Computed, watch: Watch) -> Table:
        """Return the results of a reduction as a table: arrays with coordinates and attributes.

        Some cells of the study are verified here by other means, which `watch` may stop.
        """
        variables = {
            one.name: TableVariable(one.dims, computed.arrays[one.name], one.attributes)
            for one in self.statistics
        }
        which = (
            "all cells with a value count"
            if self.asked.cells == "all"
            else "cells count whose regime describes a real part and that have a value"
        )
        attributes = {
            **self.attributes(),
            "reduced": f"over {', '.join(self.asked.over)}: {which}",
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
    # CF's bounds would be its own way, but its checker knows none of a scalar.
    asked, grid = prepared.asked, prepared.grid
    coordinates = coordinates_of(prepared.plan, grid)
    gone = [name for name, axis in grid.along.items() if axis in asked.over]
    for axis in dict.fromkeys((*asked.over, *gone)):
        values = coordinates[axis].values
        ends = np.array([values.min(), values.max()])
        attributes = {**quantity_attributes(axis), "reduced_range": ends}
        coordinates[axis] = TableVariable((), np.asarray(ends.mean()), attributes)
    if asked.quantiles:
        attributes = {"units": "1", "long_name": "Quantile"}
        values = np.array(asked.quantiles)
        coordinates[QUANTILE] = TableVariable((QUANTILE,), values, attributes)
    return coordinates


def _outputs(prepared: Reduced) -> tuple[str, ...]:
    asked, plan = prepared.asked, prepared.plan
    if not (asked.statistics or asked.quantiles):
        return ()
    wanted = asked.of or plan.outputs
    return tuple(name for name in plan.outputs if name in wanted and name not in FLAGS)


def statistics_of(prepared: Reduced) -> Iterator[Statistic]:
    """Yield the variables of a reduced result."""
    asked, plan = prepared.asked, prepared.plan
    for output in _outputs(prepared):
        yield from _of_output(prepared, output)
    for verdict in plan.verdicts if asked.regimes else ():
        for regime in verdict.regimes:
            attributes = {
                "units": "1",
                "long_name": f"Cells in the regime {regime}",
                "comment": REGIMES[regime].description,
            }
            name, dims = f"{verdict.name}_{regime}_count", prepared.kept(verdict.name)
            met = (ShareCondition(verdict.name, "==", regime),)
            yield Statistic(name, dims, attributes, "regime", conditions=met)
    for name, conditions in asked.shares.items():
        attributes = {
            "units": "1",
            "long_name": f"Share of cells: {name}",
            "comment": " and ".join(map(str, conditions)),
        }
        dims = prepared.kept(*(one.name for one in conditions))
        yield Statistic(f"share_{name}", dims, attributes, "share", conditions=conditions)
    for name, level in asked.levels.items():
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
        dims = prepared.kept(level.output)
        yield Statistic(f"level_{name}", dims, attributes, "level", level.output, level=level)


def _of_output(prepared: Reduced, output: str) -> Iterator[Statistic]:
    asked, quantity, dims = prepared.asked, QUANTITIES[output], prepared.kept(output)
    label, over = quantity.label.lower(), "".join(f"{axis}: " for axis in asked.over)
    counted = {"ancillary_variables": f"{output}_count"}
    attributes = {
        "long_name": f"Cells that count for {label}",
        "standard_name": "number_of_observations",
    }
    yield Statistic(f"{output}_count", dims, {"units": "1", **attributes}, "count", output)
    for what in asked.statistics:
        if what in STATISTICS:
            word, method = STATISTICS[what]
            attributes = {"long_name": f"{word} {label}", "cell_methods": over + method, **counted}
            yield Statistic(
                f"{output}_{what}", dims, {"units": quantity.unit, **attributes}, what, output
            )
            continue
        for axis in asked.over:
            where = "largest" if what == "argmax" else "least"
            attributes = {
                "units": QUANTITIES[axis].unit,
                "long_name": f"{QUANTITIES[axis].label} where {label} is {where}",
                "comment": "of equal values that of the first cell, the last axis fastest",
                **counted,
            }
            yield Statistic(f"{output}_{what}_{axis}", dims, attributes, what, output, axis)
    if asked.quantiles:
        attributes = {
            "units": quantity.unit,
            "long_name": f"Quantiles of {label}",
            "comment": "exact, of all cells that count; linear between neighbouring values",
            **counted,
        }
        yield Statistic(f"{output}_{QUANTILE}", (QUANTILE, *dims), attributes, QUANTILE, output)
