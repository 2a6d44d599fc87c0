"""What a long computation asks while it runs."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Watch:
    """What a long computation asks while it runs: whether to stop, and whom to tell how far it is.

    Attributes
    ----------
    progress : callable, optional
        Called with the share of the cells done since the last call; from any thread, one at a time.
    stop : callable, optional
        Returns True if no further cell is to be started.
    deadline : float, optional
        The `time.monotonic` at which no further cell is started.
    threads : int, optional
        Most threads among which cells are shared out; one a core if left out.
    """

    progress: Callable[[float], object] | None = None
    stop: Callable[[], bool] | None = None
    deadline: float | None = None
    threads: int | None = None

    def stopped(self) -> bool:
        """Return whether no further cell is to be started."""
        late = self.deadline is not None and time.monotonic() >= self.deadline
        return late or (self.stop is not None and self.stop())

    def advance(self, share: float) -> None:
        """Tell that a share of the cells is done."""
        if self.progress is not None:
            self.progress(share)

    def part(self, share: float) -> Watch:
        """Return a watch over a share of the work."""
        return replace(self, progress=lambda done: self.advance(done * share))
