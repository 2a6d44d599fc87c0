"""Means over batches of a motion that does not repeat: their error covers, and a drift is seen."""

import numpy as np
import pytest
from scipy import stats

from vibrafeed.core.motion.kernels import means

CELLS, PERIODS = 1000, 1000


def judged(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return mean and error of each row, and whether it is steady."""
    batches = [means.batch_means(row) for row in values]
    return (
        np.array([np.mean(one) for one in batches]),
        np.array([means.mean_error(one) for one in batches]),
        np.array([means.is_steady(one, 0.0) for one in batches]),
    )


def with_memory(memory: float) -> np.ndarray:
    """Return rows of normal numbers, each like the one before; their mean is 0."""
    normal = np.random.default_rng(5).standard_normal((PERIODS, CELLS))
    values = np.empty((PERIODS, CELLS))
    values[0] = normal[0] / np.sqrt(1 - memory**2)
    for k in range(1, PERIODS):
        values[k] = memory * values[k - 1] + normal[k]
    return values.T


def logistic() -> np.ndarray:
    """Return rows of the chaos x -> 4 x (1 - x), sin^2 of doubled angles; their mean is 1/2."""
    values = np.empty((PERIODS, CELLS))
    values[0] = np.sin(np.pi * np.random.default_rng(6).uniform(size=CELLS)) ** 2
    for k in range(1, PERIODS):
        values[k] = 4 * values[k - 1] * (1 - values[k - 1])
    return values.T


def test_batches_are_successive_and_equally_long():
    values = np.arange(100.0)
    kept = values[-64:].reshape(16, 4)  # 75 are kept: 16 batches of 4
    assert means.batch_means(values).tolist() == kept.mean(axis=1).tolist()
    assert np.isnan(means.batch_means(np.arange(20.0))).all()  # 15 make no 16 batches


def test_ratio_and_error_are_those_of_their_formulas():
    values = np.random.default_rng(3).standard_normal(16)
    ratio = np.sum(np.diff(values) ** 2) / np.sum((values - values.mean()) ** 2)
    assert means.neumann_ratio(values) == pytest.approx(ratio, rel=1e-13)
    assert means.scatter(values) == pytest.approx(np.std(values, ddof=1), rel=1e-13)
    assert pytest.approx(stats.t.ppf(0.995, 15), abs=5e-4) == means.STUDENT
    alike = 0.5 * ratio if ratio < 2 else 1.0
    widened = means.STUDENT * stats.sem(values) * np.sqrt((2 - alike) / alike)
    assert means.mean_error(values) == pytest.approx(widened, rel=1e-13)


@pytest.mark.parametrize(
    ("memory", "mean"),
    [(0.0, 0.0), (0.9, 0.0), (0.97, 0.0), (None, 0.5)],
    ids=["independent", "memory of 10", "memory of 33", "chaos"],
)
def test_the_error_is_exceeded_in_less_than_one_in_twenty(memory, mean):
    found, error, steady = judged(logistic() if memory is None else with_memory(memory))
    assert np.mean(steady) > 0.9
    assert np.mean((np.abs(found - mean) > error)[steady]) < 0.05
    # And it is of use: a few times the true scatter of such means.
    assert np.median(error) < 8 * np.std(found)


def test_a_drift_is_seen():
    rows = with_memory(0.0)[:300]
    period = np.arange(PERIODS)
    for slow in (period * 0.01, 10 * np.exp(-period / 300), 30 * np.exp(-period / 3000)):
        assert not judged(rows + slow)[2].any()
    smooth = means.batch_means(67.0 - 1e-9 * period)  # next to no friction: it hardly falls
    assert not means.is_steady(smooth, 0.0)
    assert means.is_steady(smooth, 1e-6)  # less than is resolved of it


def test_what_does_not_change_is_steady_and_what_is_no_number_is_not():
    same = np.full(16, 1 / 3)
    assert means.is_steady(same, 1e-12)
    assert means.mean_error(same) < 1e-15
    assert not means.is_steady(np.full(16, np.nan), 1e-12)
