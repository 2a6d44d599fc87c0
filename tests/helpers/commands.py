"""The command line, in this process: a line of words in, an exit code and texts out."""

import json
import shlex
from pathlib import Path
from typing import Any

from click.testing import Result
from typer.testing import CliRunner

from vibrafeed.app.cli import app


def run(line: str, code: int = 0, **more: Any) -> Result:
    """Carry out a command as it is typed; it ends with an exit code, and without a traceback."""
    result = CliRunner().invoke(app, shlex.split(line), **more)
    assert result.exit_code == code, result.output
    assert isinstance(result.exception, SystemExit | None), result.exception
    return result


def said(line: str, code: int = 0, **more: Any) -> str:
    """Return all that a command prints, its lines joined."""
    return " ".join(run(line, code, **more).output.split())


def tells(line: str, *sentences: str, code: int = 0, **more: Any) -> None:
    """Carry out a command, which prints all of some sentences."""
    told = said(line, code, **more)
    for sentence in sentences:
        assert sentence in told


def saved(study: str | dict[str, Any], name: str = "study.toml") -> Path:
    """Write a study into a file, by default in the folder where the test is; return its path."""
    path = Path(name)
    if not isinstance(study, str):
        study, path = json.dumps(study), path.with_suffix(".json")
    path.write_text(study)
    return path
