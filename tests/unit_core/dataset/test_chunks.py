"""Chunks written past HDF5: HDF5 reads the files, and a run goes on to the same bytes.

What is relied on and not promised by HDF5: that it places chunks by their lengths alone.
"""

from __future__ import annotations

import h5py
import netCDF4
import numpy as np
import pytest

from vibrafeed.core.dataset import layout
from vibrafeed.core.dataset.chunks import ChunkFile
from vibrafeed.core.dataset.layout import Layout
from vibrafeed.core.dataset.netcdf import define, tiles_of
from vibrafeed.core.dataset.table import Table, TableVariable

SHAPE = (300, 90)
RANDOM = np.random.default_rng(31)
VALUES = {
    "rounded": np.round(RANDOM.normal(size=SHAPE), 2),
    "single": RANDOM.normal(size=SHAPE).astype(np.float32),
    "regime": RANDOM.integers(0, 3, SHAPE).astype(np.int8),
}


@pytest.fixture
def table(monkeypatch):
    """Return a table of several tiles of several chunks."""
    monkeypatch.setattr(layout, "CHUNK_CELLS", 1000)
    monkeypatch.setattr(layout, "TILE_CELLS", 8000)
    axes = {
        name: TableVariable((name,), np.arange(size, dtype=float), {})
        for name, size in zip(("x", "y"), SHAPE, strict=True)
    }
    arrays = {name: TableVariable(("x", "y"), values, {}) for name, values in VALUES.items()}
    return Table(axes, arrays, {"title": "chunks"})


def written(path, table, compression, *, broken_off_after=None):
    """Write the chunks of a table; by two runs, if the first one is broken off."""
    define(path, table, history=None, compression=compression)
    begun = path.read_bytes()
    tiles = list(tiles_of(table))
    assert len(tiles) > 3
    arrays = [
        {n: v.values[tuple(slice(*ends) for ends in tile.box)] for n, v in table.variables.items()}
        for tile in tiles
    ]
    done = []
    if broken_off_after is not None:
        with ChunkFile(path, threads=1) as file:
            done = [file.write(*both) for both in zip(tiles, arrays, strict=True)][
                :broken_off_after
            ]
        # HDF5 is told the file as it began; what chunks hold stays where it is.
        with path.open("r+b") as file:
            file.write(begun)
    with ChunkFile(path, threads=2) as file:
        for tile, (lengths, checksum) in zip(tiles, done, strict=False):
            assert file.pass_over(tile, lengths) == checksum
        for tile, part in list(zip(tiles, arrays, strict=True))[len(done) :]:
            file.write(tile, part)
        file.close()
    return path.read_bytes()


@pytest.mark.parametrize("compression", [True, False])
def test_hdf5_and_netcdf_read_what_was_written(tmp_path, table, compression):
    written(tmp_path / "a.nc", table, compression)
    with netCDF4.Dataset(tmp_path / "a.nc") as one, h5py.File(tmp_path / "a.nc") as other:
        for name, values in VALUES.items():
            np.testing.assert_array_equal(one[name][...], values)
            np.testing.assert_array_equal(other[name][...], values)


@pytest.mark.parametrize("compression", [True, False])
def test_a_run_that_was_broken_off_goes_on_to_the_same_bytes(tmp_path, table, compression):
    whole = written(tmp_path / "whole.nc", table, compression)
    for count in (1, 3):
        path = tmp_path / f"{count}.nc"
        assert written(path, table, compression, broken_off_after=count) == whole


def test_chunks_that_changed_on_the_disk_are_told_by_their_checksum(tmp_path, table):
    path = tmp_path / "a.nc"
    define(path, table, history=None, compression=False)
    begun = path.read_bytes()
    (tile, *_), arrays = tiles_of(table), VALUES
    part = {n: v[tuple(slice(*ends) for ends in tile.box)] for n, v in arrays.items()}
    with ChunkFile(path) as file:
        lengths, checksum = file.write(tile, part)
    spoilt = bytearray(path.read_bytes())
    assert len(spoilt) > len(begun)
    spoilt[-100] ^= 1
    path.write_bytes(begun + spoilt[len(begun) :])
    with ChunkFile(path) as file:
        assert file.pass_over(tile, lengths) != checksum


def test_other_filters_of_hdf5_are_refused():
    from vibrafeed.core.dataset.chunks import encoder

    with pytest.raises(NotImplementedError, match="filters"):
        encoder([32015])


def test_the_layout_that_chunks_have_is_that_of_the_file(tmp_path, table):
    define(tmp_path / "a.nc", table, history=None, compression=True)
    with h5py.File(tmp_path / "a.nc") as file:
        assert file["rounded"].chunks == Layout.of(SHAPE).chunk
