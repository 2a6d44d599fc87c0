"""Rows under waves, from event to event: the sine, one part, and laws."""

import numpy as np
import pytest

import vibrafeed
from night import count
from rows import TURN, cell, followed, path, sines
from vibrafeed.core.motion.kernels.rows.row_state import IN_SPACE, NO_STOP, ON_TRACK

SHORT = TURN * np.arange(1, 7)
"""Ends of periods at which paths are compared: rounding grows in chaotic rows."""


STOPS = (NO_STOP, ON_TRACK, IN_SPACE)


# --- the sine


@pytest.mark.parametrize("stop", STOPS)
def test_a_wave_of_one_harmonic_is_the_sine(stop):
    random = np.random.default_rng(3)
    for _ in range(count(12, 1000)):
        n, px, pz = int(random.integers(2, 6)), random.uniform(0.5, 3.0), random.uniform(0.1, 2.5)
        kinetic = random.uniform(0.1, 0.7, n)
        row = {
            "kinetic": kinetic, "friction": kinetic * random.choice([1.0, 1.3]),
            "mass": random.uniform(0.3, 3.0, n), "gap": random.choice([0.0, 0.3], n - 1),
            "stop": stop, "stop_gap": random.choice([0.0, 0.2]), "e": random.choice([0.0, 0.4]),
        }  # fmt: skip
        waved = path(cell(0.0, 0.0, **row, wave=sines([px, 0.0, 0.0], [pz])), SHORT)
        plain = path(cell(px, pz, **row), SHORT)
        for one, other in zip(waved, plain, strict=True):
            assert one == pytest.approx(other, abs=1e-9)


def test_what_is_said_of_a_wave_of_one_harmonic_is_said_of_the_sine():
    names = ("velocity", "contact", "flight", "gap", "stop_force", "stop_peak", "stop_impulse")
    three, pair = [0.3, 0.45, 0.4], [0.5, 0.3, 0.3]
    for stop, px, pz, friction in (
        (NO_STOP, 3.0, 0.9, pair), (IN_SPACE, 2.0, 0.7, three), (ON_TRACK, 1.5, 0.8, three),
    ):  # fmt: skip
        row = {"friction": friction, "mass": [1.0, 0.4, 0.6], "stop": stop}
        plain, name = followed(cell(px, pz, **row))
        waved, same = followed(cell(0, 0, wave=sines([px, 0.0], [pz]), **row))
        assert same == name == "periodic"
        for column in names:
            assert waved[column] == pytest.approx(plain[column], abs=1e-11, nan_ok=True), column


# --- one part


def test_parts_of_one_friction_move_as_one_part_of_the_plane():
    axes = {
        "amplitude_along_1": "0.2 mm", "amplitude_along_2": "0.06 mm",
        "phase_along_2": [0, 1, 2, 3, 4, 5], "amplitude_normal_1": "0.05 mm",
        "amplitude_normal_3": "0.02 mm", "phase_normal_1": "-60 deg", "frequency": 50,
        "drive_factor": [0.4, 0.7, 1.0],
        "outputs": ["conveying_velocity", "flight_fraction", "period_multiple"],
    }  # fmt: skip
    one = vibrafeed.simulate(scene="rectangle-on-plane", friction=0.3, **axes)
    alike = vibrafeed.simulate(scene="row-on-plane", parts=3, friction=0.3, **axes)
    # Frictions that differ in a last bit are followed as a row.
    row = vibrafeed.simulate(
        scene="row-on-plane", part_friction_1=0.3, part_friction_2=0.3 * (1 + 4e-16),
        part_friction_3=0.3, **axes,
    )  # fmt: skip
    for name in axes["outputs"]:
        np.testing.assert_array_equal(alike[name].values, one[name].values)
        assert row[name].values == pytest.approx(one[name].values, abs=1e-9), name
    assert 0.0 == one.flight_fraction.values.min() < one.flight_fraction.values.max()


def test_steps_off_the_floor_move_three_parts_as_one():
    drive = {
        "frequency": 50, "acceleration_along_1": "3.924 m/s^2",
        "acceleration_normal_1": ["2.943 m/s^2", "12 m/s^2"], "duration_2": 1,
        "gravity": "9.81 m/s^2", "outputs": ["conveying_velocity", "flight_fraction"],
    }  # fmt: skip
    one = vibrafeed.simulate(scene="rectangle-on-plane", friction=0.4, **drive)
    row = vibrafeed.simulate(
        scene="row-on-plane", part_friction_1=0.4, part_friction_2=0.4 * (1 + 4e-16), **drive
    )
    for name in drive["outputs"]:
        assert row[name].values == pytest.approx(one[name].values, abs=1e-10)
    assert one.flight_fraction.values[1] > 0.1


# --- laws


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_stop_takes_no_more_than_friction_gives(restitution):
    """Of a row that repeats |F + M g sin(gamma)| <= sum mu m g cos(gamma) (theory 17.6)."""
    random, held = np.random.default_rng(5), 0
    for _ in range(count(12, 1000)):
        n, slope = int(random.integers(2, 6)), random.uniform(-0.03, 0.03)
        friction, mass = random.uniform(0.1, 0.7, n), random.uniform(0.3, 3.0, n)
        wave = sines(random.normal(size=2), 0.3 * random.normal(size=2))
        place = {"stop": IN_SPACE, "gs": np.sin(slope), "gn": np.cos(slope)}
        row = cell(0, 0, friction, mass=mass, wave=wave, e=restitution, most=60, **place)
        found, name = followed(row)
        if name == "periodic":
            held += found["stop_contact"] > 0.0
            limit = friction @ mass * place["gn"]
            assert abs(found["stop_force"] + mass.sum() * place["gs"]) <= limit * (1 + 1e-9)
    assert held > 0


def test_a_row_that_hops_onto_a_fixed_stop_presses_with_all_its_friction():
    # Every contact with the floor happens while the track runs forward, as above 1.705 of a sine.
    wave = sines([1.0, 0.2], [2.2, 0.15])
    found, name = followed(cell(0, 0, [0.2, 0.4], mass=[1.0, 2.0], wave=wave, stop=IN_SPACE))
    assert name == "periodic"
    assert found["stop_force"] == pytest.approx(1.0, rel=1e-9)


def test_blocks_are_in_the_order_of_friction():
    """Parts that slide forward and touch: those behind are no rougher; else they part."""
    wave = sines([0.7, 0.35], [0.1], along_cosines=[0.0, 0.2])
    together, _ = followed(cell(0, 0, [0.25, 0.4], wave=wave))
    apart, _ = followed(cell(0, 0, [0.4, 0.25], wave=wave))
    assert {together["platoons"], apart["platoons"]} == {1, 2}


def test_a_wave_may_lift_parts_off_as_it_begins():
    wave = sines([1.0], [0.5], normal_cosines=[1.5])
    places, _ = path(cell(0, 0, [0.3, 0.6], wave=wave), np.array([0.01, 0.1]))
    # In the air nothing holds them apart from the push: both move by it alone.
    assert places[:, 0] == pytest.approx(places[:, 1], abs=1e-16)
    assert places[1, 0] == pytest.approx(0.1 - np.sin(0.1), abs=1e-15)
