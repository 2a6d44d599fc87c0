"""The positions at which dimensions that are not drawn are held."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray

from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.quantities import QUANTITIES, by_letters
from vibrafeed.core.study.units import UnitError, read_number
from vibrafeed.core.study.values import position_on_axis
from vibrafeed.core.suggestions import suggestion


def read_fixed(texts: Mapping[str, float | str]) -> dict[str, float]:
    """Return numbers, or texts with units, as numbers in the units of their quantities.

    `texts` are by the names of the quantities.

    Raises
    ------
    PlotError
        If a name is not a quantity, or a text not a value of it.
    """
    values = {}
    for name, text in in_letters(texts).items():
        if name not in QUANTITIES:
            message = "there is no such quantity"
            raise PlotError(_axis_name(name), message, suggestion(name, QUANTITIES))
        try:
            values[name] = read_number(name, QUANTITIES[name], text)
        except UnitError as error:
            raise PlotError(_axis_name(name), error.message, error.fix) from None
    return values


def in_letters(at: Mapping[str, Any]) -> dict[str, Any]:
    """Return values by the names of quantities, the words for angles replaced by their letters.

    Raises
    ------
    PlotError
        If an angle is given by both.
    """
    values, problems = by_letters(at)
    for problem in problems:
        raise PlotError(_axis_name(problem.place), problem.message, problem.fix)
    return values


def fixed_positions(
    dataset: xarray.Dataset,
    at: Mapping[str, float],
    loose: Iterable[str],
    axes: Iterable[str],
    *,
    nearest: bool = False,
) -> dict[str, int]:
    """Return the index at which each dimension that is not drawn is held; else the middle.

    Parameters
    ----------
    dataset : xarray.Dataset
        The dataset.
    at : mapping of str to float
        Values of dimensions that the user asked for, in the unit of the dataset.
    loose, axes : iterable of str
        The dimensions to hold, and those that are drawn.
    nearest : bool
        True if a value that the dataset does not have stands for the nearest one.

    Raises
    ------
    PlotError
        If `at` names an axis, no parameter, or a value that the dataset does not have.
    """
    known = [str(name) for name in dataset.coords]
    asked = {}
    for name, value in at.items():
        if name in axes:
            others = ",".join(axis for axis in axes if axis != name)
            fix = f"Add --axes {others}, or leave it out" if others else "Leave it out"
            raise PlotError(
                _axis_name(name),
                f"{name} is an axis of this picture, so it cannot also have a fixed value",
                fix,
            )
        if name not in known:
            message = "the dataset has no such dimension"
            raise PlotError(_axis_name(name), message, suggestion(name, map(str, dataset.dims)))
        asked[name] = _position(dataset[name], value, nearest=nearest)
    return {name: asked.get(name, dataset.sizes[name] // 2) for name in loose}


def _position(coordinate: xarray.DataArray, value: float, *, nearest: bool) -> int:
    """Return the index of a value on a coordinate; raise `PlotError` if it is not there.

    With `nearest` it is the index of the nearest value.
    """
    values = np.atleast_1d(np.asarray(coordinate.values, dtype=np.float64))
    if nearest and np.isfinite(value):
        return int(np.abs(values - value).argmin())
    try:
        return position_on_axis(str(coordinate.name), values, value, "trade")
    except UnitError as error:
        fix = f"{error.fix}{'; --nearest takes the nearest one' if values.size > 1 else ''}"
        raise PlotError(_axis_name(coordinate.name), error.message, fix) from None


def _axis_name(name: object) -> str:
    """Return the path of a value in `at`."""
    return f"at.{name}"
