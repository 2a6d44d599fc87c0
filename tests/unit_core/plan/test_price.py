"""What a sweep will take, told before: in order, at any size, and at no cost."""

import tracemalloc

import pytest

from vibrafeed.core.intake import prepare_content
from vibrafeed.core.plan import price

AXES = {
    "frequency": (20, 120), "amplitude": (1e-4, 1e-3), "alpha": (0, 60), "beta": (5, 60),
    "friction": (0.1, 0.8), "delta": (0, 20),
}  # fmt: skip


def seconds(output: str, num: int, **more) -> float:
    spans = {name: {"start": a, "stop": b, "num": num} for name, (a, b) in AXES.items()}
    given = {**spans, "radius": 0.8, "distance": 2e-4, **more}
    prepared = prepare_content(
        {
            "kind": "sweep", "scene": "rectangle-on-track", "outputs": [output],
            "parameters": {name: value for name, value in given.items() if value is not None},
        }
    )  # fmt: skip
    return prepared.seconds_a_cell * prepared.cells


def test_a_price_grows_with_cells_and_steps():
    large, larger = (seconds("transport_velocity", num) for num in (100, 200))
    assert larger == pytest.approx(64 * large, rel=0.1)
    # A part that starts at a speed has more roots, and its time an arc in every cell; from rest it
    # has one for each friction. What brakes has an arc tangent between loops.
    assert seconds("transport_velocity", 100, speed=0.1) > 1.2 * large
    assert seconds("travel_time", 100) < 2 * large
    assert seconds("travel_time", 100, speed=0.1) > 2 * large
    assert seconds("stopping_time", 100, speed=0.1, distance=None) > 4 * large


def test_a_price_is_told_without_the_grid():
    # 10^24 cells: an axis of them alone would take 800 MB.
    spans = {"frequency": {"start": 20, "stop": 120, "num": 10**8}}
    tracemalloc.start()
    try:
        assert seconds("transport_velocity", 2000, **spans) > 1e6
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert most < 2e7  # bytes; what the libraries keep for a study is some 10^6


def test_what_is_small_has_the_price_of_numpy():
    prepared = prepare_content(
        {
            "kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["acceleration_x"],
            "parameters": {"frequency": [50, 60], "amplitude": 1e-4, "beta": 20, "friction": 0.3},
        }
    )  # fmt: skip
    assert prepared.seconds_a_cell == prepared.plan.scene.seconds_a_cell * price.pace()
