"""A Zarr group that grows shard by shard, in a folder or on an object store.

Each tile of an array is one shard, which is written at once and appears whole, so that tiles may be
written in any order and by anybody. The group cannot be opened before it is complete: its own
document is written last.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from core.dataset.files import partial, settle, sync
from core.dataset.layout import CHUNK_CELLS, Field, Tile, Tiles, chunk_shape
from core.dataset.table import Table
from core.dataset.zarr_metadata import array_document, group_document
from core.errors import VibrafeedError

if TYPE_CHECKING:
    import zarr
    from obstore.store import ObjectStore

GROUP = "zarr.json"
UNFINISHED = "unfinished.json"  # beside the arrays while some are missing: whose they are
INSTALL = "Zarr files need zarr and obstore: pip install 'vibrafeed[cluster]'"


class GrowingZarr:
    """A Zarr group under way.

    Parameters
    ----------
    where : str
        A path, or the URL of an object store such as ``s3://bucket/key``, whose keys and address
        come from the environment as for its other clients.
    tiles : Tiles
        Of all arrays.
    table : Table
        Coordinates, attributes, and arrays whose values do not count unless they are scalars.
    identity : mapping of str to str
        What must be equal for a run to go on with what another has begun.
    resume : bool
        Go on with what is there, if it has this identity; otherwise it is begun anew.
    history : str, optional
        The CF history attribute; brings the price along.

    Attributes
    ----------
    tiles : Tiles
        Of all arrays.
    done : int
        Number of the tiles that are written.
    seconds : float
        Zero: nobody knows what they cost.

    Raises
    ------
    VibrafeedError
        If zarr or obstore is not installed.
    FileExistsError
        If there is something else, or a whole result.
    """

    def __init__(
        self,
        where: str,
        tiles: Tiles,
        table: Table,
        identity: Mapping[str, str],
        *,
        resume: bool = False,
        history: str | None = None,
    ):
        self.tiles, self._table, self._history = tiles, table, history
        self._path = None if "://" in where else Path(where)
        self._folder = None if self._path is None else partial(self._path)
        self._store = _store(where, self._folder)
        self._widths = {name: one.values.dtype.itemsize for name, one in table.variables.items()}
        self.done, self.seconds = 0, 0.0
        there = self._listed()
        if self._path.exists() if self._path is not None else GROUP in there:
            raise FileExistsError(f"{where} is there already")
        if UNFINISHED not in there and there:
            raise FileExistsError(f"{where} holds something else")
        self._documents = self._described()
        is_same = UNFINISHED in there and self._get(UNFINISHED) == _as_json(identity)
        if not (resume and is_same):
            for key in there:
                self._store.delete(key)
            there = {}
            self._put(UNFINISHED, _as_json(identity))
            for name, document in self._documents.items():
                self._put(f"{name}/{GROUP}", _as_json(document))
        self._missing = [k for k, tile in enumerate(tiles) if not self._is_there(tile, there)]
        self.done = self._begun = len(tiles) - len(self._missing)
        self._arrays = {name: self._opened(name) for name in self._documents}

    @property
    def missing(self) -> Iterator[int]:
        """The tiles that are not written."""
        return iter(self._missing)

    def write(self, index: int, arrays: Mapping[str, NDArray[Any]], seconds: float) -> None:
        """Write a tile; whoever writes it, it has the same bytes."""
        tile = self.tiles[index]
        place = tuple(slice(*ends) for ends in tile.box)
        for name, values in arrays.items():
            self._arrays[name][place] = values
            if self._folder is not None:
                sync(self._folder / _shard(name, tile))
        self.done += 1

    def finish(self, price: Mapping[str, float]) -> None:
        """Write what is no tile, and let the group appear; `price` is left out after a resume."""
        table = self._table
        for name, one in {**table.coordinates, **table.variables}.items():
            if name in table.coordinates or not one.dims:
                self._arrays[name][...] = one.values
        attributes = dict(table.attributes)
        if self._history is not None:
            attributes |= {"history": self._history, **({} if self._begun else price)}
        group = group_document(replace(table, attributes=attributes), self._documents)
        self._put(GROUP, _as_json(group))
        if self._path is not None and self._folder is not None:
            settle(self._folder, self._path)
            (self._path / UNFINISHED).unlink()
        else:
            self._store.delete(UNFINISHED)

    def close(self) -> None:
        """Leave things so that another run can go on."""

    def _described(self) -> dict[str, dict[str, Any]]:
        """Return the documents of all arrays."""
        table = self._table
        fields: dict[str, Field] = {n: f for f in self.tiles.fields for n in f.names}
        documents = {}
        for name, one in {**table.coordinates, **table.variables}.items():
            if name in fields:
                cut = fields[name].layout
                documents[name] = array_document(table, name, cut.shape, cut.chunk, cut.tile)
            else:
                shape = one.values.shape
                documents[name] = array_document(
                    table, name, shape, chunk_shape(shape, CHUNK_CELLS)
                )
        return documents

    def _opened(self, name: str) -> zarr.Array[Any]:
        import zarr
        from zarr.storage import ObjectStore

        array = zarr.open_array(ObjectStore(self._store), path=name, mode="r+")
        # A shard of nothing but the fill value is a shard too: one that is missing is not computed.
        return array.with_config({"write_empty_chunks": True})

    def _is_there(self, tile: Tile, there: Mapping[str, int]) -> bool:
        """Return whether all shards of a tile are whole."""
        layout = tile.field.layout
        chunks = math.prod(t // c for t, c in zip(layout.tile, layout.chunk, strict=True))
        for name in tile.field.names:
            key = _shard(name, tile)
            if key not in there or not self._is_whole(key, there[key], chunks):
                return False
        return True

    def _is_whole(self, key: str, size: int, chunks: int) -> bool:
        """Return whether the index at the end of a shard is sound and tells of all its bytes."""
        from google_crc32c import value as crc32c  # zarr's own

        index = 16 * chunks
        if size < index + 4:
            return False
        tail = bytes(self._store.get_range(key, start=size - index - 4, end=size))
        if crc32c(tail[:index]) != int.from_bytes(tail[index:], "little"):
            return False
        places = np.frombuffer(tail[:index], "<u8").reshape(-1, 2)
        held = places[places[:, 0] != np.iinfo(np.uint64).max]
        return bool(held[:, 1].sum() == size - index - 4)

    def _listed(self) -> dict[str, int]:
        """Return the size of everything that is there, by key."""
        return {one["path"]: one["size"] for batch in self._store.list() for one in batch}

    def _get(self, key: str) -> bytes:
        return bytes(self._store.get(key).bytes())

    def _put(self, key: str, data: bytes) -> None:
        self._store.put(key, data)
        if self._folder is not None:
            sync(self._folder / key)


def _store(where: str, folder: Path | None) -> ObjectStore:
    try:
        import zarr.storage  # noqa: F401
        from obstore.store import LocalStore, from_url
    except ImportError:
        raise VibrafeedError(INSTALL) from None
    if folder is not None:
        return LocalStore(folder, mkdir=True)
    return from_url(where)


def _shard(name: str, tile: Tile) -> str:
    """Return the key of the shard that holds a tile of an array."""
    at = (start // n for (start, _), n in zip(tile.box, tile.field.layout.tile, strict=True))
    return "/".join([name, "c", *map(str, at)])


def _as_json(document: Mapping[str, Any]) -> bytes:
    return json.dumps(document, allow_nan=False).encode()
