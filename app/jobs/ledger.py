"""The ledger of jobs: an SQLite database that several servers and threads may share.

Every change is one transaction, committed to the disk before the call returns. A *job* is what a
client posted. An *item of work* is what has to be computed, once for all jobs of equal studies; it
exists only until it is done. The server that works on an item holds a lease on it, which it renews;
a lease that has run out may be taken over.
"""

from __future__ import annotations

import json
import sqlite3
import threading
import time
import uuid
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.exceptions import QueueFullError

ACTIVE = ("accepted", "running")
STATES = (*ACTIVE, "successful", "failed", "dismissed")

_SCHEMA = """
CREATE TABLE IF NOT EXISTS work (
    key TEXT PRIMARY KEY,
    process TEXT NOT NULL,
    cells INTEGER NOT NULL,
    block_cells INTEGER NOT NULL,
    blocks INTEGER NOT NULL,
    done INTEGER NOT NULL DEFAULT 0,
    seconds REAL NOT NULL DEFAULT 0,
    created REAL NOT NULL,
    owner TEXT,
    lease REAL NOT NULL DEFAULT 0
) STRICT;
CREATE TABLE IF NOT EXISTS jobs (
    id TEXT PRIMARY KEY,
    key TEXT NOT NULL,
    process TEXT NOT NULL,
    state TEXT NOT NULL,
    cells INTEGER NOT NULL,
    blocks INTEGER NOT NULL,
    created REAL NOT NULL,
    started REAL,
    finished REAL,
    seconds REAL,
    problem TEXT
) STRICT;
CREATE INDEX IF NOT EXISTS jobs_by_key ON jobs (key);
CREATE INDEX IF NOT EXISTS jobs_by_time ON jobs (created);
"""

_JOB = """
SELECT jobs.*, coalesce(work.done, 0) AS done, coalesce(work.seconds, 0) AS spent
FROM jobs LEFT JOIN work ON work.key = jobs.key
"""

# Times are compared as they are told, to the millisecond. What has not begun has no duration.
_WANTED = """
WHERE (?1 = '[]' OR jobs.process IN (SELECT value FROM json_each(?1)))
AND (?2 = '[]' OR jobs.state IN (SELECT value FROM json_each(?2)))
AND (?3 IS NULL OR CAST(round(jobs.created * 1e6) AS INTEGER) / 1000 >= round(?3 * 1000))
AND (?4 IS NULL OR CAST(round(jobs.created * 1e6) AS INTEGER) / 1000 <= round(?4 * 1000))
AND (?6 IS NULL OR coalesce(jobs.finished, ?5) - jobs.started >= ?6)
AND (?7 IS NULL OR coalesce(jobs.finished, ?5) - jobs.started <= ?7)
"""


@dataclass(frozen=True)
class Wanted:
    """Which jobs a list is to hold; what is empty or None chooses nothing.

    Attributes
    ----------
    processes, states : tuple
        One of these.
    created : pair of float or None
        Entered between these times [s since the epoch].
    seconds : pair of int or None
        Least and longest time from their beginning to their end, or until now.
    """

    processes: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    created: tuple[float | None, float | None] = (None, None)
    seconds: tuple[int | None, int | None] = (None, None)


