"""Jobs survive what kills a server, its workers or its database, and free their workers.

By night there are 20 kills; ``KILLS`` says how many else. With ``LEDGER=postgresql`` the
ledger of each test is a database of Debian's PostgreSQL.
"""

import os
import random
import signal
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from disasters import expected, fill, read_only, simulation, small, small_disk
from night import count
from postgres import PASSWORD
from services import QUICK, refusal, serving

KILLS = count(2, 20, "KILLS")
JOBS = 3 if KILLS <= 4 else 8
SIZE = 51 if KILLS <= 4 else 301  # of two axes: the last kill is to meet work
# Some bytes that ask for hours: a part that hops and never repeats, by the method that is slowest.
HOURS = {
    **small(amplitude="2.1 mm", beta=41, restitution=0.6),
    "method": "reference",
    "max_periods": 100_000,
}


@pytest.fixture
def settings():
    """Return settings of the service of a test."""
    return {**QUICK}


@pytest.fixture(autouse=os.environ.get("LEDGER") == "postgresql")
def in_postgresql(postgresql, settings):
    """Keep the ledger of a test in PostgreSQL."""
    settings["ledger_url"] = postgresql.new_database()
    return postgresql


@pytest.mark.timeout(1800 + 100 * KILLS)
def test_jobs_survive_kills_of_server_and_workers(settings, tmp_path):
    """No job is lost or wrong, no file is torn, nothing is left behind."""
    chance = random.Random(7)
    studies = [simulation(number, SIZE) for number in range(JOBS)]
    with serving(tmp_path, **settings) as server:
        with ThreadPoolExecutor(JOBS) as pool:
            numbers = list(pool.map(server.post, studies))
        for kill in range(KILLS):
            time.sleep(chance.uniform(0.2, 3.0))
            workers = server.workers()
            if kill % 2 and workers:
                chance.choice(workers).kill()
            else:
                server.kill()
                server.launch()
        before = {server.job(number)["status"] for number in numbers}
        assert before & {"accepted", "running"}
        jobs = [server.finished(number) for number in numbers]
        assert [job["status"] for job in jobs] == ["successful"] * JOBS, jobs
        contents = [server.dataset(number) for number in numbers]
        server.kill()
        server.launch()
        assert len(server.get("/jobs")["jobs"]) == JOBS
    left = {path.suffix for path in (tmp_path / "data").rglob("*")}
    assert not left & {".part", ".block"}
    for study, content in zip(studies, contents, strict=True):
        assert content == expected(study, tmp_path / "whole.nc")


def test_a_database_that_is_restarted_under_jobs_loses_none(settings, tmp_path, in_postgresql):
    """Stopped, crashed, and crashed at the same time as the server."""
    studies = [simulation(number) for number in range(2)]
    with serving(tmp_path, **settings, workers=1) as server:
        numbers = [server.post(study) for study in studies]
        server.begun(numbers[-1])  # the first may be over before the last is posted
        in_postgresql.stop()
        try:
            told = refusal(lambda: server.ask("/readyz"), 503)["errors"]
            assert "The database of the ledger cannot be reached." in str(told)
            refusal(lambda: server.job(numbers[0]), 503)
        finally:
            in_postgresql.start()
        states = {server.job(number)["status"] for number in numbers}
        assert states <= {"accepted", "running", "successful"}
        in_postgresql.stop(signal.SIGQUIT)
        server.kill()
        in_postgresql.start()
        server.launch()
        jobs = [server.finished(number) for number in numbers]
        assert [job["status"] for job in jobs] == ["successful"] * 2, jobs
        for study, number in zip(studies, numbers, strict=True):
            assert server.dataset(number) == expected(study, tmp_path / "whole.nc")
    assert not (tmp_path / "data" / "jobs.sqlite3").exists()
    assert PASSWORD not in server.log.read_text()


def test_a_full_and_a_read_only_disk_are_told_and_lose_nothing(settings, tmp_path):
    data = tmp_path / "data"
    first, second, third, fourth = (
        {**simulation(0), "parameters": {**simulation(n)["parameters"], "beta": 30}}
        for n in range(4)
    )
    with small_disk(data, 3), serving(tmp_path, **settings, workers=1) as server:
        done = server.post(first)
        assert server.finished(done)["status"] == "successful"
        kept = server.dataset(done)
        # What would not fit is refused before anything is computed.
        large = {**simulation(1)["parameters"], "gamma": {"start": 0, "stop": 5, "num": 90}}
        large = {**simulation(1), "parameters": large}
        refusal(lambda: server.post(large), 507, "problem:storage")
        # The disk fills up while a job is under way.
        number = server.post(second)
        filler = fill(data)
        refusal(lambda: server.post(third), 507, "problem:storage")
        refusal(lambda: server.ask("/readyz"), 503)
        assert server.dataset(done) == kept
        filler.unlink()
        # It has failed and says why, or it has waited for room.
        job = server.finished(number)
        assert job["status"] == "successful" or "The disk is full" in job["message"]
        for study in (third, second):
            assert server.finished(server.post(study))["status"] == "successful"
        with read_only(data):
            told = refusal(lambda: server.post(fourth), 507)
            assert told["detail"].startswith("The data directory is read-only")
            refusal(lambda: server.ask("/readyz"), 503)
            assert server.dataset(done) == kept
        assert server.finished(server.post(fourth))["status"] == "successful"


def test_work_that_is_dismissed_or_over_its_time_frees_its_worker(settings, tmp_path):
    """However long a cell takes."""
    with serving(tmp_path, **settings, workers=1, max_job_seconds=8) as server:
        long = server.post(HOURS)
        server.waited(long, lambda job: job["status"] == "running")
        # What is short does not wait for it.
        assert server.finished(server.post(small()))["status"] == "successful"
        over = server.finished(long)
        assert over["status"] == "failed"
        assert "longer than this service allows" in over["message"]
        long = server.post({**HOURS, "max_periods": 99_999})
        server.waited(long, lambda job: job["status"] == "running")
        time.sleep(2)  # the worker is amid the cell
        server.ask(f"/jobs/{long}", method="DELETE")
        assert server.finished(server.post(small(60)))["status"] == "successful"
        assert server.job(long)["status"] == "dismissed"
