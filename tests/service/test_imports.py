"""What a worker loads: the computing and the disk, no console and nothing of HTTP."""

from __future__ import annotations

import subprocess
import sys

import pytest

OTHERS = (
    "fastapi",
    "starlette",
    "uvicorn",
    "prometheus_client",
    "typer",
    "rich",
    "structlog",
    "sqlalchemy",
)
ROOMS = ("vibrafeed.app.cli", "vibrafeed.app.main", "vibrafeed.app.web")

# As on a worker: functions found by their names, and run.
WORK = """
import importlib, pathlib, sys
directory = pathlib.Path(sys.argv[1])
run = importlib.import_module("vibrafeed.app.jobs.work")
from vibrafeed.app.jobs.store import Store
from vibrafeed.core.code_version import code_version
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.plan.pieces import cells_of_piece
study = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["throw_number"],
         "parameters": {"frequency": 50, "amplitude": 0.001, "beta": [0, 30, 60]}}
store = Store(directory)
prepared = prepare_content(study)
key, _ = store.add(prepared.study)
cells = cells_of_piece(prepared, 1.0)
run.compute_block(str(directory), key, "sweep", cells, 0, code_version())
run.write_result(str(directory), key, "sweep", cells, 0.0)
assert store.manifest(key) is not None
import vibrafeed.app.web.calculations  # what it loads to read studies
import vibrafeed.app.jobs.accuracy  # what it loads for a report of accuracy
print(*sorted(sys.modules))
"""


@pytest.fixture(scope="module")
def loaded(tmp_path_factory: pytest.TempPathFactory) -> set[str]:
    """Return the modules of a fresh process that has carried out a study as a worker does."""
    command = [sys.executable, "-c", WORK, str(tmp_path_factory.mktemp("data"))]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return set(done.stdout.split())


@pytest.mark.parametrize("name", OTHERS)
def test_a_worker_loads_no_console_and_no_server(loaded: set[str], name: str) -> None:
    assert "vibrafeed.app.jobs.work" in loaded
    assert name not in loaded


def test_a_worker_loads_no_other_room(loaded: set[str]) -> None:
    own = {"vibrafeed.app.web", "vibrafeed.app.web.calculations", "vibrafeed.app.web.execution"}
    rooms = {name for name in loaded if name.startswith(ROOMS)} - own
    assert "vibrafeed.app.jobs.store" in loaded
    assert not rooms


def test_the_check_would_see_them() -> None:
    code = "import vibrafeed.app.web.problems, vibrafeed.app.cli, sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert {"fastapi", "typer", "vibrafeed.app.cli"} <= set(done.stdout.split())
