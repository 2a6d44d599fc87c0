"""`run -o` by suffix, for every kind of study, and `export`."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas
import pytest
import scipy.io
import xarray
from typer.testing import CliRunner

from night import spread
from vibrafeed.app.cli import app
from vibrafeed.core.system import installing

FIXED = {"frequency": "50 Hz", "friction": 0.4}
STUDIES = {
    "sweep": {
        "scene": "rectangle-on-plane",
        "outputs": ["throw_number"],
        "parameters": {"frequency": 50, "amplitude": ["0.5 mm", "1 mm"], "beta": [10, 20, 30]},
    },
    "simulate": {
        "scene": "rectangle-on-plane",
        "outputs": ["conveying_velocity"],
        "parameters": {**FIXED, "amplitude": ["0.1 mm", "0.2 mm"], "beta": 30},
    },
    "optimise": {
        "scene": "rectangle-on-plane",
        "criterion": {"kind": "limit", "limit": "1 m/s^2"},
        "parameters": {"frequency": 60, "amplitude": "0.2 mm", "friction": [0.2, 0.3]},
    },
}
COURSE = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity"],
    "trajectory": 20,
    "parameters": {**FIXED, "amplitude": "0.2 mm", "beta": 30},
}
SUFFIXES = (".nc", ".zarr", ".csv", ".parquet", ".xlsx", ".mat")


def run(*arguments: object):
    return CliRunner().invoke(app, [str(one) for one in arguments])


def saved(folder: Path, content: dict) -> Path:
    path = folder / "study.json"
    path.write_text(json.dumps(content))
    return path


def read(path: Path, name: str) -> np.ndarray:
    """Return the values of a variable as a row, whatever the format."""
    match path.suffix:
        case ".nc" | ".zarr":
            engine = "netcdf4" if path.suffix == ".nc" else "zarr"
            with xarray.open_dataset(path, engine=engine) as found:
                return np.ravel(found[name].values)
        case ".mat":
            return np.ravel(scipy.io.loadmat(path, simplify_cells=True)["result"]["data"][name])
        case ".csv":
            table = pandas.read_csv(path)
        case ".xlsx":
            table = pandas.read_excel(path)
        case _:
            table = pandas.read_parquet(path)
    table.columns = [str(column).split(" [")[0] for column in table.columns]
    return table[name].to_numpy()


@pytest.mark.parametrize(
    ("kind", "name"),
    spread(
        [
            ("sweep", "throw_number"),
            ("simulate", "conveying_velocity"),
            ("optimise", "best_beta"),
            ("course", "position_along"),
        ],
        2,
    ),
)
def test_every_kind_goes_into_every_format(kind, name, tmp_path):
    content = COURSE if kind == "course" else {"kind": kind, **STUDIES[kind]}
    study = saved(tmp_path, content)
    for suffix in SUFFIXES[:3]:
        result = run("run", study, "-o", tmp_path / "new" / f"x{suffix}")
        assert result.exit_code == 0, result.output
    whole = tmp_path / "new" / "x.nc"
    expected = read(whole, name)
    assert expected.size > 1
    for suffix in SUFFIXES:
        result = run("export", whole, "-o", tmp_path / "exported" / f"x{suffix}")
        assert result.exit_code == 0, result.output
        np.testing.assert_array_equal(read(tmp_path / "exported" / f"x{suffix}", name), expected)
    for suffix in SUFFIXES[:3]:
        np.testing.assert_array_equal(read(tmp_path / "new" / f"x{suffix}", name), expected)
    assert (tmp_path / "new" / "x.csv.json").exists()
    assert not [path for path in (tmp_path / "new").iterdir() if path.name.startswith(".")]


@pytest.mark.parametrize("suffix", [".xlsx", ".mat", ".parquet"])
def test_a_sweep_is_written_at_once(suffix, tmp_path):
    study = saved(tmp_path, {"kind": "sweep", **STUDIES["sweep"]})
    assert run("run", study, "-o", tmp_path / f"x{suffix}").exit_code == 0
    assert read(tmp_path / f"x{suffix}", "throw_number").size == 6


@pytest.mark.parametrize(
    ("output", "told"),
    [
        ("x.txt", "'.txt': unknown format. End it in .nc, .zarr, .csv, .parquet, .xlsx"),
        ("x.parquett", "Did you mean .parquet?"),
        ("x.nc.gz", "or in / if it is a folder"),
    ],
)
def test_an_unknown_suffix_is_refused(output, told, tmp_path):
    study = saved(tmp_path, {"kind": "sweep", **STUDIES["sweep"]})
    for command in (("run", study), ("export", study)):
        result = run(*command, "-o", tmp_path / output)
        assert result.exit_code == 2
        assert told in " ".join(result.output.split())
    assert [path.name for path in tmp_path.iterdir()] == ["study.json"]


@pytest.mark.parametrize("output", ["folder", "folder.v2/", "there.csv"])
def test_what_is_a_folder(output, tmp_path):
    (tmp_path / "there.csv").mkdir()
    study = saved(tmp_path, {"kind": "sweep", **STUDIES["sweep"]})
    assert run("run", study, "-o", f"{tmp_path}/{output}").exit_code == 0
    assert (tmp_path / output / "study.nc").is_file()


def test_one_file_is_of_one_study(tmp_path):
    study = saved(tmp_path, {"kind": "sweep", **STUDIES["sweep"]})
    other = study.rename(tmp_path / "other.json")
    saved(tmp_path, {"kind": "sweep", **STUDIES["sweep"]})
    result = run("run", study, other, "-o", tmp_path / "x.csv")
    assert result.exit_code == 2
    assert "is for one study. Give a folder." in result.output


def test_what_a_format_cannot_hold_is_told_before_it_is_computed(tmp_path, monkeypatch):
    monkeypatch.setattr("vibrafeed.core.kinds.tabulate", None)
    content = {"kind": "sweep", **STUDIES["sweep"]}
    span = {"start": 10, "stop": 60, "num": 600_000}
    content["parameters"] = {**STUDIES["sweep"]["parameters"], "frequency": span}
    study = saved(tmp_path, content)
    result = run("run", study, "-o", tmp_path / "x.xlsx")
    assert result.exit_code == 2
    assert "3,600,000 rows in a sheet of Excel, the limit is 1,048,575" in result.output
    monkeypatch.setattr("vibrafeed.core.dataset.matlab.MAX_BYTES", 1000)
    result = run("run", study, "-o", tmp_path / "x.mat")
    assert result.exit_code == 2
    assert "bytes in a MAT file" in result.output


def test_a_package_that_is_missing_is_told_before_anything_is_computed(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "xlsxwriter", None)
    study = saved(tmp_path, {"kind": "sweep", **STUDIES["sweep"]})
    result = run("run", study, "-o", tmp_path / "x.xlsx")
    assert result.exit_code == 2
    assert installing("xlsxwriter") in result.output
    assert "Or give the output a name that ends in .nc or .csv" in result.output


def test_csv_for_excel_in_europe(tmp_path):
    study = saved(tmp_path, {"kind": "sweep", **STUDIES["sweep"]})
    plain = tmp_path / "plain.csv"
    assert run("run", study, "-o", plain).exit_code == 0
    run("run", study, "-o", tmp_path / "x.nc")
    for command in (("run", study), ("export", tmp_path / "x.nc")):
        result = run(*command, "-o", tmp_path / "x.csv", "--csv-style", "excel", "--force")
        assert result.exit_code == 0, result.output
        found = pandas.read_csv(tmp_path / "x.csv", sep=";", decimal=",")
        pandas.testing.assert_frame_equal(found, pandas.read_csv(plain), check_exact=True)
        result = run(*command, "-o", tmp_path / "y.nc", "--csv-style", "excel")
        assert result.exit_code == 2
        assert "--csv-style: it is for CSV only. Leave it out" in result.output
        assert not (tmp_path / "y.nc").exists()


def test_zarr_of_version_2(tmp_path):
    study = saved(tmp_path, {"kind": "sweep", **STUDIES["sweep"]})
    run("run", study, "-o", tmp_path / "x.nc")
    for name in ("x.zarr", "y.zarr"):
        command = ("export", tmp_path / "x.nc", "-o", tmp_path / name, "--zarr-version", 2)
        assert run(*command).exit_code == 0
    with (
        xarray.open_dataset(tmp_path / "x.nc") as whole,
        xarray.open_zarr(tmp_path / "x.zarr", zarr_format=2, mask_and_scale=False) as found,
    ):
        xarray.testing.assert_equal(found.load(), whole.load())
        assert found.throw_number.long_name == whole.throw_number.long_name
        assert found.attrs["study"] == whole.attrs["study"]
    run("export", tmp_path / "x.zarr", "-o", tmp_path / "back.nc")
    with (
        xarray.open_dataset(tmp_path / "x.nc") as whole,
        xarray.open_dataset(tmp_path / "back.nc") as back,
    ):
        xarray.testing.assert_equal(back.load(), whole.load())
    result = run("export", tmp_path / "x.nc", "-o", tmp_path / "x.csv", "--zarr-version", 2)
    assert result.exit_code == 2
    assert "--zarr-version: it is for Zarr only" in result.output


def test_export_refuses_what_is_no_result(tmp_path):
    (tmp_path / "x.csv").write_text("a\n1\n")
    result = run("export", tmp_path / "x.csv", "-o", tmp_path / "y.xlsx")
    assert result.exit_code == 2
    assert (
        "the file is not a result of vibrafeed. Give a NetCDF file or a Zarr group" in result.output
    )
    result = run("export", tmp_path / "absent.nc", "-o", tmp_path / "y.xlsx")
    assert result.exit_code == 1
    assert "cannot be read: No such file" in result.output


def test_export_keeps_the_history_and_replaces_no_group(tmp_path):
    study = saved(tmp_path, {"kind": "sweep", **STUDIES["sweep"]})
    run("run", study, "-o", tmp_path / "x.nc")
    run("export", tmp_path / "x.nc", "-o", tmp_path / "x.zarr")
    with xarray.open_zarr(tmp_path / "x.zarr") as found:
        last, first = found.attrs["history"].splitlines()
    assert last.endswith("vibrafeed export x.nc")
    assert first.endswith("vibrafeed run study.json")
    result = run("export", tmp_path / "x.nc", "-o", tmp_path / "x.zarr")
    assert result.exit_code == 2
    assert "exists already. Remove the existing output, or give another name." in result.output


def test_an_export_replaces_nothing_unasked(tmp_path):
    study = saved(tmp_path, {"kind": "sweep", **STUDIES["sweep"]})
    run("run", study, "-o", tmp_path / "x.nc")
    (tmp_path / "y.csv").write_text("mine")
    refused = run("export", tmp_path / "x.nc", "-o", tmp_path / "y.csv")
    assert refused.exit_code == 2
    assert "y.csv exists already. Add --force to replace it" in refused.output
    assert (tmp_path / "y.csv").read_text() == "mine"
    assert run("export", tmp_path / "x.nc", "-o", tmp_path / "y.csv", "--force").exit_code == 0


def test_an_export_for_people_is_in_their_units(tmp_path):
    result = tmp_path / "motion.nc"
    content = {"kind": "simulate", **STUDIES["simulate"]}
    assert run("run", saved(tmp_path, content), "-o", result).exit_code == 0
    with xarray.open_dataset(result, decode_times=False) as dataset:
        speeds = dataset.conveying_velocity.values
    for units, factor, heading in (("trade", 1e3, "mm/s"), ("m/min, mm", 60, "m/min")):
        table = tmp_path / "shown.csv"
        assert run("export", result, "-o", table, "--units", units, "--force").exit_code == 0
        shown = pandas.read_csv(table)
        found = shown[f"conveying_velocity [{heading}]"].to_numpy()
        np.testing.assert_allclose(found, factor * speeds, rtol=1e-15)
        np.testing.assert_allclose(shown["amplitude [mm]"], [0.1, 0.2], rtol=1e-15)
    refused = run("export", result, "-o", tmp_path / "x.nc", "--units", "trade")
    assert refused.exit_code == 2
    assert ".nc files keep the units of the result" in refused.output
    assert not (tmp_path / "x.nc").exists()
