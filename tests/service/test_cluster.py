"""A Dask scheduler takes calls as processes do; two workers compute what one machine does."""

import asyncio
import json
import os
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import distributed
import pytest
import xarray
from distributed.security import Security
from typer.testing import CliRunner

from large_studies import sweep_of
from vibrafeed.app.cli import app
from vibrafeed.app.jobs import cluster as clusters
from vibrafeed.app.jobs.cluster import Cluster
from vibrafeed.app.jobs.process_pool import LostError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import open_lazily, tabulate
from waiting import PATIENCE, awaited, wait_for

GO_ON, BEGUN = threading.Event(), threading.Event()


def go_on() -> None:
    BEGUN.set()
    GO_ON.wait(PATIENCE)


async def nothing() -> None:
    """Begin."""


async def plays(cluster: Cluster, local: distributed.LocalCluster) -> None:
    with pytest.raises(LostError, match="there are no workers"):
        await cluster.prepare()
    assert cluster.trouble == "there are no workers"
    assert cluster.alive() == 0
    local.scale(1)
    await asyncio.to_thread(local.wait_for_workers, 1)
    await cluster.prepare()
    assert (cluster.alive(), cluster.fair_queue.slots, cluster.trouble) == (2, 3, None)
    assert await cluster(divmod, 7, 2, on_start=nothing) == (3, 1)
    with pytest.raises(ZeroDivisionError):
        await cluster(divmod, 1, 0, on_start=nothing)
    # What is given up is left to itself.
    call = asyncio.create_task(cluster(go_on, on_start=nothing, grace=0.1))
    await awaited(BEGUN.is_set)
    call.cancel()
    await asyncio.wait({call})
    assert call.cancelled()
    GO_ON.set()
    # A connection that is lost is made again.
    await asyncio.to_thread(cluster._client.close)
    await awaited(lambda: cluster._client.status == "closed")
    await cluster.prepare()
    assert await cluster(divmod, 7, 2, on_start=nothing) == (3, 1)
    await asyncio.to_thread(cluster.close)


def test_calls_return_or_raise_whatever_becomes_of_the_cluster() -> None:
    """With a cluster of threads in this process."""
    with distributed.LocalCluster(
        n_workers=0, threads_per_worker=2, processes=False, host="127.0.0.1",
        dashboard_address="127.0.0.1:0", protocol="tcp",
    ) as local:  # fmt: skip
        asyncio.run(plays(Cluster(local.scheduler_address), local))


def test_a_scheduler_that_does_not_answer_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clusters, "PATIENCE", 0.5)

    async def run() -> None:
        cluster = Cluster("tcp://127.0.0.1:9")
        with pytest.raises(LostError, match="cannot be reached"):
            await cluster.prepare()
        assert cluster.trouble
        cluster.close()

    asyncio.run(run())


STUDY = {**sweep_of(32), "outputs": ["transport_velocity", "throw_number"], "verify": 2}
# Workers compute small blocks slowly, so that there is time to kill one.
WORKER = """
import sys, time
from vibrafeed.core.lazy import store
store.STORED_CELLS = int(sys.argv[1])
plain = store.compute_block
store.compute_block = lambda *given: time.sleep(0.05) or plain(*given)
from distributed.cli import dask_worker
dask_worker.main([sys.argv[2], "--nthreads", "1", "--no-nanny", "--no-dashboard"])
"""
RUN = """
import sys
from vibrafeed.core.lazy import store
store.STORED_CELLS = int(sys.argv[1])
from vibrafeed.app.cli import app
app(["run", *sys.argv[2:]])
"""


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Start a scheduler that talks TLS; whoever reads the settings of Dask has its certificates."""
    folder = tmp_path_factory.mktemp("scheduler")
    given = Security.temporary()
    (folder / "ca.pem").write_text(given.tls_ca_file)
    settings = {"CA_FILE": str(folder / "ca.pem")}
    for role in ("scheduler", "worker", "client"):
        for what in ("cert", "key"):
            path = folder / f"{role}-{what}.pem"
            path.write_text(getattr(given, f"tls_{role}_{what}"))
            settings[f"{role}__{what}".upper()] = str(path)
    start = {f"DASK_DISTRIBUTED__COMM__TLS__{name}": value for name, value in settings.items()}
    start["DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES"] = "20"
    with pytest.MonkeyPatch.context() as patched:
        for name, value in start.items():
            patched.setenv(name, value)
        process = subprocess.Popen(
            [sys.executable, "-m", "distributed.cli.dask_scheduler", "--protocol", "tls", "--host",
             "127.0.0.1", "--port", "0", "--no-dashboard"],
            stderr=subprocess.PIPE, text=True, cwd=folder,
        )  # fmt: skip
        assert process.stderr is not None
        try:
            lines = (re.search(r"Scheduler at:\s+(tls://\S+)", line) for line in process.stderr)
            yield next(found[1] for found in lines if found)
        finally:
            process.kill()
            process.wait()
            process.stderr.close()


def started(*command: object, folder: Path) -> subprocess.Popen[str]:
    """Start Python on what it is to do."""
    return subprocess.Popen(
        [sys.executable, *map(str, command)], cwd=folder, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip


def test_two_workers_one_of_them_killed_and_a_client_in_python(
    scheduler: str, tmp_path: Path
) -> None:
    study, target, cells = tmp_path / "study.json", tmp_path / "a.zarr", 20_000
    study.write_text(json.dumps(STUDY))
    workers = [started("-c", WORKER, cells, scheduler, folder=tmp_path) for _ in range(2)]
    to = ("-o", target, "--scheduler", scheduler)
    running = started("-c", RUN, cells, study, *to, folder=tmp_path)
    prepared = prepare_content(STUDY)
    try:
        begun = tmp_path / ".a.zarr.partial"
        wait_for(lambda: len([*begun.glob("*_velocity/c/**/0")]) > 2 or running.poll() is not None)
        workers[0].send_signal(signal.SIGKILL)
        output = running.communicate(timeout=PATIENCE)[0]
        assert running.returncode == 0, output
        lazy: Any = open_lazily(prepared)["transport_velocity"].max()
        wanted = float(lazy)
        tls = {name: os.environ[f"DASK_DISTRIBUTED__COMM__TLS__{name}"] for name in
               ("CA_FILE", "CLIENT__CERT", "CLIENT__KEY")}  # fmt: skip
        security = Security(
            tls_ca_file=tls["CA_FILE"], tls_client_cert=tls["CLIENT__CERT"],
            tls_client_key=tls["CLIENT__KEY"],
        )  # fmt: skip
        with distributed.Client(scheduler, security=security):
            assert float(lazy) == wanted
    finally:
        for process in (running, *workers):
            process.kill()
            process.communicate()
    with xarray.open_zarr(target) as found:
        xarray.testing.assert_equal(found.load(), tabulate(prepared).with_price({}).to_xarray())
        assert found.attrs["verified_cells"] == 2


def test_a_scheduler_that_is_not_reached_is_told(
    scheduler: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = tmp_path / "study.json"
    study.write_text(json.dumps(STUDY))

    def told(*options: object, exit_code: int) -> str:
        command = ["run", str(study), *map(str, options), "--scheduler", scheduler]
        refused = CliRunner().invoke(app, command)
        assert refused.exit_code == exit_code
        return " ".join(refused.output.split())

    # It has read no certificates.
    unreached = told("-o", tmp_path / "a.zarr", exit_code=1)
    assert f"{scheduler} cannot be reached: it talks TLS" in unreached
    assert "Write to Zarr (-o result.zarr), or remove --scheduler" in told(exit_code=2)
