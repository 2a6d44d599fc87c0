"""Texts that take seconds to make from the sources, kept with the user until a source changes."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
import sys
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

from vibrafeed import core
from vibrafeed.app.folders import cache_folder
from vibrafeed.core.dataset.files import whole

SOURCES = (Path(core.__file__).parent, Path(__file__).parent)
KEPT = 8  # texts of a name that stay, the last written: a branch or two


def study_schema_text() -> str:
    """Return the JSON Schema of studies as text, a key a line."""

    def make() -> str:
        """Return it from the models of every kind."""
        from vibrafeed.core.schema import study_schema  # here, since it loads half of core

        return json.dumps(study_schema(), indent=0)

    return kept_text("schema", make)


def kept_text(name: str, make: Callable[[], str]) -> str:
    """Return a text, made if the user's cache folder does not have it for these sources.

    Parameters
    ----------
    name : str
        What the file in the folder is called, before a digest of the sources.
    make : callable
        Makes the text. It may depend on the program's sources, on pydantic and Python alone.
    """
    folder = cache_folder()
    path = folder / f"{name}-{_digest()}.json"
    with contextlib.suppress(OSError):
        return path.read_text(encoding="utf-8")
    text = make()
    with contextlib.suppress(OSError):  # a folder that cannot be written: made each time
        folder.mkdir(parents=True, exist_ok=True)
        with whole(path) as temporary:
            temporary.write_text(text, encoding="utf-8")
        texts = sorted(folder.glob(f"{name}-*.json"), key=os.path.getmtime, reverse=True)
        for old in texts[KEPT:]:
            old.unlink(missing_ok=True)
    return text


@functools.cache
def _digest() -> str:
    """Return a digest of the program's sources and of what runs them, 16 hexadecimal digits."""
    content = hashlib.sha256(f"{sys.version} {version('pydantic')}".encode())
    for folder in SOURCES:
        for path in sorted(folder.rglob("*.py")):
            content.update(f"\n{path.relative_to(folder.parent).as_posix()}\n".encode())
            content.update(hashlib.sha256(path.read_bytes()).digest())
    return content.hexdigest()[:16]
