"""Studies of uncertain parameters: closed cases, laws, indices, and what a study may say."""

import json

import numpy as np
import pytest
import xarray
from scipy import stats
from scipy.stats import sobol_indices as of_scipy

import vibrafeed
from benchmarks.sobol_indices import FUNCTIONS, sobol_indices
from refusals import told_of
from vibrafeed.core.errors import StoppedError, StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import KINDS, tabulate
from vibrafeed.core.plan.pieces import Cut, join
from vibrafeed.core.report import check
from vibrafeed.core.sensitivity.budget import Budget
from vibrafeed.core.sensitivity.indices import design, indices_of
from vibrafeed.core.study.distributions import read_distribution
from vibrafeed.core.watch import Watch

PLANE = {
    "scene": "rectangle-on-plane",
    "outputs": ["acceleration_x"],
    "samples": 256,
    "uncertain": {"friction": {"mean": 0.3, "deviation": 0.02}},
    "parameters": {"frequency": 50, "amplitude": "0.1 mm", "beta": 20},
}
A_S, A_M, G = 0.4 * 9.81, 2 * 9.81, 9.81
LEVEL_WAVE = {
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity"],
    "samples": 1024,
    "uncertain": {"friction_kinetic": {"mean": 0.3, "deviation": 0.03}},
    "parameters": {
        "frequency": 50, "gravity": G, "friction_static": 0.5,
        "acceleration_along_1": A_S, "acceleration_along_2": -A_M, "acceleration_along_3": A_S,
        "duration_1": A_M, "duration_2": 2 * A_S, "duration_3": A_M,
    },
}  # fmt: skip


def speed_of_level_wave(friction):
    """Formula Q: sticks while the track creeps forwards, slips as it darts back (D. Quaid 1999)."""
    a_k = friction * G
    return A_S**2 * (A_M - a_k) / ((A_S + A_M) * (A_S + a_k)) / 50 / 2


def sensitive(content=PLANE, /, **change):
    return vibrafeed.sensitivity({**content, **change})


# --- closed cases


def test_the_probability_of_a_closed_form_is_that_of_its_normal_friction():
    normal, at = stats.norm(0.3, 0.02), [0.28, 0.31]
    frictions = sorted([*at, *normal.ppf([0.05, 0.5, 0.95])])  # the two are second and fourth
    every = vibrafeed.sweep(
        scene=PLANE["scene"], outputs="acceleration_x", friction=frictions, **PLANE["parameters"]
    ).acceleration_x.values
    known, of_quantiles = every[1::2], every[::-2]
    for friction, level in zip(at, known, strict=True):
        # More friction, less acceleration: as likely as that the friction is below.
        demand = {"output": "acceleration_x", "at_least": float(level)}
        found = sensitive(demands=[demand], samples=4096)
        error = float(found.probability_acceleration_x_at_least_error)
        probability = float(found.probability_acceleration_x_at_least)
        assert probability == pytest.approx(normal.cdf(friction), abs=1.5 * error)
        assert error < 0.005
    away = np.abs(found.acceleration_x_quantile.values - of_quantiles)
    assert away.max() <= 2e-3
    assert (away <= 2 * found.acceleration_x_quantile_error.values).all()
    # It is linear in friction: one parameter, all of the variance, and a budget without error.
    slope = (known[1] - known[0]) / 0.03
    assert found.acceleration_x_linear.values == pytest.approx([slope * 0.06], rel=1e-4)
    assert float(found.acceleration_x_deviation) == pytest.approx(abs(slope) * 0.02, rel=2e-3)
    assert found.acceleration_x_first.values == pytest.approx([1], abs=0.01)
    assert found.acceleration_x_variance_share.values == pytest.approx([1])


def test_the_probability_of_a_motion_is_that_of_formula_q():
    demand = {"output": "conveying_velocity", "at_least": speed_of_level_wave(0.32)}
    found = sensitive(LEVEL_WAVE, demands=[demand], analyses=["distribution", "budget"])
    assert float(found.conveying_velocity_nominal) == pytest.approx(0.015882857, abs=5e-10)
    error = float(found.probability_conveying_velocity_at_least_error)
    probability = float(found.probability_conveying_velocity_at_least)
    assert probability == pytest.approx(stats.norm(0.3, 0.03).cdf(0.32), abs=2 * error)
    a_k = 0.3 * G
    slope = -(1 / (A_M - a_k) + 1 / (A_S + a_k)) * G * speed_of_level_wave(0.3)
    names = [f"conveying_velocity_{word}" for word in ("linear", "least", "largest")]
    known = [slope * 0.09, speed_of_level_wave(0.39), speed_of_level_wave(0.21)]
    assert [float(found[name].squeeze()) for name in names] == pytest.approx(known, rel=1e-4)


# --- laws


