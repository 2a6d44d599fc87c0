"""A server of one's own, run as users run it, and the tools that are not ours."""

from collections.abc import Callable, Iterator

import pytest

import postgres
from services import Server, services
from tools import absent, tool


@pytest.fixture(scope="session")
def curl() -> str:
    return tool("curl")


@pytest.fixture(scope="module")
def serve(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[..., Server]]:
    """Return a function that starts a service of one's own with settings."""
    with services(tmp_path_factory) as start:
        yield start


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """Yield a service that all clients share, as they do in life."""
    with services(tmp_path_factory) as start:
        yield start(workers=2)


@pytest.fixture(scope="session")
def server(shared: Server) -> str:
    """Return the address of the service that all clients share."""
    return shared.address


@pytest.fixture(scope="session")
def postgresql() -> Iterator[postgres.Postgres]:
    """Debian's PostgreSQL, on loopback; tests that stop it start it again."""
    programs = postgres.programs()
    if programs is None:
        absent("PostgreSQL is not installed")
    with postgres.running(programs) as server:
        yield server
