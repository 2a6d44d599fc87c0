"""Studies as they come from a Windows desk: paths with backslashes, UTF-16, decimal commas."""

from __future__ import annotations

import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import load_study, read_content, read_toml
from vibrafeed.core.intake.section import advice_on_path

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


def test_other_syntax_errors_have_their_own_advice():
    assert "texts, such as" in told(read_toml, "path = 'C:\\Users\\anna'\nbeta = 20 deg\n")


@pytest.mark.parametrize("line", ["friction = 0,3", "a = { start = 0.1, stop = 0,3 }", "b=-0,3 mm"])
def test_a_decimal_comma_is_named(line):
    message = told(read_toml, f"[parameters]\n{line}\n")
    assert "line 2: the number " in message
    assert "0,3 has a decimal comma. Write " in message


def test_utf_16_is_what_powershell_writes(tmp_path):
    file = tmp_path / "study.toml"
    file.write_bytes(STUDY.format("").replace("\n", "\r\n").encode("utf-16"))
    message = "it is not UTF-8 text. Save it as UTF-8; in PowerShell write it with -o FILE, not >."
    assert told(read_content, file) == f"file: {message}"
    file.write_bytes("title = 'Sch\u00fcttgut'".encode("latin-1"))
    assert told(read_content, file) == "file: it is not UTF-8 text. Save it as UTF-8."


@pytest.mark.parametrize(
    "line",
    [
        "drive = { file = 'data\\x.csv', along = 'a' }",
        'drive = { file = "data\\new.csv", along = "a" }',
        "drive = { file = 'C:\\Users\\anna\\x.csv', along = 'a' }",
        "kind_ = 1\nobservations = 'data\\x.csv'",
        "uncertain = { friction = { calibration = 'data\\x.nc' } }",
    ],
)
def test_a_missing_file_with_backslashes_is_told_of_the_separator(tmp_path, line):
    kind = {"observations": "calibrate", "uncertain": "sensitivity"}
    text = STUDY.format(line.replace("kind_ = 1\n", ""))
    for word, other in kind.items():
        if word in line:
            text = text.replace("simulate", other)
    file = tmp_path / "study.toml"
    file.write_text(text)
    assert SLASHES in told(load_study, file)


def test_a_plain_missing_file_has_the_advice_of_its_section(tmp_path):
    assert advice_on_path("data/x.csv", "Name a CSV") == "Name a CSV"
    file = tmp_path / "study.toml"
    file.write_text(STUDY.format("drive = { file = 'data/x.csv', along = 'a' }"))
    assert "Name a CSV file by its path" in told(load_study, file)
