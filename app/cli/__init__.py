"""The command line, one file a command.

Every command imports what it needs when it runs: `vibrafeed scenes` loads no NetCDF library.
"""

from __future__ import annotations

from typing import Annotated

import typer

from app.cli import (
    atlas,
    convert,
    drive,
    export,
    friction,
    key,
    lookup,
    new,
    parts,
    plot,
    report,
    run,
    scenes,
    schema,
    scrub,
    serve,
    validate,
    warm,
)
from core.kinds import KINDS

app = typer.Typer(
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",  # folds paragraphs as wholes
    help="Sweeps, motion in time and best drives of parts on vibratory feeder tracks.\n\n"
    f"Kinds of study: {', '.join(KINDS)}.",
)


def _tell_version(asked: bool) -> None:
    if asked:
        import core

        typer.echo(f"vibrafeed {core.__version__}")
        raise typer.Exit


@app.callback()
def _all_commands(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_tell_version, is_eager=True, help="Print the version and stop."
        ),
    ] = False,
) -> None:
    pass


for _command in (
    new.new, run.run, convert.convert, export.export, parts.join, plot.plot, drive.drive,
    report.report, atlas.atlas, lookup.lookup, scenes.scenes, friction.friction, schema.schema,
    serve.serve, scrub.scrub, validate.validate, warm.warm,
):  # fmt: skip
    app.command()(_command)
app.add_typer(key.key, name="key")


def main() -> None:
    """Run the command line."""
    app(prog_name="vibrafeed")
