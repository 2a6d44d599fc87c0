"""What the page gives away says what it is, and is carried out as it is."""

from __future__ import annotations

import csv
import io
import json
import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import openpyxl
import pytest
import xarray
from PIL import Image
from playwright.sync_api import Page

from looking import opened, taken_away
from night import spread
from services import ROOT
from tools import tool

PLANE = "kind=simulate&scene=rectangle-on-plane&output=conveying_velocity&p.friction=0.4"
AXES = "x=amplitude:0.0001:0.0007&y=beta:5:60"
SNAPSHOT = "kind=sweep&scene=rectangle-on-plane&choice=physical&output=acceleration_x"
VIEWS = {
    "map": f"question=speed&{PLANE}&{AXES}",
    "closed forms": f"question=all&{SNAPSHOT}&{AXES}&p.friction=0.4",
    "hops": "question=hop",
    "ellipse": "question=waves",
    "springs": "question=springs",
    "lines": f"question=speed&{PLANE}&x=amplitude:0.0001:0.0007&y=&p.beta=30",
    "rows": "question=rows&x=amplitude:0.0001:0.0005&y=&p.beta=20",
    "which way up": "question=resting",
    "line": "question=orienting",
    "thesis": "question=thesis",
}


def carried_out(folder: Path, *command: str) -> str:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("name", spread(VIEWS, 2))
def test_what_is_taken_away_is_carried_out_in_every_form(
    page: Page, address: str, tmp_path: Path, name: str
) -> None:
    opened(page, f"{address}/#{VIEWS[name]}")
    output = page.locator("#choose-output").input_value()

    result = tmp_path / "taken.nc"
    result.write_bytes(taken_away(page, "NetCDF"))
    dataset = xarray.load_dataset(result)
    values = dataset[output].values
    assert np.isfinite(values).any()
    rows = list(csv.reader(taken_away(page, "Table (CSV)").decode().splitlines()))
    at = next(k for k, row in enumerate(rows) if output in " ".join(row))
    assert len(rows) - at > values.size
    book = openpyxl.load_workbook(io.BytesIO(taken_away(page, "Table (XLSX)")), read_only=True)
    longest = max(sum(1 for _ in sheet.rows) for sheet in book.worksheets)
    assert longest > values.size

    drawing = ElementTree.fromstring(taken_away(page, "Picture (SVG)").decode())
    words = " ".join(drawing.itertext())
    assert page.url in words  # the view that it belongs to
    assert page.locator("#headline").inner_text() in words
    if "p.friction" in VIEWS[name]:
        assert "friction 0.4" in words.lower()
    if "y=beta" in VIEWS[name]:
        (bar,) = (one for one in drawing.iter() if one.get("class") == "bar")
        assert any(one.get("class") == "tick" for one in bar.iter())
    with Image.open(io.BytesIO(taken_away(page, "Picture (PNG)"))) as picture:
        assert picture.width == 2 * float(drawing.get("width") or 0)
        assert len(picture.convert("RGB").getcolors(picture.width * picture.height) or ()) > 20

    command = taken_away(page, "Code for curl").decode()
    told = carried_out(tmp_path, tool("sh"), "-c", command)
    reply = json.loads(told)
    assert "jobID" in reply or output in reply["variables"], told[:500]
    (tmp_path / "study.toml").write_bytes(taken_away(page, "Study (TOML)"))
    run = "from vibrafeed.app.cli import main; main()"
    carried_out(tmp_path, sys.executable, "-c", run, "run", "study.toml", "-o", "result.nc")
    again = xarray.load_dataset(tmp_path / "result.nc")
    np.testing.assert_allclose(again[output].values, values, rtol=1e-9, atol=1e-12)
    (tmp_path / "program.py").write_bytes(taken_away(page, "Code in Python"))
    assert output in carried_out(tmp_path, sys.executable, "program.py")
