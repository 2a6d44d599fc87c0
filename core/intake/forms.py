"""A study in the forms in which people pass it on: TOML and JSON, read and written, and others.

A request and a call in Python are written alone. Each writer takes the content of a sound study as
it was typed, so that units and ranges stay as they are.
"""

import codecs
import json
import os
import pprint
import re
import shlex
import sys
import tomllib
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Final, NoReturn

from vibrafeed.core.errors import Problem, StudyError, raise_any, refused
from vibrafeed.core.intake.part import with_part
from vibrafeed.core.intake.section import names_file
from vibrafeed.core.intake.sections import SECTIONS, in_letters, read_rows, with_posteriors
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.tables.text import text_of

# --- Reading what stands in TOML and JSON, from files and from the network.


DEEPEST = 32  # levels of nesting; a study has 5, an execute request around it 2
# What no study comes near: who sends more is refused before it is looked at closely.
MAX_KEYS = 1_000  # of one object of JSON
EXPECTED = "Send the study as one JSON object"
SYNTAX = "Fix the syntax there"
NO_STUDIES = {
    ".nc": (
        "it is a result, not a study",
        "Draw it with `vibrafeed plot`, or give the study's file",
    ),
    **dict.fromkeys(
        (".csv", ".parquet", ".xlsx", ".mat"),
        ("it is a table, not a study", "Give a study in TOML or JSON"),
    ),
}  # what other files are, and what to do instead of running them
MAX_BRACKETS = 10_000  # objects and lists of one text
LARGEST = sys.float_info.max
TOO_LARGE = "the number is larger than 1.8e308", "Write a smaller number"
_TOO_LONG = "set_int_max_str_digits"  # in Python's message on an integer of thousands of digits
_HALVES = re.compile("[\ud800-\udfff]")


def read_content(path: Path) -> object:
    """Return the keys and values in a TOML or JSON file of a study.

    File names in it (a recording, observations, calibrations) are relative to its folder, and
    become paths from the current one. Raises `StudyError` if the file cannot be read, with advice
    for files of other kinds, such as results.
    """
    suffix = path.suffix.lower()
    if suffix in NO_STUDIES:
        _fail("file", *NO_STUDIES[suffix])
    if path.is_dir():
        _fail("file", "it is a folder", f"Name the studies in it, such as {path.as_posix()}/*.toml")
    try:
        text = path.read_text(encoding="utf-8-sig")  # with or without a byte order mark
    except UnicodeDecodeError as error:
        # PowerShell 5 writes UTF-16 by `>`.
        is_utf16 = error.object.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
        _fail(
            "file",
            "it is not UTF-8 text",
            (
                "Save it as UTF-8"
                + ("; in PowerShell write it with -o FILE, not >" if is_utf16 else "")
            ),
            error,
        )
    except OSError as error:
        _fail(
            "file",
            f"it cannot be read: {error.strerror}",
            "Give the path of a study in TOML or JSON",
            error,
        )
    content = _read_text(text, ".json" if suffix == ".json" else ".toml", path.stem)
    if isinstance(content, dict):
        return _with_files(content, lambda name: str(path.parent / name))
    return content


def _read_text(text: str, suffix: str, stem: str) -> object:
    try:
        return _READERS[suffix](text)
    except StudyError as error:
        other = ".toml" if suffix == ".json" else ".json"
        try:
            _READERS[other](text)
        except StudyError:
            (problem,) = error.problems
            if problem.place == "body":  # the place of requests
                problem = Problem(
                    "file", problem.message, SYNTAX if problem.fix == EXPECTED else problem.fix
                )
            raise StudyError([problem]) from None
        form = other.removeprefix(".").upper()
        _fail(
            "file",
            f"the file contains {form}, but its name ends in {suffix}",
            f"Rename it to {stem}{other}",
        )


