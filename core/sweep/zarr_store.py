"""The view of a sweep as a store that the zarr library reads; importing it loads that library."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Iterable
from typing import NoReturn

from zarr.abc.store import (
    ByteRequest,
    OffsetByteRequest,
    RangeByteRequest,
    Store,
    SuffixByteRequest,
)
from zarr.core.buffer import Buffer, BufferPrototype, default_buffer_prototype

from vibrafeed.core.sweep.zarr_view import ZarrView


class ViewStore(Store):
    """A read-only store whose chunks are computed by threads, as many as zarr asks for."""

    supports_writes = False
    supports_deletes = False
    supports_listing = False  # there may be more keys than anyone can list

    def __init__(self, view: ZarrView):
        """Show a view as a read-only store."""
        super().__init__(read_only=True)
        self._view = view

    def with_read_only(self, read_only: bool = True) -> ViewStore:
        """Return a store of the same view, which is always read-only."""
        return ViewStore(self._view) if read_only else _refuse()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ViewStore) and other._view is self._view

    async def get(
        self,
        key: str,
        prototype: BufferPrototype | None = None,
        byte_range: ByteRequest | None = None,
    ) -> Buffer | None:
        """Return the bytes of a key, or a range of them; None if there is no such key.

        It is part of zarr's interface of a store; the bytes are computed in a thread.
        """
        try:
            content = await asyncio.to_thread(self._view.read, key)
        except KeyError:
            return None
        part = content[_part(byte_range)]
        return (prototype or default_buffer_prototype()).buffer.from_bytes(part)

    async def get_partial_values(
        self,
        prototype: BufferPrototype,
        key_ranges: Iterable[tuple[str, ByteRequest | None]],
    ) -> list[Buffer | None]:
        """Return ranges of several keys, in order."""
        return [await self.get(key, prototype, part) for key, part in key_ranges]

    async def exists(self, key: str) -> bool:
        """True if the Zarr group has a key; part of zarr's interface of a store."""
        try:
            self._view.length(key)
        except KeyError:
            return False
        return True

    async def set(self, key: str, value: Buffer) -> None:
        """Raise: the view is read-only."""
        _refuse()

    async def delete(self, key: str) -> None:
        """Raise: the view is read-only."""
        _refuse()

    def list(self) -> AsyncIterator[str]:
        """Raise: keys cannot be listed."""
        raise NotImplementedError

    def list_prefix(self, prefix: str) -> AsyncIterator[str]:
        """Raise: keys cannot be listed."""
        raise NotImplementedError

    def list_dir(self, prefix: str) -> AsyncIterator[str]:
        """Raise: keys cannot be listed."""
        raise NotImplementedError


def _part(wanted: ByteRequest | None) -> slice:
    """Return the slice of the bytes of a key that zarr's request for a range of bytes means.

    Without a request it is all of them.
    """
    if isinstance(wanted, RangeByteRequest):
        return slice(wanted.start, wanted.end)
    if isinstance(wanted, OffsetByteRequest):
        return slice(wanted.offset, None)
    if isinstance(wanted, SuffixByteRequest) and wanted.suffix:
        return slice(-wanted.suffix, None)
    return slice(0) if wanted else slice(None)


def _refuse() -> NoReturn:
    """Raise the error of a read-only view."""
    raise ValueError("the Zarr group of a computed sweep is read-only")
