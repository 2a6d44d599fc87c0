"""From states to answers: the arrays of a reduction, in the units of files."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.plan.grid import Grid
from core.quantities import REGIMES
from core.reduce.boxes import Boxes, values_of
from core.reduce.kernels.others import BINS, SHIFT
from core.reduce.run import Units
from core.reduce.state import State
from core.reduce.sums import means
from core.study.reduction import QUANTILE, Reduction

Arrays = dict[str, NDArray[Any]]
_BY_VALUE = {flag.value: name for name, flag in REGIMES.items()}


def dims_of(units: Units, asked: Reduction) -> dict[str, tuple[str, ...]]:
    """Return the dimensions of every variable of a reduction, by the variable's name.

    `units` are the boxes of the reduction. A quantile has the dimension `quantile` before the axes
    that stay.
    """
    dims: dict[str, tuple[str, ...]] = {}
    for boxes in units.boxes:
        kept = tuple(dim for dim in boxes.field.dims if dim not in asked.over)
        for name in _names(boxes, asked):
            is_quantile = name.endswith(f"_{QUANTILE}") and name not in boxes.field.levels
            dims[name] = (QUANTILE, *kept) if is_quantile else kept
    return dims


def reduced_arrays(
    units: Units, grid: Grid, asked: Reduction, states: Iterable[tuple[int, int, State]]
) -> Arrays:
    """Return the variables of a reduction, in the units of files, by name.

    `states` are the number of a field, the number of a block and the state of that block, for all
    blocks.
    """
    dims = dims_of(units, asked)
    sizes = {**grid.shape, QUANTILE: len(asked.quantiles)}
    arrays: Arrays = {}
    for name, own in dims.items():
        dtype = np.int64 if name.endswith("_count") else np.float64
        arrays[name] = np.zeros([sizes[dim] for dim in own], dtype)
    for field, block, state in states:
        boxes = units.boxes[field]
        box = boxes.cutting.kept(boxes.cutting.box(block, 0))
        region = tuple(slice(*ends) for ends in box)
        shape = tuple(stop - start for start, stop in box)
        for name, values in _arrays_of_block(boxes, grid, asked, state):
            if dims[name][:1] == (QUANTILE,):
                arrays[name][(slice(None), *region)] = values.reshape((-1, *shape))
            else:
                arrays[name][region] = values.reshape(shape)
    return arrays


def _names(boxes: Boxes, asked: Reduction) -> Iterator[str]:
    """Yield the names of a field's variables: statistics, quantiles, regimes, shares, levels."""
    field = boxes.field
    for name in field.outputs:
        yield f"{name}_count"
        for statistic in asked.statistics:
            if statistic.startswith("arg"):
                yield from (f"{name}_{statistic}_{axis}" for axis in asked.over)
            else:
                yield f"{name}_{statistic}"
        if asked.quantiles:
            yield f"{name}_{QUANTILE}"
    if field.regimes:
        yield from (f"regime_{_BY_VALUE[flag]}_count" for flag in boxes.flags)
    yield from (f"share_{name}" for name in field.shares)
    yield from (f"level_{name}" for name in field.levels)


