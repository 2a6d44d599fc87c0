"""`vibrafeed convert`, as a user runs it."""

import json
import tomllib
from pathlib import Path

import pytest
import xarray

from commands import run, saved

STUDY = """\
kind = "simulate"
scene = "rectangle-on-plane"

[parameters]
frequency = "50 Hz"
amplitude = "0.3 mm"
beta = "20 deg"
friction = 0.3
"""
CONTENT = tomllib.loads(STUDY)


def test_there_and_back_through_files_and_standard_input():
    saved(STUDY)
    run("convert study.toml --to json -o study.json")
    assert json.loads(Path("study.json").read_text()) == CONTENT
    assert tomllib.loads(run("convert study.json --to toml").stdout) == CONTENT
    assert json.loads(run("convert - --to json", input=STUDY).stdout) == CONTENT
    toml = run("convert - --to toml", input=json.dumps(CONTENT)).stdout
    assert 'beta = "20 deg"' in toml
    Path("study.json").write_text("mine")
    run("convert study.toml --to json -o study.json --force")
    assert json.loads(Path("study.json").read_text()) == CONTENT


def test_the_program_runs():
    saved(STUDY)
    run("convert study.toml --to python -o study.py")
    printed: list[xarray.Dataset] = []
    exec(Path("study.py").read_text(), {"print": printed.append})
    (dataset,) = printed
    assert float(dataset.conveying_velocity) > 0


@pytest.mark.parametrize(
    ("form", "ends"),
    [
        ("curl", " http://lab:9000/processes/simulate/execution\n"),
        ("powershell", " -Uri 'http://lab:9000/processes/simulate/execution'\n"),
    ],
)
def test_the_command_asks_the_service_that_is_named(form, ends):
    saved(STUDY)
    line = f"convert study.toml --to {form} --service http://lab:9000/"
    assert run(line).stdout.endswith(ends)
