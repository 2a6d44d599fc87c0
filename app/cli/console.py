"""The console: lines, empty tables, a progress bar."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich import box
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table as Grid

stdout = Console(highlight=False)
stderr = Console(stderr=True, highlight=False)


def fail(message: str) -> None:
    """Print an error that is not about a study."""
    stderr.print(message, style="red", markup=False, soft_wrap=True)


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """Show a progress bar on the error stream while the block runs; yield what advances it.

    It takes the share of the work done since the last call.
    """
    bar = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeRemainingColumn(),
        console=stderr,
        transient=True,
        disable=not stderr.is_terminal,
    )
    with bar:
        task = bar.add_task(label, total=1.0)
        yield lambda done: bar.advance(task, done)


def new_grid(*columns: str) -> Grid:
    """Return an empty table; names, in its first column, are never broken."""
    grid = Grid(box=box.SIMPLE)
    for number, column in enumerate(columns):
        grid.add_column(column, no_wrap=number == 0, min_width=12 if number else None)
    return grid


def say(text: str) -> None:
    """Print a line as it is, however long."""
    stdout.print(text, markup=False, soft_wrap=True)
