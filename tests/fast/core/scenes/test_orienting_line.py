"""Lines of devices: worked values, parts that go round one by one, laws, drop tests."""

import itertools

import numpy as np
import pytest
import scipy

import vibrafeed
from night import count
from refusals import words_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.mechanics import orienting
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


# --- worked values, of the problem's own statement


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
    assert oriented == pytest.approx([0, *[335.438] * 6], abs=5e-4)
    assert (every[0], every[-1]) == (0, 400)
    with pytest.raises(StudyError, match="wanted_aspect: it is missing"):
        line("oriented_feed_rate", **BOX, wiper_height_1="12 mm", arrival_rate=300)


@pytest.mark.parametrize(("end", "rate"), [("", 335.438), ("_upper", 385.098)])
def test_the_recommended_wiper_sorts(end, rate):
    found = vibrafeed.optimise(
        scene="orienting-line",
        criterion={"kind": "maximise", "output": f"oriented_feed_rate{end}"},
        variables={"wiper_height_2": {"lower": "2 mm", "upper": "13 mm"}}, **SMALL,
    )  # fmt: skip
    assert 3e-3 <= float(found.best_wiper_height_2) < 8e-3
    assert float(found.objective) == pytest.approx(rate, abs=5e-4)
    assert float(found[f"purity{end}"]) == 1


def test_a_line_that_lets_nothing_pass_is_an_answer():
    outputs = ["oriented_feed_rate", "return_rate", "laps"]
    found = vibrafeed.sweep(
        scene="orienting-line", outputs=outputs, **SMALL, wiper_height_2=["2 mm", "5 mm"],
        reduce={"over": ["wiper_height_2"], "statistics": ["min", "max"]},
    )  # fmt: skip
    told = ("oriented_feed_rate_min", "return_rate_max", "laps_max", "return_rate_count")
    assert [float(found[name]) for name in told] == [0, 400, np.inf, 2]


@pytest.mark.parametrize("counts", [(), (129, 49)])
@pytest.mark.parametrize(
    ("shape", "names"),
    [("box", ("length", "width", "height")), ("cylinder", ("length", "diameter")),
     ("truncated_cone", ("diameter", "small_diameter", "height"))],
)  # fmt: skip
def test_nothing_returns_where_all_pass(shape, names, counts):
    tested = {f"drop_count_{k}": n for k, n in enumerate(counts, 1)}
    if tested and shape != "cylinder":
        tested["drop_count_3"] = 22
    outputs = ("return_rate", "return_rate_lower", "return_rate_upper", "laps_variance", "yield")
    random = np.random.default_rng(3)
    for sizes in random.uniform(0.01, 0.03, (5, 3)):
        given = dict(zip(names, sizes.tolist(), strict=False))
        found = line(*outputs, variant=shape, **given, **tested, arrival_rate=300,
                     turned_share_1=random.uniform(), wiper_height_2="100 mm")  # fmt: skip
        assert [float(one) for one in found[:4]] == [0, 0, 0, 0]
        assert 1 - 1e-15 < found[4] <= 1


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
    np.testing.assert_allclose([eta, hanging], [[0, 1 - upright, 0]] * 2, atol=ROUNDING)


def test_a_riser_does_not_commute_with_a_test():
    both = line("yield", **BOX, **RISER, **FLAT_ONLY, device_order=[1, 2])
    assert both == pytest.approx([0.7906578795, 0.6450215619], abs=5e-11)


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


def test_orders_are_the_line_written_in_that_order():
    sizes = {"wiper_height": "22 mm", "turned_share": 0.5, "gap_length": "12 mm"}
    told = {f"{name}_{place}": size for place, (name, size) in enumerate(sizes.items(), 1)}
    for order, names in enumerate(itertools.permutations(sizes), 1):
        given = {f"{name}_{place}": sizes[name] for place, name in enumerate(names, 1)}
        turn = {f"turn_{names.index('turned_share') + 1}": 31}
        found = line("yield", **BOX, **told, turn_2=31, device_order=order)
        assert found == pytest.approx(line("yield", **BOX, **given, **turn), abs=ROUNDING)


# --- laws


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


# --- what a study may say


