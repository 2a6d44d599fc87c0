"""What a user has: the command in an empty folder, and one service for all journeys."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from services import Service, services

Typed = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def vibrafeed(tmp_path: Path) -> Typed:
    """Return a function that runs the command in an empty folder, and checks its exit code."""

    def run(*arguments: object, exit_code: int = 0) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            [sys.executable, "-m", "vibrafeed", *map(str, arguments)],
            cwd=tmp_path,
            env={**os.environ, "PYTHONUTF8": "1", "NO_COLOR": "1", "COLUMNS": "200"},
            capture_output=True,
            encoding="utf-8",
            check=False,
        )
        assert done.returncode == exit_code, done.stdout + done.stderr
        return done

    return run


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """Yield a service that the journeys over HTTP share, as its users do."""
    with services(tmp_path_factory) as start:
        yield start(workers=2)
