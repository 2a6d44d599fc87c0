"""The statistics of a reduction: dask computes them over the blocks of the cells."""

import math
import operator
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce
from itertools import chain
from typing import TYPE_CHECKING, Any, Final

import dask.array
import dask.base
import numpy as np
import xarray
from numpy.typing import NDArray

from vibrafeed.core.lazy.dataset import BLOCK_CELLS, COUNTED, arrays_of, watched
from vibrafeed.core.plan.plan import Plan, Verdict
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes import Equation
from vibrafeed.core.study.reduction import QUANTILE, ShareCondition
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    from vibrafeed.core.lazy.reduced import Reduced, Statistic

COMPARED: Final[Mapping[str, Callable[[Any, Any], Any]]] = {
    "<": operator.lt, "<=": operator.le, "==": operator.eq,
    "!=": operator.ne, ">=": operator.ge, ">": operator.gt,
}  # fmt: skip


def compute(prepared: "Reduced", watch: Watch) -> dict[str, NDArray[Any]]:
    """Return the variables of a reduced study, in the units of files.

    Raises
    ------
    StoppedError
        If `watch` stops it.
    """
    cells = Cells(prepared)
    lazy = {
        statistic.name: cells.variable(statistic).transpose(*statistic.dims).data
        for statistic in prepared.statistics
    }
    with watched(watch), warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # numpy's, where no cell counts
        (values_by_name,) = dask.base.compute(lazy)
    return {name: np.asarray(values) for name, values in values_by_name.items()}


@dataclass(frozen=True)
class Counted:
    """The function of an equation: an output, NaN where its regime describes no real part."""

    output: str
    verdict: Verdict

    def __call__(self, **quantities: Any) -> Any:
        """Return the values of the output in the cells that count."""
        values = quantities[self.output]
        counted = values if REGIMES[self.verdict.otherwise].valid else np.nan
        for condition in reversed(self.verdict.conditions):  # the first that holds decides
            holds = condition.function(**{name: quantities[name] for name in condition.inputs})
            values_here = values if REGIMES[condition.regime].valid else np.nan
            counted = np.where(holds, values_here, counted)
        return counted


def _plan_of_counting_cells(prepared: "Reduced") -> Plan:
    """Return the plan of what a reduction needs, with outputs that are NaN in other cells.

    A loop that writes NaN itself takes half as long as one that also writes regimes.
    """
    plan, needed = prepared.plan, prepared.needed
    equations, outputs = list(plan.equations), list[str]()
    for name in (name for name in plan.outputs if name in needed):
        verdict = prepared.judge(name)
        if verdict is not None:
            inputs = (name, *verdict.inputs)
            equations.append(Equation(COUNTED + name, Counted(name, verdict), "", needs=inputs))
        outputs.append(name if verdict is None else COUNTED + name)
    extended = replace(plan, equations=tuple(equations))
    return extended.part([*outputs, *(name for name in plan.verdict_names if name in needed)])


