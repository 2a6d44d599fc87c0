"""Zarr groups in folders and on object stores, as zarr-python opens them."""

import contextlib
import json
import shutil
from collections.abc import Iterable, Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from vibrafeed.core.dataset.files import ZarrVersion, whole
from vibrafeed.core.errors import MissingPackageError
from vibrafeed.core.system import installing

if TYPE_CHECKING:
    import zarr
    from obstore.store import ObjectStore

GROUP: Final = "zarr.json"
"""The document of a group."""
UNFINISHED: Final = "unfinished"
"""The attribute of a group that says whose it is while blocks are missing."""


def open_group(
    where: str, *, create: bool = False, read_only: bool = False, version: ZarrVersion = 3
) -> "zarr.Group":
    """Return the Zarr group in a folder, or at the URL of an object store.

    `version` is that of the format of a group that is created.

    Raises
    ------
    MissingPackageError
        If obstore is not installed, for a URL.
    OSError
        If it cannot be read, or the URL is wrong.
    """
    import zarr  # heavy, and few results are groups

    store: Any = where
    if "://" in where:
        store = zarr.storage.ObjectStore(open_store(where), read_only=read_only)
    if create:
        return zarr.open_group(store, mode="a", zarr_format=version)
    return zarr.open_group(store, mode="r" if read_only else "r+")


def document_of(group: "zarr.Group", names: Iterable[str]) -> bytes:
    """Return the document of a group with those of its arrays, so that one request opens it.

    `names` are its arrays in the order in which readers are to have them; zarr-python's own has an
    order that varies from run to run.
    """
    from zarr.buffer import default_buffer_prototype

    prototype = default_buffer_prototype()
    arrays = {
        name: json.loads(group[name].metadata.to_buffer_dict(prototype)[GROUP].to_bytes())
        for name in names
    }
    document = {
        "zarr_format": 3,
        "node_type": "group",
        "attributes": dict(group.attrs),
        "consolidated_metadata": {"kind": "inline", "must_understand": False, "metadata": arrays},
    }
    return json.dumps(document).encode()


def put_document(where: str, document: bytes) -> None:
    """Write the document of a group in a folder or object store."""
    if "://" in where:
        with plain_errors():
            open_store(where).put(GROUP, document)
        return
    with whole(Path(where) / GROUP) as temporary:
        temporary.write_bytes(document)


def open_store(where: str) -> "ObjectStore":
    """Return the object store at a URL.

    Raises
    ------
    MissingPackageError
        If obstore is not installed.
    OSError
        If the URL is wrong.
    """
    if find_spec("obstore") is None:
        raise MissingPackageError("Zarr", "obstore", installing("obstore", "cluster"))
    from obstore.store import from_url

    with plain_errors():
        return from_url(where)


def attributes_at(where: str) -> dict[str, Any]:
    """Return the global attributes of a complete Zarr group; empty if there is none.

    Raises
    ------
    OSError
        If it cannot be read.
    """
    try:
        with plain_errors():
            attributes = dict(open_group(where, read_only=True).attrs)
    except (FileNotFoundError, NotADirectoryError):
        return {}
    return {} if UNFINISHED in attributes else attributes


def keys_in(where: str) -> set[str]:
    """Return the keys of all files of a folder or object store."""
    if "://" not in where:
        root = Path(where)
        return {path.relative_to(root).as_posix() for path in root.rglob("*") if path.is_file()}
    with plain_errors():
        return {entry["path"] for batch in open_store(where).list() for entry in batch}


def remove_all(where: str) -> None:
    """Remove the files of a folder or object store, which may be missing."""
    if "://" not in where:
        shutil.rmtree(where, ignore_errors=True)
        return
    with plain_errors():
        store = open_store(where)
        for key in keys_in(where):
            store.delete(key)


@contextlib.contextmanager
def plain_errors() -> Iterator[None]:
    """Turn errors of object stores into `OSError`, so that they are treated as those of a disk."""
    if find_spec("obstore") is None:
        yield
        return
    from obstore.exceptions import BaseError

    try:
        yield
    except BaseError as error:
        raise OSError(str(error).strip().splitlines()[0]) from error
