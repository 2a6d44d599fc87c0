"""Folders that the system sets aside for programs."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def data_folder() -> Path:
    """Return the system's folder for the data of a user's programs; `data` where there is no home.

    That is `XDG_DATA_HOME`, or `~/.local/share`; `~/Library/Application Support` on macOS.
    """
    usual = "Library/Application Support" if sys.platform == "darwin" else ".local/share"
    return _folder("XDG_DATA_HOME", usual) or Path("data")


def cache_folder() -> Path:
    """Return the system's folder for caches of programs; `.cache` where there is no home.

    That is `XDG_CACHE_HOME`, or `~/.cache`; `~/Library/Caches` on macOS.
    """
    usual = "Library/Caches" if sys.platform == "darwin" else ".cache"
    return _folder("XDG_CACHE_HOME", usual) or Path(".cache")


def _folder(variable: str, usual: str) -> Path | None:
    """Return our part of the folder that a variable names, or of the usual one in the home."""
    base = Path(os.environ.get(variable, ""))
    if not base.is_absolute():  # the standard says that others are ignored
        try:
            base = Path.home() / usual
        except RuntimeError:
            return None
    return base / "vibrafeed"
