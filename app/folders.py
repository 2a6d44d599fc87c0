"""Folders that the system sets aside for programs."""

from __future__ import annotations

import os
import sys
from pathlib import Path

LOCAL = ("LOCALAPPDATA", "AppData/Local")  # Windows' folder for what stays on one computer


def data_folder() -> Path:
    """Return the system's folder for application data of this user; `data` if the user has no home.

    That is `XDG_DATA_HOME`, or `~/.local/share`; `~/Library/Application Support` on macOS,
    `%LOCALAPPDATA%` on Windows, which other users cannot read.
    """
    if sys.platform == "win32":
        return _folder(*LOCAL) or Path("data")
    default = "Library/Application Support" if sys.platform == "darwin" else ".local/share"
    return _folder("XDG_DATA_HOME", default) or Path("data")


def cache_folder() -> Path:
    """Return the system's cache folder of this user; `.cache` if the user has no home.

    That is `XDG_CACHE_HOME`, or `~/.cache`; `~/Library/Caches` on macOS, `Cache` in the data folder
    on Windows.
    """
    if sys.platform == "win32":
        return data_folder() / "Cache"
    default = "Library/Caches" if sys.platform == "darwin" else ".cache"
    return _folder("XDG_CACHE_HOME", default) or Path(".cache")


def _folder(variable: str, default: str) -> Path | None:
    """Return the folder `vibrafeed` in a system folder; None if the user has no home folder.

    `variable` is the environment variable that may name the system folder by an absolute path;
    `default` is that folder relative to the user's home where the variable is not set.
    """
    base = Path(os.environ.get(variable, ""))
    if not base.is_absolute():  # the standard says that others are ignored
        try:
            base = Path.home() / default
        except RuntimeError:
            return None
    return base / "vibrafeed"
