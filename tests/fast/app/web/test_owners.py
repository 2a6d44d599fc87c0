"""Keys with roles and limits over HTTP, what belongs to whom, and wrong keys."""

import json
import logging
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace
from typing import Any

import pytest
from fastapi.testclient import TestClient

from local_client import client_of
from posted_sweeps import problem
from vibrafeed.app.jobs import audit
from vibrafeed.app.jobs.keys import Key
from vibrafeed.app.web.entry import INVALID
from waiting import PATIENCE, wait_for

EXECUTION = "/processes/sweep/execution"
SLICE = "/slice?output=acceleration_x&axes=beta"
ASYNC = {"Prefer": "respond-async"}
UNKNOWN = "0" * 64


def study(number: int, values: int = 20) -> dict[str, Any]:
    """Return one of many studies of the same size."""
    return {
        "kind": "sweep",
        "scene": "rectangle-on-track",
        "outputs": ["acceleration_x"],
        "parameters": {
            "frequency": 50 + number / 1000,
            "amplitude": "0.5 mm",
            "alpha": 10,
            "beta": {"start": 0, "stop": 60, "num": values},
            "friction": 0.3,
            "radius": "0.8 m",
        },
    }


class House:
    """A service in this process, and clients with keys of its ledger."""

    def __init__(self, client: TestClient):
        self.client = client
        self.keys = client.app.state.keys
        self.admission = client.app.state.admission

    def key(self, name: str, role: str = "run", days: float | None = None, **limits: int) -> Any:
        """Return what asks with a new key."""
        made, _ = self.keys.add(Key(name, role, **limits), days)
        self.read_keys()
        return self.asking(made)

    def asking(self, key: str) -> Any:
        headers = {"Authorization": f"Bearer {key}"}

        def ask(method: str, path: str, **options: Any) -> Any:
            given = {**headers, **options.pop("headers", {})}
            return self.client.request(method, path, headers=given, **options)

        return ask

    def read_keys(self) -> None:
        """Have keys read again, as they are a second later."""
        self.keys._read_at = -100.0

    def sweep(self, ask: Any, number: int = 1) -> str:
        """Return the identifier of a sweep that was posted."""
        return ask("POST", "/sweeps", json=study(number)).json()["id"]

    def job(self, ask: Any, number: int = 1) -> Any:
        """Return a job that was posted."""
        reply = ask("POST", EXECUTION, json=study(number), headers=ASYNC)
        assert reply.status_code == 201, reply.text
        return reply.json()

    def carried_out(self, ask: Any, number: int) -> str:
        """Return a job that has ended well."""
        job = self.job(ask, number)["jobID"]
        wait_for(lambda: ask("GET", f"/jobs/{job}").json()["status"] == "successful")
        return job


@pytest.fixture
def house(tmp_path) -> Iterator[House]:
    """Give a service that has not been started: its jobs wait."""
    client = client_of(tmp_path)
    yield House(client)
    client.app.state.admission.ledger.close()


@pytest.fixture
def no_time_passes(monkeypatch) -> None:
    """Stop the clock of the limits: requests come as fast as they are counted to do."""
    monkeypatch.setattr("limits.storage.memory.time", SimpleNamespace(time=lambda: 1e9))


@pytest.fixture(scope="module")
def running(tmp_path_factory) -> Iterator[House]:
    """Give one that works."""
    with client_of(tmp_path_factory.mktemp("data"), workers=1) as client:
        yield House(client)


