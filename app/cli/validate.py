"""`vibrafeed validate`: what is known to be true, and what this program, or another, answers."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from vibrafeed import core
from vibrafeed.app.cli import console
from vibrafeed.app.cli.console import plain_lines
from vibrafeed.app.cli.options import FAILED
from vibrafeed.app.cli.studies import interruption, refuse, refuse_taken, write_text
from vibrafeed.core.errors import Problem, StudyError

if TYPE_CHECKING:
    from vibrafeed.core.assurance.answers import ProgramAnswers
    from vibrafeed.core.assurance.case import Case
    from vibrafeed.core.assurance.judge import Outcome

COMMAND = Path("validate")  # what problems are said to be of


class Form(StrEnum):
    """The formats of outcomes."""

    TEXT = "text"
    JSON = "json"
    MARKDOWN = "markdown"


SUFFIXES = {".json": Form.JSON, ".md": Form.MARKDOWN}


def validate(
    family: Annotated[
        list[str] | None,
        typer.Option(
            help="Letters of the families of problems to solve, such as Q or Q,W, whose "
            "problems are then listed one by one; by default all families."
        ),
    ] = None,
    form: Annotated[
        Form | None,
        typer.Option(
            "--format",
            help="Format of the report: text, json or markdown; by default given by the "
            "suffix of -o, else text.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="Write the report to this file; by default to standard output."
        ),
    ] = None,
    random: Annotated[
        int,
        typer.Option(
            min=0,
            max=10_000,
            help="Number of problems with random inputs to add for each form of problem.",
        ),
    ] = 20,
    seed: Annotated[
        int,
        typer.Option(
            min=0, max=10**9 - 1, help="Seed of the random inputs: equal seeds give equal problems."
        ),
    ] = 1,
    problems: Annotated[
        bool, typer.Option("--problems", help="Write the problems as JSON without solving them.")
    ] = False,
    answers: Annotated[
        Path | None,
        typer.Option(
            help="JSON file with another program's answers to these problems, which are "
            "judged by the "
            "same tolerances.",
            show_default=False,
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file.")] = False,
) -> None:
    """Solve problems with known results, and report the errors.

    Anchors from the literature, limits, laws that any drive keeps, a measured set, worked values:
    docs/validation.md. Exit code 1 means that an answer is wrong, 2 that an option or a file is.
    """
    from vibrafeed.core.assurance import catalogue
    from vibrafeed.core.assurance.tables import document, markdown, sentence

    if problems and (answers or form in (Form.TEXT, Form.MARKDOWN)):
        fix = "Leave --answers and --format out"
        _refuse(
            [Problem("problems", "--problems writes problems as JSON and judges no answers", fix)]
        )
    if output:
        refuse_taken(output, "output", force=force)
    try:
        letters = catalogue.families_of(family or ())
        theirs = _read(answers) if answers else None
    except StudyError as error:
        _refuse(error.problems, answers)
    if problems:
        found = catalogue.cases(letters, random, seed)
        _write(catalogue.document(found), output)
        if output:
            console.say(f"wrote {output}: {len(found):,} problems")
        return
    if theirs is None:
        outcomes, program = _own_outcomes(catalogue.cases(letters, random, seed))
    else:
        outcomes, program = _outcomes_of_other_program(theirs, letters)
    form = form or (SUFFIXES.get(output.suffix.lower()) if output else None) or Form.TEXT
    if form is Form.JSON:
        _write(document(outcomes, program), output)
    elif form is Form.MARKDOWN or output:
        page = (markdown if form is Form.MARKDOWN else _outcomes_as_text)(outcomes, program)
        if output:
            write_text(output, page)
        else:
            typer.echo(page, nl=False)
    else:
        _print_outcomes(outcomes, program, listed=bool(family))
    if output:
        console.say(sentence(outcomes, program))
        console.say(f"wrote {output}")
    if not all(outcome.passed for outcome in outcomes):
        raise typer.Exit(FAILED)


def _read(path: Path) -> ProgramAnswers:
    """Return the answers of another program from a file."""
    from vibrafeed.core.assurance.answers import read_answers

    return read_answers(path)


def _own_outcomes(problems: Sequence[Case]) -> tuple[list[Outcome], str]:
    """Solve validation problems with this program; return the outcomes and the program's name.

    Exit if that was stopped by Ctrl-C.
    """
    from vibrafeed.core.assurance.judge import run_cases
    from vibrafeed.core.watch import Watch

    with console.progress("validate") as advance, interruption() as interrupted:
        outcomes = run_cases(problems, Watch(advance, interrupted))
    if len(outcomes) < len(problems):
        console.fail(
            f"The check was stopped after {len(outcomes):,} of {len(problems):,} problems."
        )
        raise typer.Exit(FAILED)
    return outcomes, f"vibrafeed {core.__version__}"


def _outcomes_of_other_program(
    program: ProgramAnswers, letters: Sequence[str]
) -> tuple[list[Outcome], str]:
    """Return the outcomes of another program's answers, judged by our tolerances, and its name.

    `letters` are the families of problems that count. Exit if the program answers none of them.
    """
    from vibrafeed.core.assurance.judge import judge_results

    asked = [problem for problem in program.cases if problem.family in letters]
    if not asked:
        fix = f"Families that it answers: {', '.join(sorted({p.family for p in program.cases}))}"
        _refuse(
            [
                Problem(
                    "family",
                    "the file of --answers has no answer to a problem of the requested families",
                    fix,
                )
            ]
        )
    return judge_results(asked, program.values), program.program


def _print_outcomes(outcomes: Sequence[Outcome], program: str, *, listed: bool) -> None:
    """Print outcomes: one row per family and the failed ones, or each problem if `listed`.

    `program` is the name of the program that solved the problems.
    """
    from vibrafeed.core.assurance.judge import summaries
    from vibrafeed.core.assurance.tables import COLUMNS, FAMILY_COLUMNS, family_rows, rows, sentence

    failed = [outcome for outcome in outcomes if not outcome.passed]
    if listed:
        console.table((*COLUMNS,), rows(outcomes))
    else:
        console.table(FAMILY_COLUMNS, family_rows(summaries(outcomes)))
        if failed:
            console.table((*COLUMNS,), rows(failed))
    console.say(sentence(outcomes, program))
    if not listed:
        console.tell(
            "--family Q lists the problems of a family; -o validation.md writes all of them."
        )


def _outcomes_as_text(outcomes: Sequence[Outcome], program: str) -> str:
    """Return outcomes of validation as plain lines of text: a row per family, then every problem.

    `program` is the name of the program that solved the problems.
    """
    from vibrafeed.core.assurance.judge import summaries
    from vibrafeed.core.assurance.tables import COLUMNS, FAMILY_COLUMNS, family_rows, rows, sentence

    families = plain_lines(FAMILY_COLUMNS, family_rows(summaries(outcomes)))
    lines = [
        *families,
        "",
        *plain_lines((*COLUMNS,), rows(outcomes)),
        "",
        sentence(outcomes, program),
    ]
    return "\n".join(lines) + "\n"


def _write(content: object, output: Path | None) -> None:
    """Write a JSON document (`content`) to a file, or to standard output if `output` is None.

    If the file cannot be written, the reason is printed and the program exits.
    """
    if output is None:
        console.document(content)
    else:
        write_text(output, console.as_json(content) + "\n")


def _refuse(problems: Sequence[Problem], file: Path | None = None) -> NoReturn:
    """Print problems of the answers file or of the options, and exit."""
    refuse({file or COMMAND: list(problems)})
