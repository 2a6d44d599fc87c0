"""Speeds over a parameter that is known within a band: least, most, and a settled direction."""

from __future__ import annotations

import numpy as np
import pytest

import vibrafeed
from night import count
from vibrafeed.core.dataset.bands import rounded, sentences_on_bands
from vibrafeed.core.dataset.document import to_document
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content, study_of
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.materials import friction
from vibrafeed.core.plan.bands import MAX_POINTS, SAMPLES, extremes
from vibrafeed.core.plan.pieces import Cut, join
from vibrafeed.core.quantities.flags import SIGNS
from vibrafeed.core.watch import Watch

BAND = {"low": 0.2, "high": 0.5}
DRIVE = {"frequency": 50, "amplitude": "0.3 mm", "beta": 20, "gamma": 2}
SCENE = "rectangle-on-plane"
GRAVITY = 9.80665
SETTLED, UNSETTLED, OPEN = (SIGNS[name].value for name in ("settled", "unsettled", "open"))


def content(kind="simulate", **parameters):
    outputs = {"outputs": ["conveying_velocity"]} if kind in ("simulate", "sensitivity") else {}
    return {"kind": kind, "scene": SCENE, "parameters": DRIVE | parameters} | outputs


def simulate(outputs=("conveying_velocity",), **parameters):
    return vibrafeed.simulate(scene=SCENE, outputs=[*outputs], **DRIVE | parameters)


def problems_of(study):
    with pytest.raises(StudyError) as caught:
        prepare_content(study)
    return {problem.place: problem for problem in caught.value.problems}


# --- how it is written


def test_a_pair_is_the_range_of_the_table_and_the_middle_its_nominal_value():
    asked = {"pair": "Steel on steel", "surface": "dry"}
    band = study_of(content(friction=asked)).values()["friction"]
    rows = [row for row in friction("steel")["pairs"] if row["part"] == row["track"] == "steel"]
    ends = [end for row in rows if row["surface"] == "dry" for end in row["kinetic"]]
    assert (band.low, band.high) == (min(ends), max(ends)) == (0.08, 0.7)
    assert band.value == 0.39
    static = study_of(content(friction_static=asked, friction_kinetic=0.1)).values()
    assert static["friction_static"].canonical() == {"low": 0.12, "high": 0.8}


@pytest.mark.parametrize(
    ("name", "written", "told"),
    [
        ("friction", {"pair": "stel on steel"}, "steel on steel"),
        ("friction", {"pair": "steel on steel", "surface": "wet"}, "lubricated: oil"),
        ("friction", {"pair": "abs on steel"}, "0.3"),
        ("friction", {"low": 0.2}, "high = 0.4"),
        ("friction", {"low": 0.4, "high": 0.2}, "Swap"),
        ("friction", {"low": -0.4, "high": 0.2}, "0"),
        ("friction", {"low": 0.1, "pair": "steel on steel"}, "surface"),
        ("beta", {"pair": "steel on steel"}, "low and high"),
    ],
)
def test_what_is_wrong_with_a_band_is_told_with_the_way_out(name, written, told):
    for kind in ("simulate", "optimise"):
        with pytest.raises(StudyError) as caught:
            study_of(content(kind, **{"friction": 0.3, name: written}))
        (problem,) = (one for one in caught.value.problems if one.place == f"parameters.{name}")
        assert told in f"{problem.message} {problem.fix}"


@pytest.mark.parametrize(
    ("kind", "more", "section"),
    [
        ("optimise", {"criterion": {"kind": "maximise"}}, "uncertain"),
        ("sensitivity", {}, "uncertain"),
        ("calibrate", {"observations": [{"conveying_velocity": 0.02}]}, "unknowns"),
    ],
)
def test_other_kinds_read_a_band_as_bounds(kind, more, section):
    band = study_of(content(kind, friction=BAND) | more)
    bounds = {section: {"friction": {"lower": 0.2, "upper": 0.5}}}
    assert band == study_of(content(kind) | more | bounds)


# --- extremes


def counted(function):
    calls = np.zeros(1, dtype=int)

    def compute(at, cell):
        calls[:] += at.size
        return np.stack([function(at), 2 * function(at)])

    return compute, calls


@pytest.mark.parametrize(
    ("function", "least", "most"),
    [
        (lambda x: (x - 0.31) ** 2, 0.0, 0.69**2),
        (lambda x: -abs(x - 0.43), -0.57, 0.0),
        (lambda x: np.sin(9 * x), -1.0, 1.0),
    ],
)
def test_extremes_lie_within_the_range_too(function, least, most):
    compute, calls = counted(function)
    found = extremes(compute, 0.0, 1.0, 1)
    assert found.least[:, 0] == pytest.approx([least, 2 * least], abs=2e-3)
    assert found.most[:, 0] == pytest.approx([most, 2 * most], abs=2e-3)
    assert calls[0] <= MAX_POINTS <= 40
    assert not found.is_open.any()


