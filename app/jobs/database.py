"""The database of the ledger: an SQLite file, or PostgreSQL; one transaction at a time in both.

Every transaction is committed to the disk before it returns. A method that reads before it writes
is right if nobody else writes meanwhile, so that is what `Database.transaction` promises, of all
threads and servers:

- SQLite: `BEGIN IMMEDIATE` takes the lock for writing at the start. With a plain `BEGIN` the lock
  is taken at the first change, and fails if somebody else has changed what was read.
- PostgreSQL: a lock with a number of our own, which the transaction takes before it reads and which
  ends with it. `READ COMMITTED` lets each statement see all that was committed before it, so what
  stood under the lock before is seen. Row locks (`FOR UPDATE SKIP LOCKED`) would let servers claim
  at the same time, but not keep two posts from promising the same room. One writer at a time is
  no loss: transactions take milliseconds and there are a few for each block of some second.

What reads only takes no lock, and sees what has been committed.
"""

from __future__ import annotations

import errno
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from filelock import FileLock
from sqlalchemy import URL, Connection, Engine, Row, create_engine, event, exc, inspect, make_url
from sqlalchemy.sql.expression import Select

from vibrafeed.app.jobs.errors import DamagedLedgerError, LaterLedgerError, LostLedgerError
from vibrafeed.app.jobs.tables import UPGRADES, VERSION, WORDS

PATIENCE = 30  # s that a transaction waits for another process to end its own
# A server that hangs, or whose machine is gone, gives up the lock after so long.
HANGS = 60  # s
LOCK = int.from_bytes(b"vibrafee")  # the number of the lock in PostgreSQL

BEGIN = {
    "sqlite": ("BEGIN IMMEDIATE",),
    "postgresql": (
        "BEGIN ISOLATION LEVEL READ COMMITTED READ WRITE",
        f"SELECT pg_advisory_xact_lock({LOCK})",
    ),
}
# Set in each new connection. On the disk before the reply, whatever the server's default is.
SET = {
    "sqlite": ("PRAGMA synchronous = FULL",),
    "postgresql": (
        "SET synchronous_commit = on",
        f"SET lock_timeout = '{PATIENCE}s'",
        f"SET idle_in_transaction_session_timeout = '{HANGS}s'",
    ),
}
# Of libpq, unless the URL says otherwise: a machine that is gone is noticed within seconds.
CONNECT: dict[str, dict[str, Any]] = {
    "sqlite": {"timeout": PATIENCE},
    "postgresql": {
        "connect_timeout": 10,
        "keepalives_idle": 10,
        "keepalives_interval": 5,
        "keepalives_count": 3,
        "tcp_user_timeout": 20_000,  # ms
        "application_name": "vibrafeed",
    },
}
# What PostgreSQL reports, by the beginning of its codes, as the errors that files have.
FAILURES = {
    "53100": errno.ENOSPC,
    "25006": errno.EROFS,
    "55P03": errno.EAGAIN,  # the lock was not to be had
    "40": errno.EAGAIN,
}
LOST = ("08", "57P", "53300", "25P03")
DAMAGED = ("XX001", "XX002")
MALFORMED = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)


