"""A study in shares that are computed anywhere, in any order, and again; and their joining.

Of each share a record is the last that is written: what has no record, or another digest, is
computed again, and nothing else.
"""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from numpy.typing import NDArray

from vibrafeed import core
from vibrafeed.core.dataset.records import Record, Records
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.errors import StoppedError, VibrafeedError
from vibrafeed.core.study.grid_study import Study
from vibrafeed.core.watch import Watch

MAX_SHARES = 100_000  # shares of a study: each leaves a record
SHARDS, ARRAYS = "zarr", "nc"
"""Where shares go: into the shards of a Zarr group that grows, or into records alone, joined to a
NetCDF file."""


class SharesMissingError(VibrafeedError):
    """Shares are missing or damaged; `numbers` are those to compute again."""

    def __init__(self, missing: list[int], damaged: list[int]):
        """Keep the missing and the damaged shares, and make the message."""
        self.missing, self.damaged = missing, damaged
        self.numbers = sorted({*missing, *damaged})
        messages = [
            f"{len(numbers):,} {what}: {ranges(numbers)}"
            for what, numbers in (("missing", missing), ("damaged", damaged))
            if numbers
        ]
        super().__init__("; ".join(messages))


def identity(study: Study) -> dict[str, str]:
    """Return the identity of a run: runs with equal identities write equal bytes."""
    return {"study": study.key(), "version": core.__version__}


@dataclass(frozen=True)
class Shares(ABC):
    """The shares of a study on their way to a result.

    Attributes
    ----------
    study : Study
        The study.
    cells : int
        Number of its cells.
    where : str
        The result: path or URL of a Zarr group, or path of a NetCDF file.
    count : int
        Number of shares.
    boxes : int
        Number of boxes or tiles of the study; each share is a range of them.
    """

    study: Study
    cells: int
    where: str
    count: int
    boxes: int

    scheme: ClassVar[str] = ""
    """How its boxes are cut and what they tell; shares of another one are computed again."""

    @property
    def identity(self) -> dict[str, str]:
        """The fields that identify the study in every record."""
        scheme = {"scheme": self.scheme} if self.scheme else {}
        return {**identity(self.study), **scheme}

    @property
    def records(self) -> Records:
        """The records of all shares."""
        return Records(self.where)

    def name(self, share: int) -> str:
        """Return the name of a share's record."""
        return f"{share:06}-of-{self.count:06}"

    def ends(self, share: int) -> tuple[int, int]:
        """Return the number of a share's first box or tile, and the number after its last."""
        return share * self.boxes // self.count, (share + 1) * self.boxes // self.count

    def missing(self) -> list[int]:
        """Return the numbers of shares without a record."""
        there = set(self.records.names())
        return [share for share in range(self.count) if self.name(share) not in there]

    def begin(self) -> None:
        """Write the metadata of a growing result for its readers, if the format has any."""
        return

    def digests(self) -> dict[str, str]:
        """Return the SHA-256 of every file (shard) that shares of a study have written.

        A shard is a file with a piece of the result; by its key, later checks find whether its
        bytes are intact.
        """
        records = (self.records.read(self.name(share)) for share in range(self.count))
        return {
            key: digest
            for record in records
            if record is not None
            for key, digest in record.fields["shards"].items()
        }

    def forget(self, shares: Iterable[int]) -> None:
        """Remove the records of some shares, so that they are computed again."""
        for share in shares:
            self.records.remove(self.name(share))

    def is_there(self, share: int) -> bool:
        """True if a share has a valid record."""
        return self._is_ours(self.records.read(self.name(share)), share)

    def compute(self, share: int, watch: Watch | None = None) -> bytes:
        """Compute a share of a study and write its shards; return its record as bytes.

        A share is a slab of the grid that may be computed on any machine; the record says which
        study it belongs to, has its seconds, and what is needed to join all shares.

        Raises
        ------
        StoppedError
            If `watch` stops it.
        """
        watch, started = watch or Watch(), time.perf_counter()
        arrays, shards = self._computed(*self.ends(share), watch)
        fields = {
            "identity": self.identity,
            "share": share,
            "shares": self.count,
            "seconds": time.perf_counter() - started,
            "shards": shards,
        }
        return Record(fields, arrays).pack()

    def keep(self, share: int, record: bytes) -> None:
        """Store the record of a share, which marks it as done."""
        self.records.write(self.name(share), record)

    def join(self, watch: Watch | None = None, *, history: str | None = None) -> Table:
        """Join all shares into the result and write it; return its table and remove the records.

        The table of a Zarr group has no values but those without dimension. `history` is an
        attribute of the result.

        Raises
        ------
        SharesMissingError
            If shares are missing, or differ from their digest.
        """
        table = self._joined(watch or Watch(), history)
        self.records.clear()
        return table

    def joined_table(self, watch: Watch | None = None) -> Table | None:
        """Return the result of all shares as one table without writing it; None for a Zarr group.

        Raises
        ------
        SharesMissingError
            If shares are missing, or differ from their digest.
        """
        del watch
        return None

    @abstractmethod
    def _computed(
        self, start: int, stop: int, watch: Watch
    ) -> tuple[dict[str, NDArray[Any]], dict[str, str]]:
        """Compute the boxes or tiles from `start` to `stop`; return arrays and shard digests.

        The arrays are for the record; the digests are the SHA-256 of written shards, by key.
        """

    @abstractmethod
    def _joined(self, watch: Watch, history: str | None) -> Table:
        """Write the result of all shares; return its table. `history` is an attribute of it."""

    def _is_ours(self, record: Record | None, share: int) -> bool:
        """True if a record belongs to this share of this study."""
        own = {"identity": self.identity, "share": share, "shares": self.count}
        return record is not None and own.items() <= record.fields.items()

    def _check(
        self, watch: Watch, is_usable: Callable[[Record], bool] = lambda _: True
    ) -> list[Mapping[str, Any]]:
        """Return the fields of all shares' records, after checking that all are there and whole.

        A share is a slab of the study that may be computed elsewhere and leaves a record.
        `is_usable` checks the content of a record. Raises `SharesMissingError` with the missing and
        the damaged shares, `StoppedError` if `watch` stops it.
        """
        missing, damaged, fields = [], [], []
        there = set(self.records.names())
        for share in range(self.count):
            if watch.stopped():
                raise StoppedError(
                    "the join was stopped while shares were checked; run the command again"
                )
            record = self.records.read(self.name(share))
            if self.name(share) not in there:
                missing.append(share)
            elif not self._is_ours(record, share):
                damaged.append(share)
            elif record is not None:
                if not is_usable(record):
                    damaged.append(share)
                fields.append(record.fields)
            watch.advance(1 / self.count)
        if missing or damaged:
            raise SharesMissingError(missing, damaged)
        return fields

    def _records(self) -> Iterator[Record]:
        """Yield the records that the shares of a study have left on disk, in order.

        A share is a slab of the study's grid that may be computed on another machine. Raises
        `SharesMissingError` at the first one that is missing or not readable.
        """
        for share in range(self.count):
            record = self.records.read(self.name(share))
            if record is None:
                raise SharesMissingError([share], [])
            yield record


def ranges(numbers: list[int]) -> str:
    """Return sorted numbers in the notation of job queues, such as ``3,17-19``.

    It names the shares of a study that are to be computed again.
    """
    intervals: list[str] = []
    start = before = -2
    for number in [*sorted(numbers), -2]:
        if number != before + 1 or number < 0:
            if before >= 0:
                intervals.append(str(start) if start == before else f"{start}-{before}")
            start = number
        before = number
    return ",".join(intervals)
