"""What clients read of a sweep, and keep: slices in all forms, tables, Zarr keys, NetCDF files."""

import asyncio
import contextlib
import errno
import hashlib
import io
import json
import os
import struct
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pandas
import pytest
from fastapi import Request

from local_client import client_of
from posted_sweeps import STUDY, TRILLION, problem, with_axes
from vibrafeed.app.jobs.manifest import NETCDF
from vibrafeed.app.web.accept import preferred
from vibrafeed.app.web.downloads import file_reply
from vibrafeed.core.intake import parse_study, prepare_content
from vibrafeed.core.kinds import run_study
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.lazy.view import ZarrView
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.system import installing
from waiting import PATIENCE, wait_for


def unpack(content: bytes) -> tuple[dict, dict[str, np.ndarray]]:
    """Read a binary slice by `docs/api-reference.md` alone."""
    (length,) = struct.unpack_from("<Q", content)
    header = json.loads(content[8 : 8 + length])
    values = content[8 + length :]

    def array(place: dict) -> np.ndarray:
        dtype, shape = np.dtype(place["dtype"]), tuple(place["shape"])
        count = int(np.prod(shape))
        assert (8 + length + place["offset"]) % dtype.itemsize == 0
        return np.frombuffer(values, dtype, count, place["offset"]).reshape(shape)

    arrays = {axis["name"]: array(axis["values"]) for axis in header["axes"]}
    return header, arrays | {name: array(header[name]["data"]) for name in ("values", "regime")}


def view_of(content: dict) -> ZarrView:
    sweep = prepare_content(content)
    return ZarrView(sweep, outline(sweep))


CUT = {
    "output": "transport_velocity",
    "axes": "alpha,frequency",
    "beta": "15 deg",
    "amplitude": "0.5 mm",
}


