"""What schemathesis makes of the OpenAPI document, sent to a server of its own: no reply surprises.

A few cases a route by day, 500 and three seeds by night; `VIBRAFEED_FUZZ_CASES` says how many else.
"""

import json
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from http import HTTPStatus
from pathlib import Path
from typing import Any

import pytest

from access import KEY, lock
from benchmarks import serving
from night import NIGHT, count
from vibrafeed.app.web.execution import PROCESSES
from waiting import PATIENCE, wait_for

CASES = count(2, 500, "VIBRAFEED_FUZZ_CASES")
SEEDS = (1, 2, 3) if CASES > 100 else (1,)
PHASES = "examples,fuzzing,stateful" if NIGHT else "fuzzing,stateful"
STUDY = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["throw_number"],
    "parameters": {"frequency": 50, "amplitude": [0.0005, 0.001], "beta": [0, 10, 20]},
}
# Small, so that no case takes long; three studies of a key at most wait for the one worker.
LIMITS = {
    "max_cells": 2000,
    "max_slice_cells": 2000,
    "max_synchronous_seconds": 0.05,
    "max_execution_seconds": PATIENCE,
    "max_job_seconds": PATIENCE,
    "max_wait_seconds": 0.1,
    "max_queue": 6,  # of which the only key has half
    "workers": 1,
}
# A schema says what a study looks like, not what is physical: whether a scene has an output, needs
# a parameter, or has a value on its axis is told by 422 and a problem document, as documented.
CONFIGURATION = """
request-timeout = {patience}  # the first simulation may have to be compiled

[checks]
max_response_time = {patience}  # its own limit of 10 s hangs on how busy the machine is

[checks.positive_data_acceptance]
expected-statuses = ["2xx", "3xx", 401, 404, 422, 429]

# Also a query that is too long; no error of the service.
[checks.negative_data_rejection]
expected-statuses = [400, 401, 403, 404, 405, 406, 409, 413, 414, 415, 422, 428, 429]

[auth.openapi.bearer]
bearer = "{key}"

[phases.coverage]
unexpected-methods = ["GET", "PUT", "POST", "DELETE", "OPTIONS", "PATCH", "TRACE"]

[parameters]
"path.name" = {{ dictionary = "scenes", probability = 0.8 }}
"path.process" = {{ dictionary = "processes", probability = 0.8 }}
"path.key" = {{ dictionary = "sweeps", probability = 0.9 }}
"path.path" = {{ dictionary = "zarr", probability = 0.8 }}
"query.output" = {{ dictionary = "outputs", probability = 0.9 }}
"query.axes" = {{ dictionary = "axes", probability = 0.9 }}

# A study has so many places that all their borders take minutes a route. Nor does the schema say
# that null stands for a field that is left out.
[[operations]]
include-path-regex = "(execution|convert|sweeps)$"
include-method = "POST"
phases.coverage.enabled = false

# Not for DELETE: the job is to stay.
[[operations]]
include-path-regex = "^/jobs/"
include-method = "GET"
parameters = {{ "path.number" = {{ dictionary = "jobs", probability = 0.8 }} }}

[dictionaries]
scenes = {{ values = ["rectangle-on-plane", "cylinder-rolling"] }}
processes = {{ values = ["sweep", "simulate", "optimise", "sensitivity", "calibrate"] }}
sweeps = {{ values = ["{sweep}"] }}
jobs = {{ values = ["{job}"] }}
zarr = {{ values = ["zarr.json", "throw_number/zarr.json", "throw_number/c/0/0"] }}
outputs = {{ values = ["throw_number"] }}
axes = {{ values = ["amplitude,beta"] }}
"""


def asked(address: str, content: Any = None, **headers: str) -> Any:
    body = None if content is None else json.dumps(content).encode()
    request = urllib.request.Request(
        address, body, {"X-API-Key": KEY, "Content-Type": "application/json", **headers}
    )
    while True:
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
                return json.load(reply)
        except urllib.error.HTTPError as refused:
            if refused.code != HTTPStatus.TOO_MANY_REQUESTS:
                raise
            time.sleep(float(refused.headers["Retry-After"]))  # the queue is full of made up work


@pytest.fixture(scope="module")
def served(tmp_path_factory) -> Iterator[tuple[str, Path]]:
    """The address of a server that has a sweep and a finished job, and how to talk about them."""
    folder = tmp_path_factory.mktemp("fuzzed")
    with serving.served(**LIMITS) as server:
        lock(server.address, server.data)
        address = server.address
        # The document is made once, which a busy machine takes longer for than Schemathesis waits.
        asked(f"{address}/openapi.json")
        sweep = asked(f"{address}/sweeps", STUDY)["id"]
        job = asked(f"{address}/processes/sweep/execution", STUDY, Prefer="respond-async")["jobID"]
        wait_for(lambda: asked(f"{address}/jobs/{job}")["status"] == "successful")
        configuration = folder / "schemathesis.toml"
        content = CONFIGURATION.format(patience=PATIENCE, key=KEY, sweep=sweep, job=job)
        configuration.write_text(content)
        yield address, configuration


@pytest.mark.parametrize("seed", SEEDS)
def test_every_check_holds_on_every_route(served, seed, tmp_path):
    address, configuration = served
    command = [
        str(Path(sys.executable).with_name("schemathesis")),
        *("--config-file", configuration, "run", f"{address}/openapi.json", "--checks", "all"),
        *("--max-examples", CASES, "--seed", seed, "--continue-on-failure", "--no-shrink"),
        # A dismissed job still tells that it was dismissed, as the standard of OGC has it.
        # Wrong keys are made to wait, up to 3 s each; test_guard.py sends them to every route.
        *("--exclude-checks", "use_after_free,ignored_auth"),
        # The others do not depend on the seed; the borders of every place take longest. By day the
        # examples are carried out by the other test only.
        *(() if seed == SEEDS[0] and NIGHT else ("--phases", PHASES)),
    ]
    done = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, cwd=tmp_path
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_examples_of_bodies_are_carried_out(served):
    # All that is made up above is refused for its physics; these reach the computing.
    address, _ = served
    posted = 0
    for path, operations in asked(f"{address}/openapi.json")["paths"].items():
        if "requestBody" in operations.get("post", {}):
            body = operations["post"]["requestBody"]["content"]["application/json"]
            form = "?to=json" if path == "/convert" else ""
            examples = {name: one["value"] for name, one in body.get("examples", {}).items()}
            for process, example in (examples or {"": body["example"]}).items():
                assert asked(f"{address}{path.format(process=process)}{form}", example)
                posted += 1
    assert posted == len(PROCESSES) + 2
