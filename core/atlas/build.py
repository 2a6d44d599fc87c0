"""The table of an atlas: exact values at every node, and what interpolation between them leaves."""

from __future__ import annotations

import hashlib
import json
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vibrafeed import core
from vibrafeed.core.atlas.cells import BITS, REGIMES_STORED, Cells, exact, regime_of
from vibrafeed.core.atlas.nodes import Axes, choose_nodes
from vibrafeed.core.atlas.numbers import AXES, Numbers
from vibrafeed.core.atlas.practice import PRACTICAL
from vibrafeed.core.dataset.table import (
    CONVENTIONS,
    REFERENCES,
    Table,
    TableVariable,
    quantity_attributes,
    regime_attributes,
)
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.motion.result import SHARES
from vibrafeed.core.watch import Watch

ATLAS_VERSION: Final = 1
"""Version of the content of an atlas; raised when numbers, variables or the error model change."""

RESOLUTIONS: Final = {"coarse": (60_000, 128), "full": (6_000_000, 256)}
"""Most nodes of an atlas, and the lines along each axis on which interpolation is tested to place
nodes."""

VELOCITY_DIGITS: Final = 6  # decimals of a velocity number
SHARE_DIGITS: Final = 5  # decimals of a share of the period
ERROR_DIGITS: Final = 6  # decimals of an error, which is rounded up
SAFETY: Final = 2.0
"""Factor of stated errors over computed ones, since curvature is known at nodes only."""

SHARE_SAFETY: Final = 3.0
"""The same for shares of the period, which begin like a square root."""

SLAB: Final = 200_000  # nodes computed at a time: a bound on memory

ERROR_MODEL = (
    "Between nodes of one pattern: the sum over the four numbers of 4 t (1 - t) times the largest "
    "error_<number> of the corners, t the place between two nodes, 0 to 1, times "
    f"{SAFETY}, plus {2 * 10.0**-VELOCITY_DIGITS:g} for rounding; in the unit of the velocity "
    "number. error_<number> is the second difference along that number, for linear interpolation."
)
UNIT = (
    "A0 w sqrt(cos(beta)^2 + (friction_kinetic sin(beta))^2), the drive's speed as friction sees it"
)
LIMITS = (
    "A part that moves in the plane of the track and its normal, under a plain sine along a line, "
    "without restitution; it starts at rest on the floor (theory 13)."
)


def build(resolution: str = "full", watch: Watch | None = None) -> Table:
    """Compute an atlas: exact mean velocities at its nodes, and errors of interpolation.

    An atlas tabulates planar motion without rebound over four dimensionless numbers, so that
    look-ups interpolate instead of simulating.

    Parameters
    ----------
    resolution : str
        A key of `RESOLUTIONS`: "coarse" or "full".
    watch : Watch, optional
        May stop the computation.

    Raises
    ------
    StoppedError
        If the watch stopped it: an incomplete atlas is not returned.
    """
    watch = watch or Watch()
    axes = choose_nodes(*RESOLUTIONS[resolution], watch)
    cells = _round_cells(_compute_nodes(axes, watch))
    errors = {name: _round_up_error(e) for name, e in zip(AXES, _errors(cells, axes), strict=True)}
    return _label_table(resolution, axes, cells, errors, _round_up_error(_share_error(cells, axes)))


