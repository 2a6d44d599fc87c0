"""The cells of a CSV table of a heading and rows, such as that of observations."""

from __future__ import annotations

import csv
import io
import itertools
import re
from pathlib import Path

from vibrafeed.core.measured.marks import contradictions
from vibrafeed.core.measured.read import SEPARATOR, decoded

_NUMBER = re.compile(r"([-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?)(\s*[^\d\s.,].*)?")


def read_cells(path: Path) -> tuple[list[list[str]], list[str]]:
    """Return the rows of a CSV file as lists of cells, and contradictions of its decimal marks.

    Commas, semicolons or tabs separate the cells; a line ``sep=;`` on top may name the separator.
    Beside the last two a comma is a decimal comma, and becomes a point. Empty lines and lines that
    begin with # are left out.

    Raises
    ------
    OSError, ValueError
        If the file cannot be read, or is no text.
    """
    text = decoded(path.read_bytes())
    lines = [line for line in text.splitlines() if line.strip(" ,;\t") and line[0] != "#"]
    named = SEPARATOR.fullmatch(lines[0].strip()) if lines else None
    lines = lines[1:] if named else lines
    delimiter = named[1] if named else max(";\t,", key=lines[0].count) if lines else ","
    rows = [*csv.reader(io.StringIO("\n".join(lines)), delimiter=delimiter)]
    if delimiter == "," or not rows:
        return rows, []
    columns = dict(zip(rows[0], itertools.zip_longest(*rows[1:], fillvalue=""), strict=False))
    numbers = {
        name: [
            found[1] for cell in dict.fromkeys(cells) if (found := _NUMBER.fullmatch(cell.strip()))
        ]
        for name, cells in columns.items()
    }
    return [[_with_point(cell) for cell in row] for row in rows], [
        *contradictions(numbers).values()
    ]


def _with_point(cell: str) -> str:
    found = _NUMBER.fullmatch(cell.strip())
    return found[1].replace(",", ".") + (found[2] or "") if found else cell
