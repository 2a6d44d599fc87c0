"""What a landscape draws is what its title says, against values of sweeps and of the optimiser."""

from typing import Any

import numpy as np
import pytest
import xarray
from matplotlib.contour import QuadContourSet
from matplotlib.text import Text

import vibrafeed

LOWER, UPPER, NODES = 0.25, 0.45, 9
PLACE: dict[str, Any] = {"scene": "rectangle-on-plane", "frequency": 50, "amplitude": "0.1 mm"}
UNSURE = {"friction": {"lower": LOWER, "upper": UPPER}}


def accelerations(friction: Any, **angles: Any) -> xarray.Dataset:
    """Return both accelerations of the closed forms, of a sweep."""
    outputs = ["acceleration_x", "normal_acceleration"]
    return vibrafeed.sweep(**PLACE, outputs=outputs, friction=friction, **angles)


@pytest.mark.parametrize("how", ["worst", "mean"])
def test_curve_of_uncertain_friction(how: str):
    best = vibrafeed.optimise(
        **PLACE, criterion={"kind": "maximise", "output": "acceleration_x"}, robust=how,
        variables={"beta": {"lower": 5, "upper": 40}}, uncertain=UNSURE,
    )  # fmt: skip
    figure = vibrafeed.plot(best, kind="landscape", units="si")
    words = " ".join(text.get_text() for text in figure.findobj(Text)).replace("\n", " ")
    words = words.replace("\N{NO-BREAK SPACE}", " ")
    assert "friction from 0.25 to 0.45" in words
    assert "friction 0.35" not in words
    curve = figure.axes[0].lines[0]
    beta, drawn = (np.asarray(data) for data in curve.get_data())
    roots, weights = np.polynomial.legendre.leggauss(NODES)
    middle, half = (LOWER + UPPER) / 2, (UPPER - LOWER) / 2
    nodes = np.linspace(LOWER, UPPER, NODES) if how == "worst" else middle + half * roots
    among = slice(None, None, 60)
    told = accelerations(nodes.tolist(), beta=beta[among].tolist())
    values = told["acceleration_x"].transpose("friction", "beta").values
    right = values.min(axis=0) if how == "worst" else weights @ values / 2
    # Angles go to degrees and back: a few units in the last place of numbers of some 10 m/s2.
    np.testing.assert_allclose(drawn[among], right, rtol=1e-12, atol=1e-12)
    # The optimiser's own best is the highest point: 720 steps leave a parabola's top 1e-6 lower.
    top = float(best["objective"])
    assert drawn.max() <= top * (1 + 1e-12)
    assert drawn.max() == pytest.approx(top, rel=1e-4)


def test_plane_of_the_worst_case_keeps_its_limits_over_the_whole_band():
    best = vibrafeed.optimise(
        **PLACE, criterion={"kind": "maximise", "output": "acceleration_x"}, robust="worst",
        variables={"alpha": {"lower": 0, "upper": 90}, "beta": {"lower": 0, "upper": 60}},
        uncertain=UNSURE,
        constraints=[{"output": "normal_acceleration", "lower": 5.0}],
    )  # fmt: skip
    figure = vibrafeed.plot(best, kind="landscape", units="si")
    sets = [one for one in figure.axes[0].collections if isinstance(one, QuadContourSet)]
    lines = next(one for one in sets if not one.filled)
    checked = 0
    for level, path in zip(lines.levels, lines.get_paths(), strict=True):
        for beta, alpha in path.vertices[::150]:
            told = accelerations(np.linspace(LOWER, UPPER, NODES).tolist(), beta=beta, alpha=alpha)
            # Half a degree between points: what a straight line misses is h^2/8 of the curvature,
            # 1e-5 of some 10 m/s2, and more at the kink of the worst case.
            assert float(told["acceleration_x"].min()) == pytest.approx(level, abs=5e-3)
            checked += 1
    assert checked > 5


def test_colours_belong_to_what_is_allowed():
    best = vibrafeed.optimise(
        **PLACE, friction=0.3, criterion={"kind": "maximise", "output": "acceleration_x"},
        variables={"alpha": {"lower": 0, "upper": 90}, "beta": {"lower": 0, "upper": 60}},
        constraints=[{"output": "acceleration_x", "upper": 2.0}],
    )  # fmt: skip
    figure = vibrafeed.plot(best, kind="landscape", units="si")
    sets = [one for one in figure.axes[0].collections if isinstance(one, QuadContourSet)]
    assert max(float(one.levels.max()) for one in sets if not one.filled) <= 2.5


def test_further_variables_are_held_at_the_optimum():
    place: dict[str, Any] = {"scene": "rectangle-on-plane", "frequency": 50, "friction": 0.3}
    best = vibrafeed.optimise(
        **place, criterion={"kind": "maximise", "output": "acceleration_x"},
        variables={
            "amplitude": {"lower": "0.05 mm", "upper": "0.1 mm"},
            "alpha": {"lower": 0, "upper": 90}, "beta": {"lower": 0, "upper": 60},
        },
    )  # fmt: skip
    curve = vibrafeed.plot(best, kind="landscape", axes="beta", units="si").axes[0].lines[0]
    beta, drawn = (np.asarray(data)[::60] for data in curve.get_data())
    held = {name: float(best[f"best_{name}"]) for name in ("amplitude", "alpha")}
    told = vibrafeed.sweep(**place, **held, beta=beta.tolist(), outputs=["acceleration_x"])
    np.testing.assert_allclose(drawn, told.acceleration_x.values, rtol=1e-12, atol=1e-12)
    plane = vibrafeed.plot(best, axes=("amplitude", "beta"), kind="landscape").axes[0]
    assert plane.get_xlabel().startswith("Amplitude")
    assert plane.get_ylabel().startswith("Drive elevation")
    assert f"alpha {held['alpha']:.6g}" in plane.get_title(loc="left").replace("\xa0", " ")
    with pytest.raises(vibrafeed.VibrafeedError, match="one or two of amplitude, alpha, beta"):
        vibrafeed.plot(best, kind="landscape", axes="gamma")
