"""One result in every format, read back by others: the same numbers, units and study."""

import csv as reader
import hashlib
import io
import json
import sys
import zipfile
from dataclasses import replace

import numpy as np
import openpyxl
import pandas
import pyarrow.parquet
import pytest
import scipy.io
import xarray

from results import check_same, rows, table_of_motion, written
from vibrafeed.core.dataset import frame, matlab, workbook
from vibrafeed.core.dataset.files import Storage
from vibrafeed.core.dataset.formats import FORMATS, read_result, suffix_of, write_result
from vibrafeed.core.dataset.frame import Frame, csv, parquet
from vibrafeed.core.dataset.limits import Size
from vibrafeed.core.dataset.matlab import names_in_matlab
from vibrafeed.core.dataset.read import read_netcdf
from vibrafeed.core.dataset.table import Table, TableVariable, flags_of, percent
from vibrafeed.core.errors import LimitError, MissingPackageError, VibrafeedError

FLAGS = {"flag_values": np.array([1, 5], dtype=np.int8), "flag_meanings": "slide flight"}
STUDY = '{"kind":"sweep"}'


@pytest.fixture(scope="module")
def motion() -> Table:
    return table_of_motion()


@pytest.fixture(scope="module")
def places(motion, tmp_path_factory):
    return written(motion, tmp_path_factory.mktemp("formats"))


@pytest.fixture
def awkward() -> Table:
    """Return a table with everything that no ordinary result has."""
    return Table(
        {
            "a": TableVariable(("a",), np.array([1.0, 0.1, 1e-300]), {"units": "Hz"}),
            "b": TableVariable(("b",), np.array([1, 2]), {"long_name": "Second"}),
            "c": TableVariable((), np.array(7.5), {"units": "1"}),
        },
        {
            "turned": TableVariable(("b", "a"), np.arange(6.0).reshape(2, 3), {"units": "m"}),
            "short": TableVariable(("b",), np.array([np.nan, -np.inf]), {"comment": "=1+1"}),
            "count": TableVariable(("a",), np.array([2**40, 0, -1]), {}),
            "told": TableVariable(("a",), np.array(['=x,"y"', "", "#z\x01"], dtype=object), {}),
            "single": TableVariable(("a",), np.array([0.1, 1, 2], dtype=np.float32), {}),
            "regime": TableVariable(("a",), np.array([1, 5, 9], dtype=np.int8), FLAGS),
        },
        {"title": "=T", "source": "vibrafeed 0", "study": STUDY, "study_sha256": "f" * 64},
        {"elapsed_seconds": 0.5},
    )


def test_pandas_reads_csv_also_as_excel_in_europe_writes_it(places, motion, tmp_path):
    check_same(pandas.read_csv(places[".csv"]), rows(motion, with_units=True))
    told = json.loads(places[".csv"].with_name("result.csv.json").read_text())
    assert told["coords"]["beta"]["attrs"]["units"] == "degree"
    assert told["attrs"]["study"] == motion.attributes["study"]
    place = tmp_path / "x.csv"
    write_result(motion, str(place), history="", storage=Storage(csv_style="excel"))
    assert place.read_bytes().startswith(b"\xef\xbb\xbfamplitude [m];")
    assert place.read_bytes().count(b"\xef\xbb\xbf") == 1
    found = pandas.read_csv(place, sep=";", decimal=",")
    check_same(found, rows(motion, with_units=True))


def test_pandas_reads_parquet(places, motion):
    check_same(pandas.read_parquet(places[".parquet"]), rows(motion))
    about = pyarrow.parquet.read_schema(places[".parquet"])
    assert about.field("amplitude").metadata[b"units"] == b"m"
    assert about.metadata[b"history"] == b"2026-11-23 a test"
    assert about.metadata[b"study"].decode() == motion.attributes["study"]


