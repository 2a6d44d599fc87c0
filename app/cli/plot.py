"""`vibrafeed plot`: pictures of a NetCDF file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli import console
from app.cli.options import FAILED
from app.cli.studies import refuse, refuse_existing
from core.errors import Problem
from core.extras import installing
from core.plots.pictures import PICTURES


def plot(
    files: Annotated[
        list[Path],
        typer.Argument(
            help="NetCDF files written by `vibrafeed run`; several are drawn in one picture."
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="PNG, SVG or PDF; GIF or MP4 for an animation. If left out: in the file's "
            "folder, named after it, the kind and the output.",
        ),
    ] = None,
    variable: Annotated[
        str | None,
        typer.Option("--variable", "-v", help="The output to draw; the first one by default."),
    ] = None,
    axes: Annotated[
        str | None,
        typer.Option(
            "--axes",
            "-a",
            help="One or two dimensions, as in beta,alpha; by default the longest ones.",
        ),
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option("--at", help="Fix another dimension at a value, as in `frequency=60 Hz`."),
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(
            "--kind",
            "-k",
            help="; ".join(f"{one.name}: {one.says}" for one in PICTURES.values())
            + ". By default the first that fits the result.",
        ),
    ] = None,
    slow: Annotated[
        float | None,
        typer.Option("--slow", help="Slow-motion factor of an animation.", show_default=False),
    ] = None,
    title: Annotated[
        str | None, typer.Option("--title", help="Title of the picture.", show_default=False)
    ] = None,
    units: Annotated[
        str | None,
        typer.Option(
            "--units", help="trade (mm, mm/s), si, or units, as in m/min,rad; those of the study."
        ),
    ] = None,
    nearest: Annotated[
        bool, typer.Option("--nearest", help="Use the nearest value if --at is not on the axis.")
    ] = False,
    dark: Annotated[
        bool, typer.Option("--dark", help="Use light colours on a dark background.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing picture.")] = False,
    small: Annotated[
        bool, typer.Option("--small", help="Make a small picture for one text column, 11 cm wide.")
    ] = False,
) -> None:
    """Draw a result: an output with its regimes, a map of regimes, or the motion of one part."""
    try:
        from core.plots import PlotError, draw_file
    except ModuleNotFoundError as error:
        console.fail(f"{error.name} is missing. Install it: {installing('matplotlib', 'plot')}")
        raise typer.Exit(FAILED) from None
    file = files[0]
    endings = (".gif",) if kind == "animation" else (".png", ".svg")
    name = "-".join(filter(None, (file.stem, variable, kind)))
    targets = [output] if output else [file.with_name(name + ending) for ending in endings]
    for target in targets:
        refuse_existing(str(file), str(target), force=force)
    try:
        draw_file(
            files,
            targets,
            variable=variable,
            axes=tuple(part.strip() for part in axes.split(",")) if axes else None,
            at=dict(_fixed(text) for text in at or ()),
            kind=kind,
            slow=slow,
            title=title,
            units=units,
            nearest=nearest,
            dark=dark,
            small=small,
        )
    except PlotError as error:
        refuse({file: [error.problem]})
    except OSError as error:
        console.fail(f"{error.filename or file}: {error.strerror or error}.")
        raise typer.Exit(FAILED) from None
    for target in targets:
        typer.echo(f"wrote {target}")


def _fixed(text: str) -> tuple[str, str]:
    """Return name and value of an `--at` option typed as `name=value`; exit if it has no `=`."""
    name, sign, value = text.partition("=")
    if not sign:
        refuse({Path("--at"): [Problem(text, "it has no value", "Write name=value")]})
    return name.strip(), value.strip()
