"""Jobs survive what kills a server or its workers, and run on any Dask cluster.

By night there are 20 kills; ``KILLS`` says how many else. With ``LEDGER=postgresql`` the
ledger of each test is a database of Debian's PostgreSQL.
"""

import contextlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import distributed
import netCDF4
import pytest

from benchmarks.serving import free_port
from night import count
from postgres import PASSWORD
from services import QUICK, Server
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from waiting import PATIENCE, wait_for

KILLS = count(2, 20, "KILLS")
JOBS = 3 if KILLS <= 4 else 8
SIZE = 51 if KILLS <= 4 else 301  # of two axes: the last kill is to meet work


ELSEWHERE = {}  # settings of a test whose ledger is no file


@pytest.fixture(autouse=os.environ.get("LEDGER") == "postgresql")
def in_postgresql(postgresql):
    """Keep the ledger of a test in PostgreSQL."""
    ELSEWHERE["ledger_url"] = postgresql.new_database()
    yield postgresql
    ELSEWHERE.clear()


def simulation(number):
    """Return a study of some seconds, in some tens of blocks."""
    return {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "outputs": ["conveying_velocity", "flight_fraction"],
        "parameters": {
            "frequency": 40 + number,
            "amplitude": {"start": "0.05 mm", "stop": "0.75 mm", "num": SIZE},
            "beta": {"start": 5, "stop": 60, "num": SIZE},
            "friction": 0.4,
            "restitution": 0.3,
        },
    }


def descendants(parent):
    """Return the processes below one, deepest last."""
    done = subprocess.run(
        ["ps", "-eo", "pid=,ppid=,args="], capture_output=True, text=True, check=True
    )
    children = {}
    for line in done.stdout.splitlines():
        pid, ppid, args = line.split(None, 2)
        if "resource_tracker" not in args and "defunct" not in args:
            children.setdefault(int(ppid), []).append(int(pid))
    found = [*children.get(parent, [])]
    for pid in found:
        found += children.get(pid, [])
    return found


@contextlib.contextmanager
def serving(folder, **settings):
    server = Server(folder, **ELSEWHERE, **settings)
    server.launch()
    try:
        yield server
    finally:
        server.stop()


def expected(study, path):
    write_netcdf(tabulate(prepare_content(study)), path)
    return path.read_bytes()


@pytest.mark.timeout(1800 + 100 * KILLS)
def test_jobs_survive_kills_of_server_and_workers(tmp_path):
    """No job is lost or wrong, no file is torn, nothing is left behind."""
    chance = random.Random(7)
    studies = [simulation(number) for number in range(JOBS)]
    with serving(tmp_path, **QUICK) as server:
        with ThreadPoolExecutor(JOBS) as pool:
            numbers = list(pool.map(server.post, studies))
        for kill in range(KILLS):
            time.sleep(chance.uniform(0.2, 3.0))
            workers = descendants(server.process.pid)
            if kill % 2 and workers:
                os.kill(chance.choice(workers), signal.SIGKILL)
            else:
                server.process.kill()
                server.process.wait(PATIENCE)
                server.launch()
        before = [server.job(number) for number in numbers]
        assert any(job["status"] in ("accepted", "running") for job in before)
        jobs = [server.finished(number) for number in numbers]
        assert [job["status"] for job in jobs] == ["successful"] * JOBS, jobs
        contents = [server.ask(f"/jobs/{number}/results/dataset") for number in numbers]
        server.process.kill()
        server.process.wait(PATIENCE)
        server.launch()
        server.ask("/healthz")
        assert len(json.loads(server.ask("/jobs"))["jobs"]) == JOBS
        left = [
            path for path in (tmp_path / "data").rglob("*") if path.suffix in (".part", ".block")
        ]
        assert left == []
    for study, content in zip(studies, contents, strict=True):
        assert content == expected(study, tmp_path / "whole.nc")
    with netCDF4.Dataset("x", memory=contents[0]) as file:
        assert file.variables["conveying_velocity"].shape == (SIZE, SIZE)


