"""Lines of devices: worked values, parts that go round one by one, laws, drop tests."""

from __future__ import annotations

import itertools
import tomllib

import numpy as np
import pytest
import scipy
from scipy import stats

import vibrafeed
from night import count
from plans import make_plan
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.mechanics import orienting
from vibrafeed.core.plan.trace import traced
from vibrafeed.core.quantities import REGIMES

BOX = {"length": "30 mm", "width": "20 mm", "height": "10 mm"}
FLAT_ONLY = {"wiper_height_2": "12 mm"}
RISER = {"turned_share_1": 0.6}
COUNTS = {"drop_count_1": 129, "drop_count_2": 49, "drop_count_3": 22}
ROUNDING = 1e-13


def line(*outputs, **given):
    found = vibrafeed.sweep(scene="orienting-line", outputs=outputs, **given)
    values = [found[name].values for name in outputs]
    return values[0] if len(values) == 1 else values


def refused(**given):
    content = {"kind": "sweep", "scene": "orienting-line", "outputs": ["yield"]}
    variant = {"variant": given.pop("variant")} if "variant" in given else {}
    with pytest.raises(StudyError) as caught:
        prepare_content({**content, **variant, "parameters": given})
    return str(caught.value)


# --- worked values, of the problem's own statement


def test_a_filter_for_the_flat():
    eta, laps, variance, most = line(
        "yield", "laps", "laps_variance", "laps_99", **BOX, **FLAT_ONLY
    )
    assert eta == pytest.approx(0.6450216, abs=5e-8)
    assert laps == pytest.approx(1.5503358, abs=5e-8)
    assert variance == pytest.approx(0.8532052, abs=5e-8)
    assert most == pytest.approx(4.446, abs=5e-4)


def test_a_riser_before_it():
    eta, laps, rate, back, pure, wanted = line(
        "yield", "laps", "line_feed_rate", "return_rate", "purity", "oriented_feed_rate",
        **BOX, **RISER, **FLAT_ONLY, arrival_rate="300 1/min", wanted_aspect=1,
    )  # fmt: skip
    assert eta == pytest.approx(0.7906578795, abs=5e-11)
    assert laps == pytest.approx(1.2647695, abs=5e-8)
    assert rate == pytest.approx(237.197, abs=5e-4)
    assert rate + back == pytest.approx(300, rel=ROUNDING)
    assert pure == pytest.approx(1, abs=ROUNDING)
    assert wanted == pytest.approx(rate, rel=ROUNDING)
    by_pitch = line("line_feed_rate", **BOX, **RISER, **FLAT_ONLY, arrival_speed="100 mm/s",
                    part_pitch="20 mm")  # fmt: skip
    assert by_pitch == pytest.approx(rate, rel=ROUNDING)


def test_what_passes_at_both_ends_of_the_shares():
    names = ("yield", "laps", "line_feed_rate", "return_rate", "purity", "oriented_feed_rate")
    flat, thrown = 0.6450215619, 0.8586676690
    known = {
        12: (flat, thrown, 1.0, 1.0),
        # Those on their side pass, too.
        22: (0.8877487579, 0.9890649110, flat / 0.8877487579, thrown / 0.9890649110),
    }
    for wiper, (least, most, pure, purer) in known.items():
        low, high = (
            line(*(f"{name}_{end}" for name in names), **BOX, wiper_height_1=f"{wiper} mm",
                 arrival_rate=300, wanted_aspect=1)
            for end in ("lower", "upper")
        )  # fmt: skip
        expected = [least, 1 / most, 300 * least, 300 * (1 - most), pure, 300 * flat]
        assert low == pytest.approx(expected, rel=1e-8)
        expected = [most, 1 / least, 300 * most, 300 * (1 - least), purer, 300 * thrown]
        assert high == pytest.approx(expected, rel=1e-8)
        found = line(*names, **BOX, wiper_height_1=f"{wiper} mm", arrival_rate=300, wanted_aspect=1)
        assert np.all((np.array(low) <= found) & (np.array(found) <= high))


SMALL = {"length": "12 mm", "width": "8 mm", "height": "3 mm", "arrival_rate": "400 1/min",
         "wanted_aspect": 1, "turned_share_1": 0.6}  # fmt: skip