@dataclass(frozen=True)
class Job:
    """What a client posted; times in seconds since the epoch.

    Attributes
    ----------
    done : int
        Blocks that have been computed.
    seconds : float
        Time that computing took, summed over all workers.
    problem : mapping or None
        Why it failed: status, kind, title, detail of a problem document.
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


@dataclass(frozen=True)
class Work:
    """An item of work that this server holds the lease of."""

    key: str
    process: str
    block_cells: int
    blocks: int
    seconds: float


class Ledger:
    """Reads and writes the ledger.

    Parameters
    ----------
    path : Path
        The database; made if missing.
    """

    def __init__(self, path: Path):
        self._path = path
        self._lock = threading.Lock()
        self._opened: sqlite3.Connection | None = None

    def close(self) -> None:
        """Close the database; the next use opens it again."""
        with self._lock:
            if self._opened is not None:
                self._opened.close()
                self._opened = None

    def _database(self) -> sqlite3.Connection:
        """Return the connection, made when it is first needed; the lock is held."""
        if self._opened is None:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            database = sqlite3.connect(
                self._path, timeout=30, isolation_level=None, check_same_thread=False
            )
            try:
                database.row_factory = sqlite3.Row
                database.execute("PRAGMA journal_mode = WAL")
                database.execute("PRAGMA synchronous = FULL")  # on the disk before the reply
                database.executescript(_SCHEMA)
            except BaseException:
                database.close()
                raise
            self._opened = database
        return self._opened

    @contextmanager
    def _changing(self) -> Iterator[sqlite3.Connection]:
        # IMMEDIATE: a transaction that reads before it writes would fail under another writer.
        with self._lock:
            database = self._database()
            database.execute("BEGIN IMMEDIATE")
            try:
                yield database
                database.execute("COMMIT")
            except BaseException:
                if database.in_transaction:
                    database.execute("ROLLBACK")
                raise

    def _read(self, statement: str, *values: object) -> list[sqlite3.Row]:
        with self._lock:
            return self._database().execute(statement, values).fetchall()

    # --- what clients do

    def post(
        self,
        key: str,
        process: str,
        *,
        cells: int,
        block_cells: int,
        blocks: int,
        finished_seconds: float | None,
        most_waiting: int,
    ) -> Job:
        """Enter a job; one whose result is there already is successful at once.

        Parameters
        ----------
        finished_seconds : float or None
            What computing took, if the result is there.
        most_waiting : int
            Most items of work in the queue; a job of work that is in it already is always taken.

        Raises
        ------
        QueueFullError
            If the queue is full.
        """
        number, now = uuid.uuid4().hex, time.time()
        state: str
        started: float | None
        finished: float | None
        with self._changing() as database:
            if finished_seconds is None:
                known = database.execute(
                    "SELECT owner, blocks FROM work WHERE key = ?", (key,)
                ).fetchone()
                if known is None:
                    [waiting] = database.execute("SELECT count(*) FROM work").fetchone()
                    if waiting >= most_waiting:
                        raise QueueFullError(
                            f"{waiting:,} studies are being carried out or waiting; no more are "
                            "taken before one is done."
                        )
                    database.execute(
                        "INSERT INTO work (key, process, cells, block_cells, blocks, created) "
                        "VALUES (?, ?, ?, ?, ?, ?)",
                        (key, process, cells, block_cells, blocks, now),
                    )
                at_work = known is not None and known["owner"] is not None
                state, started, finished = "accepted", None, None
                if at_work:
                    state, started = "running", now
                if known is not None:  # it may have been cut when blocks were of another size
                    blocks = known["blocks"]
            else:
                state, started, finished = "successful", now, now
            database.execute(
                "INSERT INTO jobs (id, key, process, state, cells, blocks, created, started, "
                "finished, seconds) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                (number, key, process, state, cells, blocks, now, started, finished,
                 finished_seconds),
            )  # fmt: skip
        job = self.job(number)
        assert job is not None
        return job

    def job(self, number: str) -> Job | None:
        """Return a job, or None if there is no such job."""
        rows = self._read(f"{_JOB} WHERE jobs.id = ?", number)
        return _job(rows[0]) if rows else None

    def jobs(self, wanted: Wanted | None = None, *, limit: int, offset: int = 0) -> list[Job]:
        """Return jobs, the latest first."""
        wanted = wanted or Wanted()
        rows = self._read(
            f"{_JOB} {_WANTED} ORDER BY jobs.created DESC, jobs.id LIMIT ?8 OFFSET ?9",
            json.dumps(wanted.processes), json.dumps(wanted.states), *wanted.created,
            time.time(), *wanted.seconds, limit, offset,
        )  # fmt: skip
        return [_job(row) for row in rows]

    def dismiss(self, number: str) -> Job | None:
        """Dismiss a job; work that no other job waits for is given up. None if there is none."""
        with self._changing() as database:
            row = database.execute("SELECT key FROM jobs WHERE id = ?", (number,)).fetchone()
            if row is None:
                return None
            database.execute(
                "UPDATE jobs SET state = 'dismissed', finished = coalesce(finished, ?), "
                "problem = NULL WHERE id = ?",
                (time.time(), number),
            )
            database.execute(
                "DELETE FROM work WHERE key = ?1 AND NOT EXISTS "
                "(SELECT 1 FROM jobs WHERE key = ?1 AND state IN ('accepted', 'running'))",
                (row["key"],),
            )
        return self.job(number)

    def counts(self) -> dict[str, int]:
        """Return how many jobs there are in each state."""
        rows = self._read("SELECT state, count(*) AS count FROM jobs GROUP BY state")
        return dict.fromkeys(STATES, 0) | {row["state"]: row["count"] for row in rows}

    # --- what servers do

    def claim(self, owner: str, lease_seconds: float) -> Work | None:
        """Take the lease of the item of work that has waited longest; None if none is free."""
        now = time.time()
        with self._changing() as database:
            row = database.execute(
                "SELECT * FROM work WHERE owner IS NULL OR lease < ? ORDER BY created LIMIT 1",
                (now,),
            ).fetchone()
            if row is None:
                return None
            database.execute(
                "UPDATE work SET owner = ?, lease = ? WHERE key = ?",
                (owner, now + lease_seconds, row["key"]),
            )
            database.execute(
                "UPDATE jobs SET state = 'running', started = ? "
                "WHERE key = ? AND state = 'accepted'",
                (now, row["key"]),
            )
        return Work(*(row[name] for name in ("key", "process", "block_cells", "blocks", "seconds")))

    def renew(self, key: str, owner: str, lease_seconds: float) -> bool:
        """Renew a lease; False if it has been lost, or the work is wanted no more."""
        with self._changing() as database:
            changed = database.execute(
                "UPDATE work SET lease = ? WHERE key = ? AND owner = ?",
                (time.time() + lease_seconds, key, owner),
            )
            return changed.rowcount == 1

    def advance(self, key: str, owner: str, *, done: int, seconds: float) -> None:
        """Note how many blocks are done, and time spent since the last note."""
        with self._changing() as database:
            database.execute(
                "UPDATE work SET done = ?, seconds = seconds + ? WHERE key = ? AND owner = ?",
                (done, seconds, key, owner),
            )

    def succeed(self, key: str, owner: str) -> None:
        """Note that an item of work is done; its result is on the disk."""
        self._end(key, owner, "successful", None)

    def fail(self, key: str, owner: str, problem: Mapping[str, Any]) -> None:
        """Note that an item of work cannot be done, and why."""
        self._end(key, owner, "failed", json.dumps(dict(problem)))

    def _end(self, key: str, owner: str, state: str, problem: str | None) -> None:
        with self._changing() as database:
            row = database.execute(
                "DELETE FROM work WHERE key = ? AND owner = ? RETURNING seconds", (key, owner)
            ).fetchone()
            if row is not None:
                database.execute(
                    "UPDATE jobs SET state = ?, finished = ?, seconds = ?, problem = ? "
                    "WHERE key = ? AND state IN ('accepted', 'running')",
                    (state, time.time(), row["seconds"], problem, key),
                )

    def release(self, owner: str | None) -> None:
        """Give up the leases of an owner, or of all: another server, or the next, goes on."""
        with self._changing() as database:
            database.execute(
                "UPDATE work SET owner = NULL, lease = 0 WHERE owner = ?1 OR ?1 IS NULL", (owner,)
            )

    def release_one(self, key: str, owner: str) -> None:
        """Give up one lease."""
        with self._changing() as database:
            database.execute(
                "UPDATE work SET owner = NULL, lease = 0 WHERE key = ? AND owner = ?", (key, owner)
            )

    def wanted(self) -> set[str]:
        """Return the keys of all items of work."""
        return {row["key"] for row in self._read("SELECT key FROM work")}

    def forget(self, before: float) -> None:
        """Remove the jobs that were finished before a time."""
        with self._changing() as database:
            database.execute("DELETE FROM jobs WHERE finished < ?", (before,))


def _job(row: sqlite3.Row) -> Job:
    over = row["state"] not in ACTIVE
    return Job(
        id=row["id"],
        key=row["key"],
        process=row["process"],
        state=row["state"],
        cells=row["cells"],
        blocks=row["blocks"],
        done=row["blocks"] if row["state"] == "successful" else row["done"],
        created=row["created"],
        started=row["started"],
        finished=row["finished"],
        seconds=(row["seconds"] or 0.0) if over else row["spent"],
        problem=json.loads(row["problem"]) if row["problem"] else None,
    )
