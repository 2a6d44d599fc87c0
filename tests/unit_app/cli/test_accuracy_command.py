"""`vibrafeed report`, as a user runs it."""

from __future__ import annotations

import re
import shlex
from dataclasses import replace
from pathlib import Path

import pytest
import xarray
from typer.testing import CliRunner

from vibrafeed.app.cli import app
from vibrafeed.app.cli.accuracy import write_report
from vibrafeed.core.assurance.accuracy.curves import FAMILIES
from vibrafeed.core.assurance.accuracy.report import families_of
from vibrafeed.core.assurance.case import Truth
from vibrafeed.core.intake import prepare_content, read_content

ROOT = Path(__file__).parents[3]

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


def run(*arguments: object):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(STUDY)
    return path


def test_a_page_its_pictures_and_a_dataset_are_written(study, tmp_path):
    folder = tmp_path / "out"
    result = run("report", study, "-o", folder, "--only", "closed_forms", "--only", "storage")
    assert result.exit_code == 0, result.output
    page = (folder / "accuracy.md").read_text()
    assert "A small sweep" in page
    pictures = re.findall(r"!\[.*?\]\((.*?)\)", page)
    assert pictures == ["accuracy-small-closed-forms.png", "accuracy-small-storage.png"]
    names = {*pictures, "accuracy.md", "accuracy-small.nc"}
    assert {path.name for path in folder.iterdir()} == names
    assert all(f"wrote {folder / name}" in result.output for name in names)
    for picture in pictures:
        assert (folder / picture).read_bytes().startswith(b"\x89PNG")
    with xarray.open_dataset(folder / "accuracy-small.nc", engine="netcdf4") as dataset:
        assert set(dataset["family"].values.tolist()) == {0, 3}
        assert "vibrafeed report" in dataset.attrs["history"]


def test_the_page_goes_beside_the_study_and_names_a_command_that_does_what_it_says(study):
    assert run("report", study, "--only", "closed_forms").exit_code == 0
    page = (study.parent / "accuracy" / "accuracy.md").read_text()
    (command,) = re.findall(r"^`vibrafeed (report .*)`$", page, re.MULTILINE)
    assert run(*command.split()).exit_code == 0
    again = (study.parent / "accuracy" / "accuracy.md").read_text()

    def without_times(text: str) -> str:
        return re.sub(r"[\d.]+ (ns|us|ms) |load [\d.]+", "", text)

    assert without_times(again) == without_times(page)


def test_the_page_of_the_documents_is_whole():
    page = (ROOT / "docs/generated/accuracy.md").read_text()
    pictures = re.findall(r"!\[.*?\]\((.*?)\)", page)
    assert len(pictures) >= 6
    assert all((ROOT / "docs/generated" / picture).exists() for picture in pictures)
    commands = re.findall(
        r"^`vibrafeed report (\S+) --only (\S+)(?: --seconds \d+)?`$", page, re.MULTILINE
    )
    extremes = re.findall("^## (.*)\n\n`vibrafeed report --extremes`$", page, re.MULTILINE)
    assert extremes == ["Hard cases", "What a study does not load or compute"]
    assert len(commands) + len(extremes) == len(re.findall("^## ", page, re.MULTILINE))
    assert " 0 wrong" in page
    for study, family in commands:
        families_of(prepare_content(read_content(ROOT / study)), [family])
    # One of each family of the three kinds of study.
    assert {family for _, family in commands} == set(FAMILIES)


def test_a_command_carries_what_the_page_was_made_with(tmp_path):
    path = tmp_path / "my study.toml"
    path.write_text(STUDY)
    assert run("report", path, "--only", "storage", "--seconds", 30).exit_code == 0
    page = (tmp_path / "accuracy" / "accuracy.md").read_text()
    (command,) = re.findall(r"^`vibrafeed (report .*)`$", page, re.MULTILINE)
    assert shlex.split(command) == ["report", str(path), "--only", "storage", "--seconds", "30"]
    assert "](accuracy-my%20study-storage.png)" in page  # a blank would end the address


def test_two_studies_of_one_name_are_refused(study, tmp_path):
    other = tmp_path / "other" / study.name
    other.parent.mkdir()
    other.write_text(STUDY)
    result = run("report", study, other, "-o", tmp_path / "out")
    assert result.exit_code == 2
    assert result.output.count("accuracy-small.nc would be written more than once") == 2
    taken = tmp_path / "extremes.toml"
    taken.write_text(STUDY)
    assert run("report", taken, "--extremes", "-o", tmp_path / "out").exit_code == 2
    assert not (tmp_path / "out").exists()


