"""Studies of any size from the command line: room, stopping, going on, object stores."""

import re
import resource
import shutil
import signal
from collections import namedtuple

import pytest
import xarray

from commands import run, said, saved, tells
from vibrafeed.core.intake import parse_study, read_toml
from vibrafeed.core.kinds import open_lazily, prepare
from vibrafeed.core.lazy import store

STUDY = """
kind = "sweep"
scene = "rectangle-on-track"
outputs = ["transport_velocity", "throw_number"]
verify = 3

[parameters]
frequency = [20, 50, 80, 120]
amplitude = { start = "0.1 mm", stop = "1 mm", num = 20 }
alpha = { start = 0, stop = 90, num = 13 }
beta = { start = 0, stop = 90, num = 40 }
friction = 0.3
radius = 0.8
distance = "0.2 mm"
"""


@pytest.fixture(autouse=True)
def small_blocks(here, monkeypatch):
    """A study that is large, as blocks and limits are small."""
    monkeypatch.setattr(store, "STORED_CELLS", 2000)
    monkeypatch.setattr("vibrafeed.app.cli.running.LARGE_BYTES", 100_000)
    saved(STUDY)


@pytest.fixture(scope="module")
def wanted() -> xarray.Dataset:
    """The same study in memory."""
    return open_lazily(prepare(parse_study(read_toml(STUDY)))).load()


def check(found: xarray.Dataset, wanted: xarray.Dataset) -> None:
    xarray.testing.assert_equal(found.load(), wanted)
    assert found.attrs["verified_cells"] == 3
    assert "vibrafeed run study.toml" in found.attrs["history"]


def ctrl_c() -> None:
    signal.raise_signal(signal.SIGINT)


def no_space() -> None:
    raise OSError(28, "No space left on device")


def breaks(monkeypatch: pytest.MonkeyPatch, name: str, fault, call: int = 6) -> None:
    """Let something happen at a call of a function of the store."""
    plain, calls = getattr(store, name), []

    def broken(*arguments):
        calls.append(arguments)
        if len(calls) == call:
            fault()
        return plain(*arguments)

    monkeypatch.setattr(store, name, broken)


@pytest.mark.parametrize(
    ("name", "fault", "call", "words"),
    [
        (
            "compute_block",
            ctrl_c,
            6,
            r"it was stopped; \d+ of \d+ blocks are done, about [\d,]+ of 41,600 cells\. What is "
            r"done is kept in \.a\.zarr\.partial\. To go on, give the same command with --resume\.",
        ),
        (
            "put",
            no_space,
            30,
            r"a\.zarr cannot be written: No space left on device\. "
            r"What is done is kept; the same command with --resume goes on\.",
        ),
    ],
)
def test_what_is_done_is_kept_and_the_same_command_goes_on(
    here, monkeypatch, wanted, name, fault, call, words
):
    breaks(monkeypatch, name, fault, call)
    assert re.search(words, said("run study.toml -o a.zarr", 1))
    assert not (here / "a.zarr").exists()
    told = said("run study.toml -o a.zarr --resume")
    (done, of) = re.findall(r"continuing: (\d+) of (\d+) blocks were done before", told)[0]
    assert 0 < int(done) < int(of)
    with xarray.open_zarr("a.zarr") as dataset:
        check(dataset, wanted)
    assert {path.name for path in here.iterdir()} == {"study.toml", "a.zarr"}


def test_a_large_netcdf_says_that_it_begins_anew(here, monkeypatch, wanted):
    breaks(monkeypatch, "compute_block", ctrl_c)
    words = "it was stopped; nothing is written. A run to Zarr would go on."
    tells("run study.toml -o a.nc", words, code=1)
    assert [path.name for path in here.iterdir()] == ["study.toml"]
    tells(
        "run study.toml -o a.nc",
        " bytes before compression; a run to NetCDF that is stopped begins anew, one to Zarr",
        "41,600 cells, 0.000",
        "Ranges of values are not printed above 0.0001 GB.",
    )
    with xarray.open_dataset("a.nc") as found:
        check(found, wanted)


def test_a_time_limit_stops_it_too():
    told = said("run study.toml -o a.zarr --time-limit 0", 1)
    assert "it was stopped while cells were verified; nothing is written" in told


Usage = namedtuple("Usage", "total used free")


@pytest.mark.parametrize("name", ["a.nc", "a.zarr"])
def test_what_the_disk_cannot_hold_is_refused_with_what_fits(here, name, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda path: Usage(10**9, 0, 25_000))
    told = said(f"run study.toml -o {name}", 2)
    assert re.search(r"output: the result takes \S+ GB before compression; \S+ has only", told)
    assert re.search(r"It fits with \d+ instead of 40 values of", told)
    assert [path.name for path in here.iterdir()] == ["study.toml"]


def test_a_netcdf_that_the_disk_does_not_take_is_told(here):
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, before[1]))
    try:
        told = said("run study.toml -o a.nc", 1)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert "a.nc cannot be written: NetCDF: HDF error (is the disk full?)." in told
    assert [path.name for path in here.iterdir()] == ["study.toml"]


def test_an_object_store_takes_the_group(here, wanted):
    (here / "bucket").mkdir()
    target = (here / "bucket").as_uri()
    run(f"run study.toml -o {target}")
    with xarray.open_zarr(here / "bucket") as found:
        check(found, wanted)
    assert "exists already" in said(f"run study.toml -o {target}", 2)
    assert "is complete already" in said(f"run study.toml -o {target} --resume")
