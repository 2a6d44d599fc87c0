"""Shares of a sweep: computed by processes that are killed, joined, the same bytes as one run."""

from __future__ import annotations

import hashlib
import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import xarray
from typer.testing import CliRunner

from night import first_by_day
from vibrafeed.app.cli import app
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.plan.shares import SharesMissingError, ranges
from waiting import PATIENCE, wait_for

SWEEP: dict[str, Any] = {
    "kind": "sweep",
    "scene": "rectangle-on-track",
    "outputs": ["transport_velocity", "throw_number"],
    "parameters": {
        "frequency": {"start": "20 Hz", "stop": "120 Hz", "num": 20},
        "amplitude": {"start": "0.02 mm", "stop": "0.2 mm", "num": 20},
        "alpha": {"start": 0, "stop": 60, "num": 13},
        "beta": {"start": 1, "stop": 45, "num": 40},
        "friction": 0.3,
        "gamma": 30,
        "radius": 0.8,
        "distance": "0.05 mm",
    },
}
ASKED = {
    "statistics": ["max", "min", "mean", "argmax", "argmin"],
    "quantiles": [0.5],
    "regimes": True,
    "shares": {"slips": ["regime == slip", "throw_number < 1"]},
    "levels": {
        "fast": {"output": "transport_velocity", "level": "10 mm/s", "along": "beta"},
    },
}
ALL = {
    **SWEEP,
    "reduce": {**ASKED, "quantiles": [], "over": ["frequency", "amplitude", "alpha", "beta"]},
}
SOME = {**SWEEP, "reduce": {**ASKED, "over": ["frequency", "beta"]}}

# What `vibrafeed run --share` does, for many shares in one process, each taking a while.
WORKER = """
import json, sys, time
from vibrafeed.core.dataset import layout
from vibrafeed.core.reduce import cutting
layout.TILE_CELLS, layout.CHUNK_CELLS, cutting.BOX_CELLS = 4_000, 500, 2_000
from vibrafeed.core.intake import prepare_content
content, where, count, numbers, wait = json.loads(sys.argv[1])
shares = prepare_content(content).shares(where, count)
for number in numbers:
    if not shares.is_there(number):
        record = shares.compute(number)
        time.sleep(wait)
        shares.keep(number, record)
"""


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vibrafeed.core.dataset.layout.TILE_CELLS", 4_000)
    monkeypatch.setattr("vibrafeed.core.dataset.layout.CHUNK_CELLS", 500)
    monkeypatch.setattr("vibrafeed.core.reduce.cutting.BOX_CELLS", 2_000)


def worker(content: Any, where: Path, count: int, numbers: list[int], wait: float = 0.0):
    arguments = json.dumps([content, str(where), count, numbers, wait])
    return subprocess.Popen([sys.executable, "-c", WORKER, arguments])


def run(*arguments: object):
    return CliRunner().invoke(app, [*map(str, arguments)])


def contents(path: Path) -> dict[str, str]:
    files = sorted(path.rglob("*")) if path.is_dir() else [path]
    return {
        str(file.relative_to(path)): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in files
        if file.is_file()
    }


@pytest.mark.parametrize(
    ("content", "ending"), first_by_day([(SWEEP, "zarr"), (ALL, "nc"), (SOME, "nc")])
)
def test_64_shares_of_four_processes_two_of_them_killed(content, ending, tmp_path) -> None:
    where = tmp_path / f"result.{ending}"
    shares = [list(range(k, 64, 4)) for k in range(4)]
    working = [worker(content, where, 64, share, 0.1) for share in shares]
    shares = prepare_content(content).shares(str(where), 64)
    wait_for(lambda: {0, 1} <= {int(name[:6]) % 4 for name in shares.records.names()})
    for one in working[:2]:
        one.send_signal(signal.SIGKILL)
    assert [one.wait() for one in working] == [-9, -9, 0, 0]
    with pytest.raises(SharesMissingError) as missing:
        shares.join()
    assert 2 <= len(missing.value.missing) < 32
    assert all(number % 4 < 2 for number in missing.value.missing)
    assert not where.exists()
    # Those that are missing, and one of which a byte has gone wrong, are computed again.
    name = shares.records.names()[3]
    damage(tmp_path / f"result.{ending}.shares" / name, 100)
    with pytest.raises(SharesMissingError) as damaged:
        shares.join()
    assert damaged.value.damaged == [int(name[:6])]
    assert worker(content, where, 64, damaged.value.numbers).wait() == 0
    shares.join()
    assert not (tmp_path / f"result.{ending}.shares").exists()
    one = tmp_path / f"one.{ending}"
    whole = prepare_content(content).shares(str(one), 1)
    whole.keep(0, whole.compute(0))
    whole.join()
    assert contents(where) == contents(one)
    assert contents(one) == contents(of_one_run(content, tmp_path / f"plain.{ending}"))


def of_one_run(content: Any, where: Path) -> Path:
    """Return the result of a study that is in no shares, without what its run cost."""
    from vibrafeed.core.dataset.netcdf import write_netcdf
    from vibrafeed.core.kinds import tabulate
    from vibrafeed.core.sweep.stream import outline_table, stream
    from vibrafeed.core.sweep.targets import open_target

    prepared = prepare_content(content)
    if where.suffix == ".nc":
        write_netcdf(tabulate(prepared), where)
        return where
    growing = open_target(where, prepared, outline_table(prepared))
    stream(prepared, growing)
    growing.close()
    return where


def damage(path: Path, place: int) -> None:
    data = bytearray(path.read_bytes())
    data[place] ^= 1
    path.write_bytes(bytes(data))


