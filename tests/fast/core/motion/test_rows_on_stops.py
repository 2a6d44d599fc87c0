"""Rows on a stop, rows by steps, rows of drawn friction: worked values, another method, laws."""

import numpy as np
import pytest

import vibrafeed
from night import count
from refusals import places_of
from rows import TURN, cell, followed, path, two_level
from vibrafeed.core.errors import StudyError
from vibrafeed.core.motion.kernels.rows.row_state import IN_SPACE, ON_TRACK
from vibrafeed.core.motion.row_scene import drawn_deviations
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.scenes.row_on_plane import HELD_FROM

G = 9.80665


# --- worked values


def test_a_stop_at_rest_in_space_under_two_levels():
    found, name = followed(cell(0, 0, [0.3, 0.3], steps=two_level(0.2, 1.0), stop=IN_SPACE))
    assert name == "periodic"
    assert found["stop_force"] / 2 == pytest.approx(0.1112701665, abs=5e-11)
    assert found["stop_contact"] == pytest.approx(0.1127016654, abs=5e-11)
    impacts = found["stop_impulse"] / TURN / found["stop_force"]
    assert impacts == pytest.approx(0.696, abs=5e-4)


@pytest.mark.parametrize("throw", [1.72, 1.8, 2.5, 3.1, 3.5, 4.2, 5.0, 6.0])
def test_a_hopping_row_presses_with_all_its_friction(throw):
    for px, friction, mass in ((2.0, [0.4, 0.4], [1, 1]), (0.7, [0.2, 0.4], [1.0, 2.0])):
        found, _ = followed(cell(px, throw, friction, mass=mass, stop=IN_SPACE))
        assert found["stop_force"] == pytest.approx(np.dot(friction, mass), rel=1e-12)


def test_the_force_drops_at_once_below_the_throw_number_of_the_law():
    above, below = (
        followed(cell(1.0, HELD_FROM * share, [0.4, 0.4], stop=IN_SPACE))[0]["stop_force"]
        for share in (1 + 1e-6, 1 - 1e-6)
    )
    assert above == pytest.approx(0.8, rel=1e-12)
    # The landing impulse changes its side: 1 - 2.7049/(2 pi) of the friction at least is left.
    assert below < (1 - 2.7049 / TURN) * 0.8 + 0.05


def test_the_least_force_on_a_stop_of_the_track():
    found, name = followed(cell(0.5, 0.5, [0.4, 0.4], stop=ON_TRACK))
    assert name == "at_rest"
    assert found["stop_force"] / 2 == pytest.approx(0.060299340617, abs=5e-12)
    assert found["stop_peak"] / 2 == pytest.approx(0.5 - 0.4 * 0.5, abs=1e-12)  # D - mu n on top
    a_s, a_m, mu = 0.2, 1.0, 0.3
    found, _ = followed(cell(0, 0, [mu, mu], steps=two_level(a_s, a_m), stop=ON_TRACK))
    assert found["stop_force"] / 2 == pytest.approx((a_m - mu) * a_s / (a_s + a_m), abs=1e-12)


def test_rows_of_unequal_parts_press_on_a_stop_of_the_track_block_by_block():
    static, mass = np.array([0.45, 0.3, 0.5, 0.2]), np.array([1.0, 2.0, 0.5, 1.0])
    found, _ = followed(cell(0.4, 0.3, static, mass=mass, stop=ON_TRACK))
    tau = (np.arange(100_000) + 0.5) * TURN / 100_000
    push, load = 0.4 * np.sin(tau), 1.0 - 0.3 * np.sin(tau)
    force = np.zeros_like(tau)
    for mu, m in zip(static, mass, strict=True):  # least force from the rear on
        force = np.maximum(0.0, force + m * (push - mu * load))
    assert found["stop_force"] == pytest.approx(force.mean(), abs=1e-8)
    assert found["stop_peak"] == pytest.approx(force.max(), abs=1e-8)


# --- laws


