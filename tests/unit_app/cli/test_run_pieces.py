"""Simulations, optimisations and studies of tolerances that were stopped go on where they were."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
import xarray
from typer.testing import CliRunner

from vibrafeed.app.cli import app as commands
from vibrafeed.app.cli import pieces
from vibrafeed.core.dataset.files import partial

MOTION = """
kind = "simulate"
scene = "rectangle-on-plane"
outputs = ["conveying_velocity", "throw_number"]

[parameters]
frequency = "50 Hz"
amplitude = ["0.1 mm", "0.2 mm", "0.3 mm"]
beta = [20, 30]
friction = [0.3, 0.4]
"""
BEST = """
kind = "optimise"
scene = "rectangle-on-plane"
criterion = { kind = "maximise", output = "conveying_velocity" }
variables = { beta = { lower = "5 deg", upper = "60 deg" } }

[parameters]
frequency = "50 Hz"
amplitude = ["0.1 mm", "0.2 mm"]
friction = [0.3, 0.4]
"""
TOLERANCES = """
kind = "sensitivity"
scene = "rectangle-on-plane"
outputs = ["conveying_velocity"]
samples = 256

[uncertain]
friction = { mean = 0.3, deviation = 0.03 }
amplitude = { lower = "0.24 mm", upper = "0.26 mm" }

[parameters]
frequency = "50 Hz"
beta = [20, 25, 30]
"""
STUDIES = {"motion": MOTION, "best": BEST, "tolerances": TOLERANCES}
RUN_ALONE = ("elapsed_seconds", "cells_per_second", "history")


@pytest.fixture
def computed(monkeypatch) -> list[int]:
    """Return a list of the pieces that are computed; each is a cell or a design."""
    numbers: list[int] = []
    plain = pieces.Pieces._piece

    def piece(self, index, watch):
        numbers.append(index)
        return plain(self, index, watch)

    monkeypatch.setattr(pieces, "PIECE_SECONDS", 1e-9)
    monkeypatch.setattr(pieces.Pieces, "_piece", piece)
    return numbers


@pytest.fixture
def stop_at(monkeypatch, computed) -> list[int]:
    """Return a list whose number is the piece in whose midst a run is stopped."""
    numbers: list[int] = []
    plain = pieces.Pieces.tabulate

    def tabulate(self, watch):
        stop = lambda: bool(numbers) and len(computed) >= numbers[0]  # noqa: E731
        return plain(self, replace(watch, stop=stop))

    monkeypatch.setattr(pieces.Pieces, "tabulate", tabulate)
    return numbers


def run(*arguments: object):
    return CliRunner().invoke(commands, ["run", *map(str, arguments)])


def words(outcome) -> str:
    return " ".join(outcome.output.split())


def result(path: Path) -> xarray.Dataset:
    with xarray.open_dataset(path, decode_times=False) as file:
        dataset = file.load()
    for name in RUN_ALONE:
        dataset.attrs.pop(name, None)
    return dataset


@pytest.mark.by_day(1)
@pytest.mark.parametrize(("name", "count"), [("motion", 12), ("best", 4), ("tolerances", 3)])
def test_a_study_that_was_stopped_goes_on_where_it_was(
    name, count, tmp_path, monkeypatch, computed, stop_at
):
    study, target = tmp_path / f"{name}.toml", tmp_path / f"{name}.nc"
    study.write_text(STUDIES[name])
    with monkeypatch.context() as whole:
        whole.setattr(pieces, "PIECE_SECONDS", 1e9)
        assert run(study, "-o", tmp_path / "whole.nc").exit_code == 0
    assert not computed  # one piece is not kept

    stop_at.append(3)
    stopped = run(study)
    assert stopped.exit_code == 1, stopped.output
    assert f"2 of its {count} pieces" in words(stopped) or f"2 of {count} pieces" in words(stopped)
    assert "--resume goes on with" in words(stopped)

    stop_at.clear()
    computed.clear()
    resumed = run(study, "--resume")
    assert resumed.exit_code == 0, resumed.output
    assert f"continuing: 2 of {count} pieces were done before" in words(resumed)
    assert computed == [*range(2, count)]
    assert not partial(target).exists()
    xarray.testing.assert_identical(result(target), result(tmp_path / "whole.nc"))


def test_pieces_survive_a_kill_and_damage(tmp_path, computed, stop_at):
    study, target = tmp_path / "motion.toml", tmp_path / "motion.nc"
    study.write_text(MOTION)
    stop_at.append(5)
    run(study)
    target.unlink()  # a kill leaves the pieces alone
    stop_at.clear()
    computed.clear()
    one, *_ = sorted(partial(target).rglob("*.block"))
    one.write_bytes(one.read_bytes()[:-1])
    assert run(study, "--resume").exit_code == 0
    assert computed == [*range(4, 12), 0]
    assert not partial(target).exists()


def test_other_studies_and_runs_without_resume_take_no_pieces(tmp_path, computed, stop_at):
    study, target = tmp_path / "motion.toml", tmp_path / "motion.nc"
    for options, content in (
        (["--resume"], MOTION.replace("20, 30", "20, 35")),
        (["--force"], MOTION),
    ):
        study.write_text(MOTION)
        computed.clear()
        stop_at.append(5)
        run(study)
        target.unlink()
        stop_at.clear()
        computed.clear()
        study.write_text(content)
        assert run(study, *options).exit_code == 0
        assert computed == [*range(12)]
        assert not partial(target).exists()
        target.unlink()


def test_a_disk_that_takes_no_pieces_ends_no_study(tmp_path, monkeypatch, computed):
    study = tmp_path / "motion.toml"
    study.write_text(MOTION)

    def full(*arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(pieces.Blocks, "write_block", full)
    assert run(study).exit_code == 0
    assert computed == [*range(12)]
    assert (tmp_path / "motion.nc").exists()
