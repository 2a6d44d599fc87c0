"""The selection of what is drawn: the variable, its axes, and where other dimensions are held."""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from vibrafeed.core.dataset.bands import BAND, ENDS, UNSETTLED, known_between
from vibrafeed.core.dataset.table import Table, judge_of
from vibrafeed.core.plots.looks import categories_of, codes_of
from vibrafeed.core.plots.pictures import PlotError, unreadable
from vibrafeed.core.plots.style import (
    Array,
    axis_label,
    demand_in_words,
    long_name,
    name_in_words,
    number,
    scaled,
    shown_in,
    with_unit,
    words,
)
from vibrafeed.core.quantities import QUANTITIES, by_letters
from vibrafeed.core.quantities.flags import REGIME, SIGNS, is_regime
from vibrafeed.core.scenes import EXACT, SCENES
from vibrafeed.core.study.shown import ShownUnits, read_shown
from vibrafeed.core.study.units import UnitError, read_number
from vibrafeed.core.study.values import position_on_axis
from vibrafeed.core.suggestions import suggestion

SPEEDS = ("conveying_velocity",)
"""Outputs that are read off lines of equal value, over the colours of their regimes."""
SPACE = "\N{NO-BREAK SPACE}"
ANY_REGIME = -2
FEW = 7  # values of an axis between which nothing is drawn: curves, not contours


@dataclass(frozen=True)
class PlotAxis:
    """A dimension that is drawn, values ascending, in the unit in which it is read."""

    name: str
    label: str
    unit: str
    values: Array

    @property
    def is_log(self) -> bool:
        """True if the values of the axis are geometrically spaced, to be drawn with a log scale."""
        if self.values.size < 3 or self.values[0] <= 0:
            return False
        steps = np.diff(np.log(self.values))
        return bool(np.ptp(steps) <= 1e-6 * steps.max())


@dataclass(frozen=True)
class Selection:
    """A slice of a dataset over one or two axes.

    Attributes
    ----------
    variable : xarray.DataArray
        The slice, dimensions in the order of `axes`.
    values, regimes : ndarray
        Values in `unit`, NaN where none is finite; the regime of each, or its category.
    regime : xarray.DataArray
        The variable of the dataset that judges the values; it says what the numbers mean.
    fixed : list of str
        Name, value and unit of every other dimension and parameter, what was asked for first.
    exact : bool
        Whether the values hold in every regime.
    categories : dict of int to str, optional
        Words of an output whose numbers stand for words.
    band : tuple of ndarray, optional
        Lower and upper ends about the values, of the same shape and unit, where the dataset has
        them: of a spread, or over a parameter that is known within a band.
    band_label : str
        What the band is.
    unsettled : ndarray of bool, optional
        Where a speed changes its direction within the band.
    """

    variable: xarray.DataArray
    axes: tuple[PlotAxis, ...]
    values: Array
    unit: str
    regimes: NDArray[np.int64]
    regime: xarray.DataArray
    fixed: list[str]
    exact: bool = False
    categories: dict[int, str] | None = None
    band: tuple[Array, Array] | None = None
    band_label: str = ""
    unsettled: NDArray[np.bool_] | None = None


def natural(
    dataset: xarray.Dataset, variable: str | None, axes: tuple[str, ...] | None
) -> tuple[str, str, tuple[str, ...]]:
    """Return kind, output and axes of the picture that is drawn of a dataset by default.

    Lines are drawn over one axis, or if an axis has at most seven values; a map if values have
    names; lines of equal value for speeds; else contours.
    """
    array = dataset[_variable(dataset, variable)]
    names = _axes(array, axes, 2)
    is_named = bool(categories_of(array))
    few = len(names) == 2 and min(array.sizes[name] for name in names) <= FEW
    if len(names) == 1 or (few and not is_named):
        if axes is None:
            names = tuple(sorted(names, key=lambda name: -array.sizes[name]))
        return "line", str(array.name), names
    if is_named:
        return "map", str(array.name), names
    return "levels" if array.name in SPEEDS else "contour", str(array.name), names


