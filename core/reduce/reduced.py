"""A study of which answers are told in place of its cells: states of all boxes, answers, labels.

What its cells are, each kind says: closed forms (`vibrafeed.core.sweep`) or motion
(`vibrafeed.core.motion`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core import reduce  # whose modules load numba when they are needed
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.dataset.table import Table, TableVariable, quantity_attributes
from vibrafeed.core.errors import Problem
from vibrafeed.core.plan.labels import coordinates_of
from vibrafeed.core.plan.pieces import Computed, run_cost
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plan.price import in_words
from vibrafeed.core.plan.shares import ARRAYS, Shares
from vibrafeed.core.reduce.labels import attributes_of, unit_of
from vibrafeed.core.reduce.state import State, merge_states
from vibrafeed.core.study.reduction import QUANTILE, Reduction
from vibrafeed.core.study.sweep_and_simulate import SimulateStudy, SweepStudy
from vibrafeed.core.system import cores
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    from vibrafeed.core.reduce.run import Units


class Reduced(Prepared):
    """A study whose result holds statistics over some axes in place of all cells.

    `cells` is the number of cells that are evaluated, `stored` that of the points of the result.
    """

    study: SweepStudy | SimulateStudy
    shares_as: ClassVar[str] = ARRAYS
    keeps_some: ClassVar[bool] = False
    box_cells: ClassVar[int | None] = None
    """Most cells of a box, if not as usual."""

    @property
    def not_lazy(self) -> Problem | None:
        """The problem with computing cells on reading: a reduction has none."""
        return Problem(
            "reduce",
            "a study with [reduce] stores statistics, not cells that can be read",
            "Remove [reduce]",
        )

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
    def work(self) -> Units:
        """The boxes in which the reduction is computed."""
        return reduce.run.Units(self.plan, self.grid, self.asked, self.box_cells)

    @cached_property
    def dims(self) -> dict[str, tuple[str, ...]]:
        """The dimensions of each variable."""
        return reduce.arrays.dims_of(self.work, self.asked)

    @cached_property
    def units(self) -> dict[str, str]:
        """The unit of each variable."""
        return {name: unit_of(name, self.asked, self.plan.outputs) for name in self.dims}

    @property
    def sizes(self) -> dict[str, int]:
        """The length of each dimension."""
        return {**self.grid.shape, QUANTILE: len(self.asked.quantiles)}

    @property
    def stored(self) -> int:
        """The number of points of all variables."""
        return max(self._points.values())

    @cached_property
    def _points(self) -> dict[str, int]:
        """Return the number of points of each variable."""
        sizes = self.sizes
        return {n: math.prod(sizes[dim] for dim in dims) for n, dims in self.dims.items()}

    @property
    def bytes(self) -> int:
        """The bytes of the result, uncompressed."""
        return 8 * sum(self._points.values())

    @property
    def computed_bytes(self) -> int:
        """The bytes of the result as computed."""
        return self.bytes

    @property
    def cut_axes(self) -> tuple[str, ...]:
        """The axes along which the study can be cut: those that stay."""
        return tuple(axis for axis in self.grid.axes if axis not in self.asked.over)

    def what_fits(self, share: float) -> str:
        """Return a sentence that says how to shrink the study to a share of its size."""
        stays = ", ".join(self.cut_axes)
        return f"It fits over more axes, or with fewer values of {stays}"

    def compute(self, watch: Watch) -> Computed:
        """Return the variables in the units of files.

        Raises
        ------
        StoppedError
            If `watch` stops it.
        """
        return self.joined(self.work.states(0, len(self.work), watch))

    def joined(self, states: Iterable[tuple[int, int, State]]) -> Computed:
        """Return the variables of the reduction in the units of files.

        `states` are the number of a field, the number of a block and the block's state, for all
        blocks.
        """
        return Computed(reduce.arrays.reduced_arrays(self.work, self.grid, self.asked, states))

    def label(self, computed: Computed, watch: Watch) -> Table:
        """Return the results of a reduction as a table: arrays with coordinates and attributes.

        `computed` has the bare arrays by name. Some cells of the study are verified here by other
        means, which `watch` may stop.
        """
        asked, plan = self.asked, self.plan
        exact = {name: one.is_exact for one in self.work.boxes for name in one.field.outputs}
        variables = {}
        for name, values in computed.arrays.items():
            is_exact = exact.get(name.removesuffix(f"_{QUANTILE}"), True)
            attributes = attributes_of(name, asked, plan.outputs, is_exact=is_exact)
            variables[name] = TableVariable(self.dims[name], values, attributes)
        return Table(
            _coordinates(self),
            variables,
            {
                **self.attributes(),
                "reduced": f"over {', '.join(asked.over)}: {_which(self)}",
                **self.verified(watch),
            },
        )

    def shares(self, where: str, count: int) -> ReducedShares:
        """Return the shares of the study: ranges of its boxes, whose states are kept in records."""
        return ReducedShares(self.study, self.cells, where, count, self.boxes, self)

    @property
    def boxes(self) -> int:
        """The number of boxes, the largest number of shares."""
        return len(self.work)

    @property
    def cores(self) -> int:
        """The number of cores used here."""
        return cores()

    @property
    def seconds_here(self) -> float:
        """The price of the study on this machine [s]: that of its cells over all cores."""
        return self.seconds / self.cores

    @property
    def size_in_words(self) -> str:
        """A text with cells, values of the result and time, to show before a study is run."""
        return (
            f"{self.cells:,} cells reduced to {self.bytes // 8:,} values, {self.bytes:,} bytes; "
            f"some {in_words(self.seconds_here)} here"
        )


@dataclass(frozen=True)
class ReducedShares(Shares):
    """The shares of a reduced study on their way to a NetCDF file.

    Attributes
    ----------
    whole : Reduced
        The study.
    """

    whole: Reduced
    scheme: ClassVar[str] = "tree of tiles"

    def joined_table(self, watch: Watch | None = None) -> Table:
        """Return the result of all shares as one table, verified and with its cost.

        Raises `SharesMissingError` if a share is missing or damaged, `StoppedError` if `watch`
        stops it.
        """
        watch, records = watch or Watch(), list[Mapping[str, Any]]()
        self._check(watch)
        computed = self.whole.joined(self._states(records))
        table = self.whole.label(computed, watch)
        return table.with_price(run_cost(self.cells, sum(one["seconds"] for one in records)))

    def _computed(
        self, start: int, stop: int, watch: Watch
    ) -> tuple[dict[str, NDArray[Any]], dict[str, str]]:
        """Compute the boxes of cells from `start` to `stop`; return their states as arrays.

        A box is a numbered range of cells, and its state is what the statistics have gathered
        there; the states of all parts of a study are joined later. An array is named
        ``field/block/name``: number of the group of outputs, number of the block of the result,
        name within the state. The second result, digests of files written, is empty, since nothing
        but the record is written. `watch` may stop it.
        """
        arrays: State = {}
        if stop > start:
            for field, block, state in self.whole.work.states(start, stop, watch):
                arrays |= {f"{field}/{block}/{name}": values for name, values in state.items()}
        return arrays, {}

    def _joined(self, watch: Watch, history: str | None) -> Table:
        """Write the result of all shares and return its table."""
        table = self.joined_table(watch)
        write_netcdf(table, Path(self.where), history=history)
        return table

    def _states(self, records: list[Mapping[str, Any]]) -> Iterator[tuple[int, int, State]]:
        """Yield field, block and joined state of each block, from the records of all shares.

        A field is a group of outputs, a block a region of the result; both are numbers. A state has
        what statistics have gathered: those of one block in successive parts are added up. The
        fields of the records are appended to `records`.
        """
        known: tuple[int, int] | None = None
        state: State = {}
        for record in self._records():
            records.append(record.fields)
            for block, values in _blocks(record.arrays).items():
                if block == known:
                    state = merge_states(state, values)
                    continue
                if known is not None:
                    yield (*known, state)
                known, state = block, values
        if known is not None:
            yield (*known, state)


def _blocks(arrays: Mapping[str, NDArray[Any]]) -> dict[tuple[int, int], State]:
    """Return the states of statistics in a record's arrays, by field and block, in ascending order.

    A record is what one part of a study leaves on disk. The names of its arrays are
    ``"<field>/<block>/<name>"``: number of the field (a group of outputs), number of the block of
    cells, and name of the array in the state.
    """
    found: dict[tuple[int, int], State] = {}
    for name, values in arrays.items():
        field, block, of = name.split("/", 2)
        found.setdefault((int(field), int(block)), {})[of] = values
    return dict(sorted(found.items()))


def _coordinates(prepared: Reduced) -> dict[str, TableVariable]:
    """Return the coordinates of a reduced result: axes that stay, reduced axes, quantiles.

    A reduced axis, over which statistics were taken, is a scalar: the middle of its range, with the
    range as an attribute. CF's bounds would be its own way, but its checker knows none of a scalar.
    """
    asked, grid = prepared.asked, prepared.grid
    coordinates = coordinates_of(prepared.plan, grid)
    for axis in asked.over:
        ends = np.array(
            sorted((float(coordinates[axis].values[0]), float(coordinates[axis].values[-1])))
        )
        attributes = {**quantity_attributes(axis), "reduced_range": ends}
        coordinates[axis] = TableVariable((), np.asarray(ends.mean()), attributes)
    if asked.quantiles:
        attributes = {"units": "1", "long_name": "Quantile"}
        values = np.array(asked.quantiles)
        coordinates[QUANTILE] = TableVariable((QUANTILE,), values, attributes)
    return coordinates


def _which(prepared: Reduced) -> str:
    """Return a text that says which cells count."""
    if prepared.asked.cells == "all":
        return "all cells with a value count"
    return "cells count whose regime describes a real part and that have a value"
