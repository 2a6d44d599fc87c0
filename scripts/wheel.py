"""Hatch's hook for wheels: installed, `core` and `app` are `vibrafeed.core` and `vibrafeed.app`.

The two folders stand at the top of the repository. In a wheel they stand within `vibrafeed`, and
every import of them says so: a program may have packages of its own that are called `core` or
`app`. No line moves. An editable install is the clone, and is not rewritten.
"""

from __future__ import annotations

import ast
import re
import shutil
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

OWN = ("core", "app")
PLAIN = ("_packages.py",)
"""Files that speak of both forms, and are right in either."""
MODULE = re.compile(rf"({'|'.join(OWN)})(\.\w+)+")
STATEMENT = re.compile(rf"\b(from|import) (?=(?:{'|'.join(OWN)})\b)")


class ImportsOfTheWheel(BuildHookInterface):  # type: ignore[type-arg]
    """Puts rewritten copies of the three packages into the wheel."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Make the copies, and have them included."""
        if version == "editable":
            return
        root = Path(self.root)
        self.folder = Path(tempfile.mkdtemp())
        for package in ("vibrafeed", *OWN):
            for file in sorted((root / package).rglob("*")):
                if not file.is_file() or "__pycache__" in file.parts:
                    continue
                within = file.relative_to(root / "vibrafeed" if package == "vibrafeed" else root)
                target = self.folder / within
                target.parent.mkdir(parents=True, exist_ok=True)
                if file.suffix == ".py" and file.name not in PLAIN:
                    text = rewritten(file.read_text(encoding="utf-8"), root)
                    target.write_text(text, encoding="utf-8")
                else:
                    shutil.copyfile(file, target)
        build_data["force_include"][str(self.folder)] = "vibrafeed"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Remove the copies."""
        if version != "editable":
            shutil.rmtree(self.folder)


def rewritten(source: str, root: Path) -> str:
    """Return a module whose imports name `vibrafeed.core` and `vibrafeed.app`.

    Names of modules in strings, and imports in code that strings hold, are rewritten too.

    Raises
    ------
    ValueError
        For an import that binds the bare name of a module below (``import core.plan``).
    """
    lines = source.encode().splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line))
    content = b"".join(lines)
    edits: list[tuple[int, int, bytes]] = []
    for node in ast.walk(ast.parse(source)):
        if not hasattr(node, "lineno"):
            continue
        begin = starts[node.lineno - 1] + node.col_offset
        end = starts[node.end_lineno - 1] + node.end_col_offset
        old = content[begin:end].decode()
        new = _rewritten_node(node, old, root)
        if new != old:
            edits.append((begin, end, new.encode()))
    for begin, end, new in sorted(edits, reverse=True):
        content = content[:begin] + new + content[end:]
    return content.decode()


def _rewritten_node(node: ast.AST, old: str, root: Path) -> str:
    if isinstance(node, ast.ImportFrom) and node.level == 0:
        if str(node.module).partition(".")[0] in OWN:
            return old.replace("from ", "from vibrafeed.", 1)
    elif isinstance(node, ast.Import):
        names = [one for one in node.names if one.name.partition(".")[0] in OWN]
        if not names:
            return old
        (name,) = node.names
        if "." in name.name and name.asname is None:
            raise ValueError(f"line {node.lineno}: give '{old}' a name with 'as'")
        if "." not in name.name and name.asname is None:
            return f"from vibrafeed import {name.name}"
        return old.replace("import ", "import vibrafeed.", 1)
    elif isinstance(node, ast.Constant) and isinstance(node.value, str):
        if MODULE.fullmatch(node.value) and _is_module(node.value, root):
            return old.replace(node.value, f"vibrafeed.{node.value}", 1)
        return STATEMENT.sub(r"\1 vibrafeed.", old)
    return old


def _is_module(name: str, root: Path) -> bool:
    path = root.joinpath(*name.split("."))
    return path.with_suffix(".py").is_file() or (path / "__init__.py").is_file()