class TestSlice:
    def test_words_for_angles_are_letters(self, client, address):
        words = {**CUT, "axes": "azimuth,frequency", "elevation": "15 deg"}
        del words["beta"]
        expected = client.get(f"{address}/slice", params=CUT).json()
        assert client.get(f"{address}/slice", params=words).json() == expected
        twice = client.get(f"{address}/slice", params={**words, "beta": "15 deg"})
        (wrong,) = problem(twice, 422)["errors"]
        assert wrong["message"] == "elevation and beta are the same angle, and both are given"

    def test_a_wrong_slice_is_explained(self, client, address):
        long = "0.5" + "0" * 250 + " mm"  # cut, it is 0.5 m
        for change, further, words in (
            ({"output": "velocity"}, [], "Did you mean"),
            ({"output": "nothing", "format": "binary"}, [], "is not an output"),
            ({"format": "xml"}, [], "format"),
            ({"axes": "bta"}, [], "Did you mean 'beta' (elevation)?"),
            ({"axes": "alpha,amplitude,frequency"}, [], "one or two"),
            ({"axes": "beta,beta"}, [], "axes has the same name twice"),
            ({"axes": 201 * "a"}, [], "at most 200 characters"),
            ({"output": 101 * "a"}, [], "at most 100 characters"),
            ({"amplitude": long}, [], "A value has at most 200 characters"),
            ({"axes": "alpha", "frequency": "55 Hz"}, [], "nearest are 50 and 60 Hz"),
            ({"axes": "alpha", "frequency": "55 kg"}, [], "Hz"),
            ({"axes": "alpha"}, [], "from 20 to 120 Hz"),
            ({"alpha": "NaN"}, [], "alpha is given twice: as a free axis and with a value"),
            ({"radius": 1}, [], "Known: alpha"),
            ({}, [("output", "x")], "more than once"),
            ({}, [("beta", "15")], "more than once"),
        ):
            params = [*{**CUT, **change}.items(), *further]
            refused = problem(client.get(f"{address}/slice", params=params), 422)
            assert words in str(refused["errors"]), (change, further)
        problem(client.get(f"/sweeps/{'0' * 64}/slice", params=CUT), 404)

    def test_a_slice_asks_only_for_the_axes_that_its_output_needs(self, client, address):
        params = {"output": "throw_number", "axes": "beta", "frequency": 50, "amplitude": 5e-4}
        piece = client.get(f"{address}/slice", params=params)
        assert piece.status_code == 200, piece.text
        assert not {"alpha", "distance"} & set(piece.json()["fixed"])

    @pytest.mark.parametrize("outputs", [["stopping_distance"], ["acceleration_x", "throw_number"],
                                         ["terminal_velocity", "acceleration_x"]])  # fmt: skip
    def test_every_listed_variable_has_a_slice_of_its_values(self, client, outputs) -> None:
        """`regime` had those of the contact, and another regime was refused."""
        axes = {"beta": [5, 20, 40], "frequency": [30, 60, 90]}
        fixed = {"friction": 0.3, "radius": 0.3, "amplitude": 2e-4}
        study = {**STUDY, "outputs": outputs, "parameters": {**axes, **fixed}}
        posted = client.post("/sweeps", json=study).json()
        dataset = run_study(parse_study(study))
        listed = posted["outputs"]
        assert {one["name"] for one in listed} == {*dataset.data_vars}
        assert len({one["label"] for one in listed}) == len(listed)
        for name, variable in dataset.data_vars.items():
            cut = {"output": name, "axes": "beta,frequency"}
            piece = client.get(f"/sweeps/{posted['id']}/slice", params=cut).json()
            assert piece["judged"] == ("ancillary_variables" in variable.attrs)
            told = piece["values"]
            assert {*told["dims"]} == {*variable.dims}
            found = np.array(told["data"], dtype=float)  # null is not finite
            wanted = variable.where(np.isfinite(variable)).transpose(*told["dims"])
            np.testing.assert_array_equal(found, wanted)

    def test_a_regime_that_needs_what_the_study_does_not_give(self, client) -> None:
        """The slice of `regime` ended with 500: the contact asks for a friction coefficient."""
        study = {"kind": "sweep", "scene": "cylinder-isolated", "outputs": ["inertia_ratio"],
                 "parameters": {"length": [0.01, 0.02], "diameter": 0.01}}  # fmt: skip
        key = client.post("/sweeps", json=study).json()["id"]
        told = client.get(f"/sweeps/{key}/slice", params={"output": "regime", "axes": "length"})
        assert told.status_code == 200, told.text
        assert told.json()["regimes"].keys() == {"not_assessed"}

    def test_binary_and_json_are_the_same_slice(self, client, address):
        told = client.get(f"{address}/slice", params=CUT)
        raw = client.get(f"{address}/slice", params={**CUT, "format": "binary"})
        by_accept = client.get(
            f"{address}/slice", params=CUT, headers={"Accept": "application/octet-stream"}
        )
        assert told.headers["content-type"] == "application/json"
        assert raw.headers["content-type"] == "application/octet-stream"
        assert by_accept.content == raw.content
        header, arrays = unpack(raw.content)
        assert header.keys() == told.json().keys()
        for name in ("output", "unit", "fixed", "regimes"):
            assert header[name] == told.json()[name]
        whole = run_study(parse_study(STUDY)).sel(beta=15, amplitude=5e-4)
        np.testing.assert_array_equal(arrays["values"].T, whole.transport_velocity)
        np.testing.assert_array_equal(arrays["regime"].T, whole.regime)
        assert arrays["regime"].dtype == np.int8
        for axis in ("alpha", "frequency"):
            np.testing.assert_array_equal(arrays[axis], whole[axis])
        assert header["values"]["dims"] == ["alpha", "frequency"]
        assert told.json()["regimes"]["flight"]["valid"] is False
        assert told.json()["fixed"]["beta"] == 15

    def test_what_json_has_no_word_for_is_kept(self, client):
        study = {
            "kind": "sweep",
            "scene": "rectangle-on-track",
            "outputs": ["transport_velocity"],
            "parameters": {**STUDY["parameters"], "distance": [1e-4, 1e3], "friction": [0, 5]},
        }
        key = client.post("/sweeps", json=study).json()["id"]
        params = {**CUT, "axes": "distance,friction", "alpha": 0, "frequency": 20}
        told = client.get(f"/sweeps/{key}/slice", params=params).json()["values"]["data"]
        raw = client.get(f"/sweeps/{key}/slice", params={**params, "format": "binary"})
        _, arrays = unpack(raw.content)
        np.testing.assert_array_equal(np.array(told, dtype=float), arrays["values"])

    def test_etags(self, client, address):
        seen = set()
        for change in ({}, {"format": "binary"}, {"beta": 30}, {"axes": "frequency,alpha"}):
            params = {**CUT, **change}
            response = client.get(f"{address}/slice", params=params)
            etag = response.headers["etag"]
            assert response.headers["vary"].startswith("Accept")
            assert "immutable" in response.headers["cache-control"]
            again = client.get(f"{address}/slice", params=params, headers={"If-None-Match": etag})
            assert (again.status_code, again.content) == (304, b"")
            assert again.headers["vary"] == "Accept"
            seen.add(etag)
        assert len(seen) == 4

    @pytest.mark.parametrize(
        ("accept", "expected"),
        [
            ("", "application/json"),
            ("*/*", "application/json"),
            ("application/json", "application/json"),
            ("application/*;q=0.2", "application/json"),
            ("application/octet-stream", "application/octet-stream"),
            ("application/octet-stream, */*;q=0.1", "application/octet-stream"),
            ("application/json, application/octet-stream", "application/json"),
            (
                "application/json;q=0.5, application/octet-stream;q=0.9",
                "application/octet-stream",
            ),
            ("*/*, application/json;q=0", "application/octet-stream"),
            ("application/octet-stream;q=0", None),
            ("application/octet-stream;q=x", None),
            ("text/html", None),
            ("Application/Octet-Stream ; v=1", "application/octet-stream"),
        ],
    )
    def test_accept(self, accept, expected):
        assert preferred(accept, ("application/json", "application/octet-stream")) == expected


