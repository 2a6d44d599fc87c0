"""Private parts of libraries stand in few files, each with a test that notices when they change."""

from __future__ import annotations

import ast
from pathlib import Path

ROOT = Path(__file__).parents[1]

INTERNAL = ("numba.core", "numba.misc", "llvmlite", "h5py.h5")
"""Modules that libraries keep for themselves, or warn of."""

BEHIND = {
    "core/kernel_cache.py": "tests/unit_core/test_kernel_cache.py",
    "core/compiled.py": "tests/unit_core/test_linking.py",
}
"""The files that reach into libraries, and their tests."""

PUBLIC = {"_asdict", "_fields", "_field_defaults", "_make", "_replace", "_exit", "_mapping"}
"""What begins with a line and is documented: of named tuples, of `os`, of SQLAlchemy's rows."""


def sources() -> list[Path]:
    return sorted(path for top in ("core", "app") for path in (ROOT / top).rglob("*.py"))


def internal_modules(tree: ast.AST) -> set[str]:
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {one.name for one in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module}
        elif isinstance(node, ast.Attribute):
            names |= {ast.unparse(node)}
    return {name for name in names if name.startswith(INTERNAL)}


def foreign_attributes(tree: ast.AST) -> set[str]:
    """Return private names that are read of objects, and that the file itself does not define."""
    own, read = set(), set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            of_self = isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")
            private = node.attr.startswith("_") and not node.attr.startswith("__")
            if private and node.attr not in PUBLIC:
                (own if of_self else read).add(node.attr)
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            own.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            own.add(node.id)
    return read - own


def test_private_parts_of_libraries_stand_behind_one_file_each():
    found = set()
    for path in sources():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        if internal_modules(tree) or foreign_attributes(tree):
            found.add(str(path.relative_to(ROOT)))
    assert found == set(BEHIND)
    for test in BEHIND.values():
        assert (ROOT / test).exists()
