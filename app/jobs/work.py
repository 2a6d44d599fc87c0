"""What workers run: one block of a study, or the writing of its result.

Workers share the data directory with the server, and nothing else: arguments are short, and what
is computed goes to the disk.
"""

from __future__ import annotations

import time
from functools import lru_cache
from pathlib import Path

from app.store import Store
from core.kinds import KINDS
from core.sweep.pieces import Cut, join
from core.sweep.prepare import Prepared
from core.watch import Watch

BLOCK_SECONDS = 1.0  # of one core: what a kill or a dismissal loses
MOST_BLOCK_CELLS = 1_000_000
MOST_BLOCKS = 100_000


def cut(prepared: Prepared) -> Cut:
    """Return a study cut into blocks of about a second."""
    cells = BLOCK_SECONDS / prepared.seconds_a_cell
    fewest = prepared.cells / MOST_BLOCKS
    return Cut(prepared, int(min(MOST_BLOCK_CELLS, max(cells, fewest, 1))))


def compute_block(directory: str, key: str, index: int) -> float:
    """Compute a block of a study and keep it; return the seconds that it took."""
    started = time.perf_counter()
    store = Store(Path(directory))
    if not store.has_block(key, index):
        prepared, pieces = _study(directory, key)
        part = prepared.within(pieces.box(index))
        computed = KINDS[prepared.study.kind].compute(part, Watch())
        store.write_block(key, index, computed)
    return time.perf_counter() - started


def write_result(directory: str, key: str, process: str, seconds: float) -> float:
    """Join the blocks of a study and write its result; return the seconds that it took.

    Raises
    ------
    TornBlockError
        If a block is missing or cannot be read; it is to be computed anew.
    """
    started = time.perf_counter()
    store = Store(Path(directory))
    if store.manifest(key) is None:
        prepared, pieces = _study(directory, key)
        count = len(pieces)
        parts = ((pieces.box(index), store.read_block(key, index)) for index in range(count))
        table = KINDS[prepared.study.kind].label(prepared, join(prepared, parts))
        spent = seconds + time.perf_counter() - started
        store.finish(key, table, process=process, cells=prepared.cells, blocks=count, seconds=spent)
    return time.perf_counter() - started


@lru_cache(maxsize=16)
def _study(directory: str, key: str) -> tuple[Prepared, Cut]:
    """Return a study and its blocks; a worker computes many blocks of one."""
    prepared = Store(Path(directory)).get(key)
    return prepared, cut(prepared)
