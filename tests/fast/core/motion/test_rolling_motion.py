"""Round parts in time: two theorems against time stepping of a test's own, statuses, words."""

import numpy as np
import pytest

import vibrafeed
from night import count
from vibrafeed.core.dataset.table import percent
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.mechanics.rolling import RollingContact
from vibrafeed.core.motion.events import motion_by_events, planar_path
from vibrafeed.core.motion.feeding import travel_in_words
from vibrafeed.core.motion.method import STATUS, Contacts
from vibrafeed.core.motion.rolling_scene import always_rolls, block_groups
from vibrafeed.core.quantities import REGIMES

TURN = 2 * np.pi
BALL = {"scene": "sphere-on-plane", "frequency": 50.0, "beta": 20.0}


def simulate(*outputs, **given):
    found = vibrafeed.simulate(outputs=outputs, **given)
    values = [found[name].values for name in outputs]
    return (*values, found.regime.values, found.motion_status.values)


def numbers(along, normal, gamma=0.0):
    """Return the parameters of some drive numbers at 1/(2 pi) Hz, and g = 1."""
    return {
        "frequency": 1 / TURN, "gravity": 1.0, "gamma": float(np.degrees(gamma)),
        "amplitude": float(np.hypot(along, normal)),
        "beta": float(np.degrees(np.arctan2(normal, along))),
    }  # fmt: skip


# --- T1: friction conveys no round part


@pytest.mark.parametrize(
    ("kap", "along", "normal", "mu", "restitution", "known"),
    [
        (2.5, 1.0, 0.5, 0.3, 0.0, -0.0356994066),
        (2.5, 3.0, 0.9, 0.1, 0.0, -0.0356994066),
        (2.0, 1.0, 1.8, 0.2, 0.0, -0.0333194462),
        (1.5, 1.0, 2.6, 0.2, 0.4, -0.0299875016),
    ],
)
def test_a_ball_runs_down_whatever_drives_it(kap, along, normal, mu, restitution, known):
    given = {**numbers(along, normal, 0.05), "friction": mu, "rolling_factor": kap}
    speed, down, regime, status = simulate(
        "conveying_velocity", "mean_acceleration", scene="sphere-on-plane", **given
    )
    assert down == pytest.approx(-np.sin(0.05) * kap / (1 + kap), rel=1e-12)
    assert down == pytest.approx(known, abs=5e-10)
    assert np.isnan(speed)
    assert (regime, status) == (REGIMES["runaway"].value, STATUS["runaway"])


G = 9.80665
SLIPPERY = [
    # -(g sin(gamma) - mu g cos(gamma)), for the disc with the wall's share, and free fall; the
    # first is also that of an integration with 4,000 steps a period, -6.240913844149798.
    ({"gamma": 45, "friction": 0.1}, -6.24091384415075),
    ({"gamma": 30, "friction": 0}, -G / 2),
    ({"gamma": 90, "friction": 0.3}, -G),
    ({"gamma": 10, "friction": 0.04}, -1.3166003034743),
    ({"gamma": 5, "friction": 0.05, "rolling_resistance": 0.05}, -0.3662392278142),
    # Rolling resistance beyond friction: the part slides as a block does.
    ({"gamma": 5, "friction": 0.05, "rolling_resistance": 0.2}, -0.3662392278142),
    ({"gamma": 45, "friction": 0.1, "scene": "roller-on-plane"}, -6.24091384415075),
    ({"gamma": 45, "friction": 0.1, "scene": "disc-on-edge", "delta": 5, "wall_friction": 0.2},
     -6.1226789106328),
    ({"gamma": 45, "friction": 0.1, "scene": "disc-on-edge", "delta": 5, "wall_friction": 0},
     -6.2435525731908),
]  # fmt: skip


@pytest.mark.parametrize("method", ["events", "reference"])
@pytest.mark.parametrize(("given", "known"), SLIPPERY)
def test_where_the_slip_runs_away_friction_alone_holds_the_part(given, known, method):
    for way in (1, -1):
        turned = {**BALL, "amplitude": "0.1 mm", **given, "gamma": way * given["gamma"]}
        down, speed, regime, status = simulate(
            "mean_acceleration", "conveying_velocity", method=method, **turned
        )
        assert down == pytest.approx(way * known, rel=1e-12)
        assert np.isnan(speed)
        assert (regime, status) == (REGIMES["runaway"].value, STATUS["runaway"])


