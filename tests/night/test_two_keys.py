"""Two keys that share a service: neither sees, changes or evicts what is the other's."""

from __future__ import annotations

from benchmarks.serving import served
from night import count
from two_keys import LIMITED, STRICT, make_keys, play

CALLS = count(60, 2000, "VIBRAFEED_FUZZ_CASES")


def test_random_calls_of_both_tell_nothing_of_the_other():
    with served(workers=1) as server:
        keys = make_keys(server)  # while it runs
        assert set(keys) == {STRICT, LIMITED}
        found = play(server, keys, CALLS, seed=5)
    assert not found.wrong, found.wrong[:5]
