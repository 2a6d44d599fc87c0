"""Tables as rows and columns, and NetCDF files read back."""

from __future__ import annotations

import csv as reader
import io

import numpy as np
import pytest

from posted_sweeps import STUDY
from vibrafeed.core.dataset.frame import Frame, csv, parquet
from vibrafeed.core.dataset.netcdf import write_netcdf
from vibrafeed.core.dataset.read import read_netcdf
from vibrafeed.core.dataset.table import Table, TableVariable
from vibrafeed.core.errors import LimitError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate

FLAGS = {"flag_values": np.array([1, 5], dtype=np.int8), "flag_meanings": "slide flight"}


@pytest.fixture
def table() -> Table:
    """Return a table with everything that is awkward."""
    return Table(
        {
            "a": TableVariable(("a",), np.array([1.0, 0.1, 1e-300]), {"units": "Hz"}),
            "b": TableVariable(("b",), np.array([1, 2]), {}),
            "c": TableVariable((), np.array(7.5), {"units": "1"}),
        },
        {
            "turned": TableVariable(("b", "a"), np.arange(6.0).reshape(2, 3), {"units": "m"}),
            "short": TableVariable(("b",), np.array([np.nan, -np.inf]), {}),
            "told": TableVariable(("a",), np.array(['x,"y"', "", "z"], dtype=object), {}),
            "regime": TableVariable(("a",), np.array([1, 5, 9], dtype=np.int8), FLAGS),
        },
        {"title": "T"},
    )


def test_csv(table):
    text = b"".join(csv(Frame.of(table))).decode()
    heading, *rows = reader.reader(io.StringIO(text, newline=""))
    assert heading == ["a [Hz]", "b", "c", "turned [m]", "short", "told", "regime"]
    assert rows == [
        ["1.0", "1", "7.5", "0.0", "", 'x,"y"', "slide"],
        ["1.0", "2", "7.5", "3.0", "-inf", 'x,"y"', "slide"],
        ["0.1", "1", "7.5", "1.0", "", "", "flight"],
        ["0.1", "2", "7.5", "4.0", "-inf", "", "flight"],
        ["1e-300", "1", "7.5", "2.0", "", "z", ""],
        ["1e-300", "2", "7.5", "5.0", "-inf", "z", ""],
    ]


def test_parquet(table, monkeypatch):
    library = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr("vibrafeed.core.dataset.frame.PARQUET_ROWS", 4)  # two groups
    content = b"".join(parquet(Frame.of(table)))
    found = library.read_table(io.BytesIO(content))
    assert library.ParquetFile(io.BytesIO(content)).num_row_groups == 2
    assert found["turned"].to_pylist() == [0, 3, 1, 4, 2, 5]
    assert found["told"].to_pylist()[:2] == ['x,"y"', 'x,"y"']
    assert found["regime"].to_pylist() == ["slide"] * 2 + ["flight"] * 2 + [None] * 2
    assert np.isnan(found["short"].to_numpy()[0])
    assert found.field("a").metadata == {b"units": b"Hz"}
    assert found.schema.metadata[b"title"] == b"T"
    assert b"1 of 3 cells" in found.schema.metadata[b"note"]


def test_a_limit_of_rows(table):
    with pytest.raises(LimitError, match="6 rows, the limit is 5"):
        Frame.of(table, most=5)


def test_a_file_is_read_back(tmp_path):
    table = tabulate(prepare_content(STUDY))
    write_netcdf(table, tmp_path / "x.nc")
    found = read_netcdf(tmp_path / "x.nc")
    for name in ("coordinates", "variables"):
        ours, theirs = getattr(table, name), getattr(found, name)
        assert ours.keys() == theirs.keys()
        for key, variable in ours.items():
            assert theirs[key].dims == variable.dims
            np.testing.assert_array_equal(theirs[key].values, variable.values)
            for attribute, value in variable.attributes.items():
                np.testing.assert_array_equal(theirs[key].attributes[attribute], value)
    assert dict(found.attributes) == dict(table.attributes)
    assert b"".join(csv(Frame.of(found))) == b"".join(csv(Frame.of(table)))
    with pytest.raises(LimitError, match="1,540 rows"):
        read_netcdf(tmp_path / "x.nc", most_rows=1000)


def test_what_is_read_back_of_a_simulation(tmp_path):
    study = {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "outputs": ["conveying_velocity"],
        "parameters": {"frequency": 50, "beta": 30, "friction": 0.4, "amplitude": [1e-4, 4e-4]},
    }
    table = tabulate(prepare_content(study))
    write_netcdf(table, tmp_path / "x.nc")
    ours, theirs = (b"".join(csv(Frame.of(one))) for one in (table, read_netcdf(tmp_path / "x.nc")))
    assert ours == theirs
