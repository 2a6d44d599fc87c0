"""`vibrafeed new`, as a user runs it: answers in, a study out that runs."""

import inspect
import tomllib
from pathlib import Path

import pytest

from commands import run, said, tells
from vibrafeed.app.cli.new import new
from vibrafeed.app.cli.questions import QUESTIONS
from vibrafeed.app.cli.starter import STARTERS
from vibrafeed.core.intake import load_study, prepare_content, read_toml
from vibrafeed.core.study.unusual import questions

OF_PARTS = ["--part rectangle", "--part rectangle --track bowl", "--part cylinder"]
STARTED = [
    f"--question {question} {part}"
    for question in STARTERS
    for part in {"springs": OF_PARTS[::2], "which-way": [""]}.get(question, OF_PARTS)
]


@pytest.fixture
def terminal(monkeypatch):
    """Let the command believe that somebody answers."""
    monkeypatch.setattr("vibrafeed.app.cli.new.is_terminal", lambda: True)


@pytest.mark.parametrize("words", STARTED)
def test_every_starter_is_a_sound_study_of_usual_numbers(words):
    text = run(f"new - {words}").stdout
    content = read_toml(text)
    prepared = prepare_content(content)
    assert prepared.cells == (41 if "springs" in words else 1)
    assert questions(content) == []
    assert text.count("#") >= 10


def test_a_starter_runs_as_it_is():
    assert "Next: vibrafeed run mine.toml" in said("new mine.toml --yes")
    assert "vibrafeed run mine.toml" in Path("mine.toml").read_text()
    assert "conveying_velocity" in said("run mine.toml")
    run("new mine.toml --yes --force")


def test_options_answer_questions():
    run(
        "new bowl.toml --question speed --track bowl --frequency '6000 rpm' "
        "--peak-to-peak '0.4 mm' --friction 0.25 --climb -1"
    )
    parameters = tomllib.loads(Path("bowl.toml").read_text())["parameters"]
    expected = {"frequency": "6000 rpm", "peak_to_peak": "0.4 mm", "friction": 0.25, "gamma": -1}
    assert parameters | expected == parameters
    assert "amplitude" not in parameters
    assert load_study("bowl.toml").scene == "rectangle-on-track"


def test_somebody_at_a_terminal_is_asked_and_asked_again(terminal):
    answers = ["how", "speed", "block", "", "", "fifty", "60 m", "60 Hz", "", "", "0.4", "30 mm"]
    tells(
        "new study.toml",
        "'how' is not one of the answers. "
        "Please answer speed or drive or forces or springs or which-way.",
        "'fifty' is not a number with a unit. Write frequency = ",
        "'m' does not measure frequency.",
        "how fast a part travels",
        input="\n".join(answers) + "\n",
    )
    assert tomllib.loads(Path("study.toml").read_text())["parameters"] == {
        "gamma": "2 deg", "frequency": "60 Hz", "amplitude": "0.3 mm", "beta": "20 deg",
        "friction": 0.4, "length": "30 mm",
    }  # fmt: skip


def test_an_unusual_answer_is_asked_about_once(terminal):
    answers = ["speed", "", "", "", "", "0.5", "0.3 mm", "", "3", "3", ""]
    result = run("new -", input="\n".join(answers) + "\n")
    assert "amplitude = 0.5 means 500 mm; usual values are 0.0001 to 25 mm. Did" in result.stderr
    assert 'amplitude = "0.3 mm"' in result.stdout
    assert "friction = 3\n" in result.stdout  # said twice, it is meant


def test_what_an_option_answers_is_not_asked(terminal):
    keep = ("question", "part", "track", "climb", "frequency", "angle", "friction", "length")
    given = [f"--{q.name} '{q.default}'" for q in QUESTIONS if q.asks and q.name in keep]
    assert 'amplitude = "0.25 mm"' in said(f"new - {' '.join(given)}", input="0.25 mm\n")


def test_every_question_has_its_option():
    options = set(inspect.signature(new).parameters) - {"context", "file", "kind", "yes", "force"}
    assert options == {question.name for question in QUESTIONS}
    assert all(question.parameter or question.choices for question in QUESTIONS)


@pytest.mark.parametrize("path", ["line", "ellipse"])
@pytest.mark.parametrize("hop", ["yes", "no"])
@pytest.mark.parametrize("known", ["well", "roughly"])
def test_wishes_about_the_best_drive_are_in_the_study(path, hop, known):
    words = f"new - --question drive --path {path} --hop {hop} --known {known} --yes"
    content = read_toml(run(f"{words} --peak-to-peak '0.7 mm'").stdout)
    assert prepare_content(content).cells == 1
    variables, fixed = content["variables"], content["parameters"]
    largest = {one["upper"] for name, one in variables.items() if name.startswith("amplitude")}
    # Who wants no hop wants a smaller amplitude, too: it is chosen.
    is_chosen = path == "ellipse" or hop == "no"
    assert largest == ({"0.35 mm"} if is_chosen else set())
    assert ("amplitude" in variables) == (path == "line" and hop == "no")
    assert ("peak_to_peak" in fixed) == (not is_chosen)
    bounds = [{"output": "throw_number", "upper": 1}]
    assert content.get("constraints") == (None if hop == "yes" else bounds)
    assert ("friction" in fixed) == (known == "well")
    assert content.get("robust") == (None if known == "well" else "worst")
