"""Thresholds, levels, parallel coordinates, and several datasets in one picture."""

from __future__ import annotations

import numpy as np
import pytest
import xarray
from matplotlib.collections import LineCollection

import vibrafeed
from layout import judge
from pictures import SPACE, legend, problem
from vibrafeed.core.plots import draw
from vibrafeed.core.plots.parallel import MAX_DESIGNS, read_designs
from vibrafeed.core.plots.thresholds import find_thresholds
from vibrafeed.core.study.shown import ShownUnits

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


@pytest.fixture(scope="module")
def designs() -> xarray.Dataset:
    return vibrafeed.simulate(
        scene="rectangle-on-plane", frequency=50, outputs=["conveying_velocity"],
        amplitude=np.linspace(1e-4, 5e-4, 11), beta=np.linspace(10, 50, 11),
        friction=np.linspace(0.1, 0.6, 10),
    )  # fmt: skip


def texts(figure: object) -> list[str]:
    return [text.get_text().replace(SPACE, " ") for text in figure.axes[0].texts]


class TestThresholds:
    def test_each_kind_is_told_once_where_it_comes_first(self):
        states = ["stick", "stick", "slip", "hopping", "slip", "hopping", "period_doubled"]
        found, left = find_thresholds(
            np.arange(7.0), np.array([0, 0, 1, 2, -1, 3, 2.0]), states, None, "mm/s"
        )
        assert [(each.position, each.says.replace(SPACE, " ")) for each in found] == [
            (1.5, "starts to move"),
            (2.5, "lifts off"),
            (3.5, "stays on the track"),
            (3 + 2 / 3, "turns backward"),
            (5.0, "best, 3 mm/s"),
            (5.5, "period doubles"),
        ]
        assert left == 1

    def test_a_further_doubling_is_no_change_of_regime(self):
        states = ["hopping", "period_doubled", "period_doubled", "aperiodic"]
        found, _ = find_thresholds(
            np.arange(4.0), np.full(4, np.nan), states, np.array([1, 2, 4, 0.0]), "mm/s"
        )
        told = [threshold.says for threshold in found]
        assert told == ["period doubles", "repeats after 4 periods", "stops repeating"]

    def test_lift_off_stands_where_the_throw_number_reaches_one(self, dry: xarray.Dataset):
        figure = draw(dry, kind="thresholds")
        told = dict(text.rsplit(" ", 2)[:2] for text in texts(figure) if "best" not in text)
        track = 9.80665 * np.cos(np.deg2rad(2))
        lift = 1e3 * track / ((2 * np.pi * 50) ** 2 * np.sin(np.deg2rad(25)))
        assert float(told["lifts off"]) == pytest.approx(lift, abs=0.01)
        assert float(told["starts to move"]) < float(told["lifts off"])
        judge(figure)

    def test_values_are_in_the_units_that_are_asked_for(self, dry: xarray.Dataset):
        told = texts(draw(dry, kind="thresholds", units="m/min,m"))
        best = next(text for text in told if text.startswith("best"))
        assert best.startswith("best, 12.4 m/min at 0.00")

    def test_one_axis_only(self, dry: xarray.Dataset):
        told = problem(dry, kind="thresholds", axes=("amplitude", "beta"))
        assert told.place == "axes"
        assert problem(dry, kind="thresholds", variable="period_multiple").place == "variable"


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


class TestParallel:
    def test_a_line_a_design_and_the_best_in_any_case(self, designs: xarray.Dataset):
        found = read_designs(designs, ShownUnits(), None)
        assert found.total == designs.conveying_velocity.size > MAX_DESIGNS
        assert [column.name for column in found.columns] == [
            "amplitude", "drive elevation", "friction coefficient", "conveying velocity",
        ]  # fmt: skip
        speed = found.columns[-1].values
        assert speed.size == MAX_DESIGNS
        largest = designs.conveying_velocity
        assert speed[found.best] == 1000 * float(largest.max())
        where = largest.where(largest == largest.max(), drop=True)
        assert found.columns[1].values[found.best] == float(where.beta[0])
        figure = draw(designs, kind="parallel")
        lines = next(a for a in figure.axes[0].collections if isinstance(a, LineCollection))
        assert len(lines.get_segments()) == MAX_DESIGNS
        judge(figure)

    def test_a_value_may_be_held(self, designs: xarray.Dataset):
        figure = draw(designs, kind="parallel", at={"beta": 30.0})
        names = [label.get_text() for label in figure.axes[0].get_xticklabels()]
        assert names[:2] == ["amplitude\n(mm)", "friction coefficient"]

    def test_the_least_is_best_where_the_study_says_so(self):
        best = vibrafeed.optimise(
            scene="rectangle-on-plane", frequency=60, amplitude="0.1 mm",
            criterion={"kind": "pareto", "points": 20}, friction=[0.3, 0.5],
        )  # fmt: skip
        found = read_designs(best, ShownUnits(), None)
        knees = best.knee.values == 1
        assert found.columns[-1].values[found.best] == best.acceleration_x.values[knees].max()
        assert found.best_is.startswith("of the knees")

    def test_one_design_has_nothing_to_compare(self):
        one = vibrafeed.simulate(**DRIVE, amplitude=3e-4, friction=0.3)
        assert "there is one design only" in str(problem(one, kind="parallel"))


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
