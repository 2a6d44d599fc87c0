"""Finds the packages `core` and `app` of a clone, whatever else has these names.

They are folders at the top of the repository. Installed from a wheel they are `vibrafeed.core` and
`vibrafeed.app`, and nothing has to be found. A clone, and an editable install of it, has them under
their own names, and an environment may hold another `core`, as may the folder that one works in.
docs/decisions/2026-11-22-one-name-to-import.md says what else was tried.
"""

from __future__ import annotations

import os
import sys
from importlib.machinery import PathFinder

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType

_HERE = __file__.rpartition(os.sep)[0]
_SEARCH_PATH = [_HERE.rpartition(os.sep)[0]]
_IS_INSTALLED = os.path.isdir(os.path.join(_HERE, "core"))  # noqa: PTH112, PTH118 - pathlib is dear


class ForeignPackageError(ImportError):
    """Another package has the name of one of vibrafeed's own, and was imported before it."""


class _Finder:
    """Finds the claimed packages where vibrafeed has them, and nothing else.

    It is asked first. What is not claimed is none of its business: a program whose own package is
    called `app` may import vibrafeed, which needs its own only for the command line and service.
    """

    def __init__(self) -> None:
        self.claimed: set[str] = set()

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec of a claimed package or a module of it; None for all others."""
        if name in ("vibrafeed.core", "vibrafeed.app"):  # there would be two of everything
            own = name.rpartition(".")[2]
            raise ModuleNotFoundError(f"No module named '{name}': its name is '{own}'", name=name)
        package = name.partition(".")[0]
        if package not in self.claimed:
            return None
        spec = PathFinder.find_spec(name, _SEARCH_PATH if name == package else path, target)
        if spec is None:
            message = f"No module named '{name}': in this process '{package}' is vibrafeed's own"
            raise ModuleNotFoundError(message, name=name)
        return spec


_FINDER = _Finder()


def claim(*packages: str) -> None:
    """Let imports of these packages find those of the clone, from now on.

    Installed from a wheel vibrafeed needs no such thing, and claims nothing.

    Raises
    ------
    ForeignPackageError
        If another package of that name is imported already.
    """
    if _IS_INSTALLED:
        return
    for package in packages:
        imported = sys.modules.get(package)
        if imported is not None and not _is_ours(imported):
            where = getattr(imported, "__file__", None) or "a folder without __init__.py"
            raise ForeignPackageError(
                f"vibrafeed has a package '{package}' of its own, but another one, {where}, is "
                "imported in this process already: use vibrafeed in a process of its own, or give "
                "the other package another name.",
                name=package,
            )
    _FINDER.claimed.update(packages)
    if _FINDER not in sys.meta_path:
        sys.meta_path.insert(0, _FINDER)


def load(name: str) -> ModuleType:
    """Return a module of vibrafeed by its name in the repository, such as `app.jobs.work`.

    Workers of a cluster use it, where other packages may be called `app` and `core`.
    """
    from importlib import import_module

    claim("core", "app")
    return import_module(f"vibrafeed.{name}" if _IS_INSTALLED else name)


def _is_ours(imported: ModuleType) -> bool:
    """True if an imported package is the one of this clone."""
    own = PathFinder.find_spec(imported.__name__, _SEARCH_PATH)
    file = getattr(imported, "__file__", None)
    if own is None or own.origin is None or file is None:
        return False
    if file == own.origin:
        return True
    from pathlib import Path  # costs more than all the rest here, and is hardly ever needed

    return Path(file).samefile(own.origin)
