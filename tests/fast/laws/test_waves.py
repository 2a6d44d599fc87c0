"""Exact motion under any drive: closed solutions, the laws that all motions keep, two kernels."""

import numpy as np
import pytest

import vibrafeed
from benchmarks.waves import PLANAR, SPATIAL, harmonics, parts, steps
from night import count
from vibrafeed.core.motion import waves
from vibrafeed.core.motion.events import planar_motion, spatial_motion
from vibrafeed.core.motion.method import STATUS, Contacts, Groups
from vibrafeed.core.motion.waves import ALONG, NORMAL, TURN, Wave

G = 9.81
REPEATS = [STATUS["periodic"], STATUS["at_rest"]]
WAVES = [(harmonics, 1), (harmonics, 2), (harmonics, 5), (harmonics, 8), (steps, 2), (steps, 7)]


def velocity(scene: str = "rectangle-on-plane", **parameters) -> float:
    """Return the mean velocity of one study at 50 Hz [m/s]."""
    found = vibrafeed.simulate(
        scene=scene, gravity=G, frequency=50, **parameters, outputs=["conveying_velocity"]
    )
    assert found.motion_status.item() == STATUS["periodic"]
    return found.conveying_velocity.item()


# --- closed solutions


@pytest.mark.parametrize(("static", "kinetic"), [(0.5, 0.3), (0.3, 0.1)])
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("ulps", [-3, 0, 3])
def test_a_step_at_the_limit_of_friction_holds_whatever_its_last_bit(static, kinetic, way, ulps):
    """Q at a_s = mu_s g, where a slip would be half as fast: forward and in its mirror image."""
    slow, fast = static * (1 + ulps * np.finfo(float).eps), 2.0
    exact = G / 100 * slow**2 * (fast - kinetic) / ((slow + fast) * (slow + kinetic))
    given = {
        "acceleration_along_1": way * slow * G, "acceleration_along_2": -way * fast * G,
        "duration_1": fast, "duration_2": slow, "friction_static": static,
        "friction_kinetic": kinetic,
    }  # fmt: skip
    on_track = velocity("rectangle-on-track", **given, radius=1e12)
    assert [velocity(**given), on_track] == pytest.approx([way * exact] * 2, rel=1e-9)


@pytest.mark.parametrize(
    ("normal", "second", "limit"), [(1 - 1e-12, 0.0, 0.6736120291832148), (0.0, 0.2, 0.2)]
)
def test_far_above_friction_the_speed_is_a_weighted_median_of_the_tracks(normal, second, limit):
    """M: an ellipse whose load is all but 0 once; cos t + e cos 2t, whose median is -e."""
    off = []
    for small in (0.02, 0.01, 0.005):  # mu g/(A w^2)
        along = 0.2 * G / small / (TURN * 50) ** 2
        found = velocity(
            friction=0.2, amplitude_along_1=along, amplitude_along_2=second * along / 2,
            amplitude_normal_1=G * normal / (TURN * 50) ** 2, phase_normal_1=-90.0,
        )  # fmt: skip
        off.append(abs(abs(found) / (along * TURN * 50) - limit))
    assert off[0] < 2e-3
    assert off[0] > 1.9 * off[1] > 3.6 * off[2]


# --- laws


@pytest.mark.parametrize(("kind", "orders"), WAVES)
def test_plane_and_space_agree(kind, orders):
    """Two kernels that share no flow: closed forms in the plane, series in space (issue: 99 %)."""
    pick = np.random.default_rng(orders)
    groups = parts(pick, kind(pick, count(60, 350), orders))
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


def moving(pick: np.random.Generator, kind, orders: int, cells: int = 60) -> Groups:
    """Return random parts whose motion every start leads to: one coefficient, no rebound."""
    groups = parts(pick, kind(pick, cells, orders))
    return groups._replace(friction_static=groups.friction_kinetic, restitution=0.0)


def same(one, other, speed) -> None:
    """Assert that motions which both repeat have one mean."""
    both = np.isin(one.status, REPEATS) & np.isin(other.status, REPEATS)
    assert both.mean() > 0.9
    assert np.all(np.abs(one.velocity - other.velocity)[both] <= 1e-10 * speed[both])


@pytest.mark.parametrize("orders", [1, 3, 8])
def test_a_shift_of_time_changes_nothing(orders):
    groups = moving(np.random.default_rng(orders), harmonics, orders, 100)
    sine, cosine = np.moveaxis(groups.wave.harmonics, 1, 0)
    turn = 1.234 * np.arange(1, orders + 1)[:, np.newaxis]
    turned = np.stack([
        sine * np.cos(turn) - cosine * np.sin(turn), sine * np.sin(turn) + cosine * np.cos(turn),
    ], axis=1)  # fmt: skip
    later = groups._replace(wave=Wave(turned, groups.wave.steps))
    one, other = planar_motion(groups, **PLANAR), planar_motion(later, **PLANAR)
    # A part that hops may fall into another motion from another start.
    both = (one.flight == 0) & (other.flight == 0)
    both &= np.isin(one.status, REPEATS) & np.isin(other.status, REPEATS)
    assert both.sum() > 10
    apart = np.abs(one.velocity - other.velocity)[both]
    assert np.all(apart <= 1e-10 * waves.size(groups.wave)[both])


@pytest.mark.parametrize(("kind", "orders"), WAVES)
def test_the_mirror_image_moves_the_other_way_and_none_faster_than_the_track(kind, orders):
    """On the level, friction carries a part no faster than the track ever goes."""
    groups = moving(np.random.default_rng(orders), kind, orders)
    harmonic, stepped = (np.array(part) for part in groups.wave)
    harmonic[ALONG] *= -1
    stepped[ALONG] *= -1
    turned = groups._replace(
        wave=Wave(harmonic, stepped), gravity_number_along=-groups.gravity_number_along
    )
    one, other = planar_motion(groups, **PLANAR), planar_motion(turned, **PLANAR)
    same(one, other._replace(velocity=-other.velocity), waves.size(groups.wave))
    level = groups._replace(gravity_number_along=0.0, gravity_number_normal=1.0)
    found = planar_motion(level, **PLANAR)
    sure = np.isin(found.status, REPEATS)
    fastest = waves.largest_over_period(groups.wave, ALONG, "speed")
    assert np.all(np.abs(found.velocity)[sure] <= fastest[sure] * (1 + 1e-12))


def test_a_second_harmonic_turned_by_half_a_period_turns_the_motion():
    """S: with a constant load a wave of odd and even orders, its even ones reversed, reverses."""
    groups = moving(np.random.default_rng(3), harmonics, 4)
    odd = np.array(groups.wave.harmonics)
    odd[NORMAL] = 0.0
    even = np.array(odd)
    even[ALONG, :, 1::2] *= -1
    level = groups._replace(gravity_number_along=0.0, gravity_number_normal=1.0)
    one, other = (
        planar_motion(level._replace(wave=Wave(part, groups.wave.steps)), **PLANAR)
        for part in (odd, even)
    )
    same(one, other._replace(velocity=-other.velocity), waves.size(groups.wave))


@pytest.mark.parametrize("phase", [0.0, 40.0, 133.0])
def test_along_once_and_normal_twice_goes_nowhere(phase):
    """S: along at the drive frequency with normal at twice that, on the level, gives 0."""
    normal = {"amplitude_normal_2": 2e-5, "phase_normal_2": phase}
    found = velocity(friction=0.4, amplitude_along_1=3e-4, **normal)
    assert abs(found) < 1e-12 * 3e-4 * TURN * 50
