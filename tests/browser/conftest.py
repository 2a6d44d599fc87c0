"""A server, once for all tests that one process runs, and a browser, once for those of a file."""

from __future__ import annotations

import pytest

from benchmarks.browsing import browsed
from benchmarks.serving import served
from tools import tool
from waiting import PATIENCE


@pytest.fixture(scope="session")
def address():
    with served(workers=1) as server:
        yield server.address


@pytest.fixture(scope="module")
def browser():  # not longer: while it runs, so does an event loop, and there may be no other
    tool("chromium")
    from playwright.sync_api import expect

    expect.set_options(timeout=1000 * PATIENCE)  # ms; a busy machine takes its time
    with browsed() as context:
        yield context


@pytest.fixture
def page(browser):
    """A new page; at the end it has asked nobody else for anything, and complained of nothing.

    Motions stand still at first, as for who asks for reduced motion: to play them takes longer than
    all else that most tests do.
    """
    found = browser.new_page()
    found.emulate_media(reduced_motion="reduce")
    asked: list[str] = []
    complaints: list[str] = []
    found.on("request", lambda request: asked.append(request.url))
    found.on("console", lambda message: complaints.append(message.text))
    found.on("pageerror", lambda error: complaints.append(f"{error}\n{error.stack}"))
    found.set_default_timeout(1000 * PATIENCE)
    yield found
    found.close()
    local = ("http://127.0.0.1:", "data:", "blob:")
    assert all(url.startswith(local) for url in asked), asked
    # A refusal is told by the page; the browser tells it as well.
    left = [text for text in complaints if not text.startswith("Failed to load resource")]
    assert left == []
