"""Reading studies from TOML and JSON, with every error of a text reported at once."""

from __future__ import annotations

import json
import os
import re
import sys
import tomllib
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from pydantic import ValidationError

from core.errors import MOST_PROBLEMS, Problem, StudyError, Suggestions, nearest
from core.study.calibrate_study import STEMS
from core.study.distributions import CALIBRATION
from core.study.drive import RecordedDrive
from core.study.grid_study import PARAMETERS
from core.study.models import STUDIES, Study
from core.study.observations import OBSERVED
from core.study.optimise_study import CRITERIA
from core.study.reduction import LevelSet, Reduction

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

DEEPEST = 32  # levels; a study has 5, an execute request around it 2
# What no study comes near: who sends more is refused before it is looked at closely.
MOST_KEYS = 1_000  # of one object of JSON
ONE = "Send one JSON object, a study"
SYNTAX = "Fix the syntax there"
NO_STUDIES = {
    ".nc": ("it is a result, not a study", "Draw it with `vibrafeed plot`, or name its study"),
    **dict.fromkeys(
        (".csv", ".parquet", ".xlsx", ".mat"),
        ("it is a table, not a study", "Name a TOML or JSON study"),
    ),
}  # what other files are, and what to do instead of running them
MOST_BRACKETS = 10_000  # of the objects and lists of one text
OUTSIDE = 5  # misplaced parameters that are named
LARGEST = sys.float_info.max
_HALVES = re.compile("[\ud800-\udfff]")


def load_study(path: str | os.PathLike[str]) -> Study:
    """Return the study in the TOML or JSON file at `path`.

    Raises
    ------
    StudyError
        With every problem of the file.
    """
    return parse_study(read_content(Path(path)))


def read_content(path: Path) -> object:
    """Return what stands in the TOML or JSON file at `path`; raise `StudyError` if it cannot.

    The files of a recording, of observations and of calibrations are named beside that of the
    study.
    """
    suffix = path.suffix.lower()
    if suffix in NO_STUDIES:
        _fail("file", *NO_STUDIES[suffix])
    try:
        text = path.read_text(encoding="utf-8-sig")  # editors of Windows begin it with a mark
    except UnicodeDecodeError as error:
        _fail("file", "it is not UTF-8 text", "Save it as UTF-8", error)
    except OSError as error:
        _fail("file", f"it cannot be read: {error.strerror}", "Name a TOML or JSON study", error)
    content = _read_text(text, ".json" if suffix == ".json" else ".toml", path.stem)
    drive = content.get("drive") if isinstance(content, dict) else None
    if isinstance(drive, dict) and isinstance(drive.get("file"), str):
        drive["file"] = str(path.parent / drive["file"])
    uncertain = content.get("uncertain") if isinstance(content, dict) else None
    for one in uncertain.values() if isinstance(uncertain, dict) else ():
        if isinstance(one, dict) and isinstance(one.get(CALIBRATION), str):
            one[CALIBRATION] = str(path.parent / one[CALIBRATION])
    if isinstance(content, dict) and isinstance(content.get("observations"), str):
        content["observations"] = str(path.parent / content["observations"])
    return content


def _read_text(text: str, suffix: str, stem: str) -> object:
    """Return what stands in the text of a file; tell TOML and JSON apart if its name is wrong."""
    try:
        return _READERS[suffix](text)
    except StudyError as error:
        (other,) = {*_READERS} - {suffix}
        try:
            _READERS[other](text)
        except StudyError:
            (problem,) = error.problems
            if problem.place == "body":  # the word of requests
                problem = Problem("file", problem.message, SYNTAX)
            raise StudyError([problem]) from None
        form = other.removeprefix(".").upper()
        _fail("file", f"this is {form}, and its name ends in {suffix}", f"Name it {stem}{other}")


def read_toml(text: str) -> object:
    """Return what stands in a TOML text; raise `StudyError` if it is none."""
    try:
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        fix = f'{SYNTAX}: texts, such as "20 deg", stand in quotes'
        _fail("file", f"it is not TOML: {error}", fix, error)


def read_json(text: str | bytes) -> object:
    """Return what stands in a JSON text; raise `StudyError` if it is none."""
    try:
        # By itself json would let halves of characters through, and take other encodings.
        text = text if isinstance(text, str) else text.decode("utf-8")
        if text.count("[") + text.count("{") > MOST_BRACKETS:
            _fail("body", f"it holds more than {MOST_BRACKETS:,} objects and lists", ONE)
        content: object = json.loads(
            text, object_pairs_hook=_unique, parse_constant=_refuse_constant
        )
    except (ValueError, RecursionError) as error:
        reason = "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
        _fail("body", f"it is not JSON: {reason}"[:300], ONE, error)
    # What is no text can stand there as an escape only, or as itself in what Python hands over.
    _check_values(content, texts="\\u" in text or not text.isascii())
    return content


_READERS: dict[str, Callable[[str], object]] = {".json": read_json, ".toml": read_toml}


