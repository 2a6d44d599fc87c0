"""The ledger in SQLite."""

import pytest

from ledger_laws import *  # noqa: F403
from ledger_laws import made_at_once
from vibrafeed.app.jobs.ledger import Ledger


@pytest.fixture
def ledgers(tmp_path):
    """Two servers' views of one ledger."""
    pair = [Ledger(tmp_path / "jobs.sqlite3") for _ in range(2)]
    yield pair
    for ledger in pair:
        ledger.close()


def test_who_makes_a_ledger_at_the_same_moment_waits_for_the_other(tmp_path):
    """SQLite does not wait: without a lock of ours every fifth of these opens failed."""
    for number in range(5):
        made_at_once(tmp_path / str(number) / "jobs.sqlite3")
