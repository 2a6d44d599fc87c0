"""A section of a study, a key that holds more than a value; and the section `drive` of one."""

import hashlib
import math
import os
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeGuard

from pydantic import BaseModel, ValidationError

from vibrafeed.core import measured
from vibrafeed.core.errors import MAX_PROBLEMS, Problem, StudyError, refused
from vibrafeed.core.quantities import QUANTITIES, letter_of
from vibrafeed.core.study.grid_study import (
    PARAMETERS,
    MeasuredDrive,
    RecordedDrive,
    names_recording,
    only_the_plain_sine,
)
from vibrafeed.core.study.units import UnitError, read_numbers
from vibrafeed.core.study.unusual import leaves_of
from vibrafeed.core.suggestions import Suggestions
from vibrafeed.core.tables.read import read_table
from vibrafeed.core.tables.table import InputTable

Content = dict[str, Any]
"""What stands in a study: its keys and their values, as a file or request has them."""


class Resolved(NamedTuple):
    """Content with the numbers of a file instead of its name, and problems of the file.

    If the file cannot be used, the section is left out. `fit` is that of a recording.
    """

    content: Content
    problems: Iterable[Problem] = ()
    fit: "measured.Fit | None" = None


@dataclass(frozen=True)
class Stranger:
    """A key that a study, or one of its sections, does not have.

    `path` leads to it in the study, its name last; `place` is the same as users read it. `tag` is
    the alternative that the section is, such as a kind of criterion. `keys` are those of the study
    and `parameters` those of the scene, for suggestions by `suggest`.
    """

    path: Sequence[Any]
    place: str
    tag: str
    keys: Collection[str]
    parameters: Collection[str]
    suggest: Suggestions

    @property
    def name(self) -> str:
        """The key itself, shortened if it is long."""
        return str(self.path[-1])[:60]

    @property
    def within(self) -> str:
        """The section that contains the key; empty for a key of the study."""
        return str(self.path[0]) if len(self.path) > 1 else ""


def dotted(path: Sequence[Any]) -> str:
    """Return a path as users read it: keys joined by dots."""
    return ".".join(str(part)[:60] for part in path) or "study"


def no_key(stranger: Stranger) -> Problem:
    """Return the problem of an unknown key in a section of a study with fixed keys."""
    tag = f" '{stranger.tag}'" if stranger.tag else ""
    return Problem(
        stranger.place,
        f"'{stranger.name}' is not a key of the {stranger.within.removesuffix('s')}{tag}",
        "Remove it",
    )


def no_parameter(stranger: Stranger) -> Problem:
    """Return the problem of an unknown name in a section of a study whose keys are parameters.

    A key of the study gets the advice to move it; another name the most similar parameter.
    """
    name, within = stranger.name, stranger.within
    if name in stranger.keys:
        return Problem(
            stranger.place,
            f"'{name}' is a key of the study, but it is in the section [{within}]",
            f"Move {name} above the line [{within}]",
        )
    return Problem(
        stranger.place,
        f"'{name}' is not a parameter",
        stranger.suggest(name, PARAMETERS, stranger.parameters),
    )


def no_field(stranger: Stranger, model: type[BaseModel]) -> Problem:
    """Return the problem of an unknown key in a section of a study that a model describes."""
    return Problem(
        stranger.place,
        f"'{stranger.name}' is not a key of the section {stranger.within}",
        stranger.suggest(stranger.name, model.model_fields),
    )


def advice_on_path(path: str | Path, fix: str) -> str:
    """Return the advice for a file that cannot be read; `fix`, unless the path has backslashes.

    Only Windows has them between folders, and in TOML those in double quotes stand for other
    characters, such as a tab.
    """
    text = str(path)
    has_backslashes = ("\\" in text and os.sep == "/") or any(
        letter in text for letter in "\b\t\n\f\r"
    )
    return "Write / between the folders of a path, not \\" if has_backslashes else fix