def test_what_is_monotone_costs_no_search_and_what_has_no_value_is_open():
    compute, calls = counted(lambda x: np.where(x < 0.5, np.nan, x))
    found = extremes(compute, 0.0, 0.4, 3)
    assert np.isnan(found.least).all()
    assert found.is_open.all()
    compute, calls = counted(lambda x: x**3)
    found = extremes(compute, -1.0, 1.0, 3)
    assert calls[0] == 3 * SAMPLES
    assert found.least[0].tolist() == [-1.0] * 3
    compute, calls = counted(lambda x: np.where(x < 0.5, np.nan, x))
    found = extremes(compute, 0.0, 1.0, 1)
    assert found.most[0, 0] == 1.0
    assert found.least[0, 0] == pytest.approx(0.5, abs=1e-2)


def test_bands_of_random_drives_hold_a_fine_scan():
    number, values = count(200, 2000), np.linspace(0.08, 0.6, 200)
    random = np.random.default_rng(60)
    throws, angles = random.uniform(0.3, 3.0, number), random.uniform(5, 60, number)
    drives = [
        {
            "amplitude": throw * GRAVITY / ((100 * np.pi) ** 2 * np.sin(np.deg2rad(beta))),
            "beta": beta, "gamma": gamma,
        }
        for throw, beta, gamma in zip(throws, angles, random.uniform(0, 4, number), strict=True)
    ]  # fmt: skip
    asked = {"scene": SCENE, "frequency": 50, "designs": drives}
    scan = vibrafeed.simulate(**asked, friction=values).conveying_velocity
    found = vibrafeed.simulate(**asked, friction={"low": 0.08, "high": 0.6})
    assert np.isfinite(scan).all()
    low, high = scan.min("friction"), scan.max("friction")
    least, most = found.conveying_velocity_least, found.conveying_velocity_most
    width = high - low
    assert float(((least - low) / width).max()) < 1e-3
    assert float(((high - most) / width).max()) < 1e-3
    np.testing.assert_allclose(most - least, width, rtol=0.02)
    np.testing.assert_array_equal(found.sign_unsettled == UNSETTLED, (least < 0) & (most > 0))


def test_the_table_does_not_settle_the_sign_of_model_3():
    amplitudes = ["0.1 mm", "0.2 mm", "0.3 mm", "0.45 mm"]
    found = simulate(amplitude=amplitudes, friction={"low": 0.08, "high": 0.6})
    least, most = (1e3 * found[f"conveying_velocity_{end}"].values for end in ("least", "most"))
    assert least.round().tolist() == [-17, -34, -52, -34]
    assert most == pytest.approx([4.8, 20, 33, 55], abs=0.5)
    assert (found.sign_unsettled == UNSETTLED).all()
    middle = simulate(amplitude=amplitudes, friction=0.34)
    np.testing.assert_array_equal(found.conveying_velocity, middle.conveying_velocity)


def test_a_part_rests_from_the_anchor_of_friction_on_and_with_its_probability():
    beta = np.deg2rad(20)
    threshold = 0.3 * np.cos(beta) / (1 - 0.3 * np.sin(beta))
    assert threshold == pytest.approx(0.3141404999, abs=5e-11)
    assert (0.5 - threshold) / (0.5 - 0.08) == pytest.approx(0.4425226193, abs=5e-11)
    drive = {"amplitude": 0.3 * GRAVITY / (100 * np.pi) ** 2, "gamma": 0}
    near = simulate(["stick_fraction"], **drive, friction=[threshold - 1e-11, threshold + 1e-11])
    assert near.stick_fraction.values[0] < 1
    assert near.stick_fraction.values[1] == 1
    band = simulate(**drive, friction={"low": 0.08, "high": threshold + 1e-11})
    assert float(band.conveying_velocity_least) == 0
    rests = vibrafeed.sensitivity(
        scene=SCENE, **DRIVE | drive, friction={"low": 0.08, "high": 0.5},
        outputs=["conveying_velocity"], demands=[{"regime": "stick"}], samples=4096,
        analyses=["distribution"],
    )  # fmt: skip
    error = max(4 * float(rests.probability_stick_error), 2e-3)
    assert float(rests.probability_stick) == pytest.approx(0.4425226193, abs=error)


# --- what a result holds


