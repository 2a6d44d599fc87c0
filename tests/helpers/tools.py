"""Programs that are not Python's: a test says which it needs, and is skipped where it is not there.

`VIBRAFEED_REQUIRE_TOOLS=1` turns each such skip into a failure, as CI wants it.
"""

import os
import shutil
from pathlib import Path
from typing import NoReturn

import pytest

REQUIRED = "VIBRAFEED_REQUIRE_TOOLS"


def absent(reason: str) -> NoReturn:
    """Skip, or fail where the tools must be there."""
    if os.environ.get(REQUIRED) == "1":
        pytest.fail(f"{reason}, and {REQUIRED}=1 asks for it")
    pytest.skip(reason)


def tool(*names: str | Path) -> str:
    """Return the path of the first of these programs that is there; else skip, and name it."""
    for name in names:
        path = shutil.which(name)
        if path is not None:
            return path
    absent(f"{Path(names[0]).name} is not installed")
