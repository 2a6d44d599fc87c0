"""Exact motion under any drive: closed solutions, the laws that all motions keep, two kernels."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.waves import harmonics, steps
from random_waves import parts, shifted
from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import run_study
from vibrafeed.core.motion import waves
from vibrafeed.core.motion.events import planar_motion, spatial_motion
from vibrafeed.core.motion.kernels.sine_sums import SineSum, passages
from vibrafeed.core.motion.method import STATUS, Contacts, Groups
from vibrafeed.core.motion.waves import ALONG, NORMAL, TURN, Wave

G = 9.81
PLANAR = {"tolerance": 1e-12, "max_periods": 1000.0}
SPATIAL = {"tolerance": 1e-10, "max_periods": 400.0}
REPEATS = [STATUS["periodic"], STATUS["at_rest"]]
WAVES = [(harmonics, 1), (harmonics, 2), (harmonics, 5), (harmonics, 8), (steps, 2), (steps, 7)]
ASKED = ["conveying_velocity", "conveying_velocity_error"]


def velocity(scene: str = "rectangle-on-plane", **parameters) -> float:
    """Return the mean velocity of one study [m/s]."""
    study = {
        "kind": "simulate",
        "scene": scene,
        "outputs": ASKED,
        "parameters": {"gravity": G, **parameters},
    }
    found = run_study(parse_study(study))
    assert found.motion_status.item() == STATUS["periodic"]
    return found.conveying_velocity.item()


# --- closed solutions


@pytest.mark.parametrize(
    ("slow", "fast", "frequency", "static", "kinetic", "expected"),
    [(0.4, 2.0, 50.0, 0.5, 0.3, 15.882857142857142e-3), (0.2, 1.0, 100.0, 0.25, 0.2, 3.27e-3)],
)
@pytest.mark.parametrize("scene", ["rectangle-on-plane", "rectangle-on-track"])
def test_two_levels(slow, fast, frequency, static, kinetic, expected, scene):
    """Q: the part sticks at the lower acceleration and slips back at the higher one.

    On the track the motion in space follows it, since the wave across is 0 but the floor leans.
    """
    part = fast / (2 * (slow + fast))
    found = velocity(
        scene,
        frequency=frequency,
        friction_static=static,
        friction_kinetic=kinetic,
        acceleration_along_1=slow * G,
        acceleration_along_2=-fast * G,
        acceleration_along_3=slow * G,
        duration_1=part,
        duration_2=1 - 2 * part,
        duration_3=part,
        **({"radius": 1e6} if scene == "rectangle-on-track" else {}),
    )
    assert found == pytest.approx(expected, rel=1e-6 if "track" in scene else 1e-12)


@pytest.mark.parametrize(("static", "kinetic"), [(0.5, 0.3), (0.37, 0.1), (0.3, 0.1)])
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("ulps", [-3, 0, 1, 3])
def test_a_step_at_the_limit_of_friction_holds_whatever_its_last_bit(static, kinetic, way, ulps):
    """Q at a_s = mu_s g, where a slip would be half as fast: forward and in its mirror image."""
    slow, fast = static * (1 + ulps * np.finfo(float).eps), 2.0
    exact = G / 100 * slow**2 * (fast - kinetic) / ((slow + fast) * (slow + kinetic))
    drive = {
        "acceleration_along_1": way * slow * G,
        "acceleration_along_2": -way * fast * G,
        "duration_1": fast,
        "duration_2": slow,
    }
    friction = {"friction_static": static, "friction_kinetic": kinetic}
    for scene in ("rectangle-on-plane", "rectangle-on-track"):
        curve = {"radius": 1e12} if "track" in scene else {}
        found = velocity(scene, frequency=50, **friction, **drive, **curve)
        assert found == pytest.approx(way * exact, rel=1e-9)


@pytest.mark.parametrize(
    ("along", "normal", "friction", "expected"),
    [(0.4, 0.3, 0.4, 3.32687e-3), (0.3, 0.9, 0.25, 9.1376e-3)],
)
def test_winkler(along, normal, friction, expected):
    """W: half a period forward and pressed on, half a period back and relieved."""
    less, more = friction * (1 - normal), friction * (1 + normal)
    exact = G / 50 / 8 * (along - less) * (2 * along + more - less) / (along + more)
    found = velocity(
        frequency=50,
        friction=friction,
        acceleration_along_1=along * G,
        acceleration_normal_1=normal * G,
        acceleration_along_2=-along * G,
        acceleration_normal_2=-normal * G,
    )
    assert found == pytest.approx(exact, rel=1e-12)
    assert found == pytest.approx(expected, rel=1e-4)  # as printed


def test_fast_ellipse():
    """M: far above friction the speed is a weighted median of the track's, reached from below."""
    limits = []
    for small in (0.02, 0.01, 0.005):
        # mu g/(A w^2) = small, and the normal acceleration is gravity's.
        friction, frequency = 0.2, 50.0
        along = friction * G / small / (TURN * frequency) ** 2
        found = velocity(
            frequency=frequency,
            friction=friction,
            amplitude_along_1=along,
            amplitude_normal_1=G * (1 - 1e-12) / (TURN * frequency) ** 2,
            phase_normal_1=-90.0,
        )
        limits.append(found / (along * TURN * frequency))
    off = np.abs(np.array(limits) - 0.6736120291832148)
    assert off[0] < 2e-3
    assert off[0] > 1.9 * off[1] > 3.6 * off[2]


