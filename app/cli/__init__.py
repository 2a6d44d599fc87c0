"""The command line, one file a command.

A command's file is loaded when the command runs: `vibrafeed scenes` loads no NetCDF library, and
`vibrafeed --help` none of them.
"""

import gc
import os
from importlib import import_module
from types import MappingProxyType
from typing import Annotated, Any, Final

import typer
from typer.core import TyperCommand

from vibrafeed import core
from vibrafeed.app.cli.console import needing
from vibrafeed.app.cli.options import INVALID_INPUT, Group
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.system import write_utf8

COMMANDS: Final = MappingProxyType(
    {
        "new": "Write a commented study to start from, after a few questions.",
        "run": "Run studies and write one result file each: NetCDF, or the format of the "
        "output's suffix.",
        "convert": "Convert a study to TOML, JSON, a command that posts it, or a Python call.",
        "export": "Convert a result to another format, given by the suffix of the output.",
        "plot": "Draw a result: an output with its regimes, a map of regimes, or the motion of "
        "one part.",
        "sheet": "Write a one-page PDF summary of a result: parameters, outputs, a picture.",
        "drive": "Fit the harmonics of a drive, with errors, to an accelerometer recording.",
        "report": "Measure the error of studies over run time: a page, pictures and datasets.",
        "scenes": "Print the catalogue: scenes, parameters, outputs, units, equations, validity.",
        "materials": "Print published friction, restitution and leaf springs, with their sources.",
        "serve": "Serve the HTTP interface.",
        "key": "Keys for the HTTP interface.",
        "mcp": "Offer scenes, checks, runs and jobs to an agent (Model Context Protocol).",
    }
)
"""Each command and the line that lists it; the file of its name has the function of its name."""

GONE: Final = MappingProxyType(
    {
        "atlas": "The notebook docs/notebooks/five-number-chart.ipynb draws the chart of speeds",
        "friction": "vibrafeed materials prints it",
        "join": "vibrafeed run --scheduler computes a study on many machines: docs/scale.md",
        "leaves": "vibrafeed materials --leaves prints them",
        "lookup": "vibrafeed run computes the speed; vibrafeed new writes the study",
        "schema": "vibrafeed scenes --schema prints it",
        "scrub": "The service compares each result with its digest before it serves it",
        "validate": "The known answers are TOML files in tests/known_answers",
        "warm": "python -m vibrafeed.core.warm compiles everything",
    }
)
"""Commands of former versions, and what does the same."""

SERVICE: Final = ("serve", "key", "mcp")
"""The commands that need the extra `serve`."""


STYLE: Final[Any] = {"pretty_exceptions_enable": False, "rich_markup_mode": None}
"""Help is plain text: boxes would take rich, and as long to load as all the rest."""


COLLECTED = 50_000
"""Objects between two collections of garbage: Python's 700 cost a tenth of a start."""


class Commands(Group):
    """The commands, of which only the one that runs is loaded."""

    def __init__(self, **options: Any):
        """List every command with its help line; a command's module is loaded when it runs."""
        super().__init__(**options)
        for name, line in COMMANDS.items():
            self.add_command(TyperCommand(name, help=line))

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the list of the commands, each with its whole line."""
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl([*COMMANDS.items()])

    def invoke(self, ctx: Any) -> Any:
        """Run the typed command; those of the service hint at their extra if it is missing."""
        try:
            return super().invoke(ctx)
        except ModuleNotFoundError:
            if ctx.invoked_subcommand not in SERVICE:
                raise
            with needing("serve"):
                raise

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the name of the typed command, the command itself, and the words after it.

        The module of the command, with its options, is imported only now. `args` are all words that
        were typed.
        """
        if args and args[0] in GONE:
            typer.echo(f"There is no command {args[0]}. {GONE[args[0]]}.", err=True)
            raise typer.Exit(INVALID_INPUT)
        name, _, rest = super().resolve_command(ctx, args)
        return name, name and loaded(name), rest


def loaded(name: str) -> Any:
    """Import the module of a command by its name and return the command, ready for Click.

    Modules are loaded when their command is called, so that the program starts quickly. `name` is
    both that of the module and that of its function or group of commands.
    """
    command = getattr(import_module(f"{__name__}.{name}"), name)
    if not isinstance(command, typer.Typer):
        function, command = command, typer.Typer(add_completion=False, **STYLE)
        command.command(name)(function)
    return typer.main.get_command(command)


app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Compute how parts move on vibratory feeder tracks: sweeps over parameters, motion in "
    "time, and best drives.\n\n"
    f"Kinds of study: {', '.join(KINDS)}.",
    **STYLE,
)


def _tell_version(asked: bool) -> None:
    if asked:
        typer.echo(f"vibrafeed {core.__version__}")
        raise typer.Exit


@app.callback()
def _all_commands(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_tell_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    pass


def main() -> None:
    """Run the command line."""
    write_utf8()
    gc.set_threshold(COLLECTED)
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # it looks through all packages
    try:
        app(prog_name="vibrafeed")
    finally:
        gc.freeze()  # the interpreter need not look for garbage when it ends
