"""Records of the shares of a result, beside it: each appears whole, behind its digest."""

from __future__ import annotations

import hashlib
import io
import json
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.files import whole

if TYPE_CHECKING:
    from obstore.store import ObjectStore

ENDING = ".shares"  # ends the name of the folder of a result's records
_DIGEST = hashlib.sha256().digest_size
_FIELDS = "told"


@dataclass(frozen=True)
class Record:
    """The record that a share leaves: plain values, and arrays.

    Attributes
    ----------
    fields : mapping
        Plain values.
    arrays : mapping of str to ndarray
        What it has computed, where that is not stored elsewhere.
    """

    fields: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)

    def pack(self) -> bytes:
        """Return the record as bytes, preceded by their SHA-256, which shows damage at reading.

        Equal records give equal bytes, whichever machine makes them.
        """
        content = io.BytesIO()
        packed = np.frombuffer(json.dumps(dict(self.fields), sort_keys=True).encode(), np.uint8)
        np.savez(content, allow_pickle=False, **{_FIELDS: packed}, **self.arrays)
        return hashlib.sha256(content.getbuffer()).digest() + content.getvalue()

    @classmethod
    def unpack(cls, data: bytes) -> Record | None:
        """Return the record in `data`, the bytes that `pack` made; None if they are damaged."""
        content = memoryview(data)[_DIGEST:]
        if hashlib.sha256(content).digest() != data[:_DIGEST]:
            return None
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            arrays = dict(file)
        return cls(json.loads(arrays.pop(_FIELDS).tobytes()), arrays)


class Records:
    """The records of the shares of a result, in a folder or a place on an object store.

    Parameters
    ----------
    where : str
        The path or URL of the result; records are beside it, under its name and ``.shares``.
    """

    def __init__(self, where: str):
        """Use the folder or object store of the records beside a result."""
        self.where = where.rstrip("/") + ENDING
        self._store: ObjectStore | None = None
        self._folder = Path(self.where)
        if "://" in where:
            from obstore.store import from_url

            self._store = from_url(self.where)

    def names(self) -> list[str]:
        """Return the names of all stored records, sorted; none where nothing has been stored."""
        if self._store is not None:
            return sorted(one["path"] for batch in self._store.list() for one in batch)
        if not self._folder.is_dir():
            return []
        return sorted(one.name for one in self._folder.iterdir() if not one.name.startswith("."))

    def read(self, name: str) -> Record | None:
        """Return the record that was stored under a name, from the folder or object store.

        It is None if there is none under this `name`, or if its checksum shows damage.
        """
        try:
            if self._store is not None:
                data = bytes(self._store.get(name).bytes())
            else:
                data = (self._folder / name).read_bytes()
        except FileNotFoundError:
            return None
        return Record.unpack(data)

    def write(self, name: str, data: bytes) -> None:
        """Store the bytes of a record under a name; they appear completely or not at all.

        A record of the same name is replaced. The place is a folder or an object store.
        """
        if self._store is not None:
            self._store.put(name, data)
            return
        self._folder.mkdir(parents=True, exist_ok=True)
        with whole(self._folder / name) as temporary:
            temporary.write_bytes(data)

    def remove(self, name: str) -> None:
        """Remove the record of a name, in the folder or on the object store, if it exists."""
        if self._store is not None:
            self._store.delete(name)
        else:
            (self._folder / name).unlink(missing_ok=True)

    def clear(self) -> None:
        """Remove all records and their folder, once the complete result needs them no more."""
        if self._store is not None:
            for name in self.names():
                self._store.delete(name)
        else:
            shutil.rmtree(self._folder, ignore_errors=True)  # another process may read one
