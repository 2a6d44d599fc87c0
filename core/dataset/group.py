"""A whole table as a Zarr group."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from vibrafeed.core.dataset.files import Storage, partial, settle
from vibrafeed.core.dataset.stores import (
    document_of,
    keys_in,
    open_group,
    plain_errors,
    put_document,
    remove_all,
)
from vibrafeed.core.dataset.table import Table

if TYPE_CHECKING:
    import zarr


def write_zarr(table: Table, where: str, storage: Storage) -> None:
    """Write a table as a Zarr group, in a folder or at a URL; it can be opened once complete.

    Parameters
    ----------
    table : Table
        The result to write.
    where : str
        A path, or the URL of an object store.
    storage : Storage
        The version of the format counts.

    Raises
    ------
    FileExistsError
        If there is a group or another file already.
    OSError
        If it cannot be written.
    """
    under_way = where if "://" in where else str(partial(Path(where)))
    if keys_in(where):
        raise FileExistsError(f"{where} exists already")
    try:
        with plain_errors():
            remove_all(under_way)
            group = open_group(under_way, create=True, version=storage.zarr_version)
            if storage.zarr_version == 2:
                _write_version_2(table, group)
            else:
                _write_version_3(table, group, under_way)
        if "://" not in where:
            settle(Path(under_way), Path(where))
    except BaseException:
        remove_all(under_way)  # an incomplete group is of no use
        raise


def _write_version_2(table: Table, group: "zarr.Group") -> None:
    encoding: dict[str, Any] = {
        name: {"_FillValue": None}
        for name, variable in table.variables.items()
        if variable.values.dtype.kind != "O"
    }
    table.to_xarray().to_zarr(
        group.store, mode="a", zarr_format=2, consolidated=True, encoding=encoding
    )


def _write_version_3(table: Table, group: "zarr.Group", where: str) -> None:
    create_arrays(group, table)
    variables = {**table.coordinates, **table.variables}
    for name, variable in variables.items():
        put(group, name, ..., variable.values)
    put_document(where, document_of(group, variables))


def create_arrays(
    group: "zarr.Group",
    table: Table,
    *,
    sizes: Mapping[str, int] = MappingProxyType({}),
    chunks: Mapping[str, tuple[int, ...]] = MappingProxyType({}),
    compressed: bool = True,
) -> None:
    """Create the arrays of a table in a group, with the attributes of the whole, without values.

    Parameters
    ----------
    group : zarr.Group
        The group.
    table : Table
        The table.
    sizes : mapping of str to int, optional
        The length of each dimension, if not that of the values.
    chunks : mapping of str to tuple of int, optional
        The chunk lengths of arrays; one chunk by default.
    compressed : bool
        Whether chunks are packed.
    """
    from zarr.codecs import BloscCodec

    # lz4 is the fastest that every reader of version 3 has; a shuffle helps floats.
    packed = [BloscCodec(cname="lz4", clevel=5)] if compressed else None
    for name, variable in {**table.coordinates, **table.variables}.items():
        shape = tuple(
            sizes.get(dim, size)
            for dim, size in zip(variable.dims, variable.values.shape, strict=True)
        )
        is_text = variable.values.dtype == object
        # Readers of version 3 take a fill value for no mask: only an attribute would be one.
        fill = "" if is_text else np.nan if variable.values.dtype.kind == "f" else 0
        group.create_array(
            name,
            shape=shape,
            dtype=str if is_text else variable.values.dtype,
            chunks=chunks.get(name) or tuple(max(1, size) for size in shape),
            compressors=packed if variable.dims and not is_text else None,
            fill_value=fill,
            dimension_names=variable.dims,
            attributes={
                **_plain(variable.attributes),
                **(table.links(name) if name in table.variables else {}),
            },
        )
    group.attrs.update(_plain(table.attributes))


def put(
    group: "zarr.Group | Mapping[str, Any]", name: str, region: Any, values: np.ndarray[Any, Any]
) -> None:
    """Write values into an array of a group; also chunks of nothing but the fill value are kept."""
    array: Any = group[name]
    array.with_config({"write_empty_chunks": True})[region] = values


def _plain(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Return attributes as values that JSON holds: arrays as lists, all but numbers as texts."""
    return {
        name: value.tolist()
        if isinstance(value, np.ndarray)
        else value
        if isinstance(value, int | float)
        else str(value)
        for name, value in attributes.items()
    }