def test_a_database_that_is_restarted_under_jobs_loses_none(tmp_path, in_postgresql):
    """Stopped, crashed, and crashed at the same time as the server."""
    studies = [simulation(number) for number in range(2)]
    with serving(tmp_path, **QUICK, workers=1) as server:
        numbers = [server.post(study) for study in studies]
        server.begun(numbers[-1])  # the first may be over before the last is posted
        in_postgresql.stop()
        try:
            told = refusal(lambda: server.ask("/readyz"))
            assert ("ledger", "The database of the ledger cannot be reached.") in {
                (problem["place"], problem["message"]) for problem in told["errors"]
            }
            assert refusal(lambda: server.job(numbers[0]))["status"] == 503
        finally:
            in_postgresql.start()
        assert {server.job(number)["status"] for number in numbers} <= {
            "accepted", "running", "successful",
        }  # fmt: skip
        in_postgresql.stop(signal.SIGQUIT)
        server.process.kill()
        server.process.wait(PATIENCE)
        in_postgresql.start()
        server.launch()
        jobs = [server.finished(number) for number in numbers]
        assert [job["status"] for job in jobs] == ["successful"] * 2, jobs
        contents = [server.ask(f"/jobs/{number}/results/dataset") for number in numbers]
        assert not (tmp_path / "data" / "jobs.sqlite3").exists()
    assert PASSWORD not in (tmp_path / "log").read_text()
    for study, content in zip(studies, contents, strict=True):
        assert content == expected(study, tmp_path / "whole.nc")


@pytest.mark.night
def test_a_block_that_is_done_is_not_computed_again(tmp_path):
    study = simulation(0)
    with serving(tmp_path, **QUICK) as server:
        number = server.post(study)
        folder = tmp_path / "data" / "studies" / server.begun(number)["study"]
        server.process.kill()
        server.process.wait(PATIENCE)
        time.sleep(2)  # for its workers to see that they are alone
        done = {path: path.stat().st_mtime_ns for path in folder.rglob("*.block")}
        assert done
        server.launch()

        def is_untouched(_):
            for path, stamp in done.items():
                if path.exists():
                    assert path.stat().st_mtime_ns == stamp
            return False

        assert server.waited(number, is_untouched)["status"] == "successful"


@pytest.mark.night
def test_a_stopped_server_hands_its_work_on_at_once(tmp_path):
    """SIGTERM gives leases back: the next server need not wait for them to run out."""
    patient = {**QUICK, "lease_seconds": 600}
    with serving(tmp_path, **patient) as server:
        number = server.post(simulation(0))
        job = server.waited(number, lambda job: job["status"] == "running")
        assert job["status"] == "running", job
        server.process.terminate()
        assert server.process.wait(PATIENCE) in (0, -signal.SIGTERM)
        server.launch()
        assert server.finished(number)["status"] == "successful"


@pytest.mark.night
def test_a_dismissed_job_stops(tmp_path):
    with serving(tmp_path, **QUICK) as server:
        numbers = [server.post(simulation(number)) for number in range(2)]
        server.begun(numbers[0])
        assert (
            json.loads(server.ask(f"/jobs/{numbers[0]}", method="DELETE"))["status"] == "dismissed"
        )
        assert server.finished(numbers[1])["status"] == "successful"
        assert server.job(numbers[0])["status"] == "dismissed"
        assert server.job(numbers[0])["cellsDone"] < SIZE**2


@pytest.mark.night
def test_work_on_a_scheduler_elsewhere(tmp_path):
    """A scheduler and two workers as processes of their own; the service starts none."""
    address = f"tcp://127.0.0.1:{free_port()}"
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    port = address.rpartition(":")[2]
    cluster = [
        subprocess.Popen(
            [*dask, "--port", port, "--host", "127.0.0.1", "--no-dashboard", "--no-show"],
            cwd=tmp_path, **quiet,
        )
    ]  # fmt: skip
    for _ in range(2):
        cluster.append(
            subprocess.Popen(
                [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1",
                 "--no-dashboard", "--no-nanny", "--local-directory", str(tmp_path)],
                cwd=tmp_path, **quiet,
            )
        )  # fmt: skip
    try:
        with serving(tmp_path, **QUICK, scheduler=address) as server:
            study = simulation(3)
            number = server.post(study)
            # Of its two workers one dies on the way.
            server.begun(number)
            cluster[-1].kill()
            assert server.finished(number)["status"] == "successful"
            with distributed.Client(address, timeout=PATIENCE) as client:
                wait_for(lambda: len(client.scheduler_info()["workers"]) == 1)
            content = server.ask(f"/jobs/{number}/results/dataset")
        assert content == expected(study, tmp_path / "whole.nc")
    finally:
        for process in cluster:
            process.kill()
            process.wait(PATIENCE)


@pytest.mark.night
def test_a_scheduler_that_is_not_there_is_told_and_waited_for(tmp_path):
    address = f"tcp://127.0.0.1:{free_port()}"
    with serving(tmp_path, **QUICK, scheduler=address) as server:
        number = server.post(simulation(0))

        def is_told():
            try:
                server.ask("/readyz")
            except urllib.error.HTTPError as refused:
                return "workers cannot be reached" in refused.read().decode()
            return False

        wait_for(is_told)
        assert server.job(number)["status"] in ("accepted", "running")


