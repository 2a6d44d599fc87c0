"""Slices and results as CSV, Parquet and XLSX; what is compressed on its way."""

from __future__ import annotations

import io

import numpy as np
import pandas
import pyarrow.parquet
import pytest

from local_client import local_client
from posted_sweeps import STUDY, problem, with_axes
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.system import installing

CUT = {
    "output": "transport_velocity",
    "axes": "alpha,frequency",
    "beta": "15 deg",
    "amplitude": "0.5 mm",
}
PARQUET = "application/vnd.apache.parquet"
XLSX = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"


@pytest.fixture
def expected() -> pandas.DataFrame:
    """Return the slice, by xarray and pandas."""
    whole = run_study(parse_study(STUDY)).sel(beta=15, amplitude=5e-4)
    return whole.transport_velocity.transpose("alpha", "frequency").to_dataframe().reset_index()


def words_of(variable) -> np.ndarray:
    meanings = variable.flag_meanings.split()
    names = dict(zip(variable.flag_values.tolist(), meanings, strict=True))
    return np.vectorize(names.get)(variable.values)


class TestSlices:
    def test_csv(self, client, address, expected):
        reply = client.get(f"{address}/slice", params=CUT, headers={"Accept": "text/csv"})
        assert reply.headers["content-type"] == "text/csv; charset=utf-8"
        assert reply.headers["etag"]
        assert "Accept" in reply.headers["vary"]
        by_name = client.get(f"{address}/slice", params={**CUT, "format": "csv"})
        assert by_name.content == reply.content
        assert reply.content.count(b"\r\n") == 1 + len(expected)
        found = pandas.read_csv(io.BytesIO(reply.content))
        for column in ("alpha [degree]", "frequency [Hz]", "transport_velocity [m s-1]"):
            np.testing.assert_array_equal(found[column], expected[column.split()[0]])
        assert (found["amplitude [m]"] == 5e-4).all()
        whole = run_study(parse_study(STUDY)).sel(beta=15, amplitude=5e-4)
        regimes = words_of(whole.regime.transpose("alpha", "frequency")).ravel()
        assert found["regime"].tolist() == regimes.tolist()
        beyond = sum(not REGIMES[name].valid for name in regimes)
        assert reply.headers["vibrafeed-note"].startswith(f"{beyond} of {len(expected)} cells do")

    def test_parquet(self, client, address, expected):
        reply = client.get(f"{address}/slice", params=CUT, headers={"Accept": PARQUET})
        assert reply.headers["content-type"] == PARQUET
        table = pyarrow.parquet.read_table(io.BytesIO(reply.content))
        found = table.to_pandas()
        for column in ("alpha", "frequency", "transport_velocity"):
            np.testing.assert_array_equal(found[column], expected[column])
        assert table.field("frequency").metadata[b"units"] == b"Hz"
        assert table.field("frequency").metadata[b"long_name"] == b"Frequency"
        about = table.schema.metadata
        assert about[b"note"].decode() == reply.headers["vibrafeed-note"]
        assert len(about[b"study_sha256"]) == 64
        assert set(found["regime"]) <= set(table.column("regime").unique().to_pylist())

    def test_xlsx(self, client, address, expected):
        reply = client.get(f"{address}/slice", params=CUT, headers={"Accept": XLSX})
        assert reply.headers["content-type"] == XLSX
        found = pandas.read_excel(io.BytesIO(reply.content), sheet_name="values")
        for column in ("alpha [degree]", "frequency [Hz]", "transport_velocity [m s-1]"):
            np.testing.assert_array_equal(found[column], expected[column.split()[0]])
        about = pandas.read_excel(io.BytesIO(reply.content), sheet_name="study", index_col=0)
        assert about.value["note"] == reply.headers["vibrafeed-note"]
        by_name = client.get(f"{address}/slice", params={**CUT, "format": "xlsx"})
        assert by_name.content == reply.content
        known = {"Accept": XLSX, "If-None-Match": reply.headers["etag"]}
        assert client.get(f"{address}/slice", params=CUT, headers=known).status_code == 304

    def test_a_client_that_takes_nothing_is_told_what_there_is(self, client, address):
        reply = client.get(f"{address}/slice", params=CUT, headers={"Accept": "image/png"})
        told = problem(reply, 406)["detail"]
        assert "text/csv" in told
        assert PARQUET in told
        assert XLSX in told

    def test_without_pyarrow_there_is_csv(self, client, address, monkeypatch):
        monkeypatch.setattr("vibrafeed.app.web.tables.find_spec", lambda name: None)
        monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
        ask = {"Accept": f"{PARQUET}, text/csv;q=0.1"}
        reply = client.get(f"{address}/slice", params=CUT, headers=ask)
        assert reply.headers["content-type"].startswith("text/csv")
        reply = client.get(f"{address}/slice", params=CUT, headers={"Accept": PARQUET})
        assert installing("pyarrow", "tables") in problem(reply, 406)["detail"]
        monkeypatch.setitem(__import__("sys").modules, "xlsxwriter", None)
        how = {"parquet": installing("pyarrow", "tables"), "xlsx": installing("xlsxwriter")}
        for form, told in how.items():
            reply = client.get(f"{address}/slice", params={**CUT, "format": form})
            assert told in problem(reply, 406)["detail"]

    def test_head_computes_nothing(self, client, address, monkeypatch):
        etag = client.get(f"{address}/slice", params=CUT).headers["etag"]
        for module in ("vibrafeed.app.web.routes.sweeps", "vibrafeed.app.web.calculations"):
            monkeypatch.setattr(f"{module}.compute_slice", None)
        reply = client.head(f"{address}/slice", params=CUT)
        assert (reply.status_code, reply.content) == (200, b"")
        assert reply.headers["etag"] == etag
        assert client.head(f"{address}/slice", params={**CUT, "axes": "x"}).status_code == 422
        assert client.head(address).status_code == 200

    def test_many_pieces_are_one_table(self, client):
        study = with_axes(frequency=150, alpha=100)
        key = client.post("/sweeps", json=study).json()["id"]
        reply = client.get(f"/sweeps/{key}/slice", params={**CUT, "format": "csv"})
        found = pandas.read_csv(io.BytesIO(reply.content))
        told = client.get(f"/sweeps/{key}/slice", params=CUT).json()
        values = np.array(told["values"]["data"], dtype=float)
        np.testing.assert_array_equal(found["transport_velocity [m s-1]"], values.ravel())


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    """Return a client, and the address of a result of 1,540 cells."""
    folder = tmp_path_factory.mktemp("data")
    app = create_app(
        Settings(data_directory=folder, workers=1, max_table_rows=2000, max_sheet_rows=1600)
    )
    with local_client(app) as client:
        ask = {"Prefer": "respond-async, wait=60"}

        def post(study: dict) -> str:
            reply = client.post("/processes/sweep/execution", json=study, headers=ask)
            assert reply.status_code == 200, reply.text
            return reply.headers["location"] + "/results/dataset"

        yield client, post