class TestRoles:
    def test_read_reads_and_the_figures_of_all_are_an_admins(self, house):
        ask = house.key("reader", "read")
        assert ask("GET", "/scenes").status_code == 200
        assert ask("HEAD", "/").status_code == 200
        for method, path in (("POST", "/sweeps"), ("DELETE", "/jobs/x"), ("PATCH", "/sweeps/x")):
            problem(ask(method, path), 403, "problem:role")
        for path in ("/metrics%0A", "/jobs/%00", "/sweeps/a%00/slice", "/jobs%7F"):
            problem(ask("GET", path), 404)
        problem(house.key("lab")("GET", "/metrics"), 403)
        assert house.key("boss", "admin")("GET", "/metrics").status_code == 200

    def test_many_keys_in_one_request_are_refused_unread(self, house):
        house.key("lab")
        many = [("X-API-Key", f"vf_{n}") for n in range(5000)]
        reply = house.client.get("/scenes", headers=many)
        assert "Send one" in problem(reply, 401)["detail"]

    def test_a_key_that_is_over_or_withdrawn_is_as_an_unknown_one(self, house, caplog):
        caplog.set_level(logging.INFO, "vibrafeed.requests")
        over, gone = house.key("over", days=1e-9), house.key("gone")
        assert gone("GET", "/scenes").status_code == 200
        assert caplog.records[-1].key == "gone"
        house.keys.withdraw("gone")
        house.read_keys()
        unknown = house.asking("vf_unknown")("GET", "/scenes")
        for ask in (over, gone):
            assert problem(ask("GET", "/scenes"), 401) == unknown.json()

    @pytest.mark.usefixtures("no_time_passes")
    def test_many_wrong_ones_of_an_address_are_refused_and_right_ones_are_not(self, house):
        right = house.key("lab")
        for number in range(INVALID.amount):
            problem(house.asking(f"vf_{number}")("GET", "/scenes"), 401)
        reply = house.asking("vf_wrong")("GET", "/scenes")
        problem(reply, 429, "problem:wrong-keys")
        assert reply.headers["retry-after"] == "60"
        assert right("GET", "/scenes").status_code == 200

    def test_a_ledger_that_cannot_be_read_lets_nobody_in(self, house, monkeypatch):
        def fails() -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(house.keys, "all", fails)
        assert house.client.get("/healthz").status_code == 200
        problem(house.client.get("/scenes"), 503)

    def test_a_stream_ends_with_its_key(self, house):
        lab = house.key("lab")
        job = house.job(lab)["jobID"]
        read, looks = house.keys.of_hash, []
        house.keys.of_hash = lambda hash_: looks.append(hash_) or read(hash_)
        with ThreadPoolExecutor(1) as threads:
            stream = threads.submit(lab, "GET", f"/jobs/{job}/events")
            wait_for(lambda: len(looks) > 2)
            assert not stream.done()
            house.keys.withdraw("lab")
            assert stream.result(PATIENCE).status_code == 200


class TestLimits:
    def test_one_key_has_its_share_of_what_is_under_way(self, tmp_path):
        house = House(client_of(tmp_path, max_requests=8))
        job = house.job(house.key("lab"))["jobID"]
        with ThreadPoolExecutor(8) as threads:
            lab = house.key("crowd", "admin")
            streams = [threads.submit(lab, "GET", f"/jobs/{job}/events") for _ in range(6)]
            wait_for(lambda: sum(stream.done() for stream in streams) >= 4)
            refused = [stream.result() for stream in streams if stream.done()]
            assert house.key("other")("GET", "/scenes").status_code == 200
            house.client.app.state.stopping.set()
        for reply in refused:
            problem(reply, 429, "problem:rate")
        house.admission.ledger.close()

    @pytest.mark.usefixtures("no_time_passes")
    def test_requests_a_second(self, house):
        ask, other = house.key("lab", requests=3), house.key("other")
        for _ in range(3):
            assert ask("GET", "/conformance").status_code == 200
        refused = ask("GET", "/conformance")
        problem(refused, 429, "problem:rate")
        assert refused.headers["retry-after"] == "1"
        assert other("GET", "/conformance").status_code == 200

    def test_cells_of_a_study(self, house):
        ask = house.key("lab", cells=10)
        for path in ("/sweeps", EXECUTION):
            document = problem(ask("POST", path, json=study(1)), 422, "problem:limit")
            assert "the limit is 10" in document["detail"]
        assert ask("POST", "/sweeps", json=study(1, 10)).status_code == 201

    def test_jobs_at_a_time(self, house):
        ask, other = house.key("lab", jobs=1), house.key("other", jobs=1)
        job = house.job(ask)["jobID"]
        refused = ask("POST", EXECUTION, json=study(2), headers=ASYNC)
        problem(refused, 429, "problem:jobs")
        assert "retry-after" in refused.headers
        house.job(other, 2)
        ask("DELETE", f"/jobs/{job}")
        house.job(ask, 2)

    def test_bytes_make_room_among_their_own_only(self, house):
        size = len(json.dumps(study(1)))
        ask, other = house.key("lab", bytes=3 * size), house.key("other")
        first, shared = (house.sweep(ask, number) for number in range(2))
        theirs = [house.sweep(other, number) for number in (1, 50)]
        more = [house.sweep(ask, number) for number in range(2, 9)]
        problem(ask("GET", f"/sweeps/{first}"), 404)
        problem(ask("GET", f"/sweeps/{shared}"), 404)
        for key in theirs:
            assert other("GET", f"/sweeps/{key}").status_code == 200
        held = [one for key in more if (one := house.admission.ownership.of("lab", key))]
        assert sum(one.bytes for one in held) <= 3 * size
        assert house.admission.store.last_use(first) == 0
        refused = ask("POST", EXECUTION, json=study(60, 2000), headers=ASYNC)
        assert "your key may store" in problem(refused, 507)["detail"]
        assert ask("GET", f"/sweeps/{more[-1]}").status_code == 200, "removed for nothing"


