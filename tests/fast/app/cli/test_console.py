"""What the command line shows: numbers, units, tables, the catalogue, help and completion."""

import json
import re

import numpy as np
import pytest
import xarray
from rich.console import Console

from commands import run, saved, tells
from pictures import legend
from vibrafeed.app.cli import COMMANDS, GONE, console
from vibrafeed.app.cli.console import block_lines, plain_lines
from vibrafeed.app.cli.units import format_number, shown_range
from vibrafeed.core.dataset.table import percent_with_error
from vibrafeed.core.plan.prepared import in_words
from vibrafeed.core.plots.drawing import draw
from vibrafeed.core.study.shown import read_shown

STUDY = """
kind = "sweep"
scene = "rectangle-on-track"
outputs = ["acceleration_x", "velocity_bound"]

[parameters]
frequency = "50 Hz"
amplitude = ["0.02 mm", "0.05 mm", "0.5 mm", "1 mm"]
beta = { start = 0, stop = 90, num = 10 }
friction = 0.3
"""
ONE = re.sub(r"(?m)^beta.*", "beta = 30", re.sub(r"\[.*mm.*\]", '"0.5 mm"', STUDY))


def row(line: str, name: str) -> list[str]:
    """Return the cells of a row of a table that a command prints plain."""
    (found,) = (found for found in run(line).output.splitlines() if found.startswith(name))
    return re.split(r"  +", found)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.114774, "0.1148"),
        (7.5, "7.5"),
        (12345.0, "12345"),
        (284241.3, "284200"),
        (-0.0, "0"),
        (1e-9, "1e-09"),
        (None, "-"),
        (float("nan"), "-"),
    ],
)
def test_numbers_have_four_digits_and_whole_ones_all(value, text):
    assert format_number(value) == text


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.8, 0.00535, "80.0 ± 0.5 %"),
        (0.759, 0.019, "76 ± 2 %"),
        (0.0123, 0.0123, "1 ± 1 %"),
        (-0.0001, 0.02, "0 ± 2 %"),
        (0.25, None, "25.0 %"),
        (0.25, 0.0, "25.0 ± 0.0 %"),
        (np.nan, 0.1, "-"),
    ],
)
def test_a_share_has_the_decimals_that_its_error_leaves(value, error, text):
    assert percent_with_error(value, error).replace(" % ±", " ±") == text


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.0123, "0.012 s"), (100, "100 s"), (8.4e2 * 86_400, "840 days"), (1e9, "12,000 days")],
)
def test_a_time_is_never_in_powers_of_ten(seconds, words):
    assert in_words(seconds) == words


@pytest.mark.parametrize(
    ("least", "largest", "units", "shown"),
    [
        (0.0123456, 0.0123466, [], ("mm/s", "12.3456", "12.3466")),
        (None, None, [], ("mm/s", "-", "-")),
        (0.5, 0.5, ["m/min"], ("m/min", "30", "30")),
    ],
)
def test_the_least_and_the_largest_value_never_look_alike(least, largest, units, shown):
    assert shown_range("m s-1", least, largest, read_shown(units)) == shown


def test_one_design_is_one_column_in_units_of_the_trade():
    saved(ONE)
    assert row("run study.toml", "output") == ["output", "value", "unit"]
    _, value, unit = row("run study.toml --force", "velocity_bound")
    assert unit == "mm/s"
    with xarray.open_dataset("study.nc") as found:
        assert float(value) == pytest.approx(1e3 * float(found.velocity_bound), rel=1e-3)
    tells("run study.toml --force", "regime: ", "1 cell evaluated")
    tells("run study.toml --dry-run", "1 cell, ")


def test_units_come_from_the_option_or_else_from_the_study():
    saved('units = ["m/min"]\n' + STUDY)
    assert row("run study.toml", "velocity_bound")[3] == "m/min"
    assert row("run study.toml --units si --force", "velocity_bound")[3] == "m/s"
    planned = "run study.toml --dry-run --units 'cm/s, rad'"
    assert row(planned, "velocity_bound")[1] == "cm/s"
    tells(planned, "alpha = 0 rad", "gravity = 9.80665 m/s²")
    assert row("scenes rectangle-on-plane --units cm", "amplitude ")[2] == "cm"


