"""Makes docs/my-bowl/recording.csv: the accelerometer of the tutorial, on a bowl that is not there.

The drive is the tutorial's, exactly: 50 Hz, 0.35 mm along a straight line at 20 degrees above a
track that climbs by 2 degrees. The sensor has noise, 12 bits over 8 g either way, and a clock that
is 0.2 % slow.

    python examples/my_bowl.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

FREQUENCY, AMPLITUDE, BETA, GAMMA = 50.0, 0.35e-3, np.radians(20.0), np.radians(2.0)
RATE, COUNT = 2000, 2000
CLOCK = 0.002  # share of a second that the clock fails to count
GRAVITY = 9.80665  # m s-2
NOISE = 0.3  # m s-2 rms
STEP = 16.0 / 2**12  # g
TARGET = Path(__file__).parents[1] / "docs" / "my-bowl" / "recording.csv"


def main(target: Path = TARGET) -> None:
    """Write the recording."""
    rng = np.random.default_rng(20261123)
    shown = np.arange(COUNT) / RATE
    turning = 2.0 * np.pi * FREQUENCY
    track = -AMPLITUDE * turning**2 * np.sin(turning * shown * (1.0 + CLOCK) + 0.4)
    columns = [
        track * np.cos(BETA) + GRAVITY * np.sin(GAMMA),
        track * np.sin(BETA) + GRAVITY * np.cos(GAMMA),
    ]
    noisy = (values + NOISE * rng.standard_normal(COUNT) for values in columns)
    along, normal = (STEP * np.round(values / GRAVITY / STEP) for values in noisy)
    rows = (f"{t:.4f},{x:.4f},{z:.4f}" for t, x, z in zip(shown, along, normal, strict=True))
    lines = ["# Made by examples/my_bowl.py, not measured.", "time [s],along [g],normal [g]", *rows]
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
