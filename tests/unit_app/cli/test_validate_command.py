"""`vibrafeed validate`: tables, files, the problems, another program's answers, exit codes."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

from vibrafeed.app.cli import app


def run(*words, code=0):
    result = CliRunner().invoke(app, ["validate", *map(str, words)])
    assert result.exit_code == code, result.output
    return result


def test_a_family_is_listed_problem_by_problem():
    lines = run("--family", "W", "--random", 1).stdout.splitlines()
    assert [line.split()[0] for line in lines] == [
        "problem", "W-winkler-1", "W-winkler-2", "W-winkler-r1.1", "vibrafeed",
    ]  # fmt: skip
    assert "3.32687" in lines[1]
    assert lines[-1].endswith("all of 3 problems are right.")


def test_the_problems_are_a_document(tmp_path):
    file = tmp_path / "problems.json"
    said = run("--problems", "--family", "W,Q", "--random", 0, "-o", file).stdout
    assert said.endswith("5 problems\n")
    told = json.loads(file.read_text(encoding="utf-8"))
    assert told["format"] == "vibrafeed-validation-1"
    assert {problem["family"] for problem in told["problems"]} == {"Q", "W"}
    assert json.loads(run("--problems", "--family", "W", "--random", 0).stdout)["not_claimed"]


@pytest.mark.parametrize(
    ("name", "begins"),
    [("all.md", "# Validation"), ("all.json", '{\n  "format": "vibrafeed-outcomes-1"'),
     ("all.txt", "family")],
)  # fmt: skip
def test_the_suffix_of_a_file_tells_its_form(tmp_path, name, begins):
    file = tmp_path / name
    said = run("--family", "M", "--random", 0, "-o", file).stdout
    assert "problems are right" in said
    text = file.read_text(encoding="utf-8")
    assert text.startswith(begins)
    assert "M-ellipse-1" in text
    refused = run("--family", "M", "-o", file, code=2)
    assert "the file exists already" in refused.stderr
    run("--family", "M", "--random", 0, "-o", file, "--force")


def test_answers_of_another_program_are_judged(tmp_path):
    file = tmp_path / "answers.json"
    content = {"format": "vibrafeed-answers-1", "program": "Another 1",
               "answers": {"Q-two-levels-1": 15.882857}}  # fmt: skip
    file.write_text(json.dumps(content), encoding="utf-8")
    assert "Another 1: all of 1 problems are right." in run("--answers", file).stdout
    content["answers"]["W-winkler-1"] = 3.0
    file.write_text(json.dumps(content), encoding="utf-8")
    said = run("--answers", file, code=1).stdout
    assert "Another 1: 1 of 2 problems are wrong." in said
    assert "W-winkler-1" in said
    told = json.loads(run("--answers", file, "--format", "json", code=1).stdout)
    assert (told["judged"], told["right"]) == (2, 1)
    assert (
        "the file of --answers has no answer to a problem of the requested families"
        in run("--answers", file, "--family", "Z", code=2).stderr
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--family", "K"), "'K' is not a family. Known: Q"),
        (
            ("--problems", "--format", "text"),
            "--problems writes problems as JSON and judges no answers",
        ),
        (("--answers", "nothing.json"), "No such file"),
        (("--random", -1), "--random"),
    ],
)
def test_wrong_usage_is_told_by_code_2(words, said):
    assert said in run(*words, code=2).stderr