def select(
    dataset: xarray.Dataset,
    variable: str | None,
    axes: tuple[str, ...] | None,
    at: Mapping[str, float],
    kind: str,
    units: ShownUnits | None = None,
    *,
    nearest: bool = False,
) -> Selection:
    """Return the values of a dataset to draw: one output over one or two axes, in readable units.

    By default it is the first output that varies, over its longest axes, other dimensions at their
    middle; `nearest` says that a value of `at` that is not there stands for the nearest one.
    `PlotError` tells that the dataset does not have what is asked for.
    """
    units = units or ShownUnits()
    array, names, categories = _selected(dataset, variable, axes, kind)
    regime = _regime(dataset, array)
    order = [*array.dims, *(dim for dim in regime.dims if dim not in array.dims)]
    named = [name for name in at if name in dataset.dims]  # told, also if nothing depends on it
    not_drawn = list(dict.fromkeys(str(dim) for dim in [*order, *named] if dim not in names))
    positions = fixed_positions(dataset, at, not_drawn, names, nearest=nearest)

    def take(array: xarray.DataArray) -> xarray.DataArray:
        return array.isel(positions, missing_dims="ignore").transpose(*names).sortby(list(names))

    name = demand_in_words(array, units) or long_name(array)
    if array.name == "objective" and "criterion" in dataset.attrs:
        name = f"Objective: {words(str(dataset.attrs['criterion']))}"
    slice_ = take(array).assign_attrs(long_name=name)
    states = regime.isel(positions, missing_dims="ignore").sortby(
        [name for name in names if name in regime.dims]
    )
    shown = shown_in(slice_, units)
    values = scaled(slice_, shown.factor)
    codes = states.broadcast_like(slice_).transpose(*names).values.astype(np.int64)
    return Selection(
        variable=slice_,
        axes=tuple(axis_of(slice_[name], units) for name in names),
        values=np.where(np.isfinite(values), values, np.nan),
        unit=shown.unit,
        regimes=codes_of(slice_.values) if categories else codes,
        regime=regime,
        fixed=held_fixed(dataset, units, positions),
        exact=_is_exact(dataset, str(array.name)),
        categories=categories,
        **_band(dataset, slice_, take, shown.factor),
    )


def _band(
    dataset: xarray.Dataset,
    output: xarray.DataArray,
    take: Callable[[xarray.DataArray], xarray.DataArray],
    factor: float,
) -> dict[str, Any]:
    """Return the fields of a `Selection` on its band: over friction, or of a spread."""
    spread, ends = dataset.get(f"{output.name}_spread"), [f"{output.name}_{end}" for end in ENDS]
    if all(end in dataset for end in ends):
        friction_range = known_between(Table.of_xarray(dataset).coordinates)
        band = tuple(scaled(take(dataset[end]), factor) for end in ends)
        signs = take(dataset[UNSETTLED].broadcast_like(dataset[ends[0]])).values
        unsettled = signs == SIGNS["unsettled"].value
        return {"band": band, "band_label": f"for {friction_range}", "unsettled": unsettled}
    if spread is None:
        return {}
    values, width = (scaled(array, factor) for array in (output, take(spread)))
    width = np.nan_to_num(width, posinf=0.0)
    if not width.any():
        return {}
    return {"band": (values - width, values + width), "band_label": "\N{PLUS-MINUS SIGN} spread"}


def _selected(
    dataset: xarray.Dataset, variable: str | None, axes: tuple[str, ...] | None, kind: str
) -> tuple[xarray.DataArray, tuple[str, ...], dict[int, str] | None]:
    """Return the output, the axes to draw, and the output's categories, if any."""
    array = _on_map(dataset, variable) if kind == "map" else dataset[_variable(dataset, variable)]
    names = _axes(array, axes, 1 if kind == "line" else 2)
    categories = None if is_regime(str(array.name)) else categories_of(array)
    if categories and kind in ("contour", "levels"):
        raise PlotError(
            "kind",
            f"the values of {array.name} are names, not numbers",
            "Leave out kind, or draw a map",
        )
    if kind != "line" and len(names) == 1:
        line = "Draw an output as a line" if kind == "map" else "Draw the output as kind line"
        raise PlotError(
            "kind",
            f"kind {kind} needs two axes, but there is only {names[0]}",
            "Name two axes" if sum(size > 1 for size in array.shape) > 1 else line,
        )
    return array, names, categories


def _on_map(dataset: xarray.Dataset, variable: str | None) -> xarray.DataArray:
    """Return the variable that colours the cells of a map: regimes, or names."""
    if REGIME not in dataset:
        raise PlotError(
            "kind",
            "the dataset has no regimes to draw as a map",
            "Draw another kind, or leave out kind",
        )
    if variable is None or is_regime(variable):
        name = variable or REGIME
        if name not in dataset:
            regimes = [str(name) for name in dataset.data_vars if is_regime(str(name))]
            raise PlotError("variable", f"'{name[:40]}' is unknown", suggestion(name, regimes))
        return dataset[name]
    array = dataset[_variable(dataset, variable)]
    if not categories_of(array):
        raise PlotError(
            "variable",
            f"the values of {array.name} are numbers, but a map shows only regimes and other names",
            f"Draw {_regime(dataset, array).name}, or draw kind contour",
        )
    return array


