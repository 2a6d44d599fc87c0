"""Parts of sweeps: one of them, all of them on a scheduler, and their joining."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.existing import refuse_others
from app.cli.options import FAILED
from app.cli.studies import interruption, prepare_all, refuse
from core.errors import Problem, StoppedError, VibrafeedError

if TYPE_CHECKING:
    from core.plan.parts import Parts
    from core.plan.prepared import Prepared

_PART = re.compile(r"(\d{1,9})/(\d{1,9})")
_OF = re.compile(r"\d+-of-(\d+)")


def run_part(studies: Mapping[Path, Prepared], targets: Mapping[Path, str], part: str) -> None:
    """Compute one part of a study and keep its record; a part that is there is left alone."""
    from app.cli import console

    path, target = _only(studies, targets)
    number, count = _numbers(path, part)
    parts = _parts(path, studies[path], target, count)
    name = f"part {number} of {count:,}"
    with _failing(path, target):
        if parts.is_there(number):
            console.say(f"{path}: {name} is there already")
            return
        started = time.perf_counter()
        with console.progress(f"{path.name}, {name}") as advance, interruption() as interrupted:
            from core.watch import Watch

            record = parts.compute(number, Watch(advance, interrupted))
        parts.keep(number, record)
    first, last = parts.ends(number)
    seconds = time.perf_counter() - started
    console.say(f"{path}: {name}, {last - first:,} boxes: {seconds:.1f} s")


def run_on_scheduler(
    studies: Mapping[Path, Prepared],
    targets: Mapping[Path, str],
    address: str,
    count: int | None,
    history: str,
) -> None:
    """Have all parts that are not there computed by a Dask cluster, and join them."""
    import distributed

    from app.cli import console
    from app.jobs.cluster import by_name
    from app.jobs.parts import compute_part, sensible_count

    path, target = _only(studies, targets)
    target = target if "://" in target else str(Path(target).resolve())
    sweep = studies[path]
    _parts(path, sweep, target, 1)  # which it may not have there
    begun = _counts(target)
    if count is None:
        count = begun.pop() if len(begun) == 1 else sensible_count(sweep)
    parts = _parts(path, sweep, target, count)
    missing = [part for part in range(count) if not parts.is_there(part)]
    console.say(f"{path}: {len(missing):,} of {count:,} parts to compute on {address}")
    with (
        _failing(path, target),
        distributed.Client(address, timeout=20) as client,  # type: ignore[no-untyped-call]
        interruption() as interrupted,
        console.progress(path.name) as advance,
    ):
        study = sweep.study.canonical()
        numbers = {
            client.submit(
                by_name(compute_part), study, target, count, part, pure=False, retries=2
            ): part
            for part in missing
        }
        done = distributed.as_completed(list(numbers), with_results=True)  # type: ignore[no-untyped-call]
        for future, record in done:
            if interrupted():
                client.cancel(list(numbers))
                raise StoppedError("it was stopped; the same command goes on with what is done")
            parts.keep(numbers.pop(future), record)
            advance(1 / len(missing))
    _join(path, parts, history)


def join(
    file: Annotated[Path, typer.Argument(help="The study, TOML or JSON.", show_default=False)],
    output: Annotated[
        str, typer.Option("-o", "--output", help="The result, as given to run --part.")
    ],
    parts: Annotated[
        int | None, typer.Option(min=1, help="Number of parts; told from what is there.")
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace a file with the result of another study.")
    ] = False,
) -> None:
    """Join the parts that `vibrafeed run --part` has computed, and give the result its name.

    Each part is checked by its digest. Exit code 1 means that some are missing or damaged; which,
    is told as a queue takes it: compute these again, and join again.
    """
    studies = prepare_all([file])
    refuse_others(studies, {file: output}, force=force)
    counts = {parts} if parts is not None else _counts(output)
    if len(counts) != 1:
        told = f"there are parts of {', '.join(map(str, sorted(counts)))}" if counts else "no part"
        message = f"{told} beside {output}" if counts else f"there is no part beside {output}"
        fix = "Give --parts" if counts else "Compute them with vibrafeed run --part 0/N, 1/N, ..."
        refuse({file: [Problem("parts", message, fix)]})
    stamp = datetime.now(UTC).isoformat(timespec="seconds")
    history = f"{stamp} vibrafeed join {file.name}"
    _join(file, _parts(file, studies[file], output, counts.pop()), history)


def _join(path: Path, parts: Parts, history: str) -> None:
    from app.cli import console
    from core.plan.parts import PartsMissingError, ranges
    from core.watch import Watch

    with _failing(path, parts.where):
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


def _only(studies: Mapping[Path, Prepared], targets: Mapping[Path, str]) -> tuple[Path, str]:
    """Return the one study, and where it goes; exit if there are more."""
    if len(studies) > 1:
        problem = Problem("part", "parts are of one study", "Give one file")
        refuse({path: [problem] for path in studies})
    return next(iter(targets.items()))


def _parts(path: Path, prepared: Prepared, target: str, count: int) -> Parts:
    """Return the parts of a study; exit if it can have none, or none there."""
    from core.plan.parts import ANSWERS, MOST_PARTS, SHARDS
    from core.sweep.targets import is_zarr

    problem = None
    if not prepared.part_of:
        problem = Problem("kind", "only sweeps are computed in parts", "Leave --part out")
    elif prepared.part_of == SHARDS and not is_zarr(target):
        message = "the parts of a sweep are shards of a Zarr group"
        problem = Problem("output", message, "Write -o result.zarr, or s3://bucket/key")
    elif prepared.part_of == ANSWERS and is_zarr(target):
        problem = Problem("output", "what is reduced goes to NetCDF", "Write -o result.nc")
    elif not 1 <= count <= MOST_PARTS:
        problem = Problem("part", f"{count:,} parts", f"Take 1 to {MOST_PARTS:,}")
    else:
        return prepared.parts(target, count)
    return refuse({path: [problem]})


def _numbers(path: Path, part: str) -> tuple[int, int]:
    """Return the number of a part and of all; exit if the text does not name one."""
    found = _PART.fullmatch(part)
    number, count = (int(found[1]), int(found[2])) if found else (0, 0)
    if number < count:
        return number, count
    message = f"'{part[:40]}' is no part"
    fix = "Parts are numbered from 0: write 0/4096 for the first, 4095/4096 for the last"
    return refuse({path: [Problem("part", message, fix)]})


def _counts(target: str) -> set[int]:
    """Return into how many parts a result has been cut, as records tell."""
    from core.dataset.records import Records

    names = Records(target).names()
    return {int(found[1]) for name in names if (found := _OF.fullmatch(name))}


@contextmanager
def _failing(path: Path, target: str) -> Iterator[None]:
    """Tell errors that are not of the study, and exit with code 1."""
    from app.cli import console

    try:
        yield
    except OSError as error:
        console.fail(f"{target} cannot be written: {error.strerror or error}.")
    except VibrafeedError as error:
        console.fail(f"{path}: {error}.")
    else:
        return
    raise typer.Exit(FAILED)
