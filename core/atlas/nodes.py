"""The nodes of the grid: they lie close where the function bends, and where regimes change.

It begins with few nodes. What interpolation leaves is measured on lines through points of the
practical range, against exact cells halfway between nodes; the worst intervals of the axis that
gains most for a node are halved, until there are as many nodes as are wanted.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.atlas.cells import exact
from vibrafeed.core.atlas.numbers import AXES, HOP, HOP_AFTER_HOP, Numbers
from vibrafeed.core.atlas.practice import practical_numbers, spread_points
from vibrafeed.core.watch import Watch

POPULATION = 20_000  # typical look-ups, which show how often an interval is asked for
NODE_OFFSET = 1e-6  # of a throw number at which the normal motion changes: a node on either side
BORDER = 0.02  # error that stands for an interval which crosses a border of patterns
DIGITS = 10  # decimals of a score: further ones differ between processors

Axes = tuple[NDArray[np.float64], ...]


def choose_nodes(most: int, probes: int, watch: Watch | None = None) -> Axes:
    """Return the nodes of the four axes of an atlas, close where linear interpolation errs most.

    It begins with a few nodes on each axis. In each round the axis on which halving its worst
    intervals gains most for the nodes added has these intervals halved, until one more round would
    make a grid of more than `most` nodes (the product of the four counts). The score of an interval
    is its mean interpolation error times the share of typical look-ups that fall into it.

    Parameters
    ----------
    most : int
        Largest number of nodes of the grid.
    probes : int
        Number of sample points; a line through each, along each axis, measures the error.
    watch : Watch, optional
        Raises `StoppedError` between rounds if the work is to stop.
    """
    watch = watch or Watch()
    axes = list(_first())
    lines = practical_numbers(spread_points(probes))
    asked = practical_numbers(spread_points(POPULATION))
    costs = [_costs(axis, nodes[:-1], nodes[1:], lines) for axis, nodes in enumerate(axes)]
    while True:
        watch.check()
        scores = [
            np.round(cost * _often(asked[axis], axes[axis]), DIGITS)
            for axis, cost in enumerate(costs)
        ]
        halved = [score >= 0.5 * score.max() for score in scores]
        # The gain of an axis is what its halved intervals err, over the logarithm of the growth.
        gains = [
            float(score[worst].sum()) / np.log1p(worst.sum() / nodes.size)
            for score, worst, nodes in zip(scores, halved, axes, strict=True)
        ]
        axis = int(np.argmax(np.round(gains, DIGITS)))
        nodes, worst = axes[axis], halved[axis]
        middles = _middles(axis, nodes[:-1], nodes[1:])[worst]
        lower, upper = nodes[:-1][worst], nodes[1:][worst]
        finer = np.sort(np.append(nodes, middles))
        if finer.size * np.prod([one.size for at, one in enumerate(axes) if at != axis]) > most:
            return tuple(axes)
        first = np.searchsorted(finer, lower)
        left, right = (_costs(axis, *ends, lines) for ends in ((lower, middles), (middles, upper)))
        cost = np.repeat(costs[axis], 1 + worst)
        cost[first], cost[first + 1] = left, right
        axes[axis], costs[axis] = finer, cost


def _first() -> Axes:
    """Return the few nodes with which the refinement of the atlas begins, one array for each axis.

    The axes are throw number, friction times tan(beta), slope over friction, and static over
    kinetic friction. The level track (slope 0) and one coefficient of friction (ratio 1) are among
    the nodes, and on either side of them the throw numbers at which the kind of motion changes: 1
    (`HOP`: the part lifts off) and sqrt(1 + pi^2) (`HOP_AFTER_HOP`: it lifts off where it lands).
    """
    throw, angle, slope, ratio = AXES.values()
    edges = (
        throw.least, 0.1, 0.3, 0.6, HOP, HOP + NODE_OFFSET, 1.5, 2.2,
        HOP_AFTER_HOP - NODE_OFFSET, HOP_AFTER_HOP + NODE_OFFSET, throw.largest,
    )  # fmt: skip
    return (
        np.array(edges),
        np.geomspace(angle.least, angle.largest, 5).round(4),
        np.linspace(slope.least, slope.largest, 5).round(4),
        np.linspace(ratio.least, ratio.largest, 3).round(4),
    )


def _middles(
    axis: int, lower: NDArray[np.float64], upper: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return midpoints of intervals on an axis of an atlas; geometric ones for the angle number.

    `axis` is the number of the axis (0 to 3, in the order of `AXES`), `lower` and `upper` are the
    ends of the intervals, shape (intervals,), without unit. The angle number, friction times
    tan(beta), spans a factor of 600: its nodes are spaced by equal factors.
    """
    if list(AXES)[axis] == "angle_number":
        return np.asarray(np.sqrt(lower * upper))
    return np.asarray((lower + upper) / 2.0)


def _costs(
    axis: int, lower: NDArray[np.float64], upper: NDArray[np.float64], lines: Numbers
) -> NDArray[np.float64]:
    """Return the mean error of linear interpolation in each interval of an axis of an atlas.

    It has the shape (intervals,). The error is that of the velocity number (mean velocity over the
    drive's speed) at the midpoint of the interval, against an exact simulation there. It is
    averaged over lines parallel to the axis through the points `lines`. A line on which the pattern
    of motion changes within the interval costs `BORDER` instead. Intervals of the least width that
    is meant to stay cost 0.

    Parameters
    ----------
    axis : int
        Number of the axis, 0 to 3, in the order of `AXES`.
    lower, upper : ndarray, shape (intervals,)
        Ends of the intervals.
    lines : Numbers
        The four atlas numbers of the sample points, each of shape (points,).
    """
    middle = _middles(axis, lower, upper)
    stops = np.stack([lower, middle, upper], axis=-1)
    fields = [np.broadcast_to(one[:, None, None], (one.size, *stops.shape)) for one in lines]
    fields[axis] = np.broadcast_to(stops, fields[axis].shape)
    found = exact(Numbers(*fields))
    below, between, above = np.moveaxis(found.velocity, -1, 0)
    share = (middle - lower) / (upper - lower)
    error = np.abs(between - (below + share * (above - below)))
    same = (found.pattern == found.pattern[..., :1]).all(axis=-1) & (found.pattern[..., 0] > 0)
    cost = np.where(same, error, BORDER).mean(axis=0)
    return np.where(upper - lower <= 3 * NODE_OFFSET, 0.0, cost)


def _often(asked: NDArray[np.float64], nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the share of look-ups that fall into each interval between the nodes of an axis.

    `asked` are the values of the axis in typical look-ups.
    """
    return np.asarray(np.histogram(asked, nodes)[0] / asked.size)
