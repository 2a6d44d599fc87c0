"""OWSLib's client of OGC API - Processes against a real server, without workarounds.

What a document must hold is written down from the text of the standard, OGC 18-062r2 (1.0.0).
"""

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
from vibrafeed.core.kinds import KINDS, run_study
from waiting import PATIENCE, SELDOM, wait_for

OGC = "http://www.opengis.net/def/rel/ogc/1.0/"
EXCEPTIONS = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"
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
    assert {type(document[name]) for name in ("processID", "jobID", "message")} == {str}
    assert document["progress"] in range(101)
    for name in {"created", "started", "finished", "updated"} & set(document):
        assert datetime.datetime.fromisoformat(document[name]).tzinfo is not None
    check_links(document["links"], rels={"self"})


def check_summary(document: Mapping[str, Any]) -> None:
    """Clause 7.11, processSummary: id, version; what the others may hold."""
    assert {type(document[name]) for name in ("id", "version")} == {str}
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
    assert {process["id"] for process in found} == {*KINDS, "accuracy"}
    whole = followed(client.response, f"{OGC}processes").json()
    assert whole["processes"] == found
    for process in found:
        check_summary(process)
        told = client.process(process["id"])
        assert followed(process, "self").json() == told
        check_summary(told)
        # inputDescription and outputDescription: schema is required.
        assert told["outputs"]["dataset"]["schema"]
        schema = told["inputs"]["study"]["schema"]
        if process["id"] == "accuracy":  # of studies with a witness
            assert set(schema["discriminator"]["mapping"]) == {"sweep", "simulate"}
        else:
            assert schema["properties"]["kind"]["const"] == process["id"]


def test_a_short_study_is_executed_at_once(client):
    assert client.execute("sweep", inputs={"study": SWEEP}, response="raw")["complete"] is True
    document = client.execute("sweep", inputs={"study": {"value": SWEEP}})
    # results: a mapping of outputs; qualifiedInputValue: value is required.
    assert set(document) == {"dataset"}
    assert document["dataset"]["mediaType"] == "application/json"
    value = document["dataset"]["value"]
    assert value["complete"] is True
    expected = run_study(parse_study({"kind": "sweep", **SWEEP}))
    for name, found in value["variables"].items():
        np.testing.assert_array_equal(np.array(found["data"], dtype=float), expected[name])


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


def test_jobs_are_listed_and_dismissed(client, server):
    status = client.execute("simulate", inputs={"study": LONG}, async_=True)
    listed = followed(client.response, f"{OGC}job-list").json()
    check_links(listed["links"], rels={"self"})
    for job in listed["jobs"]:
        check_status(job)
    assert status["jobID"] in {job["jobID"] for job in listed["jobs"]}
    (link,) = (link for link in status["links"] if link["rel"] == "self")
    reply = requests.delete(link["href"], timeout=PATIENCE)
    assert reply.status_code == 200
    check_status(reply.json())
    assert followed(reply.json(), "self").json()["status"] == "dismissed"
