"""Elliptical drives by semi-axes, tilt and sense: the harmonics that they are, and refusals."""

from __future__ import annotations

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content

HEAD = {"scene": "rectangle-on-plane", "friction": 0.3, "frequency": 50}


@pytest.mark.parametrize(("minor", "tilt"), [(1e-4, 15), (-1e-4, 15), (5e-5, -40), (0.0, 20)])
def test_an_ellipse_is_its_harmonics(minor, tilt):
    turned = 3e-4 * np.exp(1j * np.radians(tilt)), minor * np.exp(1j * np.radians(tilt - 90.0))
    times = np.arange(8) * np.pi / 4.0
    way = turned[0] * np.sin(times) + turned[1] * np.cos(times)  # along + i normal
    along, normal = (2j * np.mean(one * np.exp(-1j * times)) for one in (way.real, way.imag))
    harmonics = {
        "amplitude_along_1": abs(along), "phase_along_1": np.degrees(np.angle(along)),
        "amplitude_normal_1": abs(normal), "phase_normal_1": np.degrees(np.angle(normal)),
    }  # fmt: skip
    ellipse = {"ellipse_major": 3e-4, "ellipse_minor": minor, "ellipse_tilt": tilt}
    speeds = [vibrafeed.simulate(**HEAD, **one).conveying_velocity for one in (ellipse, harmonics)]
    assert float(speeds[0]) == pytest.approx(float(speeds[1]), rel=1e-9)


def test_a_positive_sense_conveys_forward_and_semi_axes_can_be_ranged():
    found = vibrafeed.simulate(
        **HEAD, ellipse_major="0.3 mm", ellipse_minor=["0.08 mm", "-0.08 mm"], ellipse_tilt=0
    ).conveying_velocity
    assert found[0] > 0.03
    np.testing.assert_allclose(found[0], -found[1], rtol=1e-9)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"amplitude": 1e-4}, "amplitude belongs to the plain sine, but the study also gives an"),
        ({"amplitude_along_1": 1e-4}, "ellipse_major belongs to an ellipse, but the study also"),
        ({"acceleration_along_1": 1}, "ellipse_major belongs to an ellipse, but the study also"),
        ({}, "parameters.ellipse_tilt: it is missing"),
    ],
)
def test_an_ellipse_stands_alone_and_is_whole(more, words):
    content = {
        "kind": "simulate", "scene": "rectangle-on-plane", "outputs": ["conveying_velocity"],
        "parameters": {"friction": 0.3, "frequency": 50, "ellipse_major": 3e-4,
                       "ellipse_minor": 1e-4, **more},
    }  # fmt: skip
    with pytest.raises(StudyError) as caught:
        prepare_content(content)
    assert words in str(caught.value)