def test_equal_seeds_give_equal_bits_and_others_others():
    one, same, other, less = (
        sensitive(**more) for more in ({}, {}, {"seed": 1}, {"analyses": ["distribution"]})
    )
    assert one.identical(same.assign_attrs(one.attrs))
    assert float(one.acceleration_x_mean) != float(other.acceleration_x_mean)
    assert float(less.acceleration_x_mean) == float(one.acceleration_x_mean)


def test_designs_are_told_alike_alone_together_and_in_pieces():
    def asked(gamma):
        drive = {"frequency": 50, "amplitude": "0.1 mm", "gamma": gamma}
        return prepare_content({
            **PLANE, "kind": "sensitivity", "analyses": ["distribution", "sobol", "budget"],
            "uncertain": {**PLANE["uncertain"], "beta": {"lower": 19, "upper": 21}},
            "demands": [{"output": "acceleration_x", "at_most": 1.5}], "parameters": drive,
        })  # fmt: skip

    prepared = asked([0, 1, 3])
    assert prepared.seconds > 0
    whole = tabulate(prepared).to_xarray()
    alone = tabulate(asked(1))
    for name, variable in alone.variables.items():
        part = whole[name].isel(gamma=1).values
        assert part == pytest.approx(variable.values, rel=1e-12, nan_ok=True), name
    pieces, kind = Cut(prepared, 1), KINDS["sensitivity"]
    boxes = [pieces.box(k) for k in range(len(pieces))]
    assert len(boxes) == 3
    parts = ((box, kind.compute(prepared.within(box), Watch())) for box in boxes)
    joined = kind.label(prepared, join(prepared, parts), Watch()).to_xarray()
    assert whole.identical(joined.assign_attrs(whole.attrs))


# --- what is left out, and what stops


def test_points_without_a_sound_value_are_counted():
    # Lift-off at 0.1 * (2 pi f)^2 sin(beta) = g: near that amplitude half of the points fly.
    edge = 9.80665 / ((2 * np.pi * 50) ** 2 * np.sin(np.deg2rad(20)))
    amplitude = {"amplitude": {"lower": 0.9 * edge, "upper": 1.1 * edge}}
    fixed = {"frequency": 50, "beta": 20, "friction": 0.3}
    found = sensitive(
        parameters=fixed, uncertain=amplitude,
        demands=[{"output": "acceleration_x", "at_least": -1e9}, {"regime": "flight"}],
    )  # fmt: skip
    left = float(found.acceleration_x_left_out)
    assert left == pytest.approx(0.5, abs=0.01)
    assert float(found.probability_flight) == left
    assert float(found.probability_acceleration_x_at_least) == 1 - left
    # Of an output that needs no floor nothing is left out.
    drive = {"frequency": 50, "beta": 20}
    throw = sensitive(parameters=drive, outputs=["throw_number"], uncertain=amplitude)
    assert float(throw.throw_number_left_out) == 0
    beyond = sensitive(parameters={**fixed, "beta": 60, "frequency": 200}, uncertain=amplitude)
    assert float(beyond.acceleration_x_left_out) == 1
    assert np.isnan([beyond.acceleration_x_mean, *beyond.acceleration_x_first]).all()


def test_a_stop_leaves_no_half_answer_and_progress_reaches_the_whole():
    prepared, told = prepare_content({"kind": "sensitivity", **LEVEL_WAVE}), []
    tabulate(prepared, Watch(told.append))
    assert sum(told) == pytest.approx(1, abs=1e-6)
    with pytest.raises(StoppedError):
        tabulate(prepared, Watch(stop=lambda: True))
    with pytest.raises(
        StudyError, match="a report cannot be made of a study of kind 'sensitivity'"
    ):
        check(prepared)


HUGE = {"start": 0, "stop": 1, "num": 100_000}


def test_a_budget_says_where_the_output_bends_at_once():
    budget = Budget({"friction": read_distribution("friction", {"lower": 0.2, "upper": 0.4})})
    (friction,) = budget.values().values()
    told = budget.budget_of(np.stack([
        3 * friction, np.abs(friction - 0.3), (friction - 0.3) ** 2, friction > 0.3,
        5 + 0 * friction,
    ]))  # fmt: skip
    assert told.linear[0] == pytest.approx([0.3, np.nan, 0, np.nan, 0], abs=1e-9, nan_ok=True)
    assert told.least == pytest.approx([0.6, 0, 0, 0, 5], abs=1e-9)
    assert told.at_upper[0] == pytest.approx([1.2, 0.1, 0.01, 1, 5])


# --- what a study may say


