"""Kernels compiled before anybody waits for them: when an image is built, or a service starts.

Each package of kernels has studies that need all of it, first what the first study of a user needs.

`python -m vibrafeed.core.warm` does it; the code is kept in NUMBA_CACHE_DIR, or among the user's
caches.
"""

import argparse
import multiprocessing
import os
import sys
import time
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import KINDS, tabulate
from vibrafeed.core.system import end_with_parent

STUDIES: dict[str, tuple[Mapping[str, Any], ...]] = {
    package: studies for kind in KINDS.values() for package, studies in kind.compiles.items()
}
"""Studies that need all kernels, by package; those of all kinds."""


def compile_kernels(processes: int) -> Path | None:
    """Compile all compiled code that is not in the cache for this processor; return its folder.

    It is done by running studies, in this process or in several others; None if no folder can be
    written.
    """
    from vibrafeed.core import kernel_cache  # numba is loaded with it

    marks: dict[str, Path | None] = {package: kernel_cache.mark_of(package) for package in STUDIES}
    to_compile = {
        package: mark for package, mark in marks.items() if mark is None or not mark.exists()
    }
    for mark in to_compile.values():
        # An image may have a folder that is read-only, for another processor.
        if mark is None or not os.access(mark.parent, os.W_OK):
            return None
    study_slices = (slice(1), slice(1, None))  # the first study of each package, then the others
    if processes == 1:
        for study_slice in study_slices:
            for package in to_compile:
                carry_out(package, study_slice)
    elif to_compile:
        spawn = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(min(processes, len(to_compile)), spawn, end_with_parent) as pool:
            for study_slice in study_slices:
                list(pool.map(carry_out, to_compile, len(to_compile) * [study_slice]))
    for mark in to_compile.values():
        assert mark is not None
        mark.touch()
    return Path(kernel_cache.root())


def carry_out(package: str, part: slice = slice(None)) -> None:
    """Run studies that use all kernels of a package, or some of them, which compiles them."""
    for study in STUDIES[package][part]:
        tabulate(prepare_content(study))


def main() -> int:
    """Compile everything for this processor; return the exit code of the program."""
    parser = argparse.ArgumentParser(
        "python -m vibrafeed.core.warm", description="Compile the simulation code."
    )
    parser.add_argument(
        "--processes", type=int, default=os.cpu_count() or 1,
        help="largest number of processes that compile at a time",
    )  # fmt: skip
    processes = parser.parse_args().processes
    started = time.perf_counter()
    folder = compile_kernels(max(1, processes))
    if folder is None:
        sys.stderr.write(
            "Compiled code cannot be kept: no folder can be written. "
            "Set NUMBA_CACHE_DIR to one that can.\n"
        )
        return 1
    seconds = time.perf_counter() - started
    sys.stdout.write(f"All code is compiled, and stored in {folder}: {seconds:.1f} s.\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
