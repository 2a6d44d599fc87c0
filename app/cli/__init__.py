"""The command line, one file a command.

A command's file is loaded when the command runs: `vibrafeed scenes` loads no NetCDF library, and
`vibrafeed --help` none of them.
"""

from __future__ import annotations

from importlib import import_module
from types import MappingProxyType
from typing import Annotated, Any, Final

import typer
from typer.core import TyperCommand, TyperGroup

import core
from core.kinds import KINDS

COMMANDS: Final = MappingProxyType(
    {
        "new": "Write a commented study to start from, after a few questions.",
        "run": "Carry out studies and write one file each: NetCDF, or what the suffix of the "
        "output names.",
        "convert": "Write a study as TOML, as JSON, as a line for curl, or as a call in Python.",
        "export": "Write a result in another format, which the suffix of the output names.",
        "join": "Join the parts that `vibrafeed run --part` has computed, and give the result "
        "its name.",
        "plot": "Draw an output with its regimes, a map of the regimes, or the motion of one part.",
        "sheet": "Write one page about a result, as PDF: what it is of, what came out, a picture.",
        "drive": "Fit the harmonics of a drive to the recording of an accelerometer, with "
        "their errors.",
        "report": "Measure error against run time for studies: a page, its pictures, and datasets.",
        "atlas": "Write the atlas that `vibrafeed lookup` reads, or the book of charts, or both.",
        "lookup": "Read speed, regime and shares from an atlas, each with its error.",
        "scenes": "Print the catalogue: scenes, parameters, outputs, units, equations, validity.",
        "friction": "Print published coefficients of friction and restitution, with their sources.",
        "leaves": "Print published moduli and densities of leaf springs, with their sources.",
        "schema": "Print the JSON Schema of studies, for editors.",
        "serve": "Serve the HTTP interface.",
        "scrub": "Compare every result of a service with its digests; exit with 1 if one is "
        "broken.",
        "validate": "Answer every problem whose answer is known, and say how far off that is.",
        "warm": "Compile what follows motion in time, once for this processor; a minute or so.",
        "key": "Keys for the HTTP interface.",
    }
)
"""Each command and the line that lists it; the file of its name has the function of its name."""


STYLE: Final[Any] = {"pretty_exceptions_enable": False, "rich_markup_mode": "markdown"}
"""Markdown folds paragraphs as wholes."""


class Commands(TyperGroup):
    """The commands, of which only the one that runs is loaded."""

    def __init__(self, **options: Any):
        super().__init__(**options)
        for name, line in COMMANDS.items():
            self.add_command(TyperCommand(name, help=line))

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the name of the typed command, the command, and the words after it."""
        name, _, rest = super().resolve_command(ctx, args)
        return name, name and loaded(name), rest


def loaded(name: str) -> Any:
    """Import the module of a command by its name and return the command with its options."""
    command = getattr(import_module(f"{__name__}.{name}"), name)
    if not isinstance(command, typer.Typer):
        function, command = command, typer.Typer(add_completion=False, **STYLE)
        command.command(name)(function)
    return typer.main.get_command(command)


app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Sweeps, motion in time and best drives of parts on vibratory feeder tracks.\n\n"
    f"Kinds of study: {', '.join(KINDS)}.",
    **STYLE,
)


def _tell_version(asked: bool) -> None:
    """Print the version and end the program, if `--version` was typed."""
    if asked:
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


def main() -> None:
    """Run the command line."""
    app(prog_name="vibrafeed")
