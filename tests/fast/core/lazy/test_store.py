"""A study that is stored block by block is the study in memory, stopped, killed or not."""

import itertools
import tracemalloc
from pathlib import Path
from typing import Any

import cloudpickle
import pytest
import xarray
import zarr

from large_studies import MOTION, TRACK, sweep_of
from vibrafeed.core.dataset.files import partial
from vibrafeed.core.dataset.stores import attributes_at, keys_in, open_group
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.lazy import store
from vibrafeed.core.lazy.store import Blocks, ZarrStore, store_netcdf
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.watch import Watch

FLAT = {**MOTION, "outputs": ["conveying_velocity", "motion_status"]}
"""Motion of which some parts rest."""
THREADS = Watch(threads=2)


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch):
    monkeypatch.setattr(store, "STORED_CELLS", 300)


def stopping(after: int) -> Watch:
    """Return a watch that stops when it has been asked so many times."""
    asked = itertools.count()
    return Watch(threads=1, stop=lambda: next(asked) >= after)


def begun(prepared: Prepared, where: Path | str, *, resume: bool = False) -> ZarrStore:
    group = ZarrStore(prepared, str(where))
    group.begin(outline(prepared), resume=resume)
    return group


def to_zarr(
    prepared: Prepared, where: Path | str, watch: Watch = THREADS, *, resume: bool = False
) -> None:
    group = begun(prepared, where, resume=resume)
    group.store(watch)
    group.finish()


def to_netcdf(prepared: Prepared, path: Path, watch: Watch = THREADS, **more: bool) -> None:
    store_netcdf(prepared, outline(prepared), path, watch, **more)


FORMS: dict[str, Any] = {
    "nc": (to_netcdf, xarray.open_dataset), "zarr": (to_zarr, xarray.open_zarr),
}  # fmt: skip


def files(folder: Path) -> dict[str, bytes]:
    return {key: (folder / key).read_bytes() for key in keys_in(str(folder))}


CONTENTS: dict[str, dict[str, Any]] = {
    "sweep": {**TRACK, "verify": 3},
    "motion": MOTION,
    "an output without axes": {
        **TRACK, "scene": "rectangle-on-plane",
        "outputs": ["vibration_acceleration", "acceleration_x"],
        "parameters": {"frequency": 50, "amplitude": 2e-4, "friction": [0.2, 0.4],
                       "beta": {"start": 0, "stop": 60, "num": 150}},
    },
    "a verdict with more axes, values that are NaN": {
        **TRACK, "scene": "sphere-on-plane", "outputs": ["required_friction"],
        "parameters": {"frequency": {"start": 30, "stop": 90, "num": 30}, "beta": [10, 40],
                       "amplitude": ["0.05 mm", "0.2 mm", "0.8 mm"], "friction": [0.1, 0.3, 0.6]},
    },
    "regimes that are all 0": {
        **TRACK, "scene": "rectangle-on-plane", "outputs": ["acceleration_x"],
        "parameters": {"frequency": 50, "amplitude": 1e-5, "friction": 0.4,
                       "beta": {"start": 0, "stop": 30, "num": 250}},
    },
    "one cell": {**TRACK, "parameters": {**TRACK["parameters"], "frequency": 50, "alpha": 3,
                                         "amplitude": 2e-4, "beta": 20}},
}  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("content", CONTENTS.values(), ids=list(CONTENTS))
def test_the_file_holds_what_a_run_in_memory_holds(content, form, tmp_path):
    prepared = prepare_content(content)
    write, opened = FORMS[form]
    write(prepared, tmp_path / f"a.{form}")
    table = tabulate(prepared)
    with opened(tmp_path / f"a.{form}") as found:
        found.load()
        xarray.testing.assert_equal(found, table.with_price({}).to_xarray())
        for name, variable in table.variables.items():
            assert found[name].dtype == variable.values.dtype
            assert found[name].attrs["long_name"] == variable.attributes["long_name"]
        assert found.attrs["study_sha256"] == prepared.study.key()
        assert found.attrs["comment"] == table.attributes["comment"]
        assert found.attrs.get("verified_cells") == content.get("verify")


@pytest.mark.parametrize(("content", "cells"), [(TRACK, 900), (MOTION, 30)])
def test_a_group_that_was_stopped_goes_on_to_the_same_bytes(content, cells, tmp_path, monkeypatch):
    monkeypatch.setattr(store, "STORED_CELLS", cells)
    prepared = prepare_content(content)
    to_zarr(prepared, tmp_path / "whole.zarr")
    part, under_way = tmp_path / "a.zarr", partial(tmp_path / "a.zarr")
    with pytest.raises(StoppedError):
        to_zarr(prepared, part, stopping(4))
    assert not part.exists()
    assert "unfinished" in open_group(str(under_way)).attrs
    again = prepare_content(content)  # of another process, which has no price yet
    missing = ZarrStore(again, str(part)).missing()
    assert 0 < len(missing) < len(Blocks(prepared))
    with xarray.open_zarr(under_way) as growing:
        assert any(growing[name].isnull().any() for name in prepared.plan.outputs)
    whole = files(tmp_path / "whole.zarr")
    lost = next(name for name in sorted(files(under_way)) if "velocity/c/" in name)
    (under_way / lost).rename((under_way / lost).with_name("0.1a2b.partial"))  # as a kill leaves it
    assert len(ZarrStore(again, str(part)).missing()) == len(missing) + 1
    to_zarr(again, part, resume=True)
    assert not under_way.exists()
    assert files(part) == whole