def outputs_of(dataset: xarray.Dataset) -> list[str]:
    """Return the names of the outputs that a dataset holds."""
    return [str(name) for name in dataset.data_vars if not is_regime(str(name))]


def held_fixed(
    dataset: xarray.Dataset, units: ShownUnits, positions: Mapping[str, int] | None = None
) -> list[str]:
    """Return name, value and unit of what is held, as a text each, for below a title.

    Ranged parameters at some index come first, then those of a single value; of these, the ones
    that the study gives before those left to defaults.
    """
    ranged = [held_at(dataset[name], units, index) for name, index in (positions or {}).items()]
    try:
        given = json.loads(str(dataset.attrs.get("study"))).get("parameters", {})
    except (ValueError, AttributeError):  # no study
        given = {}
    single = [
        str(name)
        for name, coordinate in dataset.coords.items()
        if not coordinate.dims and (name not in QUANTITIES or QUANTITIES[str(name)].parameter)
    ]
    ordered = sorted(single, key=lambda name: name not in given)
    return ranged + [held_at(dataset[name], units) for name in ordered]


def thin(size: int, most: int) -> NDArray[np.int64]:
    """Return at most `most` indices out of `size`, evenly spread, both ends included."""
    return np.unique(np.linspace(0, size - 1, min(size, most)).round().astype(np.int64))


def _regime(dataset: xarray.Dataset, output: xarray.DataArray) -> xarray.DataArray:
    if is_regime(str(output.name)):
        return output
    judge = judge_of(output.attrs, dataset) or REGIME
    if judge not in dataset:
        return xarray.DataArray(np.int8(ANY_REGIME), name=REGIME)
    return dataset[judge]


def _variable(dataset: xarray.Dataset, name: str | None) -> str:
    """Return the name of the output to draw, by default the first that varies."""
    outputs = outputs_of(dataset)
    if not outputs:
        raise unreadable("it holds no output")
    if name is None:
        # What is one value, or counts cells, says less than what varies.
        varies = [key for key in outputs if dataset[key].size > 1]
        values = [key for key in varies if not key.endswith("_count")]
        return next(iter([*values, *varies, *outputs]))
    if is_regime(name):
        raise PlotError(
            "variable",
            f"{name} is not an output to draw: every picture shades the regimes",
            "Draw kind map, or choose an output: " + ", ".join(outputs),
        )
    if name not in outputs:
        raise PlotError("variable", f"'{name[:40]}' is unknown", suggestion(name, outputs))
    return name


def _axes(array: xarray.DataArray, names: tuple[str, ...] | None, max_axes: int) -> tuple[str, ...]:
    """Return the dimensions to draw over, by default the longest."""
    ranged = [str(dim) for dim in array.dims if array.sizes[dim] > 1]
    if not ranged:
        raise PlotError(
            "variable",
            f"{array.name} has one value only, so there is nothing to draw",
            "Choose an output that depends on a ranged parameter",
        )
    if names is None:
        longest = sorted(ranged, key=lambda name: -array.sizes[name])[:max_axes]
        return tuple(name for name in ranged if name in longest)
    if len(names) not in (1, 2) or len(set(names)) < len(names):
        raise PlotError(
            "axes",
            "a picture needs one or two different axes of the result",
            "Name them, as in beta,alpha",
        )
    for name in names:
        if name in array.dims and name not in ranged:
            raise PlotError("axes", f"{name} has one value only", "Take " + " or ".join(ranged))
        if name not in ranged:
            raise PlotError(
                "axes", f"{array.name} has no dimension '{name[:40]}'", suggestion(name, ranged)
            )
    return names


def axis_of(coordinate: xarray.DataArray, units: ShownUnits) -> PlotAxis:
    """Return an axis of the picture from a coordinate, in the unit for reading."""
    shown = shown_in(coordinate, units)
    label = axis_label(coordinate, shown.unit)
    return PlotAxis(str(coordinate.name), label, shown.unit, scaled(coordinate, shown.factor))


