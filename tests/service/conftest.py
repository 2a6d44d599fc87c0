"""A server of one's own, run as users run it, and the tools that are not ours."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from services import Service, absent, services


@pytest.fixture(scope="session")
def find_tool() -> Callable[[str | Path, str], str]:
    """Return a function that finds a program, or skips with a reason."""

    def find(program: str | Path, reason: str) -> str:
        return shutil.which(program) or absent(reason)

    return find


@pytest.fixture(scope="session")
def curl(find_tool: Callable[[str | Path, str], str]) -> str:
    return find_tool("curl", "curl is not installed")


@pytest.fixture(scope="module")
def serve(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[..., Service]]:
    """Return a function that starts a service of one's own with settings."""
    with services(tmp_path_factory) as start:
        yield start


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Return the address of a service that all clients share, as they do in life."""
    with services(tmp_path_factory) as start:
        yield start(workers=2).address
