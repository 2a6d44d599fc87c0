"""`run -o` by suffix, for every kind of study, and `export`."""

from pathlib import Path

import numpy as np
import pandas
import pytest
import scipy.io
import xarray

from commands import run, saved

FIXED = {"frequency": "50 Hz", "friction": 0.4}
SWEEP = {
    "kind": "sweep",
    "scene": "rectangle-on-plane",
    "outputs": ["throw_number"],
    "parameters": {"frequency": 50, "amplitude": ["0.5 mm", "1 mm"], "beta": [10, 20, 30]},
}
MOTION = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity"],
    "parameters": {**FIXED, "amplitude": ["0.1 mm", "0.2 mm"], "beta": 30},
}
OPTIMA = {
    "kind": "optimise",
    "scene": "rectangle-on-plane",
    "criterion": {"kind": "limit", "limit": "1 m/s^2"},
    "parameters": {"frequency": 60, "amplitude": "0.2 mm", "friction": [0.2, 0.3]},
}
COURSE = {
    **MOTION,
    "trajectory": 20,
    "parameters": {**FIXED, "amplitude": "0.2 mm", "beta": 30},
}


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
    ("content", "name", "suffixes"),
    [
        (SWEEP, "throw_number", (".nc", ".zarr", ".csv", ".parquet", ".xlsx", ".mat")),
        (MOTION, "conveying_velocity", (".nc", ".xlsx")),
        (OPTIMA, "best_beta", (".csv", ".mat")),
        (COURSE, "position_along", (".zarr", ".parquet")),
    ],
    ids=["sweep", "simulate", "optimise", "course"],
)
def test_kinds_go_into_formats(content, name, suffixes, here):
    saved(content)
    run("run study.json")
    expected = read(here / "study.nc", name)
    assert expected.size > 1
    for suffix in suffixes:
        run(f"run study.json -o new/x{suffix}")
        run(f"export study.nc -o exported/x{suffix}")
    for path in here.glob("*/x.*"):
        if path.name != "x.csv.json":
            np.testing.assert_array_equal(read(path, name), expected, err_msg=path.name)
    assert (here / "exported" / "x.csv.json").exists() == (".csv" in suffixes)
    assert not [*here.rglob(".*")]


def test_csv_for_excel_in_europe():
    saved(SWEEP)
    run("run study.json")
    run("run study.json -o plain.csv")
    for command in ("run study.json", "export study.nc"):
        run(f"{command} -o x.csv --csv-style excel --force")
        found = pandas.read_csv("x.csv", sep=";", decimal=",")
        pandas.testing.assert_frame_equal(found, pandas.read_csv("plain.csv"), check_exact=True)


def test_zarr_of_version_2_and_its_history():
    saved(SWEEP)
    run("run study.json")
    run("export study.nc -o x.zarr --zarr-version 2")
    run("export x.zarr -o back.nc")
    whole, back = xarray.load_dataset("study.nc"), xarray.load_dataset("back.nc")
    with xarray.open_zarr("x.zarr", zarr_format=2, mask_and_scale=False) as found:
        xarray.testing.assert_equal(found.load(), whole)
        assert found.throw_number.long_name == whole.throw_number.long_name
        assert found.attrs["study"] == whole.attrs["study"]
    xarray.testing.assert_equal(back, whole)
    last, before, first = back.attrs["history"].splitlines()
    assert last.endswith("vibrafeed export x.zarr")
    assert before.endswith("vibrafeed export study.nc")
    assert first.endswith("vibrafeed run study.json")


def test_an_export_for_people_is_in_their_units():
    saved(MOTION)
    run("run study.json")
    with xarray.open_dataset("study.nc", decode_times=False) as dataset:
        speeds = dataset.conveying_velocity.values
    for units, factor, heading in (("trade", 1e3, "mm/s"), ("'m/min, mm'", 60, "m/min")):
        run(f"export study.nc -o shown.csv --units {units} --force")
        shown = pandas.read_csv("shown.csv")
        found = shown[f"conveying_velocity [{heading}]"].to_numpy()
        np.testing.assert_allclose(found, factor * speeds, rtol=1e-15)
        np.testing.assert_allclose(shown["amplitude [mm]"], [0.1, 0.2], rtol=1e-15)