def test_a_sweep_of_another_version_is_told_so(tmp_path, monkeypatch):
    with client_of(tmp_path) as client:
        address = f"/sweeps/{client.post('/sweeps', json=STUDY).json()['id']}"
    monkeypatch.setattr("vibrafeed.core.__version__", "99.0")
    with client_of(tmp_path) as client:
        for path in ("", "/netcdf", "/zarr/zarr.json"):
            problem(client.get(address + path), 409, "problem:version")
        problem(client.get(f"{address}/slice", params=CUT), 409)


class TestZarr:
    def test_keys_are_those_of_the_core(self, client, address):
        view = view_of(STUDY)
        for key, media_type in (
            ("zarr.json", "application/json"),
            ("regime/zarr.json", "application/json"),
            ("regime/c/0/0/0/0", "application/octet-stream"),
            ("transport_velocity/c/0/0/0/0", "application/octet-stream"),
            ("frequency/c/0", "application/octet-stream"),
            ("friction/c", "application/octet-stream"),
        ):
            plain = {"Accept-Encoding": "identity"}  # compressed, it would be another content
            response = client.get(f"{address}/zarr/{key}", headers=plain)
            assert response.status_code == 200
            assert response.content == view.read(key)
            assert response.headers["content-type"] == media_type
            assert response.headers["cache-control"] == "max-age=31536000, immutable"
            head = client.head(f"{address}/zarr/{key}", headers=plain)
            assert (head.status_code, head.content) == (200, b"")
            response.headers.pop("vary", None)  # of small replies that are not compressed, either
            assert dict(head.headers) == dict(response.headers)

    def test_the_sweep_names_its_group(self, client, address, without_studies):
        assert client.get(address).json()["links"]["zarr"] == f"{address}/zarr"
        documented = client.get("/openapi.json").json()["paths"]["/sweeps/{key}/zarr/{path}"]
        assert set(documented["get"]["responses"]) == {
            "200", "304", "401", "403", "404", "409", "414", "422", "429"
        }  # fmt: skip

    def test_an_etag_is_known_without_computing(self, client, monkeypatch):
        key = client.post("/sweeps", json=TRILLION).json()["id"]
        path = f"/sweeps/{key}/zarr/acceleration_x/c/1/2/3/4"
        etag = client.get(path).headers["etag"]
        assert etag == client.get(path).headers["etag"]
        assert etag != client.get(path[:-1] + "5").headers["etag"]
        monkeypatch.setattr(ZarrView, "_chunk", None)  # whatever computes would fail
        again = client.get(path, headers={"If-None-Match": etag})
        assert (again.status_code, again.content) == (304, b"")
        assert again.headers["etag"] == etag
        head = client.head(path[:-1] + "7")
        assert (head.status_code, head.headers["content-length"]) == (200, str(16**4 * 8))
        problem(client.get(path[:-1] + "7"), 500)

    def test_other_keys_are_not_found(self, client, address):
        for path in (
            "", ".zgroup", ".zmetadata", "zarr.json/", "c/0", "nothing/zarr.json", "regime",
            "acceleration_x/c/0", "acceleration_x/c/0/0/0/-1", "acceleration_x/c/0/0/0/1",
            "acceleration_x/c/0/0/0/" + "9" * 200, "acceleration_x/c/0/0/0/00",
            "acceleration_x/c/0/0/0/0x0", "acceleration_x/c/0/0/0/0%00",
            "acceleration_x%2Fzarr.json", "acceleration_x%2fc%2f0%2f0%2f0%2f0",
            "%2e%2e%2fstudy.json", "..%2Fstudy.json", "..%5Cstudy.json", "%2Fetc%2Fpasswd",
            "acceleration_x/c/%D9%A1/0/0/0", "%ff%fe",
        ):  # fmt: skip
            problem(client.get(f"{address}/zarr/{path}"), 404)
            assert client.head(f"{address}/zarr/{path}").status_code == 404
        problem(client.get(f"{address}/zarr/{'x' * 301}"), 422)
        gone = client.post("/sweeps", json=with_axes(frequency=4)).json()["id"]
        assert client.get(f"/sweeps/{gone}/zarr/zarr.json").status_code == 200
        client.app.state.store.remove(gone)
        for sweep in ("0" * 64, "..%2F..%2Fx", gone):
            problem(client.get(f"/sweeps/{sweep}/zarr/zarr.json"), 404)


