"""`vibrafeed new`, as a user runs it: answers in, a study out that runs."""

from __future__ import annotations

import inspect
import itertools
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from vibrafeed.app.cli import app
from vibrafeed.app.cli.new import new
from vibrafeed.app.cli.questions import QUESTIONS
from vibrafeed.app.cli.starter import STARTERS, starter_study
from vibrafeed.core.intake import load_study, prepare_content, read_toml
from vibrafeed.core.study.unusual import questions

KINDS = ("rectangle", "straight"), ("rectangle", "bowl"), ("cylinder", "")


def command(*arguments: object, **more):
    return CliRunner().invoke(app, ["new", *map(str, arguments)], **more)


@pytest.fixture
def terminal(monkeypatch):
    """Let the command believe that somebody answers."""
    monkeypatch.setattr("vibrafeed.app.cli.new.is_terminal", lambda: True)


@pytest.mark.parametrize(("question", "kind"), [*itertools.product(STARTERS, KINDS)])
def test_every_starter_is_a_sound_study_of_usual_numbers(question, kind):
    part, track = kind
    words = ["-", "--question", question, "--part", part, *(["--track", track] if track else [])]
    if question == "springs":  # the unit of a bowl has other parameters
        words = words[:5]
    if question == "which-way":  # a block, without a track
        words = words[:3]
    result = command(*words)
    assert result.exit_code == 0, result.output
    content = read_toml(result.stdout)
    prepared = prepare_content(content)
    assert prepared.cells == (41 if question == "springs" else 1)
    # Some three on a quiet machine; prices are of this one, which a dozen busy processes may share.
    assert prepared.seconds < 60
    assert questions(content) == []
    commented = [line for line in result.stdout.splitlines() if "#" in line]
    assert len(commented) >= 10
    assert max(map(len, result.stdout.splitlines())) <= 130


def test_a_starter_runs_as_it_is(tmp_path):
    study = tmp_path / "study.toml"
    written = command(study, "--yes")
    assert written.exit_code == 0, written.output
    assert f"Next: vibrafeed run {study}" in " ".join(written.stdout.split("\n")).replace("  ", " ")
    done = CliRunner().invoke(app, ["run", str(study)])
    assert done.exit_code == 0, done.output
    assert "conveying_velocity" in done.output
    assert study.with_suffix(".nc").exists()