def parse_toml(text: str) -> Study:
    """Return the study in a TOML text; raise `StudyError` with every problem of it."""
    return parse_study(read_toml(text))


def parse_json(text: str | bytes) -> Study:
    """Return the study in a JSON text; raise `StudyError` with every problem of it."""
    return parse_study(read_json(text))


def parse_study(
    content: object, parameters: Callable[[], Collection[str]] = lambda: PARAMETERS
) -> Study:
    """Return the study that a mapping describes; raise `StudyError` with every problem of it.

    `parameters` returns those to choose from, which messages list: all, or those of its scene.
    """
    if not isinstance(content, Mapping):
        _fail("study", "it is not an object", "Write keys and values: kind, scene, outputs, ...")
    kind = content.get("kind")
    if not isinstance(kind, str) or kind not in STUDIES:
        missing = kind is None
        said = None if missing else nearest(str(kind), STUDIES)
        problem = Problem(
            "kind",
            "it is missing" if missing else f"{str(kind)[:60]!r} is not a kind of study",
            "Write kind = " + " or ".join(f'"{name}"' for name in ([said] if said else STUDIES)),
        )
        # The rest is checked all the same, as the kind that has most of its keys.
        keys = {name: set(STUDIES[name].model_fields) & set(content) for name in STUDIES}
        likely = said or max(STUDIES, key=lambda name: len(keys[name]))
        raise StudyError([problem, *_problems_of({**content, "kind": likely}, parameters())])
    try:
        return STUDIES[kind].model_validate(content)
    except ValidationError as error:
        raise StudyError(_problems(kind, error, parameters())) from None


def parse_recorded(drive: Mapping[str, Any]) -> RecordedDrive:
    """Return the recording that a study names; raise `StudyError` with every problem of it."""
    try:
        return RecordedDrive.model_validate(drive)
    except ValidationError as error:
        raise StudyError(_problems("drive", error, PARAMETERS, "drive")) from None


def _problems_of(content: dict[str, Any], parameters: Collection[str]) -> Iterable[Problem]:
    try:
        STUDIES[content["kind"]].model_validate(content)
    except ValidationError as error:
        return _problems(content["kind"], error, parameters)
    return ()


def _problems(
    kind: str, error: ValidationError, parameters: Collection[str], *place: str
) -> list[Problem]:
    """Return what pydantic found, in our words; `place` is where what it looked at stands."""
    found = error.errors(include_url=False, include_input=False)
    outside = [] if place else [str(one["loc"][0]) for one in found if _is_outside(one)]
    suggest = Suggestions()
    problems = []
    if outside:
        told = ", ".join(outside[:OUTSIDE]) + (", ..." if len(outside) > OUTSIDE else "")
        message = f"{told} {'stands' if len(outside) == 1 else 'stand'} outside"
        fix = "Write them below the line [parameters], in JSON within that object"
        problems.append(Problem("parameters", message, fix))
        found = [one for one in found if not _is_outside(one) and one["loc"] != ("parameters",)]
    for one in found[:MOST_PROBLEMS]:
        one["loc"] = (*place, *one["loc"])
        problems.append(_problem(kind, one, parameters, suggest))
    if len(found) > MOST_PROBLEMS:
        more = f"{len(found) - MOST_PROBLEMS:,} further problems are not listed"
        problems.append(Problem("study", more, "Fix these first"))
    return problems


def _is_outside(error: ErrorDetails) -> bool:
    """Return whether a parameter stands among the keys of a study."""
    path = error["loc"]
    return error["type"] == "extra_forbidden" and len(path) == 1 and path[0] in PARAMETERS


def _problem(
    kind: str, error: ErrorDetails, parameters: Collection[str], suggest: Suggestions
) -> Problem:
    """Return one error of pydantic in our words."""
    path = list(error["loc"])
    if len(path) > 1 and path[0] == "criterion" and path[1] in CRITERIA:
        del path[1]  # which alternative it is, and no key
    if path and path[-1] == "[key]":
        del path[-1]  # it is the name that is wrong, and stands before
    place = _place_of(path)
    name = str(path[-1])[:60] if path else ""
    context: dict[str, Any] = error.get("ctx", {})
    if error["type"] == "value":
        fix = context["fix"]
        if callable(fix):
            fix = suggest.within(fix)
        return Problem(place, context["message"], fix)
    if error["type"] == "extra_forbidden":
        return _stranger(kind, error, path, parameters, suggest)
    if error["type"] == "union_tag_invalid":
        tag = str(context["tag"])[:60]
        return Problem(f"{place}.kind", f"'{tag}' is not a criterion", suggest(tag, CRITERIA))
    if error["type"] == "union_tag_not_found":
        fix = "Write kind = " + " or ".join(f'"{name}"' for name in CRITERIA)
        return Problem(f"{place}.kind", "it is missing", fix)
    if error["type"] == "missing":
        return Problem(place, "it is missing", f"Add {name}")
    return Problem(place, error["msg"].removesuffix("."), "Fix the value or its type")


