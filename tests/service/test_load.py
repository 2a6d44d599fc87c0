"""A short load: `python -m benchmarks.load` is the long one, on a machine of its own."""

from __future__ import annotations

import pytest

from benchmarks.load import measure

# A blocked event loop answers /healthz after seconds; a machine that others load, after tenths.
MAX_HEALTH = 0.5


@pytest.mark.night
def test_a_busy_service_fails_nobody_and_stays_alive():
    assert measure(clients=40, seconds=8, tell=print, most_health=MAX_HEALTH) == []