PARQUET = "application/vnd.apache.parquet"
XLSX = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"
TABLES = {"csv": "text/csv", "parquet": PARQUET, "xlsx": XLSX}


def read(form: str, content: bytes) -> pandas.DataFrame:
    """Return a table with columns named without units."""
    readers = {"csv": pandas.read_csv, "parquet": pandas.read_parquet, "xlsx": pandas.read_excel}
    found = readers[form](io.BytesIO(content))
    found.columns = [name.partition(" ")[0] for name in found.columns]
    return found


@pytest.fixture(scope="module")
def patient(tmp_path_factory):
    """Return a client of a service that computes jobs, with few rows in a table."""
    with client_of(
        tmp_path_factory.mktemp("data"), workers=1, max_wait_seconds=PATIENCE,
        max_table_rows=2000, max_sheet_rows=1600,
    ) as client:  # fmt: skip
        yield client


def dataset_of(patient, study: dict) -> str:
    ask = {"Prefer": f"respond-async, wait={PATIENCE:.0f}"}
    reply = patient.post("/processes/sweep/execution", json=study, headers=ask)
    assert reply.status_code == 200, reply.text
    return reply.headers["location"] + "/results/dataset"


class TestTables:
    @pytest.mark.parametrize("form", TABLES)
    def test_a_slice(self, client, address, form):
        ask = {"Accept": TABLES[form]}
        reply = client.get(f"{address}/slice", params=CUT, headers=ask)
        assert reply.headers["content-type"].partition(";")[0] == TABLES[form]
        assert "Accept" in reply.headers["vary"]
        by_name = client.get(f"{address}/slice", params={**CUT, "format": form})
        assert by_name.content == reply.content
        ask["If-None-Match"] = reply.headers["etag"]
        assert client.get(f"{address}/slice", params=CUT, headers=ask).status_code == 304
        found = read(form, reply.content)
        whole = run_study(parse_study(STUDY)).sel(beta=15, amplitude=5e-4)
        whole = whole[["transport_velocity", "regime"]]
        expected = whole.to_dataframe(dim_order=["alpha", "frequency"]).reset_index()
        for column in ("alpha", "frequency", "transport_velocity"):
            np.testing.assert_array_equal(found[column], expected[column])
        words = whole.regime.flag_meanings.split()
        names = dict(zip(whole.regime.flag_values.tolist(), words, strict=True))
        regimes = [names[code] for code in expected["regime"]]
        assert found["regime"].tolist() == regimes
        beyond = sum(not REGIMES[name].valid for name in regimes)
        assert reply.headers["vibrafeed-note"].startswith(f"{beyond} of {len(expected)} cells do")

    @pytest.mark.parametrize("form", TABLES)
    def test_a_result(self, patient, form):
        address, ask = dataset_of(patient, STUDY), {"Accept": TABLES[form]}
        reply = patient.get(address, headers=ask)
        assert reply.headers["content-disposition"].endswith(f'.{form}"')
        found = read(form, reply.content)
        expected = run_study(parse_study(STUDY)).to_dataframe().reset_index()
        assert form == "xlsx" or set(found["friction"]) == {0.3}
        for column in ("frequency", "acceleration_x", "throw_number"):
            np.testing.assert_array_equal(found[column], expected[column])
        head = patient.head(address, headers=ask)
        assert (head.status_code, head.content) == (200, b"")
        ask["If-None-Match"] = reply.headers["etag"]
        assert patient.get(address, headers=ask).status_code == 304
        assert patient.get(address).headers["content-type"] == "application/x-netcdf"
        told = patient.get(address, headers={"Accept": "application/json"})
        assert told.json()["variables"]["throw_number"]["units"] == "1"
        problem(patient.get(address, headers={"Accept": "text/html"}), 406)

    @pytest.mark.parametrize(
        ("size", "media", "told", "other"),
        [
            (20, "text/csv", "3,080 rows, the limit is 2,000", "application/x-netcdf"),
            (12, XLSX, "1,848 rows, the limit is 1,600", "text/csv"),
        ],
    )
    def test_too_many_rows(self, patient, size, media, told, other):
        address = dataset_of(patient, with_axes(alpha=size))
        refused = problem(patient.get(address, headers={"Accept": media}), 422, "problem:limit")
        assert told in refused["detail"]
        assert patient.get(address, headers={"Accept": other}).status_code == 200

    def test_a_client_that_takes_nothing_is_told_what_there_is(self, client, address):
        reply = client.get(f"{address}/slice", params=CUT, headers={"Accept": "image/png"})
        told = problem(reply, 406)["detail"]
        for form in ("text/csv", PARQUET, XLSX):
            assert form in told

    def test_without_pyarrow_there_is_csv(self, client, address, monkeypatch):
        monkeypatch.setattr("vibrafeed.app.web.tables.find_spec", lambda name: None)
        monkeypatch.setitem(sys.modules, "pyarrow", None)
        ask = {"Accept": f"{PARQUET}, text/csv;q=0.1"}
        reply = client.get(f"{address}/slice", params=CUT, headers=ask)
        assert reply.headers["content-type"].startswith("text/csv")
        monkeypatch.setitem(sys.modules, "xlsxwriter", None)
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
        path = f"/sweeps/{client.post('/sweeps', json=study).json()['id']}/slice"
        found = read("csv", client.get(path, params={**CUT, "format": "csv"}).content)
        told = client.get(path, params=CUT).json()["values"]["data"]
        values = np.array(told, dtype=float)
        np.testing.assert_array_equal(found["transport_velocity"], values.ravel())