def test_what_is_wrong_is_said():
    for given, words in (
        ({"turned_share_1": 0.5, "turn_1": 22}, "it names no two aspects"),
        ({"turn_2": 21}, "turned_share_2: it is missing"),
        ({**RISER, **FLAT_ONLY, "device_order": 3}, "2 devices stand in 2 orders. Give 1 to 2"),
        ({"gap_width_1": "3 mm"}, "gap_width_1"),
        ({"rail_width_1": "5 mm"}, "rail_width_1 is not used"),
    ):
        content = {"kind": "sweep", "scene": "orienting-line", "outputs": ["yield"]}
        assert words in words_of(prepare_content, {**content, "parameters": {**BOX, **given}})


def test_the_ends_of_a_beta_distribution():
    a, b = np.meshgrid(np.geomspace(0.5, 1e5, 60), np.geomspace(0.5, 1e5, 60))
    mean, deviation = a / (a + b), np.sqrt(a * b / (a + b + 1)) / (a + b)
    counted = (a >= 1) & (b >= 1) & (a + b > 5)  # of both that pass and that do not
    for side, share in ((-1, 0.025), (1, 0.975)):
        found = orienting.quantile(mean, deviation, side)
        error = np.abs(found - scipy.special.betaincinv(a, b, share)) / deviation
        assert error[counted].max() < 0.022
        assert error.max() < 0.07
    assert orienting.quantile(np.array([0.0, 1.0]), np.zeros(2), 1).tolist() == [0, 1]


def test_a_filter_for_the_flat_and_a_riser_before_it():
    eta, laps, variance, most, time = line(
        "yield", "laps", "laps_variance", "laps_99", "time_per_part", **BOX, **FLAT_ONLY,
        lap_time="40 s",
    )  # fmt: skip
    known = [0.6450216, 1.5503358, 0.8532052, 40 * 1.5503358]
    assert [eta, laps, variance, time] == pytest.approx(known, rel=1e-7)
    assert most == pytest.approx(4.446, abs=5e-4)
    eta, laps, rate, *others = line(
        "yield", "laps", "line_feed_rate", "return_rate", "purity", "oriented_feed_rate",
        **BOX, **RISER, **FLAT_ONLY, arrival_rate="300 1/min", wanted_aspect=1,
    )  # fmt: skip
    assert [eta, laps] == pytest.approx([0.7906578795, 1.2647695], abs=5e-8)
    by_pitch = line("line_feed_rate", **BOX, **RISER, **FLAT_ONLY, arrival_speed="100 mm/s",
                    part_pitch="20 mm")  # fmt: skip
    expected = np.array([300 * (1 - eta), 1, 300 * eta, 300 * eta, 300 * eta])
    assert [*others, rate, by_pitch] == pytest.approx(expected, rel=ROUNDING)


def test_intervals_by_two_hundred_counts():
    names = ("yield", "oriented_feed_rate", "purity", "laps", "return_rate", "line_feed_rate")
    asked = ["yield_deviation", *(f"{name}{end}" for name in names
                                  for end in ("", "_lower", "_upper"))]  # fmt: skip
    devices = {**RISER, "wiper_height_2": "22 mm"}  # those on their side pass, too
    told = line(*asked, **BOX, **devices, **COUNTS, arrival_rate=300, wanted_aspect=1)
    found = dict(zip(asked, told, strict=True))
    p = np.random.default_rng(4).dirichlet(np.array([129, 49, 22]) + 0.5, 400_000)
    flat, eta = p[:, 0] + 0.6 * p[:, 1], p[:, 0] + p[:, 1]
    assert found["yield_deviation"] == pytest.approx(eta.std(), rel=0.01)
    drawn = (eta, 300 * flat, flat / eta, 1 / eta, 300 * (1 - eta), 300 * eta)
    for name, draws in zip(names, drawn, strict=True):
        middle, *ends = (found[f"{name}{end}"] for end in ("", "_lower", "_upper"))
        # A purity is taken to first order of the counts' scatter; quantiles of 400 000 draws
        # scatter by 0.01 deviations, and the beta distribution of equal moments is off by less.
        right = np.quantile(draws, [0.025, 0.975])
        assert ends == pytest.approx(right, abs=0.05 * draws.std()), name
        assert ends[0] < middle < ends[1]