def test_pandas_and_openpyxl_read_excel(places, motion):
    found = pandas.read_excel(places[".xlsx"], sheet_name="values")
    whole = rows(motion, with_units=True)
    constants = pandas.read_excel(places[".xlsx"], sheet_name="constants").set_index("name")
    headings = {name.partition(" [")[0]: name for name in whole}
    fixed = {headings[name]: one.value for name, one in constants.iterrows()}
    for heading, value in fixed.items():
        assert set(whole[heading]) == {value}
    check_same(found, {name: one for name, one in whole.items() if name not in fixed})
    assert constants.unit["frequency"] == "Hz"
    book = openpyxl.load_workbook(places[".xlsx"])
    assert book.sheetnames == ["values", "constants", "columns", "study"]
    columns = {row[0]: row[1:] for row in book["columns"].values}
    assert columns["conveying_velocity"][4] == "amplitude, beta"
    assert "stick_slip: " in columns["regime"][3]
    about = dict(book["study"].values)
    assert about["study"] == motion.attributes["study"]
    assert hashlib.sha256(about["study"].encode()).hexdigest() == about["study_sha256"]


def test_scipy_reads_mat(places, motion):
    result = scipy.io.loadmat(places[".mat"], simplify_cells=True)["result"]
    for name, one in {**motion.coordinates, **motion.variables}.items():
        np.testing.assert_array_equal(result["data"][name], one.values)
        assert np.atleast_1d(result["dimensions"][name]).tolist() == list(one.dims)
    assert result["units"]["conveying_velocity"] == "m s-1"
    assert result["flags"]["regime"]["hopping"] in motion.variables["regime"].values
    assert result["study"] == motion.attributes["study"]
    assert result["about"]["history"] == "2026-11-23 a test"
    assert isinstance(result["about"]["elapsed_seconds"], float)


@pytest.mark.parametrize(("suffix", "engine"), [(".nc", "netcdf4"), (".zarr", "zarr")])
def test_a_result_comes_back_and_goes_out_again_as_it_was(places, motion, tmp_path, suffix, engine):
    with xarray.open_dataset(places[suffix], engine=engine) as found:
        xarray.testing.assert_equal(found.load(), motion.to_xarray())
        assert found.amplitude.units == "m"
        assert found.attrs["history"] == "2026-11-23 a test"
    back = read_result(str(places[suffix]))
    assert list(back.coordinates) == list(motion.coordinates)
    assert list(back.variables) == list(motion.variables)
    xarray.testing.assert_identical(
        back.to_xarray().drop_attrs(deep=False), motion.to_xarray().drop_attrs(deep=False)
    )
    again = written(back, tmp_path)
    assert again[".csv"].read_bytes() == places[".csv"].read_bytes()
    with pytest.raises(LimitError, match="bytes of memory"):
        read_result(str(places[suffix]), most_bytes=100)
    with pytest.raises(LimitError, match="15 rows"):
        read_netcdf(places[".nc"], most_rows=10)
    with pytest.raises(FileExistsError, match="exists already"):
        write_result(back, str(places[".zarr"]), history="")


def test_csv_and_parquet_of_what_is_awkward(awkward, monkeypatch):
    text = b"".join(csv(Frame.of(awkward))).decode()
    heading, *found = reader.reader(io.StringIO(text, newline=""))
    names = ["a [Hz]", "b", "c", "turned [m]", "short", "count", "told", "single", "regime"]
    assert heading == names
    assert found[1] == [
        "1.0", "2", "7.5", "3.0", "-inf", "1099511627776", '=x,"y"', "0.1", "slide",
    ]  # fmt: skip
    assert found[4] == ["1e-300", "1", "7.5", "2.0", "", "-1", "#z\x01", "2.0", ""]
    monkeypatch.setattr(frame, "PARQUET_ROWS", 4)  # two groups
    file = pyarrow.parquet.ParquetFile(io.BytesIO(b"".join(parquet(Frame.of(awkward)))))
    assert file.num_row_groups == 2
    whole = file.read()
    assert whole["turned"].to_pylist() == [0, 3, 1, 4, 2, 5]
    assert whole["regime"].to_pylist() == ["slide"] * 2 + ["flight"] * 2 + [None] * 2
    assert np.isnan(whole["short"].to_numpy()[0])
    assert whole.field("a").metadata == {b"units": b"Hz"}
    assert b"1 of 3 cells" in whole.schema.metadata[b"note"]
    with pytest.raises(LimitError, match="6 rows, the limit is 5"):
        Frame.of(awkward, most=5)


