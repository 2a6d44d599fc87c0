"""The folder that the system sets aside for the data of programs."""

from __future__ import annotations

import os
import sys
from pathlib import Path

# By platform: the variable that may name it, and where it is in the user's home otherwise.
PLACES = {
    "win32": ("LOCALAPPDATA", "AppData/Local"),  # what stays on one computer
    "darwin": ("XDG_DATA_HOME", "Library/Application Support"),
}
OTHER_SYSTEMS = ("XDG_DATA_HOME", ".local/share")


def data_folder() -> Path:
    """Return the system's folder for application data of this user; `data` if the user has no home.

    That is `XDG_DATA_HOME`, or `~/.local/share`; `~/Library/Application Support` on macOS,
    `%LOCALAPPDATA%` on Windows, which other users cannot read.
    """
    variable, default = PLACES.get(sys.platform, OTHER_SYSTEMS)
    base = Path(os.environ.get(variable, ""))
    if not base.is_absolute():  # the standard says that others are ignored
        try:
            base = Path.home() / default
        except RuntimeError:
            return Path("data")
    return base / "vibrafeed"