def test_who_reads_many_chunks_takes_no_thread_from_small_slices(tmp_path, monkeypatch):
    """Chunks that block keep others from starting; what is in memory and small slices do not."""
    free, under_way, read = threading.Event(), [], ZarrView.read

    def blocked(view, key):
        if not key.endswith(".json"):
            under_way.append(key)
            assert free.wait(PATIENCE)
        return read(view, key)

    monkeypatch.setattr(ZarrView, "read", blocked)
    with client_of(tmp_path, workers=2) as client, ThreadPoolExecutor(8) as threads:
        most = client.app.state.process_pool.fair_queue.slots - 1
        address = f"/sweeps/{client.post('/sweeps', json=STUDY).json()['id']}"
        chunk = f"{address}/zarr/acceleration_x/c/0/0/0/0"
        asked = [threads.submit(client.get, chunk) for _ in range(8)]
        wait_for(lambda: len(under_way) >= most)
        fixed = "amplitude=0.35 mm&frequency=20 Hz&alpha=0"
        slice_ = f"/slice?output=acceleration_x&axes=beta&{fixed}"
        for path in (slice_, "/zarr/zarr.json", "/zarr/beta/zarr.json"):
            assert client.get(f"{address}{path}").status_code == 200
        assert len(under_way) == most
        free.set()
        assert {one.result().status_code for one in asked} == {200}


