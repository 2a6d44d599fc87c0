"""A sweep posted to the service, and the problem documents it answers with."""

STUDY = {
    "kind": "sweep",
    "scene": "rectangle-on-track",
    "outputs": ["acceleration_x", "transport_velocity", "throw_number"],
    "parameters": {
        "frequency": {"start": "20 Hz", "stop": "120 Hz", "num": 11},
        "amplitude": ["0.35 mm", "0.5 mm"],
        "alpha": {"start": 0, "stop": 90, "num": 10},
        "beta": {"start": 0, "stop": 90, "num": 7},
        "friction": 0.3,
        "radius": "0.8 m",
        "distance": "0.2 mm",
    },
}


def with_axes(**sizes: int) -> dict:
    """Return the study with axes of so many values."""
    ends = {"frequency": (20, 120), "amplitude": (1e-4, 1e-3), "alpha": (0, 90), "beta": (0, 90)}
    axes = {
        name: {"start": ends[name][0], "stop": ends[name][1], "num": size}
        for name, size in sizes.items()
    }
    return {**STUDY, "parameters": {**STUDY["parameters"], **axes}}


TRILLION = with_axes(frequency=1000, amplitude=1000, alpha=1000, beta=1000)
"""Of 10^12 cells."""


def problem(response, status: int, kind: str = "") -> dict:
    """Return the problem document of a reply that has to be one, of a kind."""
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    document = response.json()
    assert document["status"] == status
    assert document["title"]
    assert document["type"].endswith(kind)
    return document
