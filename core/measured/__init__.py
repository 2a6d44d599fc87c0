"""Drives that have been measured: from the CSV of an accelerometer to the harmonics of a drive."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = [
    "Clock",
    "Fault",
    "Fit",
    "Fold",
    "Recording",
    "RecordingColumn",
    "RecordingTable",
    "Signal",
    "Tilt",
    "fit_drive",
    "fit_signal",
    "read_signal",
    "read_table",
]

if TYPE_CHECKING:
    from vibrafeed.core.measured.drive import Clock, Fit, Fold, Tilt
    from vibrafeed.core.measured.fit import fit_drive, fit_signal
    from vibrafeed.core.measured.read import Fault, RecordingColumn, RecordingTable, read_table
    from vibrafeed.core.measured.recording import Recording, Signal, read_signal
else:
    __getattr__ = lazily(
        __name__,
        {
            "drive": (
                "Clock",
                "Fit",
                "Fold",
                "Tilt",
            ),
            "fit": (
                "fit_drive",
                "fit_signal",
            ),
            "read": (
                "RecordingColumn",
                "Fault",
                "RecordingTable",
                "read_table",
            ),
            "recording": (
                "Recording",
                "Signal",
                "read_signal",
            ),
        },
    )