def read_toml(text: str) -> object:
    """Return the content of a TOML text as a dict; raise `StudyError` if the syntax is invalid.

    Also for what a TOML text can hold, but no study: see `read_json`.
    """
    try:
        content = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        if _TOO_LONG in str(error):
            _fail("file", *TOO_LARGE, error)
        match = re.search(r"at line (\d+)", str(error))
        number = int(match[1]) if match else 0
        _refuse_comma("file", text, number)
        line = text.rstrip().split("\n")[number - 1].strip()  # the last one where none is named
        fix = f'{SYNTAX}: put texts, such as "20 deg", in quotes'
        if re.search(r'"[^"]*\\', line):
            fix = "In a path write / for \\, or set the path in '...'"
        elif line.count('"') % 2:
            fix = "Is a quote missing there?"
        _fail("file", f"it is not TOML: {error}, in the line {line[:60]}", fix, error)
    _check_values(content, texts="\\" in text or not text.isascii())
    return content


def read_json(text: str | bytes) -> object:
    """Return the content of a JSON text, as dict, list or plain value, after strict checks.

    Raises `StudyError` if the syntax is invalid, and for repeated keys, NaN, numbers beyond double
    precision, characters that are not valid text, too many objects, and content that is nested too
    deeply: texts come from the network.
    """
    try:
        # json itself would accept other encodings, and lone surrogates.
        text = text if isinstance(text, str) else text.decode("utf-8-sig")
        if text.count("[") + text.count("{") > MAX_BRACKETS:
            _fail("body", f"it has more than {MAX_BRACKETS:,} objects and lists", EXPECTED)
        content: object = json.loads(
            text, object_pairs_hook=_unique, parse_constant=_refuse_constant
        )
    except (ValueError, RecursionError) as error:
        if _TOO_LONG in str(error):
            _fail("body", *TOO_LARGE, error)
        if isinstance(error, json.JSONDecodeError):
            _refuse_comma("body", error.doc, error.lineno)
        reason = "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
        _fail("body", f"it is not JSON: {reason}"[:300], EXPECTED, error)
    # Lone surrogates come from escapes only, or from a str that Python callers pass.
    _check_values(content, texts="\\u" in text or not text.isascii())
    return content


def _refuse_comma(path: str, text: str, number: int) -> None:
    line = text.split("\n")[number - 1] if number else ""
    comma = re.search(r"[=:]\s*([-+]?\d+),(\d+)", line)
    if comma is not None:
        whole, decimals = (digits[:20] for digits in comma.groups())
        _fail(
            path,
            f"line {number}: the number {whole},{decimals} has a decimal comma",
            f"Write {whole}.{decimals}",
        )


_READERS: dict[str, Callable[[str], object]] = {".json": read_json, ".toml": read_toml}


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len(pairs) > MAX_KEYS:
        subject = f"the object that begins with '{_shown(pairs[0][0])}'"
        _fail("body", f"{subject} has {len(pairs):,} keys", f"Give at most {MAX_KEYS:,} keys")
    content = dict(pairs)
    if len(content) < len(pairs):
        names = [name for name, _ in pairs]
        repeated = next(name for index, name in enumerate(names) if name in names[:index])
        raise ValueError(f"the key '{_shown(repeated)}' appears twice in one JSON object")
    return content


