"""The HTTP interface with a store of its own."""

from __future__ import annotations

import codecs
import contextlib
import json
import sqlite3
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from fastapi.testclient import TestClient

from local_client import local_client
from posted_sweeps import STUDY
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.app.web.calculations import read_task
from vibrafeed.app.web.routes import processes
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.scenes import SCENES


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(data_directory=tmp_path, max_body_bytes=20_000, max_cells=10**6)


@pytest.fixture
def client(settings: Settings):
    with local_client(create_app(settings), raise_server_exceptions=False) as client:
        yield client


@pytest.fixture
def posted(client: TestClient) -> str:
    return client.post("/sweeps", json=STUDY).json()["id"]


def problem(response, status: int = 422) -> dict:
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    document = response.json()
    assert document["status"] == status
    assert document["title"]
    assert document["detail"]
    return document


def test_health(client):
    assert client.get("/healthz").json()["status"] == "ok"


def test_head_is_answered_wherever_get_is(client):
    for path, operations in client.get("/openapi.json").json()["paths"].items():
        if "get" in operations:
            assert client.head(path).status_code != 405, path
    for path in ("/", "/healthz", "/readyz", "/scenes", "/processes/sweep", "/jobs"):
        head = client.head(path)
        assert head.status_code == client.get(path).status_code
        assert head.headers["content-type"] == client.get(path).headers["content-type"]
    number = client.post(
        "/processes/sweep/execution", json=STUDY, headers={"Prefer": "respond-async"}
    ).json()["jobID"]
    assert "content-length" not in client.head(f"/jobs/{number}/events").headers


@pytest.mark.parametrize(
    ("method", "path", "allowed"),
    [
        ("PUT", "/jobs/x", "DELETE, GET, HEAD, PATCH"),
        ("PUT", "/sweeps/x", "GET, HEAD, PATCH"),
        ("GET", "/processes/sweep/execution", "POST"),
        ("POST", "/page/page.css", "GET, HEAD"),
    ],
)
def test_a_method_that_is_not_allowed_lists_those_that_are(client, method, path, allowed):
    reply = client.request(method, path)
    problem(reply, 405)
    assert reply.headers["allow"] == allowed


def test_a_coded_body_is_refused_and_a_mark_of_utf_8_accepted(client):
    body = json.dumps(STUDY).encode()
    for path in ("/sweeps", "/processes/sweep/execution", "/convert?to=json"):
        coded = client.post(path, content=body, headers={"Content-Encoding": "gzip"})
        assert "Content-Encoding" in problem(coded, 415)["detail"]
    assert client.post("/sweeps", content=codecs.BOM_UTF8 + body).status_code == 201


def test_a_number_of_very_many_digits_is_told_in_our_words(client):
    body = b'{"parameters": {"friction": ' + b"1" * 15_000 + b"}}"
    (error,) = problem(client.post("/sweeps", content=body))["errors"]
    assert error["message"] == "it is a number larger than 1.8e308"


