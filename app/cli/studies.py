"""Studies from files: read, checked and refused; Ctrl-C; and text files that commands write."""

import os
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED, INVALID_INPUT
from vibrafeed.core.compiling import stopwatch
from vibrafeed.core.errors import LimitError, Problem, StudyError, refused

if TYPE_CHECKING:
    from vibrafeed.core.plan.prepared import Prepared

INTERRUPTED = 130
"""Exit code after Ctrl-C, as of programs that the signal kills: 128 + 2."""

PYTHONS_TURN = 0.5
"""Seconds that Python has to end the program by itself; it does unless LLVM is amid its work."""

SHOW_CURSOR = "\x1b[?25h"
"""What a terminal shows its cursor by, which a progress bar hides."""

REPLACE = "Add --force to replace it, or give another name"

STANDARD = Path("-")
"""Standard input where a study is read, standard output where a result is written."""


class Batch(dict[Path, "Prepared"]):
    """Prepared studies by their files, the warnings of each that has any, and what was refused."""

    def __init__(self) -> None:
        super().__init__()
        self.warnings: dict[Path, list[str]] = {}
        self.refused: dict[Path, Sequence[Problem]] = {}

    @property
    def count_of_warnings(self) -> str:
        """The number of warnings, as in "2 warnings in 1 of 10 studies"; empty without any."""
        count, studies = sum(map(len, self.warnings.values())), len(self)
        suffix = f" in {len(self.warnings):,} of {studies:,} studies" if studies > 1 else ""
        return f"{count:,} warning{'s' * (count > 1)}{suffix}" if count else ""

    def refusals(self) -> list[dict[str, Any]]:
        """Return the studies that were refused, for programs, each with its problems."""
        return [
            {"study": str(path), "errors": [problem.document() for problem in problems]}
            for path, problems in self.refused.items()
        ]

    def with_warnings(self, facts: Mapping[str, Any]) -> dict[str, Any]:
        """Return the facts on a study, for programs, with the warnings of its file."""
        return {**facts, "warnings": self.warnings.get(Path(facts["study"]), [])}


def prepare_all(
    files: Sequence[Path],
    *,
    cells: int | None = None,
    bytes_: int | None = None,
    strict: bool = False,
    keep_going: bool = False,
) -> Batch:
    """Read and prepare the study of each file; print every error of every file and exit.

    `cells` and `bytes_` are the largest size that is accepted, if any. Unusual values are allowed,
    and a line on the error stream warns of each; with `strict` they are refused. With `keep_going`
    the studies that are right are returned, if there are any.
    """
    from vibrafeed.core import intake

    prepared = Batch()
    for path in files:
        try:
            study = intake.prepare_content(content_of(path), files=True)
            study.check_limits(cells=cells, bytes_=bytes_)
            prepared[path] = study
            if study.questions:
                prepared.warnings[path] = [*study.questions]
        except StudyError as error:
            prepared.refused[path] = error.problems
        except LimitError as error:
            prepared.refused[path] = [Problem("parameters", error.message, error.fix)]
    for path, lines in prepared.warnings.items():
        warn(name_of(path), lines)
    tell(prepared.refused)
    if prepared.refused and not (keep_going and prepared):
        raise typer.Exit(INVALID_INPUT)
    if strict and prepared.warnings:
        count = prepared.count_of_warnings
        typer.echo(f"error: {count}; --strict runs no study then", err=True)
        raise typer.Exit(INVALID_INPUT)
    return prepared


def warn(name: object, lines: Iterable[str]) -> None:
    """Print warnings of a study on the error stream, each behind the `name` of its file."""
    for line in lines:
        typer.echo(f"{name}: warning: {line}", err=True)


def name_of(path: Path) -> str:
    """Return the path as text, or `standard input`."""
    return "standard input" if path == STANDARD else str(path)


def content_of(path: Path) -> object:
    """Return the content of a study file, or of standard input: TOML or a JSON object.

    Raises
    ------
    StudyError
        If it is neither.
    """
    from vibrafeed.core import intake

    if path != STANDARD:
        return intake.read_content(path)
    try:
        text = typer.get_binary_stream("stdin").read().decode("utf-8-sig")
    except UnicodeDecodeError:
        raise refused(
            "file", "standard input is not UTF-8 text", "Encode the study in UTF-8"
        ) from None
    return intake.read_json(text) if text.lstrip().startswith("{") else intake.read_toml(text)


