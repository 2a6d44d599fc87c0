"""Pictures: they are drawn, they name the regimes, and what cannot be drawn is said."""

from __future__ import annotations

import struct
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray
from matplotlib.figure import Figure

from night import spread
from pictures import problem, subtitle
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.plots.drawing import draw, draw_file
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.selection import select
from vibrafeed.core.plots.style import math_symbol
from vibrafeed.core.quantities import REGIMES

DEGREES = {"start": 0, "stop": 60, "num": 13}
TRACK = {
    "frequency": 50,
    "amplitude": {"start": "0.02 mm", "stop": "0.5 mm", "num": 25},
    "alpha": {"start": -20, "stop": 20, "num": 17},
    "beta": 20,
    "friction": 0.3,
    "radius": 0.3,
    "distance": "0.2 mm",
}


def study(scene: str, outputs: list[str], variant: str = "physical", **parameters: object):
    return run_study(
        parse_study(
            {
                "kind": "sweep",
                "scene": scene,
                "variant": variant,
                "outputs": outputs,
                "parameters": parameters,
            }
        )
    )


@pytest.fixture(scope="module")
def plane() -> xarray.Dataset:
    """Three axes; stick, slip and flight."""
    return study(
        "rectangle-on-plane",
        ["acceleration_x", "throw_number", "vibration_acceleration"],
        frequency={"start": 20, "stop": 60, "num": 5},
        amplitude="0.2 mm",
        friction=0.5,
        alpha={"start": -45, "stop": 45, "num": 19},
        beta=DEGREES,
    )


@pytest.fixture(scope="module")
def track() -> xarray.Dataset:
    return study("rectangle-on-track", ["transport_velocity", "terminal_velocity"], **TRACK)


@pytest.fixture
def file(plane: xarray.Dataset, tmp_path: Path) -> Path:
    path = tmp_path / "plane.nc"
    plane.to_netcdf(path, engine="netcdf4")
    return path


def legend(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[-1].get_texts()]


def note(figure: Figure) -> str:
    """Return what is said above the legend."""
    return figure.legends[-1].get_title().get_text()


def occurring(dataset: xarray.Dataset, **at: float) -> set[str]:
    values = np.unique(dataset["regime"].sel(at, method="nearest"))
    return {name for name, regime in REGIMES.items() if regime.value in values}


def named(figure: Figure) -> set[str]:
    return {text.split(" (")[0].replace(" ", "_") for text in legend(figure)}


@pytest.mark.parametrize("kind", spread(["contour", "levels", "line"], 1))
def test_every_kind_makes_png_and_svg(file: Path, tmp_path: Path, kind: str):
    targets = [tmp_path / "picture.png", tmp_path / "picture.SVG"]
    draw_file(file, targets, kind=kind, at={"frequency": "50"})
    png = targets[0].read_bytes()
    width, height = struct.unpack(">II", png[16:24])
    assert png.startswith(b"\x89PNG")
    assert (width, height) == (1200, 960)
    assert len(png) > 20_000
    tree = ElementTree.fromstring(targets[1].read_text("utf-8"))
    assert tree.tag.endswith("svg")
    assert len(list(tree.iter())) > 200
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "picture.SVG",
        "picture.png",
        "plane.nc",
    ]


@pytest.mark.parametrize("kind", spread(["contour", "levels", "line"], 1))
def test_legend_names_the_regimes_that_occur(
    plane: xarray.Dataset, track: xarray.Dataset, kind: str
):
    figure = draw(plane, axes=("frequency", "beta"), at={"alpha": 0}, kind=kind)
    assert named(figure) == occurring(plane, alpha=0) == {"stick", "slip", "flight"}
    fixed = {"frequency": 50.0, "alpha": 0.0}
    single = draw(plane, axes=("beta",), at=fixed)
    assert named(single) == occurring(plane, **fixed) == {"slip", "flight"}
    lost = draw(track, axes=("amplitude", "alpha"), kind=kind)
    assert "wall lost" in legend(lost)
    assert "the closed forms do not describe a part there" in note(lost)
    assert named(lost) == occurring(track) or kind == "line"


def test_what_is_not_valid_is_veiled_and_hatched(plane: xarray.Dataset):
    axes = draw(plane, at={"frequency": 50}).axes[0]
    hatched = {
        hatch for area in axes.collections for hatch in getattr(area, "hatches", [None]) if hatch
    }
    assert "///" in hatched
    strongest = [line for line in axes.collections if 2.2 in np.atleast_1d(line.get_linewidths())]
    assert len(strongest) == 1


def test_title_says_what_is_fixed(plane: xarray.Dataset):
    figure = draw(plane)
    assert figure.get_suptitle() == "Acceleration along the track"
    for text in ("frequency 40 Hz", "amplitude 0.2 mm", "friction 0.5", "gamma 0°"):
        assert text in subtitle(figure)
    assert "frequency 60 Hz" in subtitle(draw(plane, at={"frequency": 60 * (1 + 1e-10)}))
    assert "gravity 9.80665 m/s²" in subtitle(figure)
    assert "rectangle-on-plane, physical" in subtitle(figure)


