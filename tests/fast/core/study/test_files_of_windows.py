"""Studies as they come from a Windows desk: paths with backslashes, UTF-16, decimal commas."""

from __future__ import annotations

import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import load_study, read_content, read_toml

STUDY = """\
kind = "simulate"
scene = "rectangle-on-plane"
parameters = {{ friction = 0.3 }}
{}
"""
SLASHES = "Write / between the folders of a path, not \\"


def told(call, *arguments):
    with pytest.raises(StudyError) as caught:
        call(*arguments)
    return str(caught.value)


@pytest.mark.parametrize(
    "path", ["C:\\Users\\anna\\x.csv", "data\\x.csv", "C:\\temp\\x.csv", "data\\"]
)
def test_a_backslash_in_double_quotes_is_told(path):
    message = told(read_toml, f'[drive]\nfile = "{path}"\n')
    assert "line 2" in message
    assert message.endswith("In a path write / for \\, or set the path in '...'.")


def test_utf_16_is_what_powershell_writes(tmp_path):
    file = tmp_path / "study.toml"
    file.write_bytes(STUDY.format("").replace("\n", "\r\n").encode("utf-16"))
    message = "it is not UTF-8 text. Save it as UTF-8; in PowerShell write it with -o FILE, not >."
    assert told(read_content, file) == f"file: {message}"
    file.write_bytes("title = 'Sch\u00fcttgut'".encode("latin-1"))
    assert told(read_content, file) == "file: it is not UTF-8 text. Save it as UTF-8."


@pytest.mark.parametrize(
    ("kind", "line", "words"),
    [
        ("simulate", "drive = { file = 'data\\x.csv', along = 'a' }", SLASHES),
        ("simulate", 'drive = { file = "data\\new.csv", along = "a" }', SLASHES),
        ("calibrate", "observations = 'data\\x.csv'", SLASHES),
        ("sensitivity", "uncertain = { friction = { calibration = 'data\\x.nc' } }", SLASHES),
        ("simulate", "drive = { file = 'data/x.csv', along = 'a' }", "Name a CSV file by its path"),
    ],
)
def test_a_missing_file_with_backslashes_is_told_of_the_separator(tmp_path, kind, line, words):
    file = tmp_path / "study.toml"
    file.write_text(STUDY.format(line).replace("simulate", kind))
    assert words in told(load_study, file)
