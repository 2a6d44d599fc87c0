"""Two keys that share a service: neither sees, changes or evicts what is the other's.

Both make calls in a random order: equal and different studies, reads by identifiers of their own
and of the other, lists, dismissals, events, slices, Zarr, NetCDF, sharing. What each should see is
known from what it did itself and what it was shared. One has a limit of bytes, and so loses results
of its own; the other may lose nothing.
"""

from __future__ import annotations

import json
import random
from dataclasses import dataclass, field
from typing import Any

from benchmarks.serving import Served
from vibrafeed.app.jobs.keys import Key, Keys
from vibrafeed.app.jobs.ledger import Ledger
from waiting import PATIENCE, wait_for

STRICT, LIMITED = "strict", "limited"
LIMITED_BYTES = 60_000
STUDIES = 8  # different ones that both choose among
SLICE = "/slice?output=acceleration_x&axes=beta"
ASYNC = {"Prefer": "respond-async"}
SWEEP_ENDS = ["", SLICE, "/netcdf", "/zarr/zarr.json", "/nowhere"]
JOB_ENDS = ["", "/results", "/results/dataset", "/events", "/results/zarr/zarr.json"]


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


def make_keys(server: Served) -> dict[str, str]:
    """Make both keys in the ledger of a service that runs; return them when it asks for them."""
    ledger = Ledger(server.data / "jobs.sqlite3")
    try:
        keys = Keys(ledger.database)
        strict, _ = keys.add(Key(STRICT, "run"))
        limited, _ = keys.add(Key(LIMITED, "run", bytes=LIMITED_BYTES))
    finally:
        ledger.close()
    stranger = Client(server, "", "vf_none")
    wait_for(lambda: stranger.ask("GET", "/scenes")[0] != 200)
    return {STRICT: strict, LIMITED: limited}


@dataclass
class Client:
    """One of the two, and what it knows.

    Attributes
    ----------
    sweeps, jobs : dict
        What it posted, and whether it shares it.
    """

    server: Served
    name: str
    key: str
    sweeps: dict[str, bool] = field(default_factory=dict)
    jobs: dict[str, bool] = field(default_factory=dict)

    def ask(
        self, method: str, path: str, content: object = None, **headers: str
    ) -> tuple[int, bytes]:
        """Return the status and the body of a reply."""
        headers |= {"Authorization": f"Bearer {self.key}"}
        reply = self.server.ask(method, path, content, timeout=PATIENCE, **headers)
        return reply.status, reply.body


