"""Differences between operating systems."""

from __future__ import annotations

import psutil


def memory() -> int:
    """Return the memory of this machine in bytes."""
    return int(psutil.virtual_memory().total)
