"""What several processes of the tests need, made by the first of them."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from waiting import wait_for


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """Return a folder of a run of tests; the process that comes first fills it, others wait."""
    base = factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        base = base.parent
    folder, done, failed = base / name, base / f"{name}.done", base / f"{name}.failed"
    try:
        folder.mkdir()
    except FileExistsError:

        def is_made() -> bool:
            assert not failed.exists(), f"another process could not make {name}"
            return done.exists()

        wait_for(is_made, lambda: f"{name} is not made")
        return folder
    try:
        make(folder)
    except BaseException:
        failed.touch()
        raise
    done.touch()
    return folder
