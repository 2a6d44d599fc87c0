"""Whether every pinned package that users install has wheels where they sit.

`python scripts/wheels.py` asks uv, and the index that it is configured for, to resolve vibrafeed
with its extras under `constraints.txt`, from wheels alone, for each system and each Python. It
prints a line a pair and ends with code 1 if one has no solution. Nothing is installed, and nothing
but metadata is downloaded.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PLATFORMS = {
    "Windows x64": "x86_64-pc-windows-msvc",
    "macOS arm64": "aarch64-apple-darwin",
    "Linux x86_64": "x86_64-manylinux_2_28",
}
MACOS = "14.0"
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
APART = {"dev", "docs", "engines"}
"""Extras of who works on vibrafeed itself."""


def resolved(
    platform: str, python: str, constraints: Path = ROOT / "constraints.txt"
) -> tuple[list[str], str]:
    """Return the packages that are installed on a platform, and the reason if there is no way."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = sorted(project["optional-dependencies"].keys() - APART)
    uv = shutil.which("uv", path=str(Path(sys.executable).parent)) or "uv"
    done = subprocess.run(
        [
            uv, "pip", "compile", "--quiet", "--no-header", "--no-annotate",
            "--only-binary", ":all:", "--constraint", str(constraints),
            "--python-platform", platform, "--python-version", python, "pyproject.toml",
            *(word for extra in extras for word in ("--extra", extra)),
        ],
        cwd=ROOT, capture_output=True, text=True, encoding="utf-8", check=False,
        env={**os.environ, "MACOSX_DEPLOYMENT_TARGET": MACOS},
    )  # fmt: skip
    return done.stdout.split("\n")[:-1], done.stderr if done.returncode else ""


def gaps() -> Iterator[str]:
    """Yield the systems and Pythons for which wheels are missing; print what is found."""
    for system, platform in PLATFORMS.items():
        for python in PYTHONS:
            packages, reason = resolved(platform, python)
            name = f"{system}, Python {python}"
            told = reason or f"all {len(packages)} packages have wheels"
            sys.stdout.write(f"{name}: {told}\n")
            if reason:
                yield name


if __name__ == "__main__":
    sys.exit(bool([*gaps()]))
