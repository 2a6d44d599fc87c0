"""The watch of a long computation: progress, and whether to stop.

Python asks its watch. Compiled code cannot: it looks at a flag, which one thread of the process,
the lookout, raises for whatever runs and is to stop. That costs a cell nothing, however short.
"""

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.errors import StoppedError

LOOK = 0.05
"""Seconds between two looks of the lookout."""


@dataclass(frozen=True)
class Watch:
    """The watch over a long computation: it says whether to stop, and takes its progress.

    `progress` is called with the share of the cells done since the last call, from any thread, one
    at a time; no cell is started once `stop` returns True, or at the `deadline` of
    `time.monotonic`. Cells are shared out among `threads` at most, one a core if left out.
    """

    progress: Callable[[float], object] | None = None
    stop: Callable[[], bool] | None = None
    deadline: float | None = None
    threads: int | None = None

    def stopped(self) -> bool:
        """True if no further cell may be started."""
        late = self.deadline is not None and time.monotonic() >= self.deadline
        return late or (self.stop is not None and self.stop())

    def check(self) -> None:
        """Raise `StoppedError` if the computation is to stop."""
        if self.stopped():
            raise StoppedError(
                "the computation was stopped, and the cell in progress was discarded; run it again"
            )

    @contextlib.contextmanager
    def flag(self) -> Iterator[NDArray[np.int8]]:
        """Yield a one-element array for compiled code, which becomes nonzero when it is to stop.

        A thread of the process looks every 50 ms, while the block runs.
        """
        flag = np.zeros(1, dtype=np.int8)
        if self.stop is None and self.deadline is None:
            yield flag
            return
        _lookout.begin(self, flag)
        try:
            yield flag
        finally:
            _lookout.end(flag)

    def advance(self, share: float) -> None:
        """Report that a share of the cells is done."""
        if self.progress is not None:
            self.progress(share)

    def part(self, share: float) -> "Watch":
        """Return a watch over a share of the work, 0 to 1, which scales its reported progress."""
        return replace(self, progress=lambda done: self.advance(done * share))


class _Lookout:
    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._watched: dict[int, tuple[Watch, NDArray[np.int8]]] = {}
        self._thread: threading.Thread | None = None

    def begin(self, watch: Watch, flag: NDArray[np.int8]) -> None:
        with self._changed:
            self._watched[id(flag)] = watch, flag
            if self._thread is None or not self._thread.is_alive():
                self._thread = threading.Thread(target=self._look, name="lookout", daemon=True)
                self._thread.start()
            elif len(self._watched) == 1:
                self._changed.notify()

    def end(self, flag: NDArray[np.int8]) -> None:
        with self._changed:
            del self._watched[id(flag)]

    def _look(self) -> None:
        while True:
            with self._changed:
                while not self._watched:
                    self._changed.wait()
                watched = [*self._watched.values()]
            for watch, flag in watched:
                try:
                    flag[0] = watch.stopped()
                except Exception:  # raised again by the threads that compute
                    flag[0] = True
            time.sleep(LOOK)


_lookout = _Lookout()
