"""What the claims of chapter 5 speak of, measured on the data of a figure."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from benchmarks.figures.judgement import EXACT
from benchmarks.figures.studies import data
from vibrafeed.core.quantities import REGIMES


def slope(values: xr.DataArray) -> xr.DataArray:
    """Return the change of values from friction 0 to 1."""
    return values.sel(friction=1) - values.sel(friction=0)


def crossing(values: xr.DataArray, level: float = 0.0) -> float:
    """Return the coordinate where values first cross a level, by linear interpolation."""
    (dim,) = values.dims
    x, y = values[dim].values, values.values - level
    i = int(np.flatnonzero(np.sign(y[:-1]) != np.sign(y[1:]))[0])
    return float(x[i] - y[i] * (x[i + 1] - x[i]) / (y[i + 1] - y[i]))


def at_largest(values: xr.DataArray) -> dict[str, float]:
    """Return the coordinates of the largest value."""
    place = values.where(values == values.max(), drop=True)
    return {str(dim): float(place[dim].item()) for dim in values.dims}


def is_polynomial(values: xr.DataArray, dim: str, degree: int) -> bool:
    """True if values over an even axis are a polynomial of exactly this degree."""
    size = float(abs(values).max())
    rest = float(abs(values.diff(dim, degree + 1)).max())
    return rest <= EXACT * size < float(abs(values.diff(dim, degree)).max())


def is_sinusoidal(values: xr.DataArray, dim: str) -> bool:
    """True if values over an angle are a constant plus a cosine and a sine of it."""
    angle = np.deg2rad(values[dim].values)
    shapes = np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=1)
    rows = values.transpose(dim, ...).values.reshape(angle.size, -1)
    fit, *_ = np.linalg.lstsq(shapes, rows)
    return bool(abs(shapes @ fit - rows).max() <= EXACT * abs(rows).max())


def rises(values: xr.DataArray, dim: str) -> bool:
    """True if values never decrease along an axis."""
    return bool((values.diff(dim) >= 0).all())


def extents(inside: xr.DataArray) -> dict[str, tuple[float, float]]:
    """Return the smallest and largest coordinates of a region, by axis."""
    found = {}
    for dim in map(str, inside.dims):
        along = inside[dim].where(inside.any([other for other in inside.dims if other != dim]))
        found[dim] = (float(along.min()), float(along.max()))
    return found


def nearest_region(
    values: xr.DataArray, box: Mapping[str, tuple[float, float]], *, above: bool
) -> tuple[float, dict[str, tuple[float, float]], float]:
    """Return the level whose region fits a printed box best, with extents and misfit.

    The misfit is the largest distance of an edge from the printed one.
    """
    fits = []
    for level in np.arange(np.ceil(2 * values.min()), np.floor(2 * values.max())) / 2:
        found = extents(values >= level if above else values <= level)
        misfit = max(abs(found[d][i] - box[d][i]) for d in box for i in (0, 1))
        fits.append((misfit, float(level), found))
    misfit, level, found = min(fits, key=lambda fit: fit[:2])
    return level, found, misfit


def shortfall(
    values: xr.DataArray, box: Mapping[str, tuple[float, float]], *, above: bool
) -> float:
    """Return the deficit of a box's worst value from the best of all, over the range."""
    inside = values.sel({dim: slice(*ends) for dim, ends in box.items()})
    gap = values.max() - inside.min() if above else inside.max() - values.min()
    return float(gap / (values.max() - values.min()))


def share(inside: xr.DataArray) -> str:
    """Return the share of cells in per cent."""
    return f"{100 * float(inside.mean()):.0f} %"


def in_regimes(number: int, *names: str) -> xr.DataArray:
    """Return a mask of a figure's cells in one of some regimes."""
    return data(number)["regime"].isin([REGIMES[name].value for name in names])


def beyond_lift_off(number: int) -> xr.DataArray:
    """Return a mask of the cells in which the part has left the floor."""
    return in_regimes(number, "flight", "flight_and_wall_lost")


def wall_pulls(number: int) -> xr.DataArray:
    """Return a mask of the cells in which the wall would have to pull."""
    return in_regimes(number, "wall_lost", "flight_and_wall_lost")


def lift_off_angle() -> float:
    """Return the drive angle of lift-off at 60 Hz and 0.5 mm [degree]."""
    return crossing(data(3)["throw_number"], 1)


def span(pair: tuple[float, float], digits: int = 1) -> str:
    """Return two numbers as a range in words."""
    return " to ".join(dict.fromkeys(f"{value:.{digits}f}" for value in pair))
