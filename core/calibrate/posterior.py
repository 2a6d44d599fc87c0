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
    weights_from_logs,
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
    seen_fraction : ndarray, shape (points, watched runs)
        The fraction of the box in which the part does what was seen.
    log : ndarray, shape (points,)
        Logarithms of the density, but for a constant.
    size_probabilities : ndarray, shape (sizes,)
        Probability of each size of the discrepancy.
    """

    likelihood: Likelihood
    explored: Explored
    points: Array
    weights: Array
    value: Array
    variance: Array
    seen_fraction: Array
    log: Array
    size_probabilities: Array

    def quantiles(self, values: Array, fractions: Sequence[float]) -> Array:
        """Return quantiles of values over the posterior, shape (fractions, ...).

        `values` has the points along its first axis; `fractions` are of the mass below.
        """
        columns = values.reshape(len(values), -1)
        quantiles = [weighted_quantiles(column, self.weights, fractions) for column in columns.T]
        return np.stack(quantiles, axis=-1).reshape(len(fractions), *values.shape[1:])

    def mean(self, values: Array) -> Array:
        """Return the posterior mean of values, which have the points along their first axis."""
        return np.asarray(np.tensordot(self.weights, np.nan_to_num(values), 1))

    def covariance(self) -> Array:
        """Return the covariance matrix of the unknowns, shape (unknowns, unknowns)."""
        deviations = self.points - self.mean(self.points)
        return np.einsum("p,pi,pj->ij", self.weights, deviations, deviations)

    def ensemble(self, count: int) -> Array:
        """Return points of equal weight that represent the posterior, shape (count, unknowns).

        They are taken at equal steps of the cumulated weights of the points, sorted by their
        unknowns; in the units of studies. Further runs are predicted at them.
        """
        cumulative = (np.arange(count) + 0.5) / count
        order = np.lexsort(self.points.T)
        positions = np.searchsorted(np.cumsum(self.weights[order]), cumulative)
        return np.asarray(self.points[order[np.minimum(positions, len(order) - 1)]])


def posterior_of(likelihood: Likelihood, explored: Explored) -> Posterior:
    """Return the posterior as weighted points, several in each box of the grid that has mass.

    Predictions at a point follow from those at the centre of its box by their slopes, so that no
    motion is simulated here.
    """
    boxes, log_mass = explored.boxes, explored.log_mass
    boxes = boxes.only(weights_from_logs(log_mass) > NEGLIGIBLE / len(boxes))
    max_points = min(POINTS, max(2_000, MAX_NUMBERS // max(1, boxes.value.shape[1])))
    per_box = int(np.clip(max_points // len(boxes), 1, 512))
    likelihood = replace(likelihood, scatter=likelihood.scatter.finer(explored.size_probabilities))
    offsets, box = _offsets_in_boxes(boxes, per_box)
    value = boxes.value[box] + np.einsum("prk,pk->pr", boxes.slope[box], offsets)
    points = points_of(likelihood, boxes.centre[box] + offsets)
    variance = (boxes.variance + boxes.curvature_variance)[box]
    seen_fraction = boxes.seen_fraction[box]
    log = likelihood.log(value, variance, seen_fraction, points)
    log_density = log_sum(log)  # over the sizes of the discrepancy
    weights = weights_from_logs(log_density + boxes.log_volume[box])
    finite = np.isfinite(log_density)
    size_probabilities = weights[finite] @ np.exp(log[finite] - log_density[finite, np.newaxis])
    return Posterior(
        likelihood,
        explored,
        points,
        weights,
        value,
        variance,
        seen_fraction,
        log_density,
        size_probabilities,
    )


def _offsets_in_boxes(boxes: PosteriorBoxes, per_box: int) -> tuple[Array, NDArray[np.int64]]:
    # Offsets of `per_box` points in each box from its centre, and the number of each point's box.
    unknowns = boxes.centre.shape[1]
    if per_box == 1:
        return np.zeros((len(boxes), unknowns)), np.arange(len(boxes))
    random = np.random.default_rng(0)
    sobol = scipy.stats.qmc.Sobol(unknowns, seed=0).random(1 << int(np.ceil(np.log2(per_box))))[
        :per_box
    ]
    # The same Sobol points in every box, each time shifted at random (modulo 1).
    offsets = (sobol + random.random((len(boxes), 1, unknowns))) % 1.0 - 0.5
    offsets = offsets * boxes.width[:, np.newaxis, np.newaxis]
    return offsets.reshape(-1, unknowns), np.repeat(np.arange(len(boxes)), per_box)


def weighted_quantiles(values: Array, weights: Array, fractions: Sequence[float]) -> Array:
    """Return quantiles of weighted values, such as medians and bounds of a posterior."""
    order = np.argsort(values)
    order = order[np.isfinite(values[order])]
    values, weights = values[order], weights[order]
    if not weights.sum() > 0:
        return np.full(len(fractions), np.nan)
    cumulative = np.cumsum(weights) - 0.5 * weights
    return np.interp(np.asarray(fractions) * weights.sum(), cumulative, values)


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
        margin = BEYOND * (high - low)
        low, high = max(low - margin, unknown.lower), min(high + margin, unknown.upper)
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
    fractions = np.clip((points - model.lower) / model.width, 0.0, 1.0 - 1e-15)
    box = _box_numbers_of(boxes, fractions)
    logs = np.empty(len(points))
    points_per_chunk = max(1, MAX_NUMBERS // max(1, boxes.value.shape[1]))
    for start in range(0, len(points), points_per_chunk):
        chunk = slice(start, start + points_per_chunk)
        chunk_box = box[chunk]
        offsets = fractions[chunk] - boxes.centre[chunk_box]
        value = boxes.value[chunk_box] + np.einsum("prk,pk->pr", boxes.slope[chunk_box], offsets)
        variance = (boxes.variance + boxes.curvature_variance)[chunk_box]
        logs[chunk] = log_sum(
            likelihood.log(value, variance, boxes.seen_fraction[chunk_box], points[chunk])
        )
    top = logs.max()
    logs = np.maximum(logs - (top if np.isfinite(top) else 0.0), LEAST_LOG)
    return logs.reshape(grid.shape[:-1])


def _box_numbers_of(boxes: PosteriorBoxes, fractions: Array) -> NDArray[np.int64]:
    numbers = np.zeros(len(fractions), dtype=np.int64)
    # Boxes of one size are cells of a regular grid: a point lies in the box of the same cell key.
    for halvings in np.unique(boxes.halvings).tolist():
        same_size = np.flatnonzero(boxes.halvings == halvings)
        box_keys = _cell_keys(boxes.centre[same_size], halvings)
        order = np.argsort(box_keys)
        sought = _cell_keys(fractions, halvings)
        position = np.minimum(np.searchsorted(box_keys[order], sought), len(same_size) - 1)
        hit = box_keys[order][position] == sought
        numbers[hit] = same_size[order][position][hit]
    return numbers


def _cell_keys(fractions: Array, halvings: int) -> NDArray[np.int64]:
    keys = np.zeros(len(fractions), dtype=np.int64)
    for column in np.floor(fractions * 2.0**halvings).astype(np.int64).T:
        keys = (keys << halvings) + column
    return keys


def marginal_density(posterior: Posterior, axis: Array, position: int) -> Array:
    """Return the posterior density of one unknown at evenly spaced values, per its unit.

    `axis` are the values, `position` that of the unknown; the density is smoothed over a few
    values.
    """
    mass = np.pad(_bin_mass(posterior, [axis], [position]), len(SMOOTH) // 2, mode="symmetric")
    return np.asarray(np.convolve(mass, SMOOTH, mode="valid")) / (axis[1] - axis[0])


def pair_density(posterior: Posterior, axes: Sequence[Array], first: int, second: int) -> Array:
    """Return the posterior density of two unknowns at evenly spaced values, per their units.

    `axes` are the values of all unknowns, `first` and `second` the positions of these two.
    """
    mass = _bin_mass(posterior, [axes[first], axes[second]], [first, second])
    steps = [axes[k][1] - axes[k][0] for k in (first, second)]
    return mass / (steps[0] * steps[1])


def _bin_mass(posterior: Posterior, axes: Sequence[Array], positions: Sequence[int]) -> Array:
    shape = tuple(len(axis) for axis in axes)
    mass = np.zeros(int(np.prod(shape)))
    low_nodes, upper_weights, inside = [], [], np.ones(len(posterior.points), dtype=bool)
    for axis, position in zip(axes, positions, strict=True):
        node = (posterior.points[:, position] - axis[0]) / (axis[1] - axis[0])
        inside &= (node > -0.5) & (node < len(axis) - 0.5)
        node = np.clip(node, 0.0, len(axis) - 1.0)
        low = np.minimum(node.astype(np.int64), len(axis) - 2)
        low_nodes.append(low)
        upper_weights.append(node - low)
    # A point's weight is shared between the nodes about it, linearly along each axis.
    for corner in np.ndindex(*(2,) * len(axes)):
        weight = np.where(inside, posterior.weights, 0.0)
        index = np.zeros(len(weight), dtype=np.int64)
        for low, upper_weight, side, size in zip(
            low_nodes, upper_weights, corner, shape, strict=True
        ):
            weight = weight * (upper_weight if side else 1.0 - upper_weight)
            index = index * size + low + side
        np.add.at(mass, index, weight)
    mass = mass.reshape(shape)
    for dim in range(mass.ndim):  # nodes at the ends have half a width
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
    dimensions = len(axes)
    indices = np.stack(
        [
            np.clip(
                np.rint((posterior.points[:, k] - axis[0]) / (axis[1] - axis[0])), 0, len(axis) - 1
            )
            for k, axis in enumerate(axes)
        ],
        axis=1,
    ).astype(np.int64)
    shape = tuple(len(axis) for axis in axes)
    node_of_point = np.ravel_multi_index(tuple(indices.T), shape)
    mass: Array = np.bincount(node_of_point, posterior.weights, int(np.prod(shape))).astype(
        np.float64
    )
    order = np.argsort(-mass)
    cumulative = np.cumsum(mass[order])
    neighbours = np.ones((3,) * dimensions)
    # Seeds: connected regions of the densest 90 % or 99 % of the mass, whichever gives more.
    seeds = np.zeros(shape, dtype=np.int16)
    for fraction in HIGHEST:
        dense = np.zeros(mass.size, dtype=bool)
        dense[order[: int(np.searchsorted(cumulative, fraction)) + 1]] = True
        regions = scipy.ndimage.binary_dilation(dense.reshape(shape), neighbours)
        labels = _heaviest_labels(np.asarray(scipy.ndimage.label(regions, neighbours)[0]), mass)
        seeds = labels if labels.max() > seeds.max() else seeds
    depth = np.full(mass.size, DEEPEST)
    np.minimum.at(depth, node_of_point, posterior.log.max() - posterior.log)
    depth = depth.reshape(shape)
    # A watershed labels every node by the seed to which the density rises.
    levels = (np.iinfo(np.uint16).max / DEEPEST * depth).astype(np.uint16)
    labels = _without_shallow_valleys(scipy.ndimage.watershed_ift(levels, seeds, neighbours), depth)
    return _modes(posterior, labels.ravel()[node_of_point])


def _without_shallow_valleys(labels: NDArray[np.int16], depth: Array) -> NDArray[np.int16]:
    merged = labels.copy()
    while True:
        numbers = np.unique(merged).tolist()
        tops = {number: depth[merged == number].min() for number in numbers}
        valleys = []
        for first, second in combinations(numbers, 2):
            # The saddle: of all pairs of neighbours, one in either mode, the least of the deeper.
            first_depth = scipy.ndimage.minimum_filter(np.where(merged == first, depth, np.inf), 3)
            saddle_depths = np.maximum(first_depth, np.where(merged == second, depth, np.inf))
            valleys.append((saddle_depths.min() - max(tops[first], tops[second]), first, second))
        shallowest, first, second = min(valleys, default=(np.inf, 0, 0))
        if not shallowest < VALLEY:
            return merged
        merged[merged == second] = first


def _heaviest_labels(labels: NDArray[np.integer[Any]], mass: Array) -> NDArray[np.int16]:
    masses = np.bincount(labels.ravel(), mass)
    masses[0] = 0.0  # label 0 is no region
    heavy = [label for label in np.argsort(-masses)[:MAX_MODES] if masses[label] >= LEAST_MODE]
    number = np.zeros(masses.size, dtype=np.int16)
    number[heavy] = np.arange(1, len(heavy) + 1)
    return np.asarray(number[labels])


def _modes(posterior: Posterior, labels: NDArray[np.int16]) -> list[PosteriorMode]:
    masses = np.bincount(labels, posterior.weights)
    modes = []
    for label in np.unique(labels).tolist():
        members = np.flatnonzero(labels == label)
        best = posterior.points[members[np.argmax(posterior.log[members])]]
        modes.append(PosteriorMode(float(masses[label]), best))
    return sorted(modes, key=lambda mode: -mode.share)
