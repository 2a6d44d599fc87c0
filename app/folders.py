"""Folders that the system sets aside for programs."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def data_folder() -> Path:
    """Return where the system keeps what a user's programs make; `data` where there is no home.

    That is `XDG_DATA_HOME`, or `~/.local/share`; `~/Library/Application Support` on macOS.
    """
    base = Path(os.environ.get("XDG_DATA_HOME", ""))
    if not base.is_absolute():  # the standard says that others are ignored
        usual = "Library/Application Support" if sys.platform == "darwin" else ".local/share"
        try:
            base = Path.home() / usual
        except RuntimeError:
            return Path("data")
    return base / "vibrafeed"
