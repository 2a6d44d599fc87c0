"""Sweeps of any size from the command line: room, stopping, killing, going on, object stores."""

from __future__ import annotations

import hashlib
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import namedtuple
from io import FileIO
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from night import NIGHT
from vibrafeed.app.cli import app
from waiting import PATIENCE

KILLS = 2 if NIGHT else 1

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

# The command with small tiles, each taking a while, so that there is time to kill it.
SLOW = """
import sys, time
from vibrafeed.core.dataset import layout
from vibrafeed.core.plan.tiles import Tiled
layout.TILE_CELLS, layout.CHUNK_CELLS = 10_000, 1_000
plain = Tiled.values
def slow(self, tile):
    time.sleep(float(sys.argv[1]))
    return plain(self, tile)
Tiled.values = slow
from vibrafeed.app.cli import app
app(sys.argv[2:])
"""


@pytest.fixture
def study(tmp_path: Path, monkeypatch) -> Path:
    monkeypatch.setattr("vibrafeed.core.dataset.layout.TILE_CELLS", 10_000)
    monkeypatch.setattr("vibrafeed.core.dataset.layout.CHUNK_CELLS", 1_000)
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def run(*arguments: object):
    return CliRunner().invoke(app, ["run", *map(str, arguments)])


def started(wait: float, *arguments: object) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", SLOW, str(wait), "run", *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def words(output: str) -> str:
    return " ".join(output.split())


def comparable(path: Path) -> object:
    """Return what two runs of equal studies have in common: all but when it was, and its price."""
    if path.is_dir():
        text = (path / "zarr.json").read_text()
        files = {p.relative_to(path): p.read_bytes() for p in path.rglob("c/**/*") if p.is_file()}
        return re.sub(r'"(history|elapsed_seconds|cells_per_second)": [^,}]*(, )?', "", text), files
    with h5py.File(path, "r+") as file:
        for name in (b"history", b"elapsed_seconds", b"cells_per_second"):
            attribute = h5py.h5a.open(file.id, name)
            attribute.write(np.zeros(attribute.shape, attribute.dtype))
    return hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    "options", [["a.nc"], pytest.param(["a.nc", "--plain"], marks=pytest.mark.night), ["a.zarr"]]
)
def test_a_killed_run_leaves_nothing_and_goes_on_to_the_same_result(study, tmp_path, options):
    target, whole = tmp_path / options[0], tmp_path / f"whole-{options[0]}"
    assert run(study, "-o", whole, *options[1:]).exit_code == 0
    folder = tmp_path / f".{target.name}.partial"
    for kill in range(KILLS):
        more = ["--resume"] if kill else []
        process = started(0.05, study, "-o", target, *options[1:], *more)
        before = records(folder) if kill else 0
        while records(folder) < before + 6 // KILLS and process.poll() is None:
            time.sleep(0.01)
        process.kill()
        process.communicate()
        assert not target.exists()
        assert folder.exists()
    result = run(study, "-o", target, *options[1:], "--resume")
    assert result.exit_code == 0, result.output
    found = re.search(r"continuing: (\d+) of (\d+) tiles were done before", words(result.output))
    done, tiles = map(int, found.groups())
    assert 4 < done < tiles
    assert comparable(target) == comparable(whole)
    assert not folder.exists()
    again = run(study, "-o", target, *options[1:], "--resume")
    assert f"{target} is complete already" in words(again.output)


def records(folder: Path) -> int:
    """Return how far a run is: lines of its journal, or shards."""
    journal = folder / "journal"
    if folder.suffixes[0] == ".zarr" or not journal.exists():
        return sum(1 for _ in folder.rglob("transport_velocity/c/*/*/*/*"))
    return journal.read_bytes().count(b"\n")


def test_an_interrupt_stops_between_tiles_and_says_how_to_go_on(study, tmp_path):
    target = tmp_path / "a.nc"
    process = started(0.1, study, "-o", target)
    while records(tmp_path / ".a.nc.partial") < 3 and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    output = words(process.communicate(timeout=PATIENCE)[0])
    assert process.returncode == 1
    assert re.search(r"it was stopped; \d+ of \d+ tiles are done", output)
    assert f"What is done is kept in {tmp_path / '.a.nc.partial'}" in output
    assert "To go on, give the same command with --resume." in output
    assert not target.exists()
    assert run(study, "-o", target, "--resume").exit_code == 0
    with xarray.open_dataset(target) as found:
        assert found.sizes["frequency"] == 40


def test_a_time_limit_stops_it_too(study, tmp_path):
    result = run(study, "-o", tmp_path / "a.nc", "--time-limit", 0)
    assert result.exit_code == 1
    assert "it was stopped while cells were verified; nothing is written" in words(result.output)