@pytest.mark.parametrize(
    ("change", "problems"),
    [
        ({"uncertain": {"friction": {"mean": 0.3, "devation": 1}, "beta": {"lower": 3}},
          "samples": 300, "quantiles": [0.5, 1.5], "analyses": ["sobol", "other"],
          "outputs": ["aceleration_x"]},
         {"uncertain.friction": "deviation", "uncertain.beta": "distribution",
          "samples": "power of two", "quantiles": "between 0 and 1", "outputs": "Did you mean",
          "analyses": ""}),
        ({"analyses": ["morris", "sobol"]}, {"analyses": "Write sobol"}),
        ({"uncertain": {"friction": {"lower": 0.2, "upper": 0.3},
                        "beta": {"mean": 20, "deviation": 1}},
          "demands": [{"output": "acceleration_x", "at_least": 2, "at_most": 1}, {},
                      {"output": "throw_number"}, {"regime": "hopping"}, {"regime": "hoping"},
                      {"output": "motion_status", "at_most": 1},
                      {"regime": "slip", "at_most": 1}],
          "verify": 3},
         {"uncertain.beta": "parameters", "demands.0": "Swap", "demands.1": "either",
          "demands.2": "at_least", "demands.5.output": "names, not numbers",
          "demands.6": "has no bounds", "verify": ""}),
        ({"demands": [{"regime": "hopping"}, {"regime": "hoping"}]},
         {"demands.0.regime": "flight", "demands.1.regime": "hopping"}),
        ({"uncertain": {}}, {"uncertain": "no parameter is uncertain"}),
        ({"samples": 1 << 20, "parameters": {**PLANE["parameters"], "gamma": HUGE}},
         {"samples": "at most 2"}),
    ],
)  # fmt: skip
def test_every_error_is_told_with_its_place(change, problems):
    told = told_of(prepare_content, {"kind": "sensitivity", **PLANE, **change})
    for place, words in problems.items():
        assert any(one.startswith(place) and words in told[one] for one in told), (place, told)


def test_a_calibration_gives_its_density_to_who_has_the_file(tmp_path):
    friction = np.linspace(0.2, 0.4, 41)
    density = stats.norm(0.3, 0.02).pdf(friction) * (abs(friction - 0.3) < 0.07)
    path, study = tmp_path / "told.nc", tmp_path / "study.json"
    result = {"density_friction": ("friction", density)}
    xarray.Dataset(result, {"friction": friction}, {"title": "posterior"}).to_netcdf(path)
    normal = sensitive()
    for named in ("told.nc", str(path)):
        uncertain = {"friction": {"calibration": named}}
        content = {**PLANE, "kind": "sensitivity", "uncertain": uncertain}
        study.write_text(json.dumps(content))
        found = vibrafeed.sensitivity(study)
        for part, within in (("mean", 1e-3), ("deviation", 1e-2)):
            name = f"acceleration_x_{part}"
            assert float(found[name]) == pytest.approx(float(normal[name]), rel=within)
    assert len(found.vibrafeed.study.content()["uncertain"]["friction"]["values"]) < 41
    with pytest.raises(StudyError, match="the command line and Python can"):
        prepare_content(content)
    for name, wrong, says in (
        ("friction", "none.nc", "cannot be read"), ("friction", 3, "not the path of a file"),
        ("beta", named, "The file has densities of friction"),
    ):  # fmt: skip
        with pytest.raises(StudyError, match=says):
            sensitive(uncertain={name: {"calibration": wrong}})


@pytest.mark.parametrize("name", FUNCTIONS)
def test_more_points_come_nearer(name):
    one = FUNCTIONS[name]
    found = sobol_indices(one.values, one.inputs, 1 << 13)
    assert found.first == pytest.approx(one.first, abs=0.02)
    assert found.total == pytest.approx(one.total, abs=0.03)


def test_estimates_are_those_of_scipy():
    one = FUNCTIONS["ishigami"]
    at = design(one.inputs, 64, seed=3, replicates=2)
    values = one.values(at.reshape(one.inputs, -1)).reshape(at.shape[1:])
    found = indices_of(values)
    a, b, *ab = values.reshape(len(values), -1)
    told = of_scipy(func={"f_A": a[None], "f_B": b[None], "f_AB": np.array(ab)[:, None]}, n=128)
    # scipy takes the mean of a and b together from both as well, and the same products.
    assert found.first == pytest.approx(told.first_order, abs=1e-12)
    assert found.total == pytest.approx(told.total_order, abs=1e-12)


def test_points_without_a_value_are_left_out_with_all_that_belong_to_them():
    def holed(x):
        return np.where(x[0] + x[1] < 0.02, np.nan, x[0] + 2 * x[1])

    found = sobol_indices(holed, 2, 4096)
    assert found.first == pytest.approx([0.2, 0.8], abs=0.03)
    constant = sobol_indices(lambda x: np.full(x.shape[1], 3.0), 2, 256)
    none = sobol_indices(lambda x: np.full(x.shape[1], np.nan), 2, 256)
    assert np.isnan([*constant.first, *constant.total, *none.first, *none.total]).all()
