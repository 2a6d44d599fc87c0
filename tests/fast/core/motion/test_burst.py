"""Drives that begin and end: from rest, some periods long, until the part rests again."""

from __future__ import annotations

import json

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate

G = 9.81
PERIOD = 0.02
OUTPUTS = ["burst_displacement", "burst_coasting_time"]
FAST_FIRST = {
    "acceleration_along_1": -2 * G, "duration_1": PERIOD / 6,
    "acceleration_along_2": 0.4 * G, "duration_2": 5 * PERIOD / 6,
}  # fmt: skip
FAST_LAST = {
    "acceleration_along_1": 0.4 * G, "duration_1": 5 * PERIOD / 6,
    "acceleration_along_2": -2 * G, "duration_2": PERIOD / 6,
}  # fmt: skip
FRICTION = {"friction_static": 0.5, "friction_kinetic": 0.3}
SLIDES = {"amplitude": "0.1 mm", "beta": 30, "friction": 0.25, "gamma": 3}


def burst(periods, outputs=(), **parameters):
    return vibrafeed.simulate(
        scene="rectangle-on-plane", frequency=50, gravity=G, burst_periods=periods,
        outputs=[*OUTPUTS, *outputs], **parameters,
    )  # fmt: skip


def test_ten_periods_of_a_two_level_wave():
    found = burst(10, ["conveying_velocity"], **FAST_FIRST, **FRICTION)
    assert 1e3 * float(found.burst_displacement) == pytest.approx(3.176571429, abs=1e-9)
    assert 1e3 * float(found.conveying_velocity) == pytest.approx(15.882857143, abs=1e-9)
    assert float(found.burst_coasting_time) == 0


def test_a_part_that_still_slides_coasts_as_friction_brakes_it():
    # It slips in the fast level, and after it brakes at 0.7 g under the slow one, at 0.3 g at rest.
    lasts = PERIOD / 6
    speed = 1.7 * G * lasts
    begins, brakes, coasts = 0.5 * speed * lasts, *(speed**2 / (2 * d * G) for d in (0.7, 0.3))
    found = burst([1, 4], **FAST_LAST, **FRICTION)
    ways = [begins + coasts, 4 * begins + 3 * brakes + coasts]
    assert found.burst_displacement.values == pytest.approx(ways, rel=1e-10)
    assert found.burst_coasting_time.values == pytest.approx([speed / (0.3 * G)] * 2, rel=1e-10)


def stepped(periods, amplitude, beta, friction, gamma, steps=200_000):
    """Follow a sliding part by small steps of time: another method, and another program."""
    beta, gamma, w = np.deg2rad(beta), np.deg2rad(gamma), 2 * np.pi / PERIOD
    end, step = periods * PERIOD, PERIOD / steps * periods
    speed = way = time = 0.0
    while time < 4 * end:
        track = -amplitude * w**2 * np.cos(w * time) if time < end else 0.0
        load = G * np.cos(gamma) + track * np.sin(beta)
        assert load > 0
        push = -G * np.sin(gamma) - track * np.cos(beta)
        after = speed + push * step
        brake = friction * load * step
        speed = after - np.sign(after) * min(abs(after), brake)
        way += speed * step
        time += step
        if time >= end and speed == 0:
            break
    return way, time - end


def test_a_sine_agrees_with_small_steps_of_time():
    found = burst(3, **SLIDES)
    way, coasting = stepped(3, 1e-4, 30, 0.25, 3)
    assert float(found.burst_displacement) == pytest.approx(way, rel=2e-3)
    assert float(found.burst_coasting_time) == pytest.approx(coasting, rel=1e-2)


def test_a_long_burst_travels_as_a_drive_that_never_ends():
    periods = np.array([20, 100])
    found = burst([20, 100], ["conveying_velocity"], **SLIDES)
    steady = float(found.conveying_velocity) * PERIOD * periods
    extra = found.burst_displacement - steady
    # The start and the end cost the same way, whatever lies between.
    assert extra.values[0] == pytest.approx(extra.values[1], abs=1e-8)