def test_before_the_start_it_says_how_large_it_is(study, tmp_path):
    output = words(run(study, "-o", tmp_path / "a.nc").output)
    assert re.search(
        r"416,000 cells, 4,000,000 bytes, about \S+ GB in the file, \S+ GB are", output
    )
    assert "416,000 cells in" in output
    assert "transport_velocity" in output


Usage = namedtuple("Usage", "total used free")


def test_what_the_disk_cannot_hold_is_refused_with_what_fits(study, tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda path: Usage(10**9, 0, 2_000_000))
    result = run(study, "-o", tmp_path / "a.nc", "--plain")
    assert result.exit_code == 2
    output = words(result.output)
    assert f"output: it takes 0.004 GB, and the disk of {tmp_path} has 0.002 GB" in output
    assert "It fits with 20 instead of 40 values of frequency, or perhaps without --plain" in output
    assert not list(tmp_path.glob(".a*"))


def test_a_disk_that_fills_up_is_told_and_what_is_there_is_kept(study, tmp_path, monkeypatch):
    written = []

    class Full(FileIO):
        def write(self, data):
            written.append(len(data))
            if sum(written) > 500_000:
                raise OSError(28, "No space left on device")
            return super().write(data)

    monkeypatch.setattr("vibrafeed.core.dataset.chunks.FileIO", Full)
    result = run(study, "-o", tmp_path / "a.nc")
    assert result.exit_code == 1
    assert f"{tmp_path / 'a.nc'} cannot be written: No space left on device." in words(
        result.output
    )
    monkeypatch.undo()
    monkeypatch.setattr("vibrafeed.core.dataset.layout.TILE_CELLS", 10_000)
    monkeypatch.setattr("vibrafeed.core.dataset.layout.CHUNK_CELLS", 1_000)
    assert run(study, "-o", tmp_path / "a.nc", "--resume").exit_code == 0


def test_zarr_is_for_one_study_and_replaces_nothing(study, tmp_path):
    other = tmp_path / "other.toml"
    other.write_text(STUDY)
    result = run(study, other, "-o", tmp_path / "a.zarr")
    assert result.exit_code == 2
    assert "a.zarr is for one study. Give a folder." in words(result.output)
    (tmp_path / "a.zarr").mkdir()
    result = run(study, "-o", tmp_path / "a.zarr")
    assert result.exit_code == 2
    assert "a.zarr exists already. Remove the existing output, or give another name." in words(
        result.output
    )
    other.write_text(
        'kind = "simulate"\nscene = "rectangle-on-plane"\n[parameters]\nfrequency = 50\n'
        'amplitude = "0.1 mm"\nbeta = 30\nfriction = 0.4\n'
    )
    assert run(other, "-o", tmp_path / "b.zarr").exit_code == 0
    for more in ((), ("--force",)):
        refused = run(other, "-o", tmp_path / "b.zarr", *more)
        assert refused.exit_code == 2
        assert "b.zarr exists already. Remove the existing output, or give another name." in words(
            refused.output
        )
    again = run(other, "-o", tmp_path / "b.zarr", "--resume")
    assert "is complete already" in words(again.output)


def test_an_unknown_store_is_told_in_one_line(study):
    result = run(study, "-o", "nothing://bucket/key")
    assert result.exit_code == 1
    assert "nothing://bucket/key cannot be written" in words(result.output)
    assert "Traceback" not in result.output


@pytest.mark.night
@pytest.mark.service
def test_an_object_store_takes_the_shards_and_xarray_reads_them(study, tmp_path, monkeypatch):
    from moto.server import ThreadedMotoServer
    from obstore.store import from_url
    from zarr.storage import ObjectStore

    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    try:
        address = f"http://127.0.0.1:{server.get_host_and_port()[1]}"
        for name, value in {
            "AWS_ENDPOINT_URL": address,
            "AWS_ALLOW_HTTP": "true",
            "AWS_ACCESS_KEY_ID": "any",
            "AWS_SECRET_ACCESS_KEY": "any",
            "AWS_REGION": "us-east-1",
        }.items():
            monkeypatch.setenv(name, value)
        import boto3

        boto3.client("s3", endpoint_url=address).create_bucket(Bucket="sweeps")
        target = "s3://sweeps/some/key"
        result = run(study, "-o", target, "--time-limit", 2.5)
        if result.exit_code:
            result = run(study, "-o", target, "--resume")
        assert result.exit_code == 0, result.output
        assert run(study, "-o", tmp_path / "a.nc").exit_code == 0
        store = ObjectStore(from_url(target), read_only=True)
        with xarray.open_zarr(store) as found, xarray.open_dataset(tmp_path / "a.nc") as expected:
            xarray.testing.assert_equal(found.load(), expected.load())
        assert "exists already" in words(run(study, "-o", target).output)
        assert "is complete already" in words(run(study, "-o", target, "--resume").output)
    finally:
        server.stop()
