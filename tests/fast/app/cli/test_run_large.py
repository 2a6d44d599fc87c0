"""Studies of any size from the command line: room, stopping, killing, going on, object stores."""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import sys
import time
from collections import namedtuple
from pathlib import Path

import pytest
import xarray
from typer.testing import CliRunner

from vibrafeed.app.cli import app
from vibrafeed.core.intake import load_study
from vibrafeed.core.kinds import open_lazily, prepare
from waiting import PATIENCE

STUDY = """
kind = "sweep"
scene = "rectangle-on-track"
outputs = ["transport_velocity", "throw_number"]
verify = 3

[parameters]
frequency = { start = "20 Hz", stop = "120 Hz", num = 40 }
amplitude = { start = "0.1 mm", stop = "1 mm", num = 20 }
alpha = { start = 0, stop = 90, num = 13 }
beta = { start = 0, stop = 90, num = 40 }
friction = 0.3
radius = 0.8
distance = "0.2 mm"
"""
CELLS = 20_000

# The command with small blocks, each taking a while, so that there is time to kill it.
SLOW = f"""
import sys, time
from vibrafeed.app.cli import running
from vibrafeed.core.lazy import store
store.STORED_CELLS, running.LARGE_BYTES = {CELLS}, 1_000_000
plain = store.compute_block
def slow(*arguments):
    time.sleep(float(sys.argv[1]))
    return plain(*arguments)
store.compute_block = slow
from vibrafeed.app.cli import app
app(sys.argv[2:])
"""


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr("vibrafeed.core.lazy.store.STORED_CELLS", CELLS)
    monkeypatch.setattr("vibrafeed.app.cli.running.LARGE_BYTES", 1_000_000)
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def run(*arguments: object):
    return CliRunner().invoke(app, ["run", *map(str, arguments)])


def started(wait: float, *arguments: object) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", SLOW, str(wait), "run", *map(str, arguments)],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )  # fmt: skip


def words(output: str) -> str:
    return " ".join(output.split())


def chunks(folder: Path) -> int:
    return sum(1 for _ in folder.glob("transport_velocity/c/*/*/*/*"))


def stop(process: subprocess.Popen[str], folder: Path, number: int) -> str:
    """Send a signal to a run that has written some chunks; return what it has printed."""
    while chunks(folder) < 3 and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(number)
    return words(process.communicate(timeout=PATIENCE)[0])


def check(found: xarray.Dataset, study: Path) -> None:
    """Compare a result with the same study in memory."""
    wanted = open_lazily(prepare(load_study(study)))
    xarray.testing.assert_equal(found.load(), wanted.load())
    assert found.attrs["verified_cells"] == 3
    assert "vibrafeed run study.toml" in found.attrs["history"]