def _stranger(
    kind: str,
    error: ErrorDetails,
    path: Sequence[Any],
    parameters: Collection[str],
    suggest: Suggestions,
) -> Problem:
    """Return what is wrong with a key that a study has not."""
    place, name = _place_of(path), str(path[-1])[:60]
    within = path[0] if len(path) > 1 else ""
    if within == "observations":
        return _unknown_column(place, name, parameters, suggest)
    if within in ("parameters", "variables", "candidates", *STEMS):
        if name in STUDIES[kind].model_fields:
            message = f"'{name}' is a key of the study, and stands among the {within}"
            return Problem(place, message, f"Move it above the line [{within}]")
        fix = suggest(name, PARAMETERS, parameters)
        return Problem(place, f"'{name}' is not a parameter", fix)
    if within == "drive":
        fix = suggest(name, RecordedDrive.model_fields)
        return Problem(place, f"'{name}' is not a key of the drive", fix)
    if within == "reduce":
        part = LevelSet if len(path) > 2 else Reduction
        fix = suggest(name, part.model_fields)
        return Problem(place, f"'{name}' is not a key of reduce", fix)
    if within:
        which = f" '{error['loc'][1]}'" if within == "criterion" else ""
        one = str(within).removesuffix("s")
        return Problem(place, f"'{name}' is not a key of the {one}{which}", "Remove it")
    if name == "drive":
        message = "closed forms support only the plain sine of amplitude, alpha and beta"
        return Problem(place, message, 'Write kind = "simulate", or give these')
    known = tuple(STUDIES[kind].model_fields)
    return Problem(place, f"'{name}' is not a key of kind '{kind}'", suggest(name, known))


def _place_of(path: Sequence[Any]) -> str:
    """Return where a problem is; rows of observations as people count them."""
    if len(path) < 2 or path[0] != "observations":
        return ".".join(str(part)[:60] for part in path) or "study"
    return f"observations row {int(path[1]) + 1}" + "".join(f", {name}"[:60] for name in path[2:3])


def _unknown_column(
    place: str, name: str, parameters: Collection[str], suggest: Suggestions
) -> Problem:
    known = (*OBSERVED, "error", "regime", *PARAMETERS)
    shown = (*OBSERVED, "error", "regime", *parameters)
    message = f"'{name}' is no parameter, and not measured"
    return Problem(place, message, suggest(name, known, shown))


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len(pairs) > MOST_KEYS:
        begins = f"the object that begins with '{_shown(pairs[0][0])}'"
        _fail("body", f"{begins} has {len(pairs):,} keys", f"Give at most {MOST_KEYS:,}")
    content = dict(pairs)
    if len(content) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for k, name in enumerate(names) if name in names[:k])
        raise ValueError(f"the key '{_shown(twice)}' appears twice in one object")
    return content


def _refuse_constant(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not a JSON number")


def _check_values(content: object, *, texts: bool) -> None:
    """Raise `StudyError` for what JSON can say and nothing else here can.

    That is: objects within objects without end, numbers beyond floats and, where `texts` are to be
    looked at, NUL and halves of characters in them.
    """
    level: list[tuple[str, Any]] = [("", [content])]
    for _ in range(DEEPEST + 1):
        below: list[tuple[str, Any]] = []
        for place, part in level:
            if isinstance(part, dict):
                for key, value in part.items():
                    within = f"{place}.{_shown(key)}".lstrip(".")
                    if texts and _is_no_text(key):
                        _fail(within, "its name holds an invalid character", "Fix the name")
                    _check_plain(within, (value,), texts)
                    if isinstance(value, dict | list):
                        below.append((within, value))
            else:
                _check_plain(place, part, texts)
                below.extend((place, item) for item in part if isinstance(item, dict | list))
        if not below:
            return
        level = below
    _fail(level[0][0][:100] or "body", "it is nested too deeply", ONE)


def _check_plain(place: str, values: Sequence[Any], texts: bool) -> None:
    """Raise `StudyError` if one of some values is a number beyond floats, or no text."""
    kinds = {*map(type, values)}
    if kinds <= {int, float}:
        numbers = values
    else:
        numbers = [value for value in values if type(value) in (int, float)]
    if numbers and not -LARGEST <= min(numbers) <= max(numbers) <= LARGEST:
        _fail(place or "body", "it is a number larger than 1.8e308", "Fix the value")
    if texts and any(isinstance(value, str) and _is_no_text(value) for value in values):
        wrong = "it holds an invalid character: NUL, or half of a surrogate pair"
        _fail(place or "body", wrong, "Fix the value")


def _is_no_text(text: str) -> bool:
    return "\0" in text or (not text.isascii() and _HALVES.search(text) is not None)


def _shown(text: str) -> str:
    """Return the start of a text, so that it can be written."""
    return text[:60].encode("utf-8", "backslashreplace").decode("utf-8").replace("\0", "\\0")


def _fail(place: str, message: str, fix: str, cause: Exception | None = None) -> NoReturn:
    raise StudyError([Problem(place, message, fix)]) from cause
