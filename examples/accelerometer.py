"""Makes examples/accelerometer.csv: an accelerometer on the track of a feeder, as recorders write.

No feeder stood for it: the drive is known exactly, so that a fit can be judged by it. A drive of
50 Hz with a second and a third harmonic; a sensor of three axes in line with a track that climbs
by 3 degrees, 8 g either way in 12 bits; its noise, its warming up, and hum of a fan at 23.7 Hz;
one second at 5 kHz by a clock that is 0.3 % slow.

    python examples/accelerometer.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

FREQUENCY = 50.0  # Hz
CLOCK = 0.003  # share of a second that the clock fails to count
RATE, COUNT = 5000, 5000
# Amplitudes [mm] and phases [degrees] of the orders 1, 2, 3.
DRIVE = {
    "along": ((0.200, 0.0), (0.012, 40.0), (0.0030, -75.0)),
    "across": ((0.006, 110.0), (0.001, -20.0), (0.0, 0.0)),
    "normal": ((0.090, 25.0), (0.010, -160.0), (0.0040, 95.0)),
}
CLIMB = np.radians(3.0)
GRAVITY = 9.80665  # m s-2
NOISE = 0.4  # m s-2 rms
WARMING = 0.15  # m s-2 over the recording
FAN = 23.7, 0.15  # Hz, m s-2
STEP = 16.0 / 2**12  # g
START = 1.7e-3  # s, of the first sample: a recorder starts anywhere
OFFSET = {"along": GRAVITY * np.sin(CLIMB), "across": 0.0, "normal": GRAVITY * np.cos(CLIMB)}

HEADER = """\
# Accelerometer on the track of a feeder; made by examples/accelerometer.py, not measured.
# True drive: 50 Hz; along 0.200, 0.012, 0.003 mm at 0, 40, -75 degrees; across 0.006, 0.001 mm
# at 110, -20 degrees; normal 0.090, 0.010, 0.004 mm at 25, -160, 95 degrees. The track climbs by
# 3 degrees. Sensor in line with it: 12 bits over 8 g either way. The clock is 0.3 % slow.
"""


def main(target: Path) -> None:
    """Write the recording."""
    rng = np.random.default_rng(20261122)
    shown = np.arange(COUNT) / RATE
    times = shown * (1.0 + CLOCK)
    columns = []
    for axis, orders in DRIVE.items():
        values = OFFSET[axis] + WARMING * (1.0 - np.exp(-times / 0.6))
        for order, (amplitude, phase) in enumerate(orders, start=1):
            turning = 2.0 * np.pi * FREQUENCY * order
            angle = turning * (times + START) + np.radians(phase)
            values -= 1e-3 * amplitude * turning**2 * np.sin(angle)
        values += FAN[1] * np.sin(2.0 * np.pi * FAN[0] * times)
        values += NOISE * rng.standard_normal(COUNT)
        columns.append(STEP * np.round(values / GRAVITY / STEP))
    rows = (
        f"{time:.4f},{along:.4f},{across:.4f},{normal:.4f}"
        for time, along, across, normal in zip(shown, *columns, strict=True)
    )
    text = HEADER + "time [s],ax [g],ay [g],az [g]\n" + "\n".join(rows) + "\n"
    target.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(Path(__file__).with_suffix(".csv"))
