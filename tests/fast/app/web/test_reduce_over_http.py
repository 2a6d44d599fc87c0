"""Reductions over HTTP: at once where they are short, as a job where their cells take long."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import xarray
from fastapi.testclient import TestClient

from local_client import ended, local_client
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate

pytestmark = pytest.mark.service  # a server with workers of its own

PATH = "/processes/sweep/execution"
ASIDE = {"Prefer": "respond-async"}


def study(num: int) -> dict[str, Any]:
    return {
        "kind": "sweep",
        "scene": "rectangle-on-plane",
        "outputs": ["acceleration_x"],
        "parameters": {
            "frequency": [40, 50, 60],
            "amplitude": {"start": "0.1 mm", "stop": "1 mm", "num": num},
            "beta": {"start": 0, "stop": 45, "num": 46},
            "friction": 0.3,
        },
        "reduce": {
            "over": ["amplitude", "beta"],
            "statistics": ["max", "argmax", "mean"],
            "quantiles": [0.5],
        },
    }


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    settings = Settings(
        data_directory=tmp_path_factory.mktemp("data"), workers=1, max_cells=100, max_bytes=1000,
        block_seconds=0.1,
    )  # fmt: skip
    with local_client(create_app(settings), raise_server_exceptions=False) as client:
        yield client


def file_of(client: TestClient, reply: Any, folder: Path) -> Path:
    """Return the NetCDF file of the job that a reply tells of, once it is successful."""
    assert reply.status_code == 201, reply.text
    assert ended(client, reply.headers["location"])["status"] == "successful"
    links = client.get(f"{reply.headers['location']}/results").json()
    href = next(one["href"] for one in _links(links) if "netcdf" in one.get("type", ""))
    path = folder / "result.nc"
    path.write_bytes(client.get(href).content)
    return path


def test_a_short_one_is_replied_to_at_once(client: TestClient) -> None:
    reply = client.post(PATH, json=study(10))
    assert reply.status_code == 200
    found, want = reply.json(), tabulate(prepare_content(study(10)))
    assert found["cells"] == 3 * 10 * 46
    assert found["complete"]
    for name, variable in want.variables.items():
        assert found["variables"][name]["data"] == variable.values.tolist()
    assert found["coordinates"]["beta"]["reduced_range"] == [0, 45]


def test_a_job_of_more_cells_than_may_be_stored(client: TestClient, tmp_path) -> None:
    reply = client.post(PATH, json=study(10_000), headers=ASIDE)
    path = file_of(client, reply, tmp_path)
    want = tabulate(prepare_content(study(10_000))).to_xarray()
    with xarray.open_dataset(path) as found:
        for name in want.data_vars:
            assert found[name].dims == want[name].dims
            assert found[name].values.tobytes() == want[name].values.tobytes()


@pytest.mark.parametrize("aside", [False, True], ids=["at once", "as a job"])
def test_motion_is_reduced_too(client: TestClient, tmp_path, aside: bool) -> None:
    content = {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "outputs": ["conveying_velocity"],
        "parameters": {
            "frequency": [40, 50],
            "amplitude": {"start": "0.1 mm", "stop": "0.5 mm", "num": 20},
            "beta": {"start": 10, "stop": 45, "num": 10},
            "friction": 0.3,
        },
        "reduce": {
            "over": ["amplitude", "beta"],
            "statistics": ["max", "argmax", "mean"],
            "regimes": True,
            "shares": {"hops": ["regime == hopping"]},
        },
    }
    want = tabulate(prepare_content(content)).to_xarray()
    reply = client.post(
        "/processes/simulate/execution", json=content, headers=ASIDE if aside else {}
    )
    if not aside:
        assert reply.status_code == 200, reply.text
        for name in want.data_vars:
            assert reply.json()["variables"][name]["data"] == want[name].values.tolist()
        return
    path = file_of(client, reply, tmp_path)
    with xarray.open_dataset(path) as found:
        for name in want.data_vars:
            assert found[name].values.tobytes() == want[name].values.tobytes()


def test_too_much_to_store_is_refused(client: TestClient) -> None:
    content = study(200)
    content["reduce"]["over"] = ["beta"]
    reply = client.post(PATH, json=content)
    assert reply.status_code == 422
    assert "600 cells, the limit is 100" in reply.json()["detail"]


def test_a_reduction_is_no_sweep_to_read(client: TestClient) -> None:
    reply = client.post("/sweeps", json=study(10))
    assert reply.status_code == 422
    assert reply.json()["errors"][0]["place"] == "reduce"


def _links(document: Any) -> list[dict[str, Any]]:
    if isinstance(document, dict):
        own = [document] if "href" in document else []
        return own + [one for value in document.values() for one in _links(value)]
    if isinstance(document, list):
        return [one for value in document for one in _links(value)]
    return []
