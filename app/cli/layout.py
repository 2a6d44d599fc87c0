"""Tables as lines: plain where something reads them, in blocks where a terminal is narrow."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence

GAP = "  "  # between columns
INDENT = 4  # spaces before lines that continue a row
LONG = 24
"""Letters of a column from which on it may be folded, and stands below in a block."""

Rows = Sequence[Sequence[str]]


def plain_lines(columns: Sequence[str], rows: Rows) -> Iterator[str]:
    """Yield the lines of a table as text in aligned columns, headings first; no cell is cut.

    `columns` are the headings, `rows` the cells of each row; empty cells become `-`. This is how
    tables are printed where there is no terminal.
    """
    told = [[*columns], *([cell or "-" for cell in row] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*told, strict=True)]
    for row in told:
        yield _align_cells(row, widths)


def least_widths(columns: Sequence[str], rows: Rows) -> list[int]:
    """Return the smallest width of each column of a table [characters] that breaks no word.

    `columns` are the headings, `rows` the cells of each row. A column of short cells has its full
    width, so that it is not folded.
    """
    widths = []
    for heading, *cells in zip(columns, *rows, strict=True):
        longest = max(len(word) for cell in (heading, *cells) for word in cell.split() or [""])
        natural = max(map(len, (heading, *cells)))
        widths.append(max(longest, min(natural, LONG)))
    return widths


def block_lines(columns: Sequence[str], rows: Rows, width: int) -> Iterator[str]:
    """Yield the lines of a table too wide for a terminal: a block of lines for each row.

    Short columns stand in one line as far as they fit, long ones below as sentences. `columns` are
    the headings, `rows` the cells of each row, `width` is that of the terminal [characters].
    """
    natural = [max(map(len, column)) for column in zip(columns, *rows, strict=True)]
    first = [0]
    used = len(GAP) + natural[0]
    for number, wide in enumerate(natural[1:], 1):
        if wide <= LONG and used + len(GAP) + wide <= width:
            first.append(number)
            used += len(GAP) + wide
    widths = [natural[number] for number in first]
    below = [number for number in range(len(columns)) if number not in first]
    yield GAP + _align_cells([columns[number] for number in first], widths)
    if len(below) == 1:
        yield " " * INDENT + columns[below[0]]
    for row in rows:
        yield from fold_line(GAP + _align_cells([row[number] for number in first], widths), width)
        for number in below:
            name = f"{columns[number]}: " if len(below) > 1 else ""
            if row[number]:
                yield from fold_line(f"{' ' * INDENT}{name}{row[number]}", width)


def _align_cells(cells: Sequence[str], widths: Sequence[int]) -> str:
    """Return cells as one line, each padded to the width of its column."""
    pairs = zip(cells, widths, strict=True)
    return GAP.join(cell.ljust(width) for cell, width in pairs).rstrip()


def fold_line(line: str, width: int) -> list[str]:
    """Return a long line as several lines, broken between words; further lines are indented.

    `width` is the largest length of a line [characters]; a longer word is not broken.
    """
    if len(line) <= width:
        return [line]
    return textwrap.wrap(
        line.strip(),
        width,
        initial_indent=" " * (len(line) - len(line.lstrip())),
        subsequent_indent=" " * INDENT,
        break_long_words=False,  # an address is copied as one
        break_on_hyphens=False,
    )