def test_oriented_parts_are_those_that_lie_as_wanted():
    heights = [f"{h} mm" for h in (2, 3, 7.9, 8, 11, 12, 13)]
    oriented, every, pure = line(
        "oriented_feed_rate", "line_feed_rate", "purity", **SMALL, wiper_height_2=heights
    )
    assert oriented[1:] == pytest.approx((every * pure)[1:], rel=ROUNDING)
    assert oriented[0] == every[0] == 0
    assert oriented[1:] == pytest.approx(335.438, abs=5e-4)
    assert every[-1] == 400
    with pytest.raises(StudyError, match="wanted_aspect: it is missing"):
        line("oriented_feed_rate", **BOX, wiper_height_1="12 mm", arrival_rate=300)


@pytest.mark.parametrize("method", [None, "scipy"])
@pytest.mark.parametrize(("end", "rate"), [("", 335.438), ("_lower", 335.438), ("_upper", 385.098)])
def test_the_recommended_wiper_sorts(end, rate, method):
    found = vibrafeed.optimise(
        scene="orienting-line",
        criterion={"kind": "maximise", "output": f"oriented_feed_rate{end}"},
        variables={"wiper_height_2": {"lower": "2 mm", "upper": "13 mm"}}, **SMALL,
        **({"method": method} if method else {}),
    )  # fmt: skip
    assert 3e-3 <= float(found.best_wiper_height_2) < 8e-3
    assert float(found.objective) == pytest.approx(rate, abs=5e-4)
    assert float(found[f"purity{end}"]) == 1


def test_a_line_that_lets_nothing_pass_is_an_answer():
    found = vibrafeed.sweep(
        scene="orienting-line", outputs=["oriented_feed_rate", "return_rate", "laps"], **SMALL,
        wiper_height_2=["2 mm", "5 mm"],
        reduce={"over": ["wiper_height_2"], "statistics": ["min", "max"]},
    )  # fmt: skip
    assert REGIMES["no_pass"].valid
    assert float(found.oriented_feed_rate_min) == 0
    assert float(found.return_rate_max) == 400
    assert float(found.laps_max) == np.inf
    assert float(found.return_rate_count) == 2


def test_nothing_returns_where_all_pass():
    random = np.random.default_rng(3)
    shapes = {
        "box": ("length", "width", "height"), "cylinder": ("length", "diameter"),
        "truncated_cone": ("diameter", "small_diameter", "height"),
    }  # fmt: skip
    outputs = ("return_rate", "return_rate_lower", "return_rate_upper", "laps_variance", "yield")
    for shape, names in shapes.items():
        for _ in range(20):
            sizes = {
                name: float(size)
                for name, size in zip(names, random.uniform(0.01, 0.03, 3), strict=False)
            }
            share, counts = float(random.uniform()), random.integers(0, 200, 3).astype(float)
            for tested in (False, True):
                given = {f"drop_count_{k}": n for k, n in enumerate(counts, 1)} if tested else {}
                if shape == "cylinder":
                    given.pop("drop_count_3", None)
                *nothing, eta = line(
                    *outputs, variant=shape, **sizes, **given, arrival_rate=300,
                    turned_share_1=share, wiper_height_2="100 mm",
                )  # fmt: skip
                assert [float(one) for one in nothing] == [0, 0, 0, 0]
                assert 1 - 1e-15 < eta <= 1


# --- each device


def test_each_test_alone():
    shares = line(*(f"let_down_share_{name}" for name in ("flat", "on_side", "on_end")), **BOX)
    for device, kept in (
        ({"wiper_height_1": "20 mm"}, (0, 1)),
        ({"wiper_height_1": "9.9 mm"}, ()),
        ({"gap_length_3": "12 mm"}, (0, 1)),  # 30 mm long, 30 mm long, 20 mm long
        ({"ledge_width_1": "6 mm"}, (1, 2)),  # 20 mm, 10 mm, 10 mm across
        ({"ledge_width_1": "4.9 mm", "delta": "1 deg"}, (1, 2)),  # centres 10, 15 mm high
    ):
        eta = line("yield", **BOX, **device)
        assert eta == pytest.approx(sum(shares[k] for k in kept), abs=ROUNDING)
    none = vibrafeed.sweep(
        scene="orienting-line", outputs=["laps", "yield"], wiper_height_1=["9 mm", "12 mm"], **BOX
    )
    assert none.regime.values.tolist() == [REGIMES[name].value for name in ("no_pass", "passes")]
    assert none.laps.values[0] == np.inf


