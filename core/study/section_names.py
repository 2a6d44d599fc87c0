"""Names and sizes in sections of a study, known before the model of its kind is loaded."""

from __future__ import annotations

from typing import Final

CRITERIA: Final = ("weighted", "limit", "pareto", "maximise", "minimise")
"""The kinds of criterion of an optimisation."""

DRIVE_ANGLES: Final = ("alpha", "beta")
"""The variables of an optimisation that names none."""

OBSERVED: Final = ("conveying_velocity", "feed_rate")
"""Outputs that may have been measured."""

MAX_RUNS: Final = 1_000
"""Runs of a study that has observations."""
