"""Imports stand at the top of a file; inside functions are those that are slow or optional.

A command loads what it needs when it runs: in `app/cli` imports may begin a function.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from itertools import takewhile
from pathlib import Path

ROOT = Path(__file__).parents[1]
COMMANDS = ROOT / "app" / "cli"
MOST = 64
"""Of all in app, core and vibrafeed. Where a package hands on names lazily none is needed."""
IMPORTS = (ast.Import, ast.ImportFrom)
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


def inside(source: str, *, may_begin: bool = False) -> Iterator[ast.stmt]:
    """Yield the imports inside functions, perhaps without those that begin one."""
    seen = set()
    functions = [node for node in ast.walk(ast.parse(source)) if isinstance(node, FUNCTIONS)]
    for function in functions if may_begin else ():
        body = function.body[ast.get_docstring(function) is not None :]
        begin = takewhile(lambda node: isinstance(node, IMPORTS), body)
        seen |= {node.lineno for node in begin}
    for function in functions:
        for node in ast.walk(function):
            if isinstance(node, IMPORTS) and node.lineno not in seen:
                seen.add(node.lineno)
                yield node


def test_they_are_found():
    source = "import a\ndef f():\n    import b\n    def g():\n        from c import d\n"
    assert [node.lineno for node in inside(source)] == [3, 5]
    assert not [*inside(source, may_begin=True)]
    late = "def f():\n    'It does.'\n    import b\n    print()\n    import c\n"
    assert [node.lineno for node in inside(late, may_begin=True)] == [5]


def test_few_imports_are_inside_functions():
    files = [file for name in ("app", "core", "vibrafeed") for file in ROOT.glob(f"{name}/**/*.py")]
    places = [
        f"{file}:{node.lineno}"
        for file in files
        for node in inside(file.read_text(encoding="utf-8"), may_begin=COMMANDS in file.parents)
    ]
    assert len(files) > 300
    assert len(places) <= MOST, places
