"""Imports stand at the top of a file; inside functions are those that are slow or optional."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
MOST = 64
"""Of all in app, core and vibrafeed. Where a package hands on names lazily none is needed."""


def inside(source: str) -> Iterator[ast.stmt]:
    """Yield the imports inside functions."""
    functions = (ast.FunctionDef, ast.AsyncFunctionDef)
    seen = set()
    for function in ast.walk(ast.parse(source)):
        for node in ast.walk(function) if isinstance(function, functions) else ():
            if isinstance(node, ast.Import | ast.ImportFrom) and node.lineno not in seen:
                seen.add(node.lineno)
                yield node


def test_they_are_found():
    source = "import a\ndef f():\n    import b\n    def g():\n        from c import d\n"
    assert [node.lineno for node in inside(source)] == [3, 5]


def test_few_imports_are_inside_functions():
    files = [file for name in ("app", "core", "vibrafeed") for file in ROOT.glob(f"{name}/**/*.py")]
    places = [f"{file}:{node.lineno}" for file in files for node in inside(file.read_text())]
    assert len(files) > 400
    assert len(places) <= MOST, places