class Database:
    """A database with the tables of the ledger, which are made or brought up to date at first use.

    Its methods may be called from any thread.

    Parameters
    ----------
    location : Path or str
        An SQLite file, or the URL of a database.

    Attributes
    ----------
    is_damaged : bool
        True once a read or a change has found the database damaged.
    """

    def __init__(self, location: Path | str):
        """Note the SQLite file or the URL of the database; connect on first use."""
        url = (
            make_url(location)
            if isinstance(location, str)
            else URL.create("sqlite", database=f"{location}")
        )
        self.kind = url.get_backend_name()
        self._file = Path(url.database or "") if self.kind == "sqlite" else None
        if self.kind == "postgresql":
            url = url.set(drivername="postgresql+psycopg")
        self._url = url
        self._lock = threading.RLock()  # threads take turns here, not by each a connection
        self._of_thread = threading.local()  # the connection of a thread that is in a transaction
        self._opened: Engine | None = None
        self.is_damaged = False

    def close(self) -> None:
        """Close all connections to the database; the next use opens new ones."""
        with self._lock:
            if self._opened is not None:
                self._opened.dispose()
                self._opened = None

    @contextmanager
    def transaction(self) -> Iterator[Connection]:
        """Run the block in one write transaction; no other process changes the ledger meanwhile.

        Yield the connection. Transactions and reads of the same thread inside the block are part of
        it.

        Raises
        ------
        sqlite3.Error
            If SQLite fails.
        OSError
            If a remote database cannot be reached, is full, read-only, or locked for too long.
        """
        own = getattr(self._of_thread, "connection", None)
        if own is not None:
            yield own  # this thread is in a transaction already
            return
        with self._lock, self._plain_errors(), self._engine().begin() as connection:
            for statement in BEGIN[self.kind]:
                connection.exec_driver_sql(statement)
            self._of_thread.connection = connection
            try:
                yield connection
            finally:
                self._of_thread.connection = None

    def read(self, statement: Select[*tuple[Any, ...]]) -> list[Row[*tuple[Any, ...]]]:
        """Return the rows of a query, which is part of this thread's transaction if there is one.

        Raises `sqlite3.Error` or `OSError` if the database fails.
        """
        own = getattr(self._of_thread, "connection", None)
        if own is not None:
            return list(own.execute(statement))
        with self._plain_errors(), self._engine().connect() as connection:
            return list(connection.execute(statement))

    def check(self) -> None:
        """Raise `DamagedLedgerError` if an SQLite file is damaged; every page of it is read."""
        if self._file is not None:
            with self._plain_errors(), self._engine().connect() as connection:
                verdict = connection.exec_driver_sql("PRAGMA quick_check(1)").scalar_one()
            if verdict != "ok":
                self.is_damaged = True
                raise DamagedLedgerError(verdict)

    def _engine(self) -> Engine:
        """Return the SQLAlchemy engine; at first use create it, and the tables of the ledger."""
        engine = self._opened
        if engine is not None:  # a read does not wait for a transaction, which holds the lock
            return engine
        with self._lock:
            if self._opened is None:
                engine = self._new_engine()
                try:
                    if self._file is None:
                        self._upgrade(engine)
                    else:
                        self._create_file(engine, self._file)
                except BaseException:
                    engine.dispose()
                    raise
                self._opened = engine
            return self._opened

    def _new_engine(self) -> Engine:
        defaults = CONNECT[self.kind].items()
        arguments = {name: value for name, value in defaults if name not in self._url.query}
        # AUTOCOMMIT: who reads has no transaction, who changes something begins one in words.
        engine = create_engine(
            self._url,
            isolation_level="AUTOCOMMIT",
            connect_args=arguments,
            pool_pre_ping=self.kind != "sqlite",  # after a restart of the database
            max_overflow=20,
            hide_parameters=True,
        )

        @event.listens_for(engine, "connect")
        def _(connection: Any, record: object) -> None:
            """Set the options of a new connection; SQLAlchemy calls it."""
            cursor = connection.cursor()
            for statement in SET[self.kind]:
                cursor.execute(statement)
            cursor.close()

        return engine

    def _create_file(self, engine: Engine, file: Path) -> None:
        """Create the SQLite file in WAL mode (write-ahead log) and its tables."""
        file.parent.mkdir(parents=True, exist_ok=True)
        # Making a new file one for WAL does not wait for another process that does so.
        with FileLock(file.with_name(".ledger.lock")):
            with engine.connect() as connection:
                connection.exec_driver_sql("PRAGMA journal_mode = WAL")
            self._upgrade(engine)

    def _upgrade(self, engine: Engine) -> None:
        """Create the tables of the ledger or upgrade them to this version, in one transaction.

        Nothing changes if they are of this version already. Raises `LaterLedgerError` if a later
        version of vibrafeed made them. `engine` is SQLAlchemy's.
        """
        with engine.begin() as connection:
            for statement in BEGIN[self.kind]:
                connection.exec_driver_sql(statement)
            if not inspect(connection).has_table(VERSION.name):
                VERSION.create(connection)
                connection.execute(VERSION.insert().values(version=0))
            version = connection.execute(VERSION.select()).scalar_one()
            if version > len(UPGRADES):
                raise LaterLedgerError(
                    f"the tables of the job database have version {version}, made by a later "
                    f"vibrafeed; this vibrafeed reads up to version {len(UPGRADES)}: update it"
                )
            for upgrade in UPGRADES[version:]:
                for statement in upgrade:
                    connection.exec_driver_sql(statement.format(**WORDS[self.kind]))
            if version < len(UPGRADES):
                connection.execute(VERSION.update().values(version=len(UPGRADES)))

    @contextmanager
    def _plain_errors(self) -> Iterator[None]:
        # SQLAlchemy's errors become `sqlite3.Error` or, of a remote database, `OSError`: so callers
        # treat it as they treat a failing disk.
        try:
            yield
        except exc.TimeoutError as error:
            raise OSError(
                errno.EAGAIN, "all connections to the job database are in use; try again later"
            ) from error
        except exc.DBAPIError as error:
            plain = _plain_error(error)
            self.is_damaged |= isinstance(plain, DamagedLedgerError)
            if plain is None:
                raise
            raise plain from error


def _plain_error(error: exc.DBAPIError) -> Exception | None:
    cause = error.orig
    if isinstance(cause, sqlite3.Error):
        # The lowest byte; those above say what exactly was malformed.
        is_damaged = getattr(cause, "sqlite_errorcode", 0) & 0xFF in MALFORMED
        return DamagedLedgerError(str(cause)) if is_damaged else cause
    code = getattr(cause, "sqlstate", None) or ""
    if code in DAMAGED:
        return DamagedLedgerError(str(cause))
    for beginning, number in FAILURES.items():
        if code.startswith(beginning):
            return OSError(number, str(cause))
    is_refusal = not code and type(cause).__name__ == "OperationalError"
    if error.connection_invalidated or is_refusal or code.startswith(LOST):
        return LostLedgerError(str(cause))
    return None
