"""The JSON Schema of studies, which takes seconds to make, kept with the user."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
import sys
from importlib.metadata import version

from vibrafeed.app.folders import cache_folder
from vibrafeed.core.code_version import digest
from vibrafeed.core.dataset.files import whole

KEPT = 8  # texts that stay, the last written: a branch or two


def study_schema_text() -> str:
    """Return the JSON Schema of studies as text, a key a line.

    It is made if the user's cache folder does not have it for these sources.
    """
    folder = cache_folder()
    path = folder / f"schema-{_digest()}.json"
    with contextlib.suppress(OSError):
        return path.read_text(encoding="utf-8")
    from vibrafeed.core.schema import study_schema  # here, since it loads half of core

    text = json.dumps(study_schema(), indent=0)
    with contextlib.suppress(OSError):  # a folder that cannot be written: made each time
        folder.mkdir(parents=True, exist_ok=True)
        with whole(path) as temporary:
            temporary.write_text(text, encoding="utf-8")
        texts = sorted(folder.glob("schema-*.json"), key=os.path.getmtime, reverse=True)
        for old in texts[KEPT:]:
            old.unlink(missing_ok=True)
    return text


@functools.cache
def _digest() -> str:
    """Return a digest of the sources and of what runs them, 16 hexadecimal digits."""
    words = f"{sys.version} {version('pydantic')} {digest()}"
    return hashlib.sha256(words.encode()).hexdigest()[:16]
