"""Chunks of a NetCDF file, written past the libraries: encoded by threads, each written once.

HDF5 decides where a chunk goes and keeps the index of them; what it is given for a file sends each
byte straight to its place on the disk. Where it puts things follows from the lengths of the chunks
alone, so that a run that was stopped goes on by telling it these lengths again: the file is, to the
byte, that of a run that was not.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from io import FileIO
from itertools import repeat
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from deflate import crc32, zlib_compress  # crc32: ten times as fast as zlib's
from numpy.typing import NDArray

from vibrafeed.core.dataset.layout import Box, Tile

if TYPE_CHECKING:
    import h5py

Encode = Callable[[NDArray[Any], Box, NDArray[Any]], Any]
"""Returns the bytes of a chunk: from its tile's array, its box there, and a buffer to fill."""

LEVEL: Final = 1
"""Level of compression by libdeflate, whose bytes follow from its input alone. ISA-L is three times
as fast, but one chunk of some 10,000 came out different in another thread."""
DEFLATED: Final = [2, 1]  # the numbers of the filters of HDF5, shuffle first


class ChunkFile:
    """A NetCDF file whose arrays are defined and empty, open to take their chunks.

    One thread uses it at a time. The file cannot be read before `close` has finished it.

    Parameters
    ----------
    path : Path
        The file.
    threads : int, optional
        Number of threads that encode chunks; by default one per core. The bytes do not depend on
        it.
    """

    def __init__(self, path: Path, threads: int | None = None):
        """Open a defined NetCDF file for writing chunks, encoded in several threads."""
        import h5py  # a process that writes no large file does not load it

        self._disk = _Disk(path)
        self._file: h5py.File = h5py.File(self._disk, "r+")
        self._pool = ThreadPoolExecutor(threads or os.cpu_count(), thread_name_prefix="chunks")
        self._encoders: dict[str, Encode] = {}
        self._buffers: dict[str, NDArray[Any]] = {}

    def write(self, tile: Tile, arrays: Mapping[str, NDArray[Any]]) -> tuple[list[int], int]:
        """Write the arrays of a tile; return the lengths of its chunks [bytes] and a checksum.

        Parameters
        ----------
        tile : Tile
            The block of cells, made of whole chunks.
        arrays : mapping of str to ndarray
            The tile's values by name, in the shape of the tile.

        Returns
        -------
        lengths : list of int
            Bytes of each encoded chunk, in the order of the file.
        checksum : int
            CRC-32 of all these bytes.
        """
        lengths, checksum = [], 0
        for name, chunks in self._encoded(tile, arrays).items():
            target = self._file[name].id
            for chunk, data in chunks:
                target.write_direct_chunk(tuple(start for start, _ in chunk), data)
                lengths.append(len(data))
                checksum = crc32(data, checksum)
        self._disk.check()
        return lengths, checksum

    def pass_over(self, tile: Tile, lengths: Sequence[int]) -> int:
        """Register a tile that is on disk already, so that a run can go on; return its CRC-32.

        HDF5 is given stand-ins of the same lengths, so that it places the chunks as before, and
        what it would write is read from the disk instead. The checksum is compared with that at
        writing.

        Parameters
        ----------
        tile : Tile
            The block of cells.
        lengths : sequence of int
            Bytes of each of its chunks, in the order of the file.
        """
        self._disk.passing = np.zeros(max(lengths), dtype=np.uint8)
        left = iter(lengths)
        for name in tile.field.names:
            target = self._file[name].id
            for chunk in tile.field.layout.chunks(tile.box):
                nothing = self._disk.passing[: next(left)]
                target.write_direct_chunk(tuple(start for start, _ in chunk), nothing)
        self._disk.passing = None
        checksum, self._disk.checksum = self._disk.checksum, 0
        return checksum

    def sync(self) -> None:
        """Wait until all chunks are on the disk."""
        os.fsync(self._disk.file.fileno())

    def close(self, attributes: Mapping[str, float] | None = None) -> None:
        """Finish the file and close it, so that it can be read.

        `attributes` are new values of numeric global attributes, such as the cost of the run; those
        that the file does not have are left out. Raises `OSError` if an earlier write failed.
        """
        import h5py

        for name, value in (attributes or {}).items():
            if h5py.h5a.exists(self._file.id, name.encode()):
                h5py.h5a.open(self._file.id, name.encode()).write(np.array([value]))
        self._file.close()
        self._disk.check()
        self.leave()

    def leave(self) -> None:
        """Close the file without finishing it: what HDF5 still keeps in memory is not written.

        Stored chunks stay, so that a later run can go on.
        """
        self._disk.is_open = False  # HDF5 writes what it keeps, to nowhere
        self._file.close()
        self._pool.shutdown(cancel_futures=True)
        self._disk.file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.leave()

    def _encoded(
        self, tile: Tile, arrays: Mapping[str, NDArray[Any]]
    ) -> dict[str, Iterator[tuple[Box, Any]]]:
        """Return the encoded chunks of all arrays of a tile, each with its box, by name.

        They are in the order of the file, and threads encode them while they are taken. `arrays`
        are the tile's values by name.
        """
        layout = tile.field.layout
        chunks = list(layout.chunks(tile.box))
        encoded: dict[str, Iterator[tuple[Box, Any]]] = {}
        for name in tile.field.names:
            encode, values = self._encoder(name), arrays[name]
            boxes = [slice_in_tile(chunk, tile.box) for chunk in chunks]
            room = self._buffer(name, (len(chunks), *layout.chunk), values.dtype)
            data = self._pool.map(encode, repeat(values), boxes, room)
            encoded[name] = zip(chunks, data, strict=True)
        return encoded

    def _buffer(self, name: str, shape: tuple[int, ...], dtype: np.dtype[Any]) -> NDArray[Any]:
        """Return a buffer for the chunks of a tile, which is reused, since new memory is slow.

        Its contents are overwritten by the next tile. The buffer belongs to the array `name`; the
        first entry of `shape` is the number of chunks.
        """
        if name not in self._buffers or len(self._buffers[name]) < shape[0]:
            self._buffers[name] = np.empty(shape, dtype)
        return self._buffers[name][: shape[0]]

    def _encoder(self, name: str) -> Encode:
        """Return the function that encodes chunks of an array for the file.

        It applies the filters (compression, shuffle) with which the array was created; functions
        are cached by `name`, that of the array.
        """
        if name not in self._encoders:
            settings = self._file[name].id.get_create_plist()
            filters = [settings.get_filter(k)[0] for k in range(settings.get_nfilters())]
            self._encoders[name] = encoder(filters)
        return self._encoders[name]


