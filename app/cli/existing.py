"""Results that are there already: not replaced unasked, and not computed again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from vibrafeed.app.cli.studies import REPLACE, refuse
from vibrafeed.core.dataset.formats import read_result
from vibrafeed.core.errors import Problem
from vibrafeed.core.kinds import is_whole
from vibrafeed.core.plan.sample import LEFT_OUT
from vibrafeed.core.sweep.targets import attributes_there, is_complete, is_zarr

if TYPE_CHECKING:
    from vibrafeed.core.plan.prepared import Prepared

REMOVE = "Remove the existing output, or give another name"


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
        if resume and is_complete(target, studies[path]):
            if _is_whole(studies[path], target):
                complete.append(path)
            continue
        if not force or is_zarr(target):
            fix = REMOVE if is_zarr(target) else REPLACE
            problems[path] = [Problem("output", f"{target} exists already", fix)]
    if problems:
        refuse(problems)
    return complete


def refuse_others(
    studies: Mapping[Path, Prepared], targets: Mapping[Path, str], *, force: bool
) -> None:
    """Exit if shares would be joined into a file that holds the result of another study.

    `studies` and `targets` are by the study's file; `force` allows it. The shards of a Zarr group
    are checked one by one where they are computed.
    """
    files = {path: target for path, target in targets.items() if not is_zarr(target)}
    complete_already(studies, files, resume=True, force=force)


def _is_whole(prepared: Prepared, target: str) -> bool:
    """True if every cell of the result in a file is computed and, if requested, verified.

    `target` is the path of the result; `prepared` is its study.
    """
    if not prepared.keeps_some:  # it may be large, and is written when it is computed
        return LEFT_OUT not in attributes_there(target)
    return is_whole(read_result(target))
