"""The page's reading of typed numbers, without a browser: node runs the module."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from tools import tool

MODULES = Path(__file__).parents[3] / "app" / "page" / "modules"
NUMBERS = [
    ("0.3", "1", 0.3),
    ("0,3", "1", 0.3),
    ("25 %", "1", 0.25),
    ("0.35", "m", 0.35e-3),  # fields of lengths are in mm
    ("0,350 mm", "m", 0.35e-3),
    ("350 µm", "m", 0.35e-3),
    ("3000/60", "Hz", 50),
    ("3000 rpm", "Hz", 50),
    ("3000 1/min", "Hz", 50),
    ("(1 + 2) * 3", "1", 9),
    ("1e-3", "1", 1e-3),
    ("\u22125°", "degree", -5),
    ("2 g", "m s-2", 19.6133),
    ("1.2", "kg", 1.2e-3),  # fields of masses are in g
]
NONSENSE = [
    ("", "1"), ("abc", "1"), ("1e400", "1"), ("1/0", "1"), ("0/0", "1"), ("0.06k", "Hz"),
    ("3 mm", "Hz"), ("1,000", "Hz"), ("1 2", "1"), ("((((", "1"), ("__proto__", "1"),
    ("5 constructor", "1"), ("9" * 100, "1"),
]  # fmt: skip


def test_typed_numbers(tmp_path: Path) -> None:
    typed = [(text, unit) for text, unit, _ in NUMBERS] + NONSENSE
    shutil.copytree(MODULES, tmp_path, dirs_exist_ok=True)
    (tmp_path / "package.json").write_text('{"type": "module"}')
    (tmp_path / "main.js").write_text(
        'import { readNumber } from "./numbers.js";\n'
        f"const typed = {json.dumps(typed)};\n"
        "console.log(JSON.stringify(typed.map(([text, unit]) => readNumber(text, unit))));\n"
    )
    program = [tool("node"), tmp_path / "main.js"]
    done = subprocess.run(program, capture_output=True, text=True, check=True)
    read = json.loads(done.stdout)
    for (text, unit, value), found in zip(NUMBERS, read, strict=False):
        assert found == {"value": pytest.approx(value, rel=1e-15)}, (text, unit)
    for (text, unit), found in zip(NONSENSE, read[len(NUMBERS) :], strict=True):
        assert set(found) == {"problem"}, (text, unit)
