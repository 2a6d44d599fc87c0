"""Every table that a command of the README prints keeps its words, however narrow the terminal."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

from vibrafeed.app.cli import app, catalogue, console, drives, plans, results

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"^```(\w*)[^\n]*\n(.*?)^```", re.MULTILINE | re.DOTALL)
TABLES = ("scenes", "run", "drive", "materials")
"""The commands that print tables."""


def commands(text: str) -> Iterator[tuple[list[str], str]]:
    """Yield the words of each such command, and the study that was shown last before it."""
    study = ""
    for language, content in BLOCK.findall(text):
        if language == "toml":
            study = content
            continue
        for line in content.splitlines():
            begun, _, rest = line.strip().removeprefix("$ ").partition(" ")
            words = shlex.split(rest, comments=True) if begun == "vibrafeed" else []
            if words and words[0] in TABLES:
                yield words, study


def small(study: str) -> str:
    """Return a study with few values a range."""
    study = re.sub(r"num = \d+", "num = 3", study)
    return re.sub(r'step = "?[^,} ]+( \w+)?"?', "num = 3", study)


@pytest.fixture
def printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, tuple, dict, str]]:
    """Return each table that a command printed, and how it is printed where a program reads."""
    found = []
    plain = console.table
    monkeypatch.chdir(tmp_path)
    for words, study in commands((ROOT / "README.md").read_text(encoding="utf-8")):
        files = [word for word in words[1:] if word.endswith((".toml", ".csv"))]
        for name in files:
            if name.endswith(".csv"):
                shutil.copy(ROOT / "examples" / "accelerometer.csv", name)
            elif study and not Path(name).exists():
                Path(name).write_text(small(study), encoding="utf-8")
        if not all(Path(name).exists() for name in files):
            continue  # something else makes them

        def kept(*arguments, _words=tuple(words), **options):
            with contextlib.redirect_stdout(io.StringIO()) as captured:
                plain(*arguments, **options)
            found.append((" ".join(_words), arguments, options, captured.getvalue()))

        with monkeypatch.context() as patched:
            for module in (console, catalogue, drives, plans, results):
                patched.setattr(module, "table", kept)
            done = CliRunner().invoke(app, words)
        assert done.exit_code == 0, (words, done.output)
    return found


def test_no_word_is_lost_at_60_80_and_200_columns(printed, monkeypatch):
    assert len({command for command, *_ in printed}) >= 3, "the README has other commands"
    for command, arguments, options, piped in printed:
        assert not set(piped) & set("─│━┃╭"), command
        words = set(piped.split()) - {"-"}
        for width in (60, 80, 200):
            terminal = Console(force_terminal=True, width=width, color_system=None)
            monkeypatch.setattr(console, "stdout", lambda terminal=terminal: terminal)
            monkeypatch.setattr(console, "is_terminal", lambda: True)
            with terminal.capture() as captured:
                console.table(*arguments, **options)
            lines = captured.get().splitlines()
            told = {word for line in lines for word in line.split()}
            told |= {word.removesuffix(":") for word in told}
            assert words <= told, (command, width, words - told)
            assert max(map(len, lines)) <= width, (command, width)
