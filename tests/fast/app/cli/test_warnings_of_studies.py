"""Warnings of studies on the command line: told as such, counted, and refused by --strict."""

import json

import pytest
from typer.testing import CliRunner

from vibrafeed.app.cli import app

STUDY = """
kind = "sweep"
scene = "rectangle-on-plane"
outputs = ["acceleration_x"]
[parameters]
frequency = 50
amplitude = "0.1 mm"
beta = 20
friction = 0.3
"""
AMPLITUDE = (
    "warning: amplitude = 0.1 means 100 mm; usual values are 0.0001 to 25 mm. "
    'Did you mean "0.1 mm"?'
)
BETA = 'warning: beta = 0.35 means 0.35 °; usual values are 1 to 180 °. Did you mean "0.35 rad"?'


@pytest.fixture
def batch(tmp_path):
    files = [tmp_path / f"study-{number}.toml" for number in range(3)]
    for file in files:
        file.write_text(STUDY)
    files[1].write_text(STUDY.replace('"0.1 mm"', "0.1").replace("20", "0.35"))
    return files


def run(*arguments):
    return CliRunner().invoke(app, ["run", *map(str, arguments)])


@pytest.mark.parametrize("options", [(), ("--quiet",), ("--json",), ("--dry-run",)])
def test_warnings_are_told_as_such_and_counted(batch, options):
    done = run(*batch, *options)
    assert done.exit_code == 0, done.output
    lines = done.stderr.splitlines()
    assert lines == [
        f"{batch[1]}: {AMPLITUDE}", f"{batch[1]}: {BETA}", "2 warnings in 1 of 3 studies",
    ]  # fmt: skip
    if "--json" in options:
        found = [one["warnings"] for one in json.loads(done.stdout)["results"]]
        assert [len(one) for one in found] == [0, 2, 0]
        assert f"warning: {found[1][0]}" == AMPLITUDE


@pytest.mark.parametrize("options", [(), ("--dry-run",), ("--json",)])
def test_strict_refuses_them_before_anything_is_written(batch, options):
    done = run(*batch, "--strict", *options)
    assert done.exit_code == 2
    assert done.stderr.splitlines()[-1] == (
        "error: 2 warnings in 1 of 3 studies; --strict runs no study then"
    )
    assert not done.stdout
    assert sorted(batch[0].parent.iterdir()) == batch


def test_strict_runs_what_has_none(batch):
    done = run(batch[0], batch[2], "--strict")
    assert done.exit_code == 0, done.output
    assert "warning" not in done.output


def test_a_sweep_in_blocks_warns_too(batch):
    done = run(batch[1], "-o", batch[0].parent / "blocks.zarr")
    assert f"{batch[1]}: {BETA}" in done.stderr
    assert done.stderr.splitlines()[-1] == "2 warnings"


def test_errors_say_so_beside_warnings(batch):
    batch[0].write_text(STUDY.replace("friction = 0.3", "friction = 0,3"))
    done = run(*batch)
    assert done.exit_code == 2
    assert done.stderr.splitlines() == [
        f"{batch[1]}: {AMPLITUDE}",
        f"{batch[1]}: {BETA}",
        f"{batch[0]}: error: 1 problem",
        "  file: line 9: the number 0,3 has a decimal comma. Write 0.3.",
    ]


def test_other_commands_warn_in_the_same_form(batch):
    for arguments, name in (
        (["convert", str(batch[1]), "--to", "json"], batch[1]),
        (["new", "-", "--amplitude", "0.1", "--yes"], "new"),
    ):
        done = CliRunner().invoke(app, arguments)
        assert done.exit_code == 0
        assert f"{name}: {AMPLITUDE}" in done.stderr