def test_a_headed_pin_hangs_between_rails():
    pin = {"variant": "turned", "diameter": "8 mm", "small_diameter": "4 mm", "height": "20 mm",
           "centre_of_mass": "8 mm", "shank_diameter": "4 mm"}  # fmt: skip
    outputs = ("yield", "leaving_share_inverted", "let_down_share_upright")
    eta, hanging, upright = line(*outputs, **pin, rail_width_1=["3 mm", "5 mm", "9 mm"])
    assert eta == pytest.approx([0, 1 - upright, 0], abs=ROUNDING)
    assert hanging == pytest.approx(eta, abs=ROUNDING)
    assert "rail_width_1 is not used" in refused(**BOX, rail_width_1="5 mm")


def test_a_wiper_that_lays_down_what_it_stops():
    falls, laid = (
        line("yield", **BOX, wiper_height_1="12 mm", **more) for more in ({}, {"turned_share_1": 1})
    )
    side = line("let_down_share_on_side", **BOX)
    assert laid - falls == pytest.approx(side, abs=ROUNDING)


def test_an_outlet_takes_what_it_can():
    rate = line("line_feed_rate", **BOX, arrival_rate=[100, 300], wiper_height_1="12 mm",
                outlet_capacity_2="120 1/min")  # fmt: skip
    assert rate == pytest.approx([64.50215618741105, 120], rel=ROUNDING)


# --- orders


@pytest.mark.parametrize("devices", range(1, 7))
def test_orders_are_those_of_a_dictionary(devices):
    every = np.array([*itertools.permutations(range(devices))])
    found = orienting.devices_in_order(np.arange(1.0, len(every) + 1), devices)
    assert np.array_equal(np.stack(found, axis=1), every)


def test_tests_commute_and_a_riser_does_not():
    tests = {"wiper_height_1": "22 mm", "gap_length_2": "12 mm", "ledge_width_4": "6 mm"}
    every = {"start": 1, "stop": 6, "step": 1}
    assert np.ptp(line("yield", **BOX, **tests, device_order=every)) < ROUNDING
    both = line("yield", **BOX, **RISER, **FLAT_ONLY, device_order=[1, 2])
    assert both == pytest.approx([0.7906578795, 0.6450215619], abs=5e-11)


def test_orders_are_the_line_written_in_that_order():
    sizes = {"wiper_height": "22 mm", "turned_share": 0.5, "gap_length": "12 mm"}
    turns = {"turn": 31}
    for order, places in enumerate(itertools.permutations(sizes), 1):
        at = {name: place for place, name in enumerate(places, 1)}
        given = {f"{name}_{at[name]}": sizes[name] for name in sizes}
        by_hand = line("yield", **BOX, **given, **{f"turn_{at['turned_share']}": turns["turn"]})
        told = {f"{name}_{place}": sizes[name] for place, name in enumerate(sizes, 1)}
        found = line("yield", **BOX, **told, turn_2=31, device_order=order)
        assert found == pytest.approx(by_hand, abs=ROUNDING)


def test_all_orders_of_six_devices_in_one_study():
    devices = {"wiper_height_1": "12 mm", "turned_share_2": 0.5, "turned_share_3": 0.4,
               "turn_3": 32, "gap_length_4": "11 mm", "ledge_width_5": "11 mm",
               "outlet_capacity_6": 290}  # fmt: skip
    best = vibrafeed.sweep(
        scene="orienting-line", outputs=["line_feed_rate"], **BOX, **devices,
        arrival_rate=300, device_order={"start": 1, "stop": 720, "step": 1},
        reduce={"over": ["device_order"], "statistics": ["max", "argmax"]},
    )  # fmt: skip
    order = int(best.line_feed_rate_argmax_device_order)
    places = [*itertools.permutations(range(1, 7))][order - 1]
    assert places.index(3) < places.index(2) < places.index(1)  # 3 to 2, 2 to 1, then the wiper


def test_the_best_order_is_a_whole_number():
    found = vibrafeed.optimise(
        scene="orienting-line", criterion={"kind": "maximise", "output": "line_feed_rate"},
        outputs=["yield"], variables={"device_order": {"lower": 1, "upper": 6}},
        parameters={**BOX, **RISER, **FLAT_ONLY, "turned_share_3": 0.5, "turn_3": 32,
                    "arrival_rate": 300},
    )  # fmt: skip
    every = line("line_feed_rate", **BOX, **RISER, **FLAT_ONLY, turned_share_3=0.5, turn_3=32,
                 arrival_rate=300, device_order=[1, 2, 3, 4, 5, 6])  # fmt: skip
    assert float(found.best_device_order) == 1 + np.argmax(every)
    assert float(found.objective) == pytest.approx(every.max(), rel=ROUNDING)


# --- laws