@pytest.mark.parametrize("given", [{"gamma": 10, "friction": 0.04}, {"gamma": 5, "friction": 0.2}])
def test_a_drive_that_does_not_move_is_the_snapshot(given):
    down, *_ = simulate("mean_acceleration", **{**BALL, **given}, amplitude="1e-9 mm")
    still = vibrafeed.sweep(scene="sphere-on-plane", outputs=["acceleration_x"], frequency=50,
                            amplitude=0, beta=0, alpha=0, **given)  # fmt: skip
    assert down == pytest.approx(float(still.acceleration_x), rel=1e-12)


def run_down(contact, sine, periods=40, steps=100):
    """Return the mean acceleration of a part over the second half of some periods, over gravity.

    Step by step, from rest: the forces of the floor, of rolling resistance and of the wall are
    relaxed in turn until they change no more. Parts hop without rebound.
    """
    kap, dt = contact["factor"], TURN / steps
    u = v = height = lifting = half = 0.0
    for k in range(periods * steps):
        swing = sine[k % steps]
        lifting += contact["normal"] * swing - contact["load"] * dt
        pressed = max(0.0, -height / dt - lifting)
        lifting += pressed
        height = max(0.0, height + dt * lifting)
        u += contact["along"] * swing - contact["uphill"] * dt
        floor = couple = wall = 0.0
        change = 1.0
        while change > 1e-12:
            before = floor, couple, wall
            floor -= (u + floor - wall - v + kap * (floor + couple)) / (1 + kap)
            most = pressed * contact["static" if abs(floor) <= contact["static"] * pressed
                                     else "kinetic"]  # fmt: skip
            floor = min(max(floor, -most), most)
            most = contact["resistance"] * pressed
            couple = min(max(v / kap - floor, -most), most)
            most = contact["drag"] * dt
            wall = min(max(u + floor, -most), most)
            change = sum(abs(a - b) for a, b in zip(before, (floor, couple, wall), strict=True))
        u, v = u + floor - wall, v - kap * (floor + couple)
        half = u if k == periods * steps // 2 - 1 else half
    return (u - half) / (TURN * periods / 2)


def test_the_mean_acceleration_by_steps_of_random_parts():
    random, unknown, slipped = np.random.default_rng(6), 0, 0
    phases = np.cos(np.linspace(0, TURN, 101))
    sine = (phases[:-1] - phases[1:]).tolist()
    for _ in range(count(15, 500)):
        kinetic, more = random.choice([0.0, 0.02, 0.1, 0.2]), random.choice([1.0, 1.0, 1.3])
        gamma = random.choice([-1, 1]) * random.uniform(0.005, 0.8)
        along, normal, kap = random.uniform([-1.5, 0, 0.8], [1.5, 1.4, 3])
        resistance, leans = random.choice([0.0, 0.0, 0.01, 0.05, 0.15]), random.random() < 0.4
        delta, rub = (0.2, random.uniform(0, 0.4)) if leans else (0.0, 0.0)
        load = np.cos(gamma) * np.cos(delta)
        one = {
            "factor": kap, "static": more * kinetic, "kinetic": kinetic, "load": load,
            "resistance": resistance, "drag": rub * np.cos(gamma) * np.sin(delta),
            "along": along, "normal": normal, "uphill": np.sin(gamma),
        }  # fmt: skip
        wall = {"delta": np.degrees(delta), "wall_friction": rub} if leans else {}
        down, regime, _ = simulate(
            "mean_acceleration", scene="disc-on-edge" if leans else "sphere-on-plane",
            friction_static=more * kinetic, friction_kinetic=kinetic, rolling_factor=kap,
            rolling_resistance=resistance, **numbers(along, normal, gamma), **wall,
        )  # fmt: skip
        if np.isnan(down):  # static friction above kinetic, rolling resistance and hops
            assert regime == REGIMES["rolls_and_slips"].value
            unknown += 1
            continue
        # A part may end its last period up to a swing of the drive apart from its mean.
        stepped = run_down({name: float(value) for name, value in one.items()}, sine)
        assert stepped == pytest.approx(float(down), abs=0.025), one
        slipped += abs(float(down)) > kap / (1 + kap) * abs(np.sin(gamma))
    assert slipped > 3
    assert unknown <= count(1, 10)


