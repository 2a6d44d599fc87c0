"""Studies whose cells are computed one by one, of any size."""

from typing import Any

TRACK: dict[str, Any] = {
    "kind": "sweep",
    "scene": "rectangle-on-track",
    "outputs": ["acceleration_x", "transport_velocity", "throw_number", "vibration_acceleration"],
    "parameters": {
        "frequency": {"start": "20 Hz", "stop": "120 Hz", "num": 11},
        "amplitude": {"start": "0.1 mm", "stop": "1 mm", "num": 7, "spacing": "log"},
        "alpha": {"start": 0, "stop": 90, "num": 13},
        "beta": [80, 41, 40, 15, 0],
        "friction": 0.3,
        "radius": "0.8 m",
        "distance": "0.2 mm",
    },
}
MOTION: dict[str, Any] = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity", "flight_fraction", "throw_number", "motion_status"],
    "parameters": {
        "frequency": [40, 50],
        "amplitude": {"start": "0.1 mm", "stop": "0.7 mm", "num": 9},
        "beta": {"start": 10, "stop": 60, "num": 6},
        "friction": [0.4, 0.2],
    },
}


def sweep_of(cells_an_axis: int, axes: int = 4) -> dict[str, Any]:
    """Return a sweep with so many values on each of its first axes."""
    ends = {"frequency": (20, 120), "amplitude": (1e-4, 1e-3), "alpha": (0, 90), "beta": (0, 90)}
    own = {
        name: {"start": start, "stop": stop, "num": cells_an_axis}
        for name, (start, stop) in [*ends.items()][:axes]
    }
    return {**TRACK, "parameters": {**TRACK["parameters"], **own}}
