"""Random studies of all kinds, sent to a server of its own: none ends in a mistake of ours.

Posted are the studies that are shipped with other values, and with values at their bounds and
beyond. What is accepted as a job is dismissed, one of `FOLLOWED` after it has been followed for a
while. A few by day, 20,000 by night; `VIBRAFEED_FUZZ_CASES` says how many else.
"""

import json
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from benchmarks.serving import Served, served
from night import count
from random_studies import KINDS, random_study, shipped
from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.quantities import QUANTITIES
from waiting import PATIENCE

CASES = count(12, 20_000, "VIBRAFEED_FUZZ_CASES")
FOLLOWED = 25
LOOKS = 25  # at a job that is followed, 0.2 s apart
CLIENTS = 4
EXTREMES = (0.0, -1.0, 1e-300, 1e300, 5e-324, 1e-12, 1e12)


def study(random: np.random.Generator) -> dict[str, Any]:
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


def ask(server: Served, method: str, path: str, content: Any = None) -> tuple[int, Any]:
    kinds = {"Content-Type": "application/json", "Accept": "application/json"}
    reply = server.ask(method, path, content, timeout=PATIENCE, **kinds)
    return reply.status, json.loads(reply.body)


def fate(server: Served, number: str, followed: bool) -> str:
    """Dismiss a job, or follow it for a while before; return what is wrong."""
    wrong = ""
    for _ in range(LOOKS if followed else 0):
        _, job = ask(server, "GET", f"/jobs/{number}")
        if job["status"] == "failed":
            status, problem = ask(server, "GET", f"/jobs/{number}/results")
            wrong = f"failed job: {problem}" if status >= 500 else ""
        if job["status"] not in ("accepted", "running"):
            break
        time.sleep(0.2)
    status, _ = ask(server, "DELETE", f"/jobs/{number}")
    return f"{status} to its dismissal" if status >= 500 else wrong


def posted(server: Served, content: dict[str, Any], followed: bool) -> tuple[int, str]:
    """Post a study; return the status, and what is wrong with it or what becomes of it."""
    status, document = ask(server, "POST", f"/processes/{content['kind']}/execution", content)
    wrong = ""
    if status == 201:
        wrong = fate(server, document["jobID"], followed)
    elif status == 200:
        try:
            prepare_content(content)
        except VibrafeedError as error:
            wrong = f"accepted, and refused here: {error}"
    elif status not in (422, 429):
        wrong = f"{status} {document.get('detail')}"
    return status, wrong


@pytest.mark.timeout(1800 + 3 * CASES)
def test_random_studies_end_in_no_mistake_of_ours():
    random = np.random.default_rng(CASES)
    contents = [study(random) for _ in range(CASES)]
    with served(max_queue=1000) as server, ThreadPoolExecutor(CLIENTS) as clients:
        follow = [k % FOLLOWED == 0 for k in range(CASES)]
        found = list(clients.map(posted, [server] * CASES, contents, follow))
    assert not [
        (wrong, content) for (_, wrong), content in zip(found, contents, strict=True) if wrong
    ]
