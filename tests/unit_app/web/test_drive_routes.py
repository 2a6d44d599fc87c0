"""Measured drives over HTTP: a recording as text, and never a file of the server."""

from __future__ import annotations

import numpy as np

import vibrafeed
from recordings import DRIVE, csv_of, signal_of
from vibrafeed.core.intake.section import MAX_ROWS_SENT

PATH = "/processes/simulate/execution"
TEXT = csv_of(signal_of(DRIVE))


def study(**drive):
    return {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "drive": {"along": "ax", "normal": "az", **drive},
        "parameters": {"friction": 0.3},
    }


def refused(client, content):
    reply = client.post(PATH, json=content)
    assert reply.status_code == 422, reply.text
    return reply.json()["errors"]


def test_a_recording_is_sent_as_text(client):
    reply = client.post(PATH, json=study(data=TEXT))
    assert reply.status_code == 200, reply.text
    expected = vibrafeed.simulate(study(data=TEXT))
    document = reply.json()
    assert document["variables"]["conveying_velocity"]["data"] == float(expected.conveying_velocity)
    assert document["attributes"]["drive"] == expected.attrs["drive"]
    assert TEXT[:200] not in reply.text


def test_a_reply_asks_about_unusual_numbers_and_refuses_contradictions(client):
    slow = study(data=TEXT.replace("time [s]", "number"), rate=2)
    warnings = client.post(PATH, json=slow).json()["attributes"]["warnings"]
    assert warnings.startswith("frequency = 0.05 Hz, fitted to data, is unusual; usual values are")
    signal = signal_of(DRIVE)
    hung = csv_of(signal._replace(values=signal.values - [[0.0], [9.81]]))
    (told,) = refused(client, study(data=hung))
    assert told["place"] == "drive.normal"
    assert "the channel points downwards" in told["message"]


def test_no_file_of_the_server_is_read(client, tmp_path):
    path = tmp_path / "recording.csv"
    path.write_text(TEXT)
    told = refused(client, study(file=str(path)))
    assert told == refused(client, study(file=str(tmp_path / "absent.csv")))  # nor is it looked for
    assert told == [
        {
            "place": "drive.file",
            "message": "the service cannot read the recording from your computer",
            "fix": "Give data = the text of the recording's CSV",
        }
    ]


def test_a_long_recording_is_refused_before_it_is_fitted(client):
    rows = np.zeros(MAX_ROWS_SENT + 1, dtype=int)
    (told,) = refused(client, study(data="ax,az\n" + "\n".join(f"{row},0" for row in rows), rate=1))
    assert told["place"] == "drive.data"
    assert told["message"] == "the recording has 20,001 rows, the limit over HTTP is 20,000"


def test_a_study_of_numbers_and_their_origin_is_taken_as_it_is(client):
    numbers = vibrafeed.study(study(data=TEXT)).content()
    document = client.post(PATH, json=numbers).json()
    assert document["attributes"]["drive"].startswith("fitted to data (SHA-256 ")
