"""A Python client that a generator makes of our OpenAPI document calls every route; by night."""

import json
import os
import subprocess
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from services import services
from tools import tool
from waiting import PATIENCE

ROOT = Path(__file__).parents[2]
MOST_LINES = 12_000
GENERATOR = "VIBRAFEED_CLIENT_GENERATOR"
# The generator reads bytes of one media type only, and has to be told that ours is bytes, too.
CONFIGURATION = {
    "content_type_overrides": {"application/x-netcdf": "application/octet-stream"},
}

# Run with the generator's Python, which has what its clients need. Each route is called, and what
# the client made of the reply is told.
CALLS = """
import importlib, json, pkgutil, sys, time
address, file = sys.argv[1:]

import made.api
from made import AuthenticatedClient, models

client = AuthenticatedClient(address, token="none is needed", raise_on_unexpected_status=True)
modules = {}
for tag in pkgutil.iter_modules(made.api.__path__):
    package = importlib.import_module(f"made.api.{tag.name}")
    for module in pkgutil.iter_modules(package.__path__):
        modules[module.name] = importlib.import_module(f"{package.__name__}.{module.name}")
report = {}

def call(name, *values, **named):
    reply = modules[name].sync_detailed(*values, client=client, **named)
    parsed = reply.parsed
    assert int(reply.status_code) < 300, (name, reply)
    kind = type(parsed[0] if isinstance(parsed, list) else parsed).__name__
    report.setdefault(name, []).append([int(reply.status_code), kind])
    return parsed

sweep = models.SweepStudy.from_dict({
    "kind": "sweep", "scene": "rectangle-on-track", "outputs": ["acceleration_x"],
    "parameters": {"frequency": [40, 50], "amplitude": "0.5 mm", "alpha": 10, "beta": [15, 30],
                   "friction": 0.3, "radius": "0.8 m"},
})
motion = models.SimulateStudy.from_dict({
    "kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"],
    "parameters": {"frequency": 50, "beta": 30, "friction": 0.4, "amplitude": {
        "start": "0.1 mm", "stop": "0.4 mm", "num": 4}},
})
best = models.OptimiseStudy.from_dict({
    "kind": "optimise", "scene": "rectangle-on-plane",
    "criterion": {"kind": "maximise", "output": "acceleration_x"}, "outputs": [],
    "parameters": {"frequency": 50, "amplitude": "0.1 mm", "gamma": "5 deg", "friction": 0.4},
})
unsure = models.SensitivityStudy.from_dict({
    "kind": "sensitivity", "scene": "rectangle-on-plane", "outputs": ["acceleration_x"],
    "uncertain": {"friction": {"mean": 0.3, "deviation": 0.03}}, "samples": 256,
    "parameters": {"frequency": 50, "amplitude": "0.1 mm", "beta": 20},
})
measured = models.CalibrateStudy.from_dict({
    "kind": "calibrate", "scene": "rectangle-on-plane", "points": 1000,
    "unknowns": {"friction": {"lower": 0.1, "upper": 0.6}},
    "observations": [{"amplitude": "0.2 mm", "conveying_velocity": "13 mm/s", "error": "5 %"}],
    "parameters": {"frequency": 50, "beta": 20},
})
large = sweep.to_dict()
large["parameters"]["beta"] = {"start": 0, "stop": 60, "num": 2000}
large = models.SweepStudy.from_dict(large)

call("healthz")
call("readyz")
assert "vibrafeed_requests_total" in call("metrics")
scenes = call("list_scenes")
assert call("describe_scene", scenes[0]["name"])["title"] == scenes[0]["title"]
call("schema")
assert call("list_figures")[0]["name"] == "fig-3-3"
assert call("list_friction", words="abs steel")["pairs"][0]["part"] == "ABS"
assert {link["rel"] for link in call("landing_page")["links"]} > {"self", "service-desc"}
assert call("conformance")["conformsTo"]
process = call("list_processes")["processes"][0]
assert call("describe_process", process["id"])["title"] == process["title"]

study = models.SimulateStudy.from_dict(motion.to_dict())
assert call("convert", body=motion, to=models.ConvertTo("python")).startswith("import vibrafeed")

posted = call("post_sweep", body=sweep)
assert call("post_sweep", body=sweep).to_dict() == posted.to_dict()
assert call("get_sweep", posted.id).cells == 4
sharing = models.Sharing.from_dict({"shared": True})
assert call("share_sweep", posted.id, body=sharing).shared is True
at = models.GetSliceAt.from_dict({"frequency": "50"})
piece = call("get_slice", posted.id, output="acceleration_x", axes="beta", at=at)
assert piece["axes"][0]["values"] == [15, 30]
whole = call("get_netcdf", posted.id).payload.read()
assert whole[:4] == b"\\x89HDF"
assert json.load(call("get_zarr", posted.id, "zarr.json").payload)["zarr_format"] == 3

assert call("execute", "sweep", body=sweep)["cells"] == 4
wrapped = models.ExecuteRequest.from_dict({"inputs": {"study": sweep.to_dict()}})
assert call("execute", "sweep", body=wrapped)["cells"] == 4
assert call("execute", "optimise", body=best)["complete"] is True
assert call("execute", "sensitivity", body=unsure)["cells"] == 1
assert call("execute", "calibrate", body=measured, prefer="respond-async").job_id
job = call("execute", "simulate", body=motion, prefer="respond-async")
assert "event: status" in call("follow_job", job.job_id)
job = call("get_job", job.job_id)
assert (job.status.value, job.progress) == ("successful", 100), job
assert call("share_job", job.job_id, body=sharing).shared is True
assert job.job_id in {listed.job_id for listed in call("list_jobs", process_id=["simulate"]).jobs}
results = call("get_results", job.job_id)
content = call("get_dataset", job.job_id).payload.read()
assert len(content) == results.dataset.length
open(file, "wb").write(content)
job = call("execute", "sweep", body=large, prefer="respond-async")
call("follow_job", job.job_id)
assert json.load(call("get_group", job.job_id, "zarr.json").payload)["zarr_format"] == 3
job = call("execute", "accuracy", body=sweep, prefer="respond-async")
call("follow_job", job.job_id)
measured = call("get_results", job.job_id)
page = [link.href for link in measured.files if link.type_ == "text/markdown"][0]
*_, number, _, _, name = page.split("/")
assert call("get_file", number, name).startswith("# Accuracy")
assert call("dismiss_job", job.job_id).status.value == "dismissed"
print(json.dumps(report))
"""

