"""Lines of equal value, and several datasets in one picture."""

from __future__ import annotations

import numpy as np
import pytest
import xarray

import vibrafeed
from layout import judge
from pictures import legend, problem
from vibrafeed.core.plots.drawing import draw

DRIVE = {"scene": "rectangle-on-plane", "frequency": 50, "beta": 25, "gamma": 2}


def speeds(friction: float, **changes: object) -> xarray.Dataset:
    asked = {**DRIVE, "amplitude": np.linspace(1e-5, 9e-4, 90), "friction": friction, **changes}
    return vibrafeed.simulate(outputs=["conveying_velocity", "period_multiple"], **asked)


@pytest.fixture(scope="module")
def dry() -> xarray.Dataset:
    return speeds(0.3)


@pytest.fixture(scope="module")
def oiled() -> xarray.Dataset:
    return speeds(0.12)


class TestLevels:
    def test_backward_travel_is_hatched_and_named(self):
        motion = vibrafeed.simulate(
            scene="rectangle-on-plane", frequency=50, gamma=2, friction=0.3,
            amplitude=np.linspace(1e-4, 4e-4, 9), beta=np.linspace(5, 45, 9),
        )  # fmt: skip
        figure = draw(motion, kind="levels")
        assert "backward" in legend(figure)
        assert any(entry.startswith("hopping, ") for entry in legend(figure))
        forward = motion.isel(beta=slice(5, None))
        assert forward.conveying_velocity.min() > 0
        assert "backward" not in legend(draw(forward, kind="levels"))

    def test_two_axes_are_needed(self, dry: xarray.Dataset):
        assert "kind levels needs two axes" in str(problem(dry, kind="levels"))


class TestTogether:
    def test_lines_are_named_by_what_differs(self, dry: xarray.Dataset, oiled: xarray.Dataset):
        figure = draw([dry, oiled])
        assert legend(figure) == ["friction 0.3", "friction 0.12"]
        for dataset in (dry, oiled):
            speed = 1000 * dataset.conveying_velocity.values
            assert any(np.array_equal(line.get_ydata(), speed) for line in figure.axes[0].lines)
        judge(figure)

    def test_equal_ones_are_named_by_their_files(self, dry: xarray.Dataset):
        again = dry.copy()
        again.encoding["source"] = "folder/again.nc"
        assert legend(draw([dry, again], variable="period_multiple"))[1] == "again.nc"

    def test_what_they_do_not_share_is_said(self, dry: xarray.Dataset):
        other = vibrafeed.sweep(
            scene="rectangle-on-plane", outputs=["acceleration_x"], frequency=[40, 50],
            amplitude=1e-4, beta=30, friction=0.3,
        )  # fmt: skip
        other.encoding["source"] = "closed.nc"
        told = str(problem([dry, other]))
        assert "the result files have no output in common" in told
        assert "closed.nc has acceleration_x" in told
        elsewhere = vibrafeed.simulate(**{**DRIVE, "beta": [20, 30]}, amplitude=3e-4, friction=0.3)
        assert "has no axis in common" in str(problem([dry, elsewhere]))
        assert problem([dry, dry], kind="map").place == "kind"
        assert problem([dry, dry], variable="flight_share").place == "variable"
        assert problem([dry] * 8).place == "dataset"
        assert problem([]).place == "dataset"