def random_line(random):
    kinds = {"wiper_height": (0.005, 0.04), "ledge_width": (0.003, 0.02),
             "gap_length": (0.004, 0.02), "turned_share": (0, 1)}  # fmt: skip
    names = random.choice([*kinds], size=random.integers(1, 7))
    return {
        f"{name}_{place}": float(random.uniform(*kinds[name]))
        for place, name in enumerate(names, 1)
    }


def test_each_further_test_lets_fewer_pass():
    random = np.random.default_rng(8)
    for _ in range(count(6, 300)):
        given = {k: v for k, v in random_line(random).items() if not k.startswith("turned")}
        known = 1.0
        for last in range(len(given) + 1):
            some = dict([*given.items()][:last])
            eta = float(line("yield", **BOX, **some))
            assert 0 <= eta <= known + ROUNDING
            known = eta


def test_parts_that_go_round_one_by_one():
    random, parts = np.random.default_rng(9), count(20_000, 200_000)
    shares = [0.6450215619, 0.2427271960, 0.1122512421]
    for _ in range(4):
        share, turned = random.uniform(0.1, 0.9, 2)
        eta, laps, variance = line(
            "yield", "laps", "laps_variance", **BOX, turned_share_1=share, turn_1=32,
            turned_share_2=turned, wiper_height_3="12 mm",
        )  # fmt: skip
        needed, waiting = np.zeros(parts, int), np.arange(parts)
        while waiting.size:
            needed[waiting] += 1
            lies = random.choice(3, p=shares / np.sum(shares), size=waiting.size)
            lies[(lies == 2) & (random.random(waiting.size) < share)] = 1
            lies[(lies == 1) & (random.random(waiting.size) < turned)] = 0
            waiting = waiting[lies != 0]
        scatter = 5 * np.sqrt(variance / parts)
        assert needed.mean() == pytest.approx(laps, abs=scatter + 1e-9)
        # The variance of a geometric sample scatters by less than its kurtosis of 9 allows.
        assert needed.var() == pytest.approx(variance, abs=15 * variance / np.sqrt(parts) + 0.01)
        assert eta * laps == pytest.approx(1, rel=ROUNDING)


# --- drop tests


def test_an_interval_of_the_rate_by_two_hundred_counts():
    for devices in ({"wiper_height_1": "12 mm"}, {**RISER, **FLAT_ONLY}):
        names = ("yield", "yield_deviation", "yield_lower", "yield_upper", "passing_share_flat",
                 "passing_share_on_side", "passing_share_on_end")  # fmt: skip
        eta, deviation, lower, upper, *passing = line(*names, **BOX, **devices, **COUNTS)
        draws = np.random.default_rng(4).dirichlet(np.array([129, 49, 22]) + 0.5, 400_000) @ passing
        assert eta == pytest.approx(draws.mean(), abs=5 * draws.std() / 632)
        assert deviation == pytest.approx(draws.std(), rel=0.01)
        # Quantiles of 400 000 draws scatter by 0.01 deviations; the beta distribution of equal
        # moments is off by less where a riser makes the yield a sum of two shares.
        ends = np.quantile(draws, [0.025, 0.975])
        assert [lower, upper] == pytest.approx(ends, abs=0.05 * deviation)
        assert lower < eta < upper
    rates = ("line_feed_rate", "line_feed_rate_lower", "line_feed_rate_upper")
    rate, least, most = line(*rates, **BOX, **RISER, **FLAT_ONLY, **COUNTS, arrival_rate=300)
    assert [rate, least, most] == pytest.approx([300 * eta, 300 * lower, 300 * upper], rel=ROUNDING)


def test_an_interval_of_what_lies_as_wanted():
    devices = {**RISER, "wiper_height_2": "22 mm"}  # those on their side pass, too
    names = [f"{name}{end}" for name in ("oriented_feed_rate", "purity", "laps", "return_rate")
             for end in ("", "_lower", "_upper")]  # fmt: skip
    found = dict(zip(names, line(*names, **BOX, **devices, **COUNTS, arrival_rate=300,
                                 wanted_aspect=1), strict=True))  # fmt: skip
    p = np.random.default_rng(4).dirichlet(np.array([129, 49, 22]) + 0.5, 400_000)
    flat, eta = p[:, 0] + 0.6 * p[:, 1], p[:, 0] + p[:, 1]
    for name, draws in (("oriented_feed_rate", 300 * flat), ("purity", flat / eta),
                        ("laps", 1 / eta), ("return_rate", 300 * (1 - eta))):  # fmt: skip
        ends = np.quantile(draws, [0.025, 0.975])
        # A purity is taken to first order of the counts' scatter.
        assert [found[f"{name}_lower"], found[f"{name}_upper"]] == pytest.approx(
            ends, abs=0.05 * draws.std()
        )
        assert found[f"{name}_lower"] < found[name] < found[f"{name}_upper"]


