"""The time that this process has spent compiling; loads no compiler."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager


class Stopwatch:
    """Runs while something is compiled; the compiler compiles one thing at a time, and its parts.

    `spent` is the time that compiling has taken so far [s].
    """

    def __init__(self) -> None:
        self.spent = 0.0
        self._depth = 0
        self._began = 0.0
        self._listeners: list[Callable[[bool], object]] = []

    def begin(self) -> None:
        """Note that a compilation has begun, perhaps within another one, of which nobody hears."""
        self._depth += 1
        if self._depth == 1:
            self._began = time.perf_counter()
            self._tell(True)

    def end(self) -> None:
        """Note that the compilation that began last has ended."""
        self._depth -= 1
        if not self._depth:
            self.spent += time.perf_counter() - self._began
            self._tell(False)

    @property
    def is_running(self) -> bool:
        """True while something is being compiled."""
        return self._depth > 0

    @contextmanager
    def telling(self, listener: Callable[[bool], object]) -> Iterator[None]:
        """Call a function within the block whenever compiling begins (True) or ends (False)."""
        self._listeners.append(listener)
        try:
            yield
        finally:
            self._listeners.remove(listener)

    def _tell(self, compiles: bool) -> None:
        for listener in tuple(self._listeners):
            listener(compiles)


stopwatch = Stopwatch()
"""That of this process."""

ONCE = "compiling once, some seconds; it is kept"
"""The message to a waiting user; docs/performance.md has the seconds."""


@contextmanager
def announced(write: Callable[[str], object]) -> Iterator[None]:
    """Call `write` with a message the first time that the block compiles something."""
    messages_left = [ONCE]

    def on_change(compiles: bool) -> None:
        if compiles and messages_left:
            write(messages_left.pop())

    with stopwatch.telling(on_change):
        yield
