"""`vibrafeed report`, as a user runs it."""

import re
from pathlib import Path

import xarray

from commands import run, saved
from vibrafeed.core import report as reports

STUDY = """
kind = "sweep"
title = "A small sweep"
scene = "rectangle-on-plane"
outputs = ["acceleration_x", "throw_number"]

[parameters]
frequency = { start = "20 Hz", stop = "120 Hz", num = 11 }
amplitude = "0.5 mm"
beta = 20
friction = 0.3
"""


def test_a_page_its_picture_and_a_dataset_are_written(monkeypatch):
    monkeypatch.setattr(reports, "LEAST_SECONDS", 0.0)
    saved(STUDY, "small.toml")
    told = run("report small.toml").output
    folder = Path("accuracy")  # beside the study
    page = (folder / "accuracy.md").read_text()
    assert "## A small sweep (small)" in page
    assert re.findall(r"!\[.*?\]\((.*?)\)", page) == ["accuracy-small.png"]
    names = {"accuracy.md", "accuracy-small.nc", "accuracy-small.png"}
    assert {path.name for path in folder.iterdir()} == names
    assert all(f"wrote {folder / name}" in told for name in names)
    assert (folder / "accuracy-small.png").read_bytes().startswith(b"\x89PNG")
    with xarray.open_dataset(folder / "accuracy-small.nc", engine="netcdf4") as dataset:
        assert "vibrafeed report" in dataset.attrs["history"]