class Cells:
    """The cells that a reduction asks for, as lazy arrays."""

    def __init__(self, prepared: "Reduced"):
        self.reduction, self._prepared = prepared.reduction, prepared
        # Reduced axes come first, unless they fill a block: numpy is ten times as fast over leading
        # axes as over the last ones.
        over = prepared.reduction.over
        is_last = prepared.grid.size(over) > BLOCK_CELLS // 64
        order = sorted(prepared.grid.axes, key=lambda axis: (axis in over) == is_last)
        grid = replace(prepared.grid, axes={axis: prepared.grid.axes[axis] for axis in order})
        full_study = replace(prepared.whole, plan=_plan_of_counting_cells(prepared), grid=grid)
        arrays = arrays_of(full_study, whole=over)
        self._arrays = {
            name.removeprefix(COUNTED): xarray.DataArray(array, dims=full_study.dims[name])
            for name, array in arrays.items()
        }
        outputs_with_count = [
            statistic.of for statistic in prepared.statistics if statistic.what == "count"
        ]
        self._moments_of = {name: self._moments(self._arrays[name]) for name in outputs_with_count}

    def variable(self, statistic: "Statistic") -> xarray.DataArray:
        """Return a variable of the result."""
        if statistic.conditions:
            meets_all = reduce(operator.and_, map(self.meets, statistic.conditions))
            count = meets_all.sum(self.reduced_dims(meets_all)) * self.cells_per_value(meets_all)
            cells = self._prepared.grid.size(self.reduction.over)
            return count / cells if statistic.what == "share" else count
        values = self._arrays[statistic.of]
        if statistic.what == "level":
            return self._crossing(values, statistic)
        if statistic.what == QUANTILE:
            return self._quantile(values)
        moments = self._moments_of[statistic.of]
        options: dict[str, Any] = {"what": statistic.what}
        if statistic.axis:
            options["axis"] = self._prepared.grid.coordinate(statistic.axis)
            options["stride"] = self._strides(values).get(statistic.axis, math.inf)
        result = moments.copy(data=moments.data.map_blocks(_statistic, **options, dtype=np.float64))
        is_count = statistic.what == "count"
        return result.astype(np.int64) * self.cells_per_value(values) if is_count else result

    def meets(self, condition: ShareCondition) -> xarray.DataArray:
        """Return a mask of the cells that meet the condition of a share."""
        compare = COMPARED[condition.comparison]
        if condition.is_regime:
            return compare(self._arrays[condition.name], REGIMES[str(condition.value)].value)
        values = self._arrays[condition.name]
        return compare(values, condition.value) & values.notnull()

    def reduced_dims(self, array: xarray.DataArray) -> tuple[str, ...]:
        """Return the axes of an array that the reduction takes away, in the order of the grid."""
        return tuple(str(dim) for dim in array.dims if dim in self.reduction.over)

    def cells_per_value(self, array: xarray.DataArray) -> int:
        """Return the number of cells of the study that one cell of an array stands for."""
        shape = self._prepared.grid.shape
        return math.prod(shape[axis] for axis in self.reduction.over if axis not in array.dims)

    def _strides(self, values: xarray.DataArray) -> dict[str, int]:
        # Of the numbers of the cells that are reduced to one value, the last axis fastest.
        reduced_dims = self.reduced_dims(values)
        sizes = [values.sizes[dim] for dim in reduced_dims]
        return {dim: math.prod(sizes[position + 1 :]) for position, dim in enumerate(reduced_dims)}

    def _moments(self, values: xarray.DataArray) -> xarray.DataArray:
        # Records of moments over the reduced dimensions, by block and then combined.
        moments_needed = (
            _MOMENTS.get(statistic, (statistic,)) for statistic in self.reduction.statistics
        )
        names = tuple(dict.fromkeys(["count", *chain.from_iterable(moments_needed)]))
        numbers: Any = None
        if {"argmax", "argmin"} & {*names}:
            numbers = np.zeros(())
            for dim, stride in self._strides(values).items():
                positions = dask.array.arange(values.sizes[dim], chunks=values.chunksizes[dim])
                shape = [-1 if other == dim else 1 for other in values.dims]
                numbers = numbers + stride * positions.reshape(shape)
        reduced_dims = self.reduced_dims(values)
        remaining_dims = [dim for dim in values.dims if dim not in reduced_dims]
        dtype = [(name, np.float64) for name in names]
        moments = dask.array.reduction(
            values.data,
            partial(_moments, names=names),
            _combined_moments,
            axis=tuple(values.get_axis_num(dim) for dim in reduced_dims),
            dtype=dtype,
            meta=np.empty((0,) * len(remaining_dims), dtype),
            weights=numbers,
        )
        return xarray.DataArray(moments, dims=remaining_dims)

    def _quantile(self, values: xarray.DataArray) -> xarray.DataArray:
        shape, over = self._prepared.grid.shape, self.reduction.over
        cells = values.expand_dims({dim: shape[dim] for dim in over if dim not in values.dims})
        # Along one axis dask takes the quantiles of all answers at once.
        lines = cells.chunk(dict.fromkeys(over, -1)).stack({"cell": over}, create_index=False)
        return lines.quantile(list(self.reduction.quantiles), "cell")

    def _crossing(self, values: xarray.DataArray, statistic: "Statistic") -> xarray.DataArray:
        # The largest or least value on the level's axis at which any of the reduced cells cross it.
        level = statistic.level
        assert level is not None
        largest = level.take == "largest"
        crossed = xarray.apply_ufunc(
            _crossings,
            values.chunk({level.along: -1}),
            input_core_dims=[[level.along]],
            kwargs={
                "axis": self._prepared.grid.coordinate(level.along),
                "level": level.level,
                "largest": largest,
            },
            dask="parallelized",
            output_dtypes=[np.float64],
        )
        reduced_dims = self.reduced_dims(crossed)
        extreme: xarray.DataArray = (
            crossed.max(reduced_dims) if largest else crossed.min(reduced_dims)
        )
        return extreme.where(np.isfinite(extreme))


# xarray's own reductions pass over the cells for each statistic, and warn where none counts.
_MOMENTS: Final = {
    "mean": ("sum",), "std": ("sum", "squares"), "argmax": ("max", "argmax"),
    "argmin": ("min", "argmin"),
}  # fmt: skip
"""What is kept of a block for a statistic; by default itself."""
_EXTREMES: Final = {"max": np.fmax, "min": np.fmin}