def test_what_never_rests_has_no_way_and_a_weak_drive_moves_nothing():
    assert np.isnan(burst(2, amplitude=1e-4, beta=30, friction=0.2, gamma=15).burst_displacement)
    assert float(burst(5, amplitude=1e-5, beta=20, friction=0.4).burst_displacement) == 0


def test_a_burst_has_whole_periods():
    content = {"kind": "simulate", "scene": "rectangle-on-plane", "outputs": OUTPUTS}
    parameters = {"frequency": 50, "amplitude": 1e-4, "beta": 20, "friction": 0.3}
    for more, told in (({"burst_periods": 2.5}, "whole"), ({}, "missing")):
        with pytest.raises(StudyError) as caught:
            prepare_content({**content, "parameters": parameters | more})
        (problem,) = caught.value.problems
        assert problem.place == "parameters.burst_periods"
        assert told in problem.message


def test_a_trajectory_ends_where_the_part_rests():
    found = burst(2, **FAST_LAST, **FRICTION, trajectory=600)
    end = 2 * PERIOD + float(found.burst_coasting_time)
    time, way = found.cycle_time.values, found.position_along.values
    assert time[-1] == pytest.approx(end, rel=1e-12)
    assert way[-1] == pytest.approx(float(found.burst_displacement), rel=1e-12)
    speed = found.relative_velocity_along.values
    assert np.trapezoid(speed, time) == pytest.approx(way[-1], rel=1e-4)
    # The track: 0.4 g for 5/6 of a period from rest, then it stops, and stays.
    rise, peak = 0.5 * 0.4 * G * (5 * PERIOD / 6) ** 2, 0.4 * G * 5 * PERIOD / 6
    at = np.interp(5 * PERIOD / 6, time, found.track_along.values)
    assert at == pytest.approx(rise, rel=1e-4)
    assert found.track_along.values[-1] == pytest.approx(2 * 0.5 * peak * PERIOD, rel=1e-12)
    assert found.motion_mode.values[0] == 0


def test_a_trajectory_at_times_goes_on_in_rest():
    found = burst(3, ["feed_rate"], length=0.01, **SLIDES, trajectory=[0, 0.03, 0.06, 0.5])
    assert found.position_along.values[0] == 0
    assert found.position_along.values[-1] == pytest.approx(float(found.burst_displacement))
    assert found.track_along.values == pytest.approx(
        [0, -2e-4 * np.cos(np.pi / 6), 0, 0], abs=1e-12
    )
    assert found.motion_mode.values[-1] == 0


# --- a recording as it is


def recording(times, **columns):
    heads = ["time [s]", *(f"{name} [{'m/s' if name == 'v' else 'm/s^2'}]" for name in columns)]
    rows = np.stack([times, *columns.values()], axis=1).tolist()
    return "\n".join([",".join(heads), *(",".join(map(repr, row)) for row in rows)])


def once(columns, **more):
    drive = {"once": True, **columns}
    fixed = {"scene": "rectangle-on-plane", "gravity": G, "outputs": OUTPUTS, **FRICTION}
    return vibrafeed.simulate(**{**fixed, "drive": drive, **more})


@pytest.fixture(scope="module")
def saw():
    """The velocity of the track under FAST_FIRST for ten periods, with a drift of 1 m/s^2."""
    times = PERIOD / 6 * np.arange(61)
    within = np.mod(np.arange(61), 6) / 6
    speeds = 0.4 * G * PERIOD * np.where(within < 1 / 6, -5 * within, within - 1) * (within > 0)
    return {"data": recording(times, v=speeds + times), "along": "v"}


def test_a_recording_of_velocities_is_the_drive_that_it_shows(saw):
    found = once(saw)
    assert 1e3 * float(found.burst_displacement) == pytest.approx(3.176571429, rel=1e-8)
    assert float(found.burst_coasting_time) == pytest.approx(0, abs=1e-9)
    assert "without its mean acceleration, along 1 m s-2, " in found.attrs["drive"]
    assert float(found.frequency) == pytest.approx(1 / (10 * PERIOD))
    again = tabulate(prepare_content(json.loads(found.attrs["study"]))).to_xarray()
    assert float(again.burst_displacement) == float(found.burst_displacement)


