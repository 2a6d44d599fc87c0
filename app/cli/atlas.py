"""`vibrafeed atlas`: the atlas of planar motion without restitution, and its book of charts."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.missing import needing
from vibrafeed.app.cli.options import FAILED
from vibrafeed.app.cli.studies import REPLACE, interruption, refuse
from vibrafeed.core.errors import MissingPackageError, Problem, StoppedError

if TYPE_CHECKING:
    from vibrafeed.core.watch import Watch

SUFFIXES = (".nc", ".zarr")


def atlas(
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="File for the atlas, a table of computed motions: .nc, or .zarr for a Zarr group.",
        ),
    ] = None,
    resolution: Annotated[
        str,
        typer.Option(
            help="Resolution of the atlas: full; or coarse, which is computed in seconds, "
            "but has larger errors and "
            "more cells without a value."
        ),
    ] = "full",
    charts: Annotated[
        Path | None,
        typer.Option(
            help="Write charts of the conveying velocity to this PDF file; works with and "
            "without -o."
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace existing files.")] = False,
) -> None:
    """Write the atlas that `vibrafeed lookup` reads, or the book of charts, or both.

    The atlas holds the speed, the regime, the shares of the period and an error over the four
    numbers that the motion of a part in the plane depends on if it does not rebound. The charts are
    computed exactly, not read from the atlas.
    """
    _refuse_problems(output, charts, resolution, force=force)
    if charts is not None:
        with needing("plot", "matplotlib"):
            from vibrafeed.core.plots.book import write_book
    if output is not None:
        _run_with_progress(output, lambda watch: _write_atlas(output, resolution, watch))
    if charts is not None:
        _run_with_progress(charts, lambda watch: write_book(charts, watch=watch))


def _refuse_problems(
    output: Path | None, charts: Path | None, resolution: str, *, force: bool
) -> None:
    """Exit with every problem of the options of `vibrafeed atlas`; return if there is none.

    `output` and `charts` are the files to write, None if they are not asked for; `resolution` is to
    be full or coarse; `force` allows replacing files.
    """
    from vibrafeed.app.cli.existing import REMOVE
    from vibrafeed.core.atlas.build import RESOLUTIONS
    from vibrafeed.core.dataset.shards import needed_for_zarr

    problems = []
    if output is None and charts is None:
        fix = "Write -o atlas.nc, --charts book.pdf, or both"
        problems.append(
            Problem(
                "options",
                "the command names no file to write, neither an atlas (-o) nor charts (--charts)",
                fix,
            )
        )
    if resolution not in RESOLUTIONS:
        fix = f"Write {' or '.join(RESOLUTIONS)}"
        problems.append(Problem("resolution", f"'{resolution[:40]}' is not known", fix))
    if output is not None and output.suffix.lower() not in SUFFIXES:
        message = f"'{output.suffix}' is not a format of an atlas"
        problems.append(Problem("output", message, f"End it in {' or '.join(SUFFIXES)}"))
    elif output is not None and output.suffix.lower() == ".zarr":
        try:
            needed_for_zarr()
        except MissingPackageError as error:
            problems.append(
                Problem("output", str(error), "Or give the atlas a name that ends in .nc")
            )
    if charts is not None and charts.suffix.lower() != ".pdf":
        problems.append(
            Problem(
                "charts",
                f"charts are written as PDF only, not as '{charts.suffix}'",
                "Give the file of charts a name that ends in .pdf",
            )
        )
    for option, path in (("output", output), ("charts", charts)):
        if path is None or not path.exists():
            continue
        if path.is_dir() or not force:
            fix = REMOVE if path.is_dir() else REPLACE
            problems.append(Problem(option, f"{path} exists already", fix))
    if problems:
        refuse({Path("atlas"): problems})


def _run_with_progress(target: Path, carry_out: Callable[[Watch], str]) -> None:
    """Run a long computation with a progress bar; print its result, or exit with an error.

    `target` is the file that it writes. `carry_out` is called with a watch that reports progress
    and Ctrl-C, and returns the result in words.
    """
    from vibrafeed.core.watch import Watch

    began = time.perf_counter()
    try:
        with console.progress(target.name) as advance, interruption() as interrupted:
            outcome = carry_out(Watch(advance, interrupted))
    except StoppedError as stopped:
        console.fail(f"{target}: {stopped}; nothing is written.")
        raise typer.Exit(FAILED) from None
    except OSError as error:
        console.fail(f"{target} cannot be written: {error.strerror or error}.")
        raise typer.Exit(FAILED) from None
    console.say(f"wrote {target}: {outcome}, {time.perf_counter() - began:.1f} s")


def _write_atlas(target: Path, resolution: str, watch: Watch) -> str:
    """Compute an atlas of the motion of parts and write it to a file or Zarr group.

    The result is the number of nodes along each axis in words, such as "20 x 20 x 9 x 5 nodes".

    Parameters
    ----------
    target : Path
        The file, NetCDF or (with the suffix .zarr) a Zarr group.
    resolution : str
        `full` or `coarse`.
    watch : Watch
        Takes the progress and may stop the computation.
    """
    from vibrafeed.core.atlas.build import build
    from vibrafeed.core.dataset.group import write_zarr
    from vibrafeed.core.dataset.netcdf import write_netcdf

    table = build(resolution, watch)
    # Without a history: two atlases of one version are equal to the byte.
    if target.suffix.lower() == ".zarr":
        write_zarr(table, str(target))
    else:
        write_netcdf(table, target)
    nodes = table.variables["velocity_number"].values.shape
    return f"{' x '.join(map(str, nodes))} nodes"