def times_open(path: Path) -> int:
    """Return how often this process has a file open."""
    count = 0
    for descriptor in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(FileNotFoundError):
            count += descriptor.readlink() == path
    return count


class TestFile:
    @pytest.fixture
    def whole(self, client, address):
        response = client.get(f"{address}/netcdf")
        assert response.status_code == 200
        return response

    def test_its_headers(self, client, address, whole):
        digest = hashlib.sha256(whole.content).hexdigest()
        assert whole.headers["etag"] == f'"{digest}"'
        assert whole.headers["accept-ranges"] == "bytes"
        assert whole.headers["content-length"] == str(len(whole.content))
        assert whole.headers["content-disposition"].startswith('attachment; filename="vibrafeed-')
        assert whole.headers["repr-digest"].startswith("sha-256=:")
        head = client.head(f"{address}/netcdf")
        assert (head.status_code, head.content) == (200, b"")
        assert dict(head.headers) == dict(whole.headers)

    def test_ranges(self, client, address, whole):
        size, etag = len(whole.content), whole.headers["etag"]
        for wanted, start, stop in (
            ("bytes=0-0", 0, 1),
            ("bytes=100-", 100, None),
            ("bytes=100-199", 100, 200),
            ("Bytes=5-999999999999999999", 5, None),
            ("bytes=-100", -100, None),
            ("bytes=-999999999999999999", 0, None),
        ):
            part = client.get(f"{address}/netcdf", headers={"Range": wanted})
            expected = whole.content[start:stop]
            assert (part.status_code, part.content) == (206, expected)
            first = start % size
            told = f"bytes {first}-{first + len(expected) - 1}/{size}"
            assert part.headers["content-range"] == told
            assert part.headers["content-length"] == str(len(expected))
            assert part.headers["etag"] == etag
        for wanted in (f"bytes={size}-", "bytes=999999999999-"):
            past = client.get(f"{address}/netcdf", headers={"Range": wanted})
            assert past.status_code == 416
            assert past.headers["content-range"] == f"bytes */{size}"

    def test_conditions(self, client, address, whole):
        etag = whole.headers["etag"]
        get = lambda **headers: client.get(  # noqa: E731
            f"{address}/netcdf", headers={k.replace("_", "-"): v for k, v in headers.items()}
        )
        for known in (etag, f"W/{etag}", f'"other", {etag}', "*"):
            response = get(If_None_Match=known)
            assert (response.status_code, response.content) == (304, b"")
            assert response.headers["etag"] == etag
        assert get(If_None_Match='"other"').status_code == 200
        assert get(If_None_Match=etag, Range="bytes=0-1").status_code == 304
        assert get(If_Range=etag, Range="bytes=0-1").status_code == 206
        for stale in ('"other"', f"W/{etag}"):
            assert get(If_Range=stale, Range="bytes=0-1").status_code == 200
        assert get(If_Match=etag).status_code == 200
        assert get(If_Match="*").status_code == 200
        problem(get(If_Match='"other"'), 412)
        problem(get(If_Match=f"W/{etag}"), 412)

    def test_too_many_open_files(self, client, address, whole, monkeypatch):
        def open_(path, *arguments, **options):
            raise OSError(errno.EMFILE, os.strerror(errno.EMFILE), str(path))

        with monkeypatch.context() as full:
            full.setattr(Path, "open", open_)
            response = client.get(f"{address}/netcdf")
        document = problem(response, 503, "problem:busy")
        assert "limit of open files" in document["detail"]
        assert "netcdf" not in document["detail"]  # nor any path
        assert int(response.headers["retry-after"]) >= 1
        assert client.get(f"{address}/netcdf").content == whole.content

    def test_no_reply_leaves_the_file_open(self, client, address, whole):
        path = client.app.state.store.folder(address.rpartition("/")[2]) / NETCDF
        for status, method, headers in (
            (200, "GET", {}),
            (200, "HEAD", {}),
            (206, "GET", {"Range": "bytes=5-9"}),
            (304, "GET", {"If-None-Match": whole.headers["etag"]}),
            (412, "GET", {"If-Match": '"other"'}),
            (416, "GET", {"Range": "bytes=999999999-"}),
        ):
            response = client.request(method, f"{address}/netcdf", headers=headers)
            assert response.status_code == status
            assert times_open(path) == 0

    @pytest.mark.parametrize("leaves", ["a failing connection", "a cancelled request", "never run"])
    def test_a_client_that_leaves_before_the_first_byte(self, tmp_path, leaves):
        path = tmp_path / "result"
        path.write_bytes(b"12345")
        scope = {
            "type": "http", "method": "GET", "headers": [], "asgi": {"spec_version": "2.4"},
            "state": {"enlarge": lambda size: None},
        }  # fmt: skip
        reply = file_reply(
            Request(scope), path, digest="00" * 32, media_type="text/plain", filename="x"
        )
        began = asyncio.Event()

        async def send(message):
            began.set()
            if leaves == "a failing connection":
                raise OSError("gone")
            await asyncio.Event().wait()

        async def serve():
            task = asyncio.create_task(reply(scope, asyncio.Event().wait, send))
            await began.wait()
            task.cancel()
            await asyncio.wait([task])
            assert task.cancelled() or task.exception() is not None

        if leaves != "never run":
            asyncio.run(serve())
        assert times_open(path) == 0

    def test_a_sweep_that_is_too_large_for_a_file_is_refused_and_read_in_pieces(self, client):
        posted = client.post("/sweeps", json=TRILLION)
        assert posted.json()["cells"] == 10**12
        address = f"/sweeps/{posted.json()['id']}"
        document = problem(client.get(f"{address}/netcdf"), 422, "problem:limit")
        assert "1,000,000" in document["detail"]
        params = {"output": "acceleration_x", "axes": "beta", "alpha": 90, "amplitude": 1e-3}
        piece = client.get(f"{address}/slice", params={**params, "frequency": 20})
        assert piece.status_code == 200
        assert len(piece.json()["values"]["data"]) == 1000
        long = with_axes(frequency=10_000_000)
        document = problem(client.post("/sweeps", json=long), 422)
        assert "Give frequency 2,000,000 values or fewer" in document["detail"]
        many = with_axes(frequency=10**6, amplitude=10**6, alpha=10**6)
        assert "cells" in problem(client.post("/sweeps", json=many), 422)["detail"]


