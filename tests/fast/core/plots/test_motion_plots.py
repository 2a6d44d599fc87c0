"""Pictures of motion: regime maps, velocities with their spread."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray
from matplotlib.colors import to_hex, to_rgb

from pictures import legend, problem, subtitle
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.plots.drawing import draw, draw_file
from vibrafeed.core.plots.looks import LOOKS
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.quantities.pictures import FILLS

OUTPUTS = ["conveying_velocity", "conveying_velocity_spread"]
FREQUENCY = 50.0


def simulation(outputs: list[str] = OUTPUTS, **parameters: object) -> xarray.Dataset:
    return run_study(
        parse_study(
            {
                "kind": "simulate",
                "scene": "rectangle-on-plane",
                "outputs": outputs,
                "parameters": {"frequency": FREQUENCY, "gamma": 2, **parameters},
            }
        )
    )


@pytest.fixture(scope="module")
def plane() -> xarray.Dataset:
    """Stick, slip, stick-slip, hopping, hop after hop, period doubled."""
    return simulation(
        amplitude={"start": "0.02 mm", "stop": "0.75 mm", "num": 25},
        beta={"start": 2, "stop": 60, "num": 21},
        friction=[0.0, 0.3],
    )


@pytest.fixture(scope="module")
def bouncing() -> xarray.Dataset:
    """Many small islands of aperiodic motion."""
    return simulation(
        amplitude={"start": "0.02 mm", "stop": "1 mm", "num": 41},
        beta={"start": 10, "stop": 60, "num": 21},
        friction=0.3,
        restitution=0.5,
    )


def names_of(dataset: xarray.Dataset, **at: float) -> set[str]:
    values = np.unique(dataset["regime"].sel(at, method="nearest"))
    return {name.replace("_", " ") for name, regime in REGIMES.items() if regime.value in values}


# --- regime maps


def test_map_names_each_regime_with_its_share(plane: xarray.Dataset):
    figure = draw(plane, kind="map", at={"friction": 0.3})
    assert figure.get_suptitle() == "Regimes"
    assert "friction 0.3" in subtitle(figure)
    assert "rectangle-on-plane, events" in subtitle(figure)
    assert "tolerance" not in subtitle(figure)
    shares = dict(entry.rsplit(", ", 1) for entry in legend(figure))
    assert shares.keys() == names_of(plane, friction=0.3)
    assert len(shares) == 6
    # Each share is rounded by 0.5 per cent at most, the small ones by less.
    assert sum(float(share.removesuffix(" %")) for share in shares.values()) == pytest.approx(
        100, abs=3
    )
    # Cells are counted, those at the ends too, as on the console.
    hops = plane["regime"].sel(friction=0.3).values == REGIMES["hopping"].value
    assert shares["hopping"] == f"{100 * hops.mean():.0f} %"


def test_map_has_axes_with_units_and_needs_no_output(plane: xarray.Dataset):
    bare = plane.drop_vars([name for name in plane.data_vars if name != "regime"])
    for asked in ({}, {"variable": "regime"}):
        axes = draw(bare, kind="map", at={"friction": 0.3}, **asked).axes[0]
        assert axes.get_xlabel() == r"Amplitude $A_{\mathrm{0}}$ (mm)"
        assert axes.get_ylabel() == r"Drive elevation $\beta$ (°)"
        assert axes.get_xlim() == pytest.approx((0.02, 0.75))
        assert axes.get_ylim() == pytest.approx((2, 60))
    turned = draw(plane, kind="map", axes=("beta", "amplitude")).axes[0]
    assert turned.get_xlabel().startswith("Drive elevation")


def test_cells_of_a_map_have_the_fill_of_their_regime(plane: xarray.Dataset):
    axes = draw(plane, kind="map", at={"friction": 0.3}).axes[0]
    mesh = axes.collections[0]
    seen = mesh.to_rgba(mesh.get_array())[..., :3]
    names = {regime.value: name for name, regime in REGIMES.items()}
    states = plane["regime"].sel(friction=0.3).transpose("beta", "amplitude").values
    expected = [to_rgb(FILLS[names[value]]) for value in states.ravel().tolist()]
    assert seen.reshape(-1, 3) == pytest.approx(np.array(expected))


def test_names_on_a_map_stand_in_their_regime(plane: xarray.Dataset):
    figure = draw(plane, kind="map", at={"friction": 0.3})
    axes = figure.axes[0]
    states = plane["regime"].sel(friction=0.3)
    written = {text.get_text() for text in axes.texts}
    assert {"slip", "hopping", "period doubled"} <= written <= names_of(plane, friction=0.3)
    for text in axes.texts:
        box = text.get_window_extent().transformed(axes.transData.inverted())
        inside = states.sel(
            amplitude=np.linspace(box.x0, box.x1, 9) / 1000,
            beta=np.linspace(box.y0, box.y1, 5),
            method="nearest",
        )
        assert set(np.unique(inside)) == {REGIMES[text.get_text().replace(" ", "_")].value}
        frame = axes.get_window_extent()
        around = text.get_window_extent()
        assert frame.x0 < around.x0
        assert around.x1 < frame.x1
        assert frame.y0 < around.y0
        assert around.y1 < frame.y1


def test_map_says_what_has_no_value(plane: xarray.Dataset):
    figure = draw(plane, kind="map", at={"friction": 0.0})
    assert any(entry.startswith("runaway (no mean velocity), ") for entry in legend(figure))
    hatched = {
        hatch
        for area in figure.axes[0].collections
        for hatch in getattr(area, "hatches", [None])
        if hatch
    }
    assert hatched == {LOOKS["runaway"][0]}


def test_map_of_closed_forms_on_a_logarithmic_axis():
    dataset = run_study(
        parse_study(
            {
                "kind": "sweep",
                "scene": "rectangle-on-plane",
                "outputs": ["acceleration_x"],
                "parameters": {
                    "frequency": 50,
                    "amplitude": {"start": "0.01 mm", "stop": "1 mm", "num": 21, "spacing": "log"},
                    "friction": 0.3,
                    "beta": {"start": 0, "stop": 60, "num": 13},
                },
            }
        )
    )
    figure = draw(dataset, kind="map")
    assert figure.axes[0].get_xscale() == "log"
    assert any(entry.startswith("flight, ") for entry in legend(figure))


@pytest.mark.parametrize("target", ["picture.png", "picture.svg"])
def test_map_of_a_file(plane: xarray.Dataset, tmp_path: Path, target: str):
    plane.to_netcdf(tmp_path / "plane.nc", engine="netcdf4")
    draw_file(tmp_path / "plane.nc", [tmp_path / target], kind="map", at={"friction": "0.3"})
    # The cells are one image in an SVG, not a shape each.
    assert 10_000 < (tmp_path / target).stat().st_size < 400_000


@pytest.mark.parametrize(
    ("asked", "place", "words"),
    [
        (
            {"kind": "map", "axes": ("beta",)},
            "kind",
            "kind map needs two axes, but there is only beta",
        ),
        ({"kind": "map", "variable": "speed"}, "variable", "'speed' is unknown"),
        ({"kind": "mapp"}, "kind", "Did you mean 'map'?"),
        ({"kind": "map", "axes": ("beta", "alpha")}, "axes", "no dimension 'alpha'"),
        ({"kind": "map", "at": {"friction": 0.2}}, "at.friction", "The nearest are"),
        ({"variable": "regime"}, "variable", "Draw kind map"),
        ({"kind": "trajectory"}, "kind", "Set trajectory = 400"),
    ],
)
def test_what_cannot_be_drawn_is_said(
    plane: xarray.Dataset, asked: dict[str, object], place: str, words: str
):
    found = problem(plane, **asked)
    assert found.place == place
    assert words in str(found)


def test_map_of_one_axis_is_refused(plane: xarray.Dataset):
    found = problem(plane.isel(beta=0, friction=0), kind="map")
    assert (found.place, found.fix) == ("kind", "Draw an output as a line")


# --- velocity over one axis


def test_spread_is_a_band_where_it_is_not_zero(bouncing: xarray.Dataset, plane: xarray.Dataset):
    line = bouncing.isel(beta=8)
    assert (line["conveying_velocity_spread"] > 0).any()
    figure = draw(line)
    assert "\N{PLUS-MINUS SIGN} spread" in legend(figure)
    band = figure.axes[0].collections[-1].get_paths()[0].vertices
    velocity, spread = (1000 * line[name].values for name in OUTPUTS)  # in mm/s
    assert band[:, 1].max() == pytest.approx((velocity + spread).max())
    assert band[:, 1].min() == pytest.approx((velocity - spread).min())
    low, high = figure.axes[0].get_ylim()
    assert low < (velocity - spread).min()
    assert (velocity + spread).max() < high
    without = draw(plane, axes=("amplitude",), at={"friction": 0.3, "beta": 2})
    assert "\N{PLUS-MINUS SIGN} spread" not in legend(without)


def test_family_with_many_regimes_shows_them_in_strips(plane: xarray.Dataset):
    part = plane.sel(friction=0.3).isel(beta=[2, 8, 20])
    figure = draw(part, axes=("amplitude", "beta"), kind="line")
    curves, strips = figure.axes
    assert [text.get_text() for text in strips.get_yticklabels()] == ["7.8°", "25.2°", "60°"]
    assert set(legend(figure)) == names_of(part)
    assert strips.get_xlabel().startswith("Amplitude")
    assert not curves.get_xlabel()
    bars: dict[int, set[str]] = {0: set(), 1: set(), 2: set()}
    for bar in strips.collections:
        for path in bar.get_paths():
            row = round(float(path.get_extents().y0 + 0.4))
            bars[row].add(to_hex(bar.get_facecolor()[0]))
    for row, beta in enumerate(part["beta"].values):
        names = {name.replace(" ", "_") for name in names_of(part, beta=beta)}
        assert bars[row] == {FILLS[name] for name in names}


def test_many_borders_of_a_background_are_left_out(plane: xarray.Dataset):
    line = plane.isel(beta=20).sel(friction=0.3).interp(amplitude=np.linspace(2e-5, 7e-4, 60))
    line["regime"] = line["regime"].copy(data=np.full(60, REGIMES["hopping"].value))

    def borders(changes: int) -> int:
        line["regime"][1 : changes + 1 : 2] = REGIMES["aperiodic"].value
        axes = draw(line).axes[0]
        return sum(len(set(part.get_xdata())) == 1 for part in axes.get_lines())

    assert borders(6) == 6
    assert borders(40) == 0