def test_rates_and_axes_go_with_the_speed():
    found = simulate(
        ["conveying_velocity", "feed_rate", "hop_height"],
        friction=BAND, length=["10 mm", "20 mm"], amplitude=["0.2 mm", "0.3 mm", "0.4 mm"],
    )  # fmt: skip
    assert found.conveying_velocity_least.dims == ("amplitude",)
    assert found.feed_rate_most.dims == found.feed_rate.dims
    assert "hop_height_least" not in found
    for end in ("least", "most"):
        speed = found[f"conveying_velocity_{end}"]
        np.testing.assert_allclose(
            found[f"feed_rate_{end}"],
            (60 * speed / found.length).T.transpose(*found.feed_rate.dims),
        )
        assert speed.attrs["ancillary_variables"] == found.conveying_velocity.ancillary_variables
    assert found.friction.attrs["band"].tolist() == [0.2, 0.5]
    assert found.sign_unsettled.dtype == np.int8
    told = sentences_on_bands(Table.of_xarray(found))
    assert [line[:22] for line in told] == ["For friction 0.2 to 0.", "The feed rate is an up"]


def test_where_parts_run_down_the_band_is_open():
    found = simulate(gamma=10, friction={"low": 0.1, "high": 0.5})
    assert float(found.sign_unsettled) in (OPEN, UNSETTLED)
    steep = simulate(gamma=10, amplitude="1 mm", beta=45, friction={"low": 0.1, "high": 0.5})
    assert float(steep.sign_unsettled) == OPEN


def test_closed_forms_have_bands_each_of_its_own():
    asked = {"frequency": 50, "amplitude": "0.1 mm", "beta": 10, "alpha": 20, "delta": 30}
    study = {
        "scene": "rectangle-on-track", "outputs": ["velocity_at_time"], "time": "5 ms",
        "radius": 0.2,
    }  # fmt: skip
    values = np.linspace(0.1, 0.3, 200)
    scan = vibrafeed.sweep(**study, **asked, friction=values).velocity_at_time
    found = vibrafeed.sweep(**study, **asked, friction={"low": 0.1, "high": 0.3})
    assert float(found.velocity_at_time_least) == pytest.approx(float(scan.min()), rel=1e-4)
    assert float(found.velocity_at_time_most) == pytest.approx(float(scan.max()), rel=1e-4)


def test_pieces_of_a_study_join_to_the_whole_and_go_to_the_service():
    axis = {"start": 1e-4, "stop": 3e-4, "num": 7}
    prepared = prepare_content(content(friction=BAND, amplitude=axis, beta=[10, 20, 30]))
    kind, cut = KINDS["simulate"], Cut(prepared, 6)
    assert len(cut) > 1
    boxes = [cut.box(number) for number in range(len(cut))]
    pieces = [(box, kind.compute(prepared.within(box), Watch())) for box in boxes]
    joined, whole = join(prepared, pieces), kind.compute(prepared, Watch())
    for name, values in whole.arrays.items():
        np.testing.assert_array_equal(joined.arrays[name], values, err_msg=name)
    variables = to_document(kind.label(prepared, whole, Watch()))["variables"]
    assert variables["conveying_velocity_least"]["dims"] == ["amplitude", "beta"]
    assert variables["sign_unsettled"]["flags"] == {"settled": 0, "unsettled": 1, "open": 2}


def test_studies_without_a_band_add_nothing():
    assert prepare_content(content(friction=0.3)).added == ()
    priced = [prepare_content(content(friction=one)).added for one in (0.3, BAND)]
    assert [sum(added.passes for added in one) for one in priced] == [0, MAX_POINTS]


def test_what_cannot_have_a_band_is_refused():
    both = content(friction=BAND, gamma={"low": 0, "high": 2})
    assert set(problems_of(both)) <= {"parameters.friction", "parameters.gamma"}
    silent = content(friction=BAND) | {"outputs": ["stick_fraction"]}
    assert "conveying_velocity" in problems_of(silent)["parameters.friction"].fix
    reduced = content(friction=BAND, amplitude={"start": 1e-4, "stop": 2e-4, "num": 3})
    reduced["reduce"] = {"over": ["amplitude"], "statistics": ["max"]}
    assert "axis" in problems_of(reduced)["parameters.friction"].fix
    assert prepare_content(content(friction=BAND)).not_lazy.place == "parameters.friction"


@pytest.mark.parametrize(
    ("value", "width", "text"),
    [(81.234, 20, "81"), (-0.4, 20, "0"), (1234.5, 300, "1230"), (0.01234, 0.0033, "0.0123"),
     (5.0, 0.0, "5.000"), (np.nan, 1.0, "-")],
)  # fmt: skip
def test_a_number_has_the_digits_that_its_band_leaves(value, width, text):
    assert rounded(value, width) == text
