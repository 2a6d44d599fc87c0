"""The tasks of workers: one block of a study, or the writing of its result.

Workers share the data directory with the server, and nothing else: arguments are short, and what
is computed goes to the disk.
"""

from __future__ import annotations

import socket
import threading
import time
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from vibrafeed.app.jobs import large
from vibrafeed.app.jobs.errors import BlindWorkerError, NotFoundError, OtherVersionError
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.jobs.studies import identifier
from vibrafeed.app.settings import Settings
from vibrafeed.core import lazy
from vibrafeed.core.code_version import code_version
from vibrafeed.core.errors import StudyError
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.plan.pieces import Cut, cells_of_piece, join
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.report import check, measure
from vibrafeed.core.watch import Watch

IN_GROUP = 0
"""Stands for the cells of a block that goes into a Zarr group (`vibrafeed.app.jobs.large`)."""
REPORT_BYTES = 10_000_000  # bytes that an accuracy report may take on the disk
REPORT_SECONDS = 60.0  # of a report, whose study does not state it

_netcdf = threading.Lock()  # the library crashes if two threads of a worker use it


@dataclass(frozen=True)
class Task:
    """A study that a worker has read and priced, ready to become a job.

    Attributes
    ----------
    key : str
        The study's identifier.
    process : str
        What is carried out: the kind of the study, or `accuracy`.
    text : str
        The study as canonical JSON.
    cells, block_cells, blocks : int
        Cells of the study, cells of one block, and the number of blocks.
    bytes : int
        Bytes that all its files may take on the disk.
    price : float
        Expected time of computing it on one core [s].
    """

    key: str
    process: str
    text: str
    cells: int
    block_cells: int
    blocks: int
    bytes: int
    price: float


def task_of(prepared: Prepared, process: str, settings: Settings) -> Task:
    """Return the task of carrying out a process on a study; the settings say how it is cut."""
    study = prepared.study
    block_cells, count = cut_into_blocks(prepared, process, settings)
    if process in KINDS:
        # For a moment both the blocks and the result are on the disk.
        needed = 2 * prepared.bytes
        price = prepared.price.of(prepared.cells)
    else:
        needed, price = REPORT_BYTES, REPORT_SECONDS
    key, text = identifier(study, process), study.canonical()
    return Task(key, process, text, prepared.cells, block_cells, count, needed, price)


def cut_into_blocks(prepared: Prepared, process: str, settings: Settings) -> tuple[int, int]:
    """Return the number of cells of a block, or `IN_GROUP`, and the number of blocks of a job.

    A block is what a worker computes at a time. A report of accuracy is one block.

    Parameters
    ----------
    prepared : Prepared
        The study, ready to be computed.
    process : str
        What is carried out: the kind of the study, or `accuracy`.
    settings : Settings
        Has the expected time of a block and the limits of the service.
    """
    cells = cells_of_piece(prepared, settings.block_seconds)
    if process not in KINDS:
        check(prepared)
        return cells, 1
    if large.is_large(prepared, settings):
        return IN_GROUP, len(lazy.store.Blocks(prepared))
    return cells, len(Cut(prepared, cells))


def missing_blocks(directory: str, key: str, process: str, cells: int, count: int) -> list[int]:
    """Return the numbers of a study's blocks that are not stored yet, counted from 0.

    A Zarr group is begun, so that clients can read it while it grows.

    Parameters
    ----------
    directory : str
        Data directory of the service.
    key, process : str
        The study's identifier, and what is carried out.
    cells : int
        Number of cells of a block, or `IN_GROUP`.
    count : int
        Number of blocks.
    """
    store = Store(Path(directory))
    if cells != IN_GROUP or process not in KINDS:
        return [index for index in range(count) if not store.has_block(key, cells, index)]
    if store.has_group(key):  # complete: the server died before it noted so
        return []
    prepared = _study(directory, key)
    group = large.group_of_job(store, key, prepared)
    group.begin(outline(prepared), resume=True)
    return group.missing()


