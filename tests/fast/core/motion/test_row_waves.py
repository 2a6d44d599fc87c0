"""Rows under waves, from event to event: the sine, one part, and laws."""

from __future__ import annotations

import numpy as np
import pytest

import vibrafeed
from night import count
from rows import TURN, cell, followed, path, sines
from vibrafeed.core.motion import waves
from vibrafeed.core.motion.kernels.rows.row_state import IN_SPACE, NO_STOP, ON_TRACK
from vibrafeed.core.motion.waves import Wave

ROWS = 1000
"""Rows of a law by night."""
SHORT = TURN * np.arange(1, 7)
"""Ends of periods at which paths are compared: rounding grows in chaotic rows."""


def random_wave(random, along=1.2, normal=0.5):
    """Return a wave of two or three harmonics on both axes."""
    orders = int(random.integers(2, 4))
    harmonics = random.normal(size=(3, 2, orders)) / np.arange(1, orders + 1)
    harmonics[0] *= along
    harmonics[1] = 0.0
    harmonics[2] *= normal
    return Wave(harmonics, np.empty((4, 0)))


def random_row(random, parts=None, **drive):
    """Return the numbers of a row, as `cell` takes them: half of them on a slope, some apart."""
    n = int(random.integers(2, 6)) if parts is None else parts
    slope = random.choice([0.0, random.uniform(-0.03, 0.03)])
    kinetic = random.uniform(0.1, 0.7, n)
    static = kinetic * random.choice([1.0, 1.3])
    return {
        "px": 0.0, "pz": 0.0, "friction": static, "kinetic": kinetic,
        "wave": random_wave(random, **drive), "mass": random.uniform(0.3, 3.0, n),
        "gap": random.choice([0.0, 0.3], n - 1), "gs": np.sin(slope), "gn": np.cos(slope),
    }  # fmt: skip


STOPS = (NO_STOP, ON_TRACK, IN_SPACE)


# --- the sine


@pytest.mark.parametrize("stop", STOPS)
@pytest.mark.parametrize("orders", [1, 3])
def test_a_wave_of_one_harmonic_is_the_sine(orders, stop):
    random = np.random.default_rng(orders)
    for _ in range(count(12, ROWS)):
        row = random_row(random)
        px, pz = random.uniform(0.5, 3.0), random.uniform(0.1, 2.5)
        row |= {"stop": stop, "stop_gap": random.choice([0.0, 0.2]), "e": random.choice([0.0, 0.4])}
        rest = [0.0] * (orders - 1)
        waved = path(cell(**{**row, "wave": sines([px, *rest], [pz, *rest])}), SHORT)
        plain = path(cell(**{**row, "px": px, "pz": pz, "wave": None}), SHORT)
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
    }  # fmt: skip
    outputs = ["conveying_velocity", "flight_fraction", "period_multiple"]
    one = vibrafeed.simulate(
        scene="rectangle-on-plane", friction_static=0.4, friction_kinetic=0.3, outputs=outputs,
        **axes,
    )  # fmt: skip
    # Frictions that differ in a last bit are followed as a row.
    more = 0.3 * (1 + 4e-16)
    assert more != 0.3
    row = vibrafeed.simulate(
        scene="row-on-plane", part_friction_1=0.3, part_friction_2=more, part_friction_3=0.3,
        outputs=outputs, **axes,
    )  # fmt: skip
    alike = vibrafeed.simulate(scene="row-on-plane", parts=3, friction=0.3, outputs=outputs, **axes)
    for name in outputs:
        assert row[name].values == pytest.approx(alike[name].values, abs=1e-9), name
    equal = vibrafeed.simulate(
        scene="row-on-plane", parts=3, friction_static=0.4, friction_kinetic=0.3, outputs=outputs,
        **axes,
    )  # fmt: skip
    assert np.array_equal(
        equal.conveying_velocity.values, one.conveying_velocity.values, equal_nan=True
    )
    assert (row.flight_fraction.values > 0.0).any()
    assert (row.flight_fraction.values == 0.0).any()


def test_frictions_that_differ_by_rounding_move_as_one():
    random = np.random.default_rng(13)
    for _ in range(count(40, ROWS)):
        row = random_row(random, normal=random.choice([0.1, 0.3, 0.8, 1.2]))
        friction, parts = random.uniform(0.1, 0.7), len(row["mass"])
        static = friction * random.choice([1.0, 1.3])
        bits = 1.0 + random.choice([0.0, 2.3e-16, 1e-15], parts)
        row |= {"friction": static * bits, "kinetic": friction * bits, "most": 40}
        row["gap"] = [0.0] * (parts - 1)
        found, name = followed(cell(**row))
        one = {**row, "friction": [static], "kinetic": [friction], "mass": [1.0], "gap": []}
        alone, same = followed(cell(**one))
        assert (name, found["platoons"]) == (same, 1)
        assert found["velocity"] == pytest.approx(alone["velocity"], abs=1e-9)


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
    for _ in range(count(12, ROWS)):
        row = random_row(random, normal=0.3)
        found, name = followed(cell(**row, stop=IN_SPACE, e=restitution, most=60))
        if name != "periodic":
            continue
        held += found["stop_contact"] > 0.0
        limit = row["friction"] @ row["mass"] * row["gn"]
        assert abs(found["stop_force"] + row["mass"].sum() * row["gs"]) <= limit * (1 + 1e-9)
    assert held > 0