@pytest.mark.parametrize("stop", [ON_TRACK, IN_SPACE])
def test_laws_of_rows_on_stops(stop):
    random = np.random.default_rng(39)
    for _ in range(count(8, 3000)):
        n, slope = int(random.integers(2, 6)), random.uniform(-0.05, 0.05)
        push, mu = random.uniform([0.5, 0.1], [3, 2.5]), random.uniform(0.1, 0.8, n)
        mass, place = random.uniform(0.3, 3.0, n), {"gs": np.sin(slope), "gn": np.cos(slope)}

        def held(mu, mass, push=push, place=place):
            return followed(cell(*push, mu, mass=mass, stop=stop, **place))

        found, name = held(mu, mass)
        assert name in ("periodic", "aperiodic", "at_rest", "limit_reached")
        if abs(found["velocity"]) < 1e-9 and stop == IN_SPACE:
            # Momentum: the mean force is that of friction less the weight along the track.
            bound = mass @ mu * place["gn"]
            assert abs(found["stop_force"] + mass.sum() * place["gs"]) <= bound * (1 + 1e-9)
        if name in ("periodic", "at_rest"):
            slack = 1e-9 + 4.0 * found["error"] * mass.sum()
            heavy, _ = held(mu, 2.0 * mass)
            assert heavy["stop_force"] == pytest.approx(2.0 * found["stop_force"], abs=slack)
        # Two parts of one friction are one of their mass: F_n = n F_1 of equal parts.
        one, kind = held(mu[:1], [mass.sum()])
        if kind in ("periodic", "at_rest"):
            many, _ = held(np.full(n, mu[0]), mass)
            assert many["stop_force"] == pytest.approx(one["stop_force"], abs=1e-8)


def test_bounces_of_parts_that_are_pressed_together_end():
    for stop in (0, IN_SPACE, ON_TRACK):
        found, name = followed(cell(1.5, 0.8, [0.5, 0.2, 0.35], e=0.6, stop=stop, most=60))
        assert name in ("periodic", "aperiodic")
        assert found["collisions"] < 400
    soft, _ = followed(cell(2.0, 0.6, [0.4, 0.3], e=1e-9, most=100))
    plastic, _ = followed(cell(2.0, 0.6, [0.4, 0.3], most=100))
    assert soft["velocity"] == pytest.approx(plastic["velocity"], abs=1e-6)


# --- studies

DRIVEN = {"scene": "row-on-plane", "frequency": 50, "amplitude": "0.3 mm", "beta": 40}


UNIT = {
    "moving_mass": 10, "base_mass": 30, "damping_ratio": 0.02, "frequency": 50,
    "ring_down_frequency": 53, "spring_angle": 25, "drive_force": 60,
}  # fmt: skip


def test_a_study_of_a_held_row_has_forces_in_newtons():
    names = ["stop_force", "stop_force_peak", "stop_impulse", "stop_contact_fraction", "feed_rate"]
    held = {**DRIVEN, "friction": 0.4, "outputs": names, "length": "10 mm"}
    alike = {"parts": 5, "mass": "10 g"}
    found = vibrafeed.simulate(**held, **alike, fixed_stop_gap=0)
    assert found.regime == REGIMES["blocked"].value
    assert float(found.stop_force) == pytest.approx(0.4 * 0.05 * G, rel=1e-12)
    assert float(found.feed_rate) == pytest.approx(0.0, abs=1e-9)
    own = {f"part_mass_{n}": "10 g" for n in range(1, 6)}
    again, found = (
        vibrafeed.simulate(**held, **masses, track_stop_gap=0) for masses in (own, alike)
    )
    assert found.regime == REGIMES["indeterminate_force"].value
    assert float(again.stop_force) == pytest.approx(float(found.stop_force), rel=1e-12)


def test_sizes_and_velocities_of_platoons():
    apart = {"part_friction_1": 0.3, "part_friction_2": 0.34, "part_friction_3": 0.28}
    sizes, speeds = ([f"platoon_{what}_{n}" for n in (1, 2, 3)] for what in ("size", "velocity"))
    found = vibrafeed.simulate(
        **{**DRIVEN, "beta": 20},
        **apart,
        outputs=["platoons", *sizes, *speeds, "conveying_velocity"],
    )
    size, speed = (np.array([float(found[name]) for name in names]) for names in (sizes, speeds))
    there = size > 0
    assert (size.sum(), there.sum()) == (3, found.platoons)
    assert np.isnan(speed[~there]).all()
    assert size[there] @ speed[there] / 3 == pytest.approx(float(found.conveying_velocity))
    assert (np.diff(speed[there]) > 0).all()  # those in front are faster


