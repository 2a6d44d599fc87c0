"""Pinned packages have wheels on Windows x64, macOS arm64 and Linux x86_64, on every Python."""

import re
import runpy
import sys
from pathlib import Path

import pytest

from tools import tool

ROOT = Path(__file__).parents[2]
WHEELS = runpy.run_path(str(ROOT / "scripts" / "wheels.py"))
PINS = (ROOT / "constraints.txt").read_text(encoding="utf-8")


@pytest.fixture(autouse=True)
def _uv():
    tool(Path(sys.executable).with_name("uv"), "uv")


def pin(line: str) -> str:
    """Return a name and its version as the index writes names."""
    return re.split("[ ;]", line)[0].lower().replace("_", "-")


@pytest.mark.parametrize("python", WHEELS["PYTHONS"])
@pytest.mark.parametrize("system", WHEELS["PLATFORMS"])
def test_every_package_has_a_wheel(system, python):
    packages, reason = WHEELS["resolved"](WHEELS["PLATFORMS"][system], python)
    assert (reason, len(packages) > 100) == ("", True)
    pins = {pin(line) for line in PINS.splitlines() if "==" in line}
    unpinned = [name for name in packages if pin(name) not in pins]
    assert not unpinned, "its version is not in constraints.txt"
