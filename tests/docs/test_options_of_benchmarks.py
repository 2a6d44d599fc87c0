"""What all benchmarks share: their command lines, and how they time calls."""

import sys
from itertools import count
from pathlib import Path

import pytest

from benchmarks.options import options
from benchmarks.timing import in_turns, least


def read(monkeypatch, line, *names, **known):
    monkeypatch.setattr(sys, "argv", ["benchmark", *line.split()])
    return vars(options("What it prints.\n", *names, **known))


def test_options_have_the_types_of_their_defaults(monkeypatch):
    known = {"cells": 2e7, "runs": (9, "of each"), "bits": False, "cache": Path, "sizes": [float]}
    plain = read(monkeypatch, "", **known)
    assert plain == {"cells": 2e7, "runs": 9, "bits": False, "cache": None, "sizes": []}
    asked = read(monkeypatch, "--cells 5 --bits --cache a/b --sizes 1 2", **known)
    assert asked == plain | {"cells": 5.0, "bits": True, "cache": Path("a/b"), "sizes": [1.0, 2.0]}
    assert read(monkeypatch, "--seeds 4", seeds=[0, 1, 2]) == {"seeds": [4]}
    assert read(monkeypatch, "", seeds=[0, 1, 2]) == {"seeds": [0, 1, 2]}


def test_words_without_an_option_are_known_names(monkeypatch):
    assert read(monkeypatch, "events", "events", "chaos", studies=10)["names"] == ["events"]
    assert read(monkeypatch, "", "events", studies=10) == {"names": [], "studies": 10}
    with pytest.raises(SystemExit):
        read(monkeypatch, "event", "events")


def test_functions_take_turns_and_each_call_has_its_seconds():
    calls, ticks = [], count()

    def clock():
        return next(ticks) ** 2

    times = in_turns(2, lambda: calls.append("a"), lambda: calls.append("b"), clock=clock)
    assert calls == ["a", "b", "a", "b"]
    assert times == [[1, 9], [5, 13]]
    assert least(3, lambda: None, clock) == 9**2 - 8**2
