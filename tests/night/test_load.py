"""A short load: `python -m benchmarks.load` is the long one, on a machine of its own."""

from __future__ import annotations

import pytest

from benchmarks.load import measure


@pytest.mark.night
def test_a_busy_service_fails_nobody():
    assert measure(clients=20, seconds=8, trees=[]) == []