def test_between_static_and_kinetic_friction_the_drive_decides():
    # 3.5 mu from 0.35 to 0.455; tan(22 deg) = 0.404.
    given = {**BALL, "gamma": 22, "friction_static": 0.13, "friction_kinetic": 0.1}
    slope = np.radians(22)
    down, *_ = simulate("mean_acceleration", amplitude=["0.002 mm", "0.1 mm"], **given)
    assert down[0] == pytest.approx(-5 / 7 * G * np.sin(slope), rel=1e-12)
    assert down[1] == pytest.approx(-G * (np.sin(slope) - 0.1 * np.cos(slope)), rel=1e-12)
    # In hops and with rolling resistance the course of the slip is not known.
    down, regime, status = simulate(
        "mean_acceleration", amplitude="0.5 mm", rolling_resistance=0.01, **given
    )
    assert np.isnan(down)
    assert (regime, status) == (REGIMES["rolls_and_slips"].value, STATUS["rolls_and_slips"])


def test_a_disc_that_leans_off_its_wall():
    _, regime, _ = simulate(
        "mean_acceleration", scene="disc-on-edge", frequency=50, amplitude="0.1 mm", beta=20,
        gamma=5, friction=0.1, delta=[-5.0, 0.0],
    )  # fmt: skip
    assert regime.tolist() == [REGIMES["wall_lost"].value, REGIMES["runaway"].value]


def test_the_slip_is_that_of_a_block_with_more_friction():
    drive = numbers(1.0, 0.5)
    ball, *_ = simulate("slip_velocity", scene="sphere-on-plane", friction=0.05, **drive)
    block, *_ = simulate("conveying_velocity", scene="rectangle-on-plane", friction=0.175, **drive)
    assert ball == pytest.approx(float(block), rel=1e-12)
    given = {**BALL, "amplitude": "0.1 mm", "friction": 0.05, "gamma": 5}
    slip, *_ = simulate("slip_velocity", rolling_resistance=[0.0, 0.05], **given)
    # tan(5 deg) is half of 3.5 * 0.05; with the resistance the slip runs away.
    assert np.isnan(slip).tolist() == [False, True]


@pytest.mark.parametrize("given", [{"friction": 0.3}, {"friction": 0, "rolling_resistance": 0.02}])
def test_on_the_level_it_keeps_its_speed(given):
    speed, down, regime, status = simulate(
        "conveying_velocity", "mean_acceleration", **BALL, amplitude="0.3 mm", **given
    )
    assert (speed, down) == (0, 0)
    assert (regime, status) == (REGIMES["neutral"].value, STATUS["neutral"])


# --- T2: rolling resistance does


@pytest.mark.parametrize(
    ("kap", "known"), [(2.0, 0.0130592582), (2.5, 0.0139920624), (1.0, 0.0097944436)]
)
def test_a_roller_is_conveyed_by_its_rolling_resistance(kap, known):
    given = {**numbers(0.05, 0.6), "friction": 0.3, "rolling_resistance": 0.02}
    speed, regime, status = simulate(
        "conveying_velocity", scene="roller-on-plane", rolling_factor=kap, **given
    )
    # The known values come from time stepping, good to some 1e-4 of them.
    assert speed == pytest.approx(known, rel=1e-3)
    assert (regime, status) == (REGIMES["roll"].value, STATUS["periodic"])
    block, *_ = simulate("conveying_velocity", scene="rectangle-on-plane", friction=0.02,
                         **numbers(0.05, 0.6))  # fmt: skip
    assert speed / block == pytest.approx(kap / (1 + kap), rel=1e-12)


# --- the limit of traction


def contact(**changes):
    given = {"share": 5 / 7, "factor": 2.5, "static": 0.3, "kinetic": 0.3, "restitution": 0.0,
             "resistance": 0.02, "drag": 0.0, "load": 1.0, "uphill": 0.0, "along": 0.3,
             "normal": 0.5}  # fmt: skip
    return RollingContact(**{k: np.asarray(v) for k, v in {**given, **changes}.items()})


def test_the_limit_of_traction_by_the_whole_path():
    random = np.random.default_rng(3)
    between = 0
    for _ in range(count(25, 400)):
        along, uphill = random.uniform([-1.5, -0.01], [1.5, 0.01])
        normal, drag = random.uniform(-0.9, 0.9), random.choice([0.0, 0.01])
        one = contact(along=along, normal=normal, uphill=uphill, drag=drag)
        groups = block_groups(one)
        motion = motion_by_events(groups, Contacts(), tolerance=1e-12, max_periods=1000)
        needed = traction_by_samples(one, groups)
        if motion.status != STATUS["periodic"]:
            continue
        for factor in (0.97, 0.999, 1.001, 1.03):
            limited = one._replace(static=np.asarray(factor * needed))
            if limited.static < limited.resistance:
                continue
            assert bool(always_rolls(limited, None)) == (factor > 1), (along, normal, factor)
            between += not (limited.surely_rolls | limited.surely_slips)
    assert between > 0


