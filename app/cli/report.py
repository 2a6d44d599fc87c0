"""`vibrafeed report`: the accuracy report, error against run time."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED
from vibrafeed.app.cli.studies import interruption, prepare_all, refuse, refuse_clashes
from vibrafeed.core.errors import Problem, StudyError


def report(
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Study files (TOML or JSON) to measure the accuracy of.", show_default=False
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="Folder for the report; by default `accuracy` in the folder of the first study.",
        ),
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option(
            help="Measure only this family: closed_forms, model, motion, storage or "
            "optimisers; repeat the option for several. By default all families that "
            "apply to a study."
        ),
    ] = None,
    extremes: Annotated[
        bool,
        typer.Option(
            "--extremes",
            help="Also run about 200 hard cases, and list the equations, memory and program "
            "modules that a study of one output of each scene needs.",
        ),
    ] = False,
    seconds: Annotated[
        float,
        typer.Option(
            help="Time limit of each family in seconds: after it no further measurement starts.",
            min=0,
        ),
    ] = 60.0,
) -> None:
    """Measure accuracy and run time of methods; write a page, pictures and datasets.

    Closed forms against 50 digits, methods of motion, optimisers and files, each on random cells of
    the study. Exit code 2 means that a study file is wrong, 1 that a result could not be written,
    that a hard case came out wrong, or that it was stopped by Ctrl-C: what was measured by then is
    written.
    """
    from vibrafeed.app.cli.accuracy import EXTREMES, dataset_of, write_report
    from vibrafeed.core.assurance.accuracy.families import families_of

    files = files or []
    if not files and not extremes:
        fix = "Name study files, or add --extremes, which needs no study"
        refuse({Path("report"): [Problem("files", "the command names no study to measure", fix)]})
    studies = prepare_all(files)
    invalid = {}
    for path, prepared in studies.items():
        try:
            families_of(prepared, only or ())
        except StudyError as error:
            invalid[path] = error.problems
    if invalid:
        refuse(invalid)
    beside = files[0].parent if files else Path()
    folder = output or beside / "accuracy"
    refuse_clashes(
        {file: dataset_of(folder, file.stem) for file in files},
        taken=[dataset_of(folder, name) for name in EXTREMES] if extremes else (),
    )
    with interruption() as interrupted:
        try:
            written, right = write_report(
                studies, folder, only or (), seconds, interrupted, extremes
            )
        except OSError as error:
            console.fail(f"{error.filename or folder}: {error.strerror or error}.")
            raise typer.Exit(FAILED) from None
    for path in written:
        typer.echo(f"wrote {path}")
    if interrupted() or not right:
        raise typer.Exit(FAILED)
