"""Rebounds that lose little: the fastest landing by the highest hop. Equal cells are one cell."""

from __future__ import annotations

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.motion import kernel_calls
from vibrafeed.core.quantities import MOTION_STATUSES


@pytest.mark.parametrize("restitution", [0.999, 1.0])
def test_the_fastest_landing_is_the_free_fall_of_the_highest_hop(restitution):
    """sqrt(2 g (H +- 2a)) +- a w, a the amplitude normal to the track, whatever the run of hops."""
    g, w, turn = 9.80665, 2 * np.pi * 50, np.radians(30)
    amplitude = 2.0 * g / (w * w * np.sin(turn))
    found = vibrafeed.simulate(
        scene="rectangle-on-plane", frequency=50, friction=0.5, beta=30, gravity=g,
        amplitude=amplitude, restitution=restitution, outputs=["landing_speed", "hop_height"],
    )  # fmt: skip
    height, a = float(found.hop_height), amplitude * np.sin(turn)
    least, most = (np.sqrt(2 * g * (height + 2 * way * a)) + way * a * w for way in (-1, 1))
    assert int(found.motion_status) == MOTION_STATUSES["aperiodic"].value
    assert least <= float(found.landing_speed) <= most


def test_equal_cells_are_followed_once(monkeypatch):
    computed = []
    different = kernel_calls._different

    def watched(groups):
        rows, where = different(groups)
        computed.append((groups.shape[0], rows.shape[0]))
        return rows, where

    monkeypatch.setattr(kernel_calls, "_different", watched)
    # A0 w^2 is that of (50 Hz, A0) and of (100 Hz, A0/4): one motion.
    vibrafeed.simulate(
        scene="rectangle-on-plane", frequency=[50, 100], amplitude=[0.4e-4, 1.6e-4], beta=30,
        friction=0.5,
    )  # fmt: skip
    assert computed == [(4, 3)]
