"""Processes and jobs over HTTP: status codes, headers, documents."""

import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import xarray
from fastapi import Request
from fastapi.testclient import TestClient

from local_client import client_of, ended
from posted_sweeps import problem
from vibrafeed.app.jobs.ledger import Job
from vibrafeed.app.web.documents import status_info
from vibrafeed.app.web.prefer import Preferences, preferences
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study

OGC = "http://www.opengis.net/def/rel/ogc/1.0/"
PATH = "/processes/sweep/execution"
MOTION = "/processes/simulate/execution"
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


def endless(friction: float) -> dict[str, Any]:
    """Return hours of work: whatever is asked of it, it is asked while it runs or waits."""
    return {
        "kind": "simulate",
        "scene": "rectangle-on-track",
        "outputs": ["conveying_velocity"],
        "parameters": {
            "frequency": 50,
            "amplitude": {"start": "0.1 mm", "stop": "0.7 mm", "num": 500},
            "alpha": {"start": 0, "stop": 20, "num": 200},
            "beta": 25,
            "friction": friction,
        },
    }


def reduced(num: int, over: tuple[str, ...] = ("amplitude", "beta")) -> dict[str, Any]:
    axes = {
        "frequency": [40, 50, 60],
        "amplitude": {"start": "0.1 mm", "stop": "1 mm", "num": num},
        "beta": {"start": 0, "stop": 45, "num": 46},
    }
    statistics = {"statistics": ["max", "argmax", "mean"], "quantiles": [0.5]}
    return {
        "kind": "sweep",
        "scene": "rectangle-on-plane",
        "outputs": ["acceleration_x"],
        "parameters": {**axes, "friction": 0.3},
        "reduce": {"over": list(over), **statistics},
    }


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    with client_of(
        tmp_path_factory.mktemp("data"), workers=1, max_queue=2, max_cells=200_000,
        max_synchronous_seconds=1.0, max_wait_seconds=50, block_seconds=0.1, grace_seconds=0.1,
    ) as client:  # fmt: skip
        yield client


@pytest.fixture
def running(client: TestClient) -> Iterator[dict[str, Any]]:
    """Give a job that does not end; dismiss it."""
    job = client.post(MOTION, json=endless(0.3)).json()
    yield job
    client.delete(f"/jobs/{job['jobID']}")


@pytest.fixture(scope="module")
def job(client: TestClient) -> dict[str, Any]:
    """Give a job that has been carried out."""
    number = client.post(PATH, json=study(), headers=ASYNC).json()["jobID"]
    return ended(client, f"/jobs/{number}")


def link(document: dict[str, Any], rel: str) -> str:
    (found,) = (link["href"] for link in document["links"] if link["rel"] == rel)
    return found


def dataset_of(client: TestClient, job: dict[str, Any]) -> str:
    """Return where the file of a job is."""
    return client.get(link(job, f"{OGC}results")).json()["dataset"]["href"]


FILLER = "foo, " * 398  # 1,990 characters


@pytest.mark.parametrize(
    ("headers", "expected"),
    [
        ([], Preferences()),
        ([""], Preferences()),
        (["respond-async"], Preferences(True)),
        (["Respond-Async"], Preferences(True)),  # names are case-insensitive
        (["wait=100"], Preferences(wait=100)),
        (["WAIT = 10"], Preferences(wait=10)),  # white space around the sign
        (['wait="10"'], Preferences(wait=10)),  # a quoted word means the same
        (["respond-async, wait=100"], Preferences(True, 100)),  # section 4.3
        (["respond-async", "wait=100"], Preferences(True, 100)),  # two fields are one list
        (["wait=1, wait=2"], Preferences(wait=1)),  # of one given twice the first counts
        (["wait=1", "wait=2"], Preferences(wait=1)),
        (
            ["priority=5, respond-async; foo=bar; baz"],
            Preferences(True),
        ),  # unknown ones, and parameters
        (['foo="a, wait=3", respond-async'], Preferences(True)),  # a comma in quotes parts nothing
        (['foo="\\", wait=3", respond-async'], Preferences(True)),
        (["respond-async=yes"], Preferences(True)),
        (["wait"], Preferences()),
        (["wait=-1"], Preferences()),
        (["wait=1.5"], Preferences()),
        (["wait=ten"], Preferences()),
        (["wait=1234567890"], Preferences()),  # longer than any wait
        (["wait=٣"], Preferences()),  # a digit, but not of ASCII
        (
            ["=;,,;=, respond-async"],
            Preferences(True),
        ),  # what is malformed does not count, the rest does
        (["respond-sync"], Preferences()),
        (["xrespond-async"], Preferences()),
        ([FILLER + "wait=12345"], Preferences(wait=12345)),  # ends at the limit
        ([FILLER + "wait=123456"], Preferences()),  # not 12345
        (["respond-async, " + FILLER + "wait=1"], Preferences(True)),
    ],
)
def test_preferences(headers, expected):
    assert preferences(headers) == expected


