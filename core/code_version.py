"""The version of the code that computes: of vibrafeed, and a digest of its sources."""

import functools
import hashlib
from pathlib import Path

from vibrafeed import core

CORE = Path(__file__).resolve().parent

WITHOUT_NUMBERS = (
    "catalogue.py", "compiling.py", "kernel_cache.py", "plots", "schema.py", "suggestions.py",
    "warm.py",
)  # fmt: skip
"""Files and folders that no number of a result depends on."""


def code_version() -> str:
    """Return the version of vibrafeed and a digest of the sources that compute: `0.1.0+1f2e3d4c`.

    It is the same on every system.
    """
    return f"{core.__version__}+{digest(WITHOUT_NUMBERS)[:8]}"


@functools.cache
def digest(left_out: tuple[str, ...] = ()) -> str:
    """Return a digest of the sources of core, 64 hexadecimal digits.

    `left_out` are files and folders that do not count. It is the same on every system.
    """
    content = hashlib.sha256()
    files = (file for suffix in ("py", "toml") for file in CORE.rglob(f"*.{suffix}"))
    for name, file in sorted((file.relative_to(CORE).as_posix(), file) for file in files):
        if name.partition("/")[0] not in left_out:
            source = file.read_bytes().replace(b"\r\n", b"\n")  # a checkout on Windows has both
            content.update(f"{name} {len(source)}\n".encode() + source)
    return content.hexdigest()
