"""A NetCDF file that grows tile by tile, and goes on where a run before was stopped or killed.

Beside the file that is to be, a hidden folder holds three: `start`, the file without its arrays, as
the NetCDF library made it; `data`, the same with the chunks so far; and `journal`, the lengths and
checksums of the chunks of each tile.
"""

from __future__ import annotations

import hashlib
import shutil
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from vibrafeed.core.dataset.chunks import ChunkFile
from vibrafeed.core.dataset.files import Behind, partial, settle
from vibrafeed.core.dataset.journal import Journal
from vibrafeed.core.dataset.layout import Tiles
from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.system import sync

# Written bytes, or seconds, after which a thread waits until the disk has them, while more are
# written: a kill loses no more.
SYNC_BYTES = 64 * 2**20
SYNC_SECONDS = 5.0


class GrowingNetcdf:
    """A NetCDF file that is written tile by tile, in order; it gets its name once it is complete.

    Parameters
    ----------
    path : Path
        The name of the complete file; an existing file is replaced at the end.
    tiles : Tiles
        The tiles of all arrays.
    identity : mapping of str to str
        Values that must be equal for a run to go on with what another has begun, as the study's
        hash.
    begin : callable
        Writes the file without its arrays at the path that it is called with.
    resume : bool
        True to go on with stored tiles of this identity; otherwise the file is begun anew.

    Attributes
    ----------
    tiles : Tiles
        The tiles of all arrays.
    done : int
        Number of the tiles that are written.
    seconds : float
        Computing time of the tiles that were stored at the start [s].
    """

    def __init__(
        self,
        path: Path,
        tiles: Tiles,
        identity: Mapping[str, str],
        begin: Callable[[Path], None],
        *,
        resume: bool = False,
    ):
        """Begin a NetCDF file in a hidden folder, or continue one of the same study."""
        self._path, self.tiles = path, tiles
        self._folder = partial(path)
        self._folder.mkdir(parents=True, exist_ok=True)
        self._journal = Journal(self._folder / "journal")
        self._file: ChunkFile | None = None
        self._behind = Behind()
        self.done, self.seconds = 0, 0.0
        self._waiting, self._synced = 0, time.monotonic()
        try:
            if resume and self._is_of(identity):
                self._go_on()
            else:
                self._begin(identity, begin)
        except BaseException:
            self.close()
            raise

    @property
    def missing(self) -> Iterator[int]:
        """The indices of the tiles that are not written, in order."""
        return iter(range(self.done, len(self.tiles)))

    def write(self, index: int, arrays: Mapping[str, NDArray[Any]], seconds: float) -> None:
        """Write the next tile, and the lengths and checksum of its chunks into the journal.

        With the journal, a run that goes on with this file finds the tiles that are complete. From
        time to time a thread waits until the disk has what was written.

        Parameters
        ----------
        index : int
            Number of the tile, which has to be that of the tiles written so far.
        arrays : mapping of str to ndarray
            The values of each array in the tile.
        seconds : float
            Computing time of all tiles so far [s].

        Raises
        ------
        VibrafeedError
            If it is not the next tile.
        """
        assert self._file is not None
        if index != self.done:  # it would take the place of one that failed
            raise VibrafeedError(f"tile {index:,} cannot follow {self.done:,} tiles")
        lengths, checksum = self._file.write(self.tiles[index], arrays)
        self._journal.add({"lengths": lengths, "checksum": checksum, "seconds": seconds})
        self.done += 1
        self._waiting += sum(lengths)
        if self._waiting >= SYNC_BYTES or time.monotonic() - self._synced >= SYNC_SECONDS:
            self._waiting, self._synced = 0, time.monotonic()
            self._behind.start(self._sync)

    def finish(self, price: Mapping[str, float]) -> None:
        """Complete the NetCDF file, move it to its final path, and remove the folder of pieces.

        `price` has the values of numeric global attributes that are known only now: the cost of the
        run, such as seconds.
        """
        assert self._file is not None
        self._behind.end()
        self._file.close(price)
        self._file = None
        settle(self._folder / "data", self._path)
        self._journal.close()
        shutil.rmtree(self._folder, ignore_errors=True)

    def close(self) -> None:
        """Close the unfinished file, flushed to disk, so that another run can continue it.

        After `finish` only the thread that waits for the disk is ended.
        """
        self._behind.close()
        if self._file is not None:
            self._sync()
            self._file.leave()
            self._file = None
        self._journal.close()

    def _sync(self) -> None:
        """Wait until file and journal are on disk."""
        assert self._file is not None
        self._file.sync()
        self._journal.sync()

    def _is_of(self, identity: Mapping[str, str]) -> bool:
        """True if the unfinished file was begun by the same study and its head is intact.

        `identity` (the study's hash and the like) is compared with the first record of the journal,
        which also has the SHA-256 of the file without arrays.
        """
        if not self._journal.records:
            return False
        known = dict(self._journal.records[0])
        digest = known.pop("start", None)
        start = self._folder / "start"
        return known == identity and start.exists() and _digest(start) == digest

    def _begin(self, identity: Mapping[str, str], begin: Callable[[Path], None]) -> None:
        """Start a new file of tiles: write its head and the first record of the journal.

        The journal lists the tiles that are complete, so that a stopped run can continue.

        Parameters
        ----------
        identity : mapping of str to str
            Identifier and version of the study, stored in the first record.
        begin : callable
            Writes a file without the values of its arrays to the path that it gets.
        """
        self._journal.keep(0)
        start = self._folder / "start"
        start.unlink(missing_ok=True)
        begin(start)
        sync(start)
        self._journal.add({**identity, "start": _digest(start)})
        self._open(new=True)
        self._sync()

    def _go_on(self) -> None:
        """Continue with the stored tiles that the journal records, up to the first damaged one.

        Checking passes over the tiles and cannot be undone, so that it is repeated with the good
        ones alone once a damaged one was found. Later records are dropped.
        """
        records = self._journal.records[1:]
        while (good := self._passed(records)) < len(records):
            records = records[:good]
        self._journal.keep(1 + good)
        self.done = good
        self.seconds = float(records[-1]["seconds"]) if records else 0.0

    def _passed(self, records: list[dict[str, Any]]) -> int:
        """Return the number of recorded tiles that the file contains undamaged, from the first on.

        Each tile is passed over in the file, as if it were written now, and its checksum compared.
        `records` are those of the journal, with the lengths and the checksum of each tile's chunks.
        """
        file = self._open()
        for number, record in enumerate(records):
            if file.pass_over(self.tiles[number], record["lengths"]) != record["checksum"]:
                return number
        return len(records)

    def _open(self, *, new: bool = False) -> ChunkFile:
        """Open the unfinished file as before the first chunk, ready to take chunks; return it.

        The head is copied over the beginning of the file, as HDF5 has to place all chunks anew in
        the same way. Stored chunks stay behind it, unless `new` discards them.
        """
        if self._file is not None:
            self._file.leave()
        data = self._folder / "data"
        if new or not data.exists():
            data.write_bytes(b"")
        with (self._folder / "start").open("rb") as start, data.open("r+b") as file:
            shutil.copyfileobj(start, file)
        self._file = ChunkFile(data)
        return self._file


def _digest(path: Path) -> str:
    """Return the SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