def test_a_killed_run_to_zarr_leaves_nothing_and_goes_on(study: Path, tmp_path: Path) -> None:
    target, folder = tmp_path / "a.zarr", tmp_path / ".a.zarr.partial"
    process = started(0.05, study, "-o", target)
    stop(process, folder, signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL
    assert folder.exists()
    assert not target.exists()
    result = run(study, "-o", target, "--resume")
    assert result.exit_code == 0, result.output
    found = re.search(r"continuing: (\d+) of (\d+) blocks were done before", words(result.output))
    assert found is not None
    assert 0 < int(found[1]) < int(found[2])
    assert not folder.exists()
    with xarray.open_zarr(target) as dataset:
        check(dataset, study)
    again = run(study, "-o", target, "--resume")
    assert f"{target} is complete already" in words(again.output)


def test_an_interrupt_stops_between_blocks_and_says_how_to_go_on(
    study: Path, tmp_path: Path
) -> None:
    target, folder = tmp_path / "a.zarr", tmp_path / ".a.zarr.partial"
    process = started(0.1, study, "-o", target)
    output = stop(process, folder, signal.SIGINT)
    assert process.returncode == 1
    assert re.search(r"it was stopped; \d+ of \d+ blocks are done", output)
    assert f"What is done is kept in {folder}" in output
    assert "To go on, give the same command with --resume." in output
    assert not target.exists()


def test_a_large_netcdf_says_that_it_begins_anew(study: Path, tmp_path: Path) -> None:
    target = tmp_path / "a.nc"
    process = started(0.1, study, "-o", target)
    while not [*tmp_path.glob(".a.nc*.part")] and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    output = words(process.communicate(timeout=PATIENCE)[0])
    assert process.returncode == 1
    assert "it was stopped; nothing is written. A run to Zarr would go on." in output
    assert [one.name for one in tmp_path.iterdir()] == ["study.toml"]
    output = words(run(study, "-o", target).output)
    assert re.search(r"416,000 cells, \S+ bytes before compression; a run to NetCDF that", output)
    assert "begins anew, one to Zarr (-o x.zarr) goes on; " in output
    assert "416,000 cells, 0.00" in output
    assert "Ranges of values are not printed above 0.001 GB." in output
    with xarray.open_dataset(target) as found:
        check(found, study)


def test_a_time_limit_stops_it_too(study: Path, tmp_path: Path) -> None:
    result = run(study, "-o", tmp_path / "a.zarr", "--time-limit", 0)
    assert result.exit_code == 1
    assert "it was stopped while cells were verified; nothing is written" in words(result.output)


Usage = namedtuple("Usage", "total used free")


@pytest.mark.parametrize("name", ["a.nc", "a.zarr"])
def test_what_the_disk_cannot_hold_is_refused_with_what_fits(
    study: Path, tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda path: Usage(10**9, 0, 250_000))
    result = run(study, "-o", tmp_path / name)
    assert result.exit_code == 2
    output = words(result.output)
    assert re.search(r"output: it takes \S+ GB before compression; the disk of", output)
    assert re.search(r"It fits with \d+ instead of 40 values of", output)
    assert [one.name for one in tmp_path.iterdir()] == ["study.toml"]


def test_a_disk_that_fills_up_is_told_and_what_is_there_is_kept(
    study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from vibrafeed.core.lazy import store

    put, written = store.put, []

    def full(*arguments: object) -> None:
        written.append(arguments)
        if len(written) > 20:
            raise OSError(28, "No space left on device")
        put(*arguments)

    with monkeypatch.context() as patched:
        patched.setattr(store, "put", full)
        result = run(study, "-o", tmp_path / "a.zarr")
    assert result.exit_code == 1
    output = words(result.output)
    assert f"{tmp_path / 'a.zarr'} cannot be written: No space left on device." in output
    assert "What is done is kept; the same command with --resume goes on." in output
    result = run(study, "-o", tmp_path / "a.zarr", "--resume")
    assert "blocks were done before" in words(result.output)
    assert result.exit_code == 0


def test_a_netcdf_that_the_disk_does_not_take_is_told(study: Path, tmp_path: Path) -> None:
    resource = pytest.importorskip("resource", reason="Windows has no limit of sizes")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, before[1]))
    try:
        result = run(study, "-o", tmp_path / "a.nc")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert result.exit_code == 1
    assert "a.nc cannot be written: NetCDF: HDF error (is the disk full?)." in words(result.output)
    assert "Traceback" not in result.output
    assert [one.name for one in tmp_path.iterdir()] == ["study.toml"]


def test_zarr_is_for_one_study_and_replaces_nothing(study: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.toml"
    other.write_text(STUDY)
    result = run(study, other, "-o", tmp_path / "a.zarr")
    assert result.exit_code == 2
    assert "a.zarr is for one study. Give a folder." in words(result.output)
    (tmp_path / "a.zarr").mkdir()
    refusal = "a.zarr exists already. Remove the existing output, or give another name."
    for more in ((), ("--force",), ("--resume",)):
        result = run(study, "-o", tmp_path / "a.zarr", *more)
        assert result.exit_code == 2
        assert refusal in words(result.output)


def test_a_simulation_is_stored_block_by_block_too(study: Path, tmp_path: Path) -> None:
    study.write_text(
        'kind = "simulate"\nscene = "rectangle-on-plane"\noutputs = ["conveying_velocity"]\n'
        '[parameters]\nfrequency = 50\namplitude = ["0.1 mm", "0.3 mm"]\nbeta = 30\n'
        "friction = 0.4\n"
    )
    result = run(study, "-o", tmp_path / "b.zarr")
    assert result.exit_code == 0, result.output
    assert "conveying_velocity" in result.output
    assert run(study, "-o", tmp_path / "b.nc").exit_code == 0
    with (
        xarray.open_zarr(tmp_path / "b.zarr") as found,
        xarray.open_dataset(tmp_path / "b.nc") as one,
    ):
        xarray.testing.assert_equal(found.load(), one.load())
    assert "is complete already" in words(run(study, "-o", tmp_path / "b.zarr", "--resume").output)


def test_an_unknown_store_is_told_in_one_line(study: Path) -> None:
    result = run(study, "-o", "nothing://bucket/key")
    assert result.exit_code == 1
    assert "nothing://bucket/key cannot be written" in words(result.output)
    assert "Traceback" not in result.output


def test_an_object_store_takes_the_group(study: Path, tmp_path: Path) -> None:
    (tmp_path / "bucket").mkdir()
    target = (tmp_path / "bucket").as_uri()
    result = run(study, "-o", target)
    assert result.exit_code == 0, result.output
    with xarray.open_zarr(tmp_path / "bucket") as found:
        check(found, study)
    assert "exists already" in words(run(study, "-o", target).output)
    assert "is complete already" in words(run(study, "-o", target, "--resume").output)
