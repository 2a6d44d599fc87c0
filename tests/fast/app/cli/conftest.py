"""What tests of the command line share."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from vibrafeed.core import kinds


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Be in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def stopped_after(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Return a function that has runs stopped after so many of their cells."""
    plain = kinds.tabulate

    def after(cells: int) -> None:
        left, asked = cells, threading.Event()
        if not left:
            asked.set()

        def tabulate(prepared, watch):
            def advance(share: float) -> None:
                nonlocal left
                watch.advance(share)
                left -= 1
                if left == 0:
                    asked.set()

            return plain(prepared, replace(watch, progress=advance, stop=asked.is_set, threads=1))

        monkeypatch.setattr(kinds, "tabulate", tabulate)

    return after
