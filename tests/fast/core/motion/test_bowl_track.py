"""The track of a bowl in stretches: geometry, each place by itself, what passes the whole."""

import numpy as np
import pytest
from scipy.integrate import quad

import vibrafeed
from refusals import places_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.mechanics.drive_unit import Stretches, radius_at, total_length
from vibrafeed.core.motion.bowl_track import (
    CONDITIONS,
    AlongTrack,
    track_of,
)
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes.scene import Equation

BOWL = {
    "moving_mass": 12, "base_mass": 40, "moving_inertia": 0.25, "base_inertia": 0.9,
    "spring_radius": 0.15, "spring_angle": 20, "ring_down_frequency": 53, "frequency": 50,
    "drive_force": 100, "damping_ratio": 0.02,
}  # fmt: skip
TRACK = {
    "start_radius": 0.1, "stretch_radius_1": 0.16, "stretch_turns_1": 2, "stretch_climb_1": 2,
    "stretch_friction_1": 0.3, "stretch_radius_2": 0.18, "stretch_turns_2": 0.5,
    "stretch_climb_2": 0, "stretch_friction_2": 0.6,
}  # fmt: skip
STUDY = {"scene": "rectangle-on-track", **BOWL, **TRACK, "delta": 10}
WHOLE = ["transit_time", "bottleneck_velocity", "bottleneck_fraction", "bottleneck_radius"]


def test_the_length_is_that_of_the_spiral_in_space():
    found = vibrafeed.simulate(**STUDY, outputs=["track_length"])
    total = 0.0
    for first, last, turns, climb in ((0.1, 0.16, 2, 2), (0.16, 0.18, 0.5, 0)):
        slope = (last - first) / (2 * np.pi * turns)
        plan, _ = quad(lambda r, slope=slope: np.hypot(r, slope) / slope, first, last)
        total += plan / np.cos(np.radians(climb))
    assert float(found.track_length) == pytest.approx(total, rel=1e-3)  # the slope adds 7e-4
    assert float(found.track_length) < total


def test_the_radius_grows_in_proportion_to_the_turned_angle():
    x = np.linspace(0, 1, 11)
    radius = radius_at(x, Stretches((np.array(0.1),), (np.array(0.2),), (np.array(1.0),)))
    # ds = r dphi: the angle turned on the way is the integral of ds/r, here in closed form.
    turned = 2 * (radius - 0.1) / (0.2**2 - 0.1**2)
    assert np.diff(radius) / np.diff(turned) == pytest.approx(0.015, rel=1e-12)
    assert radius[[0, -1]] == pytest.approx([0.1, 0.2], rel=1e-15)


@pytest.mark.parametrize(("fraction", "climb", "friction"), [(0.3, 2, 0.3), (0.9, 0, 0.6)])
@pytest.mark.parametrize("load", [{}, {"load_mass": 1.5, "load_radius": 0.12}])
def test_each_place_is_that_of_a_study_of_its_radius_climb_and_friction(
    fraction, climb, friction, load
):
    names = ["conveying_velocity", "track_amplitude", "vibration_angle"]
    here = vibrafeed.simulate(
        **STUDY, **load, track_fraction=fraction, outputs=[*names, "track_radius"]
    )
    alone = vibrafeed.simulate(
        scene="rectangle-on-track", **BOWL, **load, delta=10, gamma=climb, friction=friction,
        radius=float(here.track_radius), outputs=names,
    )  # fmt: skip
    for name in names:
        assert float(here[name]) == pytest.approx(float(alone[name]), rel=1e-9)