def _arrays_of_block(
    boxes: Boxes, grid: Grid, asked: Reduction, state: State
) -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield name and values of each variable of a block, in the units of files.

    Values have the shape (slots,), or (quantiles, slots); a slot is a point of the axes that stay.
    """
    field = boxes.field
    for name in field.outputs:
        yield from _statistics(name, boxes, grid, asked, state)
        if f"{name}.quantiles" in state:
            yield f"{name}_{QUANTILE}", state[f"{name}.quantiles"]
        elif f"{name}.bins" in state:
            bins, filled = state[f"{name}.bins"], state[f"{name}.filled"] * boxes.times
            quantiles = binned_quantiles(bins, filled, state[f"{name}.ends"], asked.quantiles)
            yield f"{name}_{QUANTILE}", quantiles
    if field.regimes:
        for flag in boxes.flags:
            yield f"regime_{_BY_VALUE[flag]}_count", state[f"{flag}.count"] * boxes.times
    for name in field.shares:
        yield f"share_{name}", state[f"{name}.count"] / boxes.cells_a_slot
    for name, level in field.levels.items():
        found = state[f"{name}.{level.take}"]
        yield f"level_{name}", np.where(np.isinf(found), np.nan, found)


def _statistics(
    name: str, boxes: Boxes, grid: Grid, asked: Reduction, state: State
) -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield name and values of the count and each statistic of one output in a block.

    Values have the shape (slots,), NaN where no cell counts; `state` is that of the block.
    """
    ends: NDArray[np.int64] = state[f"{name}.ends"]
    count = ends[4]
    largest, least = (np.where(count > 0, values_of(ends[row]), np.nan) for row in (0, 2))
    yield f"{name}_count", count * boxes.times
    for statistic in asked.statistics:
        if statistic == "max":
            yield f"{name}_max", largest
        elif statistic == "min":
            yield f"{name}_min", least
        elif statistic == "mean":
            finite = means(int(state[f"{name}.low"][0]), state[f"{name}.digits"], count)
            yield f"{name}_mean", finite + state[f"{name}.beyond"]
        else:
            number = ends[1 if statistic == "argmax" else 3]
            for axis, values in _points(boxes, grid, asked, number).items():
                yield f"{name}_{statistic}_{axis}", np.where(count > 0, values, np.nan)


def _points(
    boxes: Boxes, grid: Grid, asked: Reduction, number: NDArray[np.int64]
) -> dict[str, NDArray[np.float64]]:
    """Return the values of each reduced axis at the cells with given numbers, by axis.

    `number` counts the cells of a slot, the last axis fastest. Along an axis that the output does
    not depend on all cells are alike, and the first is taken.
    """
    points = {}
    for axis in reversed(asked.over):
        at = np.zeros_like(number)
        if axis in boxes.field.dims:
            number, at = np.divmod(number, grid.shape[axis])
        unique, place = np.unique(at, return_inverse=True)
        found = [grid.axes[axis].array(int(k), int(k) + 1)[0] for k in unique]
        points[axis] = np.array(found)[place]
    return points


def binned_quantiles(
    bins: NDArray[np.int64],
    filled: NDArray[np.int64],
    ends: NDArray[np.int64],
    quantiles: tuple[float, ...],
) -> NDArray[np.float64]:
    """Return quantiles of one slot from its histogram, shape (quantiles, 1).

    `bins` are the bins that are not empty, `filled` the number of values in each, `ends` the keys
    of the largest (row 0) and the least (row 2) of all values. Within a bin values are taken to lie
    evenly. A bin is at most 1/512 of its value wide, which is the error at most.
    """
    result = np.full((len(quantiles), 1), np.nan)
    total = int(filled.sum())
    if not total:
        return result
    least, largest = (float(values_of(ends[row])[0]) for row in (2, 0))
    before = np.cumsum(filled) - filled
    for k, quantile in enumerate(quantiles):
        rank = quantile * (total - 1)
        if rank <= 0 or rank >= total - 1:  # they are known
            result[k, 0] = least if rank <= 0 else largest
            continue
        at = int(np.searchsorted(before, rank, side="right")) - 1
        keys = np.array([bins[at] - BINS // 2, bins[at] - BINS // 2 + 1]) << SHIFT
        keys[1] -= 1
        low, high = (float(value) for value in values_of(keys))
        # The bins of infinite values hold patterns beyond them, which are no numbers.
        low = least if math.isnan(low) else max(low, least)
        high = largest if math.isnan(high) else min(high, largest)
        share = min(1.0, (rank - float(before[at])) / max(1, int(filled[at]) - 1))
        result[k, 0] = low if low == high else low + (high - low) * share
    return result
