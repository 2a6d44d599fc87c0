"""The command line: run, plot, report, scenes, schema, serve, key.

Every command imports what it needs when it runs: `vibrafeed scenes` loads no NetCDF library.
"""

from __future__ import annotations

import errno
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from core.errors import LimitError, Problem, StudyError

if TYPE_CHECKING:
    from app.jobs.ledger import Ledger
    from app.settings import Settings
    from core.plan.prepared import Prepared

WRONG_INPUT = 2
FAILED = 1
MOST_CELLS = 100_000_000
MOST_BYTES = 8_000_000_000
ROOM = 256 * 1024  # bytes that the ledger needs to begin with, and some more

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Sweeps, motion in time and best drives of parts on vibratory feeder tracks.",
)


def main() -> None:
    """Run the command line."""
    app()


@app.command()
def run(
    files: Annotated[list[Path], typer.Argument(help="Studies, TOML or JSON.", show_default=False)],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="File (one study) or folder; beside the study if left out."
        ),
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would run, and how large it is.")
    ] = False,
    max_cells: Annotated[
        int, typer.Option(help="Largest number of cells of one study.")
    ] = MOST_CELLS,
    max_bytes: Annotated[
        int, typer.Option(help="Largest number of bytes of one study.")
    ] = MOST_BYTES,
    time_limit: Annotated[
        float | None,
        typer.Option(
            help="Seconds after which no further cell is started or verified; a sweep is computed "
            "as a whole.",
            min=0,
        ),
    ] = None,
) -> None:
    """Carry out studies and write one NetCDF file each.

    All files are checked before the first is run. Exit code 2 means that a file is wrong, 1 that
    a result could not be written, or that a study was stopped, by Ctrl-C or the time limit, while
    it was computed or verified: what was finished by then is written.
    """
    from app import report

    prepared = _prepare_all(files, cells=max_cells, bytes_=max_bytes)
    if dry_run:
        for path, sweep in prepared.items():
            report.show_plan(path, sweep)
        return
    targets = _targets(list(prepared), output)
    from core.dataset.netcdf import write_netcdf
    from core.kinds import is_whole, tabulate
    from core.watch import Watch

    deadline = None if time_limit is None else time.monotonic() + time_limit
    whole, left = True, list(prepared)
    for path, sweep in prepared.items():
        with report.progress(path.name) as advance, _interruption(sweep.study.kind) as interrupted:
            table = tabulate(sweep, Watch(advance, interrupted, deadline))
        evaluated = time.perf_counter()
        stamp = datetime.now(UTC).isoformat(timespec="seconds")
        try:
            write_netcdf(table, targets[path], history=f"{stamp} vibrafeed run {path.name}")
        except OSError as error:
            report.fail(f"{targets[path]} cannot be written: {error.strerror or error}.")
            raise typer.Exit(FAILED) from None
        written = time.perf_counter()
        seconds = float(table.price["elapsed_seconds"])
        report.show_table(path, targets[path], table, sweep.cells, seconds, written - evaluated)
        whole &= is_whole(table)
        left.remove(path)
        if interrupted():
            break
    if left:
        report.fail(f"It was stopped: not carried out are {', '.join(map(str, left))}.")
    if left or not whole:
        raise typer.Exit(FAILED)


