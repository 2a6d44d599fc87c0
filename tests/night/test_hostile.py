"""Clients that mean harm: others are answered, and memory comes back."""

from __future__ import annotations

import itertools

import pytest

from benchmarks import hostile
from benchmarks.serving import served

# Of a quiet machine; the log has a line for each request.
LIMITS = {"health": 1, "small": 3, "peak": 1.5e9, "after": 8e8, "log": 1_000_000, "busy": 3}


@pytest.mark.parametrize("attack", hostile.ATTACKS)
def test_others_are_answered_soon_and_memory_comes_back(attack):
    found = hostile.suffered(hostile.ATTACKS[attack], 14)
    assert {name: value for name, value in found.items() if value > LIMITS[name]} == {}


def test_each_attack_asks_for_what_the_service_does(monkeypatch):
    """An attack that is refused as malformed would prove nothing."""
    statuses = {}

    def ask(server, requests, seconds):
        for method, path, content, _ in itertools.islice(requests, 1):
            headers = hostile.ASYNC if "execution" in path else {}
            reply = server.ask(method, path, content, **headers)
            statuses[name] = (reply.status, reply.body if reply.status >= 300 else b"")

    monkeypatch.setattr(hostile, "_ask_again_and_again", ask)
    monkeypatch.setattr(hostile, "JOBS", 10)
    with served(workers=1) as server:
        for name in hostile.ATTACKS:
            hostile.ATTACKS[name](server, 1)
    assert statuses.keys() == hostile.ATTACKS.keys()
    assert {name: one for name, one in statuses.items() if one[0] not in (200, 201)} == {}
