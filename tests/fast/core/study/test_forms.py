"""A study keeps its key through every form in which it is passed on, whatever stands in it."""

import json
import os
import re
import shlex
import tomllib
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import vibrafeed
from night import spread
from surfaces import box
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study, read_content, read_json, read_toml
from vibrafeed.core.intake.forms import FORMS, REQUESTS, resolve_files, to_curl, to_powershell
from vibrafeed.core.intake.studies import study_of
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.study.grid_study import names_recording

CONFIGS = sorted((Path(__file__).parents[4] / "configs").rglob("*.toml"))
PLANE = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "parameters": {"frequency": "3000 rpm", "amplitude": ["0.1 mm", 3e-4], "beta": 20,
                   "friction": {"start": 0.1, "stop": 0.5, "step": 0.1}},
}  # fmt: skip
HOSTILE = "it's \"$(touch owned)\" `id` \\ !! %PATH%\n'; rm -rf x; '\t# \u2028 \x7f \U0001f600 [a]"


def body_of(line: str) -> object:
    """Return what the words of a line for curl send."""
    curl, header, content_type, raw, body, _ = shlex.split(line)
    assert [curl, header, raw] == ["curl", "-H", "--data-raw"]
    assert content_type == "Content-Type: application/json"
    return read_json(body)


def text_of(commands: str) -> str:
    """Return the text that PowerShell reads between @' and '@, as it stands there."""
    first, body, last, command, end = commands.split("\n")
    assert (first, last, end) == ("$study = @'", "'@", "")
    assert re.fullmatch(
        r"Invoke-RestMethod -Method Post -ContentType 'application/json' -Body \$study "
        r"-Uri '[^']+'",
        command,
    )
    return body


def called(program: str) -> vibrafeed.Study:
    """Return the study that a program carries out, without carrying it out."""
    found = []
    with pytest.MonkeyPatch.context() as patch:
        for kind in KINDS:

            def told(kind=kind, **keywords):
                found.append(vibrafeed.study(kind=kind, **keywords))

            patch.setattr(vibrafeed, kind, told)
        exec(compile(program, "program", "exec"), {"print": lambda *_: None})
    (study,) = found
    return study


def studies_of(content) -> dict[str, vibrafeed.Study]:
    return {
        "toml": parse_study(read_toml(FORMS["toml"](content))),
        "json": parse_study(read_json(FORMS["json"](content))),
        "curl": parse_study(body_of(to_curl(content))),
        "powershell": parse_study(read_json(text_of(to_powershell(content)))),
        "python": called(FORMS["python"](content)),
    }


@pytest.mark.parametrize("path", spread(CONFIGS, 12), ids=lambda path: path.stem)
def test_every_study_keeps_its_key_in_every_form(path):
    content = read_content(path)
    if names_recording(content) or "part" in content:
        pytest.skip("its numbers come from a file")
    key = parse_study(content).key()
    found = {form: study.key() for form, study in studies_of(content).items()}
    assert found == dict.fromkeys(FORMS, key)
    back = read_toml(FORMS["toml"](read_json(FORMS["json"](content))))
    assert back == content  # as it was typed


@given(st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=80))
@settings(max_examples=30, deadline=None)
@example(HOSTILE)
def test_whatever_stands_in_a_title_stays_there(title):
    for study in studies_of({**PLANE, "title": title, "notes": title}).values():
        assert study.title == study.notes == title


def test_powershell_reads_a_hostile_title_as_plain_text():
    title = HOSTILE + "\n'@\n\u2019"
    commands = to_powershell({**PLANE, "title": title}, "http://lab:9000/it's/")
    assert commands.isascii()  # PowerShell 5 sends other letters as Latin-1
    _, body, last, command, _ = commands.split("\n")  # its text ends at a line '@ alone
    assert (last, json.loads(body)["title"]) == ("'@", title)
    assert command.endswith(" -Uri 'http://lab:9000/it''s/processes/simulate/execution'")


def test_units_and_ranges_stay_as_they_were_typed():
    text = FORMS["toml"]({**PLANE, "title": None})
    assert tomllib.loads(text) == PLANE
    assert "friction = {start = 0.1, stop = 0.5, step = 0.1}" in text
    assert "    frequency='3000 rpm'," in FORMS["python"](PLANE)


def test_what_no_command_line_holds_is_refused():
    long = {**PLANE, "parameters": {**PLANE["parameters"], "beta": [k / 1e4 for k in range(20000)]}}
    with pytest.raises(StudyError, match="too long for a command line"):
        to_curl(long)
    with pytest.raises(StudyError, match="no Python function for the kind 'added'"):
        FORMS["python"]({"kind": "added"})


def test_a_recording_is_found_from_where_the_form_is_used(tmp_path):
    recording = tmp_path / "data" / "drive.csv"
    recording.parent.mkdir()
    recording.write_text("t,ax\n0,1\n")
    content = {**PLANE, "drive": {"file": str(recording), "along": "ax"}}
    sent = {"along": "ax", "data": "t,ax\n0,1\n"}
    for form, folder, drive in (
        ("toml", "studies", {"along": "ax", "file": "../data/drive.csv"}),
        ("python", "", {"along": "ax", "file": str(recording)}),
        *((form, "", sent) for form in REQUESTS),
    ):
        assert resolve_files(content, form, tmp_path / folder)["drive"] == drive
    recording.unlink()
    with pytest.raises(StudyError, match="cannot be read"):
        resolve_files(content, "curl", tmp_path)


def test_a_part_is_sent_by_its_numbers(tmp_path):
    file = tmp_path / "box.stl"
    file.write_text(box(30, 20, 10)["data"])
    content = {"kind": "sweep", "scene": "resting-part", "outputs": ["thrown_share"],
               "part": {"file": str(file), "unit": "mm"}}  # fmt: skip
    assert resolve_files(content, "toml", tmp_path / "studies")["part"]["file"] == "../box.stl"
    for form in REQUESTS:
        sent = resolve_files(content, form, tmp_path)
        assert parse_study(sent).key() == study_of(content).key()
    file.unlink()
    with pytest.raises(StudyError, match="cannot be read"):
        resolve_files(content, "curl", tmp_path)


def test_a_file_on_another_drive_keeps_its_whole_path(tmp_path, monkeypatch):
    def on_windows(path, start):
        raise ValueError("path is on mount 'C:', start on mount 'D:'")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(os.path, "relpath", on_windows)
    content = {**PLANE, "drive": {"file": "data/drive.csv"}, "observations": "data/runs.csv"}
    found = resolve_files(content, "toml", tmp_path / "studies")
    assert found["drive"]["file"] == (tmp_path / "data" / "drive.csv").as_posix()
    assert found["observations"] == (tmp_path / "data" / "runs.csv").as_posix()
