"""Arrows over a plate."""

import numpy as np
import pytest
from matplotlib.quiver import Quiver
from matplotlib.text import Text

import vibrafeed
from vibrafeed.core.plots.pictures import PlotError


@pytest.fixture(scope="module")
def wobble():
    """Return a plate that circles and tilts in a circle: it carries parts to its middle."""
    places = {"start": "-60 mm", "stop": "60 mm", "num": 4}
    return vibrafeed.simulate(
        scene="part-on-plate", outputs=["velocity_x", "velocity_y"], frequency=50, friction=0.3,
        amplitude_along_1="0.1 mm", phase_along_1=90, amplitude_across_1="0.1 mm",
        amplitude_tilt_y_1="0.03 deg", phase_tilt_y_1=90, amplitude_tilt_x_1="0.03 deg",
        phase_tilt_x_1=180, position_x=places, position_y=places,
    )  # fmt: skip


def test_the_field_of_a_plate_is_drawn_by_itself(wobble):
    figure = vibrafeed.plot(wobble, units="mm/s")
    (arrows,) = (one for one in figure.axes[0].collections if isinstance(one, Quiver))
    x, y = wobble.velocity_x.values.T, wobble.velocity_y.values.T
    assert np.ravel(arrows.U) == pytest.approx(1e3 * np.ravel(x))
    assert np.ravel(arrows.V) == pytest.approx(1e3 * np.ravel(y))
    assert np.asarray(arrows.get_array()) == pytest.approx(1e3 * np.hypot(np.ravel(x), np.ravel(y)))


def test_it_says_that_parts_are_centred(wobble):
    inward = -(wobble.velocity_x * wobble.position_x + wobble.velocity_y * wobble.position_y)
    says = "centres" if (inward > 0).all() else "spreads"
    texts = [text.get_text() for text in vibrafeed.plot(wobble).findobj(Text)]
    assert any(f"{says} parts: divergence" in text for text in texts), texts


def test_a_result_without_both_components_is_refused(wobble):
    with pytest.raises(PlotError, match="velocity_y is missing"):
        vibrafeed.plot(wobble.drop_vars("velocity_y"), kind="field")
