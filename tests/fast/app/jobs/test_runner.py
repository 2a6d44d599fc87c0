"""What carries out work, with workers that do as they are told."""

from __future__ import annotations

import asyncio
import errno
import sqlite3
import threading
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any

import pytest

from vibrafeed.app.jobs import work
from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.dispatcher import MAX_DEATHS, MAX_TORN
from vibrafeed.app.jobs.errors import OtherVersionError, TornBlockError
from vibrafeed.app.jobs.fair_queue import FairQueue
from vibrafeed.app.jobs.ledger import ACTIVE, Job, Ledger
from vibrafeed.app.jobs.process_pool import EndedError, LostError
from vibrafeed.app.jobs.runner import Runner
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.jobs.work import task_of
from vibrafeed.app.settings import Settings
from vibrafeed.core.intake import prepare_content
from waiting import PATIENCE, awaited

STUDY = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity"],
    "parameters": {
        "frequency": 50,
        "amplitude": {"start": "0.1 mm", "stop": "0.4 mm", "num": 4},
        "beta": 30,
        "friction": 0.4,
    },
}


class Workers:
    """Stands for the processes; `instead` takes the place of functions by their names."""

    def __init__(self, **instead: Callable[..., Any]):
        self.instead, self.calls = instead, []
        self.fair_queue = FairQueue(3)
        self.trouble: str | None = None
        self.given_up: list[str] = []
        self.cut_off: list[str] = []

    async def prepare(self) -> None:
        if self.trouble is not None:
            raise LostError(self.trouble)

    async def __call__(
        self, function: Any, *arguments: Any, began: Callable[[], Any], grace: float
    ) -> Any:
        name = function.__name__
        self.calls.append(name)
        call = asyncio.create_task(
            asyncio.to_thread(self.instead.get(name) or function, *arguments)
        )
        await began()
        try:
            return await asyncio.shield(call)
        except asyncio.CancelledError:
            self.given_up.append(name)
            if not (await asyncio.wait({call}, timeout=grace))[0]:
                self.cut_off.append(name)
            raise

    def close(self) -> None:
        pass


Play = Callable[[Runner, Admission, Job], Coroutine[Any, Any, None]]


def carried_out(folder: Path, workers: Workers, play: Play | None = None, **settings: Any) -> Job:
    """Post a job, wait for its end or play along; return how it stands then."""

    async def scene() -> Job:
        limits = Settings(data_directory=folder, **settings)
        ledger, store = Ledger(folder / "jobs.sqlite3"), Store(folder)
        runner = Runner(ledger, store, workers, limits)
        admission = Admission(ledger, store, limits, runner.wake)
        await runner.start()
        try:
            job = admission.post(task_of(prepare_content(STUDY), "simulate", limits))
            if play is not None:
                await play(runner, admission, job)
            else:
                await awaited(lambda: ledger.job(job.id).state not in ACTIVE)
            found = ledger.job(job.id)
            assert found is not None
            return found
        finally:
            await runner.stop()
            ledger.close()

    return asyncio.run(scene())


def test_work_is_carried_out(tmp_path):
    workers = Workers()
    job = carried_out(tmp_path, workers)
    assert (job.state, job.done) == ("successful", job.blocks)
    assert workers.calls == ["missing_blocks", *["compute_block"] * job.blocks, "write_result"]
    assert Store(tmp_path).manifest(job.key) is not None


def test_time_runs_out_while_a_block_runs(tmp_path):
    done = threading.Event()
    workers = Workers(compute_block=lambda *_: float(done.wait(PATIENCE)))

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: admission.ledger.job(job.id).state == "failed")
        done.set()

    job = carried_out(tmp_path, workers, play, max_job_seconds=0.5)
    assert job.state == "failed"
    assert (job.problem["status"], job.problem["kind"]) == (422, "limit")
    assert "Post its study again" in job.problem["detail"]


def test_a_job_waits_for_workers_and_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr("vibrafeed.app.jobs.runner.RETRY", 0.1)
    workers = Workers()
    workers.trouble = "there are no workers"

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: bool(runner._active))
        assert runner.waits() == runner.fault() == "there are no workers"
        found = admission.ledger.job(job.id)
        assert found is not None
        assert (found.state, found.started) == ("accepted", None)
        workers.trouble = None
        assert runner.fault() is None
        await awaited(lambda: admission.ledger.job(job.id).state == "successful")

    carried_out(tmp_path, workers, play, max_job_seconds=0.5)


