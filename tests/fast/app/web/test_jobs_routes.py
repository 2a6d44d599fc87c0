"""Processes and jobs over HTTP: status codes, headers, documents."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
import xarray
from fastapi import Request
from fastapi.testclient import TestClient

from local_client import ended, local_client
from vibrafeed.app.jobs.ledger import Ledger
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study

pytestmark = pytest.mark.service  # a server with workers of its own

OGC = "http://www.opengis.net/def/rel/ogc/1.0/"
EXCEPTIONS = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"
PATH = "/processes/sweep/execution"
ASYNC = {"Prefer": "respond-async"}
WAIT = {"Prefer": "respond-async, wait=50"}


def study(**parameters: Any) -> dict[str, Any]:
    return {
        "kind": "sweep",
        "scene": "rectangle-on-track",
        "outputs": ["acceleration_x"],
        "parameters": {
            "frequency": {"start": 20, "stop": 120, "num": 6},
            "amplitude": "0.5 mm",
            "alpha": [0, 15],
            "beta": 30,
            "friction": 0.3,
            "radius": "0.8 m",
            **parameters,
        },
    }


LONG = {"start": 20, "stop": 120, "num": 200_000}

# Hours of work: whatever is asked of it, it is asked while it runs or waits.
ENDLESS = {
    "kind": "simulate",
    "scene": "rectangle-on-track",
    "outputs": ["conveying_velocity"],
    "parameters": {
        "frequency": 50,
        "amplitude": {"start": "0.1 mm", "stop": "0.7 mm", "num": 500},
        "alpha": {"start": 0, "stop": 20, "num": 200},
        "beta": 25,
        "friction": 0.3,
    },
}


def endless(friction: float) -> dict[str, Any]:
    return {**ENDLESS, "parameters": {**ENDLESS["parameters"], "friction": friction}}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    settings = Settings(
        data_directory=tmp_path_factory.mktemp("data"),
        workers=1,
        max_queue=2,
        max_synchronous_seconds=1.0,
        max_wait_seconds=50,
    )
    with local_client(create_app(settings), raise_server_exceptions=False) as client:
        yield client


@pytest.fixture
def running(client: TestClient) -> Iterator[dict[str, Any]]:
    """Give a job that does not end; dismiss it."""
    job = client.post("/processes/simulate/execution", json=ENDLESS).json()
    yield job
    client.delete(f"/jobs/{job['jobID']}")


@pytest.fixture(scope="module")
def job(client: TestClient) -> dict[str, Any]:
    """Give a job that has been carried out."""
    return waited(client, client.post(PATH, json=study(), headers=ASYNC).json()["jobID"])


def problem(reply: Any, status: int) -> dict[str, Any]:
    assert reply.status_code == status, reply.text
    assert reply.headers["content-type"] == "application/problem+json"
    return reply.json()


def link(document: dict[str, Any], rel: str) -> str:
    (found,) = (link["href"] for link in document["links"] if link["rel"] == rel)
    return found


def waited(client: TestClient, number: str) -> dict[str, Any]:
    return ended(client, f"/jobs/{number}")


class TestPrefer:
    def test_a_short_study_is_answered_at_once(self, client):
        reply = client.post(PATH, json=study())
        assert reply.status_code == 200
        assert reply.json()["complete"] is True
        assert reply.json()["warnings"] == []
        asked = client.post(PATH, json=study(beta=0.35)).json()["warnings"]
        assert [line.partition(" means")[0] for line in asked] == ["beta = 0.35"]
        assert "location" not in reply.headers
        assert "preference-applied" not in reply.headers

    def test_respond_async_is_a_job(self, client):
        reply = client.post(PATH, json=study(), headers=ASYNC)
        assert reply.status_code == 201
        job = reply.json()
        assert job["status"] in ("accepted", "running", "successful")
        assert reply.headers["location"] == link(job, "self")
        assert client.get(reply.headers["location"]).json()["jobID"] == job["jobID"]
        assert reply.headers["preference-applied"] == "respond-async"

    def test_wait_gives_the_results(self, client):
        reply = client.post(PATH, json=study(beta=31), headers=WAIT)
        assert reply.status_code == 200, reply.text
        assert reply.headers["preference-applied"] == "respond-async, wait=50"
        job = client.get(reply.headers["location"]).json()
        assert job["status"] == "successful"
        assert reply.json() == client.get(link(job, f"{OGC}results")).json()

    def test_a_short_study_needs_no_wait(self, client):
        reply = client.post(PATH, json=study(), headers={"Prefer": "wait=5"})
        assert reply.json()["complete"] is True

    def test_a_wait_that_is_too_short_gives_the_job(self, client):
        prefer = {"Prefer": "wait=1"}
        reply = client.post("/processes/simulate/execution", json=endless(0.31), headers=prefer)
        assert reply.status_code == 201
        assert reply.headers["preference-applied"] == "wait=1"
        assert client.delete(reply.headers["location"]).json()["status"] == "dismissed"

    def test_the_wait_that_is_applied_is_told(self, client, job):
        prefer = {"Prefer": "respond-async, wait=1000000"}
        reply = client.post(PATH, json=study(), headers=prefer)  # its job is over
        assert reply.headers["preference-applied"] == "respond-async, wait=50"

    def test_a_long_study_is_a_job_without_asking(self, client, running):
        assert running["status"] in ("accepted", "running")
        assert running["cells"] == 100_000

    @pytest.mark.parametrize(
        ("prefer", "stays", "state"),
        [
            ({}, 0, "dismissed"),
            (ASYNC, 0, "accepted"),
            ({"Prefer": "wait=60"}, 1, "dismissed"),  # it leaves while it waits
        ],
    )
    def test_a_client_that_leaves_before_it_knows_of_its_job(
        self, client, running, monkeypatch, prefer, stays, state
    ):
        posted, looks = [], []
        admission = client.app.state.admission
        post = admission.post

        async def is_disconnected(request):
            looks.extend(posted)
            return len(looks) > stays

        monkeypatch.setattr(
            admission, "post", lambda *given: posted.append(post(*given)) or posted[0]
        )
        monkeypatch.setattr(Request, "is_disconnected", is_disconnected)
        reply = client.post("/processes/simulate/execution", json=endless(0.32), headers=prefer)
        assert reply.is_success == (state == "accepted")
        monkeypatch.undo()
        address = f"/jobs/{posted[0].id}"
        assert client.get(address).json()["status"] == state
        client.delete(address)

    def test_a_wrong_study_makes_no_job(self, client):
        before = len(client.get("/jobs").json()["jobs"])
        wrong = {**study(), "scene": "nowhere"}
        found = problem(client.post(PATH, json=wrong, headers=ASYNC), 422)
        assert found["errors"][0]["place"] == "scene"
        assert len(client.get("/jobs").json()["jobs"]) == before


class TestResults:
    def test_status(self, job):
        assert job["status"] == "successful"
        assert (job["progress"], job["cells"], job["cellsDone"]) == (100, 12, 12)
        assert job["message"] == "The results are ready."
        assert job["created"] <= job["started"] <= job["finished"] == job["updated"]
        assert "secondsLeft" not in job

    def test_results_and_dataset(self, client, job, tmp_path):
        found = client.get(link(job, f"{OGC}results")).json()["dataset"]
        assert found["type"] == "application/x-netcdf"
        reply = client.get(found["href"])
        assert reply.headers["content-type"] == found["type"]
        assert len(reply.content) == found["length"]
        (tmp_path / "sweep.nc").write_bytes(reply.content)
        read = xarray.load_dataset(tmp_path / "sweep.nc", engine="netcdf4")
        xarray.testing.assert_equal(read, run_study(parse_study(study())))

    def test_the_dataset_as_json(self, client, job):
        href = client.get(link(job, f"{OGC}results")).json()["dataset"]["href"]
        document = client.get(href, params={"format": "json"}).json()
        expected = run_study(parse_study(study()))
        data = document["variables"]["acceleration_x"]["data"]
        np.testing.assert_array_equal(data, expected.acceleration_x)
        problem(client.get(href, params={"format": "xml"}), 422)

    def test_head_tells_the_size_and_a_range_gives_a_part(self, client, job):
        href = client.get(link(job, f"{OGC}results")).json()["dataset"]["href"]
        whole = client.get(href)
        head = client.head(href)
        assert head.headers["content-length"] == str(len(whole.content))
        assert head.content == b""
        part = client.get(href, headers={"Range": "bytes=4-9"})
        assert part.status_code == 206
        assert part.content == whole.content[4:10]
        known = client.get(href, headers={"If-None-Match": whole.headers["etag"]})
        assert known.status_code == 304

    def test_equal_studies_share_a_result(self, client, job):
        other = {"inputs": {"study": {**study(), "parameters": study(beta="30 deg")["parameters"]}}}
        again = client.post(PATH, json=other, headers=ASYNC)
        assert again.status_code == 201
        found = again.json()
        assert found["status"] == "successful"  # at once: the result is there
        assert found["jobID"] != job["jobID"]
        assert found["study"] == job["study"]
        assert found["elapsedSeconds"] == job["elapsedSeconds"]

    def test_the_sweep_of_a_job_can_be_read_in_slices(self, client, job):
        described = client.get(link(job, "related")).json()
        assert described["id"] == job["study"]

    def test_not_ready(self, client, running):
        for end in ("/results", "/results/dataset"):
            found = problem(client.get(f"/jobs/{running['jobID']}{end}"), 404)
            assert found["type"] == f"{EXCEPTIONS}result-not-ready"

    def test_unknown(self, client):
        for end in ("", "/results", "/results/dataset", "/events"):
            found = problem(client.get(f"/jobs/nothing{end}"), 404)
            assert found["type"] == f"{EXCEPTIONS}no-such-job"
        problem(client.delete("/jobs/nothing"), 404)
        found = problem(client.post("/processes/nothing/execution", json=study()), 404)
        assert found["type"] == f"{EXCEPTIONS}no-such-process"
        assert problem(client.get("/processes/nothing"), 404) == {**found, "status": 404}


class TestFailure:
    def test_the_results_of_a_failed_job_are_why(self, tmp_path):
        # No study ends within a nanosecond: it is stopped at the limit after its first block.
        settings = Settings(data_directory=tmp_path, workers=1, max_job_seconds=1e-9)
        with local_client(create_app(settings)) as client:
            job = client.post("/processes/simulate/execution", json=ENDLESS).json()
            job = waited(client, job["jobID"])
            assert job["status"] == "failed"
            assert "takes longer than this service allows" in job["message"]
            assert 0 <= job["progress"] < 100
            assert f"{OGC}results" not in {link["rel"] for link in job["links"]}
            for end in ("/results", "/results/dataset"):
                found = problem(client.get(f"/jobs/{job['jobID']}{end}"), 422)
                assert found["type"] == "urn:vibrafeed:problem:limit"
                assert found["detail"] in job["message"]

    def test_a_full_disk_is_told_before_any_work(self, tmp_path):
        settings = Settings(data_directory=tmp_path, workers=1, disk_quota_bytes=100)
        with local_client(create_app(settings)) as client:
            found = problem(client.post(PATH, json=study(), headers=ASYNC), 507)
            assert found["type"] == "urn:vibrafeed:problem:storage"
            assert client.get("/jobs").json()["jobs"] == []
            assert problem(client.post("/sweeps", json=study()), 507)["type"] == found["type"]

    def test_a_file_of_a_sweep_asks_for_room_too(self, tmp_path):
        settings = Settings(data_directory=tmp_path, disk_quota_bytes=1000)
        with local_client(create_app(settings)) as client:
            many = study(frequency={"start": 20, "stop": 120, "num": 600})
            posted = client.post("/sweeps", json=many).json()
            found = problem(client.get(f"/sweeps/{posted['id']}/netcdf"), 507)
            assert "quota" in found["detail"]
            assert client.get(f"/sweeps/{posted['id']}").status_code == 200

    def test_a_file_that_takes_long_is_sent_to_the_jobs(self, tmp_path):
        settings = Settings(data_directory=tmp_path, max_execution_seconds=0.01)
        with local_client(create_app(settings)) as client:
            long = study(frequency=LONG, beta=list(range(10, 20)))
            posted = client.post("/sweeps", json=long).json()
            found = problem(client.get(f"/sweeps/{posted['id']}/netcdf"), 422)
            assert found["type"] == "urn:vibrafeed:problem:limit"
            assert "/processes/sweep/execution" in found["detail"]

    def test_a_report_of_a_grid_beyond_all_limits_is_refused(self, tmp_path):
        settings = Settings(data_directory=tmp_path, max_sweep_cells=10)
        with local_client(create_app(settings)) as client:
            reply = client.post("/processes/accuracy/execution", json=study())
            assert "12 cells" in problem(reply, 422)["detail"]


class TestQueue:
    def test_a_full_queue_is_answered_by_429(self, client, running):
        execution = "/processes/simulate/execution"
        second = client.post(execution, json=endless(0.32))
        assert second.status_code == 201
        third = client.post(execution, json=endless(0.33))
        assert problem(third, 429)["type"] == "urn:vibrafeed:problem:queue"
        assert third.headers["retry-after"] == "5"
        # Work that is in the queue already takes no place, nor does a result that is there.
        same = client.post(execution, json=ENDLESS)
        assert same.status_code == 201
        for job in (second, same):
            client.delete(job.headers["location"])
        fourth = client.post(execution, json=endless(0.34))
        assert fourth.status_code == 201
        client.delete(fourth.headers["location"])

    def test_dismissal(self, client):
        job = client.post("/processes/simulate/execution", json=ENDLESS).json()
        for _ in range(2):  # a job that is dismissed stays so
            reply = client.delete(f"/jobs/{job['jobID']}")
            assert reply.status_code == 200
            assert reply.json()["status"] == "dismissed"
            assert reply.json()["finished"]
        found = problem(client.get(f"/jobs/{job['jobID']}/results"), 404)
        assert found["type"] == "urn:vibrafeed:problem:not-found"

    def test_one_of_two_equal_jobs_is_dismissed(self, client, running):
        other = client.post("/processes/simulate/execution", json=ENDLESS).json()
        assert other["study"] == running["study"]
        client.delete(f"/jobs/{other['jobID']}")
        assert client.get(f"/jobs/{running['jobID']}").json()["status"] in ("accepted", "running")


class TestEvents:
    def test_they_end_with_the_job(self, client, monkeypatch):
        # However long the workers take to start, no sign of life stands among the events.
        monkeypatch.setattr("vibrafeed.app.web.routes.jobs.SIGN_OF_LIFE", float("inf"))
        job = client.post(PATH, json=study(beta=33), headers=ASYNC).json()
        reply = client.get(link(job, "monitor"))
        assert reply.headers["content-type"].startswith("text/event-stream")
        events = [block.split("\n") for block in reply.text.strip().split("\n\n")]
        assert {lines[0] for lines in events} == {"event: status"}
        told = [json.loads(lines[1].removeprefix("data: ")) for lines in events]
        assert told[-1]["status"] == "successful"
        assert told[-1] == client.get(link(job, "self")).json()
        assert [one["progress"] for one in told] == sorted(one["progress"] for one in told)
        assert {one["jobID"] for one in told} == {job["jobID"]}

    def test_dismissal_ends_them(self, client):
        job = client.post("/processes/simulate/execution", json=ENDLESS).json()
        client.delete(f"/jobs/{job['jobID']}")
        reply = client.get(link(job, "monitor"))
        assert '"status":"dismissed"' in reply.text


class TestList:
    def test_what_stands_twice_is_told_instead_of_half_heeded(self, client, job):
        found = problem(client.get("/jobs?limit=1&minDuration=2&limit=3&minDuration=4"), 422)
        assert [item["place"] for item in found["errors"]] == ["query.limit", "query.minDuration"]
        assert "more than once" in found["errors"][0]["message"]
        slice_ = f"/sweeps/{job['study']}/slice?output=acceleration_x&axes=alpha&frequency=20"
        assert client.get(slice_).status_code == 200
        found = problem(client.get(f"{slice_}&frequency=40"), 422)
        assert [item["place"] for item in found["errors"]] == ["query.frequency"]
        # These choose one of several.
        assert client.get("/jobs?status=failed&status=dismissed&type=a&type=b").status_code == 200

    def test_filters_and_pages(self, client, running):
        posted = [client.post(PATH, json=study(), headers=WAIT).headers["location"] for _ in "123"]
        listed = client.get("/jobs", params={"processID": "sweep", "status": "successful"}).json()
        assert {job["processID"] for job in listed["jobs"]} == {"sweep"}
        assert {job["status"] for job in listed["jobs"]} == {"successful"}
        newest = [link(job, "self") for job in listed["jobs"][:3]]
        assert newest == posted[::-1]  # the latest first
        page = client.get("/jobs", params={"processID": "sweep", "limit": 2}).json()
        assert [link(job, "self") for job in page["jobs"]] == newest[:2]
        after = client.get(link(page, "next")).json()
        assert link(after["jobs"][0], "self") == newest[2]
        assert {job["processID"] for job in after["jobs"]} == {"sweep"}
        assert client.get(link(page, "self")).json() == page
        assert client.get("/jobs", params={"processID": "nothing"}).json()["jobs"] == []

    def test_the_last_page_has_no_next(self, client):
        links = client.get("/jobs", params={"limit": 1000}).json()["links"]
        assert [link["rel"] for link in links] == ["self"]

    def test_times_durations_and_several_values(self, client, job, running):
        def listed(**query: Any) -> set[str]:
            page = client.get("/jobs", params={"limit": 1000, **query}).json()
            return {one["jobID"] for one in page["jobs"]}

        both = {job["jobID"], running["jobID"]}
        assert both <= listed()
        assert both <= listed(status=["successful", "running", "accepted"])
        assert both <= listed(processID=["sweep", "simulate"], type="process")
        assert listed(type="thing") == set()
        at = job["created"]
        assert job["jobID"] in listed(datetime=at)
        assert running["jobID"] not in listed(datetime=at)
        assert both <= listed(datetime=f"{at}/..")
        assert both & listed(datetime=f"/{at}") == {job["jobID"]}
        assert both & listed(datetime=f"{at}/{running['created']}") == both
        assert job["jobID"] not in listed(minDuration=1000)
        assert job["jobID"] in listed(maxDuration=1000)
        waiting = [one for one in listed() if one not in listed(minDuration=0)]
        for number in waiting:  # what has not begun has no duration
            status = client.get(f"/jobs/{number}").json()
            assert "started" not in status or status["status"] != "accepted"

    @pytest.mark.parametrize(
        "query",
        ["limit=0", "limit=1001", "after=1", "after=nan,x", "status=lost", "minDuration=-1",
         "datetime=today", "datetime=2026-01-01T00:00:00", "datetime=../..", "datetime=1/2/3",
         "datetime="],
    )  # fmt: skip
    def test_bad_queries(self, client, query):
        problem(client.get(f"/jobs?{query}"), 422)

    def test_the_old_way_to_page_names_the_new(self, client):
        assert "next" in problem(client.get("/jobs?offset=100"), 422)["errors"][0]["message"]

    def test_an_owner_reads_one_list_at_a_time(self, client, monkeypatch):
        # The lists of many jobs leave threads to others.
        under_way, most = [], []
        listed = Ledger.jobs

        def slow(*arguments: Any, **named: Any) -> Any:
            under_way.append(None)
            most.append(len(under_way))
            time.sleep(0.02)
            under_way.pop()
            return listed(*arguments, **named)

        monkeypatch.setattr(Ledger, "jobs", slow)
        with ThreadPoolExecutor(4) as threads:
            replies = [*threads.map(client.get, ["/jobs"] * 8)]
        assert [reply.status_code for reply in replies] == [200] * 8
        assert max(most) == 1
