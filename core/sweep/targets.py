"""The target of a sweep that is computed tile by tile, chosen by the name of the result."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from vibrafeed import core
from vibrafeed.core.dataset.growing import GrowingNetcdf
from vibrafeed.core.dataset.netcdf import define
from vibrafeed.core.dataset.read import attributes_of_file
from vibrafeed.core.dataset.shards import GrowingZarr, attributes_at
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plan.shares import identity
from vibrafeed.core.plan.tiles import Tiled


def is_zarr(where: str) -> bool:
    """True if a path or URL names a Zarr group."""
    return "://" in where or where.lower().endswith(".zarr")


def attributes_there(where: str) -> Mapping[str, object]:
    """Return the global attributes of an existing result; none if there is none."""
    if is_zarr(where):
        return attributes_at(where)
    return attributes_of_file(Path(where)) if Path(where).exists() else {}


def is_complete(where: str, prepared: Prepared) -> bool:
    """True if at a path lies the result that this version of the program made of the same study.

    Results appear only when they are complete. `prepared` is the study.
    """
    attributes = attributes_there(where)
    made = str(attributes.get("source")).partition(",")[0]
    return (
        attributes.get("study_sha256") == prepared.study.key()
        and made == f"vibrafeed {core.__version__}"
    )


def open_target(
    where: str | os.PathLike[str],
    sweep: Prepared,
    table: Table,
    *,
    compression: bool = True,
    resume: bool = False,
    history: str | None = None,
) -> GrowingNetcdf | GrowingZarr:
    """Return the file or Zarr group under way into which the tiles of a sweep are written.

    Parameters
    ----------
    where : str or path
        A NetCDF file, or a Zarr group: see `is_zarr`.
    sweep : Prepared
        The sweep.
    table : Table
        Its `outline_table`: names, shapes and attributes of all arrays.
    compression : bool
        Of a NetCDF file; the chunks of a Zarr group are compressed in any case.
    resume : bool
        Go on with what an equal run has begun there.
    history : str, optional
        The CF history attribute; a run that goes on keeps that of a file.

    Raises `OSError` if it cannot be written, or something else is there.
    """
    where, tiles, made = os.fspath(where), Tiled(sweep).tiles, identity(sweep.study)
    if is_zarr(where):
        return GrowingZarr(where, tiles, table, made, resume=resume, history=history)
    return GrowingNetcdf(
        Path(where),
        tiles,
        {**made, "compression": str(compression)},
        lambda start: define(start, table, history=history, compression=compression),
        resume=resume,
    )
