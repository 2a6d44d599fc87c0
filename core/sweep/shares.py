"""A sweep in shares: each a range of its tiles, which it writes as whole shards of a Zarr group."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from vibrafeed.core.dataset.records import Record
from vibrafeed.core.dataset.shards import GrowingZarr
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.plan.pieces import run_cost
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.plan.shares import Shares, identity
from vibrafeed.core.plan.tiles import Tiled
from vibrafeed.core.sweep.stream import outline_table, stream
from vibrafeed.core.watch import Watch


@dataclass(frozen=True)
class Shards(Shares):
    """The shares of a sweep on their way to a Zarr group.

    Attributes
    ----------
    sweep : Prepared
        The sweep.
    """

    sweep: Prepared

    def begin(self) -> None:
        """Write the metadata of a sweep's Zarr group, so that readers can open it as it grows."""
        growing = self._growing(outline_table(self.sweep.unverified()))
        try:
            growing.show()
        finally:
            growing.close()

    def _growing(self, table: Table, history: str | None = None) -> GrowingZarr:
        """Return the Zarr group under way."""
        tiles, made = Tiled(self.sweep).tiles, identity(self.study)
        return GrowingZarr(self.where, tiles, table, made, shared=True, history=history)

    def _computed(
        self, start: int, stop: int, watch: Watch
    ) -> tuple[dict[str, NDArray[Any]], dict[str, str]]:
        """Compute and write the tiles from `start` to `stop` of a sweep that is done in shares.

        A tile is a piece of all arrays. No arrays are returned, but the digests of the files
        (shards) that were written, by path, for later checks. Raises `StoppedError` if `watch`
        stops it before all are written.
        """
        sweep = self.sweep.unverified()
        growing = self._growing(outline_table(sweep))
        try:
            target = _Range(growing, start, stop)
            stream(sweep, target, watch)
            growing.flush()
        finally:
            growing.close()
        if target.left:
            raise StoppedError(
                "the run was stopped before this share of the sweep was written; run it again"
            )
        return {}, growing.digests

    def _joined(self, watch: Watch, history: str | None) -> Table:
        """Finish the Zarr group of a sweep whose shares are all written, and return its table.

        The sweep is verified and all files (shards) are checked first; `watch` may stop that.
        `history` is the CF attribute.
        """
        table = outline_table(self.sweep, watch)
        growing = self._growing(table, history)
        try:
            told = self._check(watch, lambda record: _is_there(growing, record))
            growing.finish(run_cost(self.cells, sum(one["seconds"] for one in told)))
        finally:
            growing.close()
        return table


def _is_there(growing: GrowingZarr, record: Record) -> bool:
    """True if the shards of a share have the digests in its record."""
    shards: Mapping[str, str] = record.fields["shards"]
    return all(growing.digest(key) == digest for key, digest in shards.items())


class _Range:
    """The tiles of a share as a target of `stream`, which it does not finish."""

    def __init__(self, growing: GrowingZarr, start: int, stop: int):
        """Take the tiles from `start` to `stop` of a growing group."""
        self._growing, self._tiles = growing, range(start, stop)
        self.seconds, self.left = 0.0, stop - start

    @property
    def missing(self) -> Iterator[int]:
        """Return the tiles of the share."""
        return iter(self._tiles)

    def write(self, index: int, arrays: Mapping[str, NDArray[Any]], seconds: float) -> None:
        """Write a tile."""
        self._growing.write(index, arrays, seconds)
        self.left -= 1

    def finish(self, price: Mapping[str, float]) -> None:
        """Do nothing: the group is finished when the shares are joined."""
