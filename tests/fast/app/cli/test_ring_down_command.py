"""`vibrafeed drive --ring-down`: natural frequency, damping ratio and moving mass of a knock."""

import json
import tomllib

import numpy as np
import pytest
from typer.testing import CliRunner

from vibrafeed.app.cli import app

TIMES = np.arange(1500) / 1000.0
TURN = 2.0 * np.pi * 53.0


def run(*arguments: object):
    return CliRunner().invoke(app, ["drive", *map(str, arguments), "--along", "ax", "--ring-down"])


@pytest.fixture
def recordings(tmp_path):
    """Return the recordings of a knock on a feeder of 10 kg, and of one with 2 kg more."""
    rng = np.random.default_rng(1)
    files = []
    for name, mass in (("empty", 10.0), ("loaded", 12.0)):
        turn = TURN * np.sqrt(10.0 / mass)
        after = np.maximum(TIMES - 0.1, 0.0)
        wave = 30.0 * np.exp(-0.02 * turn * after) * np.cos(turn * after) * (TIMES >= 0.1)
        wave += 0.3 * rng.standard_normal(1500)
        rows = "\n".join(f"{t:.3f};{v:.4f}" for t, v in zip(TIMES, wave, strict=True))
        files.append(tmp_path / f"{name}.csv")
        files[-1].write_text(f"Zeit [s];ax [m/s2]\n{rows}".replace(".", ","))
    return files


def test_the_numbers_of_a_drive_unit_are_printed(recordings):
    empty, loaded = recordings
    result = run(empty, "--loaded", loaded, "--added-mass", "2 kg")
    assert result.exit_code == 0, result.output
    for words in (
        "natural frequency: 53.0",
        "damping ratio: 0.0",
        "moving mass: ",
        "not explained",
    ):
        assert words in result.output
    lines = run(empty, "--toml", "-o", empty.with_suffix(".toml"))
    parameters = tomllib.loads(lines.stdout)["parameters"]
    assert parameters == tomllib.loads(empty.with_suffix(".toml").read_text())["parameters"]
    assert float(parameters["ring_down_frequency"].removesuffix(" Hz")) == pytest.approx(
        53, rel=1e-3
    )
    assert float(parameters["damping_ratio"]) == pytest.approx(0.02, rel=0.05)
    document = json.loads(run(empty, "--loaded", loaded, "--added-mass", 2, "--json").stdout)
    assert abs(document["moving_mass"] - 10.0) < 4.0 * document["moving_mass_error"]


def test_what_is_wrong_is_told(recordings, tmp_path):
    empty, loaded = recordings
    result = run(empty, "--loaded", loaded, "--plot", "x.png")
    assert result.exit_code == 2
    assert "a ring-down cannot be drawn" in result.output
    assert "--loaded and --added-mass need each other" in result.output
    swapped = run(loaded, "--loaded", empty, "--added-mass", "2 kg")
    assert swapped.exit_code == 2
    assert "Give the recording without the mass first" in swapped.output
    assert (
        "is not a unit" in run(empty, "--loaded", loaded, "--added-mass", "2 stoneweights").output
    )
    assert "cannot be read" in run(tmp_path / "none.csv").output
