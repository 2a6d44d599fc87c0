"""A short load: `python -m benchmarks.load` is the long one, on a machine of its own."""

from __future__ import annotations

from benchmarks.load import measure


def test_a_busy_service_fails_nobody():
    assert measure(clients=20, seconds=8, trees=[]) == []
