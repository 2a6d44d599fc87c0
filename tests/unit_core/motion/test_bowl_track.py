"""The track of a bowl in stretches: geometry, each place by itself, what passes the whole."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

import vibrafeed
from core.errors import StudyError
from core.intake import prepare_content
from core.mechanics.bowl_track import Stretches, radius_at
from core.motion.bowl_track import AllStretches, AlongTrack, track_length, track_of
from core.quantities import REGIMES
from core.scenes.scene import Equation
from night import NIGHT

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


def test_a_load_at_its_radius_is_a_heavier_bowl():
    names = ["track_amplitude", "vibration_angle"]
    unit = {"scene": "bowl-drive-unit", "variant": "springs", "spring_stiffness": 1.2e6,
            **{k: v for k, v in BOWL.items() if k != "ring_down_frequency"}}  # fmt: skip
    unit |= {"radius": [0.1, 0.2, 0.3], "outputs": names}
    full = vibrafeed.sweep(**unit, load_mass=2, load_radius=0.18)
    del unit["damping_ratio"]
    empty = vibrafeed.sweep(**{**unit, "moving_mass": 12, "damping_ratio": 0.02}, load_mass=0)
    again = vibrafeed.sweep(**{
        **unit, "moving_mass": 14, "moving_inertia": 0.25 + 2 * 0.18**2,
        # the damper is that of the empty unit
        "damping_ratio": 0.02 * float(_mass(12, 0.25) / _mass(14, 0.25 + 2 * 0.18**2)) ** 0.5,
    })  # fmt: skip
    for name in names:
        assert full[name].values == pytest.approx(again[name].values, rel=1e-12)
        assert (np.abs(full[name].values / empty[name].values - 1) > 1e-3).all()


def _mass(m1, i1):
    """Return the mass of the stroke of a bowl."""
    th, r = np.radians(20), 0.15
    return i1 * 0.9 / (i1 + 0.9) * (np.cos(th) / r) ** 2 + m1 * 40 / (m1 + 40) * np.sin(th) ** 2


def test_time_and_bottleneck_are_those_of_a_fine_walk_along_the_track():
    count = 2001 if NIGHT else 241
    fine = vibrafeed.simulate(
        **STUDY, outputs=["conveying_velocity", "track_radius", "track_length", *WHOLE],
        track_fraction={"start": 0, "stop": 1, "num": count},
    )  # fmt: skip
    x, v = fine.track_fraction.values, fine.conveying_velocity.values
    assert np.ptp(v) > 0.2 * v.max(), "the speed changes along the track"
    # A mean over each cell, but for the one in which the lining begins: there half of it.
    time = float(fine.track_length) * np.sum((1 / v[1:] + 1 / v[:-1]) / 2 * np.diff(x))
    assert float(fine.transit_time) == pytest.approx(time, rel=3e-4 if NIGHT else 3e-3)
    assert float(fine.bottleneck_velocity) == pytest.approx(v.min(), rel=5e-3)
    assert float(fine.bottleneck_velocity) <= v.min() * (1 + 5e-3)
    slowest = v.argmin()
    assert float(fine.bottleneck_fraction) == pytest.approx(x[slowest], abs=0.03)
    assert float(fine.bottleneck_radius) == pytest.approx(
        float(fine.track_radius[slowest]), abs=0.002
    )


def test_a_method_gets_its_settings_as_they_are_and_nodes_are_enough_for_a_mean():
    """A speed of 0.1 + x takes L (ln(1.1) - ln(0.1)); methods take one number of a setting."""
    (track, _) = track_of(TRACK, of_bowl=True)

    def speed(*, track_fraction, max_periods):
        assert np.ndim(max_periods) == 0
        return 0.1 + track_fraction

    stretches = AllStretches(track)
    walk = AlongTrack(
        stretches,
        (Equation("conveying_velocity", speed, ""),),
        (*stretches.inputs, "max_periods"),
    )
    given = {name: np.array(TRACK[name]) for name in stretches.inputs}
    given |= {name: np.radians(given[name]) for name in given if "climb" in name}
    passage = walk(**given, max_periods=np.array(7.0))
    length = float(track_length(stretches=stretches(**given)))
    assert float(passage.time) == pytest.approx(length * np.log(11), rel=1e-7)
    assert float(passage.slowest) == pytest.approx(0.1, rel=1e-7)
    assert float(passage.radius) == pytest.approx(0.1, rel=1e-7)


def test_the_rate_is_that_of_the_bottleneck():
    found = vibrafeed.simulate(
        **STUDY, length=0.02, part_gap=[0, 0.02], outputs=["track_feed_rate", *WHOLE]
    )
    rate = 60 * float(found.bottleneck_velocity) / np.array([0.02, 0.04])
    assert found.track_feed_rate.values == pytest.approx(rate, rel=1e-14)


def test_parts_on_the_track_are_felt_where_they_are_taken_to_be():
    names = ["track_amplitude", "effective_mass", "effective_damping"]
    share = {"load_fraction": 0.4, "track_fraction": 0.4}
    study = {name: value for name, value in STUDY.items() if name != "delta"}
    study["scene"] = "rectangle-on-plane"
    whole = vibrafeed.simulate(
        **study, conveyed_mass=1.5, **share, outputs=[*names, "track_radius"]
    )
    alone = vibrafeed.simulate(
        scene="rectangle-on-plane", **BOWL, gamma=2, friction=0.3, conveyed_mass=1.5,
        radius=float(whole.track_radius), outputs=names,
    )  # fmt: skip
    for name in names:
        assert float(whole[name]) == pytest.approx(float(alone[name]), rel=1e-8)
    elsewhere = vibrafeed.simulate(
        **study, conveyed_mass=1.5, load_fraction=0.4, track_fraction=[0, 1], outputs=names
    )
    assert elsewhere.effective_mass.dims == ()
    assert float(elsewhere.effective_mass) == float(whole.effective_mass)


def test_a_stretch_that_is_too_steep_lets_none_pass():
    steep = {**STUDY, "stretch_climb_2": 30}
    found = vibrafeed.simulate(**steep, length=0.02, outputs=[*WHOLE, "track_feed_rate"])
    assert int(found.regime) == REGIMES["stalls"].value
    assert np.isinf(float(found.transit_time))
    assert float(found.bottleneck_velocity) <= 0
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
    with pytest.raises(StudyError) as refused:
        vibrafeed.simulate(**given, outputs=WHOLE)
    assert [problem.place for problem in refused.value.problems] == [place]


def test_stretches_belong_to_a_bowl():
    with pytest.raises(StudyError, match="track of a bowl on its drive unit"):
        vibrafeed.simulate(
            scene="rectangle-on-track", **TRACK, frequency=50, amplitude=1e-4, beta=20,
            outputs=WHOLE,
        )  # fmt: skip


def test_the_price_counts_the_motions_along_the_track():
    parameters = {name: value for name, value in STUDY.items() if name != "scene"}
    study = {"kind": "simulate", "scene": "rectangle-on-track", "parameters": parameters}
    place = prepare_content({**study, "outputs": ["conveying_velocity"]})
    whole = prepare_content({**study, "outputs": WHOLE})
    assert whole.seconds_a_cell == pytest.approx(35 * place.seconds_a_cell, rel=1e-12)
