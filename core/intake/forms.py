"""A study in the forms in which people pass it on: TOML, JSON, a request, a call in Python.

Each takes the content of a sound study as it was typed, so that units and ranges stay as they are.
"""

from __future__ import annotations

import json
import os
import pprint
import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.intake.keywords import KEYS
from vibrafeed.core.intake.sections import SECTIONS, in_letters, read_rows, with_posteriors
from vibrafeed.core.measured.csv_table import decoded

SERVICE: Final = "http://127.0.0.1:8000"
LONGEST_ARGUMENT: Final = 100_000  # bytes; Linux takes 131,072 in one argument of a command
WIDTH: Final = 88  # characters of a line of Python


def to_toml(content: Mapping[str, Any]) -> str:
    """Return a study as the text of a TOML file, with the range of each parameter on one line.

    `content` holds the keys and values of the study as they were typed, with their units; keys
    whose value is None are left out.
    """
    import tomlkit

    document = tomlkit.document()
    # What stands below the name of a table belongs to it: plain values come first.
    for name, value in sorted(content.items(), key=lambda item: _depth(item[1])):
        if value is None:  # which TOML cannot say, and which leaving out says as well
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
        raise StudyError(
            [
                Problem(
                    "study",
                    f"it has {len(body):,} bytes, more than a command line holds",
                    "Write it to a file with `vibrafeed convert STUDY --to json`, and send that: "
                    f"curl --data-binary @FILE {address}",
                )
            ]
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
    if not set(parameters) & set(KEYS):
        keywords.pop("parameters", None)
        keywords |= parameters
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
    """Return a study whose files of recordings and observations are found from its new place.

    `content` is the study as it was typed, with file names from the current folder, `form` a key of
    `FORMS`: a file gets names from its own `folder`, a program from the current one, a request the
    contents of the files, as a service reads no files of others. Raises `StudyError` if a recording
    that is to be sent cannot be read.
    """
    if form in REQUESTS:
        content = with_posteriors(in_letters(content)[0], files=True).content
    if isinstance(content.get("observations"), str):
        runs = Path(content["observations"])
        moved = read_rows(runs) if form in REQUESTS else _path_from(runs, form, folder)
        content = {**content, "observations": moved}
    drive = content.get("drive")
    if not isinstance(drive, Mapping) or not isinstance(drive.get("file"), str):
        return dict(content)
    file = Path(drive["file"])
    if form in REQUESTS:
        try:
            data = decoded(file.read_bytes())
        except (OSError, ValueError) as error:
            raise StudyError(
                [Problem("drive.file", f"{file} cannot be read: {error}", "Name a CSV")]
            ) from None
        rest = {name: value for name, value in drive.items() if name != "file"}
        return {**content, "drive": {**rest, "data": data}}
    return {**content, "drive": {**drive, "file": _path_from(file, form, folder)}}


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
    in_tables = isinstance(value, list) and any(isinstance(one, Mapping) for one in value)
    return 2 if in_tables else 0


def _in_line(tomlkit: Any, value: Any) -> Any:
    if not isinstance(value, Mapping):
        return tomlkit.item(_writable(tomlkit, value))
    table = tomlkit.inline_table()
    table.update({name: _writable(tomlkit, one) for name, one in value.items()})
    return table


def _writable(tomlkit: Any, value: Any) -> Any:
    if isinstance(value, Mapping):
        return {n: _writable(tomlkit, part) for n, part in value.items() if part is not None}
    if not isinstance(value, list):
        return value
    if any(isinstance(part, Mapping | list) for part in value):
        return [_writable(tomlkit, part) for part in value]
    return tomlkit.value(f"[{', '.join(tomlkit.item(part).as_string() for part in value)}]")


def _literal(value: Any, column: int) -> str:
    if isinstance(value, str):
        return repr(value)
    first, *more = pprint.pformat(
        value, width=max(WIDTH - column, 40), sort_dicts=False
    ).splitlines()
    return "\n".join([first, *(" " * column + line for line in more)])
