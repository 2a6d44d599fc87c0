"""Pictures of one part over a cycle."""

from pathlib import Path

import numpy as np
import pytest
import xarray

import vibrafeed
from pictures import legend, problem, subtitle
from vibrafeed.core.plots.drawing import draw
from vibrafeed.core.plots.trajectory import read_trajectory
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.study.shown import read_shown

FREQUENCY, GRAVITY = 50.0, 9.80665
RATE = 2 * np.pi * FREQUENCY
ORBIT = {"amplitude_along_1": 3e-4, "amplitude_normal_1": 2e-4, "phase_along_1": 0.0}


def flags(values: list[int], meanings: str) -> dict[str, object]:
    return {"flag_values": np.int8(values), "flag_meanings": meanings}


def hop(times: object = 400, **changes: object) -> xarray.Dataset:
    """Return a part that rests on the track, hops from it at its largest velocity, and lands.

    The numbers need not solve the equations of motion: a picture shows what it is given.
    """
    period = 1 / FREQUENCY
    time = np.linspace(0.0, period, times) if isinstance(times, int) else np.asarray(times, float)
    aloft = np.clip(time - 0.25 * period, 0.0, 0.5 * period)
    height = aloft * (0.5 * period - aloft) * GRAVITY / 2
    late = np.searchsorted([0.2 * period, 0.7 * period], time, side="right")
    regime = REGIMES["hopping"].value
    of_time = {
        "position_along": (0.0625 * time, "m"),
        "height_above_floor": (height, "m"),
        "relative_velocity_along": (np.full(time.size, 0.0625), "m s-1"),
        "relative_velocity_normal": (0 * height, "m s-1"),
        "track_along": (3e-4 * np.sin(RATE * time), "m"),
        "track_normal": (2e-4 * np.sin(RATE * time), "m"),
    }
    modes = flags([0, 1, 2, 3], "stick forward backward flight")
    dataset = xarray.Dataset(
        {
            "conveying_velocity": ((), 0.0625, {"units": "m s-1"}),
            "regime": ((), np.int8(regime), flags([regime], "hopping")),
            "motion_mode": ("cycle_time", np.where(height > 0, 3, late).astype(np.int8), modes),
            **{name: ("cycle_time", values, {"units": unit})
               for name, (values, unit) in of_time.items()},
        },
        coords={
            "cycle_time": ("cycle_time", time, {"units": "s"}),
            "frequency": ((), FREQUENCY, {"units": "s-1"}),
            "friction": ((), 0.3, {"units": "1"}),
            "tolerance": ((), 1e-12, {"units": "1"}),
        },
        attrs={"scene": "rectangle-on-plane", "method": "events", "title": "A hop"},
    )  # fmt: skip
    return dataset.assign(changes)


def driven(times: object = 400, **parameters: float) -> xarray.Dataset:
    """Return the part on a track whose drive is told by other parameters."""
    units = {"phase": "degree", "amplitude": "m", "acceleration": "m s-2", "duration": "1"}
    given = {"gravity": GRAVITY, "drive_factor": 1.0, **parameters}
    return hop(times).assign_coords({
        name: ((), value, {"units": units.get(name.split("_")[0], "1")})
        for name, value in given.items()
    })  # fmt: skip


def test_a_trajectory_shows_the_part_over_the_track():
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
    # The derivative of the track's place, 0.3 mm sin(wt).
    assert swing == pytest.approx(0.3 * RATE * np.cos(RATE * dataset["cycle_time"].values))
    assert velocity - swing == pytest.approx(1000 * dataset["relative_velocity_along"].values)
    labels = ["Height (mm)", "Velocity along\nthe track (mm/s)", "Position on\nthe track (mm)"]
    assert [axes.get_ylabel() for axes in figure.axes] == labels
    assert positions.get_xlim() == pytest.approx((0, 20))


def test_a_trajectory_says_velocity_regime_and_modes():
    figure = draw(hop())
    assert figure.get_suptitle() == "Motion of the part on the moving track"
    for text in ("mean velocity 62.5 mm/s", "regime hopping", "friction 0.3", "A hop"):
        assert text in subtitle(figure)
    assert "tolerance" not in subtitle(figure)
    modes = ["sticking", "sliding forward", "sliding backward", "in flight"]
    assert legend(figure) == ["part", "track", *modes]
    spans = [patch.get_x() for patch in figure.axes[1].patches]
    assert np.array(spans) == pytest.approx([0, 4, 5, 15], abs=0.1)  # a step is 0.05 ms
    still = hop()["motion_mode"].copy(data=np.zeros(400, np.int8))
    quiet = draw(hop(motion_mode=still).drop_vars("conveying_velocity"))
    assert legend(quiet) == ["part", "track", "sticking"]
    assert "mean velocity" not in subtitle(quiet)


