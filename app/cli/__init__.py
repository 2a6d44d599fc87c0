"""The command line, one file a command.

Every command imports what it needs when it runs: `vibrafeed scenes` loads no NetCDF library.
"""

from __future__ import annotations

import typer

from app.cli import (
    drive,
    export,
    friction,
    key,
    parts,
    plot,
    report,
    run,
    scenes,
    schema,
    scrub,
    serve,
    warm,
)

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Sweeps, motion in time and best drives of parts on vibratory feeder tracks.",
)
for _command in (
    run.run, export.export, parts.join, plot.plot, drive.drive, report.report, scenes.scenes,
    friction.friction,
    schema.schema, serve.serve, scrub.scrub, warm.warm,
):  # fmt: skip
    app.command()(_command)
app.add_typer(key.key, name="key")


def main() -> None:
    """Run the command line."""
    app()