@app.command()
def plot(
    file: Annotated[Path, typer.Argument(help="A NetCDF file that `run` wrote.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="PNG or SVG; both beside the file if left out."),
    ] = None,
    variable: Annotated[
        str | None,
        typer.Option("--variable", "-v", help="The output to draw; the first if left out."),
    ] = None,
    axes: Annotated[
        str | None,
        typer.Option(
            "--axes", "-a", help="One or two dimensions, as in beta,alpha; the longest if left out."
        ),
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option("--at", help="Value of another dimension, as in `frequency=60 Hz`."),
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(
            "--kind", "-k", help="contour, surface, line, map, trajectory, front or landscape."
        ),
    ] = None,
) -> None:
    """Draw an output with its regimes, a map of the regimes, or the course of one part."""
    from app import report

    try:
        from core.plots import PlotError, draw_file
    except ModuleNotFoundError as error:
        report.fail(f"{error.name} is missing. Install it: pip install 'vibrafeed[plot]'.")
        raise typer.Exit(FAILED) from None
    targets = [output] if output else [file.with_suffix(".png"), file.with_suffix(".svg")]
    try:
        draw_file(
            file,
            targets,
            variable=variable,
            axes=tuple(part.strip() for part in axes.split(",")) if axes else None,
            at=dict(_fixed(text) for text in at or ()),
            kind=kind,
        )
    except PlotError as error:
        _refuse({file: [error.problem]})
    except OSError as error:
        report.fail(f"{error.filename or file}: {error.strerror or error}.")
        raise typer.Exit(FAILED) from None
    for target in targets:
        typer.echo(f"wrote {target}")


@app.command("report")
def report_accuracy(
    files: Annotated[
        list[Path] | None, typer.Argument(help="Studies, TOML or JSON.", show_default=False)
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Folder; `accuracy` beside the study if left out."),
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option(
            help="A family of measurements: closed_forms, model, motion, storage or optimisers; "
            "all that a study has if left out."
        ),
    ] = None,
    extremes: Annotated[
        bool,
        typer.Option(
            "--extremes", help="Also try some 200 hard cases, and count what each scene leaves out."
        ),
    ] = False,
    seconds: Annotated[
        float, typer.Option(help="Seconds after which a family starts nothing new.", min=0)
    ] = 60.0,
) -> None:
    """Measure error against run time for studies: a page, its pictures, and datasets.

    Closed forms against 50 digits, methods of motion, optimisers and files, each on random cells
    of the study. Exit code 2 means that a file is wrong, 1 that a result could not be written, that
    a hard case came out wrong, or that it was stopped by Ctrl-C: what was measured by then is
    written.
    """
    from app.accuracy import EXTREMES, dataset_of, write_report
    from core.accuracy.report import families_of

    files = files or []
    if not files and not extremes:
        fix = "Name studies, or add --extremes, which needs none"
        _refuse({Path("report"): [Problem("files", "there is nothing to measure", fix)]})
    prepared = _prepare_all(files, cells=sys.maxsize, bytes_=sys.maxsize)
    wrong = {}
    for path, study in prepared.items():
        try:
            families_of(study, only or ())
        except StudyError as error:
            wrong[path] = error.problems
    if wrong:
        _refuse(wrong)
    beside = files[0].parent if files else Path()
    folder = output or beside / "accuracy"
    _refuse_clashes(
        {file: dataset_of(folder, file.stem) for file in files},
        taken=[dataset_of(folder, name) for name in EXTREMES] if extremes else (),
    )
    with _interruption("report") as interrupted:
        try:
            written, right = write_report(
                prepared, folder, only or (), seconds, interrupted, extremes
            )
        except OSError as error:
            from app import report

            report.fail(f"{error.filename or folder}: {error.strerror or error}.")
            raise typer.Exit(FAILED) from None
    for path in written:
        typer.echo(f"wrote {path}")
    if interrupted() or not right:
        raise typer.Exit(FAILED)


@app.command()
def scenes(
    name: Annotated[str | None, typer.Argument(help="A scene; all if left out.")] = None,
    variant: Annotated[str | None, typer.Option(help="A variant; the default if left out.")] = None,
    method: Annotated[
        str | None, typer.Option(help="Describe the motion in time by this method instead.")
    ] = None,
) -> None:
    """Print the catalogue: scenes, parameters, outputs, units, equations, validity."""
    from app import report
    from core.catalogue import describe, describe_all

    try:
        if name is None:
            report.show_scenes(describe_all())
        else:
            report.show_scene(describe(name, variant, method=method))
    except StudyError as error:
        _refuse({Path("scenes"): error.problems})


@app.command()
def schema() -> None:
    """Print the JSON Schema of studies, for editors."""
    import json

    from core.catalogue import study_schema

    typer.echo(json.dumps(study_schema(), indent=2))


@app.command()
def serve(
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="Port to listen on.", min=0, max=65535)] = 8000,
    show_settings: Annotated[
        bool, typer.Option("--show-settings", help="Print the settings in force and stop.")
    ] = False,
) -> None:
    """Serve the HTTP interface.

    Other machines are answered only where keys are set: `vibrafeed key` makes one. Exit code 2
    means that a setting is wrong, or that the data directory cannot be used.
    """
    settings = _settings()
    if show_settings:
        typer.echo(settings.model_dump_json(indent=2))
        return
    from app.guard import is_loopback

    if not settings.api_key_hashes and not is_loopback(host):
        fix = "Make a key with `vibrafeed key` and set VIBRAFEED_API_KEY_HASHES to its hash"
        message = "other machines reach it, and no keys are set"
        _refuse({Path("serve"): [Problem(f"--host {host}", message, fix)]})
    from app import logs
    from app.main import create_app
    from app.server import serve_until_stopped

    service = create_app(settings)
    _check_directory(settings.data_directory.absolute(), service.state.desk.ledger)
    logs.configure()
    serve_until_stopped(service, settings, host, port)


@app.command()
def key() -> None:
    """Make a key for the HTTP interface; print it and the hash that the service is given."""
    from app.guard import new_key

    made, digest = new_key()
    typer.echo(f"key   {made}")
    typer.echo(f"hash  {digest}")
    typer.echo(f"Set VIBRAFEED_API_KEY_HASHES={digest} for the service; commas part several.")
    typer.echo("Clients send `Authorization: Bearer KEY`. The key is kept nowhere: note it now.")


