"""From the recording of an accelerometer to the speed of a part."""

import numpy as np
import xarray

from recordings import csv_of, signal_of

FREQUENCY, AMPLITUDE, BETA = 50.0, 0.3e-3, 30.0
LINE = {
    "along": ((AMPLITUDE * np.cos(np.radians(BETA)), 0.4),),
    "normal": ((AMPLITUDE * np.sin(np.radians(BETA)), 0.4),),
}
MEASURED = """
kind = "simulate"
scene = "rectangle-on-plane"

[drive]
file = "recording.csv"
along = "ax"
normal = "az"

[parameters]
friction = 0.4
"""
KNOWN = """
kind = "simulate"
scene = "rectangle-on-plane"

[parameters]
frequency = "50 Hz"
amplitude = "0.3 mm"
beta = "30 deg"
friction = 0.4
"""


def test_a_recording_to_a_speed(vibrafeed, tmp_path):
    """A recording of a known sine gives that sine, and the speed of a part under it."""
    (tmp_path / "recording.csv").write_text(csv_of(signal_of(LINE, frequency=FREQUENCY)))
    said = vibrafeed("drive", "recording.csv", "--along", "ax", "--normal", "az").stdout
    assert "50" in said

    speeds = {}
    for name, study in {"measured": MEASURED, "known": KNOWN}.items():
        (tmp_path / f"{name}.toml").write_text(study)
        vibrafeed("run", f"{name}.toml")
        found = xarray.load_dataset(tmp_path / f"{name}.nc", decode_times=False)
        speeds[name] = float(found.conveying_velocity)
    # A recording without noise leaves the error of the clock that was fitted.
    np.testing.assert_allclose(speeds["measured"], speeds["known"], rtol=1e-6)
    assert speeds["known"] > 0.02  # m/s
