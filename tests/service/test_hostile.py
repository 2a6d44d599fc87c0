"""Clients that mean harm, in short; `python -m benchmarks.hostile` is the long run."""

from __future__ import annotations

import pytest

from benchmarks import hostile

# Of a slow machine, or one with many cores; without the bounds silences last as long as the attack,
# and memory passes 2 GB and stays there.
LIMITS = hostile.Limits(health=8, small=12, peak=1.5e9, after=8e8, log=1_000_000)


@pytest.mark.parametrize(("attack", "seconds"), [(hostile.silent, 15), (hostile.deaf_slices, 14)])
def test_others_are_answered_and_memory_comes_back(attack, seconds):
    assert hostile.suffered(attack, seconds).missed(LIMITS) == []
