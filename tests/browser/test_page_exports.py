"""What the page gives away is carried out as it is, with a service without keys and with keys."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import openpyxl
import pytest
import xarray
from PIL import Image
from playwright.sync_api import Page

from access import KEY, lock
from looking import settled, taken_away
from night import spread
from services import ROOT, Service, services
from tools import tool

PLANE = "kind=simulate&scene=rectangle-on-plane&output=conveying_velocity&p.friction=0.4"
AXES = "x=amplitude:0.0001:0.0007&y=beta:5:60"
SNAPSHOT = "kind=sweep&scene=rectangle-on-plane&choice=physical&output=acceleration_x"
VIEWS = {
    "lines": f"question=speed&{PLANE}&x=amplitude:0.0001:0.0007&y=&p.beta=30",
    "map": f"question=speed&{PLANE}&{AXES}",
    "closed forms": f"question=all&{SNAPSHOT}&{AXES}&p.friction=0.4",
    "hops": "question=hop",
    "ellipse": "question=waves",
    "springs": "question=springs",
    "rows": "question=rows&x=amplitude:0.0001:0.0005&y=&p.beta=20",
    "which way up": "question=resting",
    "line": "question=orienting",
    "thesis": "question=thesis",
}


# By day with keys: what asks no service, and so has none, is run by other tests as well.
@pytest.fixture(
    scope="module", params=["with keys", pytest.param("without keys", marks=pytest.mark.night)]
)
def service(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Service]:
    with services(tmp_path_factory) as start:
        found = start(workers=1)
        found.has_keys = request.param == "with keys"  # type: ignore[attr-defined]
        if found.has_keys:  # type: ignore[attr-defined]
            lock(found.address, found.folder / "data")
        yield found


@pytest.fixture
def saved(page: Page, tmp_path: Path) -> Callable[[str], Path]:
    def take(name: str) -> Path:
        download = taken_away(page, name)
        target = tmp_path / download.suggested_filename
        download.save_as(target)
        return target

    return take


def carried_out(command: list[str], folder: Path, **environment: str) -> str:
    done = subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("name", spread(VIEWS, 1))
def test_ten_views_are_taken_away_in_every_form(
    page: Page, service: Service, saved: Callable[[str], Path], tmp_path: Path, name: str
) -> None:
    has_keys = service.has_keys  # type: ignore[attr-defined]
    page.goto(f"{service.address}/#{VIEWS[name]}")
    if has_keys:
        page.locator("#key").fill(KEY)
        page.keyboard.press("Enter")
    settled(page)
    output = page.locator("#choose-output").input_value()

    with xarray.open_dataset(saved("NetCDF")) as file:
        dataset = file.load()
    values = dataset[output].values
    assert np.isfinite(values).any()
    rows = list(csv.reader(saved("Table (CSV)").read_text().splitlines()))
    at = next(k for k, row in enumerate(rows) if output in row or output in " ".join(row))
    assert len(rows) - at > dataset[output].size
    book = openpyxl.load_workbook(saved("Table (XLSX)"), read_only=True)
    longest = max(sum(1 for _ in sheet.rows) for sheet in book.worksheets)
    assert longest > dataset[output].size
    drawing = ElementTree.fromstring(saved("Picture (SVG)").read_text())
    assert page.url in " ".join(drawing.itertext())
    with Image.open(saved("Picture (PNG)")) as picture:
        assert picture.width == 2 * float(drawing.get("width") or 0)
        assert len(picture.convert("RGB").getcolors(picture.width * picture.height) or ()) > 20

    command = saved("Code for curl").read_text()
    assert (("$VIBRAFEED_KEY" in command), KEY in command) == (has_keys, False)
    told = carried_out([tool("sh"), "-c", command], tmp_path, VIBRAFEED_KEY=KEY)
    reply = json.loads(told)
    assert "jobID" in reply or output in reply["variables"], told[:500]

    study, program = saved("Study (TOML)"), saved("Code in Python")
    if has_keys:  # neither asks a service
        return
    run = "from vibrafeed.app.cli import main; main()"
    carried_out([sys.executable, "-c", run, "run", str(study), "-o", "result.nc"], tmp_path)
    with xarray.open_dataset(tmp_path / "result.nc") as again:
        np.testing.assert_allclose(again[output].values, values, rtol=1e-9, atol=1e-12)
    assert output in carried_out([sys.executable, str(program)], tmp_path)
