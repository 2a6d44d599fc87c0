"""What a start loads, in a process of its own: no more than it needs."""

import subprocess
import sys

import pytest

# As on a worker: functions found by their names, and run.
WORK = """
import importlib, pathlib, sys
directory = pathlib.Path("data")
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
SERVICE = """
import os, sys
import vibrafeed.app.main
assert os.listdir() == []  # importing builds nothing
from vibrafeed.app.settings import Settings
from vibrafeed.app.web.execution import AnyStudy, MeasuredStudy
vibrafeed.app.main.create_app(Settings(data_directory="data"))
# The schema of all studies is as much work as all else, and only the document shows it.
assert not AnyStudy.__pydantic_complete__ and not MeasuredStudy.__pydantic_complete__
print(*sorted(sys.modules))
"""
CONSOLE = (
    "fastapi", "starlette", "uvicorn", "prometheus_client", "typer", "rich", "structlog",
    "sqlalchemy", "vibrafeed.app.cli", "vibrafeed.app.main", "vibrafeed.app.web.routes",
)  # fmt: skip


@pytest.mark.parametrize(
    ("code", "there", "absent"),
    [
        (WORK, "vibrafeed.app.jobs.store", CONSOLE),
        (SERVICE, "fastapi", ("opentelemetry.sdk", "opentelemetry.exporter", "distributed")),
    ],
)
def test_what_is_loaded(tmp_path, code, there, absent):
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    loaded = done.stdout.split()
    assert there in loaded
    assert [name for name in loaded if name.startswith(absent)] == []
