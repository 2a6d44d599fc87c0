"""The command that installs what is missing: in a clone, or elsewhere."""

from __future__ import annotations

import re
import sys
from importlib.metadata import PackageNotFoundError, requires
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
"""Where the program lies: a clone of the repository, or the packages of an environment."""

ON_WINDOWS = sys.platform == "win32"


def installing(package: str = "", extra: str | None = None) -> str:
    """Return the command that installs a package, alone or with an extra of vibrafeed.

    In a clone the command is to be typed in its folder, and keeps to the versions that the tests
    pass with. Elsewhere it names the package itself: no index need know vibrafeed.

    Parameters
    ----------
    package : str
        Name of the package on the index; empty for all of the extra.
    extra : str, optional
        The extra of vibrafeed that needs the package; by default vibrafeed itself does.
    """
    if not (ROOT / "constraints.txt").is_file():
        return f"pip install {package or ' '.join(_packages(extra))}"
    pip = "pip"
    if Path(sys.prefix) == ROOT / ".venv":
        pip = r".venv\Scripts\pip" if ON_WINDOWS else ".venv/bin/pip"
    which = f"'.[{extra}]'" if extra else "."
    if ON_WINDOWS:
        which = which.strip("'")  # cmd.exe would keep the quotes
    return f"{pip} install --constraint constraints.txt -e {which}"


def _packages(extra: str | None) -> list[str]:
    try:
        declared = requires("vibrafeed") or []
    except PackageNotFoundError:
        return []
    mark = re.compile(rf"""extra == ['"]{extra}['"]""")
    return [
        found[0] for one in declared if mark.search(one) and (found := re.match(r"[\w.-]+", one))
    ]
