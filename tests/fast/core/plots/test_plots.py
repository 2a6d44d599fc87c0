"""Pictures of closed forms: what is drawn, in which words and units, and what cannot be drawn."""

import struct
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray

import vibrafeed
from pictures import SPACE, hatches, legend, problem, regimes_in, subtitle
from vibrafeed.core.plots.drawing import draw, draw_file
from vibrafeed.core.plots.pictures import PICTURES, PlotError
from vibrafeed.core.plots.selection import select

TRACK = {
    "scene": "rectangle-on-track", "frequency": 50, "beta": 20, "friction": 0.3, "radius": 0.3,
    "amplitude": {"start": "0.02 mm", "stop": "0.5 mm", "num": 25},
}  # fmt: skip
KINDS = ("contour", "levels", "line")


@pytest.fixture(scope="module")
def plane() -> xarray.Dataset:
    """Three axes; stick, slip and flight."""
    return vibrafeed.sweep(
        "rectangle-on-plane",
        outputs=["acceleration_x", "throw_number", "vibration_acceleration"],
        frequency={"start": 20, "stop": 60, "num": 5}, amplitude="0.2 mm", friction=0.5,
        alpha={"start": -45, "stop": 45, "num": 19}, beta={"start": 0, "stop": 60, "num": 13},
    )  # fmt: skip


@pytest.fixture(scope="module")
def track() -> xarray.Dataset:
    return vibrafeed.sweep(
        **TRACK, outputs=["transport_velocity", "terminal_velocity"],
        alpha={"start": -20, "stop": 20, "num": 17}, distance="0.2 mm",
    )  # fmt: skip


@pytest.fixture
def file(plane, tmp_path) -> Path:
    plane.to_netcdf(tmp_path / "plane.nc", engine="netcdf4")
    return tmp_path / "plane.nc"


def note(figure) -> str:
    """Return what is said above the legend."""
    return figure.legends[-1].get_title().get_text()


def named(figure) -> set[str]:
    return {text.split(" (")[0] for text in legend(figure)}


# --- what is drawn


def test_files_are_png_and_svg(file, tmp_path):
    targets = [tmp_path / "picture.png", tmp_path / "picture.SVG"]
    draw_file(file, targets, kind="contour", at={"frequency": "50"})
    png = targets[0].read_bytes()
    assert png.startswith(b"\x89PNG")
    assert struct.unpack(">II", png[16:24]) == (1200, 960)
    tree = ElementTree.fromstring(targets[1].read_text("utf-8"))
    assert tree.tag.endswith("svg")


@pytest.mark.parametrize("kind", ["contour", "line"])
def test_the_legend_names_the_regimes_that_occur(plane, track, kind):
    figure = draw(plane, axes=("frequency", "beta"), at={"alpha": 0}, kind=kind)
    assert named(figure) == regimes_in(plane, alpha=0) == {"stick", "slip", "flight"}
    lost = draw(track, axes=("amplitude", "alpha"), kind=kind)
    assert "wall lost" in legend(lost)
    assert "the closed forms do not describe a part there" in note(lost)
    assert named(lost) == regimes_in(track) or kind == "line"


def test_what_is_not_valid_is_veiled_and_hatched_and_what_is_exact_is_not(plane):
    doubtful = draw(plane, at={"frequency": 50})
    assert "///" in hatches(doubtful.axes[0])
    widths = [np.atleast_1d(line.get_linewidths()) for line in doubtful.axes[0].collections]
    assert sum(2.2 in width for width in widths) == 1
    exact = draw(plane, variable="throw_number", axes=("frequency", "beta"), kind="contour")
    assert "///" not in hatches(exact.axes[0])
    assert not note(exact)
    assert legend(exact) == ["stick", "slip", "flight"]


def test_lift_off_is_marked_where_the_throw_number_is_one(plane):
    axes = draw(plane, variable="throw_number", axes=("beta",), at={"frequency": 60}).axes[0]
    assert "1: lift-off" in [text.get_text() for text in axes.texts]
    assert any(np.allclose(line.get_ydata(), 1.0) for line in axes.lines)
    low = draw(plane.isel(beta=slice(3)), variable="throw_number", axes=("beta",)).axes[0]
    assert not low.texts


def test_background_of_a_line_is_divided_halfway_between_points(plane):
    axes = draw(plane, axes=("beta",), at={"frequency": 60, "alpha": 0}, kind="line").axes[0]
    spans = [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in axes.patches]
    assert (spans[0][0], spans[-1][1]) == (0, 60)
    states = plane["regime"].sel(frequency=60, alpha=0).values
    borders = plane["beta"].values[1:][np.diff(states) != 0] - 2.5
    assert [stop for _, stop in spans[:-1]] == pytest.approx(borders)


