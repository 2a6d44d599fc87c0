"""Cells of a study that have the motion normal to the floor in common, as a sample for a trial.

Motions that do not repeat share their landings, which take most of their time: `kernels.planar`
finds them once for all cells that differ in friction or along the track alone. So a cell takes less
beside such others than it takes alone, and a trial has to follow both.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.groups import Contacts, Groups
from vibrafeed.core.motion.planar import SETS_LANDINGS
from vibrafeed.core.motion.price import some_cells
from vibrafeed.core.plan.grid import Grid, positions_of
from vibrafeed.core.plan.plan import Plan

SIBLINGS = 4
"""Cells with the same motion normal to the floor that a trial follows together."""
COMPARED = 8  # cells whose groups are compared with those of a neighbour on an axis


@dataclass(frozen=True)
class Families:
    """Cells of a study of which no two land at the same times, and siblings that do so with each.

    Attributes
    ----------
    count : int
        Number of families.
    size : int
        Number of cells of the study with the same motion normal to the floor.
    singles : mapping of str to ndarray
        Parameters of cells without a sibling among them, shape (count,), SI units.
    siblings : mapping of str to ndarray
        Parameters of some siblings of each, those of a cell one after another, shape (count * n,).
    each : int
        Number n of siblings of a cell, itself among them.
    """

    count: int
    size: int
    singles: Mapping[str, Array]
    siblings: Mapping[str, Array]
    each: int


def families_of(plan: Plan, grid: Grid, contacts: Contacts, most: int) -> Families | None:
    """Return a sample of at most `most` families of a study of motion; None if no cells share.

    The sample is the same for equal grids. `contacts` are the surfaces that the part can touch.
    """
    shared = _axes_in_common(plan, grid, contacts)
    size = math.prod(grid.shape[name] for name in shared)
    if size == 1:
        return None
    along = {name: grid.shape[name] for name in shared}
    own = {name: length for name, length in grid.shape.items() if name not in along}
    kinds = math.prod(own.values())
    chosen = np.array(random.Random(0).sample(range(kinds), min(most, kinds)), dtype=np.int64)
    each = min(SIBLINGS, size)
    first = np.random.default_rng(0).integers(size, size=chosen.size)
    # Equal steps around the shared axes: no sibling comes twice.
    beside = (first[:, np.newaxis] + np.arange(each) * (size // each)) % size
    place = positions_of(own, chosen)
    singles = place | positions_of(along, first)
    siblings = {name: np.repeat(at, each) for name, at in place.items()}
    siblings |= positions_of(along, beside.ravel())
    return Families(
        chosen.size,
        size,
        grid.at(singles, chosen.size, plan.parameters),
        grid.at(siblings, chosen.size * each, plan.parameters),
        each,
    )


def _axes_in_common(plan: Plan, grid: Grid, contacts: Contacts) -> list[str]:
    """Return the axes of a grid along which the motion changes, but not that normal to the floor.

    Found from the dimensionless groups of some cells and of their neighbours on each axis.
    """
    generator = np.random.default_rng(0)
    here = {name: generator.integers(size, size=COMPARED) for name, size in grid.shape.items()}

    def groups_at(positions: Mapping[str, NDArray[np.int64]]) -> Any:
        cells = grid.at(positions, COMPARED, plan.parameters)
        return some_cells(plan, cells, {}, contacts).known.get("groups")

    groups = groups_at(here)
    if groups is None or groups.wave is not None:  # landings under waves are found for each cell
        return []
    shared = []
    for name, size in grid.shape.items():
        others = groups_at({**here, name: (here[name] + 1) % size})
        changed = [
            field
            for field, number, other in zip(
                Groups._fields, groups.numbers, others.numbers, strict=False
            )
            if not np.array_equal(number, other, equal_nan=True)
        ]
        if changed and not set(changed) & set(SETS_LANDINGS):
            shared.append(name)
    return shared
