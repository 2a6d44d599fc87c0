"""A sweep computed tile by tile is the sweep computed as a whole, killed or not."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray

from tools import tool
from vibrafeed.core.dataset.files import partial
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.plan.tiles import Tiled
from vibrafeed.core.sweep.stream import outline_table, stream
from vibrafeed.core.sweep.targets import is_complete, open_target
from vibrafeed.core.watch import Watch

STUDY = {
    "kind": "sweep",
    "scene": "rectangle-on-track",
    "outputs": ["transport_velocity", "throw_number", "gravity_along"],
    "verify": 5,
    "parameters": {
        "frequency": {"start": 20, "stop": 120, "num": 12},
        "amplitude": {"start": "0.1 mm", "stop": "1 mm", "num": 14},
        "alpha": {"start": 0, "stop": 90, "num": 13},
        "beta": {"start": 0, "stop": 90, "num": 90},
        "friction": 0.3,
        "radius": 0.8,
        "distance": "0.2 mm",
        "gamma": 3,
    },
}


@pytest.fixture(autouse=True)
def small_tiles(monkeypatch):
    monkeypatch.setattr("vibrafeed.core.dataset.layout.TILE_CELLS", 20_000)
    monkeypatch.setattr("vibrafeed.core.dataset.layout.CHUNK_CELLS", 2_000)


@pytest.fixture
def sweep():
    return prepare_content(STUDY)


def streamed(sweep, path, *, stop_after=None, **options):
    """Stream a sweep to a path; return whether it is whole, and the tiles that were there."""
    asked = iter(range(10**9))
    watch = Watch(stop=lambda: stop_after is not None and next(asked) >= stop_after)
    target = open_target(path, sweep, outline_table(sweep), **options)
    there = target.done
    try:
        return stream(sweep, target, watch)[1], there
    finally:
        target.close()


def contents(path: Path) -> dict[str, bytes]:
    files = [path] if path.is_file() else sorted(one for one in path.rglob("*") if one.is_file())
    return {str(one.relative_to(path)): one.read_bytes() for one in files}


@pytest.mark.parametrize("compression", [True, False])
def test_the_file_is_the_one_written_from_memory(sweep, compression, tmp_path):
    assert len(Tiled(sweep).tiles) > 10
    streamed(sweep, tmp_path / "tiles.nc", compression=compression)
    table = tabulate(sweep)
    write_netcdf(table, tmp_path / "memory.nc", compression=compression)
    assert (tmp_path / "tiles.nc").read_bytes() == (tmp_path / "memory.nc").read_bytes()
    assert not partial(tmp_path / "tiles.nc").exists()
    with (
        xarray.open_dataset(tmp_path / "tiles.nc") as found,
        h5py.File(tmp_path / "tiles.nc") as h5,
    ):
        for name, variable in table.variables.items():
            np.testing.assert_array_equal(found[name].values, variable.values)
            np.testing.assert_array_equal(h5[name][...], variable.values)
        assert found.attrs["verified_cells"] == 5
    dump = subprocess.run(
        [tool("ncdump"), "-h", tmp_path / "tiles.nc"], capture_output=True, text=True, check=True
    )
    assert "double transport_velocity(frequency, amplitude, alpha, beta)" in dump.stdout


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", ["a.nc", "a.zarr"])
def test_a_run_that_was_stopped_goes_on_to_the_same_bytes(sweep, name, tmp_path):
    whole, part = tmp_path / f"whole-{name}", tmp_path / name
    assert streamed(sweep, whole) == (True, 0)
    assert streamed(sweep, part, stop_after=3) == (False, 0)
    assert not part.exists()
    assert streamed(sweep, part, stop_after=2, resume=True) == (False, 3)
    assert streamed(sweep, part, resume=True) == (True, 5)
    assert contents(part) == contents(whole)
    assert is_complete(str(part), sweep)
    assert not is_complete(str(part), prepare_content({**STUDY, "verify": 6}))


def test_without_resume_or_for_another_study_it_begins_anew(sweep, tmp_path):
    path = tmp_path / "a.nc"
    streamed(sweep, path, stop_after=3)
    assert streamed(sweep, path, stop_after=4) == (False, 0)
    other = prepare_content({**STUDY, "title": "another"})
    assert streamed(other, path, stop_after=4, resume=True) == (False, 0)
    assert streamed(other, path, stop_after=4, resume=True, compression=False) == (False, 0)


@pytest.mark.by_day(1)
@pytest.mark.parametrize("damage", ["torn journal", "changed chunk", "lost end", "changed start"])
def test_what_is_damaged_is_made_again(sweep, damage, tmp_path):
    whole, part = tmp_path / "whole.nc", tmp_path / "a.nc"
    streamed(sweep, whole)
    streamed(sweep, part, stop_after=6)
    folder = partial(part)
    if damage == "torn journal":
        journal = (folder / "journal").read_bytes()
        (folder / "journal").write_bytes(journal[:-10])
    elif damage == "changed start":
        (folder / "start").write_bytes(b"no file")
    else:
        with (folder / "data").open("r+b") as file:
            size = os.fstat(file.fileno()).st_size
            if damage == "lost end":
                file.truncate(size // 2)
            else:
                file.seek(size - 5000)
                file.write(b"?" * 100)
    finished, there = streamed(sweep, part, resume=True)
    assert finished
    assert there < 6
    assert part.read_bytes() == whole.read_bytes()


def test_two_runs_do_not_write_one_file(sweep, tmp_path):
    one = open_target(tmp_path / "a.nc", sweep, outline_table(sweep))
    with pytest.raises(BlockingIOError):
        open_target(tmp_path / "a.nc", sweep, outline_table(sweep))
    one.close()


def test_a_tile_never_takes_the_place_of_one_that_could_not_be_written(sweep, tmp_path):
    target = open_target(tmp_path / "a.nc", sweep, outline_table(sweep))
    with pytest.raises(VibrafeedError, match="tile 1 cannot follow 0 tiles"):
        target.write(1, Tiled(sweep).values(target.tiles[1]), 0.0)
    target.close()


def test_a_tile_that_differs_from_what_was_verified_is_an_error(sweep, tmp_path, monkeypatch):
    plain = Tiled.values
    monkeypatch.setattr(
        Tiled, "values", lambda self, tile: {n: v + 1 for n, v in plain(self, tile).items()}
    )
    with pytest.raises(VibrafeedError, match="differs from the same cells computed one by one"):
        streamed(sweep, tmp_path / "a.nc")
    assert not (tmp_path / "a.nc").exists()


def test_a_zarr_group_is_the_dataset_and_has_one_shard_a_tile(sweep, tmp_path):
    path = tmp_path / "a.zarr"
    streamed(sweep, path)
    expected = tabulate(sweep).with_price({}).to_xarray()
    with xarray.open_zarr(path) as found:
        xarray.testing.assert_equal(found.load(), expected)
        assert found.regime.dtype == np.int8
        assert dict(found.attrs) == expected.attrs
    tiles = Tiled(sweep).tiles
    shards = [one for one in path.rglob("c/*/**/*") if one.is_file()]
    in_fields = [one for one in shards if one.relative_to(path).parts[0] not in expected.coords]
    assert len(in_fields) == sum(f.layout.tiles * len(f.names) for f in tiles.fields)
    document = json.loads((path / "transport_velocity" / "zarr.json").read_text())
    assert document["codecs"][0]["name"] == "sharding_indexed"
    with pytest.raises(FileExistsError):
        streamed(sweep, path)


def test_a_torn_shard_is_made_again(sweep, tmp_path):
    whole, part = tmp_path / "whole.zarr", tmp_path / "a.zarr"
    streamed(sweep, whole)
    streamed(sweep, part, stop_after=5)
    shard = next(p for p in partial(part).rglob("transport_velocity/c/**/*") if p.is_file())
    shard.write_bytes(shard.read_bytes()[:-7])
    assert streamed(sweep, part, resume=True) == (True, 4)
    assert contents(part) == contents(whole)


def test_the_outline_of_a_huge_sweep_takes_no_memory():
    axes = {
        name: {"start": 1, "stop": 2, "num": 3000} for name in ("frequency", "amplitude", "beta")
    }
    study = {**STUDY, "verify": 2, "parameters": {**STUDY["parameters"], **axes}}
    table = outline_table(prepare_content(study))
    assert table.variables["regime"].values.size > 10**11
    assert table.attributes["verified_cells"] == 2


DRIVE = {"frequency": [30, 60, 90], "amplitude": ["0.05 mm", "0.2 mm", "0.8 mm"], "beta": [10, 40]}


@pytest.mark.parametrize(
    ("scene", "output", "more"),
    [
        pytest.param("sphere-on-plane", "required_friction", {}, id="the verdict has more axes"),
        pytest.param("rectangle-on-plane", "floor_force", {"mass": [1, 2]}, id="fewer axes"),
        pytest.param("cylinder-on-plane", "angular_acceleration", {"diameter": [0.01, 0.02]},
                     id="other axes"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("cells", [2, 7, 10_000])
def test_extremes_are_of_valid_cells_whatever_axes_the_verdict_has(
    monkeypatch, tmp_path, scene, output, more, cells
) -> None:
    """Invalid cells were among them where a verdict has other axes than its output."""
    monkeypatch.setattr("vibrafeed.core.dataset.layout.TILE_CELLS", cells)
    monkeypatch.setattr("vibrafeed.core.dataset.layout.CHUNK_CELLS", cells)
    content = {"kind": "sweep", "scene": scene, "outputs": [output]}
    if scene == "cylinder-on-plane":
        content["variant"] = "thesis"
    friction = {} if output == "floor_force" else {"friction": [0.1, 0.3, 0.6]}
    sweep = prepare_content({**content, "parameters": {**DRIVE, **friction, **more}})
    assert set(sweep.dims[output]) != set(sweep.dims["regime"])
    table = tabulate(sweep)
    valid = table.variables[output].values[table.valid(output)]
    assert 0 < valid.size < table.variables[output].values.size
    target = open_target(tmp_path / "result.nc", sweep, outline_table(sweep))
    passed, whole = stream(sweep, target)
    assert whole
    assert passed.ends == {output: (valid.min(), valid.max())}
