"""Pictures of motion: regime maps, velocities with their spread, one part over a cycle."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
import xarray
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from scipy.ndimage import label

from core.motion import simulate
from core.motion.systems import SYSTEMS
from core.plots import PlotError, draw, draw_file
from core.plots.islands import without_specks
from core.plots.regimes import FILLS, LOOKS
from core.plots.trajectory import read_trajectory
from core.quantities import REGIMES
from core.scenes import SCENES
from core.study import parse_study
from core.sweep import sweep

OUTPUTS = ["conveying_velocity", "conveying_velocity_spread"]
FREQUENCY = 50.0
GRAVITY = 9.80665
SPACE = "\N{NO-BREAK SPACE}"


def simulation(outputs: list[str] = OUTPUTS, **parameters: object) -> xarray.Dataset:
    return simulate(
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


def hop(times: object = 400, **changes: object) -> xarray.Dataset:
    """Return a part that rests on the track, hops from it at its largest velocity, and lands.

    The numbers need not solve the equations of motion: a picture shows what it is given.
    """
    period = 1 / FREQUENCY
    time = np.linspace(0.0, period, times) if isinstance(times, int) else np.asarray(times, float)
    phase = 2 * np.pi * FREQUENCY * time
    aloft = np.clip(time - 0.25 * period, 0.0, 0.5 * period)
    height = aloft * (0.5 * period - aloft) * GRAVITY / 2
    mode = np.where(
        height > 0, 3, np.where(time < 0.2 * period, 0, np.where(time < 0.7 * period, 1, 2))
    )

    def over_time(values: object, units: str) -> tuple[str, object, dict[str, str]]:
        return "cycle_time", values, {"units": units}

    dataset = xarray.Dataset(
        {
            "conveying_velocity": ((), 0.0625, {"units": "m s-1"}),
            "regime": (
                (),
                np.int8(REGIMES["hopping"].value),
                {"flag_values": np.int8([REGIMES["hopping"].value]), "flag_meanings": "hopping"},
            ),
            "position_along": over_time(0.0625 * time, "m"),
            "height_above_floor": over_time(height, "m"),
            "relative_velocity_along": over_time(np.full(time.size, 0.0625), "m s-1"),
            "relative_velocity_normal": over_time(np.gradient(height, time), "m s-1")
            if time.size > 1
            else over_time(height, "m s-1"),
            "track_along": over_time(3e-4 * np.sin(phase), "m"),
            "track_normal": over_time(2e-4 * np.sin(phase), "m"),
            "motion_mode": (
                "cycle_time",
                mode.astype(np.int8),
                {
                    "flag_values": np.arange(4, dtype=np.int8),
                    "flag_meanings": "stick forward backward flight",
                },
            ),
        },
        coords={
            "cycle_time": over_time(time, "s"),
            "frequency": ((), FREQUENCY, {"units": "s-1"}),
            "friction": ((), 0.3, {"units": "1"}),
            "tolerance": ((), 1e-12, {"units": "1"}),
        },
        attrs={"scene": "rectangle-on-plane", "method": "events", "title": "A hop"},
    )
    return dataset.assign(changes)


def legend(figure: Figure) -> list[str]:
    return [text.get_text().replace(SPACE, " ") for text in figure.legends[-1].get_texts()]


def subtitle(figure: Figure) -> str:
    return figure.axes[0].get_title(loc="left").replace(SPACE, " ")


def names_of(dataset: xarray.Dataset, **at: float) -> set[str]:
    values = np.unique(dataset["regime"].sel(at, method="nearest"))
    return {name.replace("_", " ") for name, regime in REGIMES.items() if regime.value in values}


def problem(dataset: xarray.Dataset, **asked: object):
    with pytest.raises(PlotError) as caught:
        draw(dataset, **asked)
    return caught.value.problem


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
    # The cells at the ends are half as wide: their middles lie on the frame.
    weights = [np.r_[0.5, np.ones(size - 2), 0.5] / (size - 1) for size in (25, 21)]
    hops = plane["regime"].sel(friction=0.3).values == REGIMES["hopping"].value
    expected = float(weights[0] @ hops @ weights[1])
    assert shares["hopping"] == f"{100 * expected:.0f} %"


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


def test_specks_have_no_border(bouncing: xarray.Dataset):
    states = bouncing["regime"].values
    plain = without_specks(states)
    assert 0 < (plain != states).mean() < 0.5
    for value in np.unique(plain):
        islands, _ = label(plain == value)
        assert np.bincount(islands.ravel())[1:].min() >= 0.005 * states.size
    assert set(np.unique(plain)) <= set(np.unique(states))
    # Fills and shares show every cell all the same.
    figure = draw(bouncing, kind="map")
    assert {entry.rsplit(", ", 1)[0] for entry in legend(figure)} == names_of(bouncing)
    few = np.ones((30, 30), dtype=np.int64)
    few[3, 4] = few[20:22, 5] = 2
    assert np.array_equal(without_specks(few), few)


def test_map_of_closed_forms_on_a_logarithmic_axis():
    dataset = sweep(
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
    assert any(entry.startswith("flight (closed forms invalid), ") for entry in legend(figure))


@pytest.mark.parametrize("target", ["picture.png", "picture.svg"])
def test_map_of_a_file(plane: xarray.Dataset, tmp_path: Path, target: str):
    plane.to_netcdf(tmp_path / "plane.nc", engine="netcdf4")
    draw_file(tmp_path / "plane.nc", [tmp_path / target], kind="map", at={"friction": "0.3"})
    # The cells are one image in an SVG, not a shape each.
    assert 10_000 < (tmp_path / target).stat().st_size < 400_000


@pytest.mark.parametrize(
    ("asked", "place", "words"),
    [
        ({"kind": "map", "axes": ("beta",)}, "kind", "a map needs two axes, there is one, beta"),
        ({"kind": "map", "variable": "speed"}, "variable", "'speed' is unknown"),
        ({"kind": "mapp"}, "kind", "Did you mean 'map'?"),
        ({"kind": "map", "axes": ("beta", "alpha")}, "axes", "no dimension 'alpha'"),
        ({"kind": "map", "at": {"friction": 0.2}}, "at.friction", "The nearest are"),
        ({"variable": "regime"}, "variable", "Ask for kind map"),
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


# --- looks


def test_every_regime_has_a_look():
    assert LOOKS.keys() == REGIMES.keys()
    assert FILLS.keys() == {name for name, regime in REGIMES.items() if regime.valid}


@pytest.mark.parametrize(
    ("scene", "variant"),
    [
        (scene, variant)
        for scene in (*SCENES.values(), *SYSTEMS.values())
        for variant in scene.conditions
    ],
    ids=lambda part: getattr(part, "name", part),
)
def test_regimes_of_a_scene_look_different_on_a_map(scene, variant: str):
    conditions = scene.conditions[variant]
    names = {condition.regime for condition in conditions}
    names |= {condition.otherwise for condition in conditions if condition.otherwise}
    fills = [FILLS[name] for name in names if REGIMES[name].valid]
    assert len(set(fills)) == len(fills)
    hatches = [LOOKS[name][:2] for name in names if not REGIMES[name].valid]
    assert len(set(hatches)) == len(hatches)


# How a colour in linear RGB is seen: G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, IEEE Trans.
# Vis. Comput. Graph. 15 (2009) 1291, table 1, severity 1.
SIGHT = {
    "full": np.eye(3),
    "without red": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "without green": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "without blue": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def lab(colour: str, sight: object) -> np.ndarray:
    """Return CIE L*a*b* of a colour as it is seen, white point D65."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    seen = np.clip(np.asarray(sight) @ linear, 0, 1)
    x, y, z = np.cbrt(np.maximum(TO_XYZ @ seen / TO_XYZ.sum(axis=1), 0.008856))
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("sight", SIGHT)
def test_fills_of_motion_are_told_apart_in_every_colour_vision(sight: str):
    # A difference of 2.3 is just seen on neighbouring patches, 10 at a glance.
    names = {condition.regime for condition in SYSTEMS["rectangle-on-plane"].conditions["events"]}
    fills = [FILLS[name] for name in (*names, "slip") if name in FILLS]
    assert len(fills) == 8
    for one, other in itertools.combinations(fills, 2):
        assert np.linalg.norm(lab(one, SIGHT[sight]) - lab(other, SIGHT[sight])) > 10


