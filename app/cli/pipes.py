"""Studies from standard input, and results to standard output."""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import typer

from vibrafeed.app.cli.studies import refuse
from vibrafeed.core.errors import Problem

FORM = ".csv"
"""What goes to standard output unless another suffix is named, as in ``-.nc``."""


def is_standard(output: str | None) -> bool:
    """True if an output path means standard output: `-`, or `-` with a suffix such as `-.csv`."""
    return output is not None and (output == "-" or output.startswith("-."))


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
            f"standard output takes the result of one study, not of {studies} studies",
            "Give a folder for the results, such as -o results/",
        )
    elif suffix == ".zarr":
        fix = "Give a name that ends in .zarr, or write -o - for CSV"
        problem = Problem(
            "output", "a Zarr group consists of many files, which standard output cannot take", fix
        )
    elif suffix != FORM and sys.stdout.isatty():
        fix = f"Write -o - for CSV, or send it on: -o {output} > result{suffix}"
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
