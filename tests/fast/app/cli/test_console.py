"""What the command line shows, and its usual options."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
import xarray
from rich.console import Console
from typer.testing import CliRunner

from vibrafeed.app.cli import app, console
from vibrafeed.app.cli.console import block_lines, plain_lines
from vibrafeed.app.cli.units import format_number, shown_range
from vibrafeed.core.study.shown import ShownUnits, read_shown

STUDY = """
kind = "sweep"
scene = "rectangle-on-track"
outputs = ["acceleration_x", "velocity_bound"]

[parameters]
frequency = "50 Hz"
amplitude = "0.5 mm"
beta = { start = 0, stop = 90, num = 10 }
friction = 0.3
"""
ONE = STUDY.replace("{ start = 0, stop = 90, num = 10 }", "30")


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def run(*arguments: object, **more: object):
    return CliRunner().invoke(app, [str(argument) for argument in arguments], **more)


def row(output: str, name: str) -> list[str]:
    """Return the cells of a row of a table that is printed plain."""
    (line,) = (line for line in output.splitlines() if line.startswith(name))
    return re.split(r"  +", line)


# --- units and digits


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


def test_the_least_and_the_largest_value_never_look_alike():
    assert shown_range("m s-1", 0.0123456, 0.0123466, ShownUnits()) == (
        "mm/s",
        "12.3456",
        "12.3466",
    )
    assert shown_range("m", None, None, ShownUnits()) == ("mm", "-", "-")
    assert shown_range("m s-1", 0.5, 0.5, read_shown(["m/min"])) == ("m/min", "30", "30")


def test_one_design_is_one_column_in_units_of_the_trade(study):
    study.write_text(ONE)
    result = run("run", study)
    assert result.exit_code == 0, result.output
    assert row(result.output, "output") == ["output", "value", "unit"]
    _, value, unit = row(result.output, "velocity_bound")
    assert unit == "mm/s"
    with xarray.open_dataset(study.with_suffix(".nc")) as found:
        assert float(value) == pytest.approx(1e3 * float(found.velocity_bound), rel=1e-3)
    assert "regime: " in result.output
    assert "1 cell evaluated" in result.output
    assert "least" not in result.output


def test_an_output_in_words_is_told_in_words(tmp_path):
    study = tmp_path / "motion.toml"
    study.write_text(
        'kind = "simulate"\nscene = "rectangle-on-plane"\noutputs = ["direction"]\n[parameters]\n'
        'frequency = 50\namplitude = "0.1 mm"\nbeta = 30\nfriction = 0.4\n'
    )
    assert "  direction: forwards\n" in run("run", study).output
    document = json.loads(run("run", study, "--json", "--force").output)
    assert document["results"][0]["states"] == {"direction": {"forwards": 1.0}}


def test_units_come_from_the_option_or_else_from_the_study(study):
    study.write_text('units = ["m/min"]\n' + STUDY)
    assert row(run("run", study).output, "velocity_bound")[3] == "m/min"
    shown = run("run", study, "--units", "si", "--force").output
    assert row(shown, "velocity_bound")[3] == "m/s"
    planned = run("run", study, "--dry-run", "--units", "cm/s, rad").output
    assert row(planned, "velocity_bound")[1] == "cm/s"
    assert "alpha = 0 rad" in planned
    assert "gravity = 9.80665 m/s²" in planned
    scene = run("scenes", "rectangle-on-plane", "--units", "cm").output
    assert row(scene, "amplitude ")[2] == "cm"
    for command in (("run", study, "--force"), ("scenes",)):
        wrong = run(*command, "--units", "mm, cheese")
        assert wrong.exit_code == 2
        assert "'cheese' is not a unit that vibrafeed knows. Write trade, si" in wrong.output


def test_the_console_and_the_map_tell_the_same_shares(tmp_path):
    from pictures import legend
    from vibrafeed.core.plots.drawing import draw

    study = tmp_path / "study.toml"
    study.write_text(STUDY.replace('"0.5 mm"', '["0.02 mm", "0.05 mm", "0.5 mm", "1 mm"]'))
    output = run("run", study).output
    (line,) = (line for line in output.splitlines() if line.startswith("  regimes: "))
    told = dict(one.split(" ", 1) for one in line.removeprefix("  regimes: ").split(", "))
    with xarray.open_dataset(study.with_suffix(".nc")) as dataset:
        entries = [entry.rsplit(", ", 1) for entry in legend(draw(dataset.load(), kind="map"))]
    shares = {name.split(" (")[0].replace(" ", "_"): share for name, share in entries}
    assert len(told) > 1
    assert told == {
        name: share.replace("\N{NO-BREAK SPACE}", " ") for name, share in shares.items()
    }


# --- tables


COLUMNS = ("name", "unit", "meaning")
ROWS = [("a_long_name", "", "what it means, told in many more words than fit"), ("b", "m", "short")]


def test_piped_tables_are_plain_whatever_the_width():
    first, second, third = plain_lines(COLUMNS, ROWS)
    assert re.split(r"  +", first) == [*COLUMNS]
    assert re.split(r"  +", second) == ["a_long_name", "-", ROWS[0][2]]
    assert third == "b            m     short"
    narrow, wide = (run("scenes", "rectangle-on-track", env={"COLUMNS": n}) for n in ("40", "300"))
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
def test_no_word_of_the_catalogue_is_lost_on_a_terminal(width, monkeypatch):
    commands = (["scenes"], ["scenes", "rectangle-on-track"])
    piped = [set(run(*command).stdout.split()) - {"-"} for command in commands]
    terminal = Console(force_terminal=True, width=width, color_system=None, highlight=False)
    monkeypatch.setattr(console, "stdout", lambda: terminal)
    monkeypatch.setattr(console, "is_terminal", lambda: True)
    for command, words in zip(commands, piped, strict=True):
        lines = run(*command).stdout
        assert words <= {word.removesuffix(":") for word in lines.split()} | set(lines.split())


# --- usual options


def test_help_and_version_have_their_usual_names():
    assert run("-h").stdout == run("--help").stdout
    assert "--force" in run("run", "-h").stdout
    assert re.fullmatch(r"vibrafeed \d+\.\d+\.\d+\n", run("--version").stdout)


def test_the_commands_themselves_load_nothing_that_draws_or_computes():
    code = (
        "import sys, vibrafeed.app.cli; "
        "print(*{'rich', 'numpy', 'pydantic', 'pint'}.intersection(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish", "powershell"])
def test_each_shell_has_its_completion(shell, monkeypatch):
    monkeypatch.setattr("shellingham.detect_shell", lambda: (shell, shell))
    script = run("--show-completion", prog_name="vibrafeed").stdout
    begins = {
        "bash": "_vibrafeed_completion()",
        "zsh": "#compdef vibrafeed",
        "fish": "complete --command vibrafeed",
        "powershell": "Import-Module PSReadLine",
    }
    assert script.startswith(begins[shell])
    assert "_VIBRAFEED_COMPLETE" in script
    variables = {
        "_VIBRAFEED_COMPLETE": f"complete_{shell}",
        "COMP_WORDS": "vibrafeed scenes cyl",
        "COMP_CWORD": "2",
        "_TYPER_COMPLETE_ARGS": "vibrafeed scenes cyl",
        "_TYPER_COMPLETE_FISH_ACTION": "get-args",
        "_TYPER_COMPLETE_WORD_TO_COMPLETE": "cyl",
    }
    offered = run(prog_name="vibrafeed", env=variables).stdout
    assert "cylinder-on-plane" in offered
    assert "rectangle" not in offered


def test_completion_is_installed_where_the_shell_looks(tmp_path, monkeypatch):
    monkeypatch.setattr("shellingham.detect_shell", lambda: ("bash", "bash"))
    monkeypatch.setenv("HOME", str(tmp_path))
    result = run("--install-completion", prog_name="vibrafeed")
    assert result.exit_code == 0, result.output
    (script,) = (tmp_path / ".bash_completions").iterdir()
    assert "_VIBRAFEED_COMPLETE" in script.read_text()
    assert str(script) in (tmp_path / ".bashrc").read_text()


def test_an_existing_result_is_replaced_with_force_only(study, tmp_path):
    other = tmp_path / "other.toml"
    other.write_text(ONE)
    result = tmp_path / "study.nc"
    result.write_text("mine")
    refused = run("run", other, study)
    assert refused.exit_code == 2
    told = f"output: {result} exists already. Add --force to replace it, or give another name"
    assert told in refused.output
    assert result.read_text() == "mine"
    assert not (tmp_path / "other.nc").exists()  # all are looked at before anything runs
    assert run("run", study, "--resume").exit_code == 2  # it is no result of this study
    assert run("run", study, "--dry-run").exit_code == 0
    assert run("run", other, study, "--force").exit_code == 0
    before = result.stat().st_mtime_ns
    again = run("run", study, "--resume")
    assert again.exit_code == 0
    assert f"{result} is complete already" in again.output
    assert result.stat().st_mtime_ns == before


def test_a_stopped_study_says_how_much_is_done_and_how_to_go_on(tmp_path, stopped_after):
    study = tmp_path / "motion.toml"
    study.write_text(
        'method = "reference"\nkind = "simulate"\nscene = "rectangle-on-plane"\n'
        "[parameters]\nfrequency = 50\n"
        'amplitude = "0.1 mm"\nbeta = [20, 30]\nfriction = 0.4\n'
    )
    stopped_after(1)
    stopped = run("run", study)
    assert stopped.exit_code == 1
    assert "The run was stopped: 1 of 2 cells are computed." in stopped.output
    assert "The same command with --resume computes the whole study again." in stopped.output
    assert "1 of 2 cells evaluated in" in stopped.output
    stopped_after(-1)  # never
    assert run("run", study).exit_code == 2
    resumed = run("run", study, "--resume")
    assert resumed.exit_code == 0, resumed.output
    assert "  2 cells evaluated in" in resumed.output
    assert "is complete already" in run("run", study, "--resume").output


def test_one_json_document_in_the_units_of_files(study):
    planned = json.loads(run("run", study, "--dry-run", "--json").stdout)["plans"][0]
    assert planned["cells"] == 10
    assert planned["outputs"]["velocity_bound"] == {"unit": "m s-1", "dimensions": {"beta": 10}}
    assert planned["defaults"]["gravity"] == {"value": 9.80665, "unit": "m s-2"}
    ran = run("run", study, "--json", "--units", "mm")
    (result,) = json.loads(ran.stdout)["results"]
    with xarray.open_dataset(study.with_suffix(".nc")) as found:
        assert result["outputs"]["velocity_bound"]["largest"] == float(found.velocity_bound.max())
    assert result["cells"] == result["cells_computed"] == 10
    assert sum(result["regimes"].values()) == pytest.approx(1)
    assert [one["name"] for one in json.loads(run("scenes", "--json").stdout)]
    assert json.loads(run("scenes", "rectangle-on-plane", "--json").stdout)["parameters"]


def test_values_that_are_none_are_null():
    assert console._without_nan({"a": [float("nan"), 1.5], "b": (float("inf"),)}) == {
        "a": [None, 1.5],
        "b": [None],
    }


def test_quiet_prints_nothing_and_verbose_more(study):
    assert run("run", study, "-q").output == ""
    assert "equations" not in run("run", study, "--force").output
    told = run("run", study, "--force", "-v").output
    assert re.search(r"checked in \d+\.\d+ s; variant physical", told)
    assert "  equations: " in told
    assert "  kernels: " in told


@pytest.mark.parametrize("text", [STUDY, "\ufeff" + STUDY])
def test_a_study_comes_from_standard_input_and_a_result_goes_to_standard_output(
    text, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    done = run("run", "-", "-o", "-", input=text)
    assert done.exit_code == 0, done.output
    heading, *rows = done.stdout.splitlines()
    assert heading.startswith("beta [degree],")
    assert len(rows) == 10
    assert list(tmp_path.iterdir()) == []
    content = {
        "kind": "sweep",
        "scene": "rectangle-on-plane",
        "outputs": ["throw_number"],
        "parameters": {"frequency": 50, "amplitude": "0.5 mm", "beta": 30},
    }
    assert run("run", "-", input=json.dumps(content)).exit_code == 0
    assert (tmp_path / "study.nc").exists()
    one = run("run", "-", "-o", "-", input=json.dumps(content))
    assert len(one.stdout.splitlines()) == 2
    binary = run("run", "-", "-o", "-.nc", input=json.dumps(content))
    assert binary.stdout_bytes[1:4] == b"HDF"
    wrong = run("run", "-", input=b"\xff\xfe")
    assert wrong.exit_code == 2
    assert (
        "standard input: error: 1 problem\n  file: standard input is not UTF-8 text."
        in wrong.output
    )


def test_what_cannot_go_to_standard_output_is_refused(study, tmp_path, monkeypatch):
    other = tmp_path / "other.toml"
    other.write_text(STUDY)
    for arguments, told in (
        ((study, other, "-o", "-"), "standard output takes the result of one study"),
        ((study, "-o", "-.zarr"), "a Zarr group consists of many files"),
        ((study, "-o", "-", "--json"), "standard output cannot take both"),
    ):
        refused = run("run", *arguments)
        assert refused.exit_code == 2
        assert told in refused.output
    terminal = SimpleNamespace(stdout=SimpleNamespace(isatty=lambda: True))
    monkeypatch.setattr("vibrafeed.app.cli.run.sys", terminal)
    refused = run("run", study, "-o", "-.nc")
    assert refused.exit_code == 2
    assert "a terminal cannot show .nc. Write -o - for CSV" in refused.output