# --- velocity over one axis


def test_spread_is_a_band_where_it_is_not_zero(bouncing: xarray.Dataset, plane: xarray.Dataset):
    line = bouncing.isel(beta=8)
    assert (line["conveying_velocity_spread"] > 0).any()
    figure = draw(line)
    assert "\N{PLUS-MINUS SIGN} spread" in legend(figure)
    band = figure.axes[0].collections[-1].get_paths()[0].vertices
    velocity, spread = line["conveying_velocity"].values, line["conveying_velocity_spread"].values
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


# --- one part over a cycle


def test_trajectory_shows_the_part_over_the_track():
    dataset = hop()
    figure = draw(dataset)
    heights, velocities, positions = figure.axes
    track, part = (line.get_xydata() for line in heights.get_lines() if len(line.get_xydata()) > 2)
    assert track[:, 0] == pytest.approx(1000 * dataset["cycle_time"].values)
    assert track[:, 1] == pytest.approx(1000 * dataset["track_normal"].values)
    assert part[:, 1] - track[:, 1] == pytest.approx(1000 * dataset["height_above_floor"].values)
    swing, velocity = (
        line.get_xydata()[:, 1] for line in velocities.get_lines() if len(line.get_xydata()) > 2
    )
    rate = 2 * np.pi * FREQUENCY
    # The derivative of the track's place, 0.3 mm sin(wt).
    assert swing == pytest.approx(3e-4 * rate * np.cos(rate * dataset["cycle_time"].values))
    assert velocity - swing == pytest.approx(dataset["relative_velocity_along"].values)
    assert heights.get_ylabel() == "Height (mm)"
    assert velocities.get_ylabel() == "Velocity along\nthe track (m/s)"
    assert positions.get_ylabel() == "Position on\nthe track (mm)"
    assert positions.get_xlabel() == "Time since the start of the cycle (ms)"
    assert positions.get_xlim() == pytest.approx((0, 20))


