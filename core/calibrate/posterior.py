"""The posterior as points with weights, and what they tell: means, intervals, marginals, modes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from vibrafeed.core.calibrate.boxes import (
    Explored,
    Likelihood,
    PosteriorBoxes,
    log_sum,
    points_of,
    shares_of,
)
from vibrafeed.core.mechanics.arrays import Array

POINTS = 60_000  # points within the boxes, about
MAX_NUMBERS = 4_000_000  # points times runs that are held at a time: a bound on memory
NEGLIGIBLE = 1e-7  # share of the mass in boxes that are left out
AXIS = {1: 201, 2: 81, 3: 41, 4: 21}
"""Values of each unknown at which densities are given, by the number of unknowns."""
SMOOTH = np.array([1.0, 8.0, 28.0, 56.0, 70.0, 56.0, 28.0, 8.0, 1.0]) / 256.0
"""Weights by which the density of one unknown, at 201 values, is smoothed over nine neighbours."""
TAIL = 1e-4  # share of the mass beyond either end of the values at which densities are given
BEYOND = 0.08  # of the distance of these ends, by which the values reach further
LEAST_LOG = -700.0  # least logarithm of a density, whose exponential is still above 0
HIGHEST = (0.9, 0.99)  # shares of the mass whose regions of highest density are looked at for modes
LEAST_MODE = 0.02  # share of the mass that a mode has at least
DEEPEST = 50.0  # depth below the top of the log density to which modes are parted
MAX_MODES = 6  # modes that are told apart, the heaviest
VALLEY = np.log(2.0)  # depth of the valley between two modes below the lower top, at least


@dataclass(frozen=True)
class Posterior:
    """Points of the unknowns with weights.

    Attributes
    ----------
    likelihood : Likelihood
        The likelihood of the observations.
    explored : Explored
        The boxes that the points lie in.
    points : ndarray, shape (points, unknowns)
        Values of the unknowns, in the units of studies.
    weights : ndarray, shape (points,)
        They add up to 1.
    value, variance : ndarray, shape (points, runs)
        Predicted values of the runs and their variances, by the slopes of the boxes.
    shown : ndarray, shape (points, watched runs)
        The share of the box in which the part does what was seen.
    log : ndarray, shape (points,)
        Logarithms of the density, but for a constant.
    sizes : ndarray, shape (sizes,)
        Probability of each size of the discrepancy.
    """

    likelihood: Likelihood
    explored: Explored
    points: Array
    weights: Array
    value: Array
    variance: Array
    shown: Array
    log: Array
    sizes: Array

    def quantiles(self, values: Array, shares: Sequence[float]) -> Array:
        """Return quantiles of values over the posterior, shape (shares, ...).

        `values` has the points along its first axis; `shares` are the shares of the mass below.
        """
        columns = values.reshape(len(values), -1)
        found = [weighted_quantiles(column, self.weights, shares) for column in columns.T]
        return np.stack(found, axis=-1).reshape(len(shares), *values.shape[1:])

    def mean(self, values: Array) -> Array:
        """Return the posterior mean of values, which have the points along their first axis."""
        return np.asarray(np.tensordot(self.weights, np.nan_to_num(values), 1))

    def covariance(self) -> Array:
        """Return the covariance matrix of the unknowns, shape (unknowns, unknowns)."""
        away = self.points - self.mean(self.points)
        return np.einsum("p,pi,pj->ij", self.weights, away, away)

    def ensemble(self, count: int) -> Array:
        """Return points of equal weight that represent the posterior, shape (count, unknowns).

        They are taken at equal steps of the cumulated weights of the points, sorted by their
        unknowns; in the units of studies. Further runs are predicted at them.
        """
        places = (np.arange(count) + 0.5) / count
        order = np.lexsort(self.points.T)
        chosen = np.searchsorted(np.cumsum(self.weights[order]), places)
        return np.asarray(self.points[order[np.minimum(chosen, len(order) - 1)]])


def posterior_of(likelihood: Likelihood, explored: Explored) -> Posterior:
    """Return the posterior as weighted points, several in each box of the grid that has mass.

    Predictions at a point follow from those at the centre of its box by their slopes, so that no
    motion is simulated here.
    """
    boxes, log_mass = explored.boxes, explored.log_mass
    boxes = boxes.only(shares_of(log_mass) > NEGLIGIBLE / len(boxes))
    most = min(POINTS, max(2_000, MAX_NUMBERS // max(1, boxes.value.shape[1])))
    each = int(np.clip(most // len(boxes), 1, 512))
    likelihood = replace(likelihood, scatter=likelihood.scatter.finer(explored.sizes))
    share, where = _within(boxes, each)
    value = boxes.value[where] + np.einsum("prk,pk->pr", boxes.slope[where], share)
    points = points_of(likelihood, boxes.centre[where] + share)
    variance = (boxes.variance + boxes.rough)[where]
    shown = boxes.shown[where]
    log = likelihood.log(value, variance, shown, points)
    density = log_sum(log)
    weights = shares_of(density + boxes.log_volume[where])
    known = np.isfinite(density)
    sizes = weights[known] @ np.exp(log[known] - density[known, np.newaxis])
    return Posterior(likelihood, explored, points, weights, value, variance, shown, density, sizes)


def _within(boxes: PosteriorBoxes, each: int) -> tuple[Array, NDArray[np.int64]]:
    count = boxes.centre.shape[1]
    if each == 1:
        return np.zeros((len(boxes), count)), np.arange(len(boxes))
    random = np.random.default_rng(0)
    even = scipy.stats.qmc.Sobol(count, seed=0).random(1 << int(np.ceil(np.log2(each))))[:each]
    share = (even + random.random((len(boxes), 1, count))) % 1.0 - 0.5
    share = share * boxes.width[:, np.newaxis, np.newaxis]
    return share.reshape(-1, count), np.repeat(np.arange(len(boxes)), each)


def weighted_quantiles(values: Array, weights: Array, shares: Sequence[float]) -> Array:
    """Return quantiles of weighted values, such as medians and bounds of a posterior."""
    order = np.argsort(values)
    order = order[np.isfinite(values[order])]
    values, weights = values[order], weights[order]
    if not weights.sum() > 0:
        return np.full(len(shares), np.nan)
    below = np.cumsum(weights) - 0.5 * weights
    return np.interp(np.asarray(shares) * weights.sum(), below, values)


def axes_of(posterior: Posterior) -> list[Array]:
    """Return evenly spaced values of each unknown, at which densities are stored.

    They are in the units of studies, one array for each unknown, and cover all but the tails
    (`TAIL` at each end) of the posterior mass, with a margin, within the bounds of the unknown.
    """
    model = posterior.likelihood.model
    count = AXIS[len(model.unknowns)]
    ends = posterior.quantiles(posterior.points, (TAIL, 1.0 - TAIL))
    axes = []
    for k, unknown in enumerate(model.unknowns):
        low, high = ends[:, k]
        more = BEYOND * (high - low)
        low, high = max(low - more, unknown.lower), min(high + more, unknown.upper)
        if not high - low > 1e-9 * unknown.width:
            middle = 0.5 * (low + high)
            low, high = middle - 1e-6 * unknown.width, middle + 1e-6 * unknown.width
        axes.append(np.linspace(low, high, count))
    return axes


def log_density(posterior: Posterior, axes: Sequence[Array]) -> Array:
    """Return the logarithm of the posterior density on a grid of the unknowns, at most 0.

    It is 0 where the density is largest, and cut at `LEAST_LOG`. `axes` are the values of each
    unknown, in the units of studies; the result has an axis for each. Predictions at a point follow
    from those at the centre of its box by their slopes.
    """
    likelihood, boxes = posterior.likelihood, posterior.explored.boxes
    model = likelihood.model
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    points = grid.reshape(-1, len(axes))
    share = np.clip((points - model.lower) / model.width, 0.0, 1.0 - 1e-15)
    where = _box_of(boxes, share)
    whole = np.empty(len(points))
    step = max(1, MAX_NUMBERS // max(1, boxes.value.shape[1]))
    for start in range(0, len(points), step):
        some = slice(start, start + step)
        at = where[some]
        away = share[some] - boxes.centre[at]
        value = boxes.value[at] + np.einsum("prk,pk->pr", boxes.slope[at], away)
        variance = (boxes.variance + boxes.rough)[at]
        whole[some] = log_sum(likelihood.log(value, variance, boxes.shown[at], points[some]))
    top = whole.max()
    whole = np.maximum(whole - (top if np.isfinite(top) else 0.0), LEAST_LOG)
    return whole.reshape(grid.shape[:-1])


def _box_of(boxes: PosteriorBoxes, share: Array) -> NDArray[np.int64]:
    box = np.zeros(len(share), dtype=np.int64)
    for halvings in np.unique(boxes.halvings).tolist():
        ours = np.flatnonzero(boxes.halvings == halvings)
        keys = _keys(boxes.centre[ours], halvings)
        order = np.argsort(keys)
        asked = _keys(share, halvings)
        place = np.minimum(np.searchsorted(keys[order], asked), len(ours) - 1)
        hit = keys[order][place] == asked
        box[hit] = ours[order][place][hit]
    return box


def _keys(share: Array, halvings: int) -> NDArray[np.int64]:
    keys = np.zeros(len(share), dtype=np.int64)
    for column in np.floor(share * 2.0**halvings).astype(np.int64).T:
        keys = (keys << halvings) + column
    return keys


def marginal(posterior: Posterior, axis: Array, k: int) -> Array:
    """Return the posterior density of one unknown at evenly spaced values, per its unit.

    `axis` are the values, `k` is the position of the unknown; the density is smoothed over a few
    values.
    """
    found = np.pad(_bin_mass(posterior, [axis], [k]), len(SMOOTH) // 2, mode="symmetric")
    return np.asarray(np.convolve(found, SMOOTH, mode="valid")) / (axis[1] - axis[0])


def pair(posterior: Posterior, axes: Sequence[Array], first: int, second: int) -> Array:
    """Return the posterior density of two unknowns at evenly spaced values, per their units.

    `axes` are the values of all unknowns, `first` and `second` the positions of these two.
    """
    found = _bin_mass(posterior, [axes[first], axes[second]], [first, second])
    steps = [axes[k][1] - axes[k][0] for k in (first, second)]
    return found / (steps[0] * steps[1])


def _bin_mass(posterior: Posterior, axes: Sequence[Array], which: Sequence[int]) -> Array:
    shape = tuple(len(axis) for axis in axes)
    mass = np.zeros(int(np.prod(shape)))
    lows, shares, inside = [], [], np.ones(len(posterior.points), dtype=bool)
    for axis, k in zip(axes, which, strict=True):
        position = (posterior.points[:, k] - axis[0]) / (axis[1] - axis[0])
        inside &= (position > -0.5) & (position < len(axis) - 0.5)
        position = np.clip(position, 0.0, len(axis) - 1.0)
        low = np.minimum(position.astype(np.int64), len(axis) - 2)
        lows.append(low)
        shares.append(position - low)
    for corner in np.ndindex(*(2,) * len(axes)):
        weight = np.where(inside, posterior.weights, 0.0)
        flat = np.zeros(len(weight), dtype=np.int64)
        for low, share, side, size in zip(lows, shares, corner, shape, strict=True):
            weight = weight * (share if side else 1.0 - share)
            flat = flat * size + low + side
        np.add.at(mass, flat, weight)
    mass = mass.reshape(shape)
    for dim in range(mass.ndim):  # the first and the last gather from one side alone
        edge = [slice(None)] * mass.ndim
        for end in (0, -1):
            edge[dim] = end  # type: ignore[call-overload]
            mass[tuple(edge)] *= 2.0
    return mass


@dataclass(frozen=True)
class PosteriorMode:
    """One of several separate regions of the unknowns that explain the runs.

    Attributes
    ----------
    share : float
        Its share of the posterior mass.
    best : ndarray, shape (unknowns,)
        The point of the highest density among its points, in the units of studies.
    """

    share: float
    best: Array


def modes_of(posterior: Posterior, axes: Sequence[Array]) -> list[PosteriorMode]:
    """Return the separate modes of a posterior, the heaviest first; at least one.

    A mode is a connected region of high density that explains the runs by itself: between two, the
    density falls below half of the lower top. Regions are sought on a grid over `axes`, evenly
    spaced values of each unknown in the units of studies. Every point belongs to a mode; one
    between two modes belongs to that to which the log density rises (a watershed).
    """
    count = len(axes)
    nodes = np.stack(
        [
            np.clip(np.rint((posterior.points[:, k] - a[0]) / (a[1] - a[0])), 0, len(a) - 1)
            for k, a in enumerate(axes)
        ],
        axis=1,
    ).astype(np.int64)
    shape = tuple(len(axis) for axis in axes)
    flat = np.ravel_multi_index(tuple(nodes.T), shape)
    mass: Array = np.bincount(flat, posterior.weights, int(np.prod(shape))).astype(np.float64)
    order = np.argsort(-mass)
    cumulative = np.cumsum(mass[order])
    neighbours = np.ones((3,) * count)
    # Separate regions of the densest 90 % or 99 % of the mass, of that with more of them.
    seeds = np.zeros(shape, dtype=np.int16)
    for share in HIGHEST:
        high = np.zeros(mass.size, dtype=bool)
        high[order[: int(np.searchsorted(cumulative, share)) + 1]] = True
        wide = scipy.ndimage.binary_dilation(high.reshape(shape), neighbours)
        found = _heaviest(np.asarray(scipy.ndimage.label(wide, neighbours)[0]), mass)
        seeds = found if found.max() > seeds.max() else seeds
    depth = np.full(mass.size, DEEPEST)
    np.minimum.at(depth, flat, posterior.log.max() - posterior.log)
    depth = depth.reshape(shape)
    # Every node joins the seed to which it rises; regions with a shallow valley between them merge.
    levels = (np.iinfo(np.uint16).max / DEEPEST * depth).astype(np.uint16)
    parted = _deeply_parted(scipy.ndimage.watershed_ift(levels, seeds, neighbours), depth)
    return _modes(posterior, parted.ravel()[flat])


def _deeply_parted(labels: NDArray[np.int16], depth: Array) -> NDArray[np.int16]:
    merged = labels.copy()
    while True:
        numbers = np.unique(merged).tolist()
        tops = {number: depth[merged == number].min() for number in numbers}
        valleys = []
        for first, second in combinations(numbers, 2):
            # The way over the highest saddle crosses neighbours, one in either mode.
            near = scipy.ndimage.minimum_filter(np.where(merged == first, depth, np.inf), 3)
            passes = np.maximum(near, np.where(merged == second, depth, np.inf))
            valleys.append((passes.min() - max(tops[first], tops[second]), first, second))
        least, first, second = min(valleys, default=(np.inf, 0, 0))
        if not least < VALLEY:
            return merged
        merged[merged == second] = first


def _heaviest(labels: NDArray[np.integer[Any]], mass: Array) -> NDArray[np.int16]:
    shares = np.bincount(labels.ravel(), mass)
    shares[0] = 0.0  # between them
    heavy = [label for label in np.argsort(-shares)[:MAX_MODES] if shares[label] >= LEAST_MODE]
    number = np.zeros(shares.size, dtype=np.int16)
    number[heavy] = np.arange(1, len(heavy) + 1)
    return np.asarray(number[labels])


def _modes(posterior: Posterior, labels: NDArray[np.int16]) -> list[PosteriorMode]:
    shares = np.bincount(labels, posterior.weights)
    modes = []
    for label in np.unique(labels).tolist():
        ours = np.flatnonzero(labels == label)
        best = posterior.points[ours[np.argmax(posterior.log[ours])]]
        modes.append(PosteriorMode(float(shares[label]), best))
    return sorted(modes, key=lambda mode: -mode.share)
