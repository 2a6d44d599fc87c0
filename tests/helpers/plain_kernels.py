"""Kernels as plain Python, for tests of what they compute: nothing is compiled."""

import sys
from types import FunctionType
from typing import Any

from vibrafeed.core.compiled import Choice


def plain(module: Any, known: dict[str, dict[str, Any]] | None = None) -> dict[str, Any]:
    """Return the names of a module of kernels, each function and all that it calls in Python.

    Of functions that there are for each kind of drive, those of a sine.
    """
    known = {} if known is None else known
    if module.__name__ in known:
        return known[module.__name__]
    names = known[module.__name__] = dict(vars(module))
    for name, function in vars(module).items():
        if isinstance(function, Choice):
            function = next(iter(vars(function)["_ways"].values()))  # a sine comes first
        if hasattr(function, "py_func"):
            function = function.py_func
            home = plain(sys.modules[function.__module__], known)
            names[name] = FunctionType(function.__code__, home, name, function.__defaults__)
    return names
