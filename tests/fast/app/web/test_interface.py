"""The HTTP interface: documents, studies read, refused, converted, computed; and the page."""

import codecs
import gzip
import hashlib
import importlib
import json
import mimetypes
import re
import shutil
import threading
import tomllib
from pathlib import Path

import numpy as np
import pytest
from fastapi.testclient import TestClient

from local_client import client_of, local_client
from posted_sweeps import STUDY, problem
from vibrafeed.app.web import calculations
from vibrafeed.app.web.execution import PROCESSES
from vibrafeed.app.web.openapi import StudySchema
from vibrafeed.app.web.routes import page, processes
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.intake import parse_study
from vibrafeed.core.intake.forms import FORMS, REQUESTS, to_toml
from vibrafeed.core.kinds import run_study
from vibrafeed.core.quantities import MOTION_STATUSES
from vibrafeed.core.scenes import SCENES

ROOT = Path(__file__).parents[4]
SITE = ("gallery", "kinds", "mistakes", "quantities", "settings")
WRITTEN = {f"generated/{name}.md" for name in SITE}
PATH = "/processes/simulate/execution"
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


@pytest.fixture(scope="module")
def posted(client: TestClient) -> str:
    return client.post("/sweeps", json=STUDY).json()["id"]


class TestDocuments:
    def test_the_pages_keep_up_with_the_code(self, client, without_studies):
        text = (ROOT / "docs/api.md").read_text()
        for path, methods in client.app.openapi()["paths"].items():
            for method in methods:
                assert f"`{method.upper()} {path}`" in text
        text = (ROOT / "docs/motion.md").read_text()
        for name, flag in MOTION_STATUSES.items():
            assert f"`{name}`" in text or flag.valid, name

    def test_links_between_documents_hold(self):
        for path in (*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")):
            for target in re.findall(r"\]\(([^)#]+)\)", path.read_text()):
                if not target.startswith("http") and target not in WRITTEN:
                    assert (path.parent / target).exists(), f"{path.name}: {target}"

    @pytest.mark.parametrize("root", ["", "/vibrafeed"])
    def test_openapi_comes_from_memory_with_an_etag(
        self, tmp_path, root, monkeypatch, without_studies
    ):
        app = client_of(tmp_path).app
        client = local_client(app, root_path=root)
        first = client.get("/openapi.json")
        assert first.status_code == 200
        expected = app.openapi()
        assert first.json() == (expected | {"servers": [{"url": root}]} if root else expected)
        monkeypatch.setattr("fastapi.applications.get_openapi", None)  # it is not made again
        assert client.get("/openapi.json").content == first.content
        known = client.get("/openapi.json", headers={"If-None-Match": first.headers["etag"]})
        assert known.status_code == 304
        assert client.head("/openapi.json").headers["etag"] == first.headers["etag"]

    def test_the_schema_is_made_once_and_sent_to_whom_has_it_not(self, client, monkeypatch):
        first = client.get("/schema")
        assert len(first.content) <= 300_000
        monkeypatch.setattr("vibrafeed.app.web.routes.scenes.study_schema", None)
        again = client.get("/schema", headers={"If-None-Match": first.headers["etag"]})
        assert (again.status_code, again.content) == (304, b"")
        other = client.get("/schema", headers={"If-None-Match": '"another"'})
        assert (other.status_code, other.content) == (200, first.content)
        told = client.get("/processes/sweep").json()
        schema = told["inputs"]["study"]["schema"]
        assert schema == PROCESSES["sweep"].study.model_json_schema(schema_generator=StudySchema)
        assert told["links"][0]["href"].endswith("/processes/sweep")

    def test_the_catalogue_lists_and_describes_every_scene(self, client):
        listed = client.get("/scenes").json()
        assert [line["name"] for line in listed] == list(SCENES)
        methods = {line["name"]: line["methods"] for line in listed}
        assert methods["rectangle-on-plane"][0] == "events"
        for name, scene in SCENES.items():
            for variant in scene.variants:
                told = client.get(f"/scenes/{name}", params={"variant": variant}).json()
                outputs = [output["name"] for output in told["outputs"]]
                assert [*outputs, "regime"] == list(scene.outputs(variant))
        told = client.get("/scenes/rectangle-on-plane", params={"method": "events"}).json()
        assert "conveying_velocity" in [output["name"] for output in told["outputs"]]
        problem(client.get("/scenes/nowhere"), 404)
        for query in ("variant=x", "method=event"):
            problem(client.get(f"/scenes/rectangle-on-plane?{query}"), 422)


class TestRequests:
    def test_head_is_answered_wherever_get_is(self, client, without_studies):
        for path, operations in client.app.openapi()["paths"].items():
            if "get" in operations:
                assert client.head(path).status_code != 405, path
        for path in ("/", "/healthz", "/readyz", "/scenes", "/processes/sweep", "/jobs"):
            head, got = client.head(path), client.get(path)
            assert head.status_code == got.status_code
            assert head.headers["content-type"] == got.headers["content-type"]
        number = client.post(PATH, json=SIMULATION, headers={"Prefer": "respond-async"})
        events = client.head(f"{number.headers['location']}/events")
        assert "content-length" not in events.headers

    @pytest.mark.parametrize(
        ("method", "path", "allowed"),
        [
            ("PUT", "/jobs/x", "DELETE, GET, HEAD, PATCH"),
            ("PUT", "/sweeps/x", "GET, HEAD, PATCH"),
            ("PUT", "/sweeps/x/zarr/zarr.json", "GET, HEAD"),
            ("GET", "/processes/sweep/execution", "POST"),
            ("POST", "/page/page.css", "GET, HEAD"),
        ],
    )
    def test_a_method_that_is_not_allowed_lists_those_that_are(self, client, method, path, allowed):
        reply = client.request(method, path)
        problem(reply, 405)
        assert reply.headers["allow"] == allowed

    def test_a_coded_body_is_refused_and_a_mark_of_utf_8_accepted(self, client):
        body = json.dumps(STUDY).encode()
        for path in ("/sweeps", "/processes/sweep/execution", "/convert?to=json"):
            coded = client.post(path, content=body, headers={"Content-Encoding": "gzip"})
            assert "Content-Encoding" in problem(coded, 415)["detail"]
        assert client.post("/sweeps", content=codecs.BOM_UTF8 + body).is_success

    @pytest.mark.parametrize(
        "body",
        [
            b"",
            b"nonsense",
            b'{"kind": "sweep", "scene": "../../etc/passwd", "outputs": ["x"], "parameters": {}}',
            b'{"kind": "sweep", "scene": {}, "outputs": 3, "parameters": []}',
            b'{"kind":"sweep","scene":"rectangle-on-plane","outputs":["throw_number"],'
            b'"parameters":{"frequency":1e400}}',
            b'{"parameters": {"friction": ' + b"1" * 15_000 + b"}}",
        ],
    )
    def test_a_body_that_is_no_study_gets_a_problem_document(self, client, body):
        document = problem(client.post("/sweeps", content=body), 422)
        assert all(error["message"] and error["fix"] for error in document["errors"])
        if b"1" * 15_000 in body:
            assert document["errors"][0]["message"] == "the number is larger than 1.8e308"

    def test_limits_are_named_with_what_would_fit(self, client):
        axis = {"start": 0, "stop": 1, "num": 1_000_000}
        study = {**STUDY, "parameters": {**STUDY["parameters"], "friction": axis, "distance": axis}}
        document = problem(client.post("/sweeps", json=study), 422)
        assert "1,000,000" in document["detail"]
        assert "It fits with" in document["detail"]

    def test_an_unforeseen_error_is_a_problem_document_without_its_text(
        self, client, posted, monkeypatch
    ):
        def fail(key: str) -> None:
            raise RuntimeError("secret path")

        monkeypatch.setattr(client.app.state.store, "sweep", fail)
        assert "secret" not in str(problem(client.get(f"/sweeps/{posted}"), 500))


class TestSweeps:
    def test_a_study_is_addressed_by_its_content(self, client):
        study = {**STUDY, "title": "new"}
        first = client.post("/sweeps", json=study)
        assert first.status_code == 201
        again = client.post("/sweeps", json={**study, "kind": "sweep"})
        assert again.status_code == 200
        told = first.json()
        assert told == again.json() == client.get(f"/sweeps/{told['id']}").json() | {"warnings": []}
        assert first.headers["location"].endswith(f"/sweeps/{told['id']}")
        other = client.post("/sweeps", json={**study, "variant": "thesis"})
        assert other.json()["id"] != told["id"]
        wide = {**STUDY, "parameters": {**STUDY["parameters"], "amplitude": 0.3}}
        (line,) = client.post("/sweeps", json=wide).json()["warnings"]
        assert line.startswith("amplitude = 0.3 means 300 mm; usual values are")
        assert told["cells"] == 11 * 2 * 10 * 7
        assert told["outputs"][2] == {
            "name": "throw_number",
            "unit": "1",
            "label": "Throw number",
            "dims": ["frequency", "amplitude", "beta"],
            "source": "theory 13.2",
        }


class TestSimulation:
    @pytest.mark.parametrize(
        "body",
        [
            SIMULATION,
            {"inputs": {"study": {k: v for k, v in SIMULATION.items() if k != "kind"}}},
        ],
    )
    def test_it_is_the_dataset_of_the_core(self, client, body):
        reply = client.post(PATH, json=body)
        assert reply.status_code == 200, reply.text
        document = reply.json()
        assert (document["complete"], document["cells"]) == (True, 8)
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
        document = client.post(PATH, json=study).json()
        assert document["variables"]["conveying_velocity"]["data"][0] == [None, None]
        status = document["variables"]["motion_status"]
        assert status["data"][0][0] == status["flags"]["runaway"]

    @pytest.mark.parametrize(
        ("body", "place"),
        [
            ({**SIMULATION, "outputs": ["conveying_velocty"]}, "outputs"),
            ({"inputs": {}}, "inputs.study"),
            ({"inputs": []}, "inputs"),
            ({**SIMULATION, "kind": "sweep"}, "kind"),
            ([1], "study"),
            ({**SIMULATION, "drive": {"file": "/etc/hostname", "along": "ax"}}, "drive.file"),
        ],
    )
    def test_wrong_studies(self, client, body, place):
        for headers in ({}, {"Prefer": "respond-async"}):
            reply = client.post(PATH, json=body, headers=headers)
            assert place in {error["place"] for error in problem(reply, 422)["errors"]}

    @pytest.mark.parametrize("is_ended", [False, True])
    def test_what_takes_longer_than_a_request_goes_on_as_a_job(
        self, tmp_path, is_ended, monkeypatch
    ):
        """By itself, or its process is ended."""
        patience = processes.calculate_in_process

        async def calculate(request, function, *arguments, seconds):
            if is_ended and function is processes.execute_at_once:
                raise StoppedError("ended")
            return await patience(request, function, *arguments, seconds=seconds)

        monkeypatch.setattr(processes, "calculate_in_process", calculate)
        with client_of(tmp_path, max_execution_seconds=30 if is_ended else 1e-9) as client:
            reply = client.post(PATH, json=SIMULATION)
            assert reply.status_code == 201, reply.text
            assert reply.headers["location"].endswith(f"/jobs/{reply.json()['jobID']}")
            assert problem(client.post(PATH, json={**SIMULATION, "outputs": ["x"]}), 422)["errors"]

    def test_what_becomes_a_job_is_read_by_a_process_of_the_pool(self, client, monkeypatch):
        prepare = calculations.prepare_content

        def read(*given):
            assert threading.current_thread().name.startswith("pool"), "the server reads a study"
            return prepare(*given)

        monkeypatch.setattr("vibrafeed.app.web.calculations.prepare_content", read)
        monkeypatch.setattr("vibrafeed.app.jobs.studies.prepare_content", read)
        wish = {"Prefer": "respond-async"}
        assert client.post(PATH, json=SIMULATION, headers=wish).status_code == 201
        assert client.post("/sweeps", json=STUDY).is_success

    def test_a_job_is_posted_though_its_owner_computes_all_it_may(self, client):
        queue = client.app.state.process_pool.fair_queue
        held = [client.portal.call(queue._take, "testclient", 0.0) for _ in range(2)]
        wish = {"Prefer": "respond-async"}
        assert client.post(PATH, json=SIMULATION, headers=wish).status_code == 201
        for slot in held:
            client.portal.call(queue._release, slot)


class TestConvert:
    def test_each_form_is_that_of_the_command(self, client):
        for form, write in FORMS.items():
            reply = client.post(f"/convert?to={form}", json=SIMULATION)
            assert reply.status_code == 200
            assert reply.headers["content-type"] == "text/plain; charset=utf-8"
            if form not in REQUESTS:
                assert reply.text == write(SIMULATION)
            if form == "toml":
                assert tomllib.loads(reply.text) == SIMULATION
        # The line asks the service that wrote it.
        address = f"{str(client.base_url).rstrip('/')}{PATH}"
        for form, end in (("curl", f" {address}\n"), ("powershell", f" -Uri '{address}'\n")):
            assert client.post(f"/convert?to={form}", json=SIMULATION).text.endswith(end)

    def test_what_is_wrong_is_told_as_where_it_is_carried_out(self, client):
        wrong = {**SIMULATION, "parameters": {**SIMULATION["parameters"], "friction": -1}}
        told = problem(client.post("/convert?to=toml", json=wrong), 422)
        assert told["errors"] == client.post(PATH, json=wrong).json()["errors"]
        # A file of the service's machine is nobody's to name.
        named = {**SIMULATION, "drive": {"file": "/etc/hostname"}}
        for to, content in (("word", SIMULATION), ("toml", [1]), ("curl", named)):
            problem(client.post(f"/convert?to={to}", json=content), 422)

    def test_a_long_array_is_read_and_never_put_together_value_by_value(self, monkeypatch):
        """Value by value it takes the square of its length: 9,000 values took 3 s."""
        odd = ['a "quoted" word', "two\nlines", "\\", "20 Hz", 0.1, 1e-300, -7, True]
        content = {
            "kind": "sweep", "outputs": ["acceleration_x"],
            "parameters": {"beta": [round(0.004 * n, 6) for n in range(2_000)], "friction": odd},
        }  # fmt: skip
        monkeypatch.setattr("tomlkit.items.Array.append", None)
        monkeypatch.setattr("tomlkit.items.Array.insert", None)
        assert tomllib.loads(to_toml(content)) == content


PAGE = ROOT / "app" / "page"
BROWSER = {"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"}
MOST = 400_000  # bytes, compressed
MARKUP = r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|eval\("


def test_a_browser_gets_the_page_and_a_program_gets_links(client):
    page = client.get("/", headers=BROWSER)
    assert page.headers["content-type"].startswith("text/html")
    assert "<title>vibrafeed</title>" in page.text
    assert client.get("/").json()["title"] == "vibrafeed"
    assert client.get("/", headers={"Accept": "application/json"}).json()["links"]
    for path in ("/", "/docs"):  # scripts come of files of its own only
        reply = client.get(path, headers=BROWSER)
        assert "script-src 'self';" in reply.headers["content-security-policy"]
        assert not re.search(r"<script(?![^>]*\bsrc=)|<style|\son[a-z]+=|\sstyle=", reply.text)


def test_a_wheel_with_a_bundle_sends_it_in_place_of_the_entry(tmp_path, monkeypatch):
    folder = tmp_path / "page"
    shutil.copytree(PAGE, folder)
    (folder / "bundle.js").write_text("// all modules")
    monkeypatch.setattr(page, "FILES", folder)
    monkeypatch.setattr(page, "BUNDLE", folder / "bundle.js")
    client = client_of(tmp_path / "data")
    assert client.get("/page/modules/main.js").text == "// all modules"
    assert "import" in client.get("/page/modules/answers.js").text


def test_scripts_have_their_type_whatever_the_registry_of_windows_says():
    for ending in (".js", ".css", ".svg"):
        mimetypes.add_type("text/plain", ending)
    importlib.reload(page)
    types = [mimetypes.guess_type(f"page{ending}")[0] for ending in (".js", ".css", ".svg")]
    assert types == ["text/javascript", "text/css", "image/svg+xml"]


def test_libraries_are_what_they_were_published_as():
    vendor = PAGE / "vendor"
    listed = dict(
        reversed(line.split()) for line in (vendor / "SHA256SUMS").read_text().splitlines()
    )
    files = [path for path in vendor.iterdir() if path.suffix in (".js", ".mjs", ".css")]
    assert {path.name for path in files} == set(listed)
    for path in files:
        assert hashlib.sha256(path.read_bytes()).hexdigest() == listed[path.name]
        assert path.name in (vendor / "README.md").read_text()


def test_the_page_makes_no_markup_from_text_and_stays_small():
    for path in (PAGE / "modules").glob("*.js"):
        assert not re.search(MARKUP, path.read_text()), path
    files = [path for path in PAGE.rglob("*") if path.suffix in (".js", ".css", ".html", ".svg")]
    assert sum(len(gzip.compress(path.read_bytes())) for path in files) < MOST


def test_figures_are_studies_that_the_service_takes(client):
    figures = client.get("/figures").json()
    assert [one["name"] for one in figures[:3]] == ["fig-3-3", "fig-3-15", "fig-5-1"]
    assert all(one["title"] and one["notes"] for one in figures)
    assert client.post("/sweeps", json=figures[-1]["study"]).status_code == 201
