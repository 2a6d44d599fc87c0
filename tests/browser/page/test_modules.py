"""Modules of the page that need no browser: node runs their tests, `*.test.js` beside this file."""

from __future__ import annotations

import subprocess
from pathlib import Path

from tools import tool

HERE = Path(__file__).parent


def test_pure_modules() -> None:
    files = sorted(HERE.glob("*.test.js"))
    assert files
    done = subprocess.run(
        [tool("node"), "--test", *files], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout
