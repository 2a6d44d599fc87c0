"""A command whose extra is not installed says how to install it, in one sentence."""

from __future__ import annotations

import sys

import pytest
from typer.testing import CliRunner

from vibrafeed.app.cli import app
from vibrafeed.core.system import installing


@pytest.fixture
def not_loaded():
    """Take the rooms of the service out of memory; afterwards they are what they were."""
    rooms = ("vibrafeed.app.jobs", "vibrafeed.app.settings")
    before = {name: module for name, module in sys.modules.items() if name.startswith(rooms)}
    for name in before:
        del sys.modules[name]
    yield
    for name in [name for name in sys.modules if name.startswith(rooms)]:
        del sys.modules[name]
    sys.modules.update(before)


@pytest.mark.usefixtures("not_loaded")
@pytest.mark.parametrize("words", [["serve"], ["serve", "--show-settings"], ["key", "list"]])
def test_commands_of_the_service_name_its_extra(words, monkeypatch):
    for module in ("orjson", "pydantic_settings", "sqlalchemy", "structlog"):
        monkeypatch.setitem(sys.modules, module, None)
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 1
    missing, how = done.stderr.split(". Install it: ")
    assert missing.endswith(" is missing")
    assert how == installing(extra="serve") + "\n"


def test_a_cluster_is_no_part_of_the_base(monkeypatch, tmp_path):
    study = tmp_path / "study.toml"
    study.write_text(
        'kind = "sweep"\nscene = "rectangle-on-plane"\noutputs = ["acceleration_x"]\n'
        "parameters = { frequency = 50, amplitude = [1e-4, 2e-4], beta = 30, friction = 0.3 }\n"
        '[reduce]\nover = ["amplitude"]\nstatistics = ["max"]\n'
    )
    monkeypatch.setitem(sys.modules, "distributed", None)
    done = CliRunner().invoke(app, ["run", str(study), "--scheduler", "tcp://127.0.0.1:1"])
    assert (done.exit_code, done.stderr) == (
        1,
        f"distributed is missing. Install it: {installing('distributed', 'cluster')}\n",
    )


def test_a_module_of_ours_that_is_missing_is_a_fault_of_ours(monkeypatch):
    monkeypatch.delitem(sys.modules, "vibrafeed.app.settings", raising=False)
    monkeypatch.setitem(sys.modules, "vibrafeed.app.settings", None)
    done = CliRunner().invoke(app, ["serve", "--show-settings"])
    assert isinstance(done.exception, ModuleNotFoundError)
