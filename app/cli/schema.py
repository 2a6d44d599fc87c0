"""`vibrafeed schema`: the JSON Schema of studies."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import sys
from importlib.metadata import version
from pathlib import Path

import typer

import core
from app.folders import cache_folder
from core.dataset.files import whole

SOURCES = Path(core.__file__).parent
KEPT = 8  # texts of other sources that stay, the last written: a branch or two


def schema() -> None:
    """Print the JSON Schema of studies, for editors.

    Models of every kind make it, which takes a second; the text is kept with the user until a
    source changes.
    """
    folder = cache_folder()
    path = folder / f"schema-{_digest()}.json"
    try:
        text = path.read_text(encoding="utf-8")
    except OSError:
        # Here, since it loads half of core.
        from core.schema import study_schema

        text = json.dumps(study_schema(), indent=0)
        with contextlib.suppress(OSError):  # a folder that cannot be written: made each time
            folder.mkdir(parents=True, exist_ok=True)
            with whole(path) as temporary:
                temporary.write_text(text, encoding="utf-8")
            texts = sorted(folder.glob("schema-*.json"), key=os.path.getmtime, reverse=True)
            for old in texts[KEPT:]:
                old.unlink(missing_ok=True)
    typer.echo(text)


def _digest() -> str:
    """Return a digest of everything that the JSON Schema depends on, 16 hexadecimal digits.

    It names the cached schema: program sources, and the versions of Python and pydantic.
    """
    content = hashlib.sha256(f"{sys.version} {version('pydantic')}".encode())
    for path in sorted(SOURCES.rglob("*.py")):
        content.update(f"\n{path.relative_to(SOURCES).as_posix()}\n".encode())
        content.update(hashlib.sha256(path.read_bytes()).digest())
    return content.hexdigest()[:16]
