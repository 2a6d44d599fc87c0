"""What becomes of a claim of the source, and the limits by which that is decided."""

from __future__ import annotations

from typing import NamedTuple

HOLDS = "holds"
REPRODUCED = "reproduced"
NOT_REPRODUCED = "not reproduced"
ARTEFACT = "artefact beyond lift-off"
IMPOSSIBLE = "cannot be reproduced"
VERDICTS = (HOLDS, REPRODUCED, NOT_REPRODUCED, ARTEFACT, IMPOSSIBLE)

EXACT = 1e-11  # of the largest value: rounding
EDGE = 1.0  # degree: how far the edge of a region may lie from the printed one
GOOD = 0.8  # of the largest velocity: what a good region is taken to mean
SMALL = 0.5  # likewise for a small velocity
SLIGHT = 0.01  # likewise for a slight change
BEST = 0.25  # of all values: what high, or low, all over a region is taken to mean


class Judgement(NamedTuple):
    """A claim of the source, what became of it, and the numbers behind the verdict."""

    claim: str
    verdict: str
    evidence: str