@pytest.mark.parametrize(("count", "marker"), [(2, "o"), (3, "")])
def test_curves_of_two_points_show_them(plane, count, marker):
    parts = [plane.sel(frequency=f, alpha=0).isel(beta=slice(count)) for f in (40, 60)]
    lines = draw(parts, variable="throw_number").axes[0].lines
    assert [line.get_marker() for line in lines if line.get_zorder() == 3] == [marker] * 2


def test_an_output_with_fewer_dimensions_than_its_regime(plane):
    figure = draw(plane, variable="throw_number", axes=("beta",), at={"alpha": -45})
    assert "alpha \N{MINUS SIGN}45°" in subtitle(figure)
    assert named(figure) == regimes_in(plane, alpha=-45, frequency=40)


def test_what_is_not_finite_or_all_equal_is_drawn(plane):
    parameters = {**TRACK, "speed": 0.05, "alpha": {"start": -90, "stop": 90, "num": 19}}
    endless = vibrafeed.sweep(**parameters, outputs=["stopping_distance"])
    assert np.isinf(endless["stopping_distance"]).any()
    flat = plane.isel(alpha=slice(2), beta=slice(2))
    flat["acceleration_x"][:] = 0
    for kind in KINDS:
        assert named(draw(endless, kind=kind))
        assert named(draw(flat, axes=None if kind == "line" else ("alpha", "beta"), kind=kind))


# --- axes, names and units


def test_the_title_says_what_is_fixed(plane):
    figure = draw(plane)
    assert figure.get_suptitle() == "Acceleration along the track"
    for text in (
        "frequency 40 Hz", "amplitude 0.2 mm", "friction 0.5", "gamma 0°", "gravity 9.80665 m/s²",
        "rectangle-on-plane, physical",
    ):  # fmt: skip
        assert text in subtitle(figure)
    assert "frequency 60 Hz" in subtitle(draw(plane, at={"frequency": 60 * (1 + 1e-10)}))
    near = draw(plane, axes=("beta",), at={"frequency": 57, "alpha": 0}, nearest=True)
    assert "frequency 60 Hz" in subtitle(near)
    brief = draw(plane, axes=("beta",), title="Mine", small=True)
    assert brief.get_suptitle() == "Mine"
    *facts, source = subtitle(brief).splitlines()
    assert len(facts) > 1
    assert "gravity" in " ".join(facts)
    assert source.endswith("(rectangle-on-plane …")


def test_axes_are_the_longest_in_the_order_of_the_dataset(plane, track):
    axes = draw(plane).axes[0]
    assert axes.get_xlabel() == r"Drive azimuth $\alpha$ (°)"
    assert axes.get_ylabel() == r"Drive elevation $\beta$ (°)"
    turned = draw(plane, axes=("elevation", "frequency"), at={"azimuth": 30}, kind="contour")
    assert turned.axes[0].get_xlabel() == axes.get_ylabel()
    assert turned.axes[0].get_ylabel() == "Frequency $f$ (Hz)"
    assert "alpha 30°" in subtitle(turned)
    small = draw(track).axes[0]
    assert small.get_xlabel() == r"Amplitude $A_{\mathrm{0}}$ (mm)"
    assert small.get_xlim() == pytest.approx((0.02, 0.5))


def test_falling_and_logarithmic_axes():
    amplitude = {"start": "0.01 mm", "stop": "1 mm", "num": 21, "spacing": "log"}
    dataset = vibrafeed.sweep(
        "rectangle-on-plane", outputs=["acceleration_x"], frequency=50, amplitude=amplitude,
        friction=[0.5, 0.3, 0.1], beta=20,
    )  # fmt: skip
    for kind in ("contour", "map"):
        axes = draw(dataset, kind=kind).axes[0]
        assert (axes.get_xscale(), axes.get_yscale()) == ("log", "linear")
        assert axes.get_ylim() == (0.1, 0.5)
    chosen = select(dataset, None, None, {}, None)
    assert chosen.values[-1, 0] == dataset["acceleration_x"].sel(friction=0.1).values[-1]


def test_few_values_of_an_axis_make_curves_and_many_make_seven(plane):
    few = draw(plane.sel(frequency=[40, 50, 60]), variable="throw_number")
    names = [text.get_text().replace(SPACE, " ") for text in few.legends[0].get_texts()]
    assert names == ["60 Hz", "50 Hz", "40 Hz"]
    assert len(draw(plane, variable="throw_number", kind="contour").axes) == 2  # a colour bar
    curves, regimes = draw(plane, axes=("beta", "alpha"), kind="line", at={"frequency": 50}).legends
    assert curves.get_title().get_text() == "Drive azimuth $\\alpha$\n7 of 19 values"
    assert [text.get_text().replace("\N{MINUS SIGN}", "-") for text in curves.get_texts()] == [
        f"{angle}°" for angle in (45, 30, 15, 0, -15, -30, -45)
    ]
    assert [text.get_text() for text in regimes.get_texts()] == ["slip", "flight"]