def test_two_frequencies_far_above_friction():
    """M: cos t + e cos 2t along the track under a constant load tends to -e times its speed."""
    frequency, friction, share = 50.0, 0.2, 0.2
    off = []
    for small in (0.02, 0.01, 0.005):
        amplitude = friction * G / small / (TURN * frequency) ** 2
        found = velocity(
            frequency=frequency,
            friction=friction,
            amplitude_along_1=amplitude,
            amplitude_along_2=share * amplitude / 2,
        )
        off.append(abs(found / (amplitude * TURN * frequency) + share))
    assert off[0] < 1e-3
    assert off[0] > 1.9 * off[1] > 3.6 * off[2]


def test_one_harmonic_is_the_plain_sine():
    """A wave of one order in phase on both axes is today's drive."""
    beta, amplitude = np.radians(25.0), 0.4e-3
    common = {"frequency": 50, "friction": 0.35, "gamma": 2.0}
    sine = velocity(**common, amplitude=amplitude, beta=25.0)
    wave = velocity(
        **common,
        amplitude_along_1=amplitude * np.cos(beta),
        amplitude_normal_1=amplitude * np.sin(beta),
    )
    assert wave == pytest.approx(sine, rel=1e-12)


# --- laws


@pytest.mark.parametrize(("kind", "orders"), WAVES)
def test_plane_and_space_agree(kind, orders):
    """Two kernels that share no flow: closed forms in the plane, series in space (issue: 99 %)."""
    pick = np.random.default_rng(orders)
    groups = parts(pick, kind(pick, 350, orders), rebounds=True)
    planar = planar_motion(groups, **PLANAR)
    spatial = spatial_motion(groups, Contacts(), **SPATIAL)
    speed = waves.size(groups.wave)
    both = np.isin(planar.status, REPEATS) & np.isin(spatial.status, REPEATS)
    assert both.mean() > 0.9
    apart = np.abs(planar.velocity - spatial.velocity)[both]
    assert np.mean(apart <= 1e-9 * speed[both]) >= 0.99
    assert np.all(apart <= (planar.error + spatial.error)[both])
    assert np.all(planar.status != STATUS["not_computed"])
    assert np.all(spatial.status != STATUS["not_computed"])


def moving(pick: np.random.Generator, kind, orders: int, cells: int = 150) -> Groups:
    """Return random parts whose motion every start leads to: one coefficient, no rebound."""
    groups = parts(pick, kind(pick, cells, orders))
    return groups._replace(friction_static=groups.friction_kinetic)


def same(one, other, speed) -> None:
    """Assert that motions which both repeat have one mean."""
    both = np.isin(one.status, REPEATS) & np.isin(other.status, REPEATS)
    assert both.mean() > 0.9
    assert np.all(np.abs(one.velocity - other.velocity)[both] <= 1e-10 * speed[both])