def held_at(coordinate: xarray.DataArray, units: ShownUnits, position: int | None = None) -> str:
    """Return name, value and unit of a parameter as one text, with non-breaking spaces.

    Of a ranged one `position` is the index of the value that is shown. A parameter over which
    statistics were taken has its range instead of a value.
    """
    name = name_in_words(str(coordinate.name))
    range_ends = coordinate.attrs.get("reduced_range", coordinate.attrs.get(BAND))
    if position is None and range_ends is not None:  # its value is only nominal
        shown = shown_in(coordinate.copy(data=np.float64(np.max(np.abs(range_ends)))), units)
        low, high = (number(shown.factor * float(end)) for end in range_ends)
        return f"over {name} {low} to {with_unit(high, shown.unit)}".replace(" ", SPACE)
    values = coordinate if position is None else coordinate[position]
    shown = shown_in(values, units)
    value = with_unit(number(float(scaled(values, shown.factor))), shown.unit)
    return f"{name} {value}".replace(" ", SPACE)


def _is_exact(dataset: xarray.Dataset, output: str) -> bool:
    # No condition of the dataset's scene restricts the output, so that pictures shade no regime.
    if output in EXACT:
        return True
    name, variant = str(dataset.attrs.get("scene")), str(dataset.attrs.get("variant"))
    scene = SCENES.get(name)
    if scene is None or variant not in scene.conditions:
        return False
    restricted = {name for condition in scene.conditions[variant] for name in condition.outputs}
    return output in scene.producers(variant) and output not in restricted


def units_of(dataset: xarray.Dataset, units: Sequence[str] | str | None) -> ShownUnits:
    """Return the units in which a picture shows values: those asked for, else those of the study.

    `PlotError` tells that a name is not a unit.
    """
    words = dataset.attrs.get("shown_units", "") if units is None else units
    listed = words.split(",") if isinstance(words, str) else list(words)
    try:
        return read_shown(word for word in listed if word.strip())
    except UnitError as error:
        raise PlotError("units", error.message, error.fix) from None


def check_result(dataset: xarray.Dataset) -> None:
    """Raise `PlotError` if a dataset is not a result of vibrafeed."""
    is_result = (
        "regime" in dataset.data_vars or "reduced" in dataset.attrs
    ) and "scene" in dataset.attrs
    if not is_result:
        raise unreadable("it is not a result of vibrafeed: no regime or no scene")


def read_fixed(texts: Mapping[str, float | str]) -> dict[str, float]:
    """Return numbers, or texts with units, by the names of quantities, in the units of these.

    `PlotError` tells that a name is not a quantity, or a text not a value of it.
    """
    values = {}
    for name, text in in_letters(texts).items():
        if name not in QUANTITIES:
            raise PlotError(f"at.{name}", "there is no such quantity", suggestion(name, QUANTITIES))
        try:
            values[name] = read_number(name, QUANTITIES[name], text)
        except UnitError as error:
            raise PlotError(f"at.{name}", error.message, error.fix) from None
    return values


def in_letters(at: Mapping[str, Any]) -> dict[str, Any]:
    """Return values by the names of quantities, the words for angles replaced by their letters."""
    values, problems = by_letters(at)
    for problem in problems:
        raise PlotError(f"at.{problem.place}", problem.message, problem.fix)
    return values


def fixed_positions(
    dataset: xarray.Dataset,
    at: Mapping[str, float],
    dimensions: Iterable[str],
    axes: Iterable[str],
    *,
    nearest: bool = False,
) -> dict[str, int]:
    """Return the index at which each of some `dimensions` is held; else the middle.

    `at` has values of dimensions in the unit of the dataset, `axes` are drawn. With `nearest` a
    value that the dataset does not have stands for the nearest one. `PlotError` tells that `at`
    names an axis, no parameter, or a value that the dataset does not have.
    """
    coordinates = [str(name) for name in dataset.coords]
    positions = {}
    for name, value in at.items():
        if name in axes:
            others = ",".join(axis for axis in axes if axis != name)
            raise PlotError(
                f"at.{name}",
                f"{name} is an axis of this picture, so it cannot also have a fixed value",
                f"Add --axes {others}, or leave it out" if others else "Leave it out",
            )
        if name not in coordinates:
            raise PlotError(
                f"at.{name}",
                "the dataset has no such dimension",
                suggestion(name, map(str, dataset.dims)),
            )
        positions[name] = _position(dataset[name], value, nearest=nearest)
    return {name: positions.get(name, dataset.sizes[name] // 2) for name in dimensions}


def _position(coordinate: xarray.DataArray, value: float, *, nearest: bool) -> int:
    values = np.atleast_1d(np.asarray(coordinate.values, dtype=np.float64))
    if nearest and np.isfinite(value):
        return int(np.abs(values - value).argmin())
    try:
        return position_on_axis(str(coordinate.name), values, value, "trade")
    except UnitError as error:
        raise PlotError(
            f"at.{coordinate.name}",
            error.message,
            f"{error.fix}{'; --nearest takes the nearest one' if values.size > 1 else ''}",
        ) from None
