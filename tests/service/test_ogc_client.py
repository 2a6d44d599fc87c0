"""OWSLib's client of OGC API - Processes against a real server, without workarounds.

What a document must hold is written down from the text of the standard, OGC 18-062r2 (1.0.0).
"""

from __future__ import annotations

import datetime
from collections.abc import Mapping
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest
import requests
import xarray
from owslib import ogcapi
from owslib.ogcapi.processes import Processes

from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from waiting import PATIENCE, SELDOM, wait_for

OGC = "http://www.opengis.net/def/rel/ogc/1.0/"
CLASSES = "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/"
STATES = {"accepted", "running", "successful", "failed", "dismissed"}

SWEEP = {
    "scene": "rectangle-on-track",
    "outputs": ["acceleration_x", "transport_velocity"],
    "parameters": {
        "frequency": {"start": "20 Hz", "stop": "120 Hz", "num": 6},
        "amplitude": "0.5 mm",
        "alpha": {"start": 0, "stop": 90, "num": 5},
        "beta": [15, 30],
        "friction": 0.3,
        "radius": "0.8 m",
        "distance": "0.2 mm",
    },
}
SIMULATION = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity", "flight_fraction"],
    "parameters": {
        "frequency": 50,
        "amplitude": {"start": "0.1 mm", "stop": "0.7 mm", "num": 13},
        "beta": {"start": 10, "stop": 50, "num": 5},
        "friction": 0.4,
    },
}
# Some ten minutes of work: it is dismissed before it ends.
LONG = {
    **SIMULATION,
    "parameters": {
        **SIMULATION["parameters"],
        "amplitude": {"start": "0.1 mm", "stop": "0.7 mm", "num": 2001},
        "beta": {"start": 10, "stop": 50, "num": 501},
    },
}


@pytest.fixture
def client(server: str, monkeypatch: pytest.MonkeyPatch) -> Processes:
    # The client keeps headers in one mapping for all of its instances.
    monkeypatch.setattr(ogcapi, "REQUEST_HEADERS", dict(ogcapi.REQUEST_HEADERS))
    return Processes(server)


def check_links(links: list[dict[str, Any]], *, rels: set[str]) -> None:
    """Clause 7, link: `href` is required; ours are whole addresses, and name their type."""
    for link in links:
        assert urlsplit(link["href"]).scheme == "http", link
        assert {"rel", "type", "title"} - {"title"} <= set(link), link
    assert rels <= {link["rel"] for link in links}


def check_status(document: Mapping[str, Any]) -> None:
    """Clause 7.13, statusInfo: jobID, status, type; the kinds of the others."""
    assert {"jobID", "status", "type"} <= set(document)
    assert document["type"] == "process"
    assert document["status"] in STATES
    for name in ("processID", "jobID", "message"):
        assert isinstance(document[name], str)
    assert isinstance(document["progress"], int)
    assert 0 <= document["progress"] <= 100
    for name in {"created", "started", "finished", "updated"} & set(document):
        assert datetime.datetime.fromisoformat(document[name]).tzinfo is not None
    check_links(document["links"], rels={"self"})


def check_summary(document: Mapping[str, Any]) -> None:
    """Clause 7.11, processSummary: id, version; what the others may hold."""
    assert isinstance(document["id"], str)
    assert isinstance(document["version"], str)
    assert set(document["jobControlOptions"]) <= {"sync-execute", "async-execute", "dismiss"}
    assert set(document["outputTransmission"]) <= {"value", "reference"}
    check_links(document["links"], rels={"self", f"{OGC}execute"})


def followed(document: Mapping[str, Any], rel: str) -> requests.Response:
    """Fetch what a link names, as it stands."""
    (link,) = (link for link in document["links"] if link["rel"] == rel)
    reply = requests.get(link["href"], timeout=PATIENCE)
    assert reply.headers["content-type"].partition(";")[0] == link["type"].partition(";")[0]
    return reply


def waited(status: dict[str, Any]) -> dict[str, Any]:
    """Follow the link of a job to itself until it is over."""

    def ended() -> dict[str, Any] | None:
        now = followed(status, "self").json()
        check_status(now)
        return None if now["status"] in ("accepted", "running") else now

    return wait_for(ended, every=SELDOM)


def test_landing_page_and_conformance(client, server):
    assert {"links"} <= set(client.response)
    check_links(
        client.links,
        rels={"self", "service-desc", "service-doc", f"{OGC}conformance", f"{OGC}processes",
              f"{OGC}job-list"},
    )  # fmt: skip
    for link in client.links:
        assert requests.get(link["href"], timeout=PATIENCE).status_code == 200, link
    assert followed(client.response, f"{OGC}conformance").json() == client.conformance()
    classes = client.conformance()["conformsTo"]
    assert {f"{CLASSES}{name}" for name in ("core", "json", "job-list", "dismiss")} <= set(classes)