@dataclass(frozen=True)
class Section:
    """The rules by which a section of a study is read; by default it only has to be there.

    Attributes
    ----------
    names : callable
        Takes the section and the parameters of the scene; returns those that it gives or leaves
        open.
    outputs : callable
        Takes the section; returns the outputs that it asks for.
    tags : tuple of str
        The alternatives among which its key `kind` chooses.
    by_parameter : bool
        True if its keys are parameters.
    place : callable
        Takes the path of a value; returns it as users read it.
    unknown : callable
        Takes a `Stranger`; returns its problem.
    beside : callable
        Takes the section and a function from the name of a file to another; returns it with the
        latter.
    resolve : callable, optional
        Takes content with the section, and True if files of this machine may be read; replaces the
        name of a file by its numbers. After a `StudyError` the section is left out.
    absent : callable, optional
        Takes the section as a `Stranger` to a kind without it; returns the problem.
    """

    names: Callable[[Any, Collection[str]], Iterable[str]] = lambda *_: ()
    outputs: Callable[[Any], Iterable[str]] = lambda _: ()
    tags: tuple[str, ...] = ()
    by_parameter: bool = False
    place: Callable[[Sequence[Any]], str] = dotted
    unknown: Callable[[Stranger], Problem] = no_key
    beside: Callable[[Any, Callable[[str], str]], Any] = lambda raw, _: raw
    resolve: Callable[[Content, bool], Resolved] | None = None
    absent: Callable[[Stranger], Problem] | None = None


# --- Messages for the errors that pydantic reports of a study, in the words of this program.


OUTSIDE = 5  # misplaced parameters that a message names at most
LONGEST = 60  # characters of a value that a message repeats

_NOT = "{said} is not "
_FEW, _MANY = "{said} is too small", "{said} is too large"
VALUES: Final[Mapping[str, tuple[str, str]]] = {
    "string_type": (_NOT + "a text", "Write a text in quotes"),
    **dict.fromkeys(("float_type", "float_parsing"), (_NOT + "a number", "Write a plain number")),
    "finite_number": (_NOT + "a finite number", "Write a plain number"),
    **dict.fromkeys(
        ("int_type", "int_parsing", "int_from_float"),
        (_NOT + "a whole number", "Write a whole number"),
    ),
    **dict.fromkeys(("bool_type", "bool_parsing"), (_NOT + "true or false", "Write true or false")),
    **dict.fromkeys(("tuple_type", "list_type"), (_NOT + "a list", "Write a list in brackets")),
    **dict.fromkeys(
        ("dict_type", "mapping_type", "model_type", "model_attributes_type"),
        (_NOT + "a table of keys and values", "Write a table, in JSON an object"),
    ),
    "greater_than_equal": (_FEW, "Write at least {ge:.15g}"),
    "greater_than": (_FEW, "Write more than {gt:.15g}"),
    "less_than_equal": (_MANY, "Write at most {le:.15g}"),
    "less_than": (_MANY, "Write less than {lt:.15g}"),
    "too_short": ("the list has too few entries", "Give at least {min_length}"),
    "too_long": ("the list has more than {max_length:,} entries", "Give at most {max_length:,}"),
    "string_too_long": ("the text has more than {max_length:,} characters", "Shorten it"),
    **dict.fromkeys(
        ("literal_error", "enum"), ("{said} is not one of the allowed values", "Write {expected}")
    ),
}
"""What is wrong with a value, and what would be right, by pydantic's names of its errors."""


