"""Every scene by file, by request and by call: the same numbers three times."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from local_client import local_client
from vibrafeed.app.cli import app
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import KINDS, run_study
from vibrafeed.core.motion import SYSTEMS
from vibrafeed.core.scenes import SCENES

CONFIGS = Path(__file__).parents[2] / "configs"
EXAMPLES: dict[str, dict[str, Path]] = {kind: {} for kind in KINDS}
for path in sorted(CONFIGS.rglob("*.toml"), reverse=True):
    found = tomllib.loads(path.read_text())
    EXAMPLES[found["kind"]].setdefault(found["scene"], path)


def test_every_scene_has_an_example():
    assert set(EXAMPLES["sweep"]) == set(SCENES)
    assert set(EXAMPLES["simulate"]) >= set(SYSTEMS) - {"cylinder-on-plane"}


@pytest.mark.parametrize("scene", EXAMPLES["simulate"])
def test_motion_by_file_by_request_and_by_call(scene, tmp_path):
    path = EXAMPLES["simulate"][scene]
    content = tomllib.loads(path.read_text())
    called = run_study(parse_study(content))
    ran = CliRunner().invoke(app, ["run", str(path), "-o", str(tmp_path / "by_file.nc")])
    assert ran.exit_code == 0, ran.output
    read = xarray.load_dataset(tmp_path / "by_file.nc", engine="netcdf4", decode_times=False)
    xarray.testing.assert_equal(read, called)
    patient = Settings(
        data_directory=tmp_path / "data", max_synchronous_seconds=600, max_execution_seconds=600
    )
    with local_client(create_app(patient)) as client:
        reply = client.post("/processes/simulate/execution", json=content)
    assert reply.status_code == 200, reply.text
    for name, variable in reply.json()["variables"].items():
        np.testing.assert_array_equal(np.array(variable["data"], dtype=float), called[name].values)


@pytest.mark.parametrize("scene", SCENES)
def test_a_scene_by_file_by_request_and_by_call(scene, tmp_path):
    path = EXAMPLES["sweep"][scene]
    content = tomllib.loads(path.read_text())
    called = run_study(parse_study(content))
    ran = CliRunner().invoke(app, ["run", str(path), "-o", str(tmp_path / "by_file.nc")])
    assert ran.exit_code == 0, ran.output
    with local_client(create_app(Settings(data_directory=tmp_path / "data"))) as client:
        posted = client.post("/sweeps", json=content)
        assert posted.status_code == 201, posted.text
        download = client.get(f"/sweeps/{posted.json()['id']}/netcdf")
    (tmp_path / "by_request.nc").write_bytes(download.content)
    for name in ("by_file.nc", "by_request.nc"):
        read = xarray.load_dataset(tmp_path / name, engine="netcdf4")
        xarray.testing.assert_equal(read, called)
    assert scene in CliRunner().invoke(app, ["scenes"]).output
