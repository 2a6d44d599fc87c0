"""A Zarr group that grows shard by shard, in a folder or on an object store.

Each tile of an array is one shard, which is written at once and appears whole, so that tiles may be
written in any order and by anybody. The group cannot be opened before it is complete: its own
document is written last.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from vibrafeed.core.dataset.files import Behind, partial, settle
from vibrafeed.core.dataset.layout import Layout, StoredField, Tile, Tiles
from vibrafeed.core.dataset.packing import index_length, is_whole, pack
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.dataset.zarr_metadata import array_document, group_document
from vibrafeed.core.errors import MissingPackageError
from vibrafeed.core.system import installing, sync

if TYPE_CHECKING:
    from obstore.store import ObjectStore

GROUP = "zarr.json"
UNFINISHED = "unfinished.json"  # beside the arrays while some are missing: whose they are
GROWING = "growing.json"  # the group's document for those who read it meanwhile
STAGING = "#"  # occurs in the names of files that obstore has not written completely
UNDER_WAY = "This group is being written: what is not there yet reads as NaN, a regime as 0."


class GrowingZarr:
    """A Zarr group that is written tile by tile, in any order.

    Parameters
    ----------
    where : str
        A path, or the URL of an object store such as ``s3://bucket/key``, whose keys and address
        come from the environment as for its other clients.
    tiles : Tiles
        The tiles of all arrays.
    table : Table
        Coordinates, attributes, and arrays whose values do not count unless they are scalars.
    identity : mapping of str to str
        Values that must be equal for a run to go on with what another has begun, as the study's
        hash.
    resume : bool
        True to go on with stored tiles of this identity; otherwise the group is begun anew.
    shared : bool
        True if other processes write to the group at the same time, each its own tiles: theirs are
        neither checked nor removed.
    history : str, optional
        The CF history attribute; with it the cost of the run is written, too.

    Attributes
    ----------
    tiles : Tiles
        The tiles of all arrays.
    done : int
        Number of the tiles that are written.
    seconds : float
        Always 0: the cost of stored tiles is not recorded.
    digests : dict of str to str
        The SHA-256 of each shard that this object has written, by key, if it is shared.

    Raises
    ------
    MissingPackageError
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
        shared: bool = False,
        history: str | None = None,
    ):
        """Begin a Zarr group, or continue an unfinished one of the same study."""
        self.tiles, self._table, self._history = tiles, table, history
        self._path = None if "://" in where else Path(where)
        self._folder = None if self._path is None else partial(self._path)
        self._store = open_store(where if self._folder is None else self._folder)
        self.done, self.seconds = 0, 0.0
        self.digests: dict[str, str] = {}
        self._shared = shared
        self._behind = Behind()
        with plain_errors():
            self._begin(where, identity, resume=resume)

    def _begin(self, where: str, identity: Mapping[str, str], *, resume: bool) -> None:
        """Begin the group, or continue an unfinished one of the same identity.

        The tiles that have to be written are listed then; all count as done that are stored
        completely. In a shared group none is listed: each process knows its own.

        Parameters
        ----------
        where : str
            The path or URL, for messages.
        identity : mapping of str to str
            Values such as the study's hash, which an unfinished group has to share to be continued.
        resume : bool
            Whether stored tiles are kept; else they are removed.

        Raises
        ------
        FileExistsError
            If another result or other files exist there.
        """
        there = self._listed()
        self._documents = self._described()
        is_same = UNFINISHED in there and self._get(UNFINISHED) == _as_json(identity)
        self._check_free(where, there, is_same)
        if not ((resume or self._shared) and is_same):
            for key in there.keys() - {UNFINISHED}:  # which says that they are ours
                self._store.delete(key)
            there = {}
            self._put(UNFINISHED, _as_json(identity))
        for name, document in self._documents.items():
            self._put(f"{name}/{GROUP}", _as_json(document))
        tiles = () if self._shared else self.tiles
        self._missing = [k for k, tile in enumerate(tiles) if not self._is_there(tile, there)]
        self.done = self._begun = len(tiles) - len(self._missing)

    def _check_free(self, where: str, there: Collection[str], is_same: bool) -> None:
        """Raise `FileExistsError` if a result or foreign files exist at the place of a Zarr group.

        Parameters
        ----------
        where : str
            The path or URL of the group, for the message.
        there : collection of str
            Keys (paths) of the objects that are stored there.
        is_same : bool
            True if they belong to an unfinished group of the same study, which may be continued.
        """
        if self._path.exists() if self._path is not None else GROUP in there:
            raise FileExistsError(f"{where} exists already")
        if UNFINISHED not in there and there:
            raise FileExistsError(f"{where} holds other files")
        if self._shared and UNFINISHED in there and not is_same:
            raise FileExistsError(
                f"{where} holds the beginning of a result of another study or version"
            )

    @property
    def missing(self) -> Iterator[int]:
        """The indices of the tiles that are not written."""
        return iter(self._missing)

    def show(self) -> None:
        """Write everything but the tiles, so that readers may open the group while it grows.

        Missing tiles read as NaN, a regime as 0. The document of the group is named `growing.json`,
        unlike that of a complete group.
        """
        with plain_errors():
            self._write_untiled()
            said = self._table.attributes.get("comment", "")
            attributes = {**self._table.attributes, "comment": f"{UNDER_WAY} {said}".rstrip()}
            group = group_document(replace(self._table, attributes=attributes), self._documents)
            self._put(GROWING, _as_json(group))

    def write(self, index: int, arrays: Mapping[str, NDArray[Any]], seconds: float) -> None:
        """Write a tile, one shard (file) for each array; equal studies write equal bytes.

        Parameters
        ----------
        index : int
            Number of the tile among all.
        arrays : mapping of str to ndarray
            The values of each array in the tile.
        seconds : float
            Not used: the cost of stored tiles is not recorded.
        """
        tile = self.tiles[index]
        for name in tile.field.names:
            key = _shard(tile)
            data = pack(self._documents[name], tile, arrays[name], key)
            key = f"{name}/{key}"
            if self._shared:
                self.digests[key] = hashlib.sha256(data).hexdigest()
            self._put(key, data)
        self.done += 1

    def digest(self, key: str) -> str:
        """Return the SHA-256 of a stored shard in hexadecimal; empty if there is none.

        `key` is its path in the group, such as `throw_number/c/0/1`.
        """
        try:
            return hashlib.sha256(self._get(key)).hexdigest()
        except FileNotFoundError:
            return ""

    def finish(self, price: Mapping[str, float]) -> None:
        """Write the rest and make the group visible; `price` is left out after a resume."""
        with plain_errors():
            self._finish(price)

    def _finish(self, price: Mapping[str, float]) -> None:
        """Write coordinates and the group's document, which make the group a complete result.

        The mark of unfinished groups is removed, and a folder gets its final name. `price` has
        numeric attributes with the cost of the run, which are left out if another run has written
        some tiles.
        """
        self._write_untiled()
        attributes = dict(self._table.attributes)
        if self._history is not None:
            attributes |= {"history": self._history, **({} if self._begun else price)}
        group = group_document(replace(self._table, attributes=attributes), self._documents)
        self._put(GROUP, _as_json(group))
        self._behind.end()
        if self._path is not None and self._folder is not None:
            for left in self._folder.rglob(f"*{STAGING}*"):
                left.unlink()
            settle(self._folder, self._path)
            (self._path / UNFINISHED).unlink()
            (self._path / GROWING).unlink(missing_ok=True)
        else:
            self._store.delete(UNFINISHED)
            if GROWING in self._listed():
                self._store.delete(GROWING)

    def _write_untiled(self) -> None:
        """Write the arrays of a group that are not computed in tiles: coordinates, texts, scalars.

        Their metadata have been written before. They are known before the first tile.
        """
        import zarr

        table = self._table
        tiled = {name for field in self.tiles.fields for name in field.names}
        for name, one in {**table.coordinates, **table.variables}.items():
            if name not in tiled:
                array = zarr.open_array(zarr.storage.ObjectStore(self._store), path=name, mode="r+")
                array.with_config({"write_empty_chunks": True})[...] = one.values

    def flush(self) -> None:
        """Wait until everything written is on disk."""
        self._behind.end()

    def close(self) -> None:
        """Close the store so that another run can continue."""
        self._behind.close()

    def _described(self) -> dict[str, dict[str, Any]]:
        """Return the metadata document (`zarr.json`) of each coordinate and variable, by name.

        Arrays with tiles get shards, all others plain chunks.
        """
        table = self._table
        fields: dict[str, StoredField] = {n: f for f in self.tiles.fields for n in f.names}
        documents = {}
        for name, variable in {**table.coordinates, **table.variables}.items():
            if name in fields:
                cut = fields[name].layout
                documents[name] = array_document(table, name, cut.shape, cut.chunk, cut.tile)
            else:
                shape = variable.values.shape
                documents[name] = array_document(table, name, shape, Layout.of(shape).chunk)
        return documents

    def _is_there(self, tile: Tile, there: Mapping[str, int]) -> bool:
        """True if the shards of a tile are stored completely, so that it need not be computed.

        A shard is the file of a tile for one array. Its index at its end is read and checked
        against its size; the data are not read.

        Parameters
        ----------
        tile : Tile
            The tile: a block of cells of arrays with the same dimensions.
        there : mapping of str to int
            Size of each stored object [bytes], by key (its path in the group).
        """
        length = index_length(tile.field.layout)
        for name in tile.field.names:
            key = f"{name}/{_shard(tile)}"
            size = there.get(key, 0)
            if size < length:
                return False
            index = self._store.get_range(key, start=size - length, end=size)
            if not is_whole(bytes(index), size):
                return False
        return True

    def _listed(self) -> dict[str, int]:
        """Return the size of every stored object, by key."""
        return {one["path"]: one["size"] for batch in self._store.list() for one in batch}

    def _get(self, key: str) -> bytes:
        """Return the bytes of a stored object."""
        return bytes(self._store.get(key).bytes())

    def _put(self, key: str, data: bytes) -> None:
        """Store bytes as a file of the Zarr group, in the folder or the object store.

        `key` is the path in the group; `data` are the bytes. On a disk, a thread then waits until
        they are written, without delaying the caller. Errors of the store are raised as `OSError`.
        """
        with plain_errors():
            self._store.put(key, data)
        if self._folder is not None:
            self._behind.start(sync, self._folder / key)


