"""What carries out work, with workers that do as they are told."""

from __future__ import annotations

import asyncio
import errno
import sqlite3
import threading
import uuid
from collections.abc import Callable, Coroutine
from importlib import import_module
from pathlib import Path
from typing import Any

from vibrafeed.app.jobs import work
from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.dispatcher import MAX_TORN
from vibrafeed.app.jobs.errors import OtherVersionError, TornBlockError
from vibrafeed.app.jobs.ledger import ACTIVE, Job, Ledger
from vibrafeed.app.jobs.runner import Runner
from vibrafeed.app.jobs.store import Store
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


class Future:
    """Runs a function in a thread, or waits for a worker that is not there."""

    def __init__(self, function: Callable[..., Any] | None, arguments: tuple[Any, ...] = ()):
        self.key = uuid.uuid4().hex
        waits = asyncio.sleep(1000)
        self._task = asyncio.ensure_future(
            waits if function is None else asyncio.to_thread(function, *arguments)
        )
        if function is not None:
            waits.close()

    def __await__(self) -> Any:
        return self._task.__await__()

    async def cancel(self) -> None:
        self._task.cancel()


class Workers:
    """Stands for the cluster; `instead` takes the place of functions by their names."""

    def __init__(self, count: int = 2, **instead: Callable[..., Any]):
        self.count, self.instead = count, instead
        self.calls: list[str] = []
        self.restarted: list[str] = []
        self.nannies = True
        self.begun: Callable[[str, str, bool], object] = lambda key, worker, is_loaded: None

    async def client(self) -> Workers:
        return self

    async def workers(self) -> int:
        return self.count

    async def close(self) -> None:
        pass

    def submit(self, call: object, module: str, name: str, *arguments: Any, pure: bool) -> Any:
        self.calls.append(name)
        if self.count == 0:
            return Future(None)
        function = self.instead.get(name) or getattr(import_module(module), name)
        future = Future(function, arguments)
        for is_loaded in (False, True):
            asyncio.get_running_loop().call_soon(self.begun, future.key, "worker", is_loaded)
        return future

    async def has_nanny(self, worker: str) -> bool:
        return self.nannies

    async def restart(self, worker: str) -> None:
        self.restarted.append(worker)


Play = Callable[[Runner, Admission, Job], Coroutine[Any, Any, None]]


def carried_out(folder: Path, workers: Workers, play: Play | None = None, **settings: Any) -> Job:
    """Post a job, wait for its end or play along; return how it stands then."""

    async def scene() -> Job:
        limits = Settings(data_directory=folder, **settings)
        ledger, store = Ledger(folder / "jobs.sqlite3"), Store(folder)
        runner = Runner(ledger, store, workers, limits)  # type: ignore[arg-type]
        admission = Admission(ledger, store, limits, runner.wake)
        await runner.start()
        try:
            job = admission.post(prepare_content(STUDY), "simulate")
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
    assert workers.calls == ["compute_blocks"] * job.blocks + ["write_result"]
    assert Store(tmp_path).manifest(job.key) is not None


def test_blocks_much_shorter_than_priced_share_calls(tmp_path, monkeypatch):
    monkeypatch.setattr("vibrafeed.app.jobs.work.cells_of_piece", lambda prepared, seconds: 1)
    amplitude = {"start": "0.1 mm", "stop": "0.4 mm", "num": 400}
    monkeypatch.setitem(STUDY["parameters"], "amplitude", amplitude)

    def in_no_time(*arguments: Any) -> list[float]:
        return [0.0] * len(work.compute_blocks(*arguments))

    workers = Workers(compute_blocks=in_no_time)
    job = carried_out(tmp_path, workers)
    assert (job.state, job.blocks, job.done) == ("successful", 400, 400)
    # Some at a time, but never more than leave as many for each of the calls under way.
    assert 2 * workers.count < len(workers.calls) < 60


def test_blocks_that_turn_out_long_are_given_back(tmp_path, monkeypatch):
    """After a block's time a call begins with no other, and the rest is computed by others."""
    monkeypatch.setattr("vibrafeed.app.jobs.work.cells_of_piece", lambda prepared, seconds: 1)
    amplitude = {"start": "0.1 mm", "stop": "0.4 mm", "num": 60}
    monkeypatch.setitem(STUDY["parameters"], "amplitude", amplitude)
    asked: list[int] = []

    def at_first_short(*arguments: Any) -> list[float]:
        *others, indices, claim, _, _ = arguments
        asked.append(len(indices))
        is_short = len(asked) < 12
        took = work.compute_blocks(*others, indices if is_short else indices[:1], claim)
        return [0.0 if is_short else 1.0] * len(took)

    job = carried_out(tmp_path, Workers(compute_blocks=at_first_short))
    assert (job.state, job.blocks, job.done) == ("successful", 60, 60)
    assert max(asked) > 1
    assert asked[-1] == 1


def test_no_block_begins_after_the_time_of_a_call(tmp_path, monkeypatch):
    monkeypatch.setattr(work, "compute_block", lambda *_: 0.4)
    assert work.compute_blocks("", "", "sweep", 1, range(9), "", 1.0) == [0.4] * 3


def test_time_runs_out_while_a_block_runs(tmp_path):
    done = threading.Event()
    workers = Workers(1, compute_blocks=lambda *_: done.wait(PATIENCE))

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: admission.ledger.job(job.id).state == "failed")
        done.set()

    job = carried_out(tmp_path, workers, play, max_job_seconds=0.5)
    assert job.state == "failed"
    assert (job.problem["status"], job.problem["kind"]) == (422, "limit")
    assert "Post its study again" in job.problem["detail"]