@pytest.mark.parametrize("harmonic", [0.0, 0.25], ids=["sine", "half wave"])
def test_time_and_bottleneck_are_those_of_a_fine_walk_along_the_track(harmonic):
    study = {name: value for name, value in STUDY.items() if name != "delta"}
    fine = vibrafeed.simulate(
        **{**study, "scene": "rectangle-on-plane"}, length=0.02, force_harmonic=harmonic,
        outputs=["conveying_velocity", "track_radius", "track_length", "track_feed_rate", *WHOLE],
        track_fraction={"start": 0, "stop": 1, "num": 241},
    )  # fmt: skip
    x, v = fine.track_fraction.values, fine.conveying_velocity.values
    assert np.ptp(v) > 0.2 * v.max(), "the speed changes along the track"
    # A mean over each cell, but for the one in which the lining begins: there half of it.
    time = float(fine.track_length) * np.sum((1 / v[1:] + 1 / v[:-1]) / 2 * np.diff(x))
    assert float(fine.transit_time) == pytest.approx(time, rel=3e-3)
    slowest = v.argmin()
    assert float(fine.bottleneck_velocity) == pytest.approx(v[slowest], rel=5e-3)
    assert float(fine.bottleneck_fraction) == pytest.approx(x[slowest], abs=0.03)
    radius = float(fine.track_radius[slowest])
    assert float(fine.bottleneck_radius) == pytest.approx(radius, abs=0.002)
    rate = 60 * float(fine.bottleneck_velocity) / 0.02
    assert float(fine.track_feed_rate) == pytest.approx(rate, rel=1e-14)


def walk_of(speed, **others):
    """Return the passage along the track of `TRACK` of a speed made up, and what it was asked."""
    (track, _) = track_of(TRACK, of_bowl=True)
    asked = []

    def made_up(*, track_fraction, max_periods):
        assert np.ndim(max_periods) == 0
        asked.extend(np.ravel(track_fraction))
        return speed(track_fraction)

    rest = {"conveying_velocity_error": 0.0, "throw_number": 2.0, "period_multiple": 1.0, **others}

    def constant(name):
        def value(*, track_fraction):
            here = rest[name]
            return here(track_fraction) if callable(here) else np.full_like(track_fraction, here)

        return Equation(name, value, "")

    walk = AlongTrack(
        track,
        (Equation("conveying_velocity", made_up, ""), *map(constant, rest)),
        (*track.inputs, "max_periods"),
    )
    given = {name: np.array(TRACK[name]) for name in track.inputs}
    given |= {name: np.radians(given[name]) for name in given if "climb" in name}
    passage = walk.passage(**given, max_periods=np.array(7.0))
    return passage, float(total_length(stretches=track.stretches(**given))), np.unique(asked)


def test_a_method_gets_its_settings_as_they_are_and_nodes_are_enough_for_a_mean():
    """A speed of 0.1 + x takes L (ln(1.1) - ln(0.1)); methods take one number of a setting."""
    passage, length, asked = walk_of(lambda x: 0.1 + x)
    assert float(passage.time) == pytest.approx(length * np.log(11), rel=1e-7)
    assert float(passage.time_error) == pytest.approx(0.0, abs=1e-9)
    assert float(passage.slowest) == pytest.approx(0.1, rel=1e-7)
    assert float(passage.radius) == pytest.approx(0.1, rel=1e-7)
    assert len(asked) == 2 * 17


@pytest.mark.parametrize(
    "speed",
    [
        lambda x: 0.01 + np.abs(x - 0.013),
        lambda x: 0.1 + 0.05 * np.sin(40 * x),
        lambda x: np.where(x < 0.333, 0.05, 0.1) + 0.1 * (x - 0.333),
        lambda x: 0.002 + (x - 0.61) ** 2,
    ],
    ids=["kink", "waves", "jump", "dip"],
)
def test_time_and_least_speed_are_right_within_their_stated_errors(speed):
    passage, length, asked = walk_of(speed)
    x = np.linspace(0.0, 1.0, 2_000_001)
    v = speed(x)
    time = length * np.mean(1.0 / v)
    assert float(passage.time) == pytest.approx(time, abs=float(passage.time_error) + 1e-6 * time)
    assert float(passage.time_error) < 4e-3 * time
    lower = float(passage.slowest) - float(passage.slowest_error)
    assert lower * (1 - 1e-7) <= v.min() <= float(passage.slowest) * (1 + 1e-6)
    assert float(passage.slowest) == pytest.approx(v.min(), rel=2e-3)
    assert 2 * 17 < len(asked) < 2 * 17 * 10


@pytest.mark.parametrize("gap", [(0.5321, 0.5341), (0.53, 0.6)])
def test_a_place_without_a_speed_leaves_the_whole_track_without_a_time(gap):
    """It lies where the number of periods changes, as a motion that takes too long to settle."""
    passage, *_ = walk_of(
        lambda x: np.where((x > gap[0]) & (x < gap[1]), np.nan, 0.1 + x),
        period_multiple=lambda x: np.where(x > gap[0], 2.0, 1.0),
    )
    for name, value in passage._asdict().items():
        assert np.isnan(float(value)), name
    assert not CONDITIONS[1].function(passage=passage)
    assert CONDITIONS[0].function(passage=passage)