# What the client makes of the reply to each route: a model's name, or what is not JSON.
PARSED = {
    "healthz": "Health",
    "readyz": "Readiness",
    "metrics": "str",
    "list_scenes": "Document",
    "list_figures": "Document",
    "list_friction": "Document",
    "convert": "str",
    "landing_page": "Document",
    "conformance": "Document",
    "list_processes": "Document",
    "describe_process": "Document",
    "post_sweep": "SweepDescription",
    "get_sweep": "SweepDescription",
    "share_sweep": "SweepDescription",
    "share_job": "StatusInfo",
    "get_netcdf": "File",
    "get_zarr": "File",
    "list_jobs": "JobList",
    "get_job": "StatusInfo",
    "dismiss_job": "StatusInfo",
    "follow_job": "str",
    "get_results": "Results",
    "get_dataset": "File",
    "get_file": "str",
    "get_group": "File",
}


@pytest.fixture(scope="module")
def generator() -> str:
    """Return the generator, which needs an environment of its own."""
    default = ROOT / ".venv-client" / "bin" / "openapi-python-client"
    wanted = os.environ.get(GENERATOR) or str(default)
    return tool(wanted, GENERATOR)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Return the address of a service of its own: replies tell what is new from what is known."""
    with services(tmp_path_factory) as start:
        yield start(workers=2, max_cells=1000, max_execution_seconds=PATIENCE).address


@pytest.fixture(scope="module")
def document(server: str) -> dict[str, Any]:
    with urllib.request.urlopen(f"{server}/openapi.json", timeout=PATIENCE) as reply:
        return json.load(reply)


def operations(document: dict[str, Any]) -> set[str]:
    return {
        operation["operationId"]
        for operations in document["paths"].values()
        for operation in operations.values()
    }


@pytest.fixture(scope="module")
def folder(generator: str, document: dict[str, Any], tmp_path_factory) -> Path:
    """Return the folder with the package `made` that the generator makes."""
    folder = tmp_path_factory.mktemp("generated")
    (folder / "openapi.json").write_text(json.dumps(document))
    (folder / "configuration.json").write_text(json.dumps(CONFIGURATION))
    command = [generator, "generate", "--path", "openapi.json", "--config", "configuration.json",
               "--output-path", "made", "--meta", "none", "--fail-on-warning"]  # fmt: skip
    path = os.pathsep.join([str(Path(generator).parent), os.environ["PATH"]])  # its formatter
    done = subprocess.run(
        command,
        env=os.environ | {"PATH": path},
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "warning" not in (done.stdout + done.stderr).lower()
    return folder


def test_a_client_is_small_and_no_route_is_left_out(folder, document):
    files = (folder / "made").rglob("*.py")
    assert sum(len(path.read_text().splitlines()) for path in files) <= MOST_LINES
    made = {path.stem for path in (folder / "made" / "api").glob("*/*.py")} - {"__init__"}
    assert made == operations(document)


def test_the_client_calls_every_route(folder, document, generator, server, tmp_path):
    python = Path(generator).parent / "python"
    file = tmp_path / "motion.nc"
    done = subprocess.run(
        [python, "-c", CALLS, server, file],
        cwd=folder, capture_output=True, text=True, timeout=4 * PATIENCE, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    report = json.loads(done.stdout)
    assert set(report) == operations(document)
    kinds = {name: {kind for _, kind in calls} for name, calls in report.items()}
    assert {name: kinds[name] for name in PARSED} == {n: {kind} for n, kind in PARSED.items()}
    # Two POSTs of a study: new, and known. A job is made once.
    assert [status for status, _ in report["post_sweep"]] == [201, 200]
    assert file.read_bytes()[:4] == b"\x89HDF"
