"""What carries out work, with workers that do as they are told."""

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

pytestmark = pytest.mark.anyio

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
        self, function: Any, *arguments: Any, on_start: Callable[[], Any], grace: float
    ) -> Any:
        name = function.__name__
        self.calls.append(name)
        call = asyncio.create_task(
            asyncio.to_thread(self.instead.get(name) or function, *arguments)
        )
        await on_start()
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


async def carried_out(
    folder: Path, workers: Workers, play: Play | None = None, **settings: Any
) -> Job:
    """Post a job, wait for its end or play along; return how it stands then."""
    limits = Settings(data_directory=folder, **settings)
    ledger, store = Ledger(folder / "jobs.sqlite3"), Store(folder)
    runner = Runner(ledger, store, workers, limits)
    admission = Admission(ledger, store, limits, runner.wake)
    await runner.start()
    try:
        job = admission.post(task_of(prepare_content(STUDY), "simulate", limits))
        if play is not None:
            await play(runner, admission, job)
        await awaited(lambda: ledger.job(job.id).state not in ACTIVE)
        return ledger.job(job.id)
    finally:
        await runner.stop()
        ledger.close()


def after(left: list[Exception], then: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that fails with some errors first."""
    return lambda *given, **named: fail(left.pop()) if left else then(*given, **named)


def fail(error: Exception) -> None:
    raise error


@pytest.fixture(autouse=True)
def soon(monkeypatch):
    for name in ("CHECK_INTERVAL", "POLL", "RETRY"):
        monkeypatch.setattr(f"vibrafeed.app.jobs.runner.{name}", 0.1)


async def test_work_is_carried_out(tmp_path):
    workers = Workers()
    job = await carried_out(tmp_path, workers)
    assert (job.state, job.done) == ("successful", job.blocks)
    assert workers.calls == ["missing_blocks", *["compute_block"] * job.blocks, "write_result"]
    assert Store(tmp_path).manifest(job.key) is not None


async def test_time_runs_out_while_a_block_runs(tmp_path):
    done = threading.Event()
    workers = Workers(compute_block=lambda *_: float(done.wait(PATIENCE)))

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: admission.ledger.job(job.id).state == "failed")
        done.set()

    job = await carried_out(tmp_path, workers, play, max_job_seconds=0.2, grace_seconds=0.1)
    assert (job.problem["status"], job.problem["kind"]) == (422, "limit")
    assert "Post its study again" in job.problem["detail"]


async def test_a_job_waits_for_workers_and_says_so(tmp_path):
    workers = Workers()
    workers.trouble = "there are no workers"

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: bool(runner._active))
        assert runner.waiting_reason() == runner.fault() == "there are no workers"
        found = admission.ledger.job(job.id)
        assert (found.state, found.started) == ("accepted", None)
        workers.trouble = None
        assert runner.fault() is None

    job = await carried_out(tmp_path, workers, play)
    assert job.state == "successful"


@pytest.mark.parametrize(
    ("grace", "cut_off", "is_elsewhere"),
    [(0.1, ["compute_block"], False), (PATIENCE, [], False), (0.1, ["compute_block"], True)],
)
async def test_what_was_dismissed_has_a_time_to_end(tmp_path, grace, cut_off, is_elsewhere):
    """Soon also by another server, which cannot wake this one: before the lease is renewed."""
    done = threading.Event()
    workers = Workers(compute_block=lambda *_: float(done.wait(PATIENCE)))

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: admission.ledger.job(job.id).state == "running")
        (admission.ledger if is_elsewhere else admission).dismiss(job.id)
        await awaited(lambda: bool(workers.given_up))
        if cut_off:
            await awaited(lambda: not runner._active)
        done.set()
        await awaited(lambda: not runner._active)
        assert not runner._workers.fair_queue.taken

    await carried_out(tmp_path, workers, play, grace_seconds=grace, lease_seconds=600)
    assert workers.cut_off == cut_off


@pytest.mark.parametrize(
    ("name", "error", "status", "kind", "words", "times"),
    [
        ("compute_block", EndedError("it died"), 500, "workers", "crashes its workers", MAX_DEATHS),
        ("write_result", TornBlockError("block 0 is torn"), 507, "storage", "", MAX_TORN),
        ("compute_block", OtherVersionError("Post it again."), 409, "version", "", None),
    ],
)
async def test_what_fails_again_and_again_is_told(
    tmp_path, name, error, status, kind, words, times
):
    workers = Workers(**{name: lambda *_: fail(error)})
    job = await carried_out(tmp_path, workers)
    assert (job.problem["status"], job.problem["kind"]) == (status, kind)
    assert words in job.problem["title"]
    assert times in (None, workers.calls.count(name))


async def test_a_worker_without_the_shared_files_is_told(tmp_path):
    def blind(directory: str, *arguments: Any) -> float:
        return work.compute_block(str(tmp_path / "elsewhere"), *arguments)

    job = await carried_out(tmp_path, Workers(compute_block=blind))
    assert (job.problem["status"], job.problem["kind"]) == (500, "workers")
    assert job.problem["title"] == "A worker does not see the data directory"
    assert "VIBRAFEED_DATA_DIRECTORY" in job.problem["detail"]


async def test_what_comes_back_fails_no_job(tmp_path, monkeypatch):
    held = [sqlite3.OperationalError("database is locked")]
    monkeypatch.setattr(Ledger, "advance", after(held, Ledger.advance))
    full = [OSError(errno.EMFILE, "Too many open files")]
    torn = [TornBlockError(f"block {number} is not what was written") for number in range(9)]
    workers = Workers(
        compute_block=after(full, work.compute_block), write_result=after(torn, work.write_result)
    )
    job = await carried_out(tmp_path, workers, lease_seconds=0.5)
    assert job.state == "successful"
    assert [held, full, torn] == [[], [], []]


async def test_what_another_server_has_finished_is_no_failure(tmp_path):
    def late(*arguments: Any) -> float:
        work.write_result(*arguments)
        raise OSError(2, "the blocks are gone")

    job = await carried_out(tmp_path, Workers(write_result=late))
    assert job.state == "successful"


async def test_a_runner_stops_though_it_is_woken_at_that_moment(tmp_path):
    """A wake that meets the stop must not swallow it: the server would never end."""
    ledger, store = Ledger(tmp_path / "jobs.sqlite3"), Store(tmp_path)
    for turns in range(6):  # of the event loop between both
        runner = Runner(ledger, store, Workers(), Settings(data_directory=tmp_path))
        await runner.start()
        await asyncio.sleep(0.05)
        runner._wake.set()
        for _ in range(turns):
            await asyncio.sleep(0)
        await runner.stop()
    ledger.close()
