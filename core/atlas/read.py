"""An atlas in memory, as look-ups read it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.atlas.build import ATLAS_VERSION
from vibrafeed.core.atlas.numbers import AXES
from vibrafeed.core.dataset.formats import read_result
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.motion.result import SHARES

VALUES = ("velocity_number", *(f"{name}_fraction" for name in SHARES))
"""The variables that are interpolated."""

ERRORS = (*(f"error_{name}" for name in AXES), "share_error")
"""The variables of which the largest at the corners of a cell counts."""

MAKE = "Make an atlas with: vibrafeed atlas -o atlas.nc"


@dataclass(frozen=True)
class Atlas:
    """An atlas, ready for look-ups.

    Attributes
    ----------
    axes : tuple of ndarray
        The nodes of the four numbers.
    records : ndarray of float32, shape (nodes, 10)
        `VALUES` and `ERRORS` of each node side by side: a corner is then one place in memory.
    patterns : ndarray of int8, shape (nodes,)
        The ways of moving, 0 where there is no answer.
    attributes : mapping
        Global attributes of the file.
    """

    axes: tuple[NDArray[np.float64], ...]
    records: NDArray[np.float32]
    patterns: NDArray[np.int8]
    attributes: Mapping[str, Any]

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of nodes on each axis."""
        return tuple(axis.size for axis in self.axes)


def of_table(table: Table) -> Atlas:
    """Return the atlas in a table, its nodes laid side by side in memory for quick look-ups.

    Raises
    ------
    VibrafeedError
        If the table is no atlas, or an atlas of another version.
    """
    version = table.attributes.get("atlas_version")
    if version is None:
        raise VibrafeedError(f"the file is a result of a study, not an atlas. {MAKE}")
    if version != ATLAS_VERSION:
        told = f"it is an atlas of version {version}, and this program reads {ATLAS_VERSION}"
        raise VibrafeedError(f"{told}. {MAKE}")
    columns = [table.variables[name].values.ravel() for name in (*VALUES, *ERRORS)]
    records = np.stack(columns, axis=-1, dtype=np.float32)
    # Where a node has no answer its pattern says so; 0 is no obstacle where it has no weight.
    np.nan_to_num(records[:, : len(VALUES)], copy=False)
    # An error that nobody knows is larger than any.
    records[np.isnan(records)] = np.inf
    axes = tuple(np.asarray(table.coordinates[name].values) for name in AXES)
    return Atlas(axes, records, table.variables["pattern"].values.ravel(), table.attributes)


def open_atlas(path: str | os.PathLike[str]) -> Atlas:
    """Return the atlas in a NetCDF file or Zarr group, loaded for many look-ups.

    Parameters
    ----------
    path : path
        Atlas file written by `vibrafeed atlas`.

    Raises
    ------
    VibrafeedError
        If it is no atlas, or one of another version.
    OSError
        If it cannot be read.

    Examples
    --------
    >>> try:
    ...     vibrafeed.open_atlas("README.md")
    ... except vibrafeed.VibrafeedError as error:
    ...     print("no atlas")
    no atlas
    """
    return of_table(read_result(os.fspath(path)))
