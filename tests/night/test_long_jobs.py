"""Long work beside short, on workers elsewhere, of an earlier commit; starts on bad disks."""

import subprocess
import sys
import tarfile
from pathlib import Path

import distributed

from benchmarks.serving import free_port
from disasters import expected, fill, read_only, simulation, small_disk
from services import QUICK, serving
from vibrafeed.core.code_version import code_version
from waiting import PATIENCE, wait_for

OLD = Path(__file__).parents[1] / "data" / "data-of-e09fcfb.tar.gz"


def test_work_on_a_scheduler_elsewhere(tmp_path):
    """A scheduler and two workers as processes of their own; the service starts none."""
    port = free_port()
    address = f"tcp://127.0.0.1:{port}"
    scheduler = ["dask_scheduler", "--port", str(port), "--host", "127.0.0.1", "--no-show"]
    worker = ["dask_worker", address, "--nthreads", "1", "--no-nanny", "--local-directory", "."]
    processes = []
    try:
        for name, *options in (scheduler, worker, worker):
            command = [sys.executable, "-m", f"distributed.cli.{name}", *options, "--no-dashboard"]
            processes.append(
                subprocess.Popen(
                    command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
                )
            )
        with serving(tmp_path, **QUICK, scheduler=address) as server:
            number = server.post(simulation(3))
            # Of its two workers one dies on the way.
            server.begun(number)
            processes[-1].kill()
            assert server.finished(number)["status"] == "successful"
            with distributed.Client(address, timeout=PATIENCE) as client:
                wait_for(lambda: len(client.scheduler_info()["workers"]) == 1)
            assert server.dataset(number) == expected(simulation(3), tmp_path / "whole.nc")
    finally:
        for process in processes:
            process.kill()
            process.wait(PATIENCE)


def test_data_of_an_earlier_commit_are_served_and_its_work_goes_on(tmp_path):
    with tarfile.open(OLD) as archive:
        archive.extractall(tmp_path, filter="data")
    results = {path.parent.name: path.read_bytes() for path in tmp_path.rglob("result.nc")}
    with serving(tmp_path, workers=1, retention_days=1_000_000) as server:
        jobs = {job["processID"]: job for job in server.get("/jobs")["jobs"]}
        assert set(jobs) == {"sweep", "simulate"}
        done, waits = jobs["sweep"], jobs["simulate"]["jobID"]
        assert done["status"] == "successful"
        assert server.dataset(done["jobID"]) == results[done["study"]]
        assert server.finished(waits)["status"] == "successful"
        for number, version in ((done["jobID"], "0.1.0"), (waits, code_version())):
            assert server.get(f"/jobs/{number}/results")["dataset"]["version"] == version


def test_a_start_on_a_full_or_read_only_disk_is_refused_in_one_line(tmp_path):
    data = tmp_path / "data"

    def refused(why):
        with serving(tmp_path) as server:
            assert server.process.wait(PATIENCE) == 2
        line = server.log.read_text().splitlines()[-1]
        assert line.startswith(f"The data directory {data} cannot be used: {why}.")
        assert "VIBRAFEED_DATA_DIRECTORY" in line
        return line

    def starts():
        with serving(tmp_path) as server:
            server.ask("/healthz")

    with small_disk(data, 1):
        starts()  # so that there is a ledger
        filler = fill(data)
        assert "Make room" in refused("No space left on device")
        filler.unlink()
        with read_only(data):
            refused("Read-only file system")
        starts()
