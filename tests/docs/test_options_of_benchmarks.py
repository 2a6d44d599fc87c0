"""What all benchmarks share: their command lines."""

import sys
from pathlib import Path

import pytest

from benchmarks.options import options


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
