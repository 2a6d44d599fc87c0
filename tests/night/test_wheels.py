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


def test_a_version_without_a_wheel_is_found(tmp_path):
    """netCDF4 1.7.5.1.post1 has none for macOS."""
    constraints = tmp_path / "constraints.txt"
    kept = [line for line in PINS.splitlines() if not line.startswith("netCDF4")]
    constraints.write_text("\n".join([*kept, "netCDF4==1.7.5.1.post1"]), encoding="utf-8")
    packages, reason = WHEELS["resolved"](WHEELS["PLATFORMS"]["macOS arm64"], "3.12", constraints)
    assert not packages
    assert "netcdf4==1.7.5.1.post1 has no usable wheels" in reason
