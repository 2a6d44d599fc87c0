"""From states to answers: the arrays of a reduction, in the units of files."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.plan.grid import Grid
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.reduce.boxes import Boxes, values_of
from vibrafeed.core.reduce.kernels.others import BINS, SHIFT
from vibrafeed.core.reduce.run import Units
from vibrafeed.core.reduce.state import State
from vibrafeed.core.reduce.sums import means
from vibrafeed.core.study.reduction import QUANTILE, Reduction

Arrays = dict[str, NDArray[Any]]
_BY_VALUE = {flag.value: name for name, flag in REGIMES.items()}


def dims_of(units: Units, asked: Reduction) -> dict[str, tuple[str, ...]]:
    """Return the names of the dimensions of every variable of a reduction, by the variable's name.

    A reduction has statistics over some axes of a study in place of all cells: these axes are
    dropped, and the others stay in their order. A quantile has the dimension `quantile` before
    them.

    Parameters
    ----------
    units : Units
        The work of the reduction, with its groups of outputs and the axes of each.
    asked : Reduction
        The section `reduce` of the study.
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
    """Return all variables of a reduced result, in the units of files, by name.

    Parameters
    ----------
    units : Units
        The work of the reduction: its groups of outputs (fields) and the blocks of each.
    asked : Reduction
        The section `reduce` of the study.
    states : iterable of (int, int, State)
        Number of a field, number of a block, and what the statistics of that block have gathered;
        for all blocks.
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
    """Yield the names of all variables that a group of outputs adds to a reduced result.

    They are statistics, quantiles, counts of regimes, shares and levels, in the order of the
    result. `boxes` has the group, and `asked` is the section `reduce` of the study.
    """
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
    for verdict, flags in boxes.flags.items():
        yield from (f"{verdict}_{_BY_VALUE[flag]}_count" for flag in flags)
    yield from (f"share_{name}" for name in field.shares)
    yield from (f"level_{name}" for name in field.levels)


def _arrays_of_block(
    boxes: Boxes, grid: Grid, asked: Reduction, state: State
) -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield name and values of each variable of a block of a reduced result, in the units of files.

    `state` has what the statistics of the block have gathered. Values have the shape (slots,), or
    (quantiles, slots); a slot is a point of the axes that stay. `asked` is the section `reduce`.
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
    for verdict, flags in boxes.flags.items():
        for flag in flags:
            counts = state[f"{verdict}.{flag}.count"]
            yield f"{verdict}_{_BY_VALUE[flag]}_count", counts * boxes.times
    for name in field.shares:
        yield f"share_{name}", state[f"{name}.count"] / boxes.cells_a_slot
    for name, level in field.levels.items():
        found = state[f"{name}.{level.take}"]
        yield f"level_{name}", np.where(np.isinf(found), np.nan, found)


def _statistics(
    name: str, boxes: Boxes, grid: Grid, asked: Reduction, state: State
) -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield name and values of the count and each statistic of one output in a block.

    Values have the shape (slots,), a slot for each point of the block, NaN where no cell counts;
    they are in the units of files. `name` is the output, `state` has what was gathered in the
    block, and `asked` is the section `reduce` of the study.
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
    """Return the place of an extreme on each reduced axis, by axis, in the units of files.

    `number` is the cell of the extreme for each point of the result, counted along the reduced
    axes, the last axis fastest; the arrays have its shape. Along an axis on which the output does
    not depend all cells are alike, and the first is taken.
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
    """Return quantiles of the values that fall into one cell of the result, shape (quantiles, 1).

    They are taken from a histogram, with values evenly spread in each bin. A bin is at most 1/512
    of its value wide, which is the largest error. NaN if there are no values.

    Parameters
    ----------
    bins, filled : ndarray, shape (n,)
        Numbers of the bins that are not empty, ascending, and the number of values in each.
    ends : ndarray of int64, shape (5, 1)
        The largest value in row 0 and the least in row 2, as integers that sort like the floats.
    quantiles : tuple of float
        The shares wanted, 0 to 1.
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