def compute_block(
    directory: str, key: str, process: str, cells: int, index: int, version: str
) -> float:
    """Compute a block of a study and store it; return the seconds it took.

    Parameters
    ----------
    directory : str
        Data directory of the service.
    key, process : str
        The study's identifier, and what is carried out.
    cells : int
        Number of cells of the blocks that the study is cut into, or `IN_GROUP`.
    index : int
        Number of the block, from 0.
    version : str
        Version of the server and of its code.

    Raises
    ------
    OtherVersionError
        If this worker has other code than the server.
    BlindWorkerError
        If this worker does not find the study.
    """
    if version != code_version():
        raise OtherVersionError(
            f"The server runs vibrafeed {version}, and a worker {code_version()}. Run one version "
            "on all servers and workers, then post the study again."
        )
    started = time.perf_counter()
    store = Store(Path(directory))
    watch = Watch(threads=1)  # each worker is given a block of its own
    if process in KINDS and cells == IN_GROUP:
        large.group_of_job(store, key, _study(directory, key)).write(index, watch)
    elif not store.has_block(key, cells, index):
        prepared = _study(directory, key)
        if process in KINDS:
            part = prepared.within(Cut(prepared, cells).box(index))
            computed = KINDS[prepared.study.kind].compute(part, watch)
        else:
            computed = measure(prepared, watch).computed()
        store.write_block(key, cells, index, computed)
    return time.perf_counter() - started


def write_result(directory: str, key: str, process: str, cells: int, seconds: float) -> float:
    """Join the blocks of a study and write its result; return the seconds that this took.

    Parameters
    ----------
    directory : str
        Data directory of the service.
    key, process : str
        The study's identifier, and what is carried out.
    cells : int
        Number of cells of a block, or `IN_GROUP`.
    seconds : float
        Computing time of all blocks [s], for the manifest.

    Raises
    ------
    TornBlockError
        If a block is missing or cannot be read; it is to be computed anew.
    """
    started = time.perf_counter()
    store = Store(Path(directory))
    with _netcdf:
        if store.manifest(key) is not None:
            store.drop_blocks(key)
        elif process not in KINDS:
            prepared = _study(directory, key)
            from vibrafeed.app.jobs.accuracy import write_report

            write_report(store, key, process, prepared, cells, seconds)
        elif cells == IN_GROUP:
            group = large.group_of_job(store, key, _study(directory, key))
            large.finish(store, key, process, group, seconds)
        else:
            prepared = _study(directory, key)
            pieces = Cut(prepared, cells)
            count = len(pieces)
            blocks = (
                (pieces.box(index), store.read_block(key, cells, index)) for index in range(count)
            )
            computed = join(prepared, blocks)
            table = KINDS[prepared.study.kind].label(prepared, computed, Watch())
            store.finish(
                key, table, process=process, cells=prepared.cells, blocks=count, seconds=seconds
            )
    return time.perf_counter() - started


@lru_cache(maxsize=16)
def _study(directory: str, key: str) -> Prepared:
    """Return a stored study, ready to be computed by this worker.

    The latest 16 are cached, as a worker gets one block of cells after another.

    Parameters
    ----------
    directory : str
        The data directory of the service, as the worker sees it.
    key : str
        The study's identifier.

    Raises
    ------
    BlindWorkerError
        If the study is not in that directory.
    OtherVersionError
        If it was posted to another version of vibrafeed, and this one cannot read it.
    """
    try:
        return Store(Path(directory)).get(key)
    except NotFoundError:
        raise BlindWorkerError(
            f"A worker on {socket.gethostname()} cannot find the study in {directory}. "
            "All workers of VIBRAFEED_SCHEDULER must see the data directory of the "
            "service (VIBRAFEED_DATA_DIRECTORY) under the same path. Correct that, "
            "then post the study again."
        ) from None
    except StudyError as error:
        raise OtherVersionError(
            f"vibrafeed {code_version()} cannot read this study of another version: {error}. "
            "Post it again."
        ) from None