def test_a_recording_may_repeat_and_its_trajectory_goes_on_to_the_rest(saw):
    found = once(saw, burst_periods=2, trajectory=50)
    assert 1e3 * float(found.burst_displacement) == pytest.approx(2 * 3.176571429, rel=1e-8)
    assert found.position_along.values[-1] == float(found.burst_displacement)
    # 0.4 g for 5/6 of a period, and back: the track goes back by this, twenty times.
    stroke = -0.5 * 0.4 * G * (5 * PERIOD / 6) * PERIOD
    assert found.track_along.values[-1] == pytest.approx(20 * stroke, rel=1e-8)


def test_a_recording_of_accelerations_is_as_good_as_its_samples():
    # A hopping part in a curve; the sensor shows gravity, too.
    drive = {"amplitude_along_1": 3e-4, "amplitude_normal_1": 1.2e-4, "phase_normal_1": -70}
    curve = {"scene": "rectangle-on-track", "radius": 0.15, "delta": 5}
    phases = np.linspace(0, 6 * np.pi, 241)
    w = 2 * np.pi / PERIOD
    along = -3e-4 * w**2 * np.sin(phases)
    normal = -1.2e-4 * w**2 * np.sin(phases - np.deg2rad(70)) + G
    data = recording(phases / w, x=along, z=normal)
    asked = {"restitution": 0.1, "outputs": OUTPUTS, **curve, **FRICTION}
    exact = vibrafeed.simulate(frequency=50, gravity=G, burst_periods=3, **drive, **asked)
    found = once({"data": data, "along": "x", "normal": "z"}, **asked)
    for name in OUTPUTS:
        assert float(found[name]) == pytest.approx(float(exact[name]), rel=0.02)


@pytest.mark.parametrize(
    ("drive", "more", "place", "told"),
    [
        ({}, {"outputs": ["conveying_velocity"]}, "outputs", "burst_displacement"),
        ({}, {"scene": "part-on-plate"}, "drive.once", "rectangle-on-track"),
        ({}, {"amplitude": 1e-4}, "parameters.amplitude", "Remove"),
        ({}, {"verify": 1}, "verify", "Remove verify"),
        ({"harmonics": 2}, {}, "drive.harmonics", "Remove harmonics"),
        ({"unit": "mm"}, {}, "drive.once", "velocities"),
        ({"once": "yes"}, {}, "drive.once", "true or false"),
        ({"data": "time [s],v [m/s]\n0,1"}, {}, "drive.data", "at least 2 samples"),
    ],
)
def test_what_no_recording_that_is_followed_once_has_is_told(saw, drive, more, place, told):
    with pytest.raises(StudyError) as caught:
        once({**saw, **drive}, **more)
    (problem,) = caught.value.problems
    assert (problem.place, told in problem.fix) == (place, True)


@pytest.mark.parametrize(
    "samples", [{"along": [0, 1]}, {"time": [0, 1, 1], "along": [0, 1, 0]},
                {"time": [0, 1, 2], "along": [0, 1]}, {"time": [1, 2], "along": [0, 1]}],
)  # fmt: skip
def test_samples_from_the_network_are_looked_at(samples):
    drive = {"name": "x", "sha256": 64 * "0", "left_over": {}, "numbers": {}, "samples": samples}
    content = {"kind": "simulate", "scene": "rectangle-on-plane", "outputs": OUTPUTS}
    parameters = {"friction": 0.3, "frequency": 5, "burst_periods": 1}
    with pytest.raises(StudyError) as caught:
        prepare_content({**content, "parameters": parameters, "drive": drive})
    assert [one.place for one in caught.value.problems] == ["drive"]


def test_other_kinds_need_a_drive_that_repeats(saw):
    study = {"kind": "optimise", "scene": "rectangle-on-plane", "criterion": {"kind": "maximise"}}
    with pytest.raises(StudyError) as caught:
        prepare_content({**study, "parameters": FRICTION, "drive": {**saw, "once": True}})
    assert "drive.once" in [problem.place for problem in caught.value.problems]