@pytest.mark.parametrize("orders", [1, 3, 8])
def test_a_shift_of_time_changes_nothing(orders):
    pick = np.random.default_rng(orders)
    groups = moving(pick, harmonics, orders)
    later = groups._replace(wave=shifted(groups.wave, 1.234))
    one, other = planar_motion(groups, **PLANAR), planar_motion(later, **PLANAR)
    # A part that hops may fall into another motion from another start.
    stays = (one.flight == 0) & (other.flight == 0)
    assert stays.sum() > 10
    both = stays & np.isin(one.status, REPEATS) & np.isin(other.status, REPEATS)
    apart = np.abs(one.velocity - other.velocity)[both]
    assert np.all(apart <= 1e-10 * waves.size(groups.wave)[both])


@pytest.mark.parametrize(("kind", "orders"), WAVES)
def test_the_mirror_image_moves_the_other_way(kind, orders):
    pick = np.random.default_rng(orders)
    groups = moving(pick, kind, orders)
    harmonic, stepped = (np.array(part) for part in groups.wave)
    harmonic[ALONG] *= -1
    stepped[ALONG] *= -1
    turned = groups._replace(
        wave=Wave(harmonic, stepped), gravity_number_along=-groups.gravity_number_along
    )
    one, other = planar_motion(groups, **PLANAR), planar_motion(turned, **PLANAR)
    same(one, other._replace(velocity=-other.velocity), waves.size(groups.wave))


def test_a_second_harmonic_turned_by_half_a_period_turns_the_motion():
    """S: with a constant load a wave of odd and even orders, its even ones reversed, reverses."""
    pick = np.random.default_rng(3)
    groups = moving(pick, harmonics, 4)
    harmonic = np.array(groups.wave.harmonics)
    harmonic[NORMAL] = 0.0
    even = np.array(harmonic)
    even[ALONG, :, 1::2] *= -1
    level = groups._replace(gravity_number_along=0.0, gravity_number_normal=1.0)
    one, other = (
        planar_motion(level._replace(wave=Wave(part, groups.wave.steps)), **PLANAR)
        for part in (harmonic, even)
    )
    same(one, other._replace(velocity=-other.velocity), waves.size(groups.wave))


def test_along_once_and_normal_twice_goes_nowhere():
    """S: along at the drive frequency with normal at twice that, on the level, gives 0."""
    found = [
        velocity(
            frequency=50, friction=0.4, amplitude_along_1=3e-4,
            amplitude_normal_2=2e-5, phase_normal_2=phase,
        )
        for phase in (0.0, 40.0, 90.0, 133.0)
    ]  # fmt: skip
    assert np.max(np.abs(found)) < 1e-12 * 3e-4 * TURN * 50


@pytest.mark.parametrize(("kind", "orders"), WAVES)
def test_never_faster_than_the_track(kind, orders):
    """On the level, friction carries a part no faster than the track ever goes."""
    pick = np.random.default_rng(10 + orders)
    groups = moving(pick, kind, orders, 400)
    level = groups._replace(gravity_number_along=0.0, gravity_number_normal=1.0)
    found = planar_motion(level, **PLANAR)
    sure = np.isin(found.status, REPEATS)
    fastest = waves.largest_over_period(groups.wave, ALONG, "speed")
    assert np.all(np.abs(found.velocity)[sure] <= fastest[sure] * (1 + 1e-12))


# --- no event is missed


def test_every_passage_of_a_sum_is_found():
    """Against dense signs, to the width of what they see."""
    pick = np.random.default_rng(0)
    phases = np.linspace(0.0, TURN, 20_001)
    for orders in (1, 2, 3, 6, 10):
        k = np.arange(1, orders + 1)[:, np.newaxis]
        for _ in range(40):
            table = np.zeros((3, 26))
            table[:2, 1 : orders + 1] = pick.normal(size=(2, orders))
            level = 0.5 * pick.normal()
            count = passages(SineSum(table, 0, 1, orders), level, 2, 24)
            total = table[0, 1 : orders + 1] @ np.sin(k * phases)
            total += table[1, 1 : orders + 1] @ np.cos(k * phases)
            seen = phases[:-1][np.diff(total > level)]
            assert count == seen.size
            found = table[2, 1 : count + 1]
            assert np.all(np.abs(found - seen) < phases[1])
            values = table[0, 1 : orders + 1] @ np.sin(k * found)
            values += table[1, 1 : orders + 1] @ np.cos(k * found)
            assert np.all(np.abs(values - level) < 1e-13 * orders**2 * 10)