def refuse(problems_of: Mapping[Path, Sequence[Problem]]) -> NoReturn:
    """Print all problems of all files on the error stream, and exit with code 2.

    `problems_of` has the problems by file, or by the name of an option.
    """
    tell(problems_of)
    raise typer.Exit(INVALID_INPUT)


def tell(problems_of: Mapping[Path, Sequence[Problem]]) -> None:
    """Print all problems of all files on the error stream."""
    for path, problems in problems_of.items():
        count = len(problems)
        typer.echo(f"{name_of(path)}: error: {count} problem{'s' if count > 1 else ''}", err=True)
        for problem in problems:
            typer.echo(f"  {problem}", err=True)


def refuse_clashes(targets: Mapping[Path, Path | str]) -> None:
    """Exit if two results would have one path; `targets` holds that of each study's result."""
    everything = [*targets.values()]
    message = "several studies would write to {}"
    fix = "Rename a study, or give another folder with -o"
    clashes = {
        file: [Problem("output", message.format(target), fix)]
        for file, target in targets.items()
        if everything.count(target) > 1
    }
    if clashes:
        refuse(clashes)


def refuse_beyond_memory(path: Path, prepared: "Prepared") -> None:
    """Exit if the result of a study needs more memory than this machine has.

    `path` is the study's file, which the message names.
    """
    from vibrafeed.core.system import memory

    size = memory()
    if prepared.bytes > size:
        message = f"the result of {prepared.bytes:,} bytes exceeds the memory of {size:,} bytes"
        refuse({path: [Problem("parameters", message, prepared.what_fits(size / prepared.bytes))]})


@contextmanager
def interruption(
    *, gently: bool = True, has_begun: Callable[[], bool] = lambda: True
) -> Iterator[Callable[[], bool]]:
    """Let Ctrl-C stop a study between cells.

    Yield a function that returns True once it was pressed. A second Ctrl-C raises
    `KeyboardInterrupt`. So does the first if there is nothing to keep: if `gently` is False, or
    `has_begun` returns False.
    """
    pressed = threading.Event()

    def interrupt(number: int, frame: object) -> None:
        """Handle Ctrl-C: stop gently at first, at once if pressed again or before the start."""
        if pressed.is_set() or not gently or not has_begun():
            raise KeyboardInterrupt
        pressed.set()

    before = signal.signal(signal.SIGINT, interrupt)
    try:
        yield pressed.is_set
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def interruptible_compiler(last_words: str) -> Iterator[None]:
    """Let Ctrl-C end the program while it compiles; print `last_words` on the error stream.

    Python handles a signal between two of its own steps, and LLVM takes seconds for one. So a
    thread reads the signals where Python's handler in C writes them, and ends the process if
    Python itself has not come to it in time. Files under way appear whole or not at all.
    """
    reader, writer = os.pipe()
    if hasattr(os, "set_blocking"):  # Windows, before Python 3.12, wants no such pipe
        os.set_blocking(writer, False)

    def watch_signals() -> None:
        """End the program if Ctrl-C comes while LLVM compiles."""
        while number := os.read(reader, 1):
            if number[0] == signal.SIGINT and stopwatch.is_running:
                time.sleep(PYTHONS_TURN)
                if stopwatch.is_running:
                    cursor = f"\n{SHOW_CURSOR}" if console.shows_codes() else ""
                    os.write(2, f"{cursor}{last_words}\n".encode())
                    os._exit(INTERRUPTED)
        os.close(reader)

    before = signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    threading.Thread(target=watch_signals, name="interrupts", daemon=True).start()
    try:
        yield
    finally:
        signal.set_wakeup_fd(before)
        os.close(writer)


def refuse_existing(source: str, target: str, *, force: bool) -> None:
    """Exit if a file would replace an existing one, unless `force` is True.

    `source` is the file that it is derived from, which the message names; URLs and Zarr groups are
    not checked here.
    """
    if not force and "://" not in target and Path(target).is_file():
        refuse({Path(source): [Problem("output", f"{target} exists already", REPLACE)]})


def write_text(file: Path, text: str) -> None:
    """Write text to a file; print the reason and exit if it cannot be written."""
    try:
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        console.fail(f"{file}: {error.strerror or error}.")
        raise typer.Exit(FAILED) from None