def test_numbers_in_names_are_told_from_values():
    figure = draw(vibrafeed.sweep(Path(__file__).parents[4] / "configs/impact-rectangles.toml"))
    assert "restitution 0.6 · position x₁ 5 mm · position y₁ 20.9641 mm" in subtitle(figure)
    assert figure.axes[1].get_ylabel() == "Normal impulse (mN s)"


# --- what cannot be drawn


@pytest.mark.parametrize(
    ("asked", "place", "words"),
    [
        ({"variable": "aceleration_x"}, "variable", "Did you mean 'acceleration_x'?"),
        ({"variable": "regime"}, "variable", "every picture shades the regimes"),
        ({"axes": ("betta", "alpha")}, "axes", "Did you mean 'beta' (elevation)?"),
        ({"axes": ("beta", "elevation")}, "axes", "different axes"),
        ({"at": {"climb": 1, "gamma": 2}}, "at.climb", "climb and gamma are the same angle"),
        ({"axes": ("alpha", "beta", "frequency")}, "axes", "one or two"),
        ({"kind": "countour"}, "kind", "Did you mean 'contour'?"),
        ({"kind": "contour", "axes": ("beta",)}, "kind", "needs two axes"),
        ({"kind": "levels", "axes": ("beta",)}, "kind", "kind levels needs two axes"),
        ({"kind": "surface"}, "kind", "Draw kind contour or levels"),
        (
            {"kind": "map", "variable": "throw_number"},
            "variable",
            "the values of throw_number are numbers",
        ),
        ({"kind": "contour", "variable": "vibration_acceleration"}, "kind", "as kind line"),
        ({"at": {"frequency": 61}}, "at.frequency", "The nearest are 50 and 60 Hz; --nearest"),
        ({"at": {"frequency": float("nan")}}, "at.frequency", "finite"),
        ({"at": {"frequency": np.nan}, "nearest": True}, "at.frequency", "finite"),
        ({"nearest": True}, "nearest", "nearest has no effect without at"),
        ({"at": {"friction": 0.4}}, "at.friction", "Its only value is 0.5."),
        ({"at": {"frequenzy": 60}}, "at.frequenzy", "Did you mean 'frequency'?"),
        ({"at": {"beta": 5}}, "at.beta", "is an axis of this picture"),
        ({"units": "kelvin"}, "units", "'kelvin' is not a unit that vibrafeed knows"),
    ],
)
def test_what_cannot_be_drawn_is_said(plane, asked, place, words):
    found = problem(plane, **asked)
    assert found.place == place
    assert words in str(found)


def test_what_is_no_result_is_refused(plane):
    point = plane.isel(frequency=0, alpha=0, beta=0)
    for kind in ("line", None):
        assert "nothing to draw" in problem(point, kind=kind).message
    assert problem(plane.drop_vars("regime")).place == "dataset"
    assert problem(plane.drop_attrs()).place == "dataset"
    for given in (3, None, [3], {"a": 1}):
        with pytest.raises(PlotError, match=r"is not a dataset\. Give a dataset"):
            vibrafeed.plot(given)
    for name in PICTURES:
        assert name in vibrafeed.plot.__doc__


def test_other_files_are_refused(file, tmp_path):
    picture = tmp_path / "picture.png"
    (tmp_path / "text.nc").write_text("no NetCDF")
    (tmp_path / "cut.nc").write_bytes(file.read_bytes()[:3000])
    for wrong in ("text.nc", "cut.nc"):
        with pytest.raises(PlotError, match="not a NetCDF file"):
            draw_file(tmp_path / wrong, [picture])
    with pytest.raises(FileNotFoundError) as caught:
        draw_file(tmp_path / "missing.nc", [picture])
    assert caught.value.filename == str(tmp_path / "missing.nc")
    with pytest.raises(PlotError, match=r"\.png"):
        draw_file(file, [tmp_path / "picture.bmp"])
    with pytest.raises(PlotError, match=r"at\.frequency"):
        draw_file(file, [picture], at={"frequency": "50 kg"})
    assert not picture.exists()
    picture.mkdir()
    with pytest.raises(OSError, match=r"picture\.png") as caught:
        draw_file(file, [picture])
    assert caught.value.filename == str(picture)
    assert not list(tmp_path.glob(".*"))
