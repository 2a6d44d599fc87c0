"""Debian's PostgreSQL, started on loopback in a folder of its own."""

from __future__ import annotations

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
        self._programs, self._folder = programs, folder
        self._data = folder / "data"
        self.port = free_port()
        self._count = 0
        word = folder / "password"
        word.write_text(PASSWORD)
        self._own(folder, word)
        self._run("initdb", "--pgdata", self._data, "--username=vibrafeed", "--encoding=UTF8",
                  "--auth=scram-sha-256", f"--pwfile={word}", "--no-sync")  # fmt: skip

    def url(self, database: str) -> str:
        """Return the URL of a database."""
        return URL.create(
            "postgresql", "vibrafeed", PASSWORD, "127.0.0.1", self.port, database
        ).render_as_string(hide_password=False)

    def new_database(self) -> str:
        """Make an empty database; return its URL."""
        self._count += 1
        name = f"ledger{self._count}"
        with psycopg.connect(self.url("postgres"), autocommit=True) as connection:
            connection.execute(f"CREATE DATABASE {name}".encode())
        return self.url(name)

    def start(self) -> None:
        """Start it, and wait until it answers."""
        self._process = subprocess.Popen(
            [self._programs / "postgres", "-D", self._data, "-p", str(self.port),
             "-c", "listen_addresses=127.0.0.1", "-c", "fsync=off", "-k", self._folder],
            cwd=self._folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL, **self._user(),
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

    def _own(self, *paths: Path) -> None:
        if os.geteuid() == 0:
            for path in paths:
                shutil.chown(path, "postgres", "postgres")

    def _user(self) -> dict[str, Any]:
        """Return as whom to run it: it refuses to be root's."""
        return {"user": "postgres", "group": "postgres"} if os.geteuid() == 0 else {}

    def _run(self, program: str, *arguments: str | Path) -> None:
        subprocess.run(
            [self._programs / program, *arguments], check=True, cwd=self._folder,
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            **self._user(),
        )  # fmt: skip


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
