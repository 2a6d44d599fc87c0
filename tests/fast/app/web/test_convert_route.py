"""POST /convert: a study in other forms, as the command writes it."""

from __future__ import annotations

import json
import tomllib

import pytest

from local_client import local_client
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.intake.forms import FORMS, REQUESTS, to_toml

STUDY = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "parameters": {"frequency": "50 Hz", "amplitude": "0.3 mm", "beta": 20, "friction": 0.3},
}


@pytest.fixture
def client(tmp_path):
    return local_client(create_app(Settings(data_directory=tmp_path)))


def test_each_form_is_that_of_the_command(client):
    for form, write in FORMS.items():
        reply = client.post(f"/convert?to={form}", json=STUDY)
        assert reply.status_code == 200
        assert reply.headers["content-type"] == "text/plain; charset=utf-8"
        if form not in REQUESTS:
            assert reply.text == write(STUDY)
    assert tomllib.loads(client.post("/convert?to=toml", json=STUDY).text) == STUDY
    # The line asks the service that wrote it.
    line = client.post("/convert?to=curl", json=STUDY).text
    address = f"{str(client.base_url).rstrip('/')}/processes/simulate/execution"
    assert line.endswith(f" {address}\n")
    assert client.post("/convert?to=powershell", json=STUDY).text.endswith(f" -Uri '{address}'\n")


def test_what_is_wrong_is_told_as_where_it_is_carried_out(client):
    wrong = {**STUDY, "parameters": {**STUDY["parameters"], "friction": -1}}
    reply = client.post("/convert?to=toml", json=wrong)
    assert reply.status_code == 422
    asked = client.post("/processes/simulate/execution", json=wrong).json()
    assert reply.json()["errors"] == asked["errors"]
    assert client.post("/convert?to=word", json=STUDY).status_code == 422
    assert client.post("/convert?to=toml", content=json.dumps([1])).status_code == 422
    # A file of the service's machine is nobody's to name.
    named = {**STUDY, "drive": {"file": "/etc/hostname"}}
    assert client.post("/convert?to=curl", json=named).status_code == 422


def test_a_long_array_is_read_and_never_put_together_value_by_value(monkeypatch):
    """Value by value it takes the square of its length: 9,000 values took 3 s."""
    odd = ['a "quoted" word', "two\nlines", "\\", "20 Hz", 0.1, 1e-300, -7, True]
    content = {
        "kind": "sweep", "outputs": ["acceleration_x"],
        "parameters": {"beta": [round(0.004 * n, 6) for n in range(9_000)], "friction": odd},
        "observations": {"parameters": {"beta": odd}, "values": [[1.5, 2.5], [3.5]], "empty": []},
    }  # fmt: skip

    def refused(*_: object) -> None:
        raise AssertionError("an array was put together")

    with monkeypatch.context() as patch:
        patch.setattr("tomlkit.items.Array.append", refused)
        patch.setattr("tomlkit.items.Array.insert", refused)
        flat = {**content, "observations": {}}
        assert tomllib.loads(to_toml(flat)) == flat
    assert tomllib.loads(to_toml(content)) == content
