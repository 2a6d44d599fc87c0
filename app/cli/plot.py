"""`vibrafeed plot`: pictures of a NetCDF file."""

from pathlib import Path
from typing import Annotated

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.console import needing
from vibrafeed.app.cli.options import FAILED
from vibrafeed.app.cli.studies import refuse, refuse_existing
from vibrafeed.core.errors import Problem
from vibrafeed.core.plots.pictures import PICTURES


def plot(
    files: Annotated[
        list[Path],
        typer.Argument(
            help="Result files (NetCDF) written by `vibrafeed run`; several are drawn in "
            "one picture."
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="Picture to write: .png, .svg or .pdf; .gif for an animation. By "
            "default .png and .svg (an animation: .gif) in the folder of the result, "
            "named after the result, --variable and --kind.",
        ),
    ] = None,
    variable: Annotated[
        str | None,
        typer.Option(
            "--variable",
            "-v",
            help="Name of the output to draw, such as conveying_velocity; by default the "
            "first one of the result.",
        ),
    ] = None,
    axes: Annotated[
        str | None,
        typer.Option(
            "--axes",
            "-a",
            help="Names of one or two axes of the picture, as in beta,alpha; by default "
            "the axes with most values.",
        ),
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            "--at",
            help="Draw the result at this value of an axis that the picture does not show, "
            "as in `frequency=60 Hz`.",
        ),
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(
            "--kind",
            "-k",
            help="Kind of picture. "
            + "; ".join(f"{one.name}: {one.says}" for one in PICTURES.values())
            + ". By default the first kind that fits the result.",
        ),
    ] = None,
    slow: Annotated[
        float | None,
        typer.Option(
            "--slow",
            help="Slow-motion factor of an animation: 50 shows 20 ms of motion in 1 s.",
            show_default=False,
        ),
    ] = None,
    title: Annotated[
        str | None, typer.Option("--title", help="Title of the picture.", show_default=False)
    ] = None,
    units: Annotated[
        str | None,
        typer.Option(
            "--units",
            help="Units of the picture: trade (mm, mm/s), si, or a list such as m/min,rad; "
            "by default the units that the study names.",
        ),
    ] = None,
    nearest: Annotated[
        bool,
        typer.Option(
            "--nearest",
            help="If the value of --at is not one of the result, use the nearest one that is.",
        ),
    ] = False,
    dark: Annotated[
        bool, typer.Option("--dark", help="Draw in light colours on a dark background.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing picture.")] = False,
    small: Annotated[
        bool, typer.Option("--small", help="Draw a small picture, 11 cm wide, for one text column.")
    ] = False,
) -> None:
    """Draw a result: an output with its regimes, a map of regimes, or the motion of one part."""
    with needing("plot", "matplotlib"):
        from vibrafeed.core.plots.drawing import draw_file
        from vibrafeed.core.plots.pictures import PlotError
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
            at=dict(_split_assignment(text) for text in at or ()),
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


def _split_assignment(text: str) -> tuple[str, str]:
    """Return name and value of `name=value`, as `--at` takes it; exit without `=`."""
    name, sign, value = text.partition("=")
    if not sign:
        refuse({Path("--at"): [Problem(text, "the option has no value", "Write --at name=value")]})
    return name.strip(), value.strip()
