"""The ledger in SQLite."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from ledger_laws import *  # noqa: F403
from vibrafeed.app.jobs.ledger import Ledger
from waiting import PATIENCE


@pytest.fixture
def ledgers(tmp_path):
    """Two servers' views of one ledger."""
    pair = [Ledger(tmp_path / "jobs.sqlite3") for _ in range(2)]
    yield pair
    for ledger in pair:
        ledger.close()


def test_who_makes_a_ledger_at_the_same_moment_waits_for_the_other(tmp_path):
    """SQLite does not wait: without a lock of ours every fifth of these opens failed."""
    barrier = threading.Barrier(3)

    def use(path):
        ledger = Ledger(path)
        barrier.wait(PATIENCE)
        try:
            ledger.counts()
        finally:
            ledger.close()

    with ThreadPoolExecutor(3) as pool:
        for number in range(15):
            paths = [tmp_path / str(number) / "jobs.sqlite3"] * 3
            list(pool.map(use, paths))