def test_frictions_drawn_by_a_seed_have_the_mean_number_of_platoons():
    seeds = count(60, 2000)
    found = vibrafeed.simulate(
        scene="row-on-plane", frequency=50, acceleration_along_1=0.2 * G, duration_1=10,
        duration_2=1, friction=0.6, friction_spread=0.1, parts=3, outputs=["platoons"],
        friction_seed=np.arange(seeds),
    )  # fmt: skip
    # 1 + 1/2 + 1/3, whatever the distribution; the variance of the number is 1/4 + 2/9.
    mean = float(found.platoons.mean())
    assert mean == pytest.approx(1 + 1 / 2 + 1 / 3, abs=4 * np.sqrt(0.4722 / seeds))


def test_drawn_deviations_are_those_of_their_seed():
    many = drawn_deviations(np.arange(400.0), 8)
    assert many.shape == (8, 400)
    assert np.abs(many).max() <= 3.0
    assert many.mean() == pytest.approx(0.0, abs=4 / np.sqrt(3200))
    assert many.std() == pytest.approx(0.987, abs=0.05)  # cut at three
    assert (drawn_deviations(np.array(7.0), 4) == many[:4, 7]).all()


@pytest.mark.parametrize(
    ("more", "place"),
    [
        ({"track_stop_gap": 0, "fixed_stop_gap": 0, "friction": 0.3, "parts": 2},
         "parameters.track_stop_gap"),
        ({"friction_spread": 0.1, "part_friction_1": 0.3, "friction": 0.3, "parts": 3},
         "parameters.friction_spread"),
        # What a row does to its unit is known of equal parts only.
        ({**UNIT, "part_friction_1": 0.4, "part_friction_2": 0.3, "conveyed_mass": 1,
          "amplitude": None, "beta": None}, "parameters.conveyed_mass"),
    ],
)  # fmt: skip
def test_what_excludes_each_other_is_said(more, place):
    given = {key: value for key, value in {**DRIVEN, **more}.items() if value is not None}
    assert place in places_of(vibrafeed.simulate, **given, outputs=["conveying_velocity"])


def test_no_method_verifies_a_row():
    with pytest.raises(StudyError, match="no other method"):
        vibrafeed.simulate(
            **DRIVEN, part_friction_1=[0.3, 0.4], part_friction_2=0.35, verify=2,
            outputs=["conveying_velocity"],
        )  # fmt: skip


def test_a_row_on_a_drive_unit_moves_as_the_amplitude_of_the_unit_says():
    row = {"scene": "row-on-plane", "outputs": ["conveying_velocity", "track_amplitude"]}
    row |= {"part_friction_1": 0.4, "part_friction_2": 0.3}
    found = vibrafeed.simulate(**row, **UNIT)
    row["outputs"] = ["conveying_velocity"]
    size = float(found.track_amplitude)
    again = vibrafeed.simulate(**row, frequency=50, amplitude=size, beta=25)
    speed = float(found.conveying_velocity)
    assert speed == pytest.approx(float(again.conveying_velocity), rel=1e-9)
    loaded = {**UNIT, "friction": 0.4, "conveyed_mass": 0.5, "outputs": ["conveying_velocity"]}
    one = vibrafeed.simulate(scene="rectangle-on-plane", **loaded)
    row = vibrafeed.simulate(scene="row-on-plane", parts=8, **loaded)
    assert float(row.conveying_velocity) == float(one.conveying_velocity)


def test_a_row_that_rebounds_without_end_has_a_path_up_to_there():
    """Bounces between a stop and what is pressed against it: the path went on for minutes."""
    row = cell(
        0.9090195874257787, 1.2464918370262843,
        [
            0.22689498742647216, 0.10105312365290828, 0.39522929402404416, 0.39978566721883513,
            0.47877091551450957,
        ],
        mass=[
            0.6365679783420476, 1.645327580376353, 1.109117280994448, 0.5197438917845667,
            1.407558668338129,
        ],
        gap=[0.0, 0.3, 0.0, 0.0],
        stop=IN_SPACE, e=0.5,
    )  # fmt: skip
    places, gaps = path(row, np.linspace(0.0, 6.0 * TURN, 20))
    # Whether it sticks is decided by rounding; that it ends, and where its values end, is not.
    ended = np.isnan(places).any(axis=1)
    assert not ended[0]
    assert (np.diff(ended.astype(int)) >= 0).all()
    assert (np.isnan(gaps).any(axis=1) == ended).all()
