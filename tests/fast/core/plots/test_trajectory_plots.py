"""Pictures of one part over a cycle."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray

from pictures import legend, problem, subtitle
from vibrafeed.core.plots.drawing import draw, draw_file
from vibrafeed.core.plots.trajectory import read_trajectory
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.study.shown import read_shown

FREQUENCY = 50.0
GRAVITY = 9.80665


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
    assert swing == pytest.approx(0.3 * rate * np.cos(rate * dataset["cycle_time"].values))
    assert velocity - swing == pytest.approx(1000 * dataset["relative_velocity_along"].values)
    assert heights.get_ylabel() == "Height (mm)"
    assert velocities.get_ylabel() == "Velocity along\nthe track (mm/s)"
    assert positions.get_ylabel() == "Position on\nthe track (mm)"
    assert positions.get_xlabel() == "Time since the start of the cycle (ms)"
    assert positions.get_xlim() == pytest.approx((0, 20))


def test_trajectory_says_velocity_regime_and_modes():
    figure = draw(hop())
    assert figure.get_suptitle() == "Motion of the part on the moving track"
    for text in ("mean velocity 62.5 mm/s", "regime hopping", "friction 0.3", "A hop"):
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
    shown = read_trajectory(hop(times), read_shown(["si"]))
    rate = 2 * np.pi * FREQUENCY
    assert shown.track_velocity == pytest.approx(3e-4 * rate * np.cos(rate * times))


def driven(times: object = 400, **parameters: float) -> xarray.Dataset:
    """Return the part on a track whose drive is told by other parameters."""
    units = {"phase": "degree", "amplitude": "m", "acceleration": "m s-2", "duration": "1"}
    given = {"gravity": GRAVITY, "drive_factor": 1.0, **parameters}
    return hop(times).assign_coords({
        name: ((), value, {"units": units.get(name.split("_")[0], "1")})
        for name, value in given.items()
    })  # fmt: skip


def test_velocity_of_a_track_with_harmonics():
    times = np.array([0.0, 0.001, 0.009])
    given = {"amplitude_along_1": 3e-4, "phase_along_1": 0.0,
             "amplitude_along_2": 1e-4, "phase_along_2": 30.0}  # fmt: skip
    shown = read_trajectory(driven(times, **given), read_shown(["si"]))
    rate = 2 * np.pi * FREQUENCY
    second = 2e-4 * rate * np.cos(2 * rate * times + np.deg2rad(30))
    assert shown.track_velocity == pytest.approx(3e-4 * rate * np.cos(rate * times) + second)
    assert shown.orbit is None


def test_velocity_of_a_track_in_steps():
    given = {"acceleration_along_1": 4.0, "duration_1": 3.0, "duration_2": 1.0}
    shown = read_trajectory(driven(np.array([0.0, 0.0075, 0.015]), **given), read_shown(["si"]))
    assert shown.track_velocity == pytest.approx([-0.03, 0.0, 0.03], abs=1e-15)


def test_track_on_an_orbit_shows_it():
    given = {"amplitude_along_1": 3e-4, "amplitude_normal_1": 2e-4, "phase_along_1": 0.0}
    figure = draw(driven(**given, phase_normal_1=90.0))
    (inset,) = figure.axes[0].child_axes
    curve = inset.get_lines()[0].get_xydata()
    assert np.ptp(curve[:, 0]) == pytest.approx(1.5 * np.ptp(curve[:, 1]))
    assert inset.get_aspect() == 1
    # It covers no curve.
    top = figure.axes[0].transData.transform((0.0, figure.axes[0].dataLim.y1))[1]
    assert inset.get_window_extent().y0 > top
    assert not draw(driven(**given, phase_normal_1=180.0)).axes[0].child_axes


def test_drive_that_is_not_told_whole_is_a_problem():
    assert "no gravity" in problem(driven(amplitude_along_1=3e-4).drop_vars("gravity")).message


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
            "a picture of kind trajectory has no variable. Leave variable out",
        ),
        (hop(), {"kind": "trajectory", "axes": ("beta",)}, "axes", "Leave axes out"),
        (hop(), {"at": {"friction": 0.4}}, "at", "has no at"),
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
            "found no cycle",
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


def test_a_track_with_a_wall_shows_the_gap_to_it():
    course = hop()
    plane = draw(course)
    course["distance_from_wall"] = 0.1 * course["height_above_floor"]
    figure = draw(course)
    assert len(figure.axes) == len(plane.axes) + 1
    gap = figure.axes[-1]
    assert gap.get_ylabel() == "Gap to\nthe wall (mm)"
    drawn = gap.lines[-1].get_ydata()
    np.testing.assert_allclose(drawn, 1000 * course["distance_from_wall"])
    assert gap.get_ylim()[0] < 0  # where the wall is seen
    assert gap.get_xlabel()
    assert not figure.axes[-2].get_xlabel()
