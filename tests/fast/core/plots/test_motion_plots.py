"""Pictures of motion: regime maps, velocities with their spread, several results together."""

import numpy as np
import pytest
import xarray
from matplotlib.colors import to_hex, to_rgb

import vibrafeed
from pictures import hatches, legend, problem, regimes_in
from vibrafeed.core.plots.drawing import draw
from vibrafeed.core.plots.looks import LOOKS, categories_of
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.quantities.pictures import FILLS

SPEED, SPREAD, MULTIPLE = "conveying_velocity", "conveying_velocity_spread", "period_multiple"
NAMES = {regime.value: name for name, regime in REGIMES.items()}


def simulation(**parameters) -> xarray.Dataset:
    return vibrafeed.simulate(
        "rectangle-on-plane", outputs=[SPEED, SPREAD, MULTIPLE], frequency=50, gamma=2,
        **parameters,
    )  # fmt: skip


@pytest.fixture(scope="module")
def plane() -> xarray.Dataset:
    """Stick, slip, stick-slip, hopping, hop after hop, period doubled."""
    return simulation(
        amplitude={"start": "0.02 mm", "stop": "0.75 mm", "num": 25},
        beta={"start": 2, "stop": 60, "num": 21}, friction=[0.0, 0.3], units=["m/min"],
    )  # fmt: skip


@pytest.fixture(scope="module")
def dry() -> xarray.Dataset:
    return simulation(amplitude=np.linspace(1e-5, 9e-4, 90), beta=25, friction=0.3)


# --- regime maps


def test_a_map_names_each_regime_with_its_share(plane):
    figure = draw(plane, kind="map", at={"friction": 0.3})
    assert figure.get_suptitle() == "Regimes"
    shares = dict(entry.rsplit(", ", 1) for entry in legend(figure))
    assert shares.keys() == regimes_in(plane, friction=0.3)
    assert len(shares) == 6
    # Each share is rounded by 0.5 per cent at most, the small ones by less.
    sums = sum(float(share.removesuffix(" %")) for share in shares.values())
    assert sums == pytest.approx(100, abs=3)
    # Cells are counted, those at the ends too, as on the console.
    hops = plane["regime"].sel(friction=0.3).values == REGIMES["hopping"].value
    assert shares["hopping"] == f"{100 * hops.mean():.0f} %"


def test_a_map_has_axes_with_units_and_needs_no_output(plane):
    bare = plane.drop_vars([name for name in plane.data_vars if name != "regime"])
    axes = draw(bare, kind="map", variable="regime", at={"friction": 0.3}).axes[0]
    assert axes.get_xlabel() == r"Amplitude $A_{\mathrm{0}}$ (mm)"
    assert axes.get_ylabel() == r"Drive elevation $\beta$ (°)"
    assert axes.get_xlim() == pytest.approx((0.02, 0.75))
    assert axes.get_ylim() == pytest.approx((2, 60))


def test_cells_of_a_map_have_the_fill_of_their_regime(plane):
    axes = draw(plane, kind="map", at={"friction": 0.3}).axes[0]
    mesh = axes.collections[0]
    seen = mesh.to_rgba(mesh.get_array())[..., :3]
    states = plane["regime"].sel(friction=0.3).transpose("beta", "amplitude").values
    expected = [to_rgb(FILLS[NAMES[value]]) for value in states.ravel().tolist()]
    assert seen.reshape(-1, 3) == pytest.approx(np.array(expected))


def test_names_on_a_map_stand_in_their_regime(plane):
    axes = draw(plane, kind="map", at={"friction": 0.3}).axes[0]
    states = plane["regime"].sel(friction=0.3)
    written = {text.get_text() for text in axes.texts}
    assert {"slip", "hopping", "period doubled"} <= written <= regimes_in(plane, friction=0.3)
    for text in axes.texts:
        box = text.get_window_extent().transformed(axes.transData.inverted())
        inside = states.sel(
            amplitude=np.linspace(box.x0, box.x1, 9) / 1000,
            beta=np.linspace(box.y0, box.y1, 5), method="nearest",
        )  # fmt: skip
        assert set(np.unique(inside)) == {REGIMES[text.get_text().replace(" ", "_")].value}
    alone = plane.assign(regime=plane["regime"] * 0 + REGIMES["slip"].value)
    (name,) = draw(alone, kind="map", at={"friction": 0.3}).axes[0].texts
    assert name.get_position() == pytest.approx((0.5, 0.5), abs=0.05)  # the middle


def test_a_map_says_what_has_no_value(plane):
    figure = draw(plane, kind="map", at={"friction": 0.0})
    assert any(entry.startswith("runaway (no mean velocity), ") for entry in legend(figure))
    assert hatches(figure.axes[0]) == {LOOKS["runaway"][0]}


@pytest.mark.parametrize(
    ("asked", "place", "words"),
    [
        ({"kind": "map", "axes": ("beta",)}, "kind", "kind map needs two axes, but there is only"),
        ({"kind": "map", "variable": "speed"}, "variable", "'speed' is unknown"),
        ({"kind": "map", "axes": ("beta", "alpha")}, "axes", "no dimension 'alpha'"),
        ({"kind": "map", "at": {"friction": 0.2}}, "at.friction", "The nearest are"),
        ({"variable": "regime"}, "variable", "Draw kind map"),
        ({"variable": MULTIPLE, "kind": "contour"}, "kind", "are names, not numbers"),
        ({"kind": "trajectory"}, "kind", "Set trajectory = 400"),
    ],
)
def test_what_cannot_be_drawn_is_said(plane, asked, place, words):
    found = problem(plane, **asked)
    assert found.place == place
    assert words in str(found)


