"""`vibrafeed run`: studies in, results out, in the format that a suffix names."""

import shutil
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vibrafeed import core
from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED, INVALID_INPUT, NO_SOLUTION, CsvStyle, Json, Units
from vibrafeed.app.cli.studies import Batch, prepare_all, refuse
from vibrafeed.core.errors import Problem

if TYPE_CHECKING:
    from vibrafeed.core.plan.prepared import Prepared

FORM = ".csv"
"""What goes to standard output unless another suffix is named, as in ``-.nc``."""


def run(
    context: typer.Context,
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Study files (TOML or JSON) to run; - reads one study from standard input.",
            show_default=False,
        ),
    ],
    output: Annotated[
        str | None,
        typer.Option(
            "-o",
            "--output",
            help="Where to write. For one study: a file (.nc, .csv, .xlsx, .parquet, .mat) "
            "or a Zarr group (.zarr, s3://bucket/key); - writes CSV to standard "
            "output, -.nc NetCDF. For any number of studies: a folder. By default the "
            "folder of each study.",
        ),
    ] = None,
    dry_run: Annotated[
        bool,
        typer.Option(
            "--dry-run",
            help="Print what would be computed and the size of the result, without computing it.",
        ),
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace existing results.")] = False,
    plain: Annotated[
        bool,
        typer.Option(
            "--plain", help="Write NetCDF and MAT files without compression: faster, but larger."
        ),
    ] = False,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume",
            help="Keep complete results, and continue runs to Zarr that were stopped or killed.",
        ),
    ] = False,
    csv_style: CsvStyle = "plain",
    units: Units = None,
    as_json: Json = False,
    quiet: Annotated[
        bool, typer.Option("-q", "--quiet", help="Print only errors and warnings.")
    ] = False,
    strict: Annotated[
        bool,
        typer.Option(
            "--strict",
            help="Treat warnings, such as one of an unusual value, as errors: run no study and "
            "exit with code 2.",
        ),
    ] = False,
    keep_going: Annotated[
        bool,
        typer.Option(
            "--keep-going",
            help="Run the valid studies even if others have errors; exit with code 2.",
        ),
    ] = False,
    verbose: Annotated[
        bool,
        typer.Option(
            "-v",
            "--verbose",
            help="Also print run times, equations, compiled kernels, and how an optimum was found.",
        ),
    ] = False,
    max_cells: Annotated[
        int | None,
        typer.Option(help="Refuse studies with more cells (grid points) than this number."),
    ] = None,
    max_bytes: Annotated[
        int | None,
        typer.Option(help="Refuse studies whose result takes more bytes than this number."),
    ] = None,
    time_limit: Annotated[
        float | None,
        typer.Option(
            help="Time limit in seconds: after it no further grid point is computed or "
            "verified. A sweep of closed forms that fits in memory is always computed "
            "in full.",
            min=0,
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            help="Address of a Dask scheduler that computes the studies, as in tls://host:8786; "
            "only for sweeps and simulations to Zarr (-o result.zarr) and studies with [reduce]."
        ),
    ] = None,
) -> None:
    """Run studies and write one result file each: NetCDF, or the format of the output's suffix.

    All files are checked before the first study runs; unusual values are printed as warnings. Exit
    code 1: a result could not be written, a verification failed, or a study was stopped by Ctrl-C
    or the time limit. What was finished is written, and --resume continues a Zarr group. Exit code
    2: a study file is wrong, --strict found a warning, or a result exists already. Exit code 3:
    everything was computed, but an optimisation has no solution.
    """
    from vibrafeed.app.cli.running import Running
    from vibrafeed.app.cli.targets import complete_already, refuse_choices, targets_of
    from vibrafeed.app.cli.units import units_asked
    from vibrafeed.core.dataset.files import Storage

    names_standard = output is not None and (output == "-" or output.startswith("-."))
    to_standard = names_standard and not dry_run
    if to_standard and as_json:
        _refuse_json_beside_result()
    began = time.perf_counter()
    units_asked(units)
    with console.muted(quiet or as_json or to_standard):
        studies = prepare_all(
            files, cells=max_cells, bytes_=max_bytes, strict=strict, keep_going=keep_going
        )
        context.call_on_close(lambda: _count_warnings(studies))
        if dry_run:
            _show_plans(studies, output, units, as_json)
            raise typer.Exit(INVALID_INPUT if studies.refused else 0)
        running = Running(
            resume=resume,
            storage=Storage(compression=not plain, csv_style=csv_style),
            units=units,
            checked=time.perf_counter() - began if verbose else None,
            deadline=None if time_limit is None else time.monotonic() + time_limit,
        )
        with (
            standard_output(output, len(studies))
            if to_standard and output
            else nullcontext(output) as destination
        ):
            targets = targets_of(studies, destination)
            refuse_choices(running.storage, targets.values())
            complete = complete_already(studies, targets, resume=resume, force=force)
            try:
                with cluster(scheduler, studies, targets):
                    sound = running.carry_out(studies, targets, complete)
            finally:
                if as_json:
                    results = [studies.with_warnings(facts) for facts in running.facts]
                    console.document(_document("results", results, studies))
    if not sound:
        raise typer.Exit(FAILED)
    if studies.refused:
        names = ", ".join(map(str, studies.refused))
        typer.echo(f"Not run, see the errors above: {names}", err=True)
        raise typer.Exit(INVALID_INPUT)
    if not running.solved:
        raise typer.Exit(NO_SOLUTION)


