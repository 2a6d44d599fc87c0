"""Random studies of all kinds against a running server, which ends in no error of its own.

Posted are the studies that are shipped with other values, and with values at their bounds and
beyond. What is accepted as a job is dismissed, one of `FOLLOWED` after it has been followed for a
while. Told are replies by status, every 5xx and every job that failed by the service's fault, with
its study.
"""

from __future__ import annotations

import itertools
import json
import shutil
import threading
import time
import urllib.error
import urllib.request
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from benchmarks.serving import Served, served
from random_studies import KINDS, random_study, shipped
from vibrafeed.app.settings import Settings
from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.quantities import QUANTITIES
from waiting import PATIENCE

FOLLOWED = 25
LOOKS = 25  # at a job that is followed, 0.2 s apart
CLIENTS = 4

EXTREMES = (0.0, -1.0, 1e-300, 1e300, 5e-324, 1e-12, 1e12)

Content = dict[str, Any]


def study(random: np.random.Generator) -> Content:
    """Return the content of a study of any kind, with some mistakes."""
    kind = str(random.choice(KINDS))
    content = random_study(random, kind, shipped(kind))
    given = content["parameters"]
    for name in [name for name in given if random.random() < 0.05]:
        quantity = QUANTITIES[name]
        ends = [end for end in (quantity.lower, quantity.upper) if np.isfinite(end)]
        beyond = [end + step for end in ends for step in (-1e-9, 0.0, 1e-9)]
        given[name] = float(random.choice([*EXTREMES, *beyond]))
    if random.random() < 0.05:
        given.pop(str(random.choice(list(given))))
    if random.random() < 0.05:
        given[str(random.choice(list(QUANTITIES)))] = "1"
    if kind == "simulate" and random.random() < 0.3:
        content["tolerance"] = 10 ** random.uniform(-14, 1)
        content["max_periods"] = int(10 ** random.uniform(0, 6))
    if random.random() < 0.1:
        content["verify"] = int(random.integers(0, 20))
    return content


class Search:
    """Posts studies and keeps what is wrong.

    Attributes
    ----------
    statuses : Counter
        Replies by status.
    wrong : list of str
        What should not have been.
    """

    def __init__(self, server: Served):
        self._server = server
        self._lock = threading.Lock()
        self._jobs = itertools.count()
        self.statuses: Counter[str] = Counter()
        self.wrong: list[str] = []

    def post(self, content: Content) -> None:
        """Post a study, and look at what becomes of it."""
        status, document = self._ask("POST", f"/processes/{content['kind']}/execution", content)
        self._count(str(status))
        if status == 507 and self._is_too_large(content):
            return
        if status >= 500:
            self._tell(f"{status} {document.get('detail')}", content)
        elif status == 200:
            self._look_at_own(content)
        elif status == 201:
            self._follow(document["jobID"], content)

    def _follow(self, number: str, content: Content) -> None:
        if next(self._jobs) % FOLLOWED == 0:
            for _ in range(LOOKS):
                _, job = self._ask("GET", f"/jobs/{number}")
                if job["status"] not in ("accepted", "running"):
                    break
                time.sleep(0.2)
            self._count(f"job {job['status']}")
            if job["status"] == "failed":
                status, problem = self._ask("GET", f"/jobs/{number}/results")
                if status >= 500:
                    self._tell(f"failed job: {problem.get('detail')}", content)
        status, _ = self._ask("DELETE", f"/jobs/{number}")
        if status >= 500:
            self._tell(f"{status} to its dismissal", content)

    def _look_at_own(self, content: Content) -> None:
        """Say so if what the service took is refused in this process."""
        try:
            prepare_content(content)
        except VibrafeedError as error:
            self._tell(f"accepted, and refused here: {error}", content)

    def _is_too_large(self, content: Content) -> bool:
        """True if a result cannot be stored here: beyond the quota, or the disk is smaller."""
        prepared = prepare_content(content)
        quota = Settings.model_fields["disk_quota_bytes"].default
        free = shutil.disk_usage(self._server.data).free
        return prepared.bytes + prepared.computed_bytes > min(quota, free)

    def _ask(self, method: str, path: str, content: Any = None) -> tuple[int, Any]:
        data = None if content is None else json.dumps(content).encode()
        headers = {"Content-Type": "application/json", "Accept": "application/json"}
        request = urllib.request.Request(self._server.address + path, data, headers, method=method)
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
                return reply.status, json.load(reply)
        except urllib.error.HTTPError as error:
            with error:
                return error.code, json.load(error)

    def _count(self, name: str) -> None:
        with self._lock:
            self.statuses[name] += 1

    def _tell(self, what: str, content: Content) -> None:
        with self._lock:
            self.wrong.append(f"{what}: {json.dumps(content)}")
            print(self.wrong[-1], flush=True)


def searched(count: int, seed: int) -> Search:
    """Post random studies to a server of its own; return what was found."""
    with served(max_queue=1000) as server, ThreadPoolExecutor(CLIENTS) as clients:
        search, random = Search(server), np.random.default_rng(seed)
        for _ in clients.map(search.post, [study(random) for _ in range(count)]):
            pass
        return search