def _mean(moments: Any) -> Any:
    return moments["sum"] / moments["count"]


def _moments(
    values: NDArray[Any],
    numbers: Any = None,
    *,
    axis: tuple[int, ...],
    keepdims: bool,
    names: Sequence[str],
) -> NDArray[Any]:
    """Return moments of a block, NaN aside, as a record.

    The squares are those of deviations from the mean; of extremes there are the `numbers` of the
    first cells that have them.
    """
    options: Any = {"axis": axis, "keepdims": keepdims}
    is_number = values == values
    # A block has fewer than 2^31 cells; numpy.count_nonzero takes twice as long.
    moments: dict[str, Any] = {"count": np.sum(is_number, dtype=np.int32, **options)}
    with np.errstate(invalid="ignore", divide="ignore"):
        for name in names[1:]:
            if name in _EXTREMES:
                moments[name] = _EXTREMES[name].reduce(values, **options)
            elif name.startswith("arg"):
                moments[name] = _first_number_of_extreme(
                    values, numbers, moments[name[3:]], options
                )
            else:
                terms = values if name == "sum" else np.square(values - _mean(moments))
                moments[name] = np.sum(terms, where=is_number, **options)
    return _record(moments)


def _first_number_of_extreme(values: Any, numbers: Any, extreme: Any, options: Any) -> Any:
    return np.where(values == extreme, numbers, np.inf).min(**options)


def _combined_moments(parts: NDArray[Any], axis: tuple[int, ...], keepdims: bool) -> NDArray[Any]:
    options: Any = {"axis": axis, "keepdims": True}
    moments: dict[str, Any] = {}
    with np.errstate(invalid="ignore", divide="ignore"):
        for name in parts.dtype.names or ():
            if name.startswith("arg"):
                extreme_name = name[3:]
                moments[name] = _first_number_of_extreme(
                    parts[extreme_name], parts[name], moments[extreme_name], options
                )
            else:
                moments[name] = _EXTREMES.get(name, np.add).reduce(parts[name], **options)
        if "squares" in moments:
            # The sum of squares within the parts plus that of their means about the common mean.
            squared_differences = np.square(_mean(parts) - _mean(moments))
            moments["squares"] += np.nansum(parts["count"] * squared_differences, **options)
    record = _record(moments)
    return record if keepdims else record.squeeze(axis)


def _record(moments: Mapping[str, Any]) -> NDArray[Any]:
    record = np.empty(moments["count"].shape, [(name, np.float64) for name in moments])
    for name, values in moments.items():
        record[name] = values
    return record


def _statistic(moments: Any, what: str, axis: Any = None, stride: float = 1) -> Any:
    # A statistic from records of moments; for the place of an extreme the value on `axis`.
    with np.errstate(invalid="ignore", divide="ignore"):
        if what == "mean":
            return _mean(moments)
        if what == "std":
            return np.sqrt(moments["squares"] / moments["count"])
        if axis is None:
            return moments[what]
        has_extreme = np.isfinite(moments[what])
        index = np.where(has_extreme, moments[what] // stride % len(axis), 0).astype(np.int64)
        return np.where(has_extreme, axis[index], np.nan)


def _crossings(
    values: NDArray[np.float64], axis: NDArray[np.float64], level: float, largest: bool
) -> NDArray[np.float64]:
    """Return the values at which the last axis crosses a level; infinite if it does not.

    Values are joined by straight lines; where two neighbours are the level, it is the larger or the
    smaller point.
    """
    lower, upper, first, last = values[..., :-1], values[..., 1:], axis[:-1], axis[1:]
    is_crossed = ((lower <= level) & (level <= upper)) | ((lower >= level) & (level >= upper))
    with np.errstate(invalid="ignore", divide="ignore"):
        crossings = first + (level - lower) / (upper - lower) * (last - first)
    # At a neighbour that is the level, and beside infinite values, without interpolation.
    crossings = np.where((upper == level) | np.isinf(lower), last, crossings)
    crossings = np.where((lower == level) | np.isinf(upper), first, crossings)
    better_end = np.maximum(first, last) if largest else np.minimum(first, last)
    crossings = np.where((lower == level) & (upper == level), better_end, crossings)
    no_crossing = -np.inf if largest else np.inf
    crossings = np.where(is_crossed, crossings, no_crossing)
    extreme: NDArray[np.float64] = (np.max if largest else np.min)(
        crossings, axis=-1, initial=no_crossing
    )
    return extreme
