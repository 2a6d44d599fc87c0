"""Warnings of studies on the command line: told as such, counted, and refused by --strict."""

import json

import pytest

from commands import run, saved

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
WARNED = [f"b.toml: {AMPLITUDE}", f"b.toml: {BETA}"]
COUNT = "2 warnings in 1 of 3 studies"


@pytest.fixture(autouse=True)
def batch():
    unusual = STUDY.replace('"0.1 mm"', "0.1").replace("20", "0.35")
    for name, text in {"a.toml": STUDY, "b.toml": unusual, "c.toml": STUDY}.items():
        saved(text, name)


@pytest.mark.parametrize("options", ["", "--quiet", "--json", "--dry-run"])
def test_warnings_are_told_as_such_and_counted(options):
    done = run(f"run a.toml b.toml c.toml {options}")
    assert done.stderr.splitlines() == [*WARNED, COUNT]
    if options == "--json":
        found = [one["warnings"] for one in json.loads(done.stdout)["results"]]
        assert [[f"b.toml: warning: {one}" for one in told] for told in found] == [[], WARNED, []]


@pytest.mark.parametrize("options", ["", "--dry-run", "--json"])
def test_strict_refuses_them_before_anything_is_written(here, options):
    done = run(f"run a.toml b.toml c.toml --strict {options}", 2)
    assert done.stderr.splitlines()[-1] == f"error: {COUNT}; --strict runs no study then"
    assert not done.stdout
    assert not list(here.glob("*.nc"))


def test_strict_runs_what_has_none():
    assert "warning" not in run("run a.toml c.toml --strict").output


def test_errors_say_so_beside_warnings():
    saved(STUDY.replace("friction = 0.3", "friction = 0,3"), "a.toml")
    assert run("run a.toml b.toml c.toml", 2).stderr.splitlines() == [
        *WARNED,
        "a.toml: error: 1 problem",
        "  file: line 9: the number 0,3 has a decimal comma. Write 0.3.",
    ]


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("run b.toml -o blocks.zarr", "b.toml"),
        ("convert b.toml --to json", "b.toml"),
        ("new - --amplitude 0.1 --yes", "new"),
    ],
)
def test_other_ways_warn_in_the_same_form(line, name):
    assert f"{name}: {AMPLITUDE}" in run(line).stderr