def test_counts_replace_both_ends_of_the_shares():
    shares = np.array([0.7, 0.2, 0.1])
    counts = {f"drop_count_{k}": 1e12 * share for k, share in enumerate(shares, 1)}
    names = [f"counted_share_{name}" for name in ("flat", "on_side", "on_end")]
    ends = ["yield_lower", "yield_upper"]
    found = line(*names, *ends, **BOX, wiper_height_1="12 mm", **counts)
    assert found == pytest.approx([*shares, 0.7, 0.7], abs=1e-5)


def test_a_drop_test_in_a_study_of_ten_lines():
    study = """
        kind = "sweep"
        scene = "orienting-line"
        outputs = ["oriented_feed_rate", "oriented_feed_rate_lower", "oriented_feed_rate_upper"]
        [parameters]
        drop_count_1 = 129
        drop_count_2 = 49
        drop_count_3 = 22
        arrival_rate = "300 1/min"
        passed_aspect_1 = 1
        wanted_aspect = 1
    """
    found = vibrafeed.sweep(tomllib.loads(study))
    exact = stats.beta(129.5, 72.0)
    assert float(found.oriented_feed_rate) == pytest.approx(300 * exact.mean(), rel=ROUNDING)
    for name, share in (("lower", 0.025), ("upper", 0.975)):
        end = float(found[f"oriented_feed_rate_{name}"])
        assert end == pytest.approx(300 * exact.ppf(share), abs=0.02 * 300 * exact.std())


def test_time_in_the_bowl():
    time, laps = line("time_per_part", "laps", **BOX, **FLAT_ONLY, lap_time="40 s")
    assert time == pytest.approx(40 * laps, rel=ROUNDING)


def test_many_counts_know_the_shares():
    shares = np.array([0.645, 0.243, 0.112])
    counts = {f"drop_count_{k}": 1e8 * share for k, share in enumerate(shares, 1)}
    eta, deviation = line("yield", "yield_deviation", wiper_height_1="12 mm", **BOX, **counts)
    assert eta == pytest.approx(0.645, abs=1e-8)
    assert deviation == pytest.approx(np.sqrt(0.645 * 0.355 / 1e8), rel=1e-6)


# --- what a study may say


def test_what_is_wrong_is_said():
    assert "it names no two aspects" in refused(**BOX, turned_share_1=0.5, turn_1=22)
    assert "turned_share_2: it is missing" in refused(**BOX, turn_2=21)
    order = refused(**BOX, **RISER, **FLAT_ONLY, device_order=3)
    assert "2 devices stand in 2 orders. Give 1 to 2" in order
    assert "gap_width_1" in refused(**BOX, gap_width_1="3 mm")


def test_a_line_knows_its_own_devices_and_is_compiled():
    given = [
        *BOX,
        "wiper_height_1",
        "turned_share_4",
        "turn_4",
        "outlet_capacity_5",
        "arrival_rate",
    ]
    outputs = ["line_feed_rate", "laps_99", "passing_share_on_end"]
    plan = make_plan("orienting-line", None, outputs, given)
    assert {*plan.parameters} == {*given}
    assert not plan.defaults
    assert traced(plan, dict(zip(given, given, strict=True))) is not None
    assert traced(
        make_plan("orienting-line", None, outputs, [*given, "device_order"]),
        dict(zip(given, given, strict=True)),
    )


def test_the_ends_of_a_beta_distribution():
    a, b = np.meshgrid(np.geomspace(0.5, 1e5, 60), np.geomspace(0.5, 1e5, 60))
    mean, deviation = a / (a + b), np.sqrt(a * b / (a + b + 1)) / (a + b)
    for side, share in ((-1, 0.025), (1, 0.975)):
        found = orienting.quantile(mean, deviation, side)
        error = np.abs(found - scipy.special.betaincinv(a, b, share)) / deviation
        counted = (a >= 1) & (b >= 1) & (a + b > 5)  # of both that pass and that do not
        assert error[counted].max() < 0.022
        assert error.max() < 0.07
    assert orienting.quantile(np.array([0.0, 1.0]), np.zeros(2), 1).tolist() == [0, 1]
