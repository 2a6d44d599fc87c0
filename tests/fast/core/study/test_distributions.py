"""Distributions of parameters: their forms, their bounds, and what they are."""

import numpy as np
import pytest
from scipy import stats

from vibrafeed.core.plan.statistics import points, values_at
from vibrafeed.core.study.distributions import (
    Distribution,
    Tabulated,
    deviation,
    nominal,
    quantiles,
    read_distribution,
    tolerance,
)
from vibrafeed.core.study.units import UnitError
from vibrafeed.core.study.values import Between

SHARES = (np.arange(100_000) + 0.5) / 100_000
# Of friction, whose bound is 0: mean and deviation by hand or by scipy's truncated law.
CUT = stats.truncnorm(-1.0, np.inf, loc=0.05, scale=0.05)
WITHIN = stats.truncnorm(-0.6, 1.4, loc=0.05, scale=0.05)
FORMS = {
    "uniform": ({"lower": 0.3, "upper": 0.5}, 0.4, 0.4, 0.2 / 12**0.5),
    "normal": ({"mean": 0.3, "deviation": 0.03}, 0.3, 0.3, 0.03),
    "cut": ({"mean": 0.05, "deviation": 0.05}, 0.05, CUT.mean(), CUT.std()),
    "within": (
        {"mean": 0.05, "deviation": 0.05, "lower": 0.02, "upper": 0.12},
        0.05, WITHIN.mean(), WITHIN.std(),
    ),
    "triangular": (
        {"lower": 0.2, "most_likely": 0.3, "upper": 0.6}, 0.3, 1.1 / 3, (0.13 / 18) ** 0.5,
    ),
    "lognormal": (
        {"median": 0.3, "factor": 1.2}, 0.3, 0.3 * np.exp(np.log(1.2) ** 2 / 2),
        stats.lognorm(np.log(1.2), scale=0.3).std(),
    ),
    "tabulated": (
        {"values": [0.2, 0.3, 0.6], "densities": [0, 1, 0]}, 0.3, 1.1 / 3, (0.13 / 18) ** 0.5,
    ),
}  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
def test_every_form_is_the_law_that_it_says(form):
    raw, meant, mean, spread = FORMS[form]
    found = read_distribution("friction", raw)
    assert isinstance(found, Distribution)
    assert nominal(found) == pytest.approx(meant)
    values = quantiles("friction", found, SHARES)
    assert (np.diff(values) >= 0).all()
    assert (values >= 0).all()
    assert values.mean() == pytest.approx(mean, rel=1e-5)
    assert values.std() == pytest.approx(spread, rel=1e-3)
    assert deviation("friction", found) == pytest.approx(spread, rel=1e-6)
    assert read_distribution("friction", found.canonical()) == found
    lower, upper = tolerance("friction", found)
    assert lower < nominal(found) < upper


def test_tolerances_are_ends_or_three_deviations():
    assert tolerance("friction", Between(0.3, 0.5)) == (0.3, 0.5)
    normal = read_distribution("friction", {"mean": 0.3, "deviation": 0.03})
    assert tolerance("friction", normal) == pytest.approx((0.21, 0.39), abs=1e-5)
    assert quantiles("friction", normal, [0.0])[0] == 0  # the bound of the quantity itself
    table = Tabulated((1.0, 2.0, 4.0), (1.0, 1.0, 1.0))  # a flat one is uniform
    assert quantiles("frequency", table, [0.0, 0.25, 1.0]).tolist() == [1.0, 1.75, 4.0]


def test_units_are_those_of_the_quantity():
    found = read_distribution("beta", {"mean": "0.5 rad", "deviation": "1 deg"})
    assert found.canonical() == {"mean": pytest.approx(28.6478897), "deviation": 1.0}
    assert values_at({"beta": found}, np.array([[0.5]]))["beta"] == pytest.approx(0.5)
    for name, mean, wide, expected in (
        ("amplitude", "0.3 mm", "5 %", 0.015e-3), ("friction", 0.3, "10%", 0.03),
    ):  # fmt: skip
        share = read_distribution(name, {"mean": mean, "deviation": wide})
        assert share.deviation == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (0.3, "this is no distribution"),
        ("0.3 +- 5 %", "may mean limits or a standard deviation"),
        ("0.3 ± 0.02", 'deviation = "0.02"'),
        ({"mean": 0.3, "deviation": "five %"}, r"Write deviation = \"5 %\", or a value with its"),
        ({"mean": 0.3}, "mean alone make no distribution"),
        ({"mean": 0.3, "devation": 0.1}, "Did you mean 'deviation'"),
        ({"mean": -0.1, "deviation": 0.1}, "at least 0"),
        ({"mean": 0.3, "deviation": 0}, "greater than 0"),
        ({"mean": 0.3, "deviation": "1 mm"}, "does not measure"),
        ({"lower": 0.5, "upper": 0.3}, "not above its lower"),
        ({"mean": 0.3, "deviation": 0.1, "lower": 0.5, "upper": 0.4}, "not above the lower"),
        ({"mean": 0.3, "deviation": 0.1, "upper": 0.2}, "not between its bounds"),
        ({"lower": 0.2, "most_likely": 0.7, "upper": 0.6}, "ascending order"),
        ({"median": 0, "factor": 2}, "above 0"),
        ({"median": 0.3, "factor": 1}, "above 1"),
        ({"values": [0.2], "densities": [1]}, "2 to 10,000"),
        ({"values": [0.3, 0.2], "densities": [1, 1]}, "not in ascending order"),
        ({"values": [0.2, 0.3], "densities": [0, 0]}, "are 0"),
        ({"values": 0.3, "densities": [1, 1]}, "two lists"),
    ],
)
def test_what_is_no_distribution_says_what_would_be(raw, message):
    with pytest.raises(UnitError, match=message):
        read_distribution("friction", raw)


def test_points_are_even_within_and_different_between_scramblings():
    found = points(3, 64, seed=5, replicates=4)
    assert found.shape == (3, 4, 64)
    assert ((found > 0) & (found < 1)).all()
    cells = np.sort(np.floor(found * 64), axis=-1)
    assert (cells == np.arange(64)).all()  # one point in each of 64 slices of each input
    assert np.array_equal(found, points(3, 64, seed=5, replicates=4))
    assert not np.array_equal(found, points(3, 64, seed=6, replicates=4))
    assert len({one.tobytes() for one in np.moveaxis(found, 1, 0)}) == 4