def test_a_row_that_hops_onto_a_fixed_stop_presses_with_all_its_friction():
    # Every contact with the floor happens while the track runs forward, as above 1.705 of a sine.
    wave = sines([1.0, 0.2], [2.2, 0.15])
    found, name = followed(cell(0, 0, [0.2, 0.4], mass=[1.0, 2.0], wave=wave, stop=IN_SPACE))
    assert name == "periodic"
    assert found["stop_force"] == pytest.approx(1.0, rel=1e-9)


def test_parts_never_overlap_and_gaps_are_those_of_their_places():
    random, phases = np.random.default_rng(9), np.linspace(0.0, 15 * TURN, 300)
    for _ in range(count(10, ROWS)):
        row = random_row(random, normal=random.choice([0.3, 1.2]))
        row |= {"e": random.choice([0.0, 0.5]), "stop": random.choice([NO_STOP, ON_TRACK])}
        places, gaps = path(cell(**row), phases)
        between = gaps[:, : len(row["gap"])]
        assert gaps.min() >= -1e-12
        assert np.abs(between - row["gap"] - np.diff(places, axis=1)).max() < 1e-11


def test_blocks_are_in_the_order_of_friction():
    """Parts that slide forward and touch: those behind are no rougher; else they part."""
    wave = sines([0.7, 0.35], [0.1], along_cosines=[0.0, 0.2])
    together, _ = followed(cell(0, 0, [0.25, 0.4], wave=wave))
    apart, _ = followed(cell(0, 0, [0.4, 0.25], wave=wave))
    assert {together["platoons"], apart["platoons"]} == {1, 2}


def mirrored(wave):
    """Return the wave that pushes back where another pushes forward."""
    return Wave(wave.harmonics * np.array([-1, 1, 1]).reshape(3, 1, 1), wave.steps)


def test_the_mirror_image_masses_and_a_later_start_change_nothing():
    random = np.random.default_rng(6)
    for _ in range(count(8, ROWS)):
        row = random_row(random, normal=random.choice([0.3, 1.0]))
        places = path(cell(**row), SHORT)[0]
        image = {
            **row, "wave": mirrored(row["wave"]), "gs": -row["gs"],
            **{name: row[name][::-1] for name in ("friction", "kinetic", "mass", "gap")},
        }  # fmt: skip
        assert -path(cell(**image), SHORT)[0][:, ::-1] == pytest.approx(places, abs=1e-8)
        heavier = {**row, "mass": 3.0 * row["mass"]}
        assert path(cell(**heavier), SHORT)[0] == pytest.approx(places, abs=1e-8)
        more = {
            **row, "friction": [*row["friction"], 0.3], "kinetic": [*row["kinetic"], 0.3],
            "mass": [*row["mass"], 1.0], "gap": [*row["gap"], 1e6],
        }  # fmt: skip
        assert path(cell(**more), SHORT)[0][:, :-1] == pytest.approx(places, abs=1e-8)


def test_parts_in_the_air_keep_their_momentum():
    random, flights = np.random.default_rng(10), 0
    for _ in range(count(8, ROWS)):
        row = random_row(random, normal=1.5)
        phases = np.linspace(3 * TURN, 5 * TURN, 800)
        # In the air, all at once, they go on at one velocity without the push and the slope.
        centre = path(cell(**row), phases)[0] @ row["mass"] / row["mass"].sum()
        free = centre + waves.position_at(row["wave"], 0, phases) + row["gs"] * phases**2 / 2
        bends = np.abs(np.diff(free, 2))
        found, _ = followed(cell(**row, most=5))
        flights += (bends < 1e-10).mean() > 0.05 and found["flight"] > 0.0
    assert flights > 0


def test_parts_that_rebound_from_each_other_lose_energy_and_have_an_answer():
    random = np.random.default_rng(12)
    for _ in range(count(8, ROWS)):
        row = random_row(random, normal=random.choice([0.3, 1.2]))
        found, name = followed(cell(**row, e=random.uniform(0.2, 0.8), most=40))
        assert name in ("periodic", "aperiodic", "at_rest")
        assert found["impact"] >= 0.0
        assert np.isfinite(found["velocity"])


def test_a_wave_may_lift_parts_off_as_it_begins():
    wave = sines([1.0], [0.5], normal_cosines=[1.5])
    places, _ = path(cell(0, 0, [0.3, 0.6], wave=wave), np.array([0.01, 0.1]))
    # In the air nothing holds them apart from the push: both move by it alone.
    assert places[:, 0] == pytest.approx(places[:, 1], abs=1e-16)
    assert places[1, 0] == pytest.approx(0.1 - np.sin(0.1), abs=1e-15)