class TestResults:
    def test_tables(self, job):
        client, post = job
        address = post(STUDY)
        expected = run_study(parse_study(STUDY)).to_dataframe().reset_index()
        reply = client.get(address, headers={"Accept": "text/csv"})
        assert reply.headers["content-disposition"].endswith('.csv"')
        found = pandas.read_csv(io.BytesIO(reply.content))
        np.testing.assert_array_equal(found["acceleration_x [m s-2]"], expected["acceleration_x"])
        np.testing.assert_array_equal(found["throw_number"], expected["throw_number"])
        assert (found["friction"] == 0.3).all()
        again = client.get(
            address, headers={"Accept": "text/csv", "If-None-Match": reply.headers["etag"]}
        )
        assert again.status_code == 304
        head = client.head(address, headers={"Accept": "text/csv"})
        assert (head.status_code, head.content) == (200, b"")
        reply = client.get(address, params={"format": "parquet"})
        table = pyarrow.parquet.read_table(io.BytesIO(reply.content)).to_pandas()
        for name in ("frequency", "acceleration_x", "throw_number", "friction"):
            np.testing.assert_array_equal(table[name], expected[name])
        reply = client.get(address, headers={"Accept": XLSX})
        assert reply.headers["content-disposition"].endswith('.xlsx"')
        table = pandas.read_excel(io.BytesIO(reply.content))
        np.testing.assert_array_equal(table["acceleration_x [m s-2]"], expected["acceleration_x"])
        assert client.get(address).headers["content-type"] == "application/x-netcdf"
        told = client.get(address, headers={"Accept": "application/json"})
        assert told.json()["variables"]["throw_number"]["units"] == "1"
        problem(client.get(address, headers={"Accept": "text/html"}), 406)

    def test_too_many_rows(self, job):
        client, post = job
        address = post(with_axes(alpha=20))
        told = problem(client.get(address, headers={"Accept": "text/csv"}), 422)
        assert told["type"].endswith("limit")
        assert "3,080 rows, the limit is 2,000" in told["detail"]
        assert client.get(address).status_code == 200
        address = post(with_axes(alpha=12))
        told = problem(client.get(address, headers={"Accept": XLSX}), 422)
        assert "1,848 rows, the limit is 1,600" in told["detail"]
        assert client.get(address, headers={"Accept": "text/csv"}).status_code == 200
