"""What the page on scale shows is carried out or read, as far as a machine without a queue can."""

import re
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from typer.testing import CliRunner

import vibrafeed
from tools import tool
from vibrafeed.app.cli import app
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate

ROOT = Path(__file__).parents[2]
SCALE = (ROOT / "docs" / "scale.md").read_text(encoding="utf-8")


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


SWEEP, _ = blocks(SCALE, "python")


def test_ten_lines_of_xarray_on_a_hundredth(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    with mpl.rc_context({"backend": "agg"}):
        exec(SWEEP.replace('"num": 1000', '"num": 100'), names)
    assert capsys.readouterr().out == "100,000,000 cells\n"
    assert (tmp_path / "fastest.png").stat().st_size > 10_000
    fastest = names["fastest"].isel(frequency=[0, 50, 99], amplitude=[0, 60, 99])
    some = vibrafeed.sweep(
        "rectangle-on-plane", outputs=["acceleration_x", "throw_number"],
        frequency=fastest.frequency.values, amplitude=fastest.amplitude.values,
        beta={"start": 5, "stop": 60, "num": 100},
        friction={"start": 0.1, "stop": 0.6, "num": 100},
    )  # fmt: skip
    wanted = some.acceleration_x.where(some.throw_number < 1, 0).max(["beta", "friction"])
    np.testing.assert_array_equal(fastest, wanted)


@pytest.mark.parametrize("command", re.findall(r"vibrafeed (run .*)", SCALE))
def test_options_of_a_command_exist(command: str) -> None:
    known = CliRunner().invoke(app, ["run", "--help"]).output
    assert set(re.findall(r"(?<=\s)--?[a-z][-a-z]*", command)) <= set(
        re.findall(r"-[-a-z]+", known)
    )


@pytest.mark.parametrize("script", blocks(SCALE, "sh"))
def test_scripts_are_shell(script: str) -> None:
    subprocess.run([tool("bash"), "-n"], input=script, text=True, check=True)


def test_what_the_page_on_reductions_shows_gives_what_it_says() -> None:
    content: dict[str, Any] = tomllib.loads(blocks(SCALE, "toml")[0])
    content["parameters"]["frequency"]["num"] = 3
    found = tabulate(prepare_content(content)).variables
    named = set(
        re.findall(r"`(transport_velocity_\w+|share_\w+|level_[a-z]\w+|regime_\w+_count)`", SCALE)
    )
    assert named
    assert named <= set(found)
