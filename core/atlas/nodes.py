"""Where the nodes of the grid lie: close where the function bends, and where regimes change.

It begins with few nodes. What interpolation leaves is measured on lines through points of the
practical range, against exact cells halfway between nodes; the worst intervals of the axis that
gains most for a node are halved, until there are as many nodes as are wanted.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.atlas.cells import exact
from core.atlas.numbers import AXES, HOP, HOP_AFTER_HOP, Numbers
from core.atlas.practice import practical, spread_out
from core.watch import Watch

PROBES = 256  # lines along each axis
POPULATION = 20_000  # points that tell how often an interval is asked for
ASIDE = 1e-6  # of a throw number at which the normal motion changes: a node on either side
BORDER = 0.02  # what an interval that crosses a border costs, as an error
DIGITS = 10  # of a score: what is beyond differs from one processor to the next

Axes = tuple[NDArray[np.float64], ...]


def choose_nodes(most: int, watch: Watch | None = None) -> Axes:
    """Return the nodes of the four axes, of a grid of about `most` nodes."""
    watch = watch or Watch()
    axes = list(_first())
    lines = practical(spread_out(PROBES))
    asked = practical(spread_out(POPULATION))
    scores = [_score(axis, axes, lines, asked) for axis in range(len(axes))]
    while True:
        watch.check()
        halved = [scores[axis] >= 0.5 * scores[axis].max() for axis in range(len(axes))]
        gains = [
            float(scores[axis][worst].sum()) / np.log1p(worst.sum() / axes[axis].size)
            for axis, worst in enumerate(halved)
        ]
        axis = int(np.argmax(np.round(gains, DIGITS)))
        finer = np.sort(np.append(axes[axis], _middles(axis, axes[axis])[halved[axis]]))
        if finer.size * np.prod([one.size for at, one in enumerate(axes) if at != axis]) > most:
            return tuple(axes)
        axes[axis] = finer
        scores[axis] = _score(axis, axes, lines, asked)


def _first() -> Axes:
    """Return the nodes to begin with; the level track and one friction are among them."""
    throw, angle, slope, ratio = AXES.values()
    edges = (
        throw.least, 0.1, 0.3, 0.6, HOP, HOP + ASIDE, 1.5, 2.2,
        HOP_AFTER_HOP - ASIDE, HOP_AFTER_HOP + ASIDE, throw.largest,
    )  # fmt: skip
    return (
        np.array(edges),
        np.geomspace(angle.least, angle.largest, 5).round(4),
        np.linspace(slope.least, slope.largest, 5).round(4),
        np.linspace(ratio.least, ratio.largest, 3).round(4),
    )


def _middles(axis: int, nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where intervals are halved: the angle number spans decades."""
    lower, upper = nodes[:-1], nodes[1:]
    if list(AXES)[axis] == "angle_number":
        return np.asarray(np.sqrt(lower * upper))
    return np.asarray((lower + upper) / 2.0)


def _score(
    axis: int, axes: list[NDArray[np.float64]], lines: Numbers, asked: Numbers
) -> NDArray[np.float64]:
    """Return what each interval of an axis costs: its error, as often as it is asked for."""
    nodes, middles = axes[axis], _middles(axis, axes[axis])
    stops = np.stack([nodes[:-1], middles, nodes[1:]], axis=-1)
    fields = [np.broadcast_to(one[:, None, None], (one.size, *stops.shape)) for one in lines]
    fields[axis] = np.broadcast_to(stops, fields[axis].shape)
    found = exact(Numbers(*fields))
    lower, middle, upper = np.moveaxis(found.velocity, -1, 0)
    share = (middles - nodes[:-1]) / np.diff(nodes)
    error = np.abs(middle - (lower + share * (upper - lower)))
    same = (found.pattern == found.pattern[..., :1]).all(axis=-1) & (found.pattern[..., 0] > 0)
    cost = np.where(same, error, BORDER).mean(axis=0)
    often = np.histogram(asked[axis], nodes)[0] / asked[axis].size
    narrow = np.diff(nodes) <= 3 * ASIDE
    return np.where(narrow, 0.0, np.round(cost * often, DIGITS))