def test_the_bowl_whose_speed_dips_between_two_of_seventeen_places():
    """As told by 20,001 places: 8.741 s, 1.808 mm/s, 5.42 a minute; once 6.494, 2.390, 7.17."""
    found = vibrafeed.simulate(
        scene="rectangle-on-track", frequency=82.36, moving_mass=5.349, base_mass=87.99,
        moving_inertia=0.3711, base_inertia=0.9584, spring_radius=0.1466, spring_angle=13.35,
        damping_ratio=0.02233, ring_down_frequency=72.22, drive_force=618.5, start_radius=0.1045,
        delta=5.93, length=0.02, stretch_turns_1=0.3431, stretch_radius_1=0.1665,
        stretch_friction_1=0.2629, stretch_climb_1=1.583,
        outputs=[
            "transit_time", "transit_time_error", "bottleneck_velocity",
            "bottleneck_velocity_error", "track_feed_rate",
        ],
    )  # fmt: skip
    assert float(found.transit_time) == pytest.approx(8.741, abs=1e-3)
    assert float(found.transit_time_error) < 1e-3 * 8.741
    assert float(found.bottleneck_velocity) == pytest.approx(1.808e-3, abs=1e-6)
    assert float(found.bottleneck_velocity_error) < 2e-3 * 1.808e-3
    assert float(found.track_feed_rate) == pytest.approx(5.42, abs=0.01)


def test_parts_on_the_track_are_felt_where_they_are_taken_to_be():
    names = ["track_amplitude", "effective_mass", "effective_damping"]
    study = {name: value for name, value in STUDY.items() if name != "delta"}
    study |= {"scene": "rectangle-on-plane", "conveyed_mass": 1.5}
    whole = vibrafeed.simulate(
        **study, load_fraction=0.4, track_fraction=0.4, outputs=[*names, "track_radius"]
    )
    alone = vibrafeed.simulate(
        scene="rectangle-on-plane", **BOWL, gamma=2, friction=0.3, conveyed_mass=1.5,
        radius=float(whole.track_radius), outputs=names,
    )  # fmt: skip
    for name in names:
        assert float(whole[name]) == pytest.approx(float(alone[name]), rel=1e-8)


def test_a_stretch_that_is_too_steep_lets_none_pass():
    found = vibrafeed.simulate(
        **{**STUDY, "stretch_climb_2": 30}, length=0.02, outputs=[*WHOLE, "track_feed_rate"]
    )
    judge = found[found.transit_time.attrs["ancillary_variables"]]
    assert int(judge) == REGIMES["stalls"].value
    assert np.isinf(float(found.transit_time))
    assert float(found.bottleneck_fraction) > 0.75
    assert float(found.track_feed_rate) <= 0


def test_a_stretch_without_its_own_climb_or_friction_has_that_before():
    own = {key: STUDY[key] for key in STUDY if key not in ("stretch_climb_2",)}
    same = vibrafeed.simulate(**{**STUDY, "stretch_climb_2": 2}, outputs=WHOLE)
    assert float(vibrafeed.simulate(**own, outputs=WHOLE).transit_time) == float(same.transit_time)


@pytest.mark.parametrize(
    ("changes", "place"),
    [
        ({"radius": 0.2}, "parameters.radius"),
        ({"gamma": 2}, "parameters.gamma"),
        ({"friction": 0.3}, "parameters.friction"),
        ({"stretch_turns_2": None}, "parameters.stretch_turns_2"),
        ({"stretch_climb_1": None}, "parameters.stretch_climb_1"),
        ({"start_radius": None}, "parameters.start_radius"),
    ],
)
def test_what_is_wrong_with_a_track(changes, place):
    given = {k: v for k, v in {**STUDY, **changes}.items() if v is not None}
    assert places_of(vibrafeed.simulate, **given, outputs=WHOLE) == [place]


def test_stretches_belong_to_a_bowl():
    with pytest.raises(StudyError, match="only with the drive unit of a bowl"):
        vibrafeed.simulate(
            scene="rectangle-on-track", **TRACK, frequency=50, amplitude=1e-4, beta=20,
            outputs=WHOLE,
        )  # fmt: skip