def traction_by_samples(one, groups):
    """Return the largest friction over load that rolling takes, at many phases of the path."""
    phases = np.linspace(0, TURN, 40_001)
    path, _ = planar_path(groups.single(), tolerance=1e-12, max_periods=1000, phases=phases)
    way = np.sign(path.velocity[:, 0])
    push = float(one.along) * np.sin(phases) - float(one.uphill)
    load = float(one.load) - float(one.normal) * np.sin(phases)
    kap, c, w = (float(getattr(one, name)) for name in ("factor", "resistance", "drag"))
    moving = np.abs(push + way * (kap * c * load - w)) / (1 + kap)
    needed = np.where(way == 0, np.maximum(np.abs(push) - w, 0.0), moving) / load
    return needed.max()


def test_little_friction_rolls_and_slips_and_more_rolls():
    given = {**numbers(0.5, 0.4), "rolling_resistance": 0.01}
    speed, regime, status = simulate(
        "conveying_velocity", scene="sphere-on-plane", friction=[0.1, 0.5], **given
    )
    assert status.tolist() == [STATUS["rolls_and_slips"], STATUS["periodic"]]
    assert regime.tolist() == [REGIMES["rolls_and_slips"].value, REGIMES["roll"].value]
    assert np.isnan(speed[0])
    assert speed[1] > 0
    _, hops = simulate("conveying_velocity", scene="sphere-on-plane", friction=0.5,
                       **{**given, **numbers(0.5, 1.2)})[1:]  # fmt: skip
    assert hops == STATUS["rolls_and_slips"]


# --- a disc at the wall


def test_a_disc_at_the_wall_is_carried_by_its_friction():
    given = {**numbers(0.4, 0.5), "friction": 0.5, "delta": 10.0, "wall_friction": 0.3}
    speed, regime, _ = simulate(
        "conveying_velocity", scene="disc-on-edge", rolling_resistance=[0.0, 0.05], **given
    )
    # Constant friction: the wall's, under a drive along the track alone, does not convey.
    assert speed[0] == pytest.approx(0, abs=1e-12)
    assert regime[0] == REGIMES["roll"].value
    assert speed[1] == pytest.approx(0.033748, rel=1e-3)  # by steps of a program of its own


def test_methods_agree_and_a_study_is_verified():
    given = {**numbers(0.3, 0.6), "friction": 0.5, "rolling_resistance": 0.02}
    exact, *_ = simulate("conveying_velocity", scene="sphere-on-plane", **given)
    other, *_ = simulate("conveying_velocity", scene="sphere-on-plane", method="reference", **given)
    assert other == pytest.approx(float(exact), rel=1e-9)
    # Outputs per part need a mass, which the other method does not.
    found = vibrafeed.simulate(scene="rectangle-on-plane", outputs=["part_drive_power"], mass=0.005,
                               verify=1, **numbers(0.3, 0.6), friction=0.5)  # fmt: skip
    assert "reference" in str(found.attrs)


DOWN, HALF = "The part does not travel", f"The part does not travel in {percent(0.5)} of the cells"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"gamma": 2.87}, f"{DOWN}: it runs down at 0.35 m/s²."),
        ({"gamma": 2.87, "rolling_factor": [1.0, 2.5], "friction": [0.1, 0.3]},
         f"{DOWN}: it runs down at 0.25 to 0.35 m/s²."),
        ({"gamma": [0, 2.87]},
         f"{HALF}: it runs down at 0.35 m/s². "
         f"{HALF}: nothing conveys it, and it keeps the speed that it has."),
        ({"rolling_resistance": 0.05, "amplitude": "0.02 mm"}, ""),
    ],
)  # fmt: skip
def test_words_for_a_ball_that_does_not_travel(given, words):
    study = {"kind": "simulate", "scene": "sphere-on-plane", "outputs": ["feed_rate"],
             "parameters": {"frequency": 50, "amplitude": "0.1 mm", "beta": 20,
                            "friction": 0.3, "length": "8 mm", **given}}  # fmt: skip
    assert travel_in_words(tabulate(prepare_content(study))) == words
