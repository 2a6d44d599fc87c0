"""`vibrafeed report`: error against run time of studies, as a page, pictures and datasets."""

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED
from vibrafeed.app.cli.studies import interruption, prepare_all, refuse, refuse_clashes
from vibrafeed.core.errors import StudyError

if TYPE_CHECKING:
    from vibrafeed.core.plan.prepared import Prepared


def report(
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Study files (TOML or JSON) whose error is measured.", show_default=False
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="Folder for the report; by default `accuracy` in the folder of the first study.",
        ),
    ] = None,
    seconds: Annotated[
        float,
        typer.Option(
            help="Time limit for each study in seconds; no setting is measured after it.",
            min=0,
        ),
    ] = 60.0,
) -> None:
    """Measure the error of each study over its run time; write a page, pictures and datasets.

    On random cells of the study, closed forms in 32-bit and 64-bit floats are compared with
    extended precision, and motions at several tolerances with the method `reference`. Exit code 2
    means that a study file is wrong, 1 that a result could not be written or that the report was
    stopped by Ctrl-C; finished studies are written.
    """
    from vibrafeed.core.report import check

    studies = prepare_all(files)
    invalid = {}
    for path, prepared in studies.items():
        try:
            check(prepared)
        except StudyError as error:
            invalid[path] = error.problems
    if invalid:
        refuse(invalid)
    folder = output or files[0].parent / "accuracy"
    targets = {path: folder / f"accuracy-{path.stem}.nc" for path in studies}
    refuse_clashes(targets)
    with interruption() as interrupted:
        try:
            written = _write(studies, targets, seconds, interrupted)
        except OSError as error:
            console.fail(f"{error.filename or folder}: {error.strerror or error}.")
            raise typer.Exit(FAILED) from None
    for path in written:
        typer.echo(f"wrote {path}")
    if interrupted():
        raise typer.Exit(FAILED)


def _write(
    studies: "Mapping[Path, Prepared]",
    targets: Mapping[Path, Path],
    seconds: float,
    stopped: Callable[[], bool],
) -> list[Path]:
    """Measure studies and write dataset and picture of each, and the page; return their paths."""
    from vibrafeed.app.jobs.accuracy import PAGE, draw
    from vibrafeed.core.dataset.files import whole
    from vibrafeed.core.dataset.netcdf import write_netcdf
    from vibrafeed.core.report import measure
    from vibrafeed.core.watch import Watch

    written: list[Path] = []
    sections: list[str] = []
    for path, prepared in studies.items():
        if stopped():
            break
        target = targets[path]
        target.parent.mkdir(parents=True, exist_ok=True)
        with console.progress(path.name) as advance:
            watch = Watch(advance, stopped, time.monotonic() + seconds)
            report = measure(prepared, watch)
        write_netcdf(report.table(prepared).with_history(f"vibrafeed report {path}"), target)
        picture = draw(target, target.with_suffix(".png"), console.fail)
        written += [target, *([picture] if picture else [])]
        title = prepared.study.title or prepared.plan.scene.title
        sections.append(report.section(str(path), title, picture.name if picture else None))
        page = target.parent / PAGE
        with whole(page) as temporary:  # whatever becomes of the next study
            temporary.write_text(report.page(sections), encoding="utf-8")
    return [*written, page] if sections else []
