"""A landscape shows what its title says: under uncertain parameters what counts over all."""

from __future__ import annotations

import numpy as np
import pytest

from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.plots.drawing import draw

FRICTIONS = (0.25, 0.45)
ROBUST = {
    "kind": "optimise",
    "scene": "rectangle-on-plane",
    "criterion": {"kind": "maximise", "output": "conveying_velocity"},
    "constraints": [{"output": "throw_number", "upper": 1}],
    "variables": {
        "amplitude": {"lower": 1e-4, "upper": 6e-4},
        "beta": {"lower": "5 deg", "upper": "60 deg"},
    },
    "parameters": {"frequency": 50},
    "uncertain": {"friction": {"lower": FRICTIONS[0], "upper": FRICTIONS[1]}},
    "robust": "worst",
}


@pytest.fixture(scope="module")
def picture(tmp_path_factory):
    dataset = tabulate(prepare_content(ROBUST)).to_xarray()
    return dataset, draw(dataset, kind="landscape")


def drawn(figure):
    """Return x, y and the values of the filled contours of a picture."""
    axes = figure.axes[0]
    image = next(one for one in axes.collections if hasattr(one, "levels") and one.filled)
    return axes, image


@pytest.mark.night
def test_a_robust_landscape_is_that_of_the_worst_case(picture):
    from vibrafeed.core.optimise.optima import designs_of
    from vibrafeed.core.plots.landscape import _computed
    from vibrafeed.core.study.shown import ShownUnits

    dataset, _ = picture
    prepared = prepare_content(ROBUST)
    assert designs_of(prepared.problem, prepared.designs)
    shown = _computed(dataset, prepared, {}, ShownUnits("si"), prepared.problem.names, np.zeros(2))
    places = np.random.default_rng(1).integers(0, shown.value.shape, (40, 2))
    amplitude, beta = (shown.variables[k][places[:, k]] for k in (0, 1))
    # The witness: simulations of the same designs at nodes of the band, each by itself.
    worst = np.full(40, np.inf)
    for friction in np.linspace(*FRICTIONS, 9):
        for k in range(40):
            motion = tabulate(
                prepare_content(
                    {
                        "kind": "simulate", "scene": "rectangle-on-plane",
                        "outputs": ["conveying_velocity"],
                        "parameters": {
                            "frequency": 50, "amplitude": amplitude[k], "friction": friction,
                            "beta": float(beta[k]),
                        },
                    }
                )
            )  # fmt: skip
            worst[k] = min(worst[k], float(motion.variables["conveying_velocity"].values))
    found = shown.value[places[:, 0], places[:, 1]]
    np.testing.assert_allclose(found, worst, rtol=1e-9, atol=1e-12)
    meant = shown.value - worst.min()
    assert np.ptp(meant) > 0


def test_the_star_stands_at_the_best_of_what_is_drawn(picture):
    dataset, figure = picture
    axes, image = drawn(figure)
    (star,) = (line for line in axes.lines if line.get_marker() == "*")
    from vibrafeed.core.plots.landscape import _computed
    from vibrafeed.core.study.shown import ShownUnits

    prepared = prepare_content(ROBUST)
    shown = _computed(dataset, prepared, {}, ShownUnits(), prepared.problem.names, np.zeros(2))
    allowed = np.where(
        shown.margins["throw number \N{LESS-THAN OR EQUAL TO} 1"] >= 0, shown.value, -np.inf
    )
    top = float(allowed.max())
    # No point that is drawn does better, and what is drawn at the star is what it stands for.
    optimum = 1e3 * float(dataset.objective)  # mm/s, as it is drawn
    assert top <= optimum * (1 + 1e-9)
    near = [
        np.abs(side - place).argmin()
        for side, place in zip(
            shown.variables, (star.get_ydata()[0], star.get_xdata()[0]), strict=True
        )
    ]
    steps = np.gradient(shown.value)
    slack = sum(abs(step[tuple(near)]) for step in steps)  # of half a step each way
    assert shown.value[tuple(near)] == pytest.approx(optimum, abs=slack)
    # The scale is that of what is allowed, not of what is excluded and ten times as fast.
    assert top <= image.levels[-1] <= 1.5 * top


def test_a_limit_without_a_value_here_and_there_excludes_and_has_its_edge():
    from vibrafeed.core.plots.landscape import Landscape, _draw_plane, _excluding
    from vibrafeed.core.plots.style import LIGHT

    side = np.linspace(0.0, 1.0, 21)
    margin = side[:, None] - 0.5 + 0 * side
    margin[0, 0] = margin[-1, -1] = np.nan  # motions that did not settle
    margin = _excluding(margin)
    assert margin[0, 0] < 0
    assert margin[-1, -1] < 0
    shown = Landscape((side, side), ("a", "b"), margin, "c", {"speed": margin}, np.empty((2, 0)))
    figure = LIGHT.sheet()
    entries = [entry.get_label() for entry in _draw_plane(figure.add_subplot(), shown, LIGHT)]
    assert entries == ["edge of speed", "faint: excluded"]
