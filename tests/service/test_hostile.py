"""Clients that mean harm: others are answered, and memory comes back."""

from __future__ import annotations

import math

import pytest

from benchmarks import hostile
from night import count

# Without the bounds memory passes 2 GB and stays there, and the log has a line for each client.
MEMORY = {"peak": 1.5e9, "after": 8e8, "log": 1_000_000, "busy": 0.5}
SECONDS = count(12, 15, "VIBRAFEED_SILENT_SECONDS")  # longer than the service waits for a head
BY_DAY = {"health": math.inf, "small": math.inf, **MEMORY}
# Of a quiet machine: without the bounds silences last as long as the attack.
BY_NIGHT = {"health": 8, "small": 12, **MEMORY}


def exceeded(found: dict[str, float], limits: dict[str, float]) -> dict[str, float]:
    return {name: value for name, value in found.items() if value > limits[name]}


def test_silent_clients_take_no_memory_and_others_are_answered():
    assert exceeded(hostile.suffered(hostile.silent, SECONDS), BY_DAY) == {}


@pytest.mark.night
@pytest.mark.parametrize(("attack", "seconds"), [(hostile.silent, 15), (hostile.deaf_slices, 14)])
def test_others_are_answered_soon_and_memory_comes_back(attack, seconds):
    assert exceeded(hostile.suffered(attack, seconds), BY_NIGHT) == {}