def test_what_is_awkward_in_other_formats(awkward, tmp_path):
    places = written(awkward, tmp_path)
    book = openpyxl.load_workbook(places[".xlsx"])
    heads, first, *_ = book["values"].values
    row = dict(zip(heads, first, strict=True))
    assert row == {
        "a [Hz]": 1, "b": 1, "turned [m]": 0, "short": None, "count": 2**40,
        "told": '=x,"y"', "single": float(np.float32(0.1)), "regime": "slide",
    }  # fmt: skip
    assert [row[:2] for row in book["constants"].values][1:] == [("c", 7.5)]
    assert book["values"]["F2"].data_type == "s"  # no formula
    assert book["values"]["F6"].value == "#z_x0001_"  # as Excel writes it
    mat = scipy.io.loadmat(places[".mat"], simplify_cells=True)["result"]["data"]
    assert np.array_equal(mat["short"], [np.nan, -np.inf], equal_nan=True)
    assert [str(text) if len(text) else "" for text in mat["told"]] == ['=x,"y"', "", "#z\x01"]
    for suffix in (".nc", ".zarr"):
        back = read_result(str(places[suffix]))
        for name, one in {**awkward.coordinates, **awkward.variables}.items():
            found = {**back.coordinates, **back.variables}[name]
            assert found.values.dtype.kind == one.values.dtype.kind
            np.testing.assert_array_equal(found.values, one.values)


@pytest.mark.parametrize(
    ("suffix", "storage"),
    [
        (".nc", Storage()),
        (".zarr", Storage()),
        (".zarr", Storage(zarr_version=2)),
        (".csv", Storage()),
        (".csv", Storage(csv_style="excel")),
        (".xlsx", Storage()),
        (".parquet", Storage()),
    ],
)
def test_equal_results_have_equal_bytes(suffix, storage, awkward, tmp_path):
    found = []
    for name in ("one", "other"):
        folder = tmp_path / name
        folder.mkdir()
        write_result(awkward, str(folder / f"x{suffix}"), history="a test", storage=storage)
        files = [path for path in folder.rglob("*") if path.is_file()]
        found.append({path.relative_to(folder): path.read_bytes() for path in files})
    assert found[0] == found[1]


def test_a_workbook_has_no_date_and_room_for_a_long_study(awkward):
    long = replace(awkward, attributes={**awkward.attributes, "study": "0123456789" * 7000})
    file = io.BytesIO(b"".join(workbook.xlsx(Frame.of(long))))
    told = openpyxl.load_workbook(file)["study"].values
    assert "".join(value for name, value in told if name == "study") == "0123456789" * 7000
    with zipfile.ZipFile(file) as book:
        assert {entry.date_time[0] for entry in book.infolist()} == {1980}
        assert book.read("docProps/core.xml").count(b"1980-01-01T00:00:00Z") == 2


