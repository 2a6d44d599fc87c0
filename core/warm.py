"""Kernels compiled before anybody waits for them: when an image is built, or a service starts.

Each group of studies has kernels of its own, so that several processes can do them at a time. Where
everything is compiled already, it takes seconds.
"""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

from core.intake import prepare_content
from core.kinds import KINDS, tabulate

GROUPS: dict[str, tuple[Mapping[str, Any], ...]] = {
    name: studies for kind in KINDS.values() for name, studies in kind.compiles.items()
}
"""The studies of each group, those of all kinds."""


def warm(processes: int) -> Path | None:
    """Compile every kernel that is not compiled yet for this processor.

    Parameters
    ----------
    processes : int
        Most processes at a time.

    Returns
    -------
    Path or None
        Where compiled code is kept; None if no folder can be written.
    """
    from core.compiled import folder

    place = folder()
    if place is None or is_warm():
        return place
    if not os.access(place, os.W_OK):  # an image ships it, for another processor
        return None
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(processes, len(GROUPS)), mp_context=spawn) as pool:
        list(pool.map(carry_out, GROUPS))
    _mark(place).touch()
    return place


def is_warm() -> bool:
    """Return whether every kernel has been compiled for this processor, and kept."""
    from core.compiled import folder

    place = folder()
    return place is not None and _mark(place).exists()


def carry_out(group: str) -> None:
    """Carry out the studies of a group."""
    for study in GROUPS[group]:
        tabulate(prepare_content(study))


def _mark(place: Path) -> Path:
    """Return the file that says so; it goes with the code that it speaks of."""
    from core.compiled import processor

    return place / f"warm-{processor()}"
