"""Every scene by file, by request and by call: the same numbers three times."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
import xarray
from fastapi.testclient import TestClient
from typer.testing import CliRunner

from app.cli import app
from app.main import create_app
from app.settings import Settings
from core.scenes import SCENES
from core.study import parse_study
from core.sweep import sweep

CONFIGS = Path(__file__).parents[2] / "configs"
EXAMPLES: dict[str, Path] = {}
for path in sorted(CONFIGS.rglob("*.toml"), reverse=True):
    EXAMPLES.setdefault(tomllib.loads(path.read_text())["scene"], path)


def test_every_scene_has_an_example():
    assert set(EXAMPLES) == set(SCENES)


@pytest.mark.parametrize("scene", SCENES)
def test_a_scene_by_file_by_request_and_by_call(scene, tmp_path):
    path = EXAMPLES[scene]
    content = tomllib.loads(path.read_text())
    called = sweep(parse_study(content))
    ran = CliRunner().invoke(app, ["run", str(path), "-o", str(tmp_path / "by_file.nc")])
    assert ran.exit_code == 0, ran.output
    with TestClient(create_app(Settings(data_directory=tmp_path / "data"))) as client:
        posted = client.post("/sweeps", json=content)
        assert posted.status_code == 201, posted.text
        download = client.get(f"/sweeps/{posted.json()['id']}/netcdf")
    (tmp_path / "by_request.nc").write_bytes(download.content)
    for name in ("by_file.nc", "by_request.nc"):
        read = xarray.load_dataset(tmp_path / name, engine="netcdf4")
        xarray.testing.assert_equal(read, called)
    assert scene in CliRunner().invoke(app, ["scenes"]).output