@pytest.mark.parametrize(("grace", "cut_off"), [(0.1, ["compute_block"]), (PATIENCE, [])])
def test_what_was_dismissed_has_a_time_to_end(tmp_path, grace, cut_off):
    done = threading.Event()
    workers = Workers(compute_block=lambda *_: float(done.wait(PATIENCE)))

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: admission.ledger.job(job.id).state == "running")
        admission.dismiss(job.id)
        await awaited(lambda: bool(workers.given_up))
        if cut_off:
            await awaited(lambda: not runner._active)
        done.set()
        await awaited(lambda: not runner._active)
        assert not runner._workers.fair_queue.taken

    carried_out(tmp_path, workers, play, grace_seconds=grace)
    assert workers.cut_off == cut_off


def test_a_block_that_takes_its_workers_down_fails_its_job(tmp_path):
    def dies(*_: Any) -> None:
        raise EndedError("it died")

    workers = Workers(compute_block=dies)
    job = carried_out(tmp_path, workers)
    assert (job.problem["status"], job.problem["title"]) == (500, "The study crashes its workers")
    assert workers.calls == ["missing_blocks", *MAX_DEATHS * ["compute_block"]]


def test_a_worker_without_the_shared_files_is_told(tmp_path):
    def blind(directory: str, *arguments: Any) -> float:
        return work.compute_block(str(tmp_path / "elsewhere"), *arguments)

    job = carried_out(tmp_path, Workers(compute_block=blind))
    assert (job.problem["status"], job.problem["kind"]) == (500, "workers")
    assert job.problem["title"] == "A worker does not see the data directory"
    assert "VIBRAFEED_DATA_DIRECTORY" in job.problem["detail"]


def test_a_dismissal_is_noticed_soon(tmp_path):
    """By another server, which cannot wake this one, and long before the lease is renewed."""
    done = threading.Event()

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: admission.ledger.job(job.id).state == "running")
        admission.ledger.dismiss(job.id)
        await awaited(lambda: not runner._active)
        done.set()

    workers = Workers(compute_block=lambda *_: float(done.wait(PATIENCE)))
    carried_out(tmp_path, workers, play, lease_seconds=600, grace_seconds=0.1)


def test_a_ledger_that_is_held_for_long_fails_no_job(tmp_path, monkeypatch):
    advance, asked = Ledger.advance, []

    def held(*arguments: Any, **options: Any) -> None:
        asked.append(True)
        if len(asked) == 1:
            raise sqlite3.OperationalError("database is locked")
        advance(*arguments, **options)

    monkeypatch.setattr(Ledger, "advance", held)
    assert carried_out(tmp_path, Workers(), lease_seconds=0.5).state == "successful"
    assert len(asked) > 1


def test_what_another_server_has_finished_is_no_failure(tmp_path):
    def late(*arguments: Any) -> float:
        work.write_result(*arguments)
        raise OSError(2, "the blocks are gone")

    assert carried_out(tmp_path, Workers(write_result=late)).state == "successful"


def test_a_runner_stops_though_it_is_woken_at_that_moment(tmp_path):
    """A wake that meets the stop must not swallow it: the server would never end."""

    async def scene() -> None:
        limits = Settings(data_directory=tmp_path)
        ledger, store = Ledger(tmp_path / "jobs.sqlite3"), Store(tmp_path)
        for fair_queue in range(6):  # of the event loop between both
            runner = Runner(ledger, store, Workers(), limits)
            await runner.start()
            await asyncio.sleep(0.1)
            runner._wake.set()
            for _ in range(fair_queue):
                await asyncio.sleep(0)
            await runner.stop()
            await asyncio.sleep(0.05)
        ledger.close()

    asyncio.run(scene())


def test_a_disk_that_loses_blocks_is_given_up(tmp_path):
    def torn(*arguments: Any) -> float:
        raise TornBlockError("block 0 is not what was written")

    workers = Workers(write_result=torn)
    job = carried_out(tmp_path, workers)
    assert (job.problem["status"], job.problem["kind"]) == (507, "storage")
    assert workers.calls.count("write_result") == MAX_TORN


def test_many_damaged_blocks_are_computed_again(tmp_path):
    torn = [TornBlockError(f"block {number} is not what was written") for number in range(9)]

    def mended(*arguments: Any) -> float:
        if torn:
            raise torn.pop()
        return work.write_result(*arguments)

    assert carried_out(tmp_path, Workers(write_result=mended)).state == "successful"


def test_too_many_open_files_fail_no_job(tmp_path, monkeypatch):
    monkeypatch.setattr("vibrafeed.app.jobs.runner.RETRY", 0.1)
    open_files = [OSError(errno.EMFILE, "Too many open files")]

    def full(*arguments: Any) -> float:
        if open_files:
            raise open_files.pop()
        return work.compute_block(*arguments)

    assert carried_out(tmp_path, Workers(compute_block=full)).state == "successful"


def test_a_study_of_another_version_is_told(tmp_path):
    def other(*arguments: Any) -> float:
        raise OtherVersionError("Post it again.")

    job = carried_out(tmp_path, Workers(compute_block=other))
    assert (job.problem["status"], job.problem["kind"]) == (409, "version")