def encoder(filters: Sequence[int]) -> Encode:
    """Return the function that encodes a chunk of an array into bytes, as its HDF5 filters would.

    `filters` are the numbers of the filters: none, deflate (1), or shuffle and deflate (2, 1);
    others raise `NotImplementedError`. The function takes a tile's array, the box of the chunk in
    it, and a buffer of the chunk's shape to work in.
    """
    if not filters:
        return lambda values, box, buffer: chunk_of(values, box, buffer).data.cast("B")
    if filters not in (DEFLATED, DEFLATED[1:]):
        raise NotImplementedError(f"HDF5 filters {filters}")

    def deflated(values: NDArray[Any], box: Box, buffer: NDArray[Any]) -> Any:
        """Return the bytes of a chunk, shuffled and compressed.

        Shuffled means that the first bytes of all values come first, then the second ones, and so
        on.
        """
        chunk = chunk_of(values, box, buffer)
        if chunk.itemsize > 1:  # shuffled: the first bytes of all values, the second ones ...
            octets = chunk.reshape(-1).view(np.uint8).reshape(-1, chunk.itemsize)
            chunk = np.ascontiguousarray(octets.T)
        return zlib_compress(chunk, LEVEL)

    return deflated


def chunk_of(values: NDArray[Any], box: Box, buffer: NDArray[Any]) -> NDArray[Any]:
    """Fill `buffer`, of the shape of a chunk, with one chunk of a tile, and return it.

    `values` is the array of the tile, and `box` start and stop of the chunk along each axis of it.
    Cells of the chunk beyond the end of an axis are 0.
    """
    part = values[tuple(slice(*ends) for ends in box)]
    if part.shape == buffer.shape:
        buffer[...] = part
    else:
        buffer[...] = 0
        buffer[tuple(map(slice, part.shape))] = part
    return buffer


def slice_in_tile(chunk: Box, tile: Box) -> Box:
    """Return the box of a chunk within the array of its tile; both boxes are of the whole array."""
    return tuple((a - start, b - start) for (a, b), (start, _) in zip(chunk, tile, strict=True))


class _Disk:
    """A file on disk in the form that HDF5 writes to.

    Attributes
    ----------
    passing : ndarray or None
        Stands for a chunk that is on disk already: writing it only reads the disk into `checksum`.
    """

    def __init__(self, path: Path):
        """Open a file for reading and writing at chosen positions."""
        self.file = FileIO(path, "r+")
        self.is_open = True
        self.passing: NDArray[np.uint8] | None = None
        self.checksum = 0
        self._trouble: OSError | None = None

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Set the position in the file and return it; `whence` is as for Python's files."""
        return self.file.seek(offset, whence)

    def tell(self) -> int:
        """Return the position in the file."""
        return self.file.tell()

    def read(self, length: int) -> bytes:
        """Return bytes at the position."""
        return self.file.read(length)

    def readinto(self, buffer: memoryview) -> int:
        """Read bytes at the position into a buffer; return their number."""
        return self.file.readinto(buffer)

    def write(self, data: memoryview) -> int:
        """Write bytes at the position, for HDF5; return their number.

        Bytes that stand for a chunk that is on disk already are not written: the disk is read
        instead, into `checksum`. An error is kept until `check` raises it, since HDF5 would replace
        it. Once the file is left (`is_open` false) nothing is written.
        """
        length = len(data)
        if not self.is_open:
            return length
        if self._is_passed(data):
            self.checksum = crc32(self.file.read(length), self.checksum)
            return length
        try:
            while data:
                data = data[self.file.write(data) :]
        except OSError as error:
            self._trouble = self._trouble or error
        return length

    def check(self) -> None:
        """Raise the error of an earlier write, which HDF5 would have replaced."""
        if self._trouble is not None:
            raise self._trouble

    def _is_passed(self, data: memoryview) -> bool:
        """True if these bytes are the array `passing`, which stands for a chunk on the disk."""
        if self.passing is None:
            return False
        return np.frombuffer(data, np.uint8).ctypes.data == self.passing.ctypes.data

    def truncate(self, size: int) -> None:
        """Cut the file to a size."""
        if self.is_open:
            self.file.truncate(size)

    def flush(self) -> None:
        """Do nothing: written data is already with the system."""