def test_processes_and_their_descriptions(client):
    found = client.processes()
    assert [process["id"] for process in found] == [
        "sweep",
        "simulate",
        "optimise",
        "sensitivity",
        "calibrate",
        "accuracy",
    ]
    whole = followed(client.response, f"{OGC}processes").json()
    assert set(whole) >= {"processes", "links"}
    assert whole["processes"] == found
    for process in found:
        check_summary(process)
        told = client.process(process["id"])
        assert followed(process, "self").json() == told
        check_summary(told)
        # inputDescription and outputDescription: schema is required.
        assert isinstance(told["inputs"]["study"]["schema"], dict)
        assert isinstance(told["outputs"]["dataset"]["schema"], dict)
        schema = told["inputs"]["study"]["schema"]
        if process["id"] == "accuracy":  # of studies with a witness
            assert set(schema["discriminator"]["mapping"]) == {"sweep", "simulate"}
        else:
            assert schema["properties"]["kind"]["const"] == process["id"]


def test_a_missing_process_is_told_as_the_standard_asks(client):
    with pytest.raises(RuntimeError, match=r"exceptions/ogcapi-processes-1/1.0/no-such-process"):
        client.process("nothing")


@pytest.mark.parametrize("wrap", [lambda study: study, lambda study: {"value": study}])
def test_a_short_study_is_executed_at_once(client, wrap):
    document = client.execute("sweep", inputs={"study": wrap(SWEEP)})
    # results: a mapping of outputs; qualifiedInputValue: value is required.
    assert set(document) == {"dataset"}
    assert document["dataset"]["mediaType"] == "application/json"
    value = document["dataset"]["value"]
    assert value["complete"] is True
    expected = run_study(parse_study({"kind": "sweep", **SWEEP}))
    for name in expected.data_vars:
        found = value["variables"][name]
        assert found["dims"] == list(expected[name].dims)
        data = np.array(found["data"], dtype=expected[name].dtype)
        np.testing.assert_array_equal(data, expected[name].values)


def test_raw_is_the_dataset_itself(client):
    assert client.execute("sweep", inputs={"study": SWEEP}, response="raw")["complete"] is True


def test_a_job_from_the_post_to_the_file(client, server, tmp_path):
    status = client.execute("simulate", inputs={"study": SIMULATION}, async_=True)
    check_status(status)
    address = client.response_headers["Location"]
    assert requests.get(address, timeout=PATIENCE).json()["jobID"] == status["jobID"]
    assert client.response_headers["Preference-Applied"] == "respond-async"
    status = waited(status)
    assert status["status"] == "successful", status
    assert status["progress"] == 100
    results = followed(status, f"{OGC}results").json()
    # results by reference: link, of which href is required.
    assert set(results) == {"dataset"}
    link = results["dataset"]
    reply = requests.get(link["href"], timeout=PATIENCE)
    assert reply.headers["content-type"] == link["type"] == "application/x-netcdf"
    assert len(reply.content) == link["length"]
    path = tmp_path / "motion.nc"
    path.write_bytes(reply.content)
    read = xarray.load_dataset(path, engine="netcdf4")
    xarray.testing.assert_equal(read, run_study(parse_study(SIMULATION)))


def test_the_list_of_jobs(client):
    status = client.execute("sweep", inputs={"study": SWEEP}, async_=True)
    waited(status)
    listed = followed(client.response, f"{OGC}job-list").json()
    assert {"jobs", "links"} <= set(listed)
    check_links(listed["links"], rels={"self"})
    for job in listed["jobs"]:
        check_status(job)
    assert status["jobID"] in {job["jobID"] for job in listed["jobs"]}


def test_a_job_is_dismissed(client):
    status = client.execute("simulate", inputs={"study": LONG}, async_=True)
    (link,) = (link for link in status["links"] if link["rel"] == "self")
    early = requests.get(f"{link['href']}/results", timeout=PATIENCE)
    assert early.status_code == 404
    assert early.json()["type"] == (
        "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/result-not-ready"
    )
    reply = requests.delete(link["href"], timeout=PATIENCE)
    assert reply.status_code == 200
    check_status(reply.json())
    assert reply.json()["status"] == "dismissed"
    assert followed(reply.json(), "self").json()["status"] == "dismissed"


def test_a_missing_job_is_told_as_the_standard_asks(server):
    for method, end in (("GET", ""), ("DELETE", ""), ("GET", "/results")):
        reply = requests.request(method, f"{server}/jobs/nothing{end}", timeout=PATIENCE)
        assert reply.status_code == 404
        assert reply.json()["type"] == (
            "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/no-such-job"
        )