def test_axes_are_the_longest_in_the_order_of_the_dataset(plane: xarray.Dataset):
    axes = draw(plane).axes[0]
    assert axes.get_xlabel() == r"Drive azimuth $\alpha$ (°)"
    assert axes.get_ylabel() == r"Drive elevation $\beta$ (°)"
    turned = draw(plane, axes=("beta", "frequency"), kind="contour").axes[0]
    assert turned.get_xlabel().startswith("Drive elevation")
    assert turned.get_ylabel() == "Frequency $f$ (Hz)"


def test_small_lengths_are_read_in_millimetres(track: xarray.Dataset):
    axes = draw(track).axes[0]
    assert axes.get_xlabel() == r"Amplitude $A_{\mathrm{0}}$ (mm)"
    assert axes.get_xlim() == pytest.approx((0.02, 0.5))


def test_family_of_lines_has_at_most_seven_curves(plane: xarray.Dataset):
    figure = draw(plane, axes=("beta", "alpha"), kind="line", at={"frequency": 50})
    curves, regimes = figure.legends
    count = plane.sizes["alpha"]
    assert curves.get_title().get_text() == f"Drive azimuth $\\alpha$\n7 of {count} values"
    assert [text.get_text().replace("\N{MINUS SIGN}", "-") for text in curves.get_texts()] == [
        f"{angle}°" for angle in (45, 30, 15, 0, -15, -30, -45)
    ]
    assert [text.get_text() for text in regimes.get_texts()] == [
        "slip",
        "flight",
    ]


def test_background_of_a_line_is_divided_halfway_between_points(plane: xarray.Dataset):
    axes = draw(plane, axes=("beta",), at={"frequency": 60, "alpha": 0}, kind="line").axes[0]
    spans = [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in axes.patches]
    assert spans[0][0] == 0
    assert spans[-1][1] == 60
    states = plane["regime"].sel(frequency=60, alpha=0).values
    borders = plane["beta"].values[1:][np.diff(states) != 0] - 2.5
    assert [stop for _, stop in spans[:-1]] == pytest.approx(borders)


def test_output_with_fewer_dimensions_than_its_regime(plane: xarray.Dataset):
    figure = draw(plane, variable="throw_number", axes=("beta",), at={"alpha": -45})
    assert "alpha \N{MINUS SIGN}45°" in subtitle(figure)
    assert named(figure) == occurring(plane, alpha=-45, frequency=40)


def test_what_is_not_finite_is_blank():
    alpha = {"start": -90, "stop": 90, "num": 19}
    parameters = {**TRACK, "speed": 0.05, "alpha": alpha}
    del parameters["distance"]
    dataset = study("rectangle-on-track", ["stopping_distance"], **parameters)
    assert np.isinf(dataset["stopping_distance"]).any()
    for kind in ("contour", "levels", "line"):
        assert named(draw(dataset, kind=kind))
    dataset["stopping_distance"][:] = np.nan
    for kind in ("contour", "levels", "line"):
        assert named(draw(dataset, kind=kind))


def test_equal_values_and_two_points_are_drawn(plane: xarray.Dataset):
    flat = plane.isel(alpha=slice(2), beta=slice(2))
    flat["acceleration_x"][:] = 0
    for kind in ("contour", "levels", "line"):
        draw(flat, axes=None if kind == "line" else ("alpha", "beta"), kind=kind)


def test_axes_and_fixed_values_are_named_by_words(plane):
    look = {"kind": "contour", "variable": "acceleration_x"}
    letters = draw(plane, axes=("frequency", "beta"), at={"alpha": 30}, **look)
    words = draw(plane, axes=("frequency", "elevation"), at={"azimuth": 30}, **look)
    assert subtitle(letters) == subtitle(words)
    assert words.axes[0].get_ylabel() == letters.axes[0].get_ylabel()
    assert "elevation" in words.axes[0].get_ylabel()


def test_falling_and_logarithmic_axes():
    dataset = study(
        "rectangle-on-plane",
        ["acceleration_x"],
        frequency=50,
        amplitude={"start": "0.01 mm", "stop": "1 mm", "num": 21, "spacing": "log"},
        friction=[0.5, 0.3, 0.1],
        beta=20,
    )
    axes = draw(dataset, kind="contour").axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "linear")
    assert axes.get_ylim() == (0.1, 0.5)
    chosen = select(dataset, None, None, {}, None)
    assert chosen.values[-1, 0] == dataset["acceleration_x"].sel(friction=0.1).values[-1]