def test_what_another_study_or_version_has_begun_is_begun_anew(tmp_path, monkeypatch):
    where, first = tmp_path / "a.zarr", prepare_content(TRACK)
    parameters = {**TRACK["parameters"], "friction": 0.4, "beta": [1, 2]}
    other = prepare_content({**TRACK, "parameters": parameters})
    with pytest.raises(StoppedError):
        to_zarr(first, where, stopping(4))
    for prepared, version in ((other, None), (first, None), (first, "0.0.1")):
        if version is not None:
            monkeypatch.setattr("vibrafeed.core.__version__", version)
        group = begun(prepared, where, resume=True)
        assert len(group.missing()) == len(Blocks(prepared))
        group.write(0, Watch(threads=1))
    assert len(begun(first, where).missing()) == len(Blocks(first))
    to_zarr(first, where, resume=True)
    found = xarray.open_zarr(where).load()
    xarray.testing.assert_equal(found, tabulate(first).with_price({}).to_xarray())


@pytest.mark.parametrize("place", ["a.zarr", ".a.zarr.partial"])
@pytest.mark.parametrize("resume", [False, True])
def test_other_files_are_left_alone(place, resume, tmp_path):
    (tmp_path / place).mkdir()
    (tmp_path / place / "letter.txt").write_text("Dear Sir")
    with pytest.raises(FileExistsError):
        begun(prepare_content(TRACK), tmp_path / "a.zarr", resume=resume)
    assert (tmp_path / place / "letter.txt").read_text() == "Dear Sir"


def test_a_group_that_broke_off_while_it_was_created_is_begun_anew(tmp_path):
    zarr.open_group(tmp_path / ".a.zarr.partial", mode="w")
    prepared = prepare_content(TRACK)
    assert len(begun(prepared, tmp_path / "a.zarr", resume=True).missing()) == len(Blocks(prepared))


def test_an_object_store_takes_the_group(tmp_path, monkeypatch):
    monkeypatch.setattr(store, "STORED_CELLS", 900)
    prepared, where = prepare_content(TRACK), (tmp_path / "bucket").as_uri()
    (tmp_path / "bucket").mkdir()
    with pytest.raises(StoppedError):
        to_zarr(prepared, where, stopping(4))
    assert attributes_at(where) == {}
    to_zarr(prepared, where, resume=True)
    assert attributes_at(where)["study_sha256"] == prepared.study.key()
    to_zarr(prepared, tmp_path / "a.zarr")
    assert files(tmp_path / "bucket") == files(tmp_path / "a.zarr")
    with pytest.raises(FileExistsError, match="exists already"):
        to_zarr(prepared, where)


@pytest.mark.parametrize("compression", [True, False])
def test_equal_studies_give_equal_bytes(compression, tmp_path):
    for threads in (1, 3):
        path = tmp_path / f"{threads}.nc"
        to_netcdf(prepare_content(TRACK), path, Watch(threads=threads), compression=compression)
    assert (tmp_path / "1.nc").read_bytes() == (tmp_path / "3.nc").read_bytes()


def test_a_netcdf_that_is_stopped_or_fails_leaves_nothing(tmp_path):
    resource = pytest.importorskip("resource", reason="Windows has no limit of sizes")
    prepared = prepare_content(TRACK)
    with pytest.raises(StoppedError):
        to_netcdf(prepared, tmp_path / "a.nc", stopping(4))
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, before[1]))
    try:
        with pytest.raises(OSError, match="is the disk full"):
            to_netcdf(prepared, tmp_path / "a.nc")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize("form", FORMS)
def test_10_8_cells_take_the_memory_of_some_blocks(form, tmp_path, monkeypatch):
    monkeypatch.undo()
    prepared = prepare_content(sweep_of(300, axes=3))
    assert prepared.cells > 10**8
    tracemalloc.start()
    try:
        with pytest.raises(StoppedError):
            FORMS[form][0](prepared, tmp_path / f"a.{form}", stopping(3))
        assert tracemalloc.get_traced_memory()[1] < 2e8
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("content", [TRACK, FLAT], ids=["sweep", "motion"])
def test_a_worker_that_gets_the_group_by_wire_has_the_same_blocks(content, tmp_path):
    group = begun(prepare_content(content), tmp_path / "a.zarr")
    other: ZarrStore = cloudpickle.loads(cloudpickle.dumps(group))
    ours, theirs = Blocks(group.prepared), Blocks(other.prepared)
    assert [one.box for one in ours] == [one.box for one in theirs]
    other.write(len(theirs) - 1, Watch(threads=1))
    assert len(group.missing()) == len(ours) - 1
