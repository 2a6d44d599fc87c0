"""The console: lines, tables, documents for programs, a progress bar.

Tables are plain where something reads them, and in blocks where a terminal is narrow.
"""

import functools
import json
import math
import os
import sys
import textwrap
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, TextIO

import typer

from vibrafeed.app.cli.options import FAILED
from vibrafeed.core.compiling import ONCE, stopwatch
from vibrafeed.core.system import installing

if TYPE_CHECKING:
    from rich.console import Console

GAP = "  "  # between columns
INDENT = 4  # spaces before lines that continue a row
LONG = 24
"""Letters of a column from which on it may be folded, and stands below in a block."""

Rows = Sequence[Sequence[str]]

_muted = [False]


@functools.cache
def stdout() -> "Console":
    """Return rich's console of standard output, for a terminal; a pipe needs no rich."""
    from rich.console import Console

    return Console(highlight=False)


@functools.cache
def stderr() -> "Console":
    """Return rich's console of the error stream."""
    from rich.console import Console

    return Console(stderr=True, highlight=False)


def is_terminal(stream: TextIO | None = None) -> bool:
    """True if a person sees the stream, by default standard output."""
    return bool(os.environ.get("FORCE_COLOR")) or (stream or sys.stdout).isatty()


def is_muted() -> bool:
    """True within a block of `muted`."""
    return _muted[-1]


@contextmanager
def muted(quiet: bool) -> Iterator[None]:
    """Suppress printed lines, tables and progress bars inside the block, if `quiet` is True."""
    _muted.append(quiet)
    try:
        yield
    finally:
        _muted.pop()


def fail(message: str) -> None:
    """Print an error message on the error stream; problems of a study are printed by `refuse`."""
    stderr().print(message, style="red", markup=False, soft_wrap=True)


def shows_codes() -> bool:
    """True if the error stream is a terminal that follows control codes, as old ones do not."""
    return stderr().is_terminal and not stderr().legacy_windows


def say(text: str) -> None:
    """Print a line of any length without folding it."""
    if is_muted():
        return
    if is_terminal():
        stdout().print(text, markup=False, soft_wrap=True)
    else:
        typer.echo(text)


def tell(text: str) -> None:
    """Print a line, folded between words on a terminal, unfolded where a program reads it."""
    for line in fold_line(text, stdout().width) if is_terminal() else [text]:
        say(line)


def document(content: object) -> None:
    """Print one JSON document on standard output, even where `muted` suppresses the rest."""
    typer.echo(as_json(content))


def as_json(content: object) -> str:
    """Return content as JSON text; NaN and infinities are written as null."""
    return json.dumps(_without_nan(content), indent=2, ensure_ascii=False, allow_nan=False)


def table(columns: Sequence[str], rows: Rows, *, right: Collection[str] = ()) -> None:
    """Print a table without losing any word: folded on a terminal, else as plain text.

    Parameters
    ----------
    columns : sequence of str
        Headings.
    rows : sequence of sequence of str
        The cells of each row, one for each column.
    right : collection of str
        Headings of the columns that are aligned to the right.
    """
    if is_muted():
        return
    if not is_terminal():
        for line in plain_lines(columns, rows):
            say(line)
        return
    _draw_table(columns, rows, right)