def test_head_of_a_file_that_is_not_made_computes_nothing(client, monkeypatch):
    posted = client.post("/sweeps", json=with_axes(frequency=5)).json()
    path = f"/sweeps/{posted['id']}/netcdf"
    with monkeypatch.context() as patch:
        patch.setattr(client.app.state.writer, "write", None)
        head = client.head(path)
    assert head.status_code == 200
    assert not {"content-length", "etag"} & set(head.headers)
    made = client.get(path)
    assert made.headers["content-type"] == head.headers["content-type"]
    assert client.head(path).headers["etag"] == made.headers["etag"]


def test_designs_are_posted_as_rows_or_lists(client):
    """As `/sweeps`, and as a process of each kind; the values are those of single designs."""
    rows = [{"frequency": 50, "amplitude": "0.3 mm"}, {"frequency": 40, "amplitude": "0.2 mm"}]
    study = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["throw_number"],
             "parameters": {"beta": 20}}  # fmt: skip
    posted = client.post("/sweeps", json={**study, "designs": rows}).json()
    assert posted["axes"] == [{"name": "design", "unit": "1", "size": 2}]
    found = client.get(
        posted["links"]["slice"], params={"output": "throw_number", "axes": "design"}
    ).json()
    lists = {"frequency": [50, 40], "amplitude": ["0.3 mm", "0.2 mm"]}
    zipped = {**study, "parameters": {**study["parameters"], **lists},
              "designs": {"zip": ["frequency", "amplitude"]}}  # fmt: skip
    assert client.post("/sweeps", json=zipped).json()["id"] == posted["id"]
    each = [run_study(parse_study({**study, "parameters": {"beta": 20, **row}})) for row in rows]
    assert found["values"]["data"] == [float(one.throw_number) for one in each]
    best = {
        "kind": "optimise", "scene": "rectangle-on-plane", "variant": "thesis", "designs": rows,
        "criterion": {"kind": "maximise"}, "parameters": {"friction": 0.3},
    }  # fmt: skip
    reply = client.post("/processes/optimise/execution", json=best)
    assert reply.is_success
    refused = client.post("/sweeps", json={**study, "designs": {"file": "designs.csv"}})
    assert problem(refused, 422)["errors"][0]["place"] == "designs.file"
