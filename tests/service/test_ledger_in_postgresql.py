"""The ledger in PostgreSQL, which may be away for a while."""

import signal

import pytest

from ledger_laws import *  # noqa: F403
from ledger_laws import LEASE, made_at_once, post
from postgres import PASSWORD
from vibrafeed.app.jobs.errors import LostLedgerError
from vibrafeed.app.jobs.ledger import Ledger


@pytest.fixture
def ledgers(postgresql):
    """Two servers' views of one ledger."""
    where = postgresql.new_database()
    pair = [Ledger(where) for _ in range(2)]
    yield pair
    for ledger in pair:
        ledger.close()


def test_servers_that_make_the_tables_of_one_database_at_the_same_moment(postgresql):
    for counts in made_at_once(postgresql.new_database()):
        assert not any(counts.values())


def test_what_is_away_for_a_while_is_told_and_loses_nothing(ledgers, postgresql):
    """Also what hung on a connection of before, and after a crash of the database."""
    ledger, _ = ledgers
    job = post(ledger)
    work = ledger.claim("a", LEASE)
    for how in (signal.SIGINT, signal.SIGQUIT):
        postgresql.stop(how)
        try:
            assert ledger.fault() == "The database of the ledger cannot be reached."
            for call in (ledger.counts, lambda: ledger.renew(work, LEASE)):
                with pytest.raises(LostLedgerError) as lost:
                    call()
                assert PASSWORD not in str(lost.getrepr(chain=True, showlocals=False))
        finally:
            postgresql.start()
        assert ledger.fault() is None
        assert ledger.holds(work)
    ledger.end(work, None, 1)
    assert ledger.job(job.id).state == "successful"


def test_a_transaction_that_loses_its_database_changes_nothing(ledgers, postgresql):
    ledger, other = ledgers

    def cut():
        with ledger.transaction():
            post(ledger, "k")
            postgresql.stop(signal.SIGQUIT)
            postgresql.start()
            post(ledger, "l")

    with pytest.raises(LostLedgerError):
        cut()
    assert other.promised() == {}
    assert post(ledger, "m").state == "accepted"
