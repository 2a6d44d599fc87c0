"""A study in parts that are computed anywhere, in any order, and again; and their joining.

Of each part a record is the last that is written: what has no record, or another digest, is
computed again, and nothing else.
"""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from numpy.typing import NDArray

import core
from core.dataset.records import Record, Records
from core.dataset.table import Table
from core.errors import StoppedError, VibrafeedError
from core.study.grid_study import Study
from core.watch import Watch

MAX_PARTS = 100_000  # parts of a study: each leaves a record
SHARDS, ARRAYS = "zarr", "nc"
"""Where parts go: into the shards of a Zarr group that grows, or into records alone, joined to a
NetCDF file."""


class PartsMissingError(VibrafeedError):
    """Parts are missing or damaged; `numbers` are those to compute again."""

    def __init__(self, missing: list[int], damaged: list[int]):
        """Keep the missing and the damaged parts, and make the message."""
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
class Parts(ABC):
    """The parts of a study on their way to a result.

    Attributes
    ----------
    study : Study
        The study.
    cells : int
        Number of its cells.
    where : str
        The result: path or URL of a Zarr group, or path of a NetCDF file.
    count : int
        Number of parts.
    boxes : int
        Number of boxes or tiles of the study; each part is a range of them.
    """

    study: Study
    cells: int
    where: str
    count: int
    boxes: int

    scheme: ClassVar[str] = ""
    """How its boxes are cut and what they tell; parts of another one are computed again."""

    @property
    def identity(self) -> dict[str, str]:
        """The fields that identify the study in every record."""
        scheme = {"scheme": self.scheme} if self.scheme else {}
        return {**identity(self.study), **scheme}

    @property
    def records(self) -> Records:
        """The records of all parts."""
        return Records(self.where)

    def name(self, part: int) -> str:
        """Return the name of a part's record."""
        return f"{part:06}-of-{self.count:06}"

    def ends(self, part: int) -> tuple[int, int]:
        """Return the number of a part's first box or tile, and the number after its last."""
        return part * self.boxes // self.count, (part + 1) * self.boxes // self.count

    def missing(self) -> list[int]:
        """Return the numbers of parts without a record."""
        there = set(self.records.names())
        return [part for part in range(self.count) if self.name(part) not in there]

    def begin(self) -> None:
        """Write the metadata of a growing result for its readers, if the format has any."""
        return

    def digests(self) -> dict[str, str]:
        """Return the SHA-256 of every shard that the parts have written, by key."""
        records = (self.records.read(self.name(part)) for part in range(self.count))
        return {
            key: digest
            for record in records
            if record is not None
            for key, digest in record.fields["shards"].items()
        }

    def forget(self, parts: Iterable[int]) -> None:
        """Remove the records of some parts, so that they are computed again."""
        for part in parts:
            self.records.remove(self.name(part))

    def is_there(self, part: int) -> bool:
        """True if a part has a valid record."""
        return self._is_ours(self.records.read(self.name(part)), part)

    def compute(self, part: int, watch: Watch | None = None) -> bytes:
        """Compute a part and write its shards; return its record as bytes, not stored yet.

        Raises
        ------
        StoppedError
            If `watch` stops it.
        """
        watch, started = watch or Watch(), time.perf_counter()
        arrays, shards = self._computed(*self.ends(part), watch)
        fields = {
            "identity": self.identity,
            "part": part,
            "parts": self.count,
            "seconds": time.perf_counter() - started,
            "shards": shards,
        }
        return Record(fields, arrays).pack()

    def keep(self, part: int, record: bytes) -> None:
        """Store the record of a part, which marks it as done."""
        self.records.write(self.name(part), record)

    def join(self, watch: Watch | None = None, *, history: str | None = None) -> Table:
        """Join all parts into the result and write it; return its table and remove the records.

        The table of a Zarr group has no values but those without dimension. `history` is an
        attribute of the result.

        Raises
        ------
        PartsMissingError
            If parts are missing, or differ from their digest.
        """
        table = self._joined(watch or Watch(), history)
        self.records.clear()
        return table

    def joined_table(self, watch: Watch | None = None) -> Table | None:
        """Return the result of all parts as one table without writing it; None for a Zarr group.

        Raises
        ------
        PartsMissingError
            If parts are missing, or differ from their digest.
        """
        del watch
        return None

    @abstractmethod
    def _computed(
        self, start: int, stop: int, watch: Watch
    ) -> tuple[dict[str, NDArray[Any]], dict[str, str]]:
        """Compute the boxes or tiles from `start` to `stop`; return arrays and shard digests.

        The arrays are for the part's record; the digests are the SHA-256 of written shards, by key.
        """

    @abstractmethod
    def _joined(self, watch: Watch, history: str | None) -> Table:
        """Write the result of all parts; return its table. `history` is an attribute of it."""

    def _is_ours(self, record: Record | None, part: int) -> bool:
        """True if a record belongs to this part of this study."""
        own = {"identity": self.identity, "part": part, "parts": self.count}
        return record is not None and own.items() <= record.fields.items()

    def _check(
        self, watch: Watch, is_usable: Callable[[Record], bool] = lambda _: True
    ) -> list[Mapping[str, Any]]:
        """Return the fields of all parts' records, after checking that each is there and sound.

        `is_usable` checks the content of a record. Raises `PartsMissingError` with the missing and
        the damaged parts, `StoppedError` if `watch` stops it.
        """
        missing, damaged, fields = [], [], []
        there = set(self.records.names())
        for part in range(self.count):
            if watch.stopped():
                raise StoppedError(
                    "the join was stopped while parts were checked; run the command again"
                )
            record = self.records.read(self.name(part))
            if self.name(part) not in there:
                missing.append(part)
            elif not self._is_ours(record, part):
                damaged.append(part)
            elif record is not None:
                if not is_usable(record):
                    damaged.append(part)
                fields.append(record.fields)
            watch.advance(1 / self.count)
        if missing or damaged:
            raise PartsMissingError(missing, damaged)
        return fields

    def _records(self) -> Iterator[Record]:
        """Yield the records of all parts; raise `PartsMissingError` for a missing one."""
        for part in range(self.count):
            record = self.records.read(self.name(part))
            if record is None:
                raise PartsMissingError([part], [])
            yield record


def ranges(numbers: list[int]) -> str:
    """Return sorted numbers in the notation of job queues, such as ``3,17-19``."""
    intervals: list[str] = []
    start = before = -2
    for number in [*sorted(numbers), -2]:
        if number != before + 1 or number < 0:
            if before >= 0:
                intervals.append(str(start) if start == before else f"{start}-{before}")
            start = number
        before = number
    return ",".join(intervals)