class Play:
    """Makes random calls, and finds replies that are not as they are to be.

    Attributes
    ----------
    wrong : list of str
        What was found.
    lost : int
        Results that the one with the limit lost to its own.
    """

    def __init__(self, clients: list[Client], seed: int):
        self._clients, self._random = clients, random.Random(seed)
        self.wrong: list[str] = []
        self.lost = 0

    def call(self) -> None:
        """Make one call."""
        me, other = self._random.sample(self._clients, 2)
        action = self._random.choice(
            [self._post_sweep, self._post_job, self._read_sweep, self._read_sweep, self._read_job,
             self._read_job, self._list, self._dismiss, self._share, self._guess]
        )  # fmt: skip
        action(me, other)

    def _expect(self, what: str, me: Client, status: int, *right: int) -> bool:
        lost = {404, 410, 507}  # its own make room
        if what == "sharing" or what.endswith("/netcdf"):
            lost.add(403)  # and the other, who has the same study, shares it
        if me.name == LIMITED and status in lost:
            self.lost += 1
            return False
        if status not in right:
            self.wrong.append(f"{me.name}, {what}: {status}, not {right}")
        return status in right

    def _post_sweep(self, me: Client, other: Client) -> None:
        status, body = me.ask("POST", "/sweeps", study(self._random.randrange(STUDIES)))
        if self._expect("a sweep", me, status, 200, 201):
            key = json.loads(body)["id"]
            if me.name == STRICT and (status == 200) != (key in me.sweeps):
                self.wrong.append(f"{me.name} was told {status} of a sweep")
            me.sweeps.setdefault(key, False)

    def _post_job(self, me: Client, other: Client) -> None:
        number = self._random.randrange(STUDIES)
        status, body = me.ask("POST", "/processes/sweep/execution", study(number), **ASYNC)
        if self._expect("a job", me, status, 201):
            job = json.loads(body)
            me.jobs[job["jobID"]] = False
            me.sweeps.setdefault(job["study"], False)
            if job["owner"] != me.name or job["shared"]:
                self.wrong.append(f"{me.name} has a job of {job}")

    def _read_sweep(self, me: Client, other: Client) -> None:
        if not me.sweeps:
            return
        key = self._random.choice(list(me.sweeps))
        end = self._random.choice(["", SLICE, "/netcdf", "/zarr/zarr.json", "/zarr/beta/c/0"])
        status, _ = me.ask("GET", f"/sweeps/{key}{end}")
        if not self._expect(f"its sweep{end}", me, status, 200) and status == 404:
            me.sweeps.pop(key)

    def _read_job(self, me: Client, other: Client) -> None:
        if not me.jobs:
            return
        number = self._random.choice(list(me.jobs))
        status, body = me.ask("GET", f"/jobs/{number}")
        self._expect("its job", me, status, 200)
        if json.loads(body)["status"] != "successful":
            return
        for end in ("/results", "/results/dataset", "/events"):
            status, _ = me.ask("GET", f"/jobs/{number}{end}")
            self._expect(f"its job{end}", me, status, 200)

    def _list(self, me: Client, other: Client) -> None:
        status, body = me.ask("GET", "/jobs?limit=1000")
        self._expect("the list", me, status, 200)
        found = {job["jobID"] for job in json.loads(body)["jobs"]}
        right = set(me.jobs) | {number for number, shared in other.jobs.items() if shared}
        if found != right:
            self.wrong.append(f"{me.name} lists {len(found - right)} too many")

    def _dismiss(self, me: Client, other: Client) -> None:
        if not me.jobs or self._random.random() < 0.5:
            return
        number = self._random.choice(list(me.jobs))
        status, _ = me.ask("DELETE", f"/jobs/{number}")
        self._expect("dismissal", me, status, 200)

    def _share(self, me: Client, other: Client) -> None:
        for path, mine in (("/sweeps", me.sweeps), ("/jobs", me.jobs)):
            if mine:
                name, shared = self._random.choice(list(mine)), self._random.random() < 0.3
                status, body = me.ask("PATCH", f"{path}/{name}", {"shared": shared})
                if self._expect("sharing", me, status, 200):
                    mine[name] = shared
                    if json.loads(body)["shared"] != shared:
                        self.wrong.append(f"{me.name} shares in vain")

    def _guess(self, me: Client, other: Client) -> None:
        """Ask for what the other has, by a name that nobody told."""
        for kind, unknown, ends, theirs in (
            ("sweeps", "0" * 64, SWEEP_ENDS, other.sweeps), ("jobs", "0" * 32, JOB_ENDS, other.jobs)
        ):  # fmt: skip
            names = sorted(set(theirs) - set(me.sweeps))
            for name in self._random.sample(names, min(2, len(names))):
                path, end, shared = f"/{kind}/{name}", self._random.choice(ends), theirs[name]
                status, body = me.ask("GET", path + end)
                told, none = me.ask("GET", f"/{kind}/{unknown}{end}")
                none = none.replace(unknown.encode(), name.encode())
                if not shared and (status, body) != (told, none):
                    self.wrong.append(
                        f"{me.name} tells {kind}{end} of the other from none: {status}"
                    )
                refused = [me.ask("PATCH", path, {"shared": not shared})[0]]
                if kind == "jobs":
                    refused.append(me.ask("DELETE", path)[0])
                right = {404} if not shared else {403} if kind == "jobs" else {403, 404}
                if not set(refused) <= right:
                    self.wrong.append(f"{me.name} changes {kind} of the other: {refused}")


def play(server: Served, keys: dict[str, str], calls: int, seed: int) -> Play:
    """Let both make calls in a random order; return what was found."""
    found = Play([Client(server, name, key) for name, key in keys.items()], seed)
    for _ in range(calls):
        found.call()
    return found