def _count_warnings(studies: Batch) -> None:
    """Print the number of warnings of all studies on the error stream, if there were any."""
    if studies.warnings:
        typer.echo(studies.count_of_warnings, err=True)


def _document(heading: str, documents: list[dict[str, Any]], studies: Batch) -> dict[str, Any]:
    return {"vibrafeed": core.__version__, heading: documents, "refused": studies.refusals()}


def _show_plans(studies: Batch, output: str | None, units: str | None, as_json: bool) -> None:
    """Print the plans of all studies, or one JSON document with all of them (`as_json`).

    `studies` are by their files; `output` and `units` are the texts of the options, if given.
    """
    from vibrafeed.app.cli import plans

    if as_json:
        documents = [
            studies.with_warnings(plans.plan_facts(path, prepared))
            for path, prepared in studies.items()
        ]
        console.document(_document("plans", documents, studies))
        return
    for path, prepared in studies.items():
        plans.show_plan(path, prepared, output, units)


@contextmanager
def cluster(
    address: str | None, studies: "Mapping[Path, Prepared]", targets: Mapping[Path, str]
) -> Iterator[None]:
    """Let dask compute on the scheduler at an address while the block runs; here without one.

    Exits if a study is computed as a whole, which only this machine does.
    """
    if address is None:
        yield
        return
    from vibrafeed.core import lazy
    from vibrafeed.core.dataset.formats import is_zarr

    problems = {}
    for path, prepared in studies.items():
        is_reduced = getattr(prepared.study, "reduce", None) is not None
        is_in_blocks = prepared.not_lazy is None and is_zarr(targets[path])
        if not (is_reduced or is_in_blocks):
            message = (
                "a cluster can run only sweeps and simulations to Zarr, and studies with [reduce]"
            )
            fix = "Write to Zarr (-o result.zarr), or remove --scheduler"
            problems[path] = [Problem("--scheduler", message, fix)]
    if problems:
        refuse(problems)
    with console.needing("cluster", "distributed"):
        import distributed

        try:
            client = distributed.Client(  # type: ignore[no-untyped-call]
                address, timeout=20, set_as_default=False
            )
        except (OSError, ValueError, TypeError) as error:
            # Dask says of missing certificates that something has another type.
            uses_tls = "it talks TLS, and the settings of Dask name no certificates (docs/scale.md)"
            reason = uses_tls if isinstance(error, TypeError) else error
            console.fail(f"{address} cannot be reached: {reason}.")
            raise typer.Exit(FAILED) from None
        before = lazy.dataset.SCHEDULER.set(client)
        try:
            with client:
                yield
        finally:
            lazy.dataset.SCHEDULER.reset(before)


def _refuse_json_beside_result() -> None:
    message = "the JSON document (--json) and the result (-o -) cannot both go to standard output"
    fix = "Remove --json, or write the result to a file: -o result.csv"
    refuse({Path("options"): [Problem("--json", message, fix)]})


@contextmanager
def standard_output(output: str, studies: int) -> Iterator[str]:
    """Yield the name of a temporary file whose content is written to standard output at the end.

    `output` is `-`, or `-` with a suffix; `studies` is the number of studies. Exits if there are
    several, or if the format cannot go there.
    """
    suffix = output[1:] or FORM
    problem = None
    if studies > 1:
        problem = Problem(
            "output",
            f"the results of {studies} studies cannot go to standard output together",
            "Give a folder for the results, such as -o results/",
        )
    elif suffix == ".zarr":
        fix = "Give a name that ends in .zarr, or use -o - for CSV"
        problem = Problem(
            "output", "a Zarr group consists of many files and cannot go to standard output", fix
        )
    elif suffix != FORM and sys.stdout.isatty():
        fix = f"Use -o - for CSV, or redirect the output: -o {output} > result{suffix}"
        problem = Problem("output", f"a terminal cannot show {suffix}", fix)
    if problem is not None:
        refuse({Path("--output"): [problem]})
    with tempfile.TemporaryDirectory(prefix="vibrafeed-") as folder:
        path = Path(folder) / f"result{suffix}"
        try:
            yield str(path)
        finally:
            if path.exists():
                with path.open("rb") as file:
                    shutil.copyfileobj(file, typer.get_binary_stream("stdout"))