def problems_of(
    error: ValidationError,
    sections: Mapping[str, Section],
    unknown: Callable[[Stranger], Problem],
    keys: Collection[str] = (),
    parameters: Collection[str] = PARAMETERS,
    within: str = "",
) -> list[Problem]:
    """Return the problems behind a pydantic error, each once, and not too many to read.

    `sections` are those of the study by their keys, `unknown` returns the problem of an unknown key
    at its top level; `keys` and `parameters` are as in `Stranger`. `within` is the key of the
    section that was validated; empty for a whole study.
    """
    faults = error.errors(include_url=False)
    outside = [] if within else [str(fault["loc"][0]) for fault in faults if _is_outside(fault)]
    suggestions = Suggestions()
    problems = []
    if outside:
        problems.append(
            Problem(
                "parameters",
                f"{', '.join(outside[:OUTSIDE])}{', ...' if outside[OUTSIDE:] else ''} "
                f"{'is' if len(outside) == 1 else 'are'} outside the section [parameters]",
                "Move them below the line [parameters], or in JSON into the object parameters",
            )
        )
        faults = [
            fault for fault in faults if not _is_outside(fault) and fault["loc"] != ("parameters",)
        ]
    for fault in faults[:MAX_PROBLEMS]:
        path, tag, section = _path_of([*filter(None, [within]), *fault["loc"]], sections)
        if fault["type"] == "extra_forbidden":
            explain = section.unknown if len(path) > 1 else unknown
            problems.append(
                explain(Stranger(path, section.place(path), tag, keys, parameters, suggestions))
            )
        else:
            problems.append(_problem_of_value(fault, path, section, suggestions))
    if len(faults) > MAX_PROBLEMS:
        problems.append(
            Problem(
                "study",
                f"{len(faults) - MAX_PROBLEMS:,} further problems are not listed",
                "Fix the listed problems first",
            )
        )
    return problems


def _path_of(path: list[Any], sections: Mapping[str, Section]) -> tuple[list[Any], str, Section]:
    section = sections.get(str(path[0]), Section()) if path else Section()
    is_tagged = len(path) > 1 and path[1] in section.tags
    tag = str(path.pop(1)) if is_tagged else ""  # which alternative it is, and no key
    if path and path[-1] == "[key]":
        del path[-1]  # it is the name that is wrong, and stands before
    return path, tag, section


def _is_outside(error: Mapping[str, Any]) -> bool:
    name, *below = error["loc"]
    return error["type"] == "extra_forbidden" and not below and letter_of(name) in PARAMETERS


def _problem_of_value(
    error: Mapping[str, Any], path: list[Any], section: Section, suggestions: Suggestions
) -> Problem:
    key, kind = section.place(path), error["type"]
    context: dict[str, Any] = error.get("ctx", {})
    if kind == "value":
        fix = context["fix"]
        return Problem(key, context["message"], suggestions.within(fix) if callable(fix) else fix)
    if kind == "union_tag_invalid":
        tag = str(context["tag"])[:60]
        return Problem(f"{key}.kind", f"'{tag}' is not a {path[0]}", suggestions(tag, section.tags))
    if kind == "union_tag_not_found":
        kinds = " or ".join(f'"{name}"' for name in section.tags)
        return Problem(f"{key}.kind", "it is missing", f"Write kind = {kinds}")
    if kind == "missing":
        return Problem(key, "it is missing", f"Add {str(path[-1])[:60] if path else ''}")
    if kind not in VALUES:
        return Problem(key, error["msg"].removesuffix("."), "Correct the value or its type")
    shown_input = _shown(error.get("input"))
    return Problem(key, *(text.format(said=shown_input, **context) for text in VALUES[kind]))


def _shown(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()  # as TOML and JSON have it
    if value is None:
        return "null"
    if isinstance(value, Mapping):
        return "a table" if value else "an empty table"
    if isinstance(value, list | tuple):
        return "a list" if value else "an empty list"
    if isinstance(value, str):
        return repr(value if len(value) <= LONGEST else f"{value[:LONGEST]}...")
    text = str(value)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}..."


MAX_ROWS_SENT = 20_000  # rows of a recording from the network; fitting so many takes a second
# Digits of kept numbers: more than a fit determines, and few enough to be equal on all processors.
DIGITS = 10
ONLY_ONCE = 'Set kind = "simulate", or leave once out'
ASKED_FROM = 5.0  # degrees between the climb of a recording and that of its study


def names_file(section: Any) -> TypeGuard[Mapping[str, Any]]:
    """True if a section of a study names a `file`."""
    return isinstance(section, Mapping) and isinstance(section.get("file"), str)


