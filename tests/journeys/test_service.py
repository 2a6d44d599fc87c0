"""Serve, post, poll, download: a design tool asks a service by REST, and a job survives a kill."""

import json
import urllib.request

import numpy as np
import pytest
import xarray

from services import QUICK, Server
from waiting import PATIENCE

STUDY = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity", "regime"],
    "parameters": {
        "frequency": "50 Hz",
        "amplitude": {"start": "0.1 mm", "stop": "0.5 mm", "num": 9},
        "beta": {"start": 10, "stop": 50, "num": 9},
        "friction": 0.4,
    },
}


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    running = Server(tmp_path_factory.mktemp("service"), workers=1, **QUICK)
    running.start()
    yield running
    running.stop()


def downloaded(server, number, file):
    job = server.finished(number)
    assert job["status"] == "successful", job
    file.write_bytes(server.ask(f"/jobs/{number}/results/dataset"))
    return xarray.load_dataset(file, decode_times=False)


def computed_here(study, vibrafeed, folder):
    (folder / "study.json").write_text(json.dumps(study))
    vibrafeed("run", "study.json", "-o", "here.nc")
    return xarray.load_dataset(folder / "here.nc", decode_times=False)


def test_post_poll_and_download(server, vibrafeed, tmp_path):
    with urllib.request.urlopen(f"{server.address}/scenes", timeout=PATIENCE) as reply:
        assert "rectangle-on-plane" in reply.read().decode()
    found = downloaded(server, server.post_to_a_busy_one(STUDY), tmp_path / "there.nc")
    here = computed_here(STUDY, vibrafeed, tmp_path)
    xarray.testing.assert_equal(found, here)
    speed = found.conveying_velocity.values
    assert np.isfinite(speed).all()
    assert speed.max() > 0.1  # m/s


def test_a_job_survives_a_kill(server, vibrafeed, tmp_path):
    study = {**STUDY, "parameters": {**STUDY["parameters"], "gamma": [-2, 0, 2, 4]}}
    study["parameters"]["amplitude"] = {"start": "0.1 mm", "stop": "0.5 mm", "num": 41}
    study["parameters"]["beta"] = {"start": 10, "stop": 50, "num": 41}
    number = server.post_to_a_busy_one(study)
    server.kill()
    server.start()
    found = downloaded(server, number, tmp_path / "there.nc")
    xarray.testing.assert_equal(found, computed_here(study, vibrafeed, tmp_path))