def test_a_workbook_that_nobody_waits_for_leaves_nothing(awkward, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    pieces = workbook.xlsx(Frame.of(awkward))
    assert next(pieces) == b""
    assert list(tmp_path.iterdir())
    pieces.close()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("suffix", "size", "told"),
    [
        (".xlsx", Size(2**20, 1, 1), "rows in a sheet of Excel, the limit is 1,048,575"),
        (".xlsx", Size(1, 2**14 + 1, 1), "columns in a sheet of Excel, the limit is 16,384"),
        (".mat", Size(1, 1, 2**31), "MATLAB reads it"),
    ],
)
def test_what_a_format_cannot_hold(awkward, tmp_path, monkeypatch, suffix, size, told):
    with pytest.raises(LimitError, match=told):
        FORMATS[suffix].check(size)
    FORMATS[".csv"].check(Size(10**12, 10**6, 10**15))
    monkeypatch.setattr(workbook, "MAX_ROWS", 5)
    monkeypatch.setattr(matlab, "MAX_BYTES", 100)
    with pytest.raises(LimitError):
        write_result(awkward, str(tmp_path / f"x{suffix}"), history="")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_place_that_cannot_be_written_has_nothing(suffix, awkward, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError):  # noqa: PT011 (each says it in its own words)
        write_result(awkward, str(tmp_path / "file" / f"x{suffix}"), history="")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize(("suffix", "package"), [(".xlsx", "xlsxwriter"), (".parquet", "pyarrow")])
def test_what_is_not_installed_is_named(suffix, package, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(MissingPackageError, match=r"is not installed: .*pip install .* -e '?\."):
        FORMATS[suffix].needs()


def test_what_is_no_result_of_ours(tmp_path):
    other = tmp_path / "other.nc"
    xarray.Dataset({"x": ("y", [1.0])}).to_netcdf(other)
    (tmp_path / "text.nc").write_text("x")
    for place in (other, tmp_path / "text.nc", tmp_path):
        with pytest.raises(VibrafeedError, match="the file is not a result of vibrafeed"):
            read_result(str(place))
    with pytest.raises(FileNotFoundError):
        read_result(str(tmp_path / "absent.nc"))
    places = ("x.CSV", "s3://bucket/key", "a.b/x", "x.tar.gz")
    assert [suffix_of(place) for place in places] == [".csv", ".zarr", "", ".gz"]


def test_octave_reads_texts_beyond_ascii_whole(tmp_path):
    """Octave takes as many bytes of UTF-8 as there are letters; the study is JSON for it."""
    study = '{"title": "F\u00f6rderer \U0001f600"}'
    table = Table({}, {"x": TableVariable((), np.array(1.0), {"long_name": "Gr\u00f6\u00dfe"})},
                  {"title": "F\u00f6rderer \u2013 Gr\u00f6\u00dfe", "study": study})  # fmt: skip
    write_result(table, str(tmp_path / "x.mat"), history="")
    result = scipy.io.loadmat(tmp_path / "x.mat", simplify_cells=True)["result"]
    assert result["study"].isascii()
    assert json.loads(result["study"]) == json.loads(study)
    text = result["about"]["title"]
    assert text.encode()[: len(text)].decode().rstrip() == table.attributes["title"]


def test_names_that_matlab_allows():
    long = "x" * 70
    found = names_in_matlab(["beta", "2nd", "a-b", "a b", "_c", long, long + "y"])
    assert found["beta"] == "beta"
    assert (found["2nd"], found["a-b"], found["a b"], found["_c"]) == (
        "x2nd", "a_b", "a_b_2", "x_c",
    )  # fmt: skip
    assert len(set(found.values())) == 7
    assert max(map(len, found.values())) <= 63


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0.0004, "< 0.1 %"), (0.0123, "1.2 %"), (0.476, "48 %"), (0.998, "99.8 %"),
        (0.99999, "99.9 %"), (1.0, "100 %"),
    ],
)  # fmt: skip
def test_small_shares_have_a_digit_more(share, text):
    assert percent(share).replace("\N{NO-BREAK SPACE}", " ") == text


def test_each_value_of_a_flag_has_its_word():
    values = np.array([0, 2, 5], dtype=np.int8)
    attributes = {"flag_values": values, "flag_meanings": "none some all"}
    assert flags_of(attributes) == {0: "none", 2: "some", 5: "all"}
    assert flags_of({"flag_values": np.int8(3), "flag_meanings": "alone"}) == {3: "alone"}
    assert flags_of({"units": "m"}) == {}
