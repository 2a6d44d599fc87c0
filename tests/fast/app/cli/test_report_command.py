"""`vibrafeed report`, as a user runs it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import xarray
from click.testing import Result
from typer.testing import CliRunner

from vibrafeed.app.cli import app
from vibrafeed.core import report as reports

STUDY = """
kind = "sweep"
title = "A small sweep"
scene = "rectangle-on-plane"
outputs = ["acceleration_x", "throw_number"]

[parameters]
frequency = { start = "20 Hz", stop = "120 Hz", num = 11 }
amplitude = "0.5 mm"
beta = 20
friction = 0.3
"""


def run(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(reports, "LEAST_SECONDS", 0.0)
    path = tmp_path / "small.toml"
    path.write_text(STUDY)
    return path


def test_a_page_its_picture_and_a_dataset_are_written(study: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    result = run("report", study, "-o", folder)
    assert result.exit_code == 0, result.output
    page = (folder / "accuracy.md").read_text()
    assert "## A small sweep (small)" in page
    assert re.findall(r"!\[.*?\]\((.*?)\)", page) == ["accuracy-small.png"]
    names = {"accuracy.md", "accuracy-small.nc", "accuracy-small.png"}
    assert {path.name for path in folder.iterdir()} == names
    assert all(f"wrote {folder / name}" in result.output for name in names)
    assert (folder / "accuracy-small.png").read_bytes().startswith(b"\x89PNG")
    with xarray.open_dataset(folder / "accuracy-small.nc", engine="netcdf4") as dataset:
        assert "vibrafeed report" in dataset.attrs["history"]


def test_the_page_goes_beside_the_study(study: Path) -> None:
    assert run("report", study).exit_code == 0
    assert (study.parent / "accuracy" / "accuracy.md").exists()


def test_two_studies_of_one_name_are_refused(study: Path, tmp_path: Path) -> None:
    other = tmp_path / "other" / study.name
    other.parent.mkdir()
    other.write_text(STUDY)
    result = run("report", study, other, "-o", tmp_path / "out")
    assert result.exit_code == 2
    assert result.output.count("accuracy-small.nc would be written more than once") == 2


def test_every_problem_of_every_study_is_told(study: Path, tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(STUDY.replace("throw_number", "throw_nmber").replace("0.5 mm", "0.5 s"))
    result = run("report", study, wrong)
    assert result.exit_code == 2
    assert "2 problems" in result.output
    assert "Did you mean 'throw_number'?" in result.output
    assert not (tmp_path / "accuracy").exists()


def test_a_folder_that_cannot_be_is_told(study: Path) -> None:
    result = run("report", study, "-o", study / "below")
    assert result.exit_code == 1
    assert "Not a directory" in result.output or "exists" in result.output
