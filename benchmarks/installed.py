"""Packages of an environment, and the room that each takes, its bytecode included.

`python -m benchmarks.installed ENVIRONMENT ...` prints a line a package, the largest first: MB
(10^6 bytes) in each environment, a folder that `python -m venv` made.
"""

from __future__ import annotations

import sys
from importlib.metadata import distributions
from pathlib import Path


def sizes(environment: Path) -> dict[str, int]:
    """Return the bytes of each package of an environment, by its name."""
    folders = [*environment.glob("lib/python*/site-packages"), environment / "Lib/site-packages"]
    found: dict[str, int] = {}
    for package in distributions(path=[str(folder) for folder in folders]):
        listed = {Path(package.locate_file(file)).resolve() for file in package.files or ()}
        kept = {
            code
            for file in listed
            if file.suffix == ".py"
            for code in file.parent.glob(f"__pycache__/{file.stem}.*.pyc")
        }
        found[package.metadata["Name"]] = sum(
            f.stat().st_size for f in listed | kept if f.is_file()
        )
    return found


def main(places: list[str]) -> None:
    """Print the table of some environments."""
    columns = [sizes(Path(place)) for place in places]
    names = sorted({name for column in columns for name in column}, key=str.lower)
    names.sort(key=lambda name: -max(column.get(name, 0) for column in columns))
    for name in names:
        cells = (
            f"{column[name] / 1e6:9.1f}" if name in column else "        -" for column in columns
        )
        print(f"{name:<24}", *cells)
    for label, cells in (
        ("MB", (sum(column.values()) / 1e6 for column in columns)),
        ("packages", map(len, columns)),
    ):
        print(f"{label:<24}", *(f"{cell:9.0f}" for cell in cells))


if __name__ == "__main__":
    main(sys.argv[1:] or [sys.prefix])
