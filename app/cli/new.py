"""`vibrafeed new`: a starter study, from a few answers."""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from vibrafeed.app.cli.questions import QUESTIONS, Question
from vibrafeed.app.cli.studies import STANDARD, refuse, refuse_existing, warn, write_text
from vibrafeed.core.errors import Problem
from vibrafeed.core.kinds import KINDS

_BY_NAME = {question.name: question for question in reversed(QUESTIONS)}  # the first of a name
Answer = str | None


def _option(name: str) -> Any:
    """Return the command-line option for a question of `vibrafeed new`, with its help.

    `name` is that of the question; giving the option answers it beforehand.
    """
    question = _BY_NAME[name]
    words = ", ".join(question.choices)
    return typer.Option(
        help=f"{question.asks or question.says} {words}".strip().removesuffix("."),
        show_default=question.default or False,
    )


def new(
    context: typer.Context,
    file: Annotated[
        Path, typer.Argument(help="Study file to write; - writes the study to standard output.")
    ] = Path("study.toml"),
    kind: Annotated[
        str | None,
        typer.Option(
            help=f"Write the example study of this kind and ask no questions: {', '.join(KINDS)}."
        ),
    ] = None,
    question: Annotated[Answer, _option("question")] = None,
    path: Annotated[Answer, _option("path")] = None,
    hop: Annotated[Answer, _option("hop")] = None,
    known: Annotated[Answer, _option("known")] = None,
    part: Annotated[Answer, _option("part")] = None,
    track: Annotated[Answer, _option("track")] = None,
    radius: Annotated[Answer, _option("radius")] = None,
    lean: Annotated[Answer, _option("lean")] = None,
    climb: Annotated[Answer, _option("climb")] = None,
    frequency: Annotated[Answer, _option("frequency")] = None,
    amplitude: Annotated[Answer, _option("amplitude")] = None,
    peak_to_peak: Annotated[Answer, _option("peak_to_peak")] = None,
    angle: Annotated[Answer, _option("angle")] = None,
    moving_mass: Annotated[Answer, _option("moving_mass")] = None,
    base_mass: Annotated[Answer, _option("base_mass")] = None,
    rings: Annotated[Answer, _option("rings")] = None,
    damping: Annotated[Answer, _option("damping")] = None,
    pull: Annotated[Answer, _option("pull")] = None,
    tilt: Annotated[Answer, _option("tilt")] = None,
    load: Annotated[Answer, _option("load")] = None,
    friction: Annotated[Answer, _option("friction")] = None,
    length: Annotated[Answer, _option("length")] = None,
    height: Annotated[Answer, _option("height")] = None,
    diameter: Annotated[Answer, _option("diameter")] = None,
    mass: Annotated[Answer, _option("mass")] = None,
    width: Annotated[Answer, _option("width")] = None,
    wiper: Annotated[Answer, _option("wiper")] = None,
    wanted: Annotated[Answer, _option("wanted")] = None,
    arrivals: Annotated[Answer, _option("arrivals")] = None,
    yes: Annotated[
        bool,
        typer.Option(
            "--yes",
            "-y",
            help="Ask no questions: use the default for every option that is not given.",
        ),
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Write a commented study to start from, after a few questions.

    On a terminal it asks for everything that no option gives; elsewhere, and with --yes, it uses
    the defaults. The study can be run as it is. Exit code 2 means that an answer is wrong or the
    file exists already, 1 that it could not be written.
    """
    from vibrafeed.app.cli.starter import example_study, starter_study

    _check_name(file, force)
    answers = {name: context.params[name] for name in _BY_NAME if context.params[name] is not None}
    name = str(file) if file != STANDARD else "study.toml"
    if kind is not None:
        _check_kind(kind, answers)
        text = example_study(kind, name)
    else:
        text = starter_study(_collect_answers(answers, asks=is_terminal() and not yes), name)
    if file == STANDARD:
        typer.echo(text, nl=False)
        return
    write_text(file, text)
    typer.echo(f"wrote {file}. Next: vibrafeed run {file}")


def is_terminal() -> bool:
    """True if standard input is a terminal, so that a person can be asked."""
    return sys.stdin.isatty()


def _check_name(file: Path, force: bool) -> None:
    """Exit if the new study would be a JSON file, or would replace an existing file.

    `force` allows replacing one.
    """
    if file.suffix.lower() == ".json":
        fix = f"Name the file {file.stem}.toml; `vibrafeed convert` makes JSON of it later"
        refuse(
            {file: [Problem("file", "a new study has comments, which JSON does not allow", fix)]}
        )
    if file != STANDARD:
        refuse_existing(str(file), str(file), force=force)


def _check_kind(kind: str, answers: Mapping[str, str]) -> None:
    """Exit if a kind of study is unknown, or if answers were given, which its example does not use.

    `kind` is the option of `vibrafeed new`; `answers` are those given as options, by question.
    """
    from vibrafeed.core.suggestions import suggestion

    message = "this option has no effect together with --kind"
    problems = [Problem(_flag(name), message, f"Remove {_flag(name)}") for name in answers]
    if kind not in KINDS:
        fix = suggestion(kind, KINDS)
        problems.insert(0, Problem("--kind", f"'{kind[:40]}' is not a kind of study", fix))
    if problems:
        refuse({Path("new"): problems})


def _collect_answers(options: dict[str, str], *, asks: bool) -> dict[str, str]:
    """Return the answers to all questions that apply, by name; print every invalid option and exit.

    `options` has the answers given on the command line, by question. With `asks`, a person is asked
    the other questions; else their defaults are taken.
    """
    from vibrafeed.core.study.units import UnitError

    answers: dict[str, str] = {}
    problems, warnings = [], []
    for question in QUESTIONS:
        if question.name in answers or not question.belongs(answers):
            continue
        if question.name in options:
            try:
                answers[question.name] = question.read(options[question.name])
                warnings.append(question.warning(answers[question.name]))
            except UnitError as error:
                problems.append(Problem(_flag(question.name), error.message, error.fix))
                if question.choices:  # which other questions apply depends on it
                    break
        elif question.asks and asks and not problems:
            answers[question.name] = _ask(question)
        elif question.asks:
            answers[question.name] = question.default
    else:  # no invalid choice
        if not problems:
            problems = [
                _problem_of_unused(name, answers) for name in options if name not in answers
            ]
    if problems:
        refuse({Path("new"): problems})
    warn("new", filter(None, warnings))
    return answers


def _ask(question: Question) -> str:
    """Ask a person a question until the answer is valid, and return the answer.

    An unusual value is questioned once: it is taken when typed again.
    """
    from vibrafeed.core.study.units import UnitError

    width = max(map(len, question.choices), default=0)
    if question.sketch:
        typer.echo(question.sketch)
    if question.choices:
        typer.echo(question.asks)
        for word, meaning in question.choices.items():
            typer.echo(f"  {word:{width}}  {meaning}")
    before = ""
    while True:
        typed = typer.prompt("Answer" if question.choices else question.asks, question.default)
        try:
            text = question.read(typed)
        except UnitError as error:
            typer.echo(f"  {error}{'' if error.fix.endswith('?') else '.'}", err=True)
            continue
        warning = question.warning(text)
        if not warning or typed == before:
            return text
        typer.echo(f"  {warning}", err=True)
        before = typed


def _problem_of_unused(name: str, answers: dict[str, str]) -> Problem:
    """Return the problem of an option that was given although its question does not apply.

    `name` is that of the question; `answers` are those to the questions that apply.
    """
    question = _BY_NAME[name]
    if question.unless in answers:
        message = f"{_flag(name)} and {_flag(question.unless)} give the same quantity"
        return Problem(_flag(name), message, "Remove one of the two options")
    unmet = {
        other: words.split()
        for other, words in question.needs.items()
        if answers.get(other) not in words.split()
    }
    needs = " and ".join(f"{_flag(other)} {' or '.join(words)}" for other, words in unmet.items())
    given = " and ".join(f"{_flag(other)} {answers[other]}" for other in unmet if other in answers)
    return Problem(
        _flag(name),
        f"{_flag(name)} applies only with {needs}" + f", not with {given}" * bool(given),
        f"Give {needs}, or remove {_flag(name)}",
    )


def _flag(name: str) -> str:
    return "--" + name.replace("_", "-")
