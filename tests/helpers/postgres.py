"""Debian's PostgreSQL, started on loopback in a folder of its own."""

import itertools
import os
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psycopg
from sqlalchemy import URL

from benchmarks.serving import free_port
from waiting import PATIENCE, wait_for

PASSWORD = "very-secret"


class Postgres:
    """A server that can be stopped, killed and started again, on the same port."""

    def __init__(self, programs: Path, folder: Path):
        self._programs, self._folder, self._data = programs, folder, folder / "data"
        self.port, self._numbers = free_port(), itertools.count()
        is_root = os.geteuid() == 0  # whose server it refuses to be
        self._how: dict[str, Any] = {
            "cwd": folder, "stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL,
            "stderr": subprocess.DEVNULL,
            **({"user": "postgres", "group": "postgres"} if is_root else {}),
        }  # fmt: skip
        word = folder / "password"
        word.write_text(PASSWORD)
        for path in (folder, word) if is_root else ():
            shutil.chown(path, "postgres", "postgres")
        options = ["--username=vibrafeed", "--encoding=UTF8", "--auth=scram-sha-256", "--no-sync"]
        command = [programs / "initdb", "--pgdata", self._data, f"--pwfile={word}", *options]
        subprocess.run(command, check=True, **self._how)

    def url(self, database: str) -> str:
        """Return the URL of a database."""
        return URL.create(
            "postgresql", "vibrafeed", PASSWORD, "127.0.0.1", self.port, database
        ).render_as_string(hide_password=False)

    def new_database(self) -> str:
        """Make an empty database; return its URL."""
        name = f"ledger{next(self._numbers)}"
        with psycopg.connect(self.url("postgres"), autocommit=True) as connection:
            connection.execute(f"CREATE DATABASE {name}".encode())
        return self.url(name)

    def start(self) -> None:
        """Start it, and wait until it answers."""
        self._process = subprocess.Popen(
            [self._programs / "postgres", "-D", self._data, "-p", str(self.port),
             "-c", "listen_addresses=127.0.0.1", "-c", "fsync=off", "-k", self._folder],
            **self._how,
        )  # fmt: skip

        def answers() -> bool:
            assert self._process.poll() is None
            try:
                psycopg.connect(self.url("postgres")).close()
            except psycopg.OperationalError:
                return False
            return True

        wait_for(answers)

    def stop(self, how: signal.Signals = signal.SIGINT) -> None:
        """Stop it; `SIGQUIT` is what a crash does."""
        self._process.send_signal(how)
        self._process.wait(PATIENCE)


def programs() -> Path | None:
    """Return the folder of PostgreSQL's programs, the newest; None if there are none."""
    found = [path.parent for path in Path("/usr/lib/postgresql").glob("*/bin/pg_ctl")]
    return max(found, key=lambda path: int(path.parent.name), default=None)


@contextmanager
def running(folder: Path) -> Iterator[Postgres]:
    """Run a server while this is open; `folder` holds the programs."""
    # In the folder for all: another user has to get there.
    with tempfile.TemporaryDirectory(prefix="vibrafeed-postgres-") as name:
        server = Postgres(folder, Path(name))
        server.start()
        try:
            yield server
        finally:
            server.stop(signal.SIGQUIT)  # nobody needs its data any more
