"""Twenty motions of parts by the events and by the witness, which shares no solver with them."""

import numpy as np
import xarray

STUDY = """
kind = "simulate"
scene = "rectangle-on-plane"
method = "{method}"
outputs = ["conveying_velocity", "conveying_velocity_error", "flight_fraction", "stick_fraction"]

[parameters]
frequency = "50 Hz"
amplitude = ["0.1 mm", "0.2 mm", "0.3 mm", "0.4 mm", "0.5 mm"]
beta = ["15 deg", "25 deg", "35 deg", "45 deg"]
gamma = "2 deg"
friction_static = 0.35
friction_kinetic = 0.3
"""


def test_events_agree_with_the_witness(vibrafeed, tmp_path):
    found = {}
    for method in ("events", "reference"):
        (tmp_path / f"{method}.toml").write_text(STUDY.format(method=method))
        vibrafeed("run", f"{method}.toml")
        found[method] = xarray.load_dataset(tmp_path / f"{method}.nc", decode_times=False)
    events, witness = found["events"], found["reference"]
    assert events.conveying_velocity.size == 20
    difference = np.abs(events.conveying_velocity - witness.conveying_velocity)
    allowed = events.conveying_velocity_error + witness.conveying_velocity_error
    assert (difference <= allowed).all()
    assert float(allowed.max()) < 1e-12  # m/s: the errors that are stated are small, too
    for fraction in ("flight_fraction", "stick_fraction"):
        np.testing.assert_allclose(events[fraction], witness[fraction], atol=1e-12)
        assert 0 < (events[fraction] > 0).mean() < 1