def test_trajectory_says_velocity_regime_and_modes():
    figure = draw(hop())
    assert figure.get_suptitle() == "Motion of the part on the moving track"
    for text in ("mean velocity 0.0625 m/s", "regime hopping", "friction 0.3", "A hop"):
        assert text in subtitle(figure)
    assert "tolerance" not in subtitle(figure)
    assert legend(figure) == [
        "part", "track", "sticking", "sliding forward", "sliding backward", "in flight",
    ]  # fmt: skip
    still = hop()["motion_mode"].copy(data=np.zeros(400, np.int8))
    assert legend(draw(hop(motion_mode=still))) == [
        "part", "track", "sticking",
    ]  # fmt: skip
    spans = [patch.get_x() for patch in figure.axes[1].patches]
    assert np.array(spans) == pytest.approx([0, 4, 5, 15], abs=0.1)  # a step is 0.05 ms
    quiet = hop().drop_vars("conveying_velocity")
    assert "mean velocity" not in subtitle(draw(quiet))


def test_velocity_of_the_track_needs_few_times():
    times = np.array([0.0, 0.001, 0.009])
    shown = read_trajectory(hop(times), None, None, {})
    rate = 2 * np.pi * FREQUENCY
    assert shown.track_velocity == pytest.approx(3e-4 * rate * np.cos(rate * times))


def test_periods_of_a_long_cycle_are_marked():
    def marks(periods: int) -> int:
        axes = draw(hop(np.linspace(0, periods / FREQUENCY, 400))).axes[0]
        return sum(line.get_linestyle() == ":" for line in axes.get_lines())

    assert marks(2) == 3
    assert marks(50) == 0


def test_part_at_rest_has_an_axis_of_the_same_unit():
    still = np.zeros(400)
    dataset = hop()
    for name in ("position_along", "height_above_floor", "relative_velocity_along"):
        dataset[name][:] = still
    heights, _, positions = draw(dataset).axes
    assert positions.get_ylabel() == "Position on\nthe track (mm)"
    assert positions.get_ylim() == heights.get_ylim()


def test_output_over_the_cycle_is_drawn_as_a_line():
    figure = draw(hop(), variable="height_above_floor")
    assert len(figure.axes) == 1
    assert legend(figure) == ["hopping"]


def test_trajectory_of_a_file(tmp_path: Path):
    hop().to_netcdf(tmp_path / "hop.nc", engine="netcdf4")
    targets = [tmp_path / "hop.png", tmp_path / "hop.svg"]
    draw_file(tmp_path / "hop.nc", targets)
    assert all(target.stat().st_size > 20_000 for target in targets)


@pytest.mark.parametrize(
    ("dataset", "asked", "place", "words"),
    [
        (
            hop(),
            {"kind": "trajectory", "variable": "height_above_floor"},
            "variable",
            "ask for kind line",
        ),
        (hop(), {"kind": "trajectory", "axes": ("beta",)}, "axes", "Leave axes out"),
        (hop(), {"at": {"friction": 0.4}}, "at.friction", "Its only value is 0.3."),
        (
            hop().drop_vars("height_above_floor"),
            {},
            "dataset",
            "its motion has no height_above_floor",
        ),
        (hop().drop_vars("frequency"), {}, "dataset", "its motion has no frequency"),
        (hop([0.0]), {}, "dataset", "one time only"),
        (
            hop(height_above_floor=hop()["height_above_floor"] * np.nan),
            {},
            "dataset",
            "no cycle was found",
        ),
        (hop(motion_mode=hop()["motion_mode"] + 7), {}, "dataset", "has no name"),
        (hop(), {"kind": "map"}, "variable", "nothing to draw"),
    ],
)
def test_what_is_no_trajectory_is_said(
    dataset: xarray.Dataset, asked: dict[str, object], place: str, words: str
):
    found = problem(dataset, **asked)
    assert found.place == place
    assert words in str(found)
