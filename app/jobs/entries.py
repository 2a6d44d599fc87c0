"""The entries of the ledger: jobs, items of work, and the filter of a list of jobs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

ACTIVE = ("accepted", "running")
STATES = (*ACTIVE, "successful", "failed", "dismissed")


@dataclass(frozen=True)
class Wanted:
    """The filter of a list of jobs; a field that is empty or None does not restrict the list.

    Attributes
    ----------
    processes, states : tuple
        Names of which a job has to have one.
    created : pair of float or None
        Times between which a job was entered [s since the epoch].
    seconds : pair of int or None
        Least and largest time from a job's beginning to its end, or until now [s].
    seen_by : str or None
        Name of a key: jobs that it owns, and shared ones.
    """

    processes: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    created: tuple[float | None, float | None] = (None, None)
    seconds: tuple[int | None, int | None] = (None, None)
    seen_by: str | None = None


@dataclass(frozen=True)
class Job:
    """A job as a client posted it; times in seconds since the epoch.

    Attributes
    ----------
    done : int
        Blocks that have been computed.
    began, done_then : float or None, int
        When the server that works on it took it up, and how many blocks were there then.
    seconds : float
        Time that computing took, summed over all workers.
    problem : mapping or None
        Why it failed: status, kind, title, detail of a problem document.
    owner : str
        Name of the key that it was posted with; empty where none was needed.
    shared : bool
        True if all keys may read the job and its results.
    gone : bool
        Whether its result has made room for others of its owner, or of the service.
    """

    id: str
    key: str
    process: str
    state: str
    cells: int
    blocks: int
    done: int
    created: float
    started: float | None
    finished: float | None
    seconds: float
    problem: Mapping[str, Any] | None
    began: float | None = None
    done_then: int = 0
    owner: str = ""
    shared: bool = False
    gone: bool = False


@dataclass(frozen=True)
class Work:
    """An item of work: what one or more jobs of equal studies need to have computed.

    Attributes
    ----------
    key, process : str
        The study's identifier, and what is carried out.
    block_cells, blocks : int
        Cells of a block, and number of blocks.
    seconds : float
        Computing time so far [s], summed over workers.
    owner : str
        The claim, under which a server holds the lease; empty if no server does.
    asker : str
        Name of the key whose job has waited longest for it.
    price : float
        Expected time of computing it on one core [s].
    """

    key: str
    process: str
    block_cells: int
    blocks: int
    seconds: float
    owner: str
    asker: str = ""
    price: float = 0.0


@dataclass(frozen=True)
class Queue:
    """The items of work: those that wait, those under way, the age of the oldest that waits [s]."""

    waiting: int
    running: int
    oldest: float