def test_the_console_and_the_map_tell_the_same_shares():
    saved(STUDY)
    (line,) = re.findall("^  regimes: (.*)", run("run study.toml").output, re.MULTILINE)
    told = dict(one.split(" ", 1) for one in line.split(", "))
    with xarray.open_dataset("study.nc") as dataset:
        entries = [entry.rsplit(", ", 1) for entry in legend(draw(dataset.load(), kind="map"))]
    assert len(told) > 1
    assert told == {name.split(" (")[0].replace(" ", "_"): share for name, share in entries}


COLUMNS = ("name", "unit", "meaning")
ROWS = [("a_long_name", "", "what it means, told in many more words than fit"), ("b", "m", "short")]


def test_piped_tables_are_plain_whatever_the_width():
    first, second, third = plain_lines(COLUMNS, ROWS)
    assert re.split(r"  +", first) == [*COLUMNS]
    assert re.split(r"  +", second) == ["a_long_name", "-", ROWS[0][2]]
    assert third == "b            m     short"
    narrow, wide = (run("scenes rectangle-on-track", env={"COLUMNS": n}) for n in ("40", "300"))
    assert narrow.stdout == wide.stdout
    assert not set(narrow.stdout) & set("─│━┃╭")


def test_narrow_tables_are_blocks():
    assert list(block_lines(COLUMNS, ROWS, 30)) == [
        "  name         unit",
        "    meaning",
        "  a_long_name",
        "    what it means, told in",
        "    many more words than fit",
        "  b            m",
        "    short",
    ]


@pytest.mark.parametrize("width", [60, 80, 200])
@pytest.mark.parametrize("command", ["scenes", "scenes rectangle-on-track"])
def test_no_word_of_the_catalogue_is_lost_on_a_terminal(command, width, monkeypatch):
    piped = set(run(command).stdout.split()) - {"-"}
    terminal = Console(force_terminal=True, width=width, color_system=None, highlight=False)
    monkeypatch.setattr(console, "stdout", lambda: terminal)
    monkeypatch.setattr(console, "is_terminal", lambda: True)
    words = run(command).stdout.split()
    assert piped <= {word.removesuffix(":") for word in words} | set(words)


def test_the_catalogue_has_units_equations_and_validity():
    tells("scenes", "cylinder-on-plane")
    words = ("(3.18)", "mm/s", "wall_lost", "snapshot")
    tells("scenes rectangle-on-track --variant thesis", *words)
    assert [one["name"] for one in json.loads(run("scenes --json").stdout)]
    assert json.loads(run("scenes rectangle-on-plane --json").stdout)["parameters"]
    assert json.loads(console.as_json({"a": [float("nan"), 1.5], "b": (float("inf"),)})) == {
        "a": [None, 1.5],
        "b": [None],
    }


def test_help_and_version_have_their_usual_names():
    assert run("-h").stdout == run("--help").stdout
    assert "--force" in run("run -h").stdout
    assert re.fullmatch(r"vibrafeed \d+\.\d+\.\d+\n", run("--version").stdout)


@pytest.mark.parametrize("name", GONE)
def test_a_command_of_old_names_what_does_the_same(name):
    assert run(f"{name} --any words", 2).stderr == f"There is no command {name}. {GONE[name]}.\n"
    assert name not in COMMANDS


@pytest.mark.parametrize(
    ("shell", "begins"),
    [
        ("bash", "_vibrafeed_completion()"),
        ("zsh", "#compdef vibrafeed"),
        ("fish", "complete --command vibrafeed"),
        ("powershell", "Import-Module PSReadLine"),
    ],
)
def test_each_shell_has_its_completion(shell, begins, monkeypatch):
    monkeypatch.setattr("shellingham.detect_shell", lambda: (shell, shell))
    assert run("--show-completion", prog_name="vibrafeed").stdout.startswith(begins)
    variables = {
        "_VIBRAFEED_COMPLETE": f"complete_{shell}",
        "COMP_WORDS": "vibrafeed scenes cyl",
        "COMP_CWORD": "2",
        "_TYPER_COMPLETE_ARGS": "vibrafeed scenes cyl",
        "_TYPER_COMPLETE_FISH_ACTION": "get-args",
        "_TYPER_COMPLETE_WORD_TO_COMPLETE": "cyl",
    }
    offered = run("", prog_name="vibrafeed", env=variables).stdout
    assert "cylinder-on-plane" in offered
    assert "rectangle" not in offered
