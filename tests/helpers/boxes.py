"""The answers of a reduced study, however its cells are cut into boxes and shared among threads."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from vibrafeed.core.reduce.arrays import reduced_arrays
from vibrafeed.core.reduce.run import Units
from vibrafeed.core.watch import Watch


def assert_same_bits(prepared: Any, ways: Iterable[tuple[int, int]]) -> None:
    """Assert that answers have the same bits by each number of cells of a box, and of threads."""
    want: dict[str, bytes] = {}
    for cells, threads in ways:
        units = Units(prepared.plan, prepared.grid, prepared.asked, cells)
        states = units.states(0, len(units), Watch(threads=threads))
        got = reduced_arrays(units, prepared.grid, prepared.asked, states)
        got_bytes = {name: array.tobytes() for name, array in got.items()}
        want = want or got_bytes
        assert got_bytes == want