def test_options_answer_questions(tmp_path):
    path = tmp_path / "bowl.toml"
    result = command(
        path, "--question", "speed", "--track", "bowl", "--frequency", "6000 rpm",
        "--peak-to-peak", "0.4 mm", "--friction", "0.25", "--climb", -1,
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    parameters = tomllib.loads(path.read_text())["parameters"]
    assert parameters["frequency"] == "6000 rpm"
    assert parameters["peak_to_peak"] == "0.4 mm"
    assert parameters["friction"] == 0.25
    assert parameters["gamma"] == -1
    assert "amplitude" not in parameters
    assert load_study(path).scene == "rectangle-on-track"


def test_somebody_at_a_terminal_is_asked_and_asked_again(terminal, tmp_path):
    path = tmp_path / "study.toml"
    answers = ["how", "speed", "block", "", "", "fifty", "60 m", "60 Hz", "", "", "0.4", "30 mm"]
    result = command(path, input="\n".join(answers) + "\n")
    assert result.exit_code == 0, result.output
    assert (
        "'how' is not one of the answers. "
        "Please answer speed or drive or forces or springs or which-way." in result.output
    )
    assert "'fifty' is not a number with a unit. Write frequency = " in result.output
    assert "'m' does not measure frequency." in result.output
    assert "how fast a part travels" in result.output
    assert tomllib.loads(path.read_text())["parameters"] == {
        "gamma": "2 deg", "frequency": "60 Hz", "amplitude": "0.3 mm", "beta": "20 deg",
        "friction": 0.4, "length": "30 mm",
    }  # fmt: skip


def test_an_unusual_answer_is_asked_about_once(terminal):
    answers = ["speed", "", "", "", "", "0.5", "0.3 mm", "", "3", "3", ""]
    result = command("-", input="\n".join(answers) + "\n")
    assert result.exit_code == 0, result.output
    assert "amplitude = 0.5 means 500 mm; usual values are 0.0001 to 25 mm. Did" in result.stderr
    assert 'amplitude = "0.3 mm"' in result.stdout
    assert "friction = 3\n" in result.stdout  # said twice, it is meant
    given = command("-", "--amplitude", "0.5", "--yes")
    assert 'Did you mean "0.5 mm"?' in given.stderr
    assert "amplitude = 0.5\n" in given.stdout


def test_what_an_option_answers_is_not_asked(terminal):
    words = [word for q in QUESTIONS if q.asks for word in (f"--{q.name}", q.default)]
    keep = ("question", "part", "track", "climb", "frequency", "angle", "friction", "length")
    given = [w for k in range(0, len(words), 2) if words[k][2:] in keep for w in words[k : k + 2]]
    result = command("-", *given, input="0.25 mm\n")
    assert result.exit_code == 0, result.output
    assert 'amplitude = "0.25 mm"' in result.output


def test_a_file_is_replaced_when_told_to_only(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text("mine")
    refused = command(path, "--yes")
    assert refused.exit_code == 2
    assert (
        "the file exists already. Add --force to replace it, or give another name."
        in refused.stderr
    )
    assert path.read_text() == "mine"
    assert command(path, "--yes", "--force").exit_code == 0
    assert "[parameters]" in path.read_text()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--frequency", "fast", "--friction", "-1"],
         "--frequency: 'fast' is not a number with a unit."),
        (["--frequency", "fast", "--friction", "-1"], "--friction: friction is -1. It must be"),
        (["--question", "xyz"], "--question: 'xyz' is not one of the answers. Please answer speed"),
        (["--radius", "1 m"], "--radius: --radius applies only together with --track bowl."),
        (["--amplitude", "1 mm", "--peak-to-peak", "2 mm"],
         "--amplitude: --peak-to-peak gives the same quantity. Leave out"),
    ],
)  # fmt: skip
def test_wrong_options_are_all_said_at_once(tmp_path, words, message):
    result = command(tmp_path / "x.toml", *words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert not (tmp_path / "x.toml").exists()


def test_a_starter_is_toml(tmp_path):
    result = command(tmp_path / "x.json", "--yes")
    assert result.exit_code == 2
    assert "Name the file x.toml; `vibrafeed convert` makes JSON of it later." in result.stderr
    nowhere = command(tmp_path / "no" / "x.toml", "--yes")
    assert nowhere.exit_code == 1
    assert "No such file or directory" in nowhere.stderr


def test_every_question_has_its_option():
    options = set(inspect.signature(new).parameters) - {"context", "file", "kind", "yes", "force"}
    assert options == {question.name for question in QUESTIONS}
    assert all(question.parameter or question.choices for question in QUESTIONS)


def test_the_file_that_a_study_names_is_its_own():
    answers = {q.name: q.default for q in QUESTIONS if q.asks}
    assert "vibrafeed run mine.toml" in starter_study(answers, "mine.toml")
    assert Path("mine.toml").exists() is False


@pytest.mark.parametrize("path", ["line", "ellipse"])
@pytest.mark.parametrize("hop", ["yes", "no"])
@pytest.mark.parametrize("known", ["well", "roughly"])
def test_wishes_about_the_best_drive_are_in_the_study(path, hop, known):
    result = command(
        "-", "--question", "drive", "--path", path, "--hop", hop, "--known", known, "--yes"
    )
    assert result.exit_code == 0, result.output
    content = read_toml(result.stdout)
    assert prepare_content(content).cells == 1
    assert ("amplitude_normal_1" in content["variables"]) == (path == "ellipse")
    # Who wants no hop wants a smaller amplitude, too: it is chosen.
    assert ("amplitude" in content["variables"]) == (path == "line" and hop == "no")
    assert ("amplitude" in content["parameters"]) == (path == "line" and hop == "yes")
    bounds = [{"output": "throw_number", "upper": 1}]
    assert content.get("constraints") == (None if hop == "yes" else bounds)
    assert ("friction" in content["parameters"]) == (known == "well")
    assert content.get("robust") == (None if known == "well" else "worst")


def test_an_ellipse_is_as_large_as_the_stroke_that_was_given():
    result = command(
        "-", "--question", "drive", "--path", "ellipse", "--peak-to-peak", "0.7 mm", "--yes"
    )
    variables = read_toml(result.stdout)["variables"]
    assert variables["amplitude_along_1"]["upper"] == "0.35 mm"