def file_beside(section: Any, move: Callable[[str], str]) -> Any:
    """Return a section with its `file`, if it names one, under the name that `move` returns."""
    return {**section, "file": move(section["file"])} if names_file(section) else section


def _with_drive(content: Content, files: bool) -> Resolved:
    if not names_recording(content):
        return Resolved(content)
    record, fit = _measured_drive(
        content["drive"], _slopes(content), files=files, kind=str(content.get("kind"))
    )
    sections = _parameter_sections(content)
    numbers = {
        name: number
        for name, number in record.numbers.items()
        if not any(name in section for section in sections)
    }
    parameters_given = content.get("parameters", {})  # if it is no mapping, its reader refuses it
    parameters = (
        {**parameters_given, **numbers}
        if isinstance(parameters_given, Mapping)
        else parameters_given
    )
    return Resolved(
        {**content, "parameters": parameters, "drive": record.model_dump(exclude_none=True)},
        fit=fit,
    )


def tilt_questions(fit: "measured.Fit | None", content: Mapping[str, Any]) -> list[str]:
    """Return a question if a recording shows another climb of the track than its study has."""
    if fit is None or fit.tilt is None:
        return []
    climb = math.degrees(fit.tilt.climb)
    lower, upper = map(math.degrees, _slopes(content).get("along", (0.0, 0.0)))
    if lower - ASKED_FROM <= climb <= upper + ASKED_FROM:
        return []
    stated = f"{lower:.3g}" if lower == upper else f"{lower:.3g} to {upper:.3g}"
    return [
        f"the recording shows a track that climbs by {climb:.3g} degrees, the study computes with "
        f"gamma = {stated} degrees. Is the sensor in line with the track, and gamma right?"
    ]


def channel_questions(fit: "measured.Fit | None") -> list[str]:
    """Return questions about channels of a recording that move as those of no feeder."""
    if fit is None:
        return []
    may_rest = ("across", *(("normal",) if fit.tilt else ()))  # gravity confirms the normal one
    found = [
        f"the recording's {axis} channel shows no motion of the drive. Is it the right column?"
        for axis, is_significant in zip(fit.axes, fit.significant, strict=True)
        if not is_significant.any() and axis not in may_rest
    ]
    largest = fit.axes[int(fit.amplitudes.max(axis=1).argmax())]
    if largest == "across" and len(fit.axes) > 1:
        found.append(
            "the recording moves most across the track. Are the names of the channels, or the "
            "mounting, right?"
        )
    return found