def test_what_fails_after_a_study_leaves_its_page(study, tmp_path, monkeypatch):
    from vibrafeed.app.cli import accuracy

    def broken(*_: object) -> None:
        raise RuntimeError("broken")

    monkeypatch.setattr(accuracy, "_extremes", broken)
    result = run("report", study, "--only", "storage", "--extremes", "-o", tmp_path / "out")
    assert isinstance(result.exception, RuntimeError)
    assert "## Files (small)" in (tmp_path / "out" / "accuracy.md").read_text()


def test_a_page_that_was_stopped_says_so(study, few_extremes, tmp_path):
    asked = []

    def stopped() -> bool:
        asked.append(None)
        return len(asked) > 1  # after the first study has begun

    written, _ = write_report(
        {study: prepare_content(read_content(study))}, tmp_path, (), 60.0, stopped, extremes=True
    )
    assert (
        "The measurement was stopped early: the remaining measurements are missing."
        in (tmp_path / "accuracy.md").read_text()
    )
    assert [path.name for path in written] == ["accuracy-small.nc", "accuracy.md"]


def test_every_problem_of_every_study_is_told(study, tmp_path):
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(STUDY.replace("throw_number", "throw_nmber").replace("0.5 mm", "0.5 s"))
    result = run("report", study, wrong)
    assert result.exit_code == 2
    assert "2 problems" in result.output
    assert "Did you mean 'throw_number'?" in result.output
    assert not (tmp_path / "accuracy").exists()


def test_a_family_that_is_not_there_is_told(study):
    result = run("report", study, "--only", "optimisers")
    assert result.exit_code == 2
    assert "Known: closed_forms, model, motion, storage" in result.output


def test_a_folder_that_cannot_be_made_is_told(study):
    result = run("report", study, "-o", study / "below", "--only", "closed_forms")
    assert result.exit_code == 1
    assert "Traceback" not in result.output
    assert str(study / "below") in result.output


@pytest.fixture
def few_extremes(monkeypatch):
    """Let the catalogue and the scenes be two cases and one scene."""
    from vibrafeed.core.assurance import leaving_out
    from vibrafeed.core.assurance.hard_cases import HARD_CASES

    easy = next(case for case in HARD_CASES if case.id == "every axis of one value")
    wrong = replace(easy, id="wrong", known=Truth(-1.0, 1e-9, "made up"))
    cases = [easy, wrong]
    monkeypatch.setattr("vibrafeed.app.cli.accuracy.HARD_CASES", cases)
    monkeypatch.setattr(leaving_out, "SCENES", {"part": leaving_out.SCENES["rectangle-isolated"]})
    monkeypatch.setattr(leaving_out, "SYSTEMS", {})
    return cases


def test_hard_cases_and_leaving_out_need_no_study(few_extremes, tmp_path):
    result = run("report", "--extremes", "-o", tmp_path)
    assert result.exit_code == 1  # a case is wrong
    page = (tmp_path / "accuracy.md").read_text()
    assert re.findall("^##+ (.*)$", page, re.MULTILINE) == [
        "Hard cases",
        "Worst of each family",
        "All cases",
        "What a study does not load or compute",
    ]
    assert "1 right, 1 wrong" in page
    assert page.count("`vibrafeed report --extremes`") == 2
    assert f"vibrafeed report --extremes -o {tmp_path}" in page
    assert page.index("**wrong**") < page.index("### All cases")
    with xarray.open_dataset(tmp_path / "accuracy-extremes.nc", engine="netcdf4") as dataset:
        assert dataset["passed"].values.tolist() == [1, 0]
        assert dataset["case"].values.tolist() == [case.id for case in few_extremes]
    with xarray.open_dataset(tmp_path / "accuracy-leaving-out.nc", engine="netcdf4") as dataset:
        assert dataset.sizes == {"study": 2}
        assert (dataset["equations"] < dataset["of"]).all()
        # A process is started for the dearer output.
        assert dataset["modules"].values[0] == -1
        assert dataset["modules"].values[1] > 100


def test_hard_cases_stand_after_the_studies_and_alone_decide(few_extremes, study, tmp_path):
    del few_extremes[1]
    result = run("report", study, "--extremes", "-o", tmp_path / "out", "--only", "storage")
    assert result.exit_code == 0, result.output
    page = (tmp_path / "out" / "accuracy.md").read_text()
    assert page.index("## Files (small)") < page.index("## Hard cases")


def test_nothing_to_measure_is_refused():
    result = run("report")
    assert result.exit_code == 2
    assert "the command names no study to measure" in result.output
