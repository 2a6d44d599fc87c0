"""The section `drive`: from the recording that a study names to the numbers of its fit."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from pydantic import ValidationError

from vibrafeed.core import measured
from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.intake.section import (
    Content,
    Resolved,
    Section,
    advice_on_path,
    no_field,
    problems_of,
)
from vibrafeed.core.measured.csv_table import refused
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.grid_study import (
    MeasuredDrive,
    RecordedDrive,
    names_recording,
    only_the_plain_sine,
)
from vibrafeed.core.study.units import UnitError, read_numbers
from vibrafeed.core.study.unusual import leaves_of

MAX_ROWS_SENT = 20_000  # rows of a recording from the network; fitting so many takes a second
# Digits of kept numbers: more than a fit determines, and few enough to be equal on all processors.
DIGITS = 10
ASKED_FROM = 5.0  # degrees between the climb of a recording and that of its study


def _beside(drive: Any, folder: Path) -> Any:
    is_named = isinstance(drive, dict) and isinstance(drive.get("file"), str)
    return {**drive, "file": str(folder / drive["file"])} if is_named else drive


def _with_drive(content: Content, files: bool) -> Resolved:
    if not names_recording(content):
        return Resolved(content)
    try:
        record, fit = _measured_drive(content["drive"], _slopes(content), files=files)
    except StudyError as error:
        return Resolved(
            {name: value for name, value in content.items() if name != "drive"}, error.problems
        )
    own = _parameter_sections(content)
    numbers = {n: v for n, v in record.numbers.items() if not any(n in given for given in own)}
    written = content.get("parameters", {})  # if it is none, its reader says so
    parameters = {**written, **numbers} if isinstance(written, Mapping) else written
    return Resolved(
        {**content, "parameters": parameters, "drive": record.model_dump(exclude_none=True)},
        fit=fit,
    )


def tilt_questions(fit: measured.Fit | None, content: Mapping[str, Any]) -> list[str]:
    """Return a question if a recording shows another climb of the track than its study has."""
    if fit is None or fit.tilt is None:
        return []
    climb = math.degrees(fit.tilt.climb)
    least, most = map(math.degrees, _slopes(content).get("along", (0.0, 0.0)))
    if least - ASKED_FROM <= climb <= most + ASKED_FROM:
        return []
    stated = f"{least:.3g}" if least == most else f"{least:.3g} to {most:.3g}"
    return [
        f"the recording shows a track that climbs by {climb:.3g} degrees, the study computes with "
        f"gamma = {stated} degrees. Is the sensor in line with the track, and gamma right?"
    ]


def channel_questions(fit: measured.Fit | None) -> list[str]:
    """Return questions about channels of a recording that move as those of no feeder."""
    if fit is None:
        return []
    known = ("across", *(("normal",) if fit.tilt else ()))  # gravity shows the normal one
    asked = [
        f"the recording's {axis} channel shows no motion of the drive. Is it the right column?"
        for axis, told in zip(fit.axes, fit.significant, strict=True)
        if not told.any() and axis not in known
    ]
    largest = fit.axes[int(fit.amplitudes.max(axis=1).argmax())]
    if largest == "across" and len(fit.axes) > 1:
        asked.append(
            "the recording moves most across the track. Are the names of the channels, or the "
            "mounting, right?"
        )
    return asked


def _parameter_sections(content: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return [
        one
        for key in ("parameters", "variables", "uncertain", "unknowns")
        if isinstance(one := content.get(key), Mapping)
    ]


def _slopes(content: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
    slopes = {}
    for axis, name in (("along", "gamma"), ("across", "delta")):
        given = (one for one in _parameter_sections(content) if name in one)
        written = [value for one in given for value in leaves_of(one[name])]
        try:
            angles = read_numbers(name, QUANTITIES[name], written) if written else ()
        except UnitError:
            continue  # which is told where the value is read
        if angles:
            least, most = math.radians(min(angles)), math.radians(max(angles))
            slopes[axis] = (least, most) if axis == "along" else (-abs(most), abs(most))
    return slopes


def _measured_drive(
    drive: Mapping[str, Any], slopes: Mapping[str, tuple[float, float]], files: bool
) -> tuple[MeasuredDrive, measured.Fit]:
    try:
        fields = RecordedDrive.model_validate(drive)
    except ValidationError as error:
        raise StudyError(
            problems_of(error, {"drive": DRIVE}, DRIVE.unknown, within="drive")
        ) from None
    source = _source(fields, files)
    path = "drive.file" if isinstance(source, Path) else "drive.data"
    asked = fields.model_dump(exclude_none=True, exclude={"file", "data"})
    try:
        fit = measured.fit_drive(
            _table(source, path, files), measured.Recording(**asked, slopes=slopes)
        )
        raw = (
            source.read_bytes()
            if isinstance(source, Path)
            else source.encode("utf-8", "surrogatepass")
        )
    except StudyError as error:
        raise StudyError(_placed(problem, path) for problem in error.problems) from None
    except (OSError, ValueError) as error:  # a NUL in its name is the second
        raise refused(
            path,
            f"it cannot be read: {getattr(error, 'strerror', None) or error}",
            advice_on_path(source, "Name a CSV file by its path from the folder of the study"),
        ) from None
    left_over: dict[Any, float] = dict(zip(fit.axes, map(_rounded, fit.left_over), strict=True))
    return MeasuredDrive(
        name=source.name if isinstance(source, Path) else "data",
        sha256=hashlib.sha256(raw).hexdigest(),
        left_over=left_over,
        clock_error=None if fit.clock is None else _rounded(fit.clock.error),
        numbers={name: _rounded(value) for name, value in fit.parameters().items()},
    ), fit


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _source(drive: RecordedDrive, files: bool) -> str | Path:
    text = "data = the text of the recording's CSV"
    fix = f"Give file = the name of the recording, or {text}" if files else f"Give {text}"
    if drive.file is not None and drive.data is not None:
        raise refused("drive", "the drive gives both file and data", fix)
    if drive.data is not None:
        return drive.data
    if drive.file is None:
        raise refused("drive", "the drive names no recording", fix)
    if not files:
        raise refused("drive.file", "the service cannot read the recording from your computer", fix)
    return drive.file


def _table(source: str | Path, path: str, files: bool) -> measured.RecordingTable:
    # Most lines are rows: what has far too many is not read.
    lines = source.count("\n") if isinstance(source, str) else 0
    limit = f"the limit over HTTP is {MAX_ROWS_SENT:,}"
    fix = "Shorten the recording: one second of motion is enough"
    if not files and lines > 2 * MAX_ROWS_SENT:
        raise refused(path, f"the recording has {lines:,} lines, {limit}", fix)
    table = measured.read_table(source)
    if not files and len(table.lines) > MAX_ROWS_SENT:
        raise refused(path, f"the recording has {len(table.lines):,} rows, {limit}", fix)
    return table


def _placed(problem: Problem, path: str) -> Problem:
    if problem.place == "recording":
        return Problem(path, problem.message, problem.fix)
    return problem if problem.place.startswith("drive.") else problem.below("drive")


DRIVE: Final = Section(
    beside=_beside,
    resolve=_with_drive,
    unknown=lambda stranger: no_field(stranger, RecordedDrive),
    absent=lambda _: only_the_plain_sine('Write kind = "simulate", or give these'),
)
"""The section `drive`."""