def test_the_schema_is_made_once_and_sent_to_whom_has_it_not(client, monkeypatch):
    first = client.get("/schema")
    assert len(first.content) <= 300_000
    monkeypatch.setattr(
        "vibrafeed.app.web.routes.scenes.study_schema_text", None
    )  # it is not made again
    again = client.get("/schema", headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    other = client.get("/schema", headers={"If-None-Match": '"another"'})
    assert (other.status_code, other.content) == (200, first.content)


def test_the_catalogue_lists_and_describes_every_scene(client):
    assert [line["name"] for line in client.get("/scenes").json()] == list(SCENES)
    for name, scene in SCENES.items():
        for variant in scene.variants:
            told = client.get(f"/scenes/{name}", params={"variant": variant}).json()
            assert [output["name"] for output in told["outputs"]] + ["regime"] == list(
                scene.outputs(variant)
            )
    problem(client.get("/scenes/nowhere"), 404)
    problem(client.get("/scenes/rectangle-on-track", params={"variant": "x"}))


def test_a_study_is_addressed_by_its_content(client):
    first = client.post("/sweeps", json=STUDY)
    assert first.status_code == 201
    again = client.post("/sweeps", json={**STUDY, "kind": "sweep"})
    assert again.status_code == 200
    assert first.json() == again.json()
    assert first.headers["location"].endswith(f"/sweeps/{first.json()['id']}")
    other = client.post("/sweeps", json={**STUDY, "variant": "thesis"})
    assert other.json()["id"] != first.json()["id"]
    assert first.json()["warnings"] == []
    wide = {**STUDY, "parameters": {**STUDY["parameters"], "amplitude": 0.3}}
    (line,) = client.post("/sweeps", json=wide).json()["warnings"]
    assert line.startswith("amplitude = 0.3 means 300 mm; usual values are")
    told = client.get(f"/sweeps/{first.json()['id']}").json()
    assert told["cells"] == 11 * 2 * 10 * 7
    assert told["outputs"][2] == {
        "name": "throw_number",
        "unit": "1",
        "label": "Throw number",
        "dims": ["frequency", "amplitude", "beta"],
        "source": "theory 13.2",
    }


def test_a_slice_is_a_piece_of_the_whole(client, posted):
    whole = run_study(parse_study(STUDY))
    piece = client.get(
        f"/sweeps/{posted}/slice",
        params={
            "output": "transport_velocity",
            "axes": "alpha,frequency",
            "beta": "15 deg",
            "amplitude": "0.5 mm",
        },
    ).json()
    expected = whole.transport_velocity.sel(beta=15, amplitude=5e-4)
    # One evaluation over a grid and one over its piece run the same operations on each cell.
    assert piece["values"]["dims"] == ["alpha", "frequency"]
    np.testing.assert_array_equal(np.array(piece["values"]["data"]).T, expected)
    np.testing.assert_array_equal(
        np.array(piece["regime"]["data"]).T, whole.regime.sel(beta=15, amplitude=5e-4)
    )
    assert piece["fixed"]["beta"] == 15
    assert piece["regimes"]["flight"]["valid"] is False


def test_a_slice_asks_only_for_the_axes_that_its_output_needs(client, posted):
    piece = client.get(
        f"/sweeps/{posted}/slice",
        params={"output": "throw_number", "axes": "beta", "frequency": 60 - 10, "amplitude": 5e-4},
    )
    assert piece.status_code == 200, piece.text
    assert "alpha" not in piece.json()["fixed"]
    assert "distance" not in piece.json()["fixed"]


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        ({"output": "velocity"}, "output", "Did you mean"),
        ({"axes": "bta"}, "axes", "Did you mean 'beta' (elevation)?"),
        ({"axes": "alpha,beta,frequency"}, "axes", "one or two"),
        ({"frequency": "55 Hz"}, "frequency", "nearest are 50 and 60 Hz"),
        ({"frequency": "55 kg"}, "frequency", "Hz"),
        ({"frequency": None}, "frequency", "from 20 to 120 Hz"),
        ({"radius": 1}, "radius", "Known: alpha"),
    ],
)
def test_a_wrong_slice_is_explained(client, posted, change, place, words):
    good = {"output": "acceleration_x", "axes": "beta", "frequency": 50, "amplitude": 5e-4}
    params = {k: v for k, v in {**good, "alpha": 10, **change}.items() if v is not None}
    document = problem(client.get(f"/sweeps/{posted}/slice", params=params))
    found = {error["place"]: f"{error['message']} {error['fix']}" for error in document["errors"]}
    assert words in found[place]


def test_the_netcdf_download_opens_in_a_fresh_process(client, posted, tmp_path):
    response = client.get(f"/sweeps/{posted}/netcdf")
    assert response.status_code == 200
    assert response.headers["content-type"] == "application/x-netcdf"
    (tmp_path / "x.nc").write_bytes(response.content)
    code = (
        "import sys, xarray\n"
        "d = xarray.open_dataset(sys.argv[1], engine='netcdf4')\n"
        "print(d.transport_velocity.dims, d.regime.dtype, d.attrs['Conventions'])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "x.nc")],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "('frequency', 'amplitude', 'alpha', 'beta') int8 CF-1.11" in done.stdout
    assert client.get(f"/sweeps/{posted}/netcdf").content == response.content


def test_files_are_written_by_one_thread_however_many_ask(client):
    """Eight threads in the NetCDF library at once crash the process."""

    def fetch(friction: float) -> int:
        study = {**STUDY, "parameters": {**STUDY["parameters"], "friction": friction}}
        key = client.post("/sweeps", json=study).json()["id"]
        return client.get(f"/sweeps/{key}/netcdf").status_code

    with ThreadPoolExecutor(8) as pool:
        assert set(pool.map(fetch, np.linspace(0, 1, 24).tolist())) == {200}


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"[]",
        b"nonsense",
        b'{"kind": NaN}',
        b'{"kind": "sweep", "kind": "sweep"}',
        b'{"kind": 1e400}',
        b'{"kind": ' + b"[" * 9000 + b"}",
        b"\xff\xfe\x00",
        b'{"kind": "sweep", "scene": "../../etc/passwd", "outputs": ["x"], "parameters": {}}',
        b'{"kind": "sweep", "scene": {}, "outputs": 3, "parameters": []}',
        b'{"kind":"sweep","scene":"rectangle-on-plane","outputs":["throw_number"],'
        b'"parameters":{"frequency":1e400}}',
    ],
)
def test_a_body_that_is_no_study_gets_a_problem_document(client, body):
    document = problem(client.post("/sweeps", content=body))
    assert all(error["message"] and error["fix"] for error in document["errors"])


