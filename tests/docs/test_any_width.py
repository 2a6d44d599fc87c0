"""Every table that a command prints keeps its words, however narrow the terminal."""

import contextlib
import io
import shlex
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

from vibrafeed.app.cli import app, catalogue, console, drives, plans, results

ROOT = Path(__file__).parents[2]
COMMANDS = (
    "scenes", "scenes rectangle-on-plane", "materials steel", "drive examples/accelerometer.csv",
    "run configs/trajectory.toml -o {}/a.nc", "run configs/trajectory.toml --dry-run",
)  # fmt: skip


@pytest.mark.parametrize("command", COMMANDS)
def test_no_word_is_lost_at_60_80_and_200_columns(command, monkeypatch, tmp_path):
    printed = []
    plain = console.table

    def kept(*arguments, **options):
        with contextlib.redirect_stdout(io.StringIO()) as captured:
            plain(*arguments, **options)
        printed.append((arguments, options, captured.getvalue()))

    monkeypatch.chdir(ROOT)
    for module in (console, catalogue, drives, plans, results):
        monkeypatch.setattr(module, "table", kept)
    done = CliRunner().invoke(app, shlex.split(command.format(tmp_path)))
    assert done.exit_code == 0, done.output
    assert printed
    monkeypatch.setattr(console, "is_terminal", lambda: True)
    for arguments, options, piped in printed:
        assert not set(piped) & set("─│━┃╭")
        words = set(piped.split()) - {"-"}
        for width in (60, 80, 200):
            terminal = Console(force_terminal=True, width=width, color_system=None)
            monkeypatch.setattr(console, "stdout", lambda terminal=terminal: terminal)
            with terminal.capture() as captured:
                plain(*arguments, **options)
            lines = captured.get().splitlines()
            told = {word for line in lines for word in line.split()}
            assert words <= told | {word.removesuffix(":") for word in told}, width
            assert max(map(len, lines)) <= width, width