HOSTILE = {
    "spaces between no parameters": ("a", "; ", "@"),
    "spaces before a sign": ("a", " ", "@"),
    "parameters": ("a", ";a=a ", "@"),
    "no names": ("", ",;", ""),
    "escapes": ('a="', "\\", ""),
    "quotes that open in every element": ("", 'a=",', ""),
    "elements in quotes": ('x="', ',a;b=";b="', "@"),
    "quotes that never end": ("", ",a", ';b="'),
    "signs": ("a", "=", ""),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_header_takes_no_time(name):
    """Reading is linear; backtracking would double with each repetition, and never end."""
    before, repeated, after = HOSTILE[name]
    for count in (24, 8_000, 65_536):
        assert preferences([before + repeated * count + after]) == Preferences()


class TestPrefer:
    def test_a_short_study_is_answered_at_once(self, client):
        reply = client.post(PATH, json=study())
        assert reply.status_code == 200
        assert reply.json()["complete"] is True
        assert reply.json()["warnings"] == []
        assert not {"location", "preference-applied"} & set(reply.headers)
        asked = client.post(PATH, json=study(beta=0.35), headers={"Prefer": "wait=5"})
        warnings = asked.json()["warnings"]
        assert [line.partition(" means")[0] for line in warnings] == ["beta = 0.35"]

    def test_respond_async_is_a_job_and_wait_gives_its_results(self, client):
        reply = client.post(PATH, json=study(beta=31), headers=ASYNC)
        assert reply.status_code == 201
        assert reply.headers["location"] == link(reply.json(), "self")
        assert reply.headers["preference-applied"] == "respond-async"
        prefer = {"Prefer": "respond-async, wait=1000000"}
        reply = client.post(PATH, json=study(beta=31), headers=prefer)
        assert reply.status_code == 200, reply.text
        assert reply.headers["preference-applied"] == "respond-async, wait=50"
        job = client.get(reply.headers["location"]).json()
        assert job["status"] == "successful"
        assert reply.json() == client.get(link(job, f"{OGC}results")).json()

    def test_a_wait_that_is_too_short_gives_the_job(self, client):
        reply = client.post(MOTION, json=endless(0.31), headers={"Prefer": "wait=0"})
        assert (reply.status_code, reply.headers["preference-applied"]) == (201, "wait=0")
        assert client.delete(reply.headers["location"]).json()["status"] == "dismissed"

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
        reply = client.post(MOTION, json=endless(0.32), headers=prefer)
        assert reply.is_success == (state == "accepted")
        monkeypatch.undo()
        address = f"/jobs/{posted[0].id}"
        is_dismissed = client.get(address).json()["status"] == "dismissed"
        assert is_dismissed == (state == "dismissed")
        client.delete(address)

    def test_a_wrong_study_makes_no_job(self, client):
        before = len(client.get("/jobs").json()["jobs"])
        wrong = {**study(), "scene": "nowhere"}
        found = problem(client.post(PATH, json=wrong, headers=ASYNC), 422)
        assert found["errors"][0]["place"] == "scene"
        assert len(client.get("/jobs").json()["jobs"]) == before


class TestResults:
    def test_status_dataset_and_json(self, client, job, tmp_path):
        assert job["status"] == "successful"
        assert (job["progress"], job["cells"], job["cellsDone"]) == (100, 12, 12)
        assert job["message"] == "The results are ready."
        assert job["created"] <= job["started"] <= job["finished"] == job["updated"]
        assert "secondsLeft" not in job
        found = client.get(link(job, f"{OGC}results")).json()["dataset"]
        reply = client.get(found["href"])
        assert reply.headers["content-type"] == found["type"] == "application/x-netcdf"
        assert len(reply.content) == found["length"]
        (tmp_path / "sweep.nc").write_bytes(reply.content)
        read = xarray.load_dataset(tmp_path / "sweep.nc", engine="netcdf4")
        expected = run_study(parse_study(study()))
        xarray.testing.assert_equal(read, expected)
        document = client.get(found["href"], params={"format": "json"}).json()
        data = document["variables"]["acceleration_x"]["data"]
        np.testing.assert_array_equal(data, expected.acceleration_x)
        problem(client.get(found["href"], params={"format": "xml"}), 422)
        part = client.get(found["href"], headers={"Range": "bytes=4-9"})
        assert (part.status_code, part.content) == (206, reply.content[4:10])
        assert client.get(link(job, "related")).json()["id"] == job["study"]

    def test_equal_studies_share_a_result(self, client, job):
        other = {"inputs": {"study": {**study(), "parameters": study(beta="30 deg")["parameters"]}}}
        again = client.post(PATH, json=other, headers=ASYNC)
        assert again.status_code == 201
        found = again.json()
        assert found["status"] == "successful"  # at once: the result is there
        assert found["jobID"] != job["jobID"]
        for name in ("study", "elapsedSeconds"):
            assert found[name] == job[name]

    def test_not_ready_and_unknown(self, client, running):
        assert running["cells"] == 100_000
        for end in ("/results", "/results/dataset"):
            problem(client.get(f"/jobs/{running['jobID']}{end}"), 404, "/result-not-ready")
        for end in ("", "/results", "/results/dataset", "/events"):
            problem(client.get(f"/jobs/nothing{end}"), 404, "/no-such-job")
        problem(client.delete("/jobs/nothing"), 404, "/no-such-job")
        problem(client.post("/processes/nothing/execution", json=study()), 404, "/no-such-process")
        problem(client.get("/processes/nothing"), 404, "/no-such-process")


class TestFailure:
    def test_the_results_of_a_failed_job_are_why(self, tmp_path):
        # No study ends within a nanosecond: it is stopped at the limit after its first block.
        with client_of(tmp_path, workers=1, max_job_seconds=1e-9, block_seconds=0.1) as client:
            job = client.post(MOTION, json=endless(0.3), headers=ASYNC).json()
            job = ended(client, f"/jobs/{job['jobID']}")
            assert job["status"] == "failed"
            assert "takes longer than this service allows" in job["message"]
            assert 0 <= job["progress"] < 100
            assert f"{OGC}results" not in {link["rel"] for link in job["links"]}
            for end in ("/results", "/results/dataset"):
                found = problem(client.get(f"/jobs/{job['jobID']}{end}"), 422, "problem:limit")
                assert found["detail"] in job["message"]

    def test_a_full_disk_is_told_before_any_work(self, tmp_path):
        with client_of(tmp_path, workers=1, disk_quota_bytes=1000) as client:
            many = study(frequency={"start": 20, "stop": 120, "num": 600})
            problem(client.post(PATH, json=many, headers=ASYNC), 507, "problem:storage")
            assert client.get("/jobs").json()["jobs"] == []
            posted = client.post("/sweeps", json=many).json()
            found = problem(client.get(f"/sweeps/{posted['id']}/netcdf"), 507)
            assert "quota" in found["detail"]
            assert client.get(f"/sweeps/{posted['id']}").status_code == 200

    def test_what_is_beyond_all_limits_is_refused(self, tmp_path):
        with client_of(tmp_path, max_execution_seconds=0.01, max_sweep_cells=10**7) as client:
            long = study(frequency={"start": 20, "stop": 120, "num": 200_000}, beta=[*range(10)])
            posted = client.post("/sweeps", json=long).json()
            found = problem(client.get(f"/sweeps/{posted['id']}/netcdf"), 422, "problem:limit")
            assert "/processes/sweep/execution" in found["detail"]
            longer = study(frequency={"start": 20, "stop": 120, "num": 10**6}, beta=[*range(10)])
            reply = client.post("/processes/accuracy/execution", json=longer)
            assert "20,000,000 cells" in problem(reply, 422)["detail"]


class TestQueue:
    def test_a_full_queue_is_answered_by_429(self, client, running):
        second = client.post(MOTION, json=endless(0.32))
        assert second.status_code == 201
        third = client.post(MOTION, json=endless(0.33))
        problem(third, 429, "problem:queue")
        assert third.headers["retry-after"] == "5"
        # Work that is in the queue already takes no place, nor does a result that is there.
        same = client.post(MOTION, json=endless(0.3))
        assert same.status_code == 201
        assert same.json()["study"] == running["study"]
        for job in (second, same, same):  # a job that is dismissed stays so
            reply = client.delete(job.headers["location"])
            assert (reply.status_code, reply.json()["status"]) == (200, "dismissed")
            assert reply.json()["finished"]
        problem(client.get(f"{same.headers['location']}/results"), 404, "problem:not-found")
        assert client.get(f"/jobs/{running['jobID']}").json()["status"] in ("accepted", "running")
        fourth = client.post(MOTION, json=endless(0.34))
        assert fourth.status_code == 201
        client.delete(fourth.headers["location"])
        assert '"status":"dismissed"' in client.get(link(fourth.json(), "monitor")).text

    def test_events_end_with_the_job(self, client, monkeypatch):
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


class TestList:
    def test_what_stands_twice_is_told_instead_of_half_heeded(self, client, job):
        found = problem(client.get("/jobs?limit=1&minDuration=2&limit=3&minDuration=4"), 422)
        assert [item["place"] for item in found["errors"]] == ["query.limit", "query.minDuration"]
        assert "more than once" in found["errors"][0]["message"]
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
        last = client.get("/jobs", params={"limit": 1000}).json()["links"]
        assert [link["rel"] for link in last] == ["self"]

    def test_times_durations_and_several_values(self, client, job, running):
        def listed(**query: Any) -> set[str]:
            page = client.get("/jobs", params={"limit": 1000, **query}).json()
            return {one["jobID"] for one in page["jobs"]}

        both, at = {job["jobID"], running["jobID"]}, job["created"]
        for query in (
            {},
            {"status": ["successful", "running", "accepted"]},
            {"processID": ["sweep", "simulate"], "type": "process"},
            {"datetime": f"{at}/.."},
            {"datetime": f"{at}/{running['created']}"},
        ):
            assert both <= listed(**query)
        assert listed(type="thing") == set()
        for query in ({"datetime": at}, {"datetime": f"/{at}"}, {"maxDuration": 1000}):
            assert job["jobID"] in listed(**query)
        assert running["jobID"] not in listed(datetime=at) | listed(datetime=f"/{at}")
        assert job["jobID"] not in listed(minDuration=1000)

    def test_bad_queries(self, client):
        for query in (
            "limit=0", "limit=1001", "after=1", "after=nan,x", "status=lost", "minDuration=-1",
            "datetime=today", "datetime=2026-01-01T00:00:00", "datetime=../..", "datetime=1/2/3",
            "datetime=",
        ):  # fmt: skip
            problem(client.get(f"/jobs?{query}"), 422)
        assert "next" in problem(client.get("/jobs?offset=100"), 422)["errors"][0]["message"]


def test_reductions_at_once_and_of_more_cells_than_may_be_stored(client, tmp_path):
    reply = client.post(PATH, json=reduced(10))
    assert reply.status_code == 200
    found, want = reply.json(), run_study(parse_study(reduced(10)))
    assert (found["cells"], found["complete"]) == (3 * 10 * 46, True)
    for name in want.data_vars:
        assert found["variables"][name]["data"] == want[name].values.tolist()
    assert found["coordinates"]["beta"]["reduced_range"] == [0, 45]
    reply = client.post(PATH, json=reduced(1500), headers=WAIT)
    job = client.get(reply.headers["location"]).json()
    (tmp_path / "result.nc").write_bytes(client.get(dataset_of(client, job)).content)
    want = run_study(parse_study(reduced(1500)))
    with xarray.open_dataset(tmp_path / "result.nc", engine="netcdf4") as found:
        for name in want.data_vars:
            assert found[name].dims == want[name].dims
            assert found[name].values.tobytes() == want[name].values.tobytes()


def test_a_reduction_to_too_much_or_read_as_a_sweep_is_refused(client):
    reply = client.post(PATH, json=reduced(200_000, ("beta",)))
    assert "600,000 cells, the limit is 200,000" in problem(reply, 422)["detail"]
    refused = problem(client.post("/sweeps", json=reduced(10)), 422)
    assert refused["errors"][0]["place"] == "reduce"


def test_a_status_tells_time_left_and_what_is_waited_for(monkeypatch):
    now = 1.8e9
    monkeypatch.setattr("vibrafeed.app.web.documents.time.time", lambda: now)
    running = Job(
        id="a", key="b", process="sweep", state="running", cells=100, blocks=10, done=5,
        created=now - 100, started=now - 90, finished=None, seconds=20.0, problem=None,
        began=now - 50,
    )  # fmt: skip
    assert status_info(running, "")["secondsLeft"] == 50
    again = replace(running, done_then=3)  # in this run, 2 blocks took 50 s
    assert status_info(again, "")["secondsLeft"] == 125
    set_back = replace(running, began=now + 86_400)  # the clock was
    assert "secondsLeft" not in status_info(set_back, "")
    waiting = replace(running, state="accepted", started=None, began=None, done=0)
    for job, waits, message in (
        (waiting, None, "The job waits for its turn."),
        (waiting, "there are no workers", "The job waits: there are no workers."),
        (running, "all workers are busy", "5 of 10 blocks are done."),
    ):
        assert status_info(job, "", waiting_reason=waits)["message"] == message
