"""What workers run: one block of a study, or the writing of its result.

Workers share the data directory with the server, and nothing else: arguments are short, and what
is computed goes to the disk.
"""

from __future__ import annotations

import time
from functools import lru_cache
from pathlib import Path

from app.store import NETCDF, Store
from core.kinds import KINDS
from core.sweep.pieces import Cut, join
from core.sweep.prepare import Prepared
from core.watch import Watch

MOST_BLOCK_CELLS = 1_000_000
MOST_BLOCKS = 100_000


def block_cells(prepared: Prepared, seconds: float) -> int:
    """Return the cells of a block that takes about so many seconds of one core."""
    cells = seconds / prepared.seconds_a_cell
    fewest = prepared.cells / MOST_BLOCKS
    return int(min(MOST_BLOCK_CELLS, max(cells, fewest, 1)))


def compute_block(directory: str, key: str, cells: int, index: int) -> float:
    """Compute a block of a study and keep it; return the seconds that it took.

    `cells` is the size of the pieces that the study is cut into.
    """
    started = time.perf_counter()
    store = Store(Path(directory))
    if not store.has_block(key, cells, index):
        prepared, pieces = _study(directory, key, cells)
        part = prepared.within(pieces.box(index))
        computed = KINDS[prepared.study.kind].compute(part, Watch())
        store.write_block(key, cells, index, computed)
    return time.perf_counter() - started


def write_result(directory: str, key: str, cells: int, process: str, seconds: float) -> float:
    """Join the blocks of a study and write its result; return the seconds that it took.

    Raises
    ------
    TornBlockError
        If a block is missing or cannot be read; it is to be computed anew.
    """
    started = time.perf_counter()
    store = Store(Path(directory))
    if store.manifest(key) is None:
        prepared, pieces = _study(directory, key, cells)
        if process not in KINDS:
            _write_report(store, key, prepared, process)
            return time.perf_counter() - started
        count = len(pieces)
        parts = ((pieces.box(index), store.read_block(key, cells, index)) for index in range(count))
        computed = join(prepared, parts)
        spent = seconds + time.perf_counter() - started  # without verifying, a part of the labels
        table = KINDS[prepared.study.kind].label(prepared, computed)
        store.finish(key, table, process=process, cells=prepared.cells, blocks=count, seconds=spent)
    return time.perf_counter() - started


def _write_report(store: Store, key: str, prepared: Prepared, process: str) -> None:
    """Measure the accuracy of a study and write the report."""
    from app.accuracy import PAGE, draw
    from core.accuracy.page import head_of, sections_of, write_page
    from core.accuracy.report import machine, measure_study

    started, facts = time.perf_counter(), machine()
    part = measure_study(prepared, name="study.json")

    def more(folder: Path) -> list[str]:
        families = [one.family for one in part.measured if one.curves]
        pictures = {
            family: path.name
            for family, path in draw(folder / NETCDF, folder, "study", families).items()
        }
        head = head_of(facts, "vibrafeed report study.json")
        page = write_page("Accuracy", head, list(sections_of(part, pictures)))
        (folder / PAGE).write_text(page, encoding="utf-8")
        return [PAGE, *pictures.values()]

    seconds = time.perf_counter() - started
    store.finish(
        key, part.table, process=process, cells=prepared.cells, blocks=0, seconds=seconds, more=more
    )


@lru_cache(maxsize=16)
def _study(directory: str, key: str, cells: int) -> tuple[Prepared, Cut]:
    """Return a study and its blocks; a worker computes many blocks of one."""
    prepared = Store(Path(directory)).get(key)
    return prepared, Cut(prepared, cells)
