"""Options that several commands have, and exit codes; imports nothing that takes long."""

from typing import Annotated, Any, Literal

import typer
from typer.core import TyperGroup

INVALID_INPUT = 2
FAILED = 1
NO_SOLUTION = 3

Json = Annotated[
    bool,
    typer.Option(
        "--json", help="Print one JSON document, with values in the units of result files."
    ),
]
Units = Annotated[
    str | None,
    typer.Option(
        help="Units of the printed values: trade (mm, mm/s, g; the default), si, or a "
        "list such as 'm/min, mm'. Result files and --json are not affected.",
    ),
]
CsvStyle = Annotated[
    Literal["plain", "excel"],
    typer.Option(
        help="Style of CSV files: plain, or excel for Excel in Europe (semicolons, decimal commas, "
        "a byte order mark)."
    ),
]


class Group(TyperGroup):
    """A group of commands whose own options are flags."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the options, each False if it is not given.

        typer would load pydantic to read their None, which takes longer than all else of help.
        """
        flags: list[Any] = super().get_params(ctx)
        for flag in flags:
            flag.default = False
        return flags
