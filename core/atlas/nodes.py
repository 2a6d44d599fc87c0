"""The nodes of the grid: they lie close where the function bends, and where regimes change.

It begins with few nodes. What interpolation leaves is measured on lines through points of the
practical range, against exact cells halfway between nodes; the worst intervals of the axis that
gains most for a node are halved, until there are as many nodes as are wanted.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.atlas.cells import exact
from core.atlas.numbers import AXES, HOP, HOP_AFTER_HOP, Numbers
from core.atlas.practice import practical_numbers, spread_points
from core.watch import Watch

POPULATION = 20_000  # typical look-ups, which show how often an interval is asked for
NODE_OFFSET = 1e-6  # of a throw number at which the normal motion changes: a node on either side
BORDER = 0.02  # error that stands for an interval which crosses a border of patterns
DIGITS = 10  # decimals of a score: further ones differ between processors

Axes = tuple[NDArray[np.float64], ...]


def choose_nodes(most: int, probes: int, watch: Watch | None = None) -> Axes:
    """Return the nodes of the four axes, for a grid of at most `most` nodes in all.

    `probes` is the number of lines along each axis on which the error of interpolation is measured.
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
    """Return the nodes to begin with, for each axis.

    The level track and one coefficient of friction are among them, and the throw numbers at which
    motion changes its kind.
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
    """Return the midpoints of intervals of an axis; geometric ones for the angle number.

    `axis` is the number of the axis, `lower` and `upper` are the ends of the intervals.
    """
    if list(AXES)[axis] == "angle_number":
        return np.asarray(np.sqrt(lower * upper))
    return np.asarray((lower + upper) / 2.0)


def _costs(
    axis: int, lower: NDArray[np.float64], upper: NDArray[np.float64], lines: Numbers
) -> NDArray[np.float64]:
    """Return the cost of each interval of an axis: the mean interpolation error in look-ups.

    `axis` is its number, `lower` and `upper` are the ends of the intervals. The error is taken
    halfway between them, on the lines through the points `lines`; a line on which the pattern of
    motion changes costs `BORDER`.
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
