"""The console: lines, tables, documents for programs, a progress bar."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager

import rich.table
import typer
from rich import box
from rich.console import Console
from rich.text import Text

from vibrafeed.app.cli.layout import Rows, block_lines, fold_line, least_widths, plain_lines
from vibrafeed.core.compiling import ONCE, stopwatch

stdout = Console(highlight=False)
stderr = Console(stderr=True, highlight=False)


@contextmanager
def muted(asked: bool) -> Iterator[None]:
    """Suppress printed lines, tables and progress bars inside the block, if `asked` is True."""
    before, stdout.quiet = stdout.quiet, asked
    try:
        yield
    finally:
        stdout.quiet = before


def fail(message: str) -> None:
    """Print an error message on the error stream; problems of a study are printed by `refuse`."""
    stderr.print(message, style="red", markup=False, soft_wrap=True)


def shows_codes() -> bool:
    """True if the error stream is a terminal that follows control codes, as old ones do not."""
    return stderr.is_terminal and not stderr.legacy_windows


def say(text: str) -> None:
    """Print a line of any length without folding it."""
    stdout.print(text, markup=False, soft_wrap=True)


def tell(text: str) -> None:
    """Print a line, folded between words on a terminal, unfolded where a program reads it."""
    for line in fold_line(text, stdout.width) if stdout.is_terminal else [text]:
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
    if not stdout.is_terminal:
        for line in plain_lines(columns, rows):
            say(line)
        return
    grid = rich.table.Table(box=box.SIMPLE)
    for column, width in zip(columns, least_widths(columns, rows), strict=True):
        grid.add_column(
            column,
            overflow="fold",
            min_width=width,
            justify="right" if column in right else "left",
        )
    for row in rows:
        grid.add_row(*map(Text, row))
    boundless = stdout.options.update(max_width=10_000)
    if stdout.measure(grid, options=boundless).minimum <= stdout.width:
        stdout.print(grid)
        return
    say("")
    for line in block_lines(columns, rows, stdout.width):
        say(line)
    say("")


@contextmanager
def progress(label: str, size: int | None = None) -> Iterator[Callable[[float], None]]:
    """Show a progress bar on the error stream while the block runs; yield a function to advance it.

    That function takes the share of the work done since its last call, 0 to 1. `label` stands
    before the bar; `size` is the number of bytes of the whole, if bytes are to be shown.
    """
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
        console=stderr,
        transient=True,
        disable=stdout.quiet or not stderr.is_terminal,
    )
    with bar:
        task = bar.add_task(label, total=size or 1.0)

        announced = stdout.quiet

        def tell(compiles: bool) -> None:
            """Note beside the progress bar that code is being compiled, or that this has ended.

            Where no bar is shown, one line says so instead, once.
            """
            nonlocal announced
            more = ", compiling once" if compiles else ""
            bar.update(task, description=f"{label}{more}")
            if compiles and bar.disable and not announced:  # nobody sees the bar
                announced = True
                stderr.print(f"{label}: {ONCE}", markup=False)

        with stopwatch.telling(tell):
            yield lambda done: bar.advance(task, done * (size or 1.0))


def _without_nan(content: object) -> object:
    """Return JSON content with NaN and infinities replaced by None, at any depth."""
    if isinstance(content, float) and not math.isfinite(content):
        return None
    if isinstance(content, dict):
        return {key: _without_nan(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_without_nan(value) for value in content]
    return content