@pytest.mark.parametrize(
    ("asked", "place", "words"),
    [
        ({"variable": "aceleration_x"}, "variable", "Did you mean 'acceleration_x'?"),
        ({"variable": "regime"}, "variable", "every picture shades the regimes"),
        ({"axes": ("betta", "alpha")}, "axes", "Did you mean 'beta' (elevation)?"),
        ({"axes": ("beta", "beta")}, "axes", "different axes"),
        ({"axes": ("beta", "elevation")}, "axes", "different axes"),
        ({"at": {"climb": 1, "gamma": 2}}, "at.climb", "climb and gamma are the same angle"),
        ({"axes": ("alpha", "beta", "frequency")}, "axes", "one or two"),
        ({"kind": "countour"}, "kind", "Did you mean 'contour'?"),
        ({"kind": "contour", "axes": ("beta",)}, "kind", "needs two axes"),
        ({"kind": "surface"}, "kind", "Draw kind contour or levels"),
        ({"at": {"frequency": 61}}, "at.frequency", "The nearest are 50 and 60 Hz; --nearest"),
        ({"at": {"frequency": float("nan")}}, "at.frequency", "finite"),
        ({"at": {"friction": 0.4}}, "at.friction", "Its only value is 0.5."),
        ({"at": {"frequenzy": 60}}, "at.frequenzy", "Did you mean 'frequency'?"),
        ({"at": {"beta": 5}}, "at.beta", "is an axis of this picture"),
    ],
)
def test_what_cannot_be_drawn_is_said(
    plane: xarray.Dataset, asked: dict[str, object], place: str, words: str
):
    found = problem(plane, **asked)
    assert found.place == place
    assert words in str(found)


def test_one_value_is_no_picture():
    dataset = study("rectangle-on-plane", ["vibration_acceleration"], frequency=50, amplitude=1e-3)
    for kind in ("line", None):
        assert "nothing to draw" in problem(dataset, kind=kind).message


def test_an_output_over_one_axis_makes_no_contour(plane: xarray.Dataset):
    found = problem(plane, variable="vibration_acceleration", kind="contour")
    assert (found.place, found.fix) == ("kind", "Draw the output as kind line")


@pytest.mark.parametrize("part", ["regime", "scene"])
def test_other_datasets_are_refused(plane: xarray.Dataset, part: str):
    other = plane.copy()
    if part == "regime":
        del other["regime"]
    else:
        del other.attrs["scene"]
    assert problem(other).place == "dataset"


def test_other_files_are_refused(file: Path, tmp_path: Path):
    picture = tmp_path / "picture.png"
    text = tmp_path / "text.nc"
    text.write_text("no NetCDF")
    cut = tmp_path / "cut.nc"
    cut.write_bytes(file.read_bytes()[:3000])
    for wrong in (text, cut):
        with pytest.raises(PlotError, match="not a NetCDF file"):
            draw_file(wrong, [picture])
    with pytest.raises(FileNotFoundError) as caught:
        draw_file(tmp_path / "missing.nc", [picture])
    assert caught.value.filename == str(tmp_path / "missing.nc")
    with pytest.raises(PlotError) as refused:
        draw_file(file, [tmp_path / "picture.bmp"])
    assert refused.value.problem.place == "output"
    with pytest.raises(PlotError) as refused:
        draw_file(file, [picture], at={"frequency": "50 kg"})
    assert refused.value.problem.place == "at.frequency"
    assert not picture.exists()


def test_a_picture_that_cannot_be_written_leaves_nothing(file: Path, tmp_path: Path):
    target = tmp_path / "taken.png"
    target.mkdir()
    with pytest.raises(OSError, match=r"taken\.png") as caught:
        draw_file(file, [target])
    assert caught.value.filename == str(target)
    assert not list(tmp_path.glob(".*"))


@pytest.mark.parametrize(
    ("symbol", "shown"),
    [
        ("alpha", r"$\alpha$"),
        ("xi", r"$\xi$"),
        ("a_x", r"$a_{\mathrm{x}}$"),
        ("v_inf", r"$v_{\infty}$"),
        ("Gamma", r"$\Gamma$"),
        ("x/t(x)", ""),
        ("P cb ca", ""),
    ],
)
def test_symbols(symbol: str, shown: str):
    assert math_symbol(symbol) == shown


def test_pyplot_is_never_loaded(file: Path, tmp_path: Path):
    code = (
        "import sys; from pathlib import Path; from vibrafeed.core.plots.drawing import draw_file\n"
        "kinds = {'contour': 2, 'levels': 3, 'line': 2, 'map': 3}\n"
        "for kind, target in kinds.items():\n"
        "    draw_file(Path(sys.argv[1]), [Path(sys.argv[target])], kind=kind)\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run(
        [sys.executable, "-W", "error", "-c", code, file, tmp_path / "a.png", tmp_path / "a.svg"],
        check=True,
    )
