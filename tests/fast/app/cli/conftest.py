"""What tests of the command line share."""

import signal
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
    """Return a function that lets Ctrl-C be pressed after so many cells of a run."""
    plain = kinds.tabulate

    def after(cells: int) -> None:
        left = cells

        def tabulate(prepared, watch):
            def advance(share: float) -> None:
                nonlocal left
                watch.advance(share)
                left -= 1
                if left == 0:
                    signal.raise_signal(signal.SIGINT)

            if not left:
                signal.raise_signal(signal.SIGINT)
            return plain(prepared, replace(watch, progress=advance, threads=1))

        monkeypatch.setattr(kinds, "tabulate", tabulate)

    return after
