"""Drives that have been measured: from the CSV of an accelerometer to the harmonics of a drive."""

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = [
    "Clock",
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
    from vibrafeed.core.measured.csv_table import RecordingColumn, RecordingTable, read_table
    from vibrafeed.core.measured.fit import Clock, Fit, Fold, Tilt, fit_drive, fit_signal
    from vibrafeed.core.measured.recording import Recording, Signal, read_signal
else:
    __getattr__ = lazily(
        __name__,
        {
            "csv_table": ("RecordingColumn", "RecordingTable", "read_table"),
            "fit": ("Clock", "Fit", "Fold", "Tilt", "fit_drive", "fit_signal"),
            "recording": ("Recording", "Signal", "read_signal"),
        },
    )
