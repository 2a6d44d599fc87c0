"""A sweep in parts that are computed anywhere, in any order, and again; and their joining.

A part of a sweep is a range of its tiles, which it writes as whole shards; a part of a reduced one
a range of its boxes, of which its record holds what they tell. Either way the record is the last
that it writes: what has no record, or another digest, is computed again, and nothing else.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from core.dataset.netcdf import write_netcdf
from core.dataset.records import Record, Records
from core.dataset.shards import GrowingZarr
from core.dataset.table import Table
from core.errors import StoppedError, VibrafeedError
from core.plan.pieces import price
from core.plan.tiles import Tiled
from core.reduce.state import State, merged
from core.sweep.prepare import ReducedSweep, Sweep
from core.sweep.reduced import joined
from core.sweep.run import label
from core.sweep.stream import identity, outline, stream
from core.watch import Watch

MOST_PARTS = 100_000


class PartsMissingError(VibrafeedError):
    """Parts are missing or damaged; `numbers` are those to compute again."""

    def __init__(self, missing: list[int], damaged: list[int]):
        self.missing, self.damaged = missing, damaged
        self.numbers = sorted({*missing, *damaged})
        told = [
            f"{len(numbers):,} {what}: {ranges(numbers)}"
            for what, numbers in (("missing", missing), ("damaged", damaged))
            if numbers
        ]
        super().__init__("; ".join(told))


@dataclass(frozen=True)
class Parts:
    """The parts of a sweep on their way to a result.

    Attributes
    ----------
    sweep : Sweep or ReducedSweep
        The sweep.
    where : str
        The result: a Zarr group, or the NetCDF file of a reduced sweep.
    count : int
        Number of parts.
    """

    sweep: Sweep | ReducedSweep
    where: str
    count: int

    @property
    def records(self) -> Records:
        """The records of all parts."""
        return Records(self.where)

    def name(self, part: int) -> str:
        """Return the name of the record of a part."""
        return f"{part:06}-of-{self.count:06}"

    def ends(self, part: int) -> tuple[int, int]:
        """Return the first of the boxes or tiles of a part, and the first after them."""
        total = len(self._work)
        return part * total // self.count, (part + 1) * total // self.count

    def missing(self) -> list[int]:
        """Return the parts that have no record."""
        there = set(self.records.names())
        return [part for part in range(self.count) if self.name(part) not in there]

    def begin(self) -> None:
        """Write what readers need who want to follow the group of a sweep while it grows."""
        if isinstance(self.sweep, Sweep):
            growing = self._growing(self.sweep, outline(self.sweep.unverified()))
            try:
                growing.show()
            finally:
                growing.close()

    def digests(self) -> dict[str, str]:
        """Return the SHA-256 of each shard that the parts have written, by its key."""
        records = (self.records.read(self.name(part)) for part in range(self.count))
        return {
            key: digest
            for record in records
            if record is not None
            for key, digest in record.told["shards"].items()
        }

    def forget(self, parts: Iterable[int]) -> None:
        """Remove the records of some parts, which are computed again then."""
        for part in parts:
            self.records.remove(self.name(part))

    def is_there(self, part: int) -> bool:
        """Return whether a part has left a sound record."""
        return self._is_ours(self.records.read(self.name(part)), part)

    def compute(self, part: int, watch: Watch | None = None) -> bytes:
        """Compute a part, and write its shards; return its record, which is still to be kept.

        Raises
        ------
        StoppedError
            If `watch` stops it.
        """
        watch, started = watch or Watch(), time.perf_counter()
        arrays: State = {}
        shards: dict[str, str] = {}
        start, stop = self.ends(part)
        if isinstance(self.sweep, Sweep):
            shards = self._shards(self.sweep, start, stop, watch)
        elif stop > start:
            for field, block, state in self.sweep.work.states(start, stop, watch):
                arrays |= {f"{field}/{block}/{name}": values for name, values in state.items()}
        told = {
            "identity": identity(self.sweep),
            "part": part,
            "parts": self.count,
            "seconds": time.perf_counter() - started,
            "shards": shards,
        }
        return Record(told, arrays).pack()

    def keep(self, part: int, record: bytes) -> None:
        """Keep the record of a part: it is done then."""
        self.records.write(self.name(part), record)

    def join(self, watch: Watch | None = None, *, history: str | None = None) -> Table:
        """Make the result of all parts, under its name; return its table.

        That of a Zarr group has no values but those without dimension.

        Raises
        ------
        PartsMissingError
            If some are missing, or differ from their digest.
        """
        watch = watch or Watch()
        if isinstance(self.sweep, Sweep):
            table = self._join_shards(self.sweep, watch, history)
        else:
            table = self.answers(self.sweep, watch)
            write_netcdf(table, Path(self.where), history=history)
        self.records.clear()
        return table

    def answers(self, sweep: ReducedSweep, watch: Watch | None = None) -> Table:
        """Return what all parts of a reduced sweep tell; raise as `join`, and write nothing."""
        watch, told = watch or Watch(), list[Mapping[str, Any]]()
        self._check(watch)
        computed = joined(sweep, self._states(told))
        table = label(sweep, computed, watch)
        return table.with_price(price(sweep.cells, sum(one["seconds"] for one in told)))

    @property
    def _work(self) -> Any:
        return Tiled(self.sweep).tiles if isinstance(self.sweep, Sweep) else self.sweep.work

    def _is_ours(self, record: Record | None, part: int) -> bool:
        own = {"identity": identity(self.sweep), "part": part, "parts": self.count}
        return record is not None and own.items() <= record.told.items()

    def _growing(self, sweep: Sweep, table: Table, history: str | None = None) -> GrowingZarr:
        return GrowingZarr(
            self.where, self._work, table, identity(sweep), shared=True, history=history
        )

    def _shards(self, sweep: Sweep, start: int, stop: int, watch: Watch) -> dict[str, str]:
        growing = self._growing(sweep, outline(sweep.unverified()))
        try:
            target = _Range(growing, start, stop)
            stream(sweep.unverified(), target, watch)
            growing.flush()
        finally:
            growing.close()
        if target.left:
            raise StoppedError("it was stopped before all shards of the part were written")
        return growing.digests

    def _check(self, watch: Watch, growing: GrowingZarr | None = None) -> list[Mapping[str, Any]]:
        """Return what all parts tell; raise if one is missing or damaged."""
        missing, damaged, told = [], [], []
        there = set(self.records.names())
        for part in range(self.count):
            if watch.stopped():
                raise StoppedError("it was stopped while parts were checked")
            record = self.records.read(self.name(part))
            if self.name(part) not in there:
                missing.append(part)
            elif not self._is_ours(record, part):
                damaged.append(part)
            elif record is not None:
                shards: Mapping[str, str] = record.told["shards"]
                if growing is not None and any(
                    growing.digest(key) != digest for key, digest in shards.items()
                ):
                    damaged.append(part)
                told.append(record.told)
            watch.advance(1 / self.count)
        if missing or damaged:
            raise PartsMissingError(missing, damaged)
        return told

    def _join_shards(self, sweep: Sweep, watch: Watch, history: str | None) -> Table:
        table = outline(sweep, watch)
        growing = self._growing(sweep, table, history)
        try:
            told = self._check(watch, growing)
            growing.finish(price(sweep.cells, sum(one["seconds"] for one in told)))
        finally:
            growing.close()
        return table

    def _states(self, told: list[Mapping[str, Any]]) -> Iterator[tuple[int, int, State]]:
        """Yield what all parts tell of each block, and collect their words."""
        known: tuple[int, int] | None = None
        state: State = {}
        for part in range(self.count):
            record = self.records.read(self.name(part))
            if record is None:
                raise PartsMissingError([part], [])
            told.append(record.told)
            for place, found in _blocks(record.arrays).items():
                if place == known:
                    state = merged(state, found)
                    continue
                if known is not None:
                    yield (*known, state)
                known, state = place, found
        if known is not None:
            yield (*known, state)


class _Range:
    """The tiles of a part as a target of `stream`, which it does not finish."""

    def __init__(self, growing: GrowingZarr, start: int, stop: int):
        self._growing, self._tiles = growing, range(start, stop)
        self.seconds, self.left = 0.0, stop - start

    @property
    def missing(self) -> Iterator[int]:
        return iter(self._tiles)

    def write(self, index: int, arrays: Mapping[str, NDArray[Any]], seconds: float) -> None:
        self._growing.write(index, arrays, seconds)
        self.left -= 1

    def finish(self, price: Mapping[str, float]) -> None:
        """Leave it to those who join."""


def _blocks(arrays: Mapping[str, NDArray[Any]]) -> dict[tuple[int, int], State]:
    """Return the states of a record, by field and block, in their order."""
    found: dict[tuple[int, int], State] = {}
    for name, values in arrays.items():
        field, block, of = name.split("/", 2)
        found.setdefault((int(field), int(block)), {})[of] = values
    return dict(sorted(found.items()))


def ranges(numbers: list[int]) -> str:
    """Return numbers as queues take them: ``3,17-19``."""
    told: list[str] = []
    start = before = -2
    for number in [*sorted(numbers), -2]:
        if number != before + 1 or number < 0:
            if before >= 0:
                told.append(str(start) if start == before else f"{start}-{before}")
            start = number
        before = number
    return ",".join(told)
