"""Compilation of the kernels: numba, cached on disk where a folder can be written."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """Return the function compiled for scalars and arrays; it releases the interpreter's lock.

    Kernels stay sequential: a pool of threads shares out the cells, so that two requests of one
    process can run at a time, a batch can be stopped between pieces, and results do not depend on
    the number of threads.
    """
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
    try:
        return numba.njit(cache=True, **options)(function)
    except RuntimeError:  # no folder for the cache can be written: compile once a process
        return numba.njit(**options)(function)