@contextlib.contextmanager
def small_disk(folder, megabytes):
    """Mount a small disk in memory; skip where one may not."""
    folder.mkdir()
    size = f"size={megabytes}m"
    mount = ["mount", "-t", "tmpfs", "-o", size, "none", str(folder)]
    if shutil.which("mount") is None or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("no disk can be mounted")
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


def unmount(folder):
    """Unmount what a request may still be reading from."""
    for _ in range(100):
        if subprocess.run(["umount", str(folder)], capture_output=True).returncode == 0:
            return
        time.sleep(0.2)
    pytest.fail(f"{folder} stays in use")


def refusal(call):
    with pytest.raises(urllib.error.HTTPError) as caught:
        call()
    assert caught.value.headers["content-type"] == "application/problem+json"
    return json.loads(caught.value.read())


def test_a_full_and_a_read_only_disk_are_told_and_lose_nothing(tmp_path):
    data = tmp_path / "data"
    small = {**simulation(0), "parameters": {**simulation(0)["parameters"], "beta": 30}}
    with small_disk(data, 3), serving(tmp_path, **QUICK, workers=1) as server:
        first = server.post(small)
        assert server.finished(first)["status"] == "successful"
        kept = server.ask(f"/jobs/{first}/results/dataset")
        # What would not fit is refused before anything is computed.
        large = {**simulation(1)["parameters"], "gamma": {"start": 0, "stop": 5, "num": 90}}
        told = refusal(lambda: server.post({**simulation(1), "parameters": large}))
        assert (told["status"], told["type"]) == (507, "urn:vibrafeed:problem:storage")
        # The disk fills up while a job is under way.
        second = server.post({**small, "parameters": {**small["parameters"], "frequency": 77}})
        with contextlib.suppress(OSError):
            (data / "filler").write_bytes(bytes(10_000_000))
        third = {**small, "parameters": {**small["parameters"], "frequency": 78}}
        told = refusal(lambda: server.post(third))
        assert (told["status"], told["type"]) == (507, "urn:vibrafeed:problem:storage")
        assert refusal(lambda: server.ask("/readyz"))["status"] == 503
        assert server.ask(f"/jobs/{first}/results/dataset") == kept
        (data / "filler").unlink()
        # It has failed and says why, or it has waited for room.
        job = server.finished(second)
        assert job["status"] == "successful" or "The disk is full" in job["message"]
        for study in (third, {**small, "parameters": {**small["parameters"], "frequency": 77}}):
            assert server.finished(server.post(study))["status"] == "successful"
        # The disk itself is in use; a read-only view of it in the same place is not.
        subprocess.run(["mount", "--bind", str(data), str(data)], check=True)
        subprocess.run(["mount", "-o", "remount,bind,ro", str(data)], check=True)
        fourth = {**small, "parameters": {**small["parameters"], "frequency": 79}}
        told = refusal(lambda: server.post(fourth))
        assert told["detail"].startswith("The data directory is read-only")
        assert refusal(lambda: server.ask("/readyz"))["status"] == 503
        assert server.ask(f"/jobs/{first}/results/dataset") == kept
        unmount(data)
        assert server.finished(server.post(fourth))["status"] == "successful"


@pytest.mark.night
def test_a_start_on_a_full_or_read_only_disk_is_refused_in_one_line(tmp_path):
    data = tmp_path / "data"

    def refused(why):
        done = subprocess.run(
            [Path(sys.executable).with_name("vibrafeed"), "serve", "--port", str(free_port())],
            env={**os.environ, "VIBRAFEED_DATA_DIRECTORY": str(data)},
            capture_output=True, text=True, timeout=PATIENCE,
        )  # fmt: skip
        assert (done.returncode, done.stdout) == (2, "")
        (line,) = done.stderr.splitlines()
        assert line.startswith(f"The data directory {data} cannot be used: {why}.")
        assert "VIBRAFEED_DATA_DIRECTORY" in line
        return line

    with small_disk(data, 1):
        with serving(tmp_path, **QUICK) as server:  # so that there is a ledger
            server.ask("/healthz")
        with contextlib.suppress(OSError):
            (data / "filler").write_bytes(bytes(10_000_000))
        assert "Make room" in refused("No space left on device")
        (data / "filler").unlink()
        subprocess.run(["mount", "--bind", str(data), str(data)], check=True)
        subprocess.run(["mount", "-o", "remount,bind,ro", str(data)], check=True)
        refused("Read-only file system")
        unmount(data)
        with serving(tmp_path, **QUICK) as server:
            server.ask("/healthz")