def _parameter_sections(content: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return [
        section
        for key in ("parameters", "variables", "uncertain", "unknowns")
        if isinstance(section := content.get(key), Mapping)
    ]


def _slopes(content: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
    # The least and the largest slope of the track by axis [rad], where the study gives them.
    slopes = {}
    for axis, name in (("along", "gamma"), ("across", "delta")):
        sections = (section for section in _parameter_sections(content) if name in section)
        angles_given = [value for section in sections for value in leaves_of(section[name])]
        try:
            angles = read_numbers(name, QUANTITIES[name], angles_given) if angles_given else ()
        except UnitError:
            continue  # refused where the value is read
        if angles:
            lower, upper = math.radians(min(angles)), math.radians(max(angles))
            slopes[axis] = (lower, upper) if axis == "along" else (-abs(upper), abs(upper))
    return slopes


def _measured_drive(
    drive: Mapping[str, Any], slopes: Mapping[str, tuple[float, float]], files: bool, kind: str
) -> "tuple[MeasuredDrive, measured.Fit | None]":
    # The drive as a study stores it, and the fit, None for a recording that is followed once.
    try:
        fields = RecordedDrive.model_validate(drive)
    except ValidationError as error:
        raise StudyError(
            problems_of(error, {"drive": DRIVE}, DRIVE.unknown, within="drive")
        ) from None
    csv = "the text of the recording's CSV"
    source = source_of("drive", fields.file, fields.data, "recording", csv, files=files)
    path = "drive.file" if isinstance(source, Path) else "drive.data"
    options = fields.model_dump(exclude_none=True, exclude={"file", "data", "once"})
    recording, fit = measured.Recording(**options, slopes=slopes), None
    try:
        if fields.once and kind != "simulate":
            raise refused("once", f"a study of kind '{kind}' needs a drive that repeats", ONLY_ONCE)
        table = _table(source, path, files)
        if fields.once:
            signal, constant = measured.read_once(table, recording)
        else:
            fit = measured.fit_drive(table, recording)
        raw = (
            source.read_bytes()
            if isinstance(source, Path)
            else source.encode("utf-8", "surrogatepass")
        )
    except StudyError as error:
        raise StudyError(_placed(problem, path) for problem in error.problems) from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in its name
        raise unreadable(path, error, source, "a CSV file") from None
    origin = {
        "name": source.name if isinstance(source, Path) else "data",
        "sha256": hashlib.sha256(raw).hexdigest(),
    }
    if fit is None:
        numbers = {"frequency": 1.0 / signal.times[-1], "burst_periods": 1.0}
        samples = {"time": signal.times, **dict(zip(signal.axes, signal.values, strict=True))}
        fields_of_record: dict[str, Any] = {
            "left_over": {},
            "samples": {
                name: [*map(_rounded, values.tolist())] for name, values in samples.items()
            },
            "derivative": signal.derivative,
            "constant": {axis: _rounded(mean) for axis, mean in constant.items()},
        }
    else:
        numbers = fit.parameters()
        fields_of_record = {
            "left_over": dict(zip(fit.axes, map(_rounded, fit.left_over), strict=True)),
            "clock_error": None if fit.clock is None else _rounded(fit.clock.error),
        }
    rounded = {name: _rounded(value) for name, value in numbers.items()}
    return MeasuredDrive.model_validate({**origin, **fields_of_record, "numbers": rounded}), fit


def unreadable(path: str, error: Exception, source: str | Path, kind: str) -> StudyError:
    """Return the error of a file, of a kind such as "a CSV file", that the system cannot read."""
    return refused(
        path,
        f"the file cannot be read: {getattr(error, 'strerror', None) or error}",
        advice_on_path(source, f"Give the path of {kind}, from the folder of the study"),
    )


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def source_of(
    key: str, file: Path | None, data: str | None, what: str, text: str, *, files: bool
) -> str | Path:
    """Return the text or the file that a section names.

    `key` is that of the section, `what` the file (such as a recording), `text` what `data` holds.
    `files` is True if files of this machine may be read. Raises `StudyError` for neither, or both.
    """
    fix = f"Give {text} as data"
    fix = f"Give the path of the {what} as file, or {text} as data" if files else fix
    if file is not None and data is not None:
        raise refused(key, f"the section {key} has both file and data", fix)
    if data is not None:
        return data
    if file is None:
        raise refused(key, f"the section {key} names no {what}", fix)
    if not files:
        raise refused(f"{key}.file", f"the service cannot read the {what} from your computer", fix)
    return file


def _table(source: str | Path, path: str, files: bool) -> InputTable:
    # Nearly all lines are rows: a text with far too many lines is not read.
    lines = source.count("\n") if isinstance(source, str) else 0
    limit = f"the limit over HTTP is {MAX_ROWS_SENT:,}"
    fix = "Shorten the recording: one second of motion is enough"
    if not files and lines > 2 * MAX_ROWS_SENT:
        raise refused(path, f"the recording has {lines:,} lines, {limit}", fix)
    table = read_table(source)
    if not files and len(table.lines) > MAX_ROWS_SENT:
        raise refused(path, f"the recording has {len(table.lines):,} rows, {limit}", fix)
    return table


def _placed(problem: Problem, path: str) -> Problem:
    if problem.place == "recording":
        return Problem(path, problem.message, problem.fix)
    return problem if problem.place.startswith("drive.") else problem.below("drive")


DRIVE: Final = Section(
    beside=file_beside,
    resolve=_with_drive,
    unknown=lambda stranger: no_field(stranger, RecordedDrive),
    absent=lambda _: only_the_plain_sine('Write kind = "simulate", or give these'),
)
"""The section `drive`."""