def test_numbers_that_stand_for_words_are_a_map_with_these_words(plane):
    motion = plane.sel(friction=0.3)
    figure = draw(motion, variable=MULTIPLE)
    assert figure.get_suptitle() == "Period multiple"
    names = {entry.rsplit(", ", 1)[0] for entry in legend(figure)}
    assert {"repeats every period", "repeats every 2 periods"} <= names
    assert not figure.axes[0].lines
    row = draw(motion, variable=MULTIPLE, kind="line", axes=("amplitude",))
    assert not row.axes[0].get_yticks().size


def test_words_of_flags_and_of_what_has_no_value():
    flags = {"flag_values": np.int8([0, 8]), "flag_meanings": "not_computed settled"}
    status = xarray.DataArray(np.int8([8, 0]), name="motion_status", attrs=flags)
    assert categories_of(status) == {0: "not computed", 8: "settled"}
    side = xarray.DataArray([1.0, np.nan, 4.0], name="resting_side")
    assert categories_of(side) == {
        -1: "no value", 1: "the side at pitch 0°", 4: "the side at pitch 270°",
    }  # fmt: skip
    assert categories_of(xarray.DataArray(np.arange(20.0), name=MULTIPLE)) is None


# --- velocity over one axis


def test_units_are_those_of_the_study_or_asked_for(plane):
    line = plane.sel(friction=0.3).isel(beta=2)
    for units, unit in ((None, "m/min"), ("trade", "mm/s"), (["si"], "m/s")):
        assert draw(line, units=units).axes[0].get_ylabel() == f"Conveying velocity $v$ ({unit})"
    axes = draw(line).axes[0]
    shown = line[SPEED].values * 60
    curves = [np.asarray(one.get_ydata()) for one in axes.lines if len(one.get_ydata()) == 25]
    for curve in curves:
        np.testing.assert_allclose(curve, np.where(np.isfinite(curve), shown, np.nan))
    assert np.isfinite(curves).any(axis=0).all()


def test_spread_is_a_band_where_it_is_not_zero(plane):
    line = simulation(amplitude=np.linspace(2e-5, 1e-3, 41), beta=30, friction=0.3, restitution=0.5)
    figure = draw(line)
    assert "\N{PLUS-MINUS SIGN} spread" in legend(figure)
    band = figure.axes[0].collections[-1].get_paths()[0].vertices
    velocity, spread = (1000 * line[name].values for name in (SPEED, SPREAD))  # in mm/s
    assert (spread > 0).any()
    least, most = (velocity - spread).min(), (velocity + spread).max()
    assert (band[:, 1].min(), band[:, 1].max()) == pytest.approx((least, most))
    low, high = figure.axes[0].get_ylim()
    assert low < least < most < high
    without = draw(plane, axes=("amplitude",), at={"friction": 0.3, "beta": 2})
    assert "\N{PLUS-MINUS SIGN} spread" not in legend(without)


def test_a_family_with_many_regimes_shows_them_in_strips(plane):
    part = plane.sel(friction=0.3).isel(beta=[2, 8, 20])
    figure = draw(part, axes=("amplitude", "beta"), kind="line")
    _, strips = figure.axes
    assert [text.get_text() for text in strips.get_yticklabels()] == ["7.8°", "25.2°", "60°"]
    assert set(legend(figure)) == regimes_in(part)
    bars = [set(), set(), set()]
    for bar in strips.collections:
        for path in bar.get_paths():
            bars[round(float(path.get_extents().y0 + 0.4))].add(to_hex(bar.get_facecolor()[0]))
    states = part["regime"].transpose("beta", "amplitude").values
    assert bars == [{FILLS[NAMES[value]] for value in row.tolist()} for row in states]
    widths = [path.get_extents().width for bar in strips.collections for path in bar.get_paths()]
    assert sum(widths) == pytest.approx(3 * np.ptp(strips.get_xlim()))  # each row is full


def test_backward_travel_is_hatched_and_named(plane):
    motion = plane.sel(friction=0.3)
    figure = draw(motion, kind="levels")
    assert "backward" in legend(figure)
    assert any(entry.startswith("hopping, ") for entry in legend(figure))
    forward = motion.isel(beta=slice(8, 16), amplitude=slice(8, 16))
    assert forward[SPEED].min() > 0
    assert "backward" not in legend(draw(forward, kind="levels"))


# --- several results together


def test_lines_are_named_by_what_differs(dry):
    oiled = simulation(amplitude=dry.amplitude.values, beta=25, friction=0.12)
    figure = draw([dry, oiled])
    assert legend(figure) == ["friction 0.3", "friction 0.12"]
    for dataset in (dry, oiled):
        speed = 1000 * dataset[SPEED].values
        assert any(np.array_equal(line.get_ydata(), speed) for line in figure.axes[0].lines)
    again = dry.copy()
    again.encoding["source"] = "folder/again.nc"
    assert legend(draw([dry, again], variable=MULTIPLE))[1] == "again.nc"


def test_what_they_do_not_share_is_said(dry, plane):
    other = vibrafeed.sweep(
        scene="rectangle-on-plane", outputs=["acceleration_x"], frequency=[40, 50],
        amplitude=1e-4, beta=30, friction=0.3,
    )  # fmt: skip
    other.encoding["source"] = "closed.nc"
    told = str(problem([dry, other]))
    assert "the result files have no output in common" in told
    assert "closed.nc has acceleration_x" in told
    elsewhere = plane.isel(amplitude=3, friction=1)
    assert "has no axis in common" in str(problem([dry, elsewhere]))
    assert problem([dry, dry], kind="map").place == "kind"
    assert problem([dry, dry], variable="flight_share").place == "variable"
    for many in ([dry] * 8, []):
        assert problem(many).place == "dataset"
