"""A name of a class means one thing: no two modules of a package define the same."""

from __future__ import annotations

import ast
from collections import defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def classes(package: Path) -> dict[str, list[str]]:
    """Return the modules of each class of a package, private ones aside."""
    where = defaultdict(list)
    for path in sorted(package.rglob("*.py")):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                where[node.name].append(str(path.relative_to(package)))
    return where


@pytest.mark.parametrize("package", ["core", "app"])
def test_no_two_classes_have_one_name(package):
    where = classes(ROOT / package)
    assert len(where) > 50
    assert {name: paths for name, paths in where.items() if len(paths) > 1} == {}


def test_a_second_class_of_a_name_is_found(tmp_path):
    for module in ("one", "two"):
        (tmp_path / f"{module}.py").write_text("class Same:\n    pass\n", encoding="utf-8")
    assert classes(tmp_path) == {"Same": ["one.py", "two.py"]}
