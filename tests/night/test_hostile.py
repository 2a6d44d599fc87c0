"""Clients that mean harm, or are many: others are answered, and memory comes back."""

import pytest

from benchmarks import hostile
from benchmarks.load import measure

# Of a quiet machine; the log has a line for each request.
LIMITS = {"health": 1, "small": 3, "peak": 1.5e9, "after": 8e8, "log": 1_000_000, "busy": 3}


@pytest.mark.parametrize("attack", hostile.ATTACKS)
def test_others_are_answered_soon_and_memory_comes_back(attack):
    found = hostile.suffered(hostile.ATTACKS[attack], 14)
    assert {name: value for name, value in found.items() if value > LIMITS[name]} == {}


def test_a_busy_service_fails_nobody():
    assert measure(clients=20, seconds=8, trees=[]) == []