def test_time_does_not_run_out_while_a_job_waits_and_it_says_for_what(tmp_path, monkeypatch):
    monkeypatch.setattr("vibrafeed.app.jobs.executor.LOOK_AT_WORKERS", 0.1)
    workers = Workers(0)

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: runner.waits() == "there are no workers")
        await asyncio.sleep(0.6)  # longer than it may run
        found = admission.ledger.job(job.id)
        assert found is not None
        assert (found.state, found.started) == ("accepted", None)

    carried_out(tmp_path, workers, play, max_job_seconds=0.5)


def test_a_worker_that_does_not_stop_what_was_dismissed_is_killed(tmp_path):
    done = threading.Event()
    workers = Workers(1, compute_blocks=lambda *_: done.wait(PATIENCE))

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: admission.ledger.job(job.id).state == "running")
        admission.dismiss(job.id)
        await awaited(lambda: workers.restarted == ["worker"])
        done.set()

    carried_out(tmp_path, workers, play, grace_seconds=0.2)


def test_a_worker_without_a_nanny_is_waited_for(tmp_path, caplog):
    done = threading.Event()
    workers = Workers(1, compute_blocks=lambda *_: done.wait(PATIENCE))
    workers.nannies = False

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: admission.ledger.job(job.id).state == "running")
        admission.dismiss(job.id)
        await awaited(lambda: "has no nanny" in caplog.text)
        assert runner._dispatcher.executor._ending  # its place is taken
        done.set()
        await awaited(lambda: not runner._dispatcher.executor._ending)

    carried_out(tmp_path, workers, play, grace_seconds=0.1)
    assert workers.restarted == []


def test_a_worker_that_stops_in_time_is_left_alone(tmp_path):
    done = threading.Event()
    workers = Workers(1, compute_blocks=lambda *_: done.wait(PATIENCE))

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: admission.ledger.job(job.id).state == "running")
        admission.dismiss(job.id)
        await awaited(lambda: not runner._active)
        done.set()
        await awaited(lambda: not runner._dispatcher.executor._ending)

    carried_out(tmp_path, workers, play)
    assert workers.restarted == []


def test_a_worker_without_the_shared_files_is_told(tmp_path):
    def blind(directory: str, *arguments: Any) -> list[float]:
        return work.compute_blocks(str(tmp_path / "elsewhere"), *arguments)

    job = carried_out(tmp_path, Workers(compute_blocks=blind))
    assert (job.problem["status"], job.problem["kind"]) == (500, "workers")
    assert job.problem["title"] == "A worker does not see the data directory"
    assert "VIBRAFEED_DATA_DIRECTORY" in job.problem["detail"]


def test_that_there_are_no_workers_is_told_while_work_waits_for_them(tmp_path, monkeypatch):
    monkeypatch.setattr("vibrafeed.app.jobs.executor.LOOK_AT_WORKERS", 0.1)

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        assert runner.fault() is None
        await awaited(lambda: runner.fault() == "there are no workers")
        admission.dismiss(job.id)
        await awaited(lambda: runner.fault() is None)

    carried_out(tmp_path, Workers(0), play, lease_seconds=0.4)


def test_workers_that_go_and_come_again_are_noticed(tmp_path, monkeypatch):
    monkeypatch.setattr("vibrafeed.app.jobs.executor.LOOK_AT_WORKERS", 0.1)
    go_on = threading.Event()
    workers = Workers(1, compute_blocks=lambda *_: go_on.wait(PATIENCE))

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: "compute_blocks" in workers.calls)
        assert runner.fault() is None
        workers.count = 0
        await awaited(lambda: runner.fault() == "there are no workers")
        workers.count = 1
        await awaited(lambda: runner.fault() is None)
        go_on.set()

    carried_out(tmp_path, workers, play)


def test_a_scheduler_that_goes_away_is_no_failure_of_the_job(tmp_path, monkeypatch):
    monkeypatch.setattr("vibrafeed.app.jobs.runner.RETRY", 0.1)
    workers = Workers()
    count, asked = workers.workers, []

    async def gone() -> int:
        asked.append(True)
        if len(asked) == 1:
            raise OSError("the scheduler is gone")
        return await count()

    monkeypatch.setattr(workers, "workers", gone)
    assert carried_out(tmp_path, workers).state == "successful"
    assert len(asked) > 1


def test_a_dismissal_is_noticed_soon(tmp_path):
    """By another server, which cannot wake this one, and long before the lease is renewed."""

    async def play(runner: Runner, admission: Admission, job: Job) -> None:
        await awaited(lambda: bool(runner._active))
        await asyncio.sleep(0.1)
        admission.ledger.dismiss(job.id)
        assert await awaited(lambda: not runner._active) < 2.5

    carried_out(tmp_path, Workers(0), play, lease_seconds=600)


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
            runner = Runner(ledger, store, Workers(), limits)  # type: ignore[arg-type]
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

    def full(*arguments: Any) -> list[float]:
        if open_files:
            raise open_files.pop()
        return work.compute_blocks(*arguments)

    assert carried_out(tmp_path, Workers(compute_blocks=full)).state == "successful"


def test_a_study_of_another_version_is_told(tmp_path):
    def other(*arguments: Any) -> float:
        raise OtherVersionError("Post it again.")

    job = carried_out(tmp_path, Workers(compute_blocks=other))
    assert (job.problem["status"], job.problem["kind"]) == (409, "version")
