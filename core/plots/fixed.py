"""The positions at which dimensions that are not drawn are held."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np
import xarray

from core.errors import suggestion
from core.plots.problem import PlotError

TOLERANCE = 1e-9


def read_fixed(texts: Mapping[str, str]) -> dict[str, float]:
    """Return the numbers of a user's `name=value` pairs.

    Raises
    ------
    PlotError
        If one is no finite number.
    """
    values = {}
    for name, text in texts.items():
        try:
            values[name] = float(text)
        except ValueError:
            message, fix = f"'{text[:40]}' is not a number", "Write it in the unit of the file"
            raise PlotError(_place(name), message, fix) from None
    return values


def fixed_positions(
    dataset: xarray.Dataset, at: Mapping[str, float], loose: Iterable[str], axes: Iterable[str]
) -> dict[str, int]:
    """Return the position of each loose dimension: as asked in `at`, else in the middle.

    Raises
    ------
    PlotError
        If `at` names an axis, no parameter, or a value that the dataset does not have.
    """
    known = [str(name) for name in dataset.coords]
    asked = {}
    for name, value in at.items():
        if name in axes:
            raise PlotError(_place(name), "it is an axis of the picture", "Fix it or draw over it")
        if name not in known:
            message = "the dataset has no such dimension"
            raise PlotError(_place(name), message, suggestion(name, map(str, dataset.dims)))
        asked[name] = _position(dataset[name], value)
    return {name: asked.get(name, dataset.sizes[name] // 2) for name in loose}


def _position(coordinate: xarray.DataArray, value: float) -> int:
    values = np.atleast_1d(np.asarray(coordinate.values, dtype=np.float64))
    if not math.isfinite(value):
        message = f"{value} is not a value of an axis"
        raise PlotError(_place(coordinate.name), message, "Give a finite number")
    away = np.abs(values - value)
    nearest = int(away.argmin())
    # The gap matters about 0, which a computed axis may miss by a rounding error.
    gap = np.abs(np.diff(values)).min(initial=np.inf) if values.size > 1 else 0.0
    if away[nearest] <= TOLERANCE * max(abs(value), abs(values[nearest]), float(gap)):
        return nearest
    unit = str(coordinate.attrs.get("units", "1"))
    near = sorted(values[np.argsort(away, kind="stable")[:2]])
    shown = " and ".join(f"{number:.12g}" for number in near) + ("" if unit == "1" else f" {unit}")
    raise PlotError(
        _place(coordinate.name),
        f"the dataset has no value {value:.12g}",
        f"The nearest are {shown}" if len(near) > 1 else f"Its only value is {shown}",
    )


def _place(name: object) -> str:
    return f"at.{name}"
