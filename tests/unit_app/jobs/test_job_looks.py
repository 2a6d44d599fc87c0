"""Clients that wait for jobs share looks at the ledger."""

from __future__ import annotations

import asyncio

import pytest

from vibrafeed.app.jobs.job_looks import JobLooks
from vibrafeed.app.jobs.ledger import Ledger


@pytest.fixture
def ledger(tmp_path):
    ledger = Ledger(tmp_path / "jobs.sqlite3")
    yield ledger
    ledger.close()


def posted(ledger, key):
    values = {"cells": 1, "block_cells": 1, "blocks": 1, "bytes_": 1, "finished_seconds": None}
    return ledger.post(key, "sweep", **values)


def test_hundreds_who_ask_cost_one_query(ledger, monkeypatch):
    jobs = [posted(ledger, key * 64) for key in "ab"]
    asked = []
    plain = ledger.by_number
    monkeypatch.setattr(ledger, "by_number", lambda n: (asked.append(n), plain(n))[1])

    async def main():
        looks = JobLooks(ledger)
        numbers = [job.id for job in jobs] * 100 + ["none"]
        gone = asyncio.create_task(looks.job(jobs[0].id))
        await asyncio.sleep(0)
        gone.cancel()  # whoever leaves takes nobody along
        return await asyncio.gather(*map(looks.job, numbers))

    found = asyncio.run(main())
    assert found == jobs * 100 + [None]
    assert asked == [[jobs[0].id, jobs[1].id, "none"]]


def test_who_asks_later_sees_what_has_changed_and_errors_are_told_to_all(ledger, monkeypatch):
    job = posted(ledger, "a" * 64)

    async def main():
        looks = JobLooks(ledger)
        before = await looks.job(job.id)
        ledger.dismiss(job.id)
        after = await looks.job(job.id)
        monkeypatch.setattr(ledger, "by_number", lambda numbers: (_ for _ in ()).throw(OSError(5)))
        errors = await asyncio.gather(looks.job(job.id), looks.job("b"), return_exceptions=True)
        return before.state, after.state, [type(error) for error in errors]

    assert asyncio.run(main()) == ("accepted", "dismissed", [OSError, OSError])
