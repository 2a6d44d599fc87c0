"""The targets of results: files by suffix, folders, paths that are refused, and what is there."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from vibrafeed import core
from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED
from vibrafeed.app.cli.studies import REPLACE, STANDARD, refuse, refuse_clashes
from vibrafeed.core.dataset.files import Storage
from vibrafeed.core.dataset.formats import (
    FORMATS,
    ZARR,
    attributes_there,
    is_zarr,
    known_suffixes,
    read_result,
    suffix_of,
    write_result,
)
from vibrafeed.core.dataset.limits import Size
from vibrafeed.core.errors import LimitError, MissingPackageError, Problem
from vibrafeed.core.suggestions import nearest

if TYPE_CHECKING:
    from vibrafeed.core.dataset.table import Table
    from vibrafeed.core.plan.prepared import Prepared

REMOVE = "Remove the existing output, or give another name"


def targets_of(studies: Mapping[Path, Prepared], output: str | None) -> dict[Path, str]:
    """Return the target path of each study's result; exit if a target cannot be written.

    `output` is the option `-o`: a file for one study, a Zarr group, or a folder, that is an
    existing one, a name that ends in a slash, or one without suffix. By default results go beside
    the studies.
    """
    if output is not None and output.rstrip("/").lower().endswith(".zarr"):
        output = output.rstrip("/")
    if output is None or _is_folder(output):
        stems = {file: "study" if file == STANDARD else file.stem for file in studies}
        targets = {
            file: str(Path(output or file.parent) / f"{stem}.nc") for file, stem in stems.items()
        }
    else:
        check_suffix(output)
        if len(studies) > 1:
            problem = Problem("output", f"{output} can hold only one result", "Give a folder")
            refuse({path: [problem] for path in studies})
        targets = dict.fromkeys(studies, output)
    refuse_clashes(targets)
    _check_formats(studies, targets)
    for target in targets.values():
        if "://" not in target:
            make_folder_of(target)
    return targets


def check_suffix(output: str) -> None:
    """Exit if the suffix of an output names no format of results, or its writer is not installed.

    `output` is a path, or the URL of a Zarr group.
    """
    suffix = suffix_of(output)
    problem = None
    if suffix not in FORMATS:
        message = f"'{suffix}' is not a known format of results"
        similar = nearest(suffix, FORMATS)
        hint = f"Did you mean {similar}? " if similar else ""
        fix = f"{hint}End the name in {known_suffixes()}, or in / for a folder"
        problem = Problem("output", message, fix)
    else:
        try:
            FORMATS[suffix].needs()
        except MissingPackageError as error:
            problem = Problem("output", str(error), "Or end the name of the output in .nc or .csv")
    if problem is not None:
        refuse({Path(output): [problem]})


def refuse_choices(storage: Storage, targets: Iterable[str]) -> None:
    """Exit if a choice is given that the format of a target does not leave."""
    given = {
        "--csv-style": (storage.csv_style != "plain", ".csv"),
        "--zarr-version": (storage.zarr_version != 3, ZARR),
    }
    for option, (is_given, suffix) in given.items():
        fix = f"Remove {option}, or end the name of the output in {suffix}"
        problem = Problem(option, f"{option} applies only to {FORMATS[suffix].name}", fix)
        invalid = {Path(target): [problem] for target in targets if suffix_of(target) != suffix}
        if is_given and invalid:
            refuse(invalid)


def make_folder_of(target: str) -> None:
    """Create the folder of an output file; exit if it cannot be created."""
    folder = Path(target).parent
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        problem = Problem("output", f"{folder} cannot be created", str(error.strerror))
        refuse({Path(target): [problem]})


def kept_apart(target: str) -> str:
    """Return the path for an incomplete result: beside an existing file, which may be complete.

    `target` is the path of the complete result; a line on the error stream names the other path,
    which ends in `.partial` and the suffix.
    """
    if not Path(target).exists():
        return target
    suffix = suffix_of(target)
    partial_target = f"{target.removesuffix(suffix)}.partial{suffix}"
    console.fail(f"{target} stays as it was; what is computed goes to {partial_target}.")
    return partial_target


def write_or_exit(path: Path, table: Table, target: str, history: str, storage: Storage) -> None:
    """Write a result to a file; exit with the reason if it cannot be written.

    Parameters
    ----------
    path : Path
        The study's file, which messages name.
    table : Table
        The result.
    target : str
        The path or URL to write to.
    history : str
        The CF attribute of the result.
    storage : Storage
        The choices that the format leaves.
    """
    try:
        write_result(table, target, history=history, storage=storage)
    except LimitError as error:
        refuse({path: [Problem("output", error.message, error.fix)]})
    except FileExistsError as error:
        refuse({path: [Problem("output", str(error), REMOVE)]})
    except OSError as error:
        console.fail(f"{target} cannot be written: {error.strerror or error}.")
        raise typer.Exit(FAILED) from None


def _is_folder(output: str) -> bool:
    """True if an output is a folder for results, not the name of a file or a Zarr group."""
    is_group = "://" in output or output.lower().endswith(".zarr")
    is_named = output.endswith("/") or not Path(output).suffix
    return not is_group and (is_named or Path(output).is_dir())


def _check_formats(studies: Mapping[Path, Prepared], targets: Mapping[Path, str]) -> None:
    """Exit before computing if the format of a file cannot hold the result of its study.

    An Excel sheet, for example, has a largest number of rows. `studies` holds the studies ready to
    be computed, by their files; `targets` the path or URL of each result, by the same files.
    """
    invalid = {}
    for path, prepared in studies.items():
        try:
            FORMATS[suffix_of(targets[path])].check(size_of(prepared))
        except LimitError as error:
            invalid[path] = [Problem("output", error.message, error.fix)]
    if invalid:
        refuse(invalid)


def size_of(prepared: Prepared) -> Size:
    """Return the size of the result of a study."""
    # A table has a row per point of all dimensions together; a file has each output over its own.
    kept = {dim for dims in prepared.dims.values() for dim in dims}
    cells = {
        name: math.prod(prepared.sizes[dim] for dim in dims) for name, dims in prepared.dims.items()
    }
    return Size(
        rows=math.prod(prepared.sizes[dim] for dim in kept),
        columns=len(prepared.plan.parameters) + len(prepared.dims),
        value_bytes=8 * sum(cells.values()),
    )


def complete_already(
    studies: Mapping[Path, Prepared], targets: Mapping[Path, str], *, resume: bool, force: bool
) -> list[Path]:
    """Return the studies whose complete results exist already; exit if a target is taken.

    Parameters
    ----------
    studies, targets : mapping
        The studies by their files, and the path or URL of each one's result.
    resume : bool
        True to leave complete results of these very studies alone, and replace incomplete ones.
    force : bool
        True to replace any existing file; a Zarr group, which is a folder, is never replaced.
    """
    problems: dict[Path, Sequence[Problem]] = {}
    complete = []
    for path, target in targets.items():
        if "://" in target or not Path(target).exists():
            continue  # an object store is looked at when it is opened
        is_same = is_complete(target, studies[path])
        if resume and is_same:
            if _is_whole(studies[path], target):
                complete.append(path)
            continue
        if not force or is_zarr(target):
            fix = REMOVE if is_zarr(target) else REPLACE
            fix = (
                "It is a result of this study: add --resume to keep or continue it. " * is_same
                + fix
            )
            problems[path] = [Problem("output", f"{target} exists already", fix)]
    if problems:
        refuse(problems)
    return complete


def is_complete(target: str, prepared: Prepared) -> bool:
    """True if at a path lies the result that this version made of the same study.

    Results appear only when they are complete.
    """
    attributes = attributes_there(target)
    program = str(attributes.get("source")).partition(",")[0]
    return (
        attributes.get("study_sha256") == prepared.study.key()
        and program == f"vibrafeed {core.__version__}"
    )


def _is_whole(prepared: Prepared, target: str) -> bool:
    """True if every cell of the result in a file is computed and, if requested, verified.

    `target` is the path of the result; `prepared` is its study.
    """
    from vibrafeed.core.kinds import is_whole
    from vibrafeed.core.plan.labels import LEFT_OUT

    if not prepared.keeps_some:  # it may be large, and is written when it is computed
        return LEFT_OUT not in attributes_there(target)
    return is_whole(read_result(target))
