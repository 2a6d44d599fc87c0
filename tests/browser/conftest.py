"""A server, once for all tests that one process runs, and a browser, once for those of a file."""

from __future__ import annotations

import pytest

from benchmarks.browsing import browsed
from benchmarks.serving import served
from looking import watched
from tools import tool


@pytest.fixture(scope="session")
def server():
    with served(workers=1) as found:
        yield found


@pytest.fixture(scope="session")
def address(server):
    return server.address


@pytest.fixture(scope="module")
def browser():  # not longer: while it runs, so does an event loop, and there may be no other
    tool("chromium")
    with browsed() as context:
        yield context


@pytest.fixture
def page(browser):
    with watched(browser) as found:
        yield found