class TestOwners:
    def test_what_others_have_is_as_if_not_there(self, house):
        one, two = house.key("one"), house.key("two")
        key = house.sweep(one)
        number = house.job(one)["jobID"]
        assert one("GET", f"/jobs/{number}").json()["owner"] == "one"
        for end in ("", SLICE, "/slice", "/netcdf", "/zarr/zarr.json"):
            told = two("GET", f"/sweeps/{key}{end}")
            none = two("GET", f"/sweeps/{UNKNOWN}{end}")
            assert problem(told, 404)["detail"] == none.json()["detail"].replace(UNKNOWN, key)
        for end in ("", "/results", "/results/dataset", "/events"):
            problem(two("GET", f"/jobs/{number}{end}"), 404)
        problem(two("DELETE", f"/jobs/{number}"), 404)
        problem(two("PATCH", f"/jobs/{number}", json={"shared": True}), 404)
        problem(two("PATCH", f"/sweeps/{key}", json={"shared": True}), 404)
        assert two("GET", "/jobs").json()["jobs"] == []
        # Posted by the other too, it is new to them, and theirs.
        assert two("POST", "/sweeps", json=study(1)).status_code == 201
        assert two("POST", "/sweeps", json=study(1)).status_code == 200
        assert two("GET", f"/sweeps/{key}").status_code == 200

    def test_an_admin_sees_all(self, house):
        one, boss = house.key("one"), house.key("boss", "admin")
        key = house.sweep(one)
        number = house.job(one)["jobID"]
        assert boss("GET", f"/sweeps/{key}").status_code == 200
        assert [job["jobID"] for job in boss("GET", "/jobs").json()["jobs"]] == [number]
        assert boss("PATCH", f"/sweeps/{key}", json={"shared": True}).json()["shared"] is True
        assert boss("DELETE", f"/jobs/{number}").json()["status"] == "dismissed"

    def test_what_is_shared_can_be_read_by_all_and_changed_by_none(self, house):
        one, two, reader = house.key("one"), house.key("two"), house.key("reader", "read")
        key = house.sweep(one)
        number = house.job(one)["jobID"]
        for path in (f"/sweeps/{key}", f"/jobs/{number}"):
            assert one("PATCH", path, json={"shared": True}).json()["shared"] is True
            for ask in (two, reader):
                assert ask("GET", path).json()["shared"] is True
            problem(two("PATCH", path, json={"shared": False}), 403, "problem:owner")
        problem(two("DELETE", f"/jobs/{number}"), 403)
        assert [job["jobID"] for job in two("GET", "/jobs").json()["jobs"]] == [number]
        for path in (f"/sweeps/{key}", f"/jobs/{number}"):
            one("PATCH", path, json={"shared": False})
            problem(two("GET", path), 404)
        assert two("GET", "/jobs").json()["jobs"] == []

    def test_a_body_that_says_nothing_of_sharing(self, house):
        one = house.key("one")
        path = f"/sweeps/{house.sweep(one)}"
        for body, count in (
            (b"[]", 1), (b"{}", 1), (b'{"shared": 1, "x": 2, "y": 3}', 3), (b"{", 1), (b"NaN", 1),
        ):  # fmt: skip
            assert len(problem(one("PATCH", path, content=body), 422)["errors"]) == count

    def test_the_audit_says_who_did_what(self, house):
        one = house.key("one")
        number = house.job(one)["jobID"]
        one("PATCH", f"/jobs/{number}", json={"shared": True})
        one("DELETE", f"/jobs/{number}")
        house.asking("vf_wrong")("GET", "/scenes")
        entries = reversed(audit.latest(house.admission.ledger.database, 9))
        assert [(entry.name, entry.action, entry.object) for entry in entries] == [
            ("", "add key", "one"),
            ("one", "post", number),
            ("one", "share", number),
            ("one", "dismiss", number),
            ("", "refuse key", "testclient"),
        ]

    def test_making_room_takes_nothing_that_others_hold(self, tmp_path):
        size = len(json.dumps(study(1)))
        house = House(client_of(tmp_path, disk_quota_bytes=12 * size))
        one, two = house.key("one"), house.key("two")
        keys = [house.sweep(one, number) for number in range(3)]
        mine, *_ = [house.sweep(two, number) for number in range(10, 25)]
        assert house.admission.store.last_use(mine) == 0, "nothing had to make room"
        for key in keys:
            assert one("GET", f"/sweeps/{key}").status_code == 200
        house.admission.ledger.close()