def _draw_table(columns: Sequence[str], rows: Rows, right: Collection[str]) -> None:
    """Print a table on a terminal: as a grid, or as blocks of lines where that is too wide."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    grid = Table(box=box.SIMPLE)
    for column, width in zip(columns, least_widths(columns, rows), strict=True):
        grid.add_column(
            column,
            overflow="fold",
            min_width=width,
            justify="right" if column in right else "left",
        )
    for row in rows:
        grid.add_row(*map(Text, row))
    console = stdout()
    boundless = console.options.update(max_width=10_000)
    if console.measure(grid, options=boundless).minimum <= console.width:
        console.print(grid)
        return
    say("")
    for line in block_lines(columns, rows, console.width):
        say(line)
    say("")


@contextmanager
def progress(label: str, size: int | None = None) -> Iterator[Callable[[float], None]]:
    """Show a progress bar on the error stream while the block runs; yield a function to advance it.

    That function takes the share of the work done since its last call, 0 to 1. `label` stands
    before the bar; `size` is the number of bytes of the whole, if bytes are to be shown.
    """
    if is_muted() or not is_terminal(sys.stderr):
        with stopwatch.telling(_announcing(label)):
            yield lambda done: None
        return
    with _bar(label, size) as advance:
        yield advance


@contextmanager
def _bar(label: str, size: int | None) -> Iterator[Callable[[float], None]]:
    """Show the bar of `progress` while the block runs; yield the function that advances it."""
    from rich.progress import (
        BarColumn,
        DownloadColumn,
        Progress,
        ProgressColumn,
        TextColumn,
        TimeRemainingColumn,
        TransferSpeedColumn,
    )

    in_bytes: tuple[ProgressColumn, ...] = (DownloadColumn(), TransferSpeedColumn())
    bar = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        *(() if size is None else in_bytes),
        TimeRemainingColumn(),
        console=stderr(),
        transient=True,
    )
    with bar:
        task = bar.add_task(label, total=size or 1.0)

        def tell(compiles: bool) -> None:
            """Note beside the progress bar that code is being compiled, or that this has ended."""
            more = ", compiling once" if compiles else ""
            bar.update(task, description=f"{label}{more}")

        with stopwatch.telling(tell):
            yield lambda done: bar.advance(task, done * (size or 1.0))


def _announcing(label: str) -> Callable[[bool], None]:
    """Return a listener of the stopwatch that says once, where no bar is shown, why it takes long.

    `label` begins the line; a muted console stays so.
    """
    announced = is_muted()

    def tell(compiles: bool) -> None:
        """Print the line when compiling begins."""
        nonlocal announced
        if compiles and not announced:
            announced = True
            typer.echo(f"{label}: {ONCE}", err=True)

    return tell


def _without_nan(content: object) -> object:
    if isinstance(content, float) and not math.isfinite(content):
        return None
    if isinstance(content, dict):
        return {key: _without_nan(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_without_nan(value) for value in content]
    return content


@contextmanager
def needing(extra: str, package: str = "") -> Iterator[None]:
    """Exit with the command that installs an extra, if the block misses a module.

    `package` is the one that is named where vibrafeed is installed from a wheel; by default all of
    the extra.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        if (error.name or "vibrafeed").partition(".")[0] == "vibrafeed":
            raise
        fail(f"{error.name} is missing. Install it: {installing(package, extra)}")
        raise typer.Exit(FAILED) from None


def plain_lines(columns: Sequence[str], rows: Rows) -> Iterator[str]:
    """Yield the lines of a table as text in aligned columns, headings first; no cell is cut.

    `columns` are the headings, `rows` the cells of each row; empty cells become `-`. This is how
    tables are printed where there is no terminal.
    """
    lines = [[*columns], *([cell or "-" for cell in row] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    for row in lines:
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
    beside = [0]
    used = len(GAP) + natural[0]
    for number, letters in enumerate(natural[1:], 1):
        if letters <= LONG and used + len(GAP) + letters <= width:
            beside.append(number)
            used += len(GAP) + letters
    widths = [natural[number] for number in beside]
    below = [number for number in range(len(columns)) if number not in beside]
    yield GAP + _align_cells([columns[number] for number in beside], widths)
    if len(below) == 1:
        yield " " * INDENT + columns[below[0]]
    for row in rows:
        yield from fold_line(GAP + _align_cells([row[number] for number in beside], widths), width)
        for number in below:
            name = f"{columns[number]}: " if len(below) > 1 else ""
            if row[number]:
                yield from fold_line(f"{' ' * INDENT}{name}{row[number]}", width)


def _align_cells(cells: Sequence[str], widths: Sequence[int]) -> str:
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
