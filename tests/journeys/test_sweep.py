"""A sweep to NetCDF and back: by the command line, through two other formats."""

import csv

import numpy as np
import xarray

STUDY = """
kind = "sweep"
scene = "rectangle-on-plane"
variant = "thesis"
outputs = ["acceleration_x", "throw_number"]

[parameters]
frequency = { start = "20 Hz", stop = "50 Hz", num = 7 }
amplitude = ["0.05 mm", "0.1 mm", "0.15 mm"]
beta = { start = "0 deg", stop = "40 deg", step = "1 deg" }
friction = 0.3
gravity = 9.81
"""


def test_a_sweep_to_netcdf_and_back(vibrafeed, tmp_path):
    (tmp_path / "study.toml").write_text(STUDY)
    assert "861 cells" in vibrafeed("run", "study.toml").stdout
    vibrafeed("export", "study.nc", "-o", "study.zarr")
    vibrafeed("export", "study.zarr", "-o", "again.nc")
    vibrafeed("export", "study.nc", "-o", "study.csv", "--units", "si")

    first = xarray.load_dataset(tmp_path / "study.nc", decode_times=False)
    again = xarray.load_dataset(tmp_path / "again.nc", decode_times=False)
    xarray.testing.assert_equal(first, again)
    assert first.attrs["study"] == again.attrs["study"]
    assert first.sizes == {"frequency": 7, "amplitude": 3, "beta": 41}

    # Equation (3.9) of the thesis with alpha = 0, on a horizontal plane.
    peak = first.amplitude * (2 * np.pi * first.frequency) ** 2
    beta = np.radians(first.beta)
    along = peak * (np.cos(beta) + 0.3 * np.sin(beta)) - 0.3 * 9.81
    throw = (peak * np.sin(beta) / 9.81).transpose(*first.throw_number.dims)
    np.testing.assert_allclose(first.throw_number, throw, rtol=1e-12)
    along = along.transpose(*first.acceleration_x.dims)
    np.testing.assert_allclose(first.acceleration_x, along, rtol=1e-12, atol=1e-12)

    rows = list(csv.DictReader((tmp_path / "study.csv").read_text().splitlines()))
    (column,) = (name for name in rows[0] if name.startswith("throw_number"))
    np.testing.assert_array_equal(
        [float(row[column]) for row in rows], first.throw_number.values.ravel()
    )