def test_limits_are_named_with_what_would_fit(client):
    problem(client.post("/sweeps", content=b" " * 30_000), 413)
    axis = {"start": 0, "stop": 1, "num": 1_000_000}
    study = {**STUDY, "parameters": {**STUDY["parameters"], "friction": axis, "distance": axis}}
    document = problem(client.post("/sweeps", json=study))
    assert "1,000,000" in document["detail"]
    assert "It fits with" in document["detail"]


@pytest.mark.parametrize(
    "path",
    [
        "/sweeps/" + "0" * 64,
        "/sweeps/..%2F..%2Fetc",
        "/sweeps/x/netcdf",
        "/sweeps/x/slice?output=a&axes=b",
    ],
)
def test_an_unknown_sweep_is_not_found(client, path):
    problem(client.get(path), 404)


def test_an_unforeseen_error_is_a_problem_document_without_its_text(client, posted, monkeypatch):
    def fail(key: str) -> None:
        raise RuntimeError("secret path")

    monkeypatch.setattr(client.app.state.store, "sweep", fail)
    document = problem(client.get(f"/sweeps/{posted}"), 500)
    assert "secret" not in str(document)


def test_a_ledger_that_another_process_holds_is_asked_again(client, tmp_path, monkeypatch):
    def held(*_: object, **__: object) -> None:
        with (
            contextlib.closing(sqlite3.connect(tmp_path / "other", isolation_level=None)) as one,
            contextlib.closing(sqlite3.connect(tmp_path / "other", timeout=0)) as two,
        ):
            one.execute("BEGIN EXCLUSIVE")
            two.execute("CREATE TABLE jobs (id)")

    with monkeypatch.context() as busy:
        busy.setattr(client.app.state.admission.ledger, "jobs", held)
        response = client.get("/jobs")
    document = problem(response, 503)
    assert document["type"] == "urn:vibrafeed:problem:busy"
    assert "holds the ledger" in document["detail"]
    assert int(response.headers["retry-after"]) >= 1
    assert client.get("/jobs").status_code == 200


def test_unknown_routes_get_problem_documents(client):
    problem(client.get("/nowhere"), 404)


def test_importing_the_app_builds_nothing(tmp_path):
    code = "import vibrafeed.app.main, os; print(os.listdir())"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


SIMULATION = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity", "flight_fraction"],
    "parameters": {
        "frequency": "50 Hz",
        "amplitude": {"start": "0.1 mm", "stop": "0.4 mm", "num": 4},
        "beta": "30 deg",
        "friction": [0.3, 0.5],
    },
}


