"""The command that installs a missing package: in a clone, or elsewhere."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
"""Where the program lies: a clone of the repository, or the packages of an environment."""


def installing(package: str, extra: str | None = None) -> str:
    """Return the command that installs a package, alone or with an extra of vibrafeed.

    In a clone the command is to be typed in its folder, and keeps to the versions that the tests
    pass with. Elsewhere it names the package itself: no index need know vibrafeed.

    Parameters
    ----------
    package : str
        Name of the package on the index.
    extra : str, optional
        The extra of vibrafeed that needs the package; by default vibrafeed itself does.
    """
    if not (ROOT / "constraints.txt").is_file():
        return f"pip install {package}"
    pip = ".venv/bin/pip" if Path(sys.prefix) == ROOT / ".venv" else "pip"
    which = f"'.[{extra}]'" if extra else "."
    return f"{pip} install --constraint constraints.txt -e {which}"
