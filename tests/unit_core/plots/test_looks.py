"""Looks of regimes: every one has its own, and they are told apart."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from core.motion.systems import SYSTEMS
from core.plots.regimes import FILLS, LOOKS
from core.quantities import REGIMES
from core.scenes import SCENES


def test_every_regime_has_a_look():
    assert LOOKS.keys() == REGIMES.keys()
    assert FILLS.keys() == {name for name, regime in REGIMES.items() if regime.valid}


@pytest.mark.parametrize(
    ("scene", "variant"),
    [
        (scene, variant)
        for scene in (*SCENES.values(), *SYSTEMS.values())
        for variant in scene.conditions
    ],
    ids=lambda part: getattr(part, "name", part),
)
def test_regimes_of_a_scene_look_different_on_a_map(scene, variant: str):
    conditions = scene.conditions[variant]
    names = {condition.regime for condition in conditions}
    names |= {condition.otherwise for condition in conditions if condition.otherwise}
    fills = [FILLS[name] for name in names if REGIMES[name].valid]
    assert len(set(fills)) == len(fills)
    hatches = [LOOKS[name][:2] for name in names if not REGIMES[name].valid]
    assert len(set(hatches)) == len(hatches)


# How a colour in linear RGB is seen: G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, IEEE Trans.
# Vis. Comput. Graph. 15 (2009) 1291, table 1, severity 1.
SIGHT = {
    "full": np.eye(3),
    "without red": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "without green": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "without blue": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def lab(colour: str, sight: object) -> np.ndarray:
    """Return CIE L*a*b* of a colour as it is seen, white point D65."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    seen = np.clip(np.asarray(sight) @ linear, 0, 1)
    x, y, z = np.cbrt(np.maximum(TO_XYZ @ seen / TO_XYZ.sum(axis=1), 0.008856))
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("sight", SIGHT)
def test_fills_of_motion_are_told_apart_in_every_colour_vision(sight: str):
    # A difference of 2.3 is just seen on neighbouring patches, 10 at a glance.
    names = {condition.regime for condition in SYSTEMS["rectangle-on-plane"].conditions["events"]}
    fills = [FILLS[name] for name in (*names, "slip") if name in FILLS]
    assert len(fills) == 8
    for one, other in itertools.combinations(fills, 2):
        assert np.linalg.norm(lab(one, SIGHT[sight]) - lab(other, SIGHT[sight])) > 10
