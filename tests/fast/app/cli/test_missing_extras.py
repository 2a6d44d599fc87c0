"""A command whose extra is not installed says how to install it, in one sentence."""

import sys

import pytest
from typer.testing import CliRunner

import vibrafeed.app
from commands import run, saved
from vibrafeed.app.cli import app
from vibrafeed.core.system import installing

ROOMS = ("vibrafeed.app.jobs", "vibrafeed.app.settings")


@pytest.fixture
def not_loaded():
    """Take the rooms of the service out of memory; afterwards they are what they were."""
    before, rooms = dict(sys.modules), dict(vars(vibrafeed.app))
    for name in [name for name in before if name.startswith(ROOMS)]:
        del sys.modules[name]
    yield
    for name in [name for name in sys.modules if name.startswith(ROOMS)]:
        del sys.modules[name]
    sys.modules.update(before)
    vars(vibrafeed.app).update(rooms)


@pytest.mark.usefixtures("not_loaded")
@pytest.mark.parametrize("line", ["serve", "serve --show-settings", "key list"])
def test_commands_of_the_service_name_its_extra(line, monkeypatch):
    for module in ("orjson", "pydantic_settings", "sqlalchemy", "structlog"):
        monkeypatch.setitem(sys.modules, module, None)
    missing, how = run(line, 1).stderr.split(". Install it: ")
    assert missing.endswith(" is missing")
    assert how == installing(extra="serve") + "\n"


STUDY = """
kind = "sweep"
scene = "rectangle-on-plane"
outputs = ["acceleration_x"]
parameters = { frequency = 50, amplitude = [1e-4, 2e-4], beta = 30, friction = 0.3 }
[reduce]
over = ["amplitude"]
statistics = ["max"]
"""


@pytest.mark.parametrize(
    ("package", "line", "code", "told"),
    [
        (
            "distributed",
            "run study.toml --scheduler tcp://127.0.0.1:1",
            1,
            f"distributed is missing. Install it: {installing('distributed', 'cluster')}\n",
        ),
        (
            "xlsxwriter",
            "run study.toml -o x.xlsx",
            2,
            f"{installing('xlsxwriter')}. Or end the name of the output in .nc or .csv.\n",
        ),
    ],
)
def test_a_package_that_is_missing_is_told_before_anything_is_computed(
    package, line, code, told, here, monkeypatch
):
    monkeypatch.setitem(sys.modules, package, None)
    saved(STUDY)
    assert run(line, code).stderr.endswith(told)
    assert [path.name for path in here.iterdir()] == ["study.toml"]


def test_a_module_of_ours_that_is_missing_is_a_fault_of_ours(monkeypatch):
    monkeypatch.setitem(sys.modules, "vibrafeed.app.settings", None)
    done = CliRunner().invoke(app, ["serve", "--show-settings"])
    assert isinstance(done.exception, ModuleNotFoundError)
