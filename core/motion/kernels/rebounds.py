"""When a run of shrinking rebounds is taken to end, in all kernels that count them: theory 13.5."""

from __future__ import annotations

SETTLED_EXACTLY = 1e-13  # rebound times remaining time, below which a run of shrinking hops ends
SETTLED_TIME = 1e-3  # its remaining time, as a share of the time to lift-off
