"""Parts of sweeps: one of them, and their joining."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from app.cli import console
from app.cli.options import FAILED
from app.cli.studies import interruption, refuse
from core.dataset.records import Records
from core.errors import Problem, VibrafeedError
from core.plan.parts import ARRAYS, MAX_PARTS, SHARDS, PartsMissingError, ranges
from core.sweep.targets import is_zarr
from core.watch import Watch

if TYPE_CHECKING:
    from core.plan.parts import Parts
    from core.plan.prepared import Prepared

_OF = re.compile(r"\d+-of-(\d+)")
_PART = re.compile(r"(\d{1,9})/(\d{1,9})")


def run_part(studies: Mapping[Path, Prepared], targets: Mapping[Path, str], part: str) -> None:
    """Compute one part of a study and store its record; a part with a record is skipped.

    `part` is typed as `k/n`, with k from 0. `studies` and `targets` are by the study's file, and
    have one entry.
    """
    path, target = single_study(studies, targets)
    number, count = _numbers(path, part)
    parts = parts_of(path, studies[path], target, count)
    name = f"part {number} of {count:,}"
    with report_errors(path, target):
        if parts.is_there(number):
            console.say(f"{path}: {name} exists already")
            return
        started = time.perf_counter()
        with console.progress(f"{path.name}, {name}") as advance, interruption() as interrupted:
            record = parts.compute(number, Watch(advance, interrupted))
        parts.keep(number, record)
    first, last = parts.ends(number)
    seconds = time.perf_counter() - started
    console.say(f"{path}: {name}, {last - first:,} boxes: {seconds:.1f} s")


def join_parts(path: Path, parts: Parts, history: str) -> None:
    """Join all computed parts of a study into its result; exit and name the missing parts.

    `path` is the study's file; `history` is the CF attribute of the result.
    """
    with report_errors(path, parts.where):
        try:
            with console.progress(f"{path.name}, joining") as advance, interruption() as stopped:
                table = parts.join(Watch(advance, stopped), history=history)
        except PartsMissingError as error:
            console.fail(f"{path}: of {parts.count:,} parts {error}.")
            again = ranges(error.numbers)
            console.fail(f"Compute these again (--array={again}), and join again.")
            raise typer.Exit(FAILED) from None
    console.say(
        f"{path} -> {parts.where}: {parts.cells:,} cells in {parts.count:,} parts, "
        f"{len(table.variables)} variables"
    )


def single_study(studies: Mapping[Path, Prepared], targets: Mapping[Path, str]) -> tuple[Path, str]:
    """Return file and target of the study of a command that takes one; exit if there are more."""
    if len(studies) > 1:
        problem = Problem(
            "part",
            f"this command computes the parts of one study, not of {len(studies)} studies",
            "Give one study file",
        )
        refuse({path: [problem] for path in studies})
    return next(iter(targets.items()))


def parts_of(path: Path, prepared: Prepared, target: str, count: int) -> Parts:
    """Return the parts of a study cut into `count`; exit if this study or target has no parts.

    `path` is the study's file; `target` is the path or URL of its result.
    """
    problem = None
    if not prepared.part_of:
        problem = Problem(
            "kind",
            "only sweeps can be computed in parts, not studies of this kind",
            "Leave out --part or --scheduler",
        )
    elif prepared.part_of == SHARDS and not is_zarr(target):
        message = "the parts of a sweep are written as shards of one Zarr group"
        problem = Problem(
            "output",
            message,
            "Write the result to a Zarr group: -o result.zarr, or -o s3://bucket/key",
        )
    elif prepared.part_of == ARRAYS and is_zarr(target):
        problem = Problem(
            "output",
            "the parts of a reduced sweep ([reduce]) are joined in a NetCDF file, not "
            "in a Zarr group",
            "Write -o result.nc",
        )
    elif not 1 <= count <= MAX_PARTS:
        problem = Problem("part", f"{count:,} parts", f"Take 1 to {MAX_PARTS:,}")
    else:
        return prepared.parts(target, count)
    return refuse({path: [problem]})


def _numbers(path: Path, part: str) -> tuple[int, int]:
    """Return the numbers k and n of a part typed as `k/n`; exit if the text is not of this form.

    `path` is the study's file, which the message names.
    """
    found = _PART.fullmatch(part)
    number, count = (int(found[1]), int(found[2])) if found else (0, 0)
    if number < count:
        return number, count
    message = f"'{part[:40]}' is not a part"
    fix = "Parts are numbered from 0: write 0/4096 for the first, 4095/4096 for the last"
    return refuse({path: [Problem("part", message, fix)]})


def counts_of(target: str) -> set[int]:
    """Return the counts of parts that results of this target were cut into, from stored records."""
    names = Records(target).names()
    return {int(found[1]) for name in names if (found := _OF.fullmatch(name))}


@contextmanager
def report_errors(path: Path, target: str) -> Iterator[None]:
    """Print errors of files and clusters that are raised in the block, and exit with code 1.

    `path` is the study's file; `target` is the path or URL of its result.
    """
    try:
        yield
    except OSError as error:
        console.fail(f"{target} cannot be written: {error.strerror or error}.")
    except VibrafeedError as error:
        console.fail(f"{path}: {error}.")
    else:
        return
    raise typer.Exit(FAILED)
