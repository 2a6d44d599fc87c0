"""Drives that have been measured: from the recording of a sensor to the harmonics of a drive."""

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = [
    "Clock",
    "Fit",
    "Fold",
    "Recording",
    "RingDown",
    "Signal",
    "Tilt",
    "fit_drive",
    "fit_ring_down",
    "fit_signal",
    "moving_mass",
    "read_once",
    "read_signal",
]

if TYPE_CHECKING:
    from vibrafeed.core.measured.fit import Clock, Fit, Fold, Tilt, fit_drive, fit_signal
    from vibrafeed.core.measured.recording import Recording, Signal, read_once, read_signal
    from vibrafeed.core.measured.ring_down import RingDown, fit_ring_down, moving_mass
else:
    __getattr__ = lazily(
        __name__,
        {
            "fit": ("Clock", "Fit", "Fold", "Tilt", "fit_drive", "fit_signal"),
            "recording": ("Recording", "Signal", "read_once", "read_signal"),
            "ring_down": ("RingDown", "fit_ring_down", "moving_mass"),
        },
    )
