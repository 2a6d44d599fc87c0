"""`vibrafeed atlas` and `vibrafeed lookup`, as a user runs them."""

from __future__ import annotations

import json

import pytest
import xarray
from typer.testing import CliRunner

from vibrafeed.app.cli import app

PART = ("frequency=50 Hz", "amplitude=0.4 mm", "beta=25", "friction=0.3")


def run(*arguments: object):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def atlas(tmp_path_factory):
    path = tmp_path_factory.mktemp("atlas") / "atlas.zarr"
    result = run("atlas", "-o", path, "--resolution", "coarse")
    assert result.exit_code == 0, result.output
    assert "nodes" in result.stdout
    return path


def test_it_opens_in_other_readers(atlas):
    dataset = xarray.open_zarr(atlas)
    assert dataset.velocity_number.dims == tuple(dataset.sizes)
    assert dataset.attrs["resolution"] == "coarse"


def test_one_part(atlas):
    result = run("lookup", *PART, "--atlas", atlas)
    assert result.exit_code == 0, result.output
    for words in ("43.6", "mm/s, stated error", "from the atlas", "hopping", "in the air 64.9 %"):
        assert words in result.stdout
    result = run("lookup", *PART, "--atlas", atlas, "--units", "m/min")
    assert "m/min" in result.stdout


def test_angles_are_named_by_their_words(atlas, tmp_path):
    words = [part.replace("beta", "elevation") for part in PART]
    expected = json.loads(run("lookup", *PART, "--atlas", atlas, "--json").stdout)
    assert json.loads(run("lookup", *words, "--atlas", atlas, "--json").stdout) == expected
    twice = run("lookup", *words, "beta=20", "--atlas", atlas)
    assert twice.exit_code == 2
    assert "beta: it is given twice. Give it once." in twice.stderr


def test_no_answer_says_what_to_do(atlas):
    wild = ("frequency=50 Hz", "amplitude=4 mm", "beta=25", "friction=0.3", "--atlas", atlas)
    result = run("lookup", *wild)
    assert result.exit_code == 1
    for words in ("no speed: out of range", "throw_number is 17.01", "add --simulate"):
        assert words in result.stdout
    result = run("lookup", *wild, "--simulate")
    assert result.exit_code == 0, result.output
    assert "by simulation" in result.stdout


def test_a_number_that_is_hardly_meant_is_asked_about(atlas):
    result = run(
        "lookup", "frequency=50", "amplitude=0.4", "beta=25", "friction=0.3", "--atlas", atlas
    )
    assert "0.4 mm" in result.stderr


def test_rows_and_documents(atlas, tmp_path):
    rows, speeds = tmp_path / "rows.csv", tmp_path / "speeds.csv"
    rows.write_text("amplitude [mm],friction\n0.4,0.3\n0.2,0.3\n4,0.3\n")
    shared = ("lookup", "frequency=50 Hz", "beta=25", "--atlas", atlas, "--rows", rows)
    result = run(*shared)
    assert result.exit_code == 1  # one row is out of range
    assert "out of range" in result.stdout
    assert "answered" in result.stdout
    result = run(*shared, "--json", "-o", speeds, "--simulate")
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout)
    assert told["values"]["lookup_status"][::2] == ["answered", "simulated"]
    assert told["values"]["conveying_velocity"][0] == pytest.approx(0.0437, rel=1e-2)
    assert len(speeds.read_text().splitlines()) == 4
    again = run(*shared, "-o", speeds)
    assert again.exit_code == 2
    assert "exists already" in again.output


def test_every_problem_is_told(atlas, tmp_path):
    result = run("lookup", "beta", "friction=1", "friction=2", "--atlas", tmp_path / "none.nc")
    assert result.exit_code == 2
    for words in ("beta: it has no value", "it is given twice", "vibrafeed atlas -o atlas.nc"):
        assert words in result.stderr
    result = run("lookup", *PART, "restitution=0.3", "--atlas", atlas)
    assert result.exit_code == 2
    assert "parts that do not rebound" in result.stderr
    taken = tmp_path / "taken.pdf"
    taken.write_text("")
    result = run("atlas", "-o", "atlas.csv", "--resolution", "fine", "--charts", taken)
    assert result.exit_code == 2
    for words in ("3 problems", "coarse or full", ".nc or .zarr", "taken.pdf exists already"):
        assert words in result.stderr
    result = run("atlas")
    assert "neither an atlas (-o) nor charts" in result.stderr


def test_a_file_that_is_no_atlas_is_refused(tmp_path):
    file = tmp_path / "other.nc"
    xarray.Dataset({"a": 1.0}).to_netcdf(file)
    result = run("lookup", *PART, "--atlas", file)
    assert result.exit_code == 2
    assert "not a result of vibrafeed" in result.stderr
