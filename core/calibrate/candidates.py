"""The next measurement: how much each of some drives would add."""

from __future__ import annotations

import numpy as np

from core.calibrate.model import Model
from core.calibrate.posterior import Posterior
from core.mechanics.arrays import Array
from core.plan.grid import Grid
from core.watch import Watch

ENSEMBLE = 300  # points of the posterior
MOST_CANDIDATES = 2_000
PLACES = 240  # of a speed, at which densities are summed
AROUND = 4.0  # deviations beyond the least and the largest speed
CANDIDATES_AT_A_TIME = 50
BIT = np.log(2.0)


def columns_of(grid: Grid) -> dict[str, Array]:
    """Return the parameters of every candidate, in the units of studies, each of shape (count,)."""
    axes = [grid.coordinate(name) for name in grid.axes]
    mesh = np.meshgrid(*axes, indexing="ij") if axes else []
    found = {name: values.ravel() for name, values in zip(grid.axes, mesh, strict=True)}
    return found | {name: np.full(grid.cells, value) for name, value in grid.fixed.items()}


def typical_error(posterior: Posterior) -> float:
    """Return the standard deviation that another measurement would have."""
    runs = posterior.likelihood.model.runs
    known = runs.error[runs.measured]
    scatter = float(posterior.sizes @ np.square(posterior.likelihood.scatter.sizes))
    usual = float(np.median(known)) if known.size else 0.0
    return float(np.sqrt(usual**2 + scatter))


def information(
    model: Model, posterior: Posterior, grid: Grid, watch: Watch
) -> tuple[Array, Array, Array]:
    """Return what measuring the speed of each candidate would add.

    It is the entropy of the speed that would be measured, less that of its error: by so much the
    entropy of the unknowns is expected to fall (D. V. Lindley, Annals of Mathematical Statistics
    27 (1956) 986).

    Returns
    -------
    gain : ndarray, shape (candidates,)
        In bits.
    mean, deviation : ndarray, shape (candidates,)
        Of the predicted speeds.
    """
    found = model.predict(posterior.ensemble(ENSEMBLE), watch, columns_of(grid))
    value = np.where(np.isnan(found.value), np.nan, found.value)
    spread = np.sqrt(found.variance + typical_error(posterior) ** 2)
    gain = np.empty(value.shape[1])
    for start in range(0, value.shape[1], CANDIDATES_AT_A_TIME):
        some = slice(start, start + CANDIDATES_AT_A_TIME)
        gain[some] = _gain(value[:, some], spread[:, some])
    with np.errstate(all="ignore"):
        known = ~np.isnan(value)
        count = np.maximum(known.sum(axis=0), 1)
        mean = np.where(known, value, 0.0).sum(axis=0) / count
        square = np.square(np.where(known, value - mean, 0.0)).sum(axis=0) / count
    nothing = ~known.any(axis=0)
    return gain, np.where(nothing, np.nan, mean), np.where(nothing, np.nan, np.sqrt(square))


def _gain(value: Array, spread: Array) -> Array:
    """Return the information of some candidates in bits; arrays have shape (ensemble, some)."""
    known = ~np.isnan(value)
    count = known.sum(axis=0)
    least = np.where(known, value - AROUND * spread, np.inf).min(axis=0)
    most = np.where(known, value + AROUND * spread, -np.inf).max(axis=0)
    some = (count > 0) & (most > least)
    found = np.full(value.shape[1], 0.0)
    if not some.any():
        return found
    value, spread, known = value[:, some], spread[:, some], known[:, some]
    steps = (most - least)[some] / (PLACES - 1)
    places = least[some] + steps * np.arange(PLACES)[:, np.newaxis]
    away = (places[np.newaxis] - np.where(known, value, 0.0)[:, np.newaxis]) / spread[:, np.newaxis]
    density = np.exp(-0.5 * np.square(away)) / (np.sqrt(2.0 * np.pi) * spread[:, np.newaxis])
    density = (density * known[:, np.newaxis]).sum(axis=0) / count[some]
    with np.errstate(divide="ignore", invalid="ignore"):
        entropy = -np.where(density > 0, density * np.log(density), 0.0).sum(axis=0) * steps
        own = np.log(spread) + 0.5 * (np.log(2.0 * np.pi) + 1.0)
    noise = np.where(known, own, 0.0).sum(axis=0) / count[some]
    # What motions of no speed tell is not counted: such a run is not one to plan.
    found[some] = np.maximum(entropy - noise, 0.0) / BIT * (count[some] / len(value))
    return found
