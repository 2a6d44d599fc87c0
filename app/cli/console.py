"""The console: lines, empty tables, a progress bar."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich import box
from rich.console import Console
from rich.progress import (
    BarColumn,
    DownloadColumn,
    Progress,
    ProgressColumn,
    TextColumn,
    TimeRemainingColumn,
    TransferSpeedColumn,
)
from rich.table import Table as Grid

from core.compiling import stopwatch

stdout = Console(highlight=False)
stderr = Console(stderr=True, highlight=False)


def fail(message: str) -> None:
    """Print an error that is not about a study."""
    stderr.print(message, style="red", markup=False, soft_wrap=True)


@contextmanager
def progress(label: str, size: int | None = None) -> Iterator[Callable[[float], None]]:
    """Show a progress bar on the error stream while the block runs; yield what advances it.

    It takes the share of the work done since the last call. `size` are the bytes of the whole.
    """
    in_bytes: tuple[ProgressColumn, ...] = (DownloadColumn(), TransferSpeedColumn())
    bar = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        *(() if size is None else in_bytes),
        TimeRemainingColumn(),
        console=stderr,
        transient=True,
        disable=not stderr.is_terminal,
    )
    with bar:
        task = bar.add_task(label, total=size or 1.0)

        def tell(compiles: bool) -> None:
            more = ", compiling once" if compiles else ""
            bar.update(task, description=f"{label}{more}")

        with stopwatch.telling(tell):
            yield lambda done: bar.advance(task, done * (size or 1.0))


def new_grid(*columns: str) -> Grid:
    """Return an empty table; names, in its first column, are never broken."""
    grid = Grid(box=box.SIMPLE)
    for number, column in enumerate(columns):
        grid.add_column(column, no_wrap=number == 0, min_width=12 if number else None)
    return grid


def say(text: str) -> None:
    """Print a line as it is, however long."""
    stdout.print(text, markup=False, soft_wrap=True)