def _refuse_constant(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not a valid number in JSON")


def _check_values(content: object, *, texts: bool) -> None:
    level: list[tuple[str, Any]] = [("", [content])]  # dicts and lists of one depth, with paths
    for _ in range(DEEPEST + 1):
        next_level: list[tuple[str, Any]] = []
        for path, container in level:
            if isinstance(container, dict):
                for key, value in container.items():
                    inner_path = f"{path}.{_shown(key)}".lstrip(".")
                    if texts and _is_no_text(key):
                        _fail(
                            inner_path,
                            "the name of the key has an invalid character",
                            "Remove that character",
                        )
                    _check_plain(inner_path, (value,), texts)
                    if isinstance(value, dict | list):
                        next_level.append((inner_path, value))
            else:
                _check_plain(path, container, texts)
                next_level.extend(
                    (path, item) for item in container if isinstance(item, dict | list)
                )
        if not next_level:
            return
        level = next_level
    _fail(level[0][0][:100] or "body", f"it is nested more than {DEEPEST} levels deep", EXPECTED)


def _check_plain(path: str, values: Sequence[Any], texts: bool) -> None:
    all_numbers = {*map(type, values)} <= {int, float}
    numbers = values if all_numbers else [value for value in values if type(value) in (int, float)]
    if numbers and not -LARGEST <= min(numbers) <= max(numbers) <= LARGEST:
        _fail(path or "body", *TOO_LARGE)
    if texts and any(isinstance(value, str) and _is_no_text(value) for value in values):
        _fail(
            path or "body",
            "the text has an invalid character: NUL, or half of a surrogate pair",
            "Remove that character",
        )


def _is_no_text(text: str) -> bool:
    return "\0" in text or (not text.isascii() and _HALVES.search(text) is not None)


def _shown(text: str) -> str:
    return text[:60].encode("utf-8", "backslashreplace").decode("utf-8").replace("\0", "\\0")


def _fail(path: str, message: str, fix: str, cause: Exception | None = None) -> NoReturn:
    raise refused(path, message, fix) from cause


SERVICE: Final = "http://127.0.0.1:8000"
LONGEST_ARGUMENT: Final = 100_000  # bytes; Linux takes 131,072 in one argument of a command
WIDTH: Final = 88  # characters of a line of Python


@cache
def keys_of_studies() -> tuple[str, ...]:
    """Return the keys that a study of any kind has beside its parameters; loads every model."""
    return tuple(dict.fromkeys(key for kind in KINDS.values() for key in kind.model.model_fields))


def to_toml(content: Mapping[str, Any]) -> str:
    """Return a study as the text of a TOML file, with the range of each parameter on one line.

    `content` holds the keys and values of the study as they were typed, with their units; keys
    whose value is None are left out.
    """
    import tomlkit

    document = tomlkit.document()
    # Plain values come first: those below the name of a table would belong to it.
    for name, value in sorted(content.items(), key=lambda item: _depth(item[1])):
        if value is None:  # TOML has no null: left out, it has its default
            continue
        if name in SECTIONS and SECTIONS[name].by_parameter:
            table = tomlkit.table()
            for parameter, written in value.items():
                table.add(parameter, _in_line(tomlkit, written))
            document.add(name, table)
        else:
            document.add(name, tomlkit.item(_writable(tomlkit, value)))
    return tomlkit.dumps(document)


def to_curl(content: Mapping[str, Any], service: str = SERVICE) -> str:
    """Return a curl command, for POSIX shells, that posts a study to a service.

    `content` holds the keys and values of the study as they were typed, `service` is the address of
    the service.

    Raises
    ------
    StudyError
        If the study is longer than an argument of a command may be.
    """
    body, address = _request(content, service)
    if len(body) > LONGEST_ARGUMENT:
        raise refused(
            "study",
            f"the study has {len(body):,} bytes, which is too long for a command line",
            "Write it to a file with `vibrafeed convert STUDY --to json`, and send the file: "
            f"curl --data-binary @FILE {address}",
        )
    return (
        "curl "
        + " ".join(
            map(shlex.quote, ["-H", "Content-Type: application/json", "--data-raw", body, address])
        )
        + "\n"
    )


def to_powershell(content: Mapping[str, Any], service: str = SERVICE) -> str:
    """Return commands for PowerShell, 5 or later, that post a study to a service.

    The body is a text between @' and '@, in which no character has a meaning of its own, and ASCII:
    PowerShell 5 would send other letters as Latin-1. `content` and `service` are as for `to_curl`.
    """
    body, address = _request(content, service)
    options = "-Method Post -ContentType 'application/json' -Body $study"
    address = address.replace("'", "''")
    return f"$study = @'\n{body}\n'@\nInvoke-RestMethod {options} -Uri '{address}'\n"


def _request(content: Mapping[str, Any], service: str) -> tuple[str, str]:
    body = json.dumps(content, separators=(",", ":"))
    return body, f"{service.rstrip('/')}/processes/{content['kind']}/execution"


def to_python(content: Mapping[str, Any]) -> str:
    """Return the text of a Python program that runs a study and prints its dataset.

    `content` holds the keys and values of the study as they were typed, with their units.
    Parameters become keywords of the call, unless a name is a key of studies, too.
    """
    keywords = {name: value for name, value in content.items() if name != "kind"}
    parameters = keywords.get("parameters", {})
    if not set(parameters) & set(keys_of_studies()):
        keywords.pop("parameters", None)
        keywords |= parameters
    if not hasattr(sys.modules["vibrafeed"], content["kind"]):  # added to the table of kinds
        raise refused(
            "kind",
            f"vibrafeed has no Python function for the kind '{content['kind']}'",
            "Run the study with `vibrafeed run`, or convert it to TOML or JSON",
        )
    lines = [f"    {name}={_literal(value, len(name) + 5)}," for name, value in keywords.items()]
    call = f"dataset = vibrafeed.{content['kind']}("
    return "\n".join(["import vibrafeed", "", call, *lines, ")", "print(dataset)", ""])


REQUESTS: Final[Mapping[str, Callable[[Mapping[str, Any], str], str]]] = {
    "curl": to_curl,
    "powershell": to_powershell,
}
"""Commands that post a study to a service, whose address they take."""
FORMS: Final[Mapping[str, Callable[..., str]]] = {
    "toml": to_toml,
    "json": lambda content: json.dumps(content, indent=2, ensure_ascii=False) + "\n",
    **REQUESTS,
    "python": to_python,
}


def write_as(form: str, content: Mapping[str, Any], service: str = SERVICE) -> str:
    """Return a study in one of `FORMS`; a request asks the service at the address `service`."""
    return FORMS[form](content, service) if form in REQUESTS else FORMS[form](content)


def resolve_files(content: Mapping[str, Any], form: str, folder: Path) -> dict[str, Any]:
    """Return a study whose files, such as recordings, are found from its new place.

    `content` is the study as it was typed, with file names from the current folder, `form` a key of
    `FORMS`: a file gets names from its own `folder`, a program from the current one, a request the
    contents of the files, as a service reads no files of others. Raises `StudyError` if a recording
    that is to be sent cannot be read.
    """
    if form not in REQUESTS:
        return _with_files(content, lambda name: _path_from(Path(name), form, folder))
    request_content = {**with_posteriors(in_letters(content)[0], files=True).content}
    runs, designs, drive = (
        request_content.get(key) for key in ("observations", "designs", "drive")
    )
    if isinstance(runs, str):
        request_content["observations"] = read_rows(Path(runs))
    if names_file(designs):
        request_content["designs"] = read_rows(Path(designs["file"]), "designs")
    if names_file(drive):
        request_content["drive"] = _with_text(drive)
    if request_content.get("part") is None:
        return request_content
    resolved = with_part(request_content, files=True)
    raise_any(resolved.problems)
    return resolved.content


def _with_files(content: Mapping[str, Any], move: Callable[[str], str]) -> dict[str, Any]:
    sections = {key: section for key, section in content.items() if key in SECTIONS}
    return {
        **content,
        **{key: SECTIONS[key].beside(section, move) for key, section in sections.items()},
    }


def _with_text(drive: Mapping[str, Any]) -> dict[str, Any]:
    file = drive["file"]
    try:
        data = text_of(Path(file).read_bytes())
    except (OSError, ValueError) as error:
        raise refused(
            "drive.file", f"{file} cannot be read: {error}", "Give the path of a CSV file"
        ) from None
    return {**{name: value for name, value in drive.items() if name != "file"}, "data": data}


def _path_from(file: Path, form: str, folder: Path) -> str:
    if form == "python":
        return file.as_posix()
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:
        return file.absolute().as_posix()


def _depth(value: object) -> int:
    if isinstance(value, Mapping):
        return 1
    in_tables = isinstance(value, list) and any(isinstance(entry, Mapping) for entry in value)
    return 2 if in_tables else 0


def _in_line(tomlkit: Any, value: Any) -> Any:
    if not isinstance(value, Mapping):
        return tomlkit.item(_writable(tomlkit, value))
    table = tomlkit.inline_table()
    table.update({name: _writable(tomlkit, entry) for name, entry in value.items()})
    return table


def _writable(tomlkit: Any, value: Any) -> Any:
    if isinstance(value, Mapping):
        return {
            name: _writable(tomlkit, entry) for name, entry in value.items() if entry is not None
        }
    if not isinstance(value, list):
        return value
    if any(isinstance(entry, Mapping | list) for entry in value):
        return [_writable(tomlkit, entry) for entry in value]
    return tomlkit.value(f"[{', '.join(tomlkit.item(entry).as_string() for entry in value)}]")


def _literal(value: Any, column: int) -> str:
    if isinstance(value, str):
        return repr(value)
    first_line, *others = pprint.pformat(
        value, width=max(WIDTH - column, 40), sort_dicts=False
    ).splitlines()
    return "\n".join([first_line, *(" " * column + line for line in others)])