def test_the_velocity_of_the_track_is_that_of_its_drive():
    times = np.array([0.0, 0.001, 0.009])
    sine = 3e-4 * RATE * np.cos(RATE * times)
    harmonics = {"amplitude_along_1": 3e-4, "phase_along_1": 0.0,
                 "amplitude_along_2": 1e-4, "phase_along_2": 30.0}  # fmt: skip
    second = 2e-4 * RATE * np.cos(2 * RATE * times + np.deg2rad(30))
    steps = {"acceleration_along_1": 4.0, "duration_1": 3.0, "duration_2": 1.0}
    stepped = driven([0.0, 0.0075, 0.015], **steps)
    for dataset, velocity in (
        (hop(times), sine), (driven(times, **harmonics), sine + second),
        (stepped, [-0.03, 0.0, 0.03]),
    ):  # fmt: skip
        shown = read_trajectory(dataset, read_shown(["si"]))
        assert shown.track_velocity == pytest.approx(velocity, abs=1e-15)
    told = problem(driven(amplitude_along_1=3e-4).drop_vars("gravity"))
    assert "no gravity" in told.message


def test_a_track_on_an_orbit_shows_it():
    figure = draw(driven(**ORBIT, phase_normal_1=90.0))
    (inset,) = figure.axes[0].child_axes
    curve = inset.get_lines()[0].get_xydata()
    assert np.ptp(curve[:, 0]) == pytest.approx(1.5 * np.ptp(curve[:, 1]))
    assert inset.get_aspect() == 1
    # It covers no curve.
    top = figure.axes[0].transData.transform((0.0, figure.axes[0].dataLim.y1))[1]
    assert inset.get_window_extent().y0 > top
    assert not draw(driven(**ORBIT, phase_normal_1=180.0)).axes[0].child_axes


def test_periods_of_a_long_cycle_are_marked():
    for periods, marks in ((2, 3), (50, 0)):
        axes = draw(hop(np.linspace(0, periods / FREQUENCY, 400))).axes[0]
        assert sum(line.get_linestyle() == ":" for line in axes.get_lines()) == marks


def test_a_part_at_rest_and_one_output_over_the_cycle():
    dataset = hop()
    assert legend(draw(dataset, variable="height_above_floor")) == ["hopping"]
    for name in ("position_along", "height_above_floor", "relative_velocity_along"):
        dataset[name][:] = 0.0
    heights, _, positions = draw(dataset).axes
    assert positions.get_ylabel() == "Position on\nthe track (mm)"
    assert positions.get_ylim() == heights.get_ylim()


@pytest.mark.parametrize(
    ("dataset", "asked", "place", "words"),
    [
        (hop(), {"kind": "trajectory", "variable": "height_above_floor"}, "variable",
         "a picture of kind trajectory does not use variable. Leave"),
        (hop(), {"kind": "trajectory", "axes": ("beta",)}, "axes", "Leave axes out"),
        (hop(), {"at": {"friction": 0.4}}, "at", "does not use at"),
        (hop().drop_vars("height_above_floor"), {}, "dataset", "has no height_above_floor"),
        (hop().drop_vars("frequency"), {}, "dataset", "its motion has no frequency"),
        (hop([0.0]), {}, "dataset", "one time only"),
        (hop(height_above_floor=hop()["height_above_floor"] * np.nan), {}, "dataset",
         "found no cycle"),
        (hop(motion_mode=hop()["motion_mode"] + 7), {}, "dataset", "has no name"),
        (hop(), {"kind": "map"}, "variable", "nothing to draw"),
    ],
)  # fmt: skip
def test_what_is_no_trajectory_is_said(dataset, asked, place, words):
    found = problem(dataset, **asked)
    assert found.place == place
    assert words in str(found)


def test_a_track_with_a_wall_shows_the_gap_to_it():
    course = hop()
    course["distance_from_wall"] = 0.1 * course["height_above_floor"]
    *_, above, gap = draw(course).axes
    assert gap.get_ylabel() == "Gap to\nthe wall (mm)"
    np.testing.assert_allclose(gap.lines[-1].get_ydata(), 1000 * course["distance_from_wall"])
    assert gap.get_ylim()[0] < 0  # where the wall is seen
    assert gap.get_xlabel()
    assert not above.get_xlabel()


def test_the_course_of_a_tumbling_part():
    study = Path(__file__).parents[4] / "configs" / "tumbling-course.toml"
    dataset = vibrafeed.simulate(study, trajectory=100)
    figure = draw(dataset)
    side, gaps, turns = figure.axes
    assert "rests on the side at pitch 0° after 0.177 s" in subtitle(figure)
    first, last = (patch.get_xy() for patch in side.patches if patch.get_zorder() == 4)
    # 20 by 8 mm, dropped with its lowest corner 10 mm above the plane, pitched by 60 degrees.
    assert first[:, 1].min() == pytest.approx(10.0)
    assert np.ptp(first[:, 1]) == pytest.approx(20 * np.sin(np.pi / 3) + 8 * np.cos(np.pi / 3))
    assert np.ptp(last[:, 0]) == pytest.approx(20.0, rel=1e-3)
    assert gaps.lines[0].get_ydata()[0] == pytest.approx(10.0)
    assert turns.lines[0].get_ydata()[0] == pytest.approx(60.0)
    assert problem(dataset.drop_vars("path_pitch")).message == "its motion has no path_pitch"
