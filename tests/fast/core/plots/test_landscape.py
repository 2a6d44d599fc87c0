"""What a landscape draws is what its title says, against values of sweeps and of the optimiser."""

from typing import Any

import numpy as np
import pytest
import xarray
from matplotlib.contour import QuadContourSet
from matplotlib.text import Text

import vibrafeed
from vibrafeed.core.plots.landscape import Landscape, _draw_plane, _with_nan_broken
from vibrafeed.core.plots.style import LIGHT

LOWER, UPPER, NODES = 0.25, 0.45, 9
PLACE: dict[str, Any] = {"scene": "rectangle-on-plane", "frequency": 50, "amplitude": "0.1 mm"}
BEST: dict[str, Any] = {**PLACE, "criterion": {"kind": "maximise", "output": "acceleration_x"}}
UNSURE = {"friction": {"lower": LOWER, "upper": UPPER}}
ANGLES = {"alpha": {"lower": 0, "upper": 90}, "beta": {"lower": 0, "upper": 60}}


def accelerations(friction: Any, **angles: Any) -> xarray.DataArray:
    """Return the acceleration of the closed forms, of a sweep."""
    found = vibrafeed.sweep(**PLACE, outputs=["acceleration_x"], friction=friction, **angles)
    return found["acceleration_x"]


@pytest.mark.parametrize("how", ["worst", "mean"])
def test_a_curve_of_uncertain_friction(how):
    best = vibrafeed.optimise(
        **BEST, robust=how, variables={"beta": {"lower": 5, "upper": 40}}, uncertain=UNSURE
    )
    figure = vibrafeed.plot(best, kind="landscape", units="si")
    words = " ".join(text.get_text() for text in figure.findobj(Text)).replace("\n", " ")
    assert "friction from 0.25 to 0.45" in words.replace("\N{NO-BREAK SPACE}", " ")
    beta, drawn = (np.asarray(data) for data in figure.axes[0].lines[0].get_data())
    roots, weights = np.polynomial.legendre.leggauss(NODES)
    nodes = np.linspace(LOWER, UPPER, NODES)
    if how == "mean":
        nodes = (LOWER + UPPER) / 2 + (UPPER - LOWER) / 2 * roots
    values = accelerations(nodes.tolist(), beta=beta[::60].tolist())
    values = values.transpose("friction", "beta").values
    right = values.min(axis=0) if how == "worst" else weights @ values / 2
    # Angles go to degrees and back: a few units in the last place of numbers of some 10 m/s2.
    np.testing.assert_allclose(drawn[::60], right, rtol=1e-12, atol=1e-12)
    # The optimiser's own best is the highest point: 720 steps leave a parabola's top 1e-6 lower.
    top = float(best["objective"])
    assert drawn.max() <= top * (1 + 1e-12)
    assert drawn.max() == pytest.approx(top, rel=1e-4)


def test_a_plane_of_the_worst_case_keeps_its_limits_over_the_whole_band():
    best = vibrafeed.optimise(
        **BEST, robust="worst", variables=ANGLES, uncertain=UNSURE,
        constraints=[{"output": "normal_acceleration", "lower": 5.0}],
    )  # fmt: skip
    axes = vibrafeed.plot(best, kind="landscape", units="si").axes[0]
    (lines, *_) = (one for one in axes.collections
                   if isinstance(one, QuadContourSet) and not one.filled)  # fmt: skip
    places = [
        (level, *place) for level, path in zip(lines.levels, lines.get_paths(), strict=True)
        for place in path.vertices[::150]
    ]  # fmt: skip
    assert len(places) > 5
    nodes = np.linspace(LOWER, UPPER, NODES).tolist()
    for level, beta, alpha in places:
        # Half a degree between points: what a straight line misses is h^2/8 of the curvature,
        # 1e-5 of some 10 m/s2, and more at the kink of the worst case.
        worst = float(accelerations(nodes, beta=beta, alpha=alpha).min())
        assert worst == pytest.approx(level, abs=5e-3)
    (star,) = (line for line in axes.lines if line.get_marker() == "*")
    assert star.get_xdata()[0] == pytest.approx(float(best["best_beta"]))
    assert star.get_ydata()[0] == pytest.approx(float(best["best_alpha"]))


def test_colours_belong_to_what_is_allowed():
    best = vibrafeed.optimise(
        **BEST, friction=0.3, variables=ANGLES,
        constraints=[{"output": "acceleration_x", "upper": 2.0}],
    )  # fmt: skip
    figure = vibrafeed.plot(best, kind="landscape", units="si")
    sets = [one for one in figure.axes[0].collections if isinstance(one, QuadContourSet)]
    assert max(float(one.levels.max()) for one in sets if not one.filled) <= 2.5


def test_further_variables_are_held_at_the_optimum():
    amplitude = {"lower": "0.05 mm", "upper": "0.1 mm"}
    asked = {**BEST, "amplitude": None, "variables": {"amplitude": amplitude, **ANGLES}}
    best = vibrafeed.optimise(**asked, friction=0.3)
    curve = vibrafeed.plot(best, kind="landscape", axes="beta", units="si").axes[0].lines[0]
    beta, drawn = (np.asarray(data)[::60] for data in curve.get_data())
    held = {name: float(best[f"best_{name}"]) for name in ("amplitude", "alpha")}
    told = vibrafeed.sweep(
        **PLACE | held, beta=beta.tolist(), friction=0.3, outputs=["acceleration_x"]
    )
    np.testing.assert_allclose(drawn, told.acceleration_x.values, rtol=1e-12, atol=1e-12)
    plane = vibrafeed.plot(best, axes=("amplitude", "beta"), kind="landscape").axes[0]
    assert f"alpha {held['alpha']:.6g}" in plane.get_title(loc="left").replace("\xa0", " ")
    with pytest.raises(vibrafeed.VibrafeedError, match="one or two of amplitude, alpha, beta"):
        vibrafeed.plot(best, kind="landscape", axes="gamma")


def test_a_limit_without_a_value_here_and_there_excludes_and_has_its_edge():
    side = np.linspace(0.0, 1.0, 21)
    margin = side[:, None] - 0.5 + 0 * side
    margin[0, 0] = margin[-1, -1] = np.nan  # motions that did not settle
    margin = _with_nan_broken(margin)
    assert max(margin[0, 0], margin[-1, -1]) < 0
    shown = Landscape((side, side), ("a", "b"), margin, "c", {"speed": margin}, np.empty((2, 0)))
    axes = LIGHT.sheet().add_subplot()
    entries = [entry.get_label() for entry in _draw_plane(axes, shown, LIGHT)]
    assert entries == ["edge of speed", "faint: excluded"]