def test_a_damaged_shard_is_found(tmp_path: Path) -> None:
    where = tmp_path / "result.zarr"
    shares = prepare_content(SWEEP).shares(str(where), 3)
    for number in range(3):
        shares.keep(number, shares.compute(number))
    shard = sorted((tmp_path / ".result.zarr.partial/transport_velocity/c").rglob("*"))[-1]
    damage(shard, shard.stat().st_size // 2)
    with pytest.raises(SharesMissingError) as found:
        shares.join()
    assert len(found.value.damaged) == 1
    (again,) = found.value.numbers
    shares.keep(again, shares.compute(again))
    shares.join()
    assert xarray.open_zarr(where).transport_velocity.notnull().any()


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = tmp_path / "study.json"
    path.write_text(json.dumps(ALL))
    return path


def test_the_command_line_computes_shares_and_joins_them(study: Path, tmp_path: Path) -> None:
    where = tmp_path / "result.nc"
    for number in (0, 2):
        done = run("run", study, "--share", f"{number}/3", "-o", where)
        assert done.exit_code == 0, done.output
    assert "exists already" in run("run", study, "--share", "2/3", "-o", where).output
    failed = run("run", study, "-o", where)
    assert failed.exit_code == 1
    assert "of 3 shares 1 missing: 1." in failed.output
    assert "--array=1" in failed.output
    assert run("run", study, "--share", "1/3", "-o", where).exit_code == 0
    joined = run("run", study, "-o", where)
    assert joined.exit_code == 0, joined.output
    assert run("run", study, "-o", tmp_path / "one.nc").exit_code == 0
    with xarray.open_dataset(where) as found, xarray.open_dataset(tmp_path / "one.nc") as want:
        assert found.drop_attrs().identical(want.drop_attrs())
        assert "vibrafeed run study.json" in found.attrs["history"]
        assert found.attrs["elapsed_seconds"] > 0


@pytest.mark.parametrize(
    ("share", "output", "told"),
    [
        ("3/3", "r.nc", "share: '3/3' is not a share. Shares are numbered from 0"),
        ("x", "r.nc", "share: 'x' is not a share"),
        ("0/0", "r.nc", "share: '0/0' is not a share"),
        ("0/3", "r.zarr", "output: the shares of a reduced sweep ([reduce]) are joined"),
        ("0/999999", "r.nc", "share: 999,999 shares. Take 1 to 100,000."),
    ],
)
def test_mistakes_are_told(study: Path, tmp_path: Path, share: str, output: str, told: str) -> None:
    done = run("run", study, "--share", share, "-o", tmp_path / output)
    assert done.exit_code == 2
    assert told in done.output


def test_what_has_no_shares_says_so(study: Path, tmp_path: Path) -> None:
    study.write_text(json.dumps(SWEEP))
    done = run("run", study, "--share", "0/2", "-o", tmp_path / "r.nc")
    assert done.exit_code == 2
    assert "the shares of a sweep are written as shards of one Zarr group" in done.output


def test_shares_of_another_study_are_not_taken(tmp_path: Path) -> None:
    where = str(tmp_path / "r.zarr")
    first = prepare_content(SWEEP).shares(where, 2)
    first.keep(0, first.compute(0))
    other = {**SWEEP, "parameters": {**SWEEP["parameters"], "friction": 0.4}}
    second = prepare_content(other).shares(where, 2)
    assert not second.is_there(0)
    with pytest.raises(FileExistsError, match="another study or version"):
        second.compute(0)
    with pytest.raises(FileExistsError, match="another study or version"):
        second.join()


def test_numbers_are_told_as_a_queue_takes_them() -> None:
    assert ranges([]) == ""
    assert ranges([0]) == "0"
    assert ranges([3, 0, 1, 2, 7, 9, 10]) == "0-3,7,9-10"


@pytest.mark.night
@pytest.mark.service
def test_a_scheduler_with_two_workers_one_of_them_killed(study: Path, tmp_path: Path) -> None:
    where = tmp_path / "result.nc"
    folder = str(tmp_path)
    environment = {**os.environ, "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "20"}
    scheduler = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port",
         "0", "--no-dashboard"], stderr=subprocess.PIPE, text=True, env=environment, cwd=folder,
    )  # fmt: skip
    workers: list[subprocess.Popen[Any]] = []
    assert scheduler.stderr is not None
    try:
        address = next(
            found[1]
            for line in scheduler.stderr
            if (found := re.search(r"Scheduler at:\s+(tcp://\S+)", line))
        )
        workers = [
            subprocess.Popen(
                [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1",
                 "--no-nanny", "--no-dashboard"], stderr=subprocess.DEVNULL, cwd=folder,
            )
            for _ in range(2)
        ]  # fmt: skip
        running = subprocess.Popen(
            [sys.executable, "-m", "vibrafeed", "run", str(study), "-o", str(where), "--scheduler",
             address, "--shares", "200"],
        )  # fmt: skip
        records = tmp_path / "result.nc.shares"
        wait_for(lambda: records.exists() or running.poll() is not None)
        workers[0].send_signal(signal.SIGKILL)
        assert running.wait(timeout=PATIENCE) == 0
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()
        scheduler.stderr.close()
    with xarray.open_dataset(where) as found, xarray.open_dataset(one_run(study)) as want:
        assert found.drop_attrs().identical(want.drop_attrs())


def one_run(study: Path) -> Path:
    assert run("run", study, "-o", study.with_suffix(".nc")).exit_code == 0
    return study.with_suffix(".nc")