class TestResults:
    def test_a_result_of_another_is_found_when_the_job_runs(self, running):
        one, two = running.key("first"), running.key("second")
        number = running.carried_out(one, 1)
        assert running.job(one)["status"] == "successful"
        again = running.job(two)
        assert (again["status"], again["elapsedSeconds"]) == ("accepted", 0)
        other = running.carried_out(two, 1)
        first, second = (
            ask("GET", f"/jobs/{job}/results/dataset").content
            for ask, job in ((one, number), (two, other))
        )
        assert first == second
        entries = [path.name for path in running.admission.store.folder(again["study"]).iterdir()]
        assert entries.count("result.nc") == 1

    def test_head_tells_nothing_of_a_file_that_another_has_made(self, running):
        one, two = running.key("third"), running.key("fourth")
        key = running.sweep(one, 2)
        assert one("GET", f"/sweeps/{key}/netcdf").status_code == 200
        assert "etag" in one("HEAD", f"/sweeps/{key}/netcdf").headers
        two("POST", "/sweeps", json=study(2))
        assert "etag" not in two("HEAD", f"/sweeps/{key}/netcdf").headers
        assert two("GET", f"/sweeps/{key}/netcdf").status_code == 200
        assert "etag" in two("HEAD", f"/sweeps/{key}/netcdf").headers

    def test_a_job_says_that_its_result_has_made_room(self, running):
        one = running.key("fifth", bytes=40_000)
        number = running.carried_out(one, 100)
        key = one("GET", f"/jobs/{number}").json()["study"]
        for other in range(101, 112):
            if running.admission.ownership.of("fifth", key) is None:
                break
            running.carried_out(one, other)
        job = one("GET", f"/jobs/{number}").json()
        assert "Post the study again" in job["message"]
        assert not [link for link in job["links"] if link["rel"].endswith("results")]
        for end in ("/results", "/results/dataset"):
            problem(one("GET", f"/jobs/{number}{end}"), 410, "problem:gone")
        running.job(one, 100)
