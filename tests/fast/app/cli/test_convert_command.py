"""`vibrafeed convert`, as a user runs it."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest
import xarray
from typer.testing import CliRunner

from vibrafeed.app.cli import app

STUDY = """\
kind = "simulate"
scene = "rectangle-on-plane"

[parameters]
frequency = "50 Hz"
amplitude = "0.3 mm"
beta = "20 deg"
friction = 0.3
"""


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def convert(*arguments: object, **more):
    return CliRunner().invoke(app, ["convert", *map(str, arguments)], **more)


def test_there_and_back(study, tmp_path):
    there = convert(study, "--to", "json", "-o", tmp_path / "study.json")
    assert there.exit_code == 0, there.output
    back = convert(tmp_path / "study.json", "--to", "toml")
    assert tomllib.loads(back.stdout) == tomllib.loads(STUDY)


def test_standard_input_is_toml_or_json(study):
    assert json.loads(convert("-", "--to", "json", input=STUDY).stdout) == tomllib.loads(STUDY)
    text = json.dumps(tomllib.loads(STUDY))
    assert 'beta = "20 deg"' in convert("-", "--to", "toml", input=text).stdout
    wrong = convert("-", "--to", "toml", input=b"\xff")
    assert "standard input: error: 1 problem" in wrong.stderr
    assert "standard input is not UTF-8 text" in wrong.stderr


def test_the_program_runs(study, tmp_path):
    program = tmp_path / "study.py"
    assert convert(study, "--to", "python", "-o", program).exit_code == 0
    printed: list[xarray.Dataset] = []
    exec(program.read_text(), {"print": printed.append})
    (dataset,) = printed
    assert float(dataset.conveying_velocity) > 0


def test_an_unusual_number_is_asked_about_and_runs():
    text = STUDY.replace('"0.3 mm"', "0.5")
    done = CliRunner().invoke(app, ["run", "-", "--dry-run"], input=text)
    assert done.exit_code == 0, done.output
    asked = "standard input: warning: amplitude = 0.5 means 500 mm; usual values are 0.0001 to "
    asked += '25 mm. Did you mean "0.5 mm"?\n'
    assert done.stderr == asked + "1 warning\n"
    assert convert("-", "--to", "json", input=text).stderr == asked


def test_the_line_for_curl_asks_the_service_that_is_named(study):
    line = convert(study, "--to", "curl", "--service", "http://lab:9000/").stdout
    assert line.endswith(" http://lab:9000/processes/simulate/execution\n")
    line = convert(study, "--to", "powershell", "--service", "http://lab:9000/").stdout
    assert line.endswith(" -Uri 'http://lab:9000/processes/simulate/execution'\n")


def test_a_file_is_replaced_when_told_to_only(study, tmp_path):
    target = tmp_path / "study.json"
    target.write_text("mine")
    refused = convert(study, "--to", "json", "-o", target)
    assert refused.exit_code == 2
    assert "the file exists already. Add --force to replace it" in refused.stderr
    assert target.read_text() == "mine"
    assert convert(study, "--to", "json", "-o", target, "--force").exit_code == 0
    assert json.loads(target.read_text())["kind"] == "simulate"


def test_what_is_wrong_is_said(study, tmp_path):
    unknown = convert(study, "--to", "yaml")
    assert unknown.exit_code == 2
    assert (
        "to: a study cannot be converted to the format 'yaml'. "
        "Known: curl, json, powershell, python, toml." in unknown.stderr
    )
    study.write_text(STUDY.replace("friction", "mu"))
    assert "Did you mean 'friction'?" in convert(study, "--to", "json").stderr
    study.write_text(STUDY)
    nowhere = convert(study, "--to", "json", "-o", tmp_path / "no" / "folder.json")
    assert nowhere.exit_code == 1
    assert "No such file or directory" in nowhere.stderr