def _settings() -> Settings:
    """Return the settings in the environment, or report every wrong one and exit."""
    from pydantic import ValidationError

    from app.settings import PREFIX, Settings, unknown_variables

    wrong = unknown_variables(os.environ)
    try:
        settings = Settings()
    except ValidationError as error:
        for item in error.errors():
            name = PREFIX + ".".join(map(str, item["loc"])).upper()
            wrong.append(Problem(name, item["msg"].removeprefix("Value error, "), "Mend it"))
    if wrong:
        _refuse({Path("environment"): wrong})
    return settings


def _check_directory(directory: Path, ledger: Ledger) -> None:
    """Write a little into the data directory, or say in one line why not and exit."""
    import sqlite3
    import tempfile

    from app import report

    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory) as file:
            file.write(bytes(ROOM))
            file.flush()
            os.fsync(file.fileno())  # some disks tell only then that they are full
        with ledger.transaction():
            pass  # what can begin a change can be opened and written
    except sqlite3.DatabaseError as error:
        why, first = f"its jobs.sqlite3: {error}", "Free, mend or move that file, or set"
    except FileExistsError:
        why, first = "it is no directory", "Set"
    except OSError as error:
        is_full = error.errno in (errno.ENOSPC, errno.EDQUOT)
        why = error.strerror or str(error)
        first = f"Make room there, {ROOM:,} bytes at least, or set" if is_full else "Set"
    else:
        return
    fix = f"{first} VIBRAFEED_DATA_DIRECTORY to a directory that can be written"
    report.fail(f"The data directory {directory} cannot be used: {why}. {fix}.")
    raise typer.Exit(WRONG_INPUT)


def _prepare_all(files: Sequence[Path], *, cells: int, bytes_: int) -> dict[Path, Prepared]:
    """Return the study of each file, or report every error of every file and exit."""
    from core.kinds import prepare_content
    from core.study.load import read_content

    prepared: dict[Path, Prepared] = {}
    wrong: dict[Path, Sequence[Problem]] = {}
    for path in files:
        try:
            prepared[path] = prepare_content(read_content(path))
            prepared[path].check_limits(cells=cells, bytes_=bytes_)
        except StudyError as error:
            wrong[path] = error.problems
        except LimitError as error:
            wrong[path] = [Problem("parameters", error.message, error.fix)]
    if wrong:
        _refuse(wrong)
    return prepared


@contextmanager
def _interruption(kind: str) -> Iterator[Callable[[], bool]]:
    """Let Ctrl-C stop a study between cells, not in the middle; yield whether it has.

    A second Ctrl-C stops at once. A sweep has nothing to keep: there it stops at once in any case.
    """
    asked = threading.Event()
    if kind == "sweep":
        yield asked.is_set
        return

    def interrupt(number: int, frame: object) -> None:
        if asked.is_set():
            raise KeyboardInterrupt
        asked.set()

    before = signal.signal(signal.SIGINT, interrupt)
    try:
        yield asked.is_set
    finally:
        signal.signal(signal.SIGINT, before)


def _targets(files: Sequence[Path], output: Path | None) -> dict[Path, Path]:
    """Return where each result goes; exit if two would go to one place."""
    if output is not None and len(files) == 1 and not output.is_dir() and output.suffix == ".nc":
        targets = {files[0]: output}
    else:
        targets = {file: (output or file.parent) / f"{file.stem}.nc" for file in files}
    _refuse_clashes(targets)
    for target in targets.values():
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            place = Problem("output", f"{target.parent} cannot be made", str(error.strerror))
            _refuse({target: [place]})
    return targets


def _refuse_clashes(targets: Mapping[Path, Path], taken: Collection[Path] = ()) -> None:
    """Exit if two studies would go to one place, or one to a place that something else takes."""
    everything = [*targets.values(), *taken]
    message = "{} would be written more than once"
    fix = "Rename a study, or use another folder"
    clashes = {
        file: [Problem("output", message.format(target), fix)]
        for file, target in targets.items()
        if everything.count(target) > 1
    }
    if clashes:
        _refuse(clashes)


def _fixed(text: str) -> tuple[str, str]:
    name, sign, value = text.partition("=")
    if not sign:
        _refuse({Path("--at"): [Problem(text, "it has no value", "Write name=value")]})
    return name.strip(), value.strip()


def _refuse(wrong: Mapping[Path, Sequence[Problem]]) -> NoReturn:
    """Print every problem of every file on the error stream, and exit with code 2."""
    for path, problems in wrong.items():
        count = len(problems)
        typer.echo(f"{path}: {count} problem{'s' if count > 1 else ''}", err=True)
        for problem in problems:
            typer.echo(f"  {problem}", err=True)
    raise typer.Exit(WRONG_INPUT)