class TestSimulation:
    PATH = "/processes/simulate/execution"

    @pytest.mark.parametrize(
        "body",
        [
            SIMULATION,
            {"inputs": {"study": SIMULATION}},
            {"inputs": {"study": {k: v for k, v in SIMULATION.items() if k != "kind"}}},
        ],
    )
    def test_it_is_the_dataset_of_the_core(self, client, body):
        reply = client.post(self.PATH, json=body)
        assert reply.status_code == 200, reply.text
        document = reply.json()
        assert document["complete"] is True
        assert document["cells"] == 8
        expected = run_study(parse_study(SIMULATION))
        for name in expected.data_vars:
            variable = document["variables"][name]
            assert variable["dims"] == list(expected[name].dims)
            np.testing.assert_array_equal(variable["data"], expected[name].values)
        assert document["variables"]["regime"]["flags"]["hopping"] == 28
        assert document["coordinates"]["amplitude"]["units"] == "m"
        assert document["coordinates"]["beta"]["data"] == 30

    def test_what_has_no_mean_is_null_with_a_status(self, client):
        study = {**SIMULATION, "parameters": {**SIMULATION["parameters"], "gamma": 40}}
        document = client.post(self.PATH, json=study).json()
        assert document["variables"]["conveying_velocity"]["data"][0] == [None, None]
        status = document["variables"]["motion_status"]
        assert status["data"][0][0] == status["flags"]["runaway"]

    def test_wrong_studies(self, client):
        wrong = {**SIMULATION, "outputs": ["conveying_velocty"]}
        found = problem(client.post(self.PATH, json=wrong))["errors"]
        assert found[0]["place"] == "outputs"
        for body, place in (
            ({"inputs": {}}, "inputs.study"),
            ({"inputs": []}, "inputs"),
            ({**SIMULATION, "kind": "sweep"}, "kind"),
            ([1], "study"),
        ):
            assert problem(client.post(self.PATH, json=body))["errors"][0]["place"] == place

    def test_limits(self, settings):
        small = settings.model_copy(update={"max_cells": 5, "max_sweep_cells": 5})
        with local_client(create_app(small)) as client:
            reply = problem(client.post(self.PATH, json=SIMULATION))
            assert reply["type"].endswith("limit")
            assert "4" in reply["detail"]

    @pytest.mark.parametrize("grace", [300, 1e-9], ids=["stops", "is ended"])
    def test_what_takes_longer_than_a_request_goes_on_as_a_job(self, settings, grace, monkeypatch):
        hurried = settings.model_copy(
            update={"max_execution_seconds": 1e-9, "grace_seconds": grace}
        )
        if grace < 1:  # to read the study has as long as the run that was ended
            patience = processes.calculate_in_process

            async def patient(request, function, *arguments, seconds):
                seconds = 300 if function is read_task else seconds
                return await patience(request, function, *arguments, seconds=seconds)

            monkeypatch.setattr(processes, "calculate_in_process", patient)
        with local_client(create_app(hurried)) as client:
            reply = client.post(self.PATH, json=SIMULATION)
            assert reply.status_code == 201, reply.text
            assert reply.headers["location"].endswith(f"/jobs/{reply.json()['jobID']}")
            assert problem(client.post(self.PATH, json={**SIMULATION, "outputs": ["x"]}))["errors"]

    def test_what_becomes_a_job_is_read_by_a_process_of_the_pool(self, client, monkeypatch):
        def refuse(*_):
            raise AssertionError("the server reads a study")

        monkeypatch.setattr("vibrafeed.app.web.calculations.prepare_content", refuse)
        monkeypatch.setattr("vibrafeed.app.jobs.studies.prepare_content", refuse)
        wish = {"Prefer": "respond-async"}
        assert client.post(self.PATH, json=SIMULATION, headers=wish).status_code == 201
        assert client.post("/sweeps", json=STUDY).status_code == 201
        assert problem(client.post(self.PATH, json={}, headers=wish))["errors"]

    def test_a_job_is_posted_though_its_owner_computes_all_it_may(self, settings):
        app = create_app(settings.model_copy(update={"workers": 2}))
        with local_client(app) as client:
            queue = app.state.process_pool.fair_queue
            held = [client.portal.call(queue._take, "testclient", 0.0) for _ in range(2)]
            wish = {"Prefer": "respond-async"}
            assert client.post(self.PATH, json=SIMULATION, headers=wish).status_code == 201
            for slot in held:
                client.portal.call(queue._leave, slot)

    def test_many_at_a_time(self, client):
        with ThreadPoolExecutor(8) as pool:
            replies = list(pool.map(lambda _: client.post(self.PATH, json=SIMULATION), range(16)))
        values = {str(reply.json()["variables"]) for reply in replies}
        assert len(values) == 1

    def test_the_catalogue_tells_of_methods(self, client):
        line = next(s for s in client.get("/scenes").json() if s["name"] == "rectangle-on-plane")
        assert line["methods"][0] == "events"
        scene = client.get("/scenes/rectangle-on-plane", params={"method": "events"}).json()
        assert "conveying_velocity" in [output["name"] for output in scene["outputs"]]
        problem(client.get("/scenes/rectangle-on-plane", params={"method": "event"}))