def attributes_at(where: str) -> dict[str, Any]:
    """Return the global attributes of a complete Zarr group; empty if there is none.

    `where` is a path or the URL of an object store. Raises `OSError` if it cannot be read.
    """
    if "://" not in where:
        path = Path(where) / GROUP
        return dict(json.loads(path.read_bytes())["attributes"]) if path.exists() else {}
    store = open_store(where)
    with contextlib.suppress(FileNotFoundError), plain_errors():
        return dict(json.loads(bytes(store.get(GROUP).bytes()))["attributes"])
    return {}


@contextlib.contextmanager
def plain_errors() -> Iterator[None]:
    """Turn errors of object stores that are raised in the block into `OSError`.

    Callers then treat a failing store as they treat a failing disk.
    """
    from obstore.exceptions import BaseError

    try:
        yield
    except BaseError as error:
        raise OSError(str(error).strip().splitlines()[0]) from error


def open_store(where: str | Path) -> ObjectStore:
    """Return the object store for a URL, or for a folder (a `Path`), which is created.

    Raises `MissingPackageError` if zarr or obstore is not installed, and `OSError` for a wrong URL.
    """
    needed_for_zarr()
    from obstore.store import LocalStore, from_url

    if isinstance(where, Path):
        return LocalStore(where, mkdir=True)
    with plain_errors():
        return from_url(where)


def needed_for_zarr() -> None:
    """Raise `MissingPackageError` if zarr or obstore is not installed."""
    for package, extra in (("zarr", None), ("obstore", "cluster")):
        if find_spec(package) is None:
            raise MissingPackageError("Zarr", package, installing(package, extra))


def _shard(tile: Tile) -> str:
    """Return the key of a tile's shard within its array, such as `c/0/1`."""
    at = (start // n for (start, _), n in zip(tile.box, tile.field.layout.tile, strict=True))
    return "/".join(["c", *map(str, at)])


def _as_json(document: Mapping[str, Any]) -> bytes:
    """Return a document as JSON bytes."""
    return json.dumps(document, allow_nan=False).encode()
