"""No wave beats the fastest one (docs/theory/best-drive.md), and one reaches it."""

import numpy as np
import pytest

from benchmarks.best_wave import KINDS, fastest_wave, motions, shares
from vibrafeed.core.motion.drives import fastest_velocity
from vibrafeed.core.motion.method import Groups

G = 9.81


def fastest(most: float, static: float, kinetic: float, frequency: float, **more: float) -> float:
    numbers = {
        "drive_number_along": most / G, "drive_number_normal": 0.0, "gravity_number_along": 0.0,
        "gravity_number_normal": 1.0, "friction_static": static, "friction_kinetic": kinetic,
    } | more  # fmt: skip
    settings = {"largest_acceleration_along": most, "frequency": frequency, "gravity": G}
    settings = {name: np.asarray(value) for name, value in settings.items()}
    return float(fastest_velocity(groups=Groups(**numbers), **settings))


@pytest.mark.parametrize(
    ("static", "kinetic", "gamma", "most"),
    [(0.4, 0.4, 0.0, 3 * G), (0.5, 0.4, 0.0, 30.0), (0.3, 0.1, 0.0, 4.0), (0.6, 0.5, 0.2, 25.0)],
)
def test_the_fastest_wave_reaches_it(
    static: float, kinetic: float, gamma: float, most: float
) -> None:
    onto, along = G * np.cos(gamma), G * np.sin(gamma)
    given = fastest_wave(static * onto - along, kinetic * onto + along, most) | {
        "gamma": gamma, "frequency": 50.0, "gravity": G, "friction_static": static,
        "friction_kinetic": kinetic,
    }  # fmt: skip
    asked = ("conveying_velocity", "fastest_velocity", "share_of_fastest")
    found = motions(asked, {name: np.array([value]) for name, value in given.items()})
    assert found["fastest_velocity"][0] > 0
    assert found["share_of_fastest"][0] == pytest.approx(1.0, abs=1e-8)


@pytest.mark.parametrize(("kind", "count"), KINDS)
def test_no_random_wave_is_faster(kind: str, count: int) -> None:
    found = shares(kind, count, 200, np.random.default_rng(count))
    assert found.size >= 180
    assert found.max() <= 1 + 1e-9


def test_what_frees_no_part_moves_none() -> None:
    assert fastest(3 * G, 0.4, 0.4, 50.0) == pytest.approx(36.1335e-3, rel=1e-5)
    assert fastest(0.49 * G, 0.5, 0.4, 50.0) == 0.0
    assert fastest(0.51 * G, 0.5, 0.4, 50.0) > 0.0
    climb = {"gravity_number_along": np.sin(0.2), "gravity_number_normal": np.cos(0.2)}
    assert fastest((0.5 * np.cos(0.2) + np.sin(0.2)) * G * 0.999, 0.5, 0.4, 50.0, **climb) == 0.0
    assert 0.0 < fastest(3 * G, 0.5, 0.4, 50.0, **climb) < fastest(3 * G, 0.5, 0.4, 50.0)


@pytest.mark.parametrize(
    "more",
    [
        {"drive_number_normal": 0.1}, {"drive_number_across": 0.1}, {"curvature_number": 0.1},
        {"gravity_number_across": 0.1},
        {"gravity_number_along": np.sin(-0.1), "gravity_number_normal": np.cos(0.1)},
        {"gravity_number_along": np.sin(0.6), "gravity_number_normal": np.cos(0.6)},
    ],
)  # fmt: skip
def test_where_the_bound_does_not_hold_there_is_none(more: dict[str, float]) -> None:
    assert np.isnan(fastest(3 * G, 0.5, 0.4, 50.0, **more))
