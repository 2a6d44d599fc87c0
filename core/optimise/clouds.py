"""Clouds of points that climb hills side by side, by values alone.

Each cloud adapts its centre, size and shape (the covariance of Hansen's CMA-ES, batched over the
hills of all designs). It compares values only, so that neither a jump nor a slanted edge of what is
feasible stops it; the worse half of the clouds of a design is dropped in turns.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array, Mask

TURN = 15  # generations before half of the clouds are dropped
MOST_GENERATIONS = 400
LEAST_SQUARE = 1e-20  # of an axis of a cloud, against its size

Values = Callable[[NDArray[np.intp], Array], Array]
"""Takes the numbers of designs (n,) and points (n, d) of the unit box; returns values (n,)."""


class Rates(NamedTuple):
    """Size, weights and rates of a cloud in d dimensions.

    Hansen, "The CMA evolution strategy: a tutorial" (2016), table 1, without negative weights and
    with a few points more than there.
    """

    points: int
    weights: Array
    mass: float
    path: float
    damping: float
    drift: float
    one: float
    many: float
    expected: float  # length of a normal vector

    @classmethod
    def of(cls, d: int) -> Rates:
        """Return those of d dimensions."""
        points = 10 + int(3 * math.log(d))
        kept = points // 2
        weights = math.log(kept + 0.5) - np.log(np.arange(1, kept + 1))
        weights /= weights.sum()
        mass = 1 / float(np.sum(weights**2))
        path = (mass + 2) / (d + mass + 5)
        one = 2 / ((d + 1.3) ** 2 + mass)
        return cls(
            points,
            weights,
            mass,
            path,
            1 + 2 * max(0.0, math.sqrt((mass - 1) / (d + 1)) - 1) + path,
            (4 + mass / d) / (d + 4 + 2 * mass / d),
            one,
            min(1 - one, 2 * (mass - 2 + 1 / mass) / ((d + 2) ** 2 + mass)),
            math.sqrt(d) * (1 - 1 / (4 * d) + 1 / (21 * d * d)),
        )


class Clouds(NamedTuple):
    """Clouds, one a row: their designs, centres, best values, sizes, shapes and paths."""

    design: NDArray[np.intp]
    centre: Array
    top: Array
    sigma: Array
    shape: Array
    path: Array
    drift: Array

    def only(self, rows: Mask) -> Clouds:
        """Return some of the clouds."""
        return Clouds._make(part[rows] for part in self)

    def size(self) -> Array:
        """Return the largest variance of a coordinate of each cloud, as a length."""
        return self.sigma * np.sqrt(np.einsum("hii->hi", self.shape).max(axis=1))


def start(design: NDArray[np.intp], centre: Array, top: Array, size: float) -> Clouds:
    """Return round clouds of designs (n,) around centres (n, d) with values `top` (n,)."""
    rows, d = centre.shape
    return Clouds(
        design,
        centre,
        top,
        np.full(rows, size),
        np.repeat(np.eye(d)[None], rows, axis=0),
        np.zeros((rows, d)),
        np.zeros((rows, d)),
    )


def follow(
    clouds: Clouds,
    values: Values,
    best: Array,
    left: int,
    tolerance: float,
    random: np.random.Generator,
) -> Array:
    """Follow clouds uphill; return the size of each design's best cloud, shape (designs,).

    Parameters
    ----------
    clouds : Clouds
        Where they start.
    values : callable
        The objective; it keeps `best`, the largest value of each design so far, up to date.
    best : ndarray, shape (designs,)
        See `values`.
    left : int
        Evaluations that may still be spent on each design.
    tolerance : float
        A smaller cloud has arrived.
    random : Generator
        Draws the points, the same for all clouds.
    """
    rates = Rates.of(clouds.centre.shape[1])
    sizes = np.full(best.shape, np.inf)
    alive = np.isfinite(clouds.top)
    for generation in range(1, MOST_GENERATIONS + 1):
        clouds = clouds.only(alive)
        if not clouds.design.size:
            break
        left -= rates.points * int(np.bincount(clouds.design).max())
        if left < 0:
            break
        clouds, found = _next_generation(values, clouds, rates, generation, random)
        size_now = clouds.size()
        leads = clouds.top == best[clouds.design]
        sizes[clouds.design[leads]] = size_now[leads]
        alive = (size_now >= tolerance) & found
        if generation % TURN == 0:
            number = np.bincount(clouds.design)[clouds.design]
            alive &= _place_in_design(clouds.design, clouds.top) < np.maximum(1, number // 2)
    return sizes


def _next_generation(
    values: Values,
    clouds: Clouds,
    rates: Rates,
    generation: int,
    random: np.random.Generator,
) -> tuple[Clouds, Mask]:
    """Return the clouds after one more sample of each, and where a point had a value."""
    design, centre, top, sigma, shape, path, drift = clouds
    d = centre.shape[1]
    squares, axes = np.linalg.eigh(shape)
    lengths = np.sqrt(np.maximum(squares, LEAST_SQUARE))
    normal = random.standard_normal((rates.points, d))  # the same for all: see `search_many`
    steps = np.einsum("hij,hj,lj->hli", axes, lengths, normal)
    cloud = np.clip(centre[:, None] + sigma[:, None, None] * steps, 0.0, 1.0)
    reached = values(np.repeat(design, rates.points), cloud.reshape(-1, d))
    reached = reached.reshape(-1, rates.points)
    order = np.argsort(-reached, axis=1, kind="stable")[:, : rates.weights.size]
    chosen = np.take_along_axis(cloud, order[..., None], axis=1)
    steps = (chosen - centre[:, None]) / sigma[:, None, None]
    step = np.einsum("l,hli->hi", rates.weights, steps)
    whitened = np.einsum("hij,hj,hkj,hk->hi", axes, 1 / lengths, axes, step)
    path = (1 - rates.path) * path
    path += math.sqrt(rates.path * (2 - rates.path) * rates.mass) * whitened
    length = np.linalg.norm(path, axis=1)
    settled = math.sqrt(1 - (1 - rates.path) ** (2 * generation))
    short = length / settled < (1.4 + 2 / (d + 1)) * rates.expected
    goes_on = short.astype(np.float64)[:, None]
    drift_gain = rates.drift * (2 - rates.drift)
    drift = (1 - rates.drift) * drift + goes_on * math.sqrt(drift_gain * rates.mass) * step
    lost = ((1 - goes_on) * drift_gain)[..., None] * shape
    shape = (
        (1 - rates.one - rates.many) * shape
        + rates.one * (drift[:, :, None] * drift[:, None, :] + lost)
        + rates.many * np.einsum("l,hli,hlj->hij", rates.weights, steps, steps)
    )
    growth = rates.path / rates.damping * (length / rates.expected - 1)
    highest = reached.max(axis=1)
    after = Clouds(
        design,
        centre + sigma[:, None] * step,
        np.maximum(top, highest),
        sigma * np.exp(np.minimum(1.0, growth)),
        shape,
        path,
        drift,
    )
    return after, np.isfinite(highest)


def _place_in_design(design: NDArray[np.intp], top: Array) -> NDArray[np.intp]:
    """Return the place of each row among those of its design, the best 0."""
    order = np.lexsort((-top, design))
    _, first = np.unique(design[order], return_index=True)
    start = np.zeros(len(design), dtype=np.intp)
    start[first] = first
    place = np.empty_like(start)
    place[order] = np.arange(len(design)) - np.maximum.accumulate(start)
    return place