def _compute_nodes(axes: Axes, watch: Watch) -> Cells:
    """Return exact velocities, shares of the period and patterns of motion at nodes of an atlas.

    `axes` are the nodes of the four numbers; the arrays of the result have the shape of their grid.
    The first axis is cut into slabs that are simulated one after another, which bounds memory.
    Raises `StoppedError` if `watch` stops it.
    """
    shape = tuple(one.size for one in axes)
    rows = max(1, SLAB // int(np.prod(shape[1:])))
    parts = []
    for start in range(0, shape[0], rows):
        slab = (axes[0][start : start + rows], *axes[1:])
        share = slab[0].size / shape[0]
        parts.append(exact(Numbers(*np.meshgrid(*slab, indexing="ij")), watch.part(share)))
        if watch.stopped():
            raise StoppedError(
                "the computation of the atlas was stopped before it was complete; start it again"
            )
    return Cells(*(np.concatenate(fields) for fields in zip(*parts, strict=True)))


def _round_cells(cells: Cells) -> Cells:
    """Return values rounded to the digits of the file, so that every processor gives the same."""
    shares = [np.round(getattr(cells, name), SHARE_DIGITS) for name in SHARES]
    return Cells._make((np.round(cells.velocity, VELOCITY_DIGITS), *shares, cells.pattern))


def _round_up_error(error: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return an error rounded up to the stored digits."""
    # A second difference of rounded values is a number of few digits and a rounding.
    scale = 10.0**ERROR_DIGITS
    return np.asarray(np.ceil(np.round(error * scale, 3)) / scale)


def _errors(cells: Cells, axes: Axes) -> list[NDArray[np.float64]]:
    """Return, for each axis, the largest error of linear interpolation beside each node.

    It is that of the velocity number; NaN where no two neighbours tell it.
    """
    return [_bend(cells.velocity, cells.pattern, axes[k], k) for k in range(len(axes))]


def _share_error(cells: Cells, axes: Axes) -> NDArray[np.float64]:
    """Return the interpolation error of the shares of the period at each node of an atlas, 0 to 1.

    It is the largest of four: those of the shares in which the part sticks, slides forwards, slides
    backwards and flies. The errors of a share along the four axes are added.

    Parameters
    ----------
    cells : Cells
        Exact values at the nodes, arrays in the shape of the grid.
    axes : tuple of ndarray
        The values of the nodes along each axis.

    Returns
    -------
    ndarray
        In the shape of the grid: what interpolation over the intervals beside the node is off by at
        most. NaN where along any axis no neighbours have the pattern of motion of the node.
    """
    largest = np.zeros(cells.pattern.shape)
    for name in SHARES:
        values = getattr(cells, name)
        bends = [_bend(values, cells.pattern, axes[k], k) for k in range(len(axes))]
        np.maximum(largest, sum(bends[1:], bends[0]), out=largest)
    return largest


def _bend(
    values: NDArray[np.float64], pattern: NDArray[np.int8], nodes: NDArray[np.float64], axis: int
) -> NDArray[np.float64]:
    """Return the error of linear interpolation along one axis beside each node of the atlas.

    It is |f[x-, x, x+]| h^2/4 with the second divided difference of the values f over a node x and
    its neighbours x-, x+, and the larger gap h beside x. Differences are not taken across a change
    of the pattern of motion: a node without neighbours of its own pattern on both sides takes the
    value of an adjacent node that has them; NaN where there is none.

    Parameters
    ----------
    values, pattern : ndarray, shape of the grid
        f, and the pattern at each node (0: no value); the result has this shape and the unit of f.
    nodes : ndarray, shape (nodes of the axis,)
        Coordinates of the nodes along axis number `axis`.
    """
    f, same = np.moveaxis(values, axis, 0), np.moveaxis(pattern, axis, 0)
    gap = np.diff(nodes).reshape(-1, *[1] * (values.ndim - 1))
    follows = (same[1:] == same[:-1]) & (same[1:] > 0)
    slope = np.diff(f, axis=0) / gap
    bend = np.full(f.shape, np.nan)
    inner = np.abs(np.diff(slope, axis=0)) / (gap[1:] + gap[:-1])
    bend[1:-1] = np.where(follows[1:] & follows[:-1], inner, np.nan)
    after, before = np.full(f.shape, np.nan), np.full(f.shape, np.nan)
    after[:-1] = np.where(follows, bend[1:], np.nan)
    before[1:] = np.where(follows, bend[:-1], np.nan)
    bend = np.where(np.isnan(bend), np.fmax(after, before), bend)
    wide = np.zeros((nodes.size, *gap.shape[1:]))
    wide[:-1], wide[1:] = gap, np.maximum(wide[1:], gap)
    return np.asarray(np.moveaxis(bend * np.square(wide) / 4.0, 0, axis))


def _label_table(
    resolution: str,
    axes: Axes,
    cells: Cells,
    errors: dict[str, NDArray[np.float64]],
    share_error: NDArray[np.float64],
) -> Table:
    """Return the table of an atlas: axes, values, errors and attributes, ready to be written.

    Parameters
    ----------
    resolution : str
        "coarse" or "full", stored as an attribute.
    axes : tuple of ndarray
        Nodes of the four numbers.
    cells : Cells
        Velocities, shares and patterns at the nodes.
    errors : dict of str to ndarray
        Interpolation error of the velocity number beside each node, by name of the axis.
    share_error : ndarray
        The same of the shares of the period, summed over the axes.
    """
    dims = tuple(AXES)

    def stored(values: NDArray[Any], **attributes: Any) -> TableVariable:
        """Return a variable of the atlas with reals in 32 bits."""
        kept = values.astype(np.float32) if values.dtype.kind == "f" else values
        return TableVariable(dims, kept, attributes)

    coordinates = {
        name: TableVariable((name,), nodes, axis.attributes())
        for (name, axis), nodes in zip(AXES.items(), axes, strict=True)
    }
    variables = {
        "velocity_number": stored(
            cells.velocity,
            units="1",
            long_name="Conveying velocity over the drive's speed",
            comment=f"Mean velocity in units of {UNIT}; rounded to {VELOCITY_DIGITS} decimals.",
        ),
        **{
            f"error_{name}": stored(
                error,
                units="1",
                long_name=f"Error of interpolation over the {AXES[name].label.lower()}",
                comment="Of the velocity number, halfway between two nodes; NaN where no two "
                "neighbours give it.",
            )
            for name, error in errors.items()
        },
        **{
            f"{name}_fraction": stored(
                getattr(cells, name), **quantity_attributes(f"{name}_fraction")
            )
            for name in SHARES
        },
        "share_error": stored(
            share_error,
            units="1",
            long_name="Error of interpolation of the shares",
            comment="The largest of the four; sum over the four numbers.",
        ),
        "pattern": stored(
            cells.pattern,
            long_name="Ways of moving that have a share",
            comment="Sum of "
            + ", ".join(f"{bit} ({name})" for name, bit in BITS.items())
            + "; 0: no answer.",
        ),
        "regime": stored(regime_of(cells.pattern), **regime_attributes(REGIMES_STORED)),
    }
    study = json.dumps(
        {
            "kind": "atlas",
            "resolution": resolution,
            "scene": "rectangle-on-plane",
            "method": "events",
            "restitution": 0,
            "practical": PRACTICAL,
        },
        separators=(",", ":"),
    )
    attributes = {
        "Conventions": CONVENTIONS,
        "title": "Atlas of planar motion without restitution",
        "source": f"vibrafeed {core.__version__}, motion in time, method events",
        "references": REFERENCES,
        "comment": LIMITS,
        "atlas_version": ATLAS_VERSION,
        "resolution": resolution,
        "numbers": "; ".join(f"{name}: {axis.definition}" for name, axis in AXES.items()),
        "velocity_unit": UNIT,
        "error_model": ERROR_MODEL,
        "study": study,
        "study_sha256": hashlib.sha256(study.encode()).hexdigest(),
    }
    return Table(coordinates, variables, attributes)
