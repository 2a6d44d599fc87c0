"""Studies with a measured drive: from the recording that they name to the numbers of its fit."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.errors import Problem, StudyError
from core.measured.drive import Fit
from core.measured.fit import fit_drive
from core.measured.read import Table, read_table
from core.measured.recording import Recording
from core.study.drive import MeasuredDrive, RecordedDrive
from core.study.load import parse_recorded

MOST_ROWS_SENT = 20_000  # of a stranger's recording, whose fit takes a second
DIGITS = 10  # of what is kept: more than a fit tells, fewer than differ between processors
SENT = "data"  # the name of a recording without a file


def with_drive(content: Mapping[str, Any], *, files: bool = False) -> tuple[dict[str, Any], Fit]:
    """Return the content of a study with the numbers of its recording, and the fit.

    What the study gives itself, as a parameter, variable or uncertain one, stays as it is.

    Parameters
    ----------
    content : mapping
        Of a study that names a recording.
    files : bool
        Whether the user may name files of this machine, and record more than `MOST_ROWS_SENT` rows.

    Raises
    ------
    StudyError
        With every problem of the recording.
    """
    record, fit = _measured(content["drive"], files=files)
    places = ("parameters", "variables", "uncertain", "unknowns")
    own = [given for name in places if isinstance(given := content.get(name), Mapping)]
    numbers = {n: v for n, v in record.numbers.items() if not any(n in given for given in own)}
    parameters = content.get("parameters", {})
    if isinstance(parameters, Mapping):  # if it is none, its reader says so
        parameters = {**parameters, **numbers}
    drive = record.model_dump(exclude_none=True)
    return {**content, "parameters": parameters, "drive": drive}, fit


def _measured(drive: Mapping[str, Any], files: bool) -> tuple[MeasuredDrive, Fit]:
    """Return what a study keeps of the recording that it names, and its fit."""
    given = parse_recorded(drive)
    source = _source(given, files)
    place = "drive.file" if isinstance(source, Path) else "drive.data"
    try:
        fit = fit_drive(_table(source, place, files), _recording(given))
        digest = _digest(source)
    except StudyError as error:
        raise StudyError(_placed(problem, place) for problem in error.problems) from None
    except (OSError, ValueError) as error:  # a NUL in its name is the second
        message = f"it cannot be read: {getattr(error, 'strerror', None) or error}"
        raise StudyError([Problem(place, message, "Name a CSV beside the study")]) from None
    name = source.name if isinstance(source, Path) else SENT
    return _record_of(fit, name, digest), fit


def _record_of(fit: Fit, name: str, digest: str) -> MeasuredDrive:
    """Return what is kept of a fit to a recording of some name and SHA-256."""
    shares: dict[Any, float] = dict(zip(fit.axes, map(_kept, fit.left_over), strict=True))
    return MeasuredDrive(
        name=name,
        sha256=digest,
        left_over=shares,
        clock_error=None if fit.clock is None else _kept(fit.clock.error),
        numbers={name: _kept(value) for name, value in fit.parameters().items()},
    )


def _kept(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _source(given: RecordedDrive, files: bool) -> str | Path:
    """Return the text or the file of a recording."""
    if (given.file is None) == (given.data is None):
        message = "it names no recording" if given.file is None else "both file and data are given"
        raise StudyError([Problem("drive", message, _which(files))])
    if given.data is not None:
        return given.data
    if not files:
        raise StudyError([Problem("drive.file", "no file is read here", _which(files))])
    assert given.file is not None
    return given.file


def _which(files: bool) -> str:
    text = "data = the text of the recording's CSV"
    return f"Give file = its name, or {text}" if files else f"Give {text}"


def _table(source: str | Path, place: str, files: bool) -> Table:
    # Most lines are rows: what has far too many is not read.
    lines = source.count("\n") if isinstance(source, str) else 0
    if not files and lines > 2 * MOST_ROWS_SENT:
        raise StudyError([_too_long(place, lines, "lines")])
    table = read_table(source)
    if not files and len(table.lines) > MOST_ROWS_SENT:
        raise StudyError([_too_long(place, len(table.lines), "rows")])
    return table


def _too_long(place: str, count: int, what: str) -> Problem:
    message = f"it has {count:,} {what}, the limit over HTTP is {MOST_ROWS_SENT:,}"
    return Problem(place, message, "Cut it: one second of recording is enough")


def _recording(given: RecordedDrive) -> Recording:
    asked = given.model_dump(exclude_none=True, exclude={"file", "data"})
    return Recording(**asked)


def _digest(source: str | Path) -> str:
    if isinstance(source, str):
        return hashlib.sha256(source.encode("utf-8", "surrogatepass")).hexdigest()
    with source.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _placed(problem: Problem, place: str) -> Problem:
    """Return a problem of a recording where a study has what it is about."""
    if problem.place == "recording":
        return Problem(place, problem.message, problem.fix)
    return problem if problem.place.startswith("drive.") else problem.below("drive")
