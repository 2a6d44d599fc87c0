"""The console: lines, tables, documents for programs, a progress bar."""

from __future__ import annotations

import functools
import json
import math
import os
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, TextIO

import typer

from vibrafeed.app.cli.layout import Rows, block_lines, fold_line, least_widths, plain_lines
from vibrafeed.core.compiling import ONCE, stopwatch

if TYPE_CHECKING:
    from rich.console import Console

_muted = [False]


@functools.cache
def stdout() -> Console:
    """Return rich's console of standard output, for a terminal; a pipe needs no rich."""
    from rich.console import Console

    return Console(highlight=False)


@functools.cache
def stderr() -> Console:
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
def muted(asked: bool) -> Iterator[None]:
    """Suppress printed lines, tables and progress bars inside the block, if `asked` is True."""
    _muted.append(asked)
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
    """Return JSON content with NaN and infinities replaced by None, at any depth."""
    if isinstance(content, float) and not math.isfinite(content):
        return None
    if isinstance(content, dict):
        return {key: _without_nan(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_without_nan(value) for value in content]
    return content
