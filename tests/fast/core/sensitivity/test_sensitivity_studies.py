"""Studies of uncertain parameters: closed cases, laws, and what a study may say."""

from __future__ import annotations

import json
import threading

import numpy as np
import pytest
import xarray
from scipy import stats
from typer.testing import CliRunner

import vibrafeed
from local_client import local_client
from vibrafeed.app.cli import app
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.errors import StoppedError, StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import KINDS, tabulate
from vibrafeed.core.plan.pieces import Cut, join
from vibrafeed.core.sensitivity.budget import Budget
from vibrafeed.core.study.distributions import quantiles, read_distribution
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


def problems(**change) -> dict[str, str]:
    with pytest.raises(StudyError) as caught:
        prepare_content({"kind": "sensitivity", **PLANE, **change})
    return {problem.place: f"{problem.message}. {problem.fix}" for problem in caught.value.problems}


# --- closed cases


def test_the_probability_of_a_closed_form_is_that_of_its_normal_friction():
    normal = stats.norm(0.3, 0.02)
    at = [0.28, 0.31]
    known = vibrafeed.sweep(
        scene=PLANE["scene"], outputs="acceleration_x", friction=at, **PLANE["parameters"]
    ).acceleration_x.values
    for friction, level in zip(at, known, strict=True):
        # More friction, less acceleration: as likely as that the friction is below.
        demand = {"output": "acceleration_x", "at_least": float(level)}
        found = sensitive(demands=[demand], samples=4096)
        error = float(found.probability_acceleration_x_at_least_error)
        expected = normal.cdf(friction)
        assert float(found.probability_acceleration_x_at_least) == pytest.approx(
            expected, abs=1.5 * error
        )
        assert error < 0.005
    quantiles = found.acceleration_x_quantile.values
    expected = vibrafeed.sweep(
        scene=PLANE["scene"], outputs="acceleration_x",
        friction=sorted(normal.ppf([0.05, 0.5, 0.95])), **PLANE["parameters"],
    ).acceleration_x.values[::-1]  # fmt: skip
    assert quantiles == pytest.approx(expected, abs=2e-3)
    assert (np.abs(quantiles - expected) <= 2 * found.acceleration_x_quantile_error.values).all()
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
    expected = stats.norm(0.3, 0.03).cdf(0.32)
    assert float(found.probability_conveying_velocity_at_least) == pytest.approx(
        expected, abs=2 * error
    )
    a_k, step = 0.3 * G, 0.09
    slope = -(1 / (A_M - a_k) + 1 / (A_S + a_k)) * G * speed_of_level_wave(0.3)
    assert found.conveying_velocity_linear.values == pytest.approx([slope * step], rel=1e-4)
    least, largest = float(found.conveying_velocity_least), float(found.conveying_velocity_largest)
    assert [least, largest] == pytest.approx([speed_of_level_wave(0.39), speed_of_level_wave(0.21)],
                                             rel=1e-4)  # fmt: skip


# --- laws


def test_monotonic_transformations_commute_with_quantiles():
    amplitude = {"amplitude": {"lower": "0.1 mm", "most_likely": "0.2 mm", "upper": "0.4 mm"}}
    parameters = {"frequency": 50, "beta": 20}
    found = sensitive(
        outputs=["throw_number"], uncertain=amplitude, parameters=parameters,
        quantiles=[0.1, 0.5, 0.9], analyses=["distribution"],
        samples=8192,
    )  # fmt: skip
    law = read_distribution("amplitude", amplitude["amplitude"])
    at = quantiles("amplitude", law, [0.1, 0.5, 0.9])
    throw = vibrafeed.sweep(
        scene=PLANE["scene"], outputs="throw_number", amplitude=at, **parameters
    ).throw_number.values
    assert found.throw_number_quantile.values == pytest.approx(throw, rel=1e-3)


def test_equal_seeds_give_equal_bits_and_others_others():
    one, same, other = (sensitive(seed=seed) for seed in (0, 0, 1))
    assert one.identical(same.assign_attrs(one.attrs))
    assert float(one.acceleration_x_mean) != float(other.acceleration_x_mean)
    less = sensitive(analyses=["distribution"])
    assert float(less.acceleration_x_mean) == float(one.acceleration_x_mean)


def test_designs_are_told_alike_alone_together_and_in_pieces():
    gamma = [0, 1, 3]
    content = {
        **PLANE, "kind": "sensitivity", "analyses": ["distribution", "sobol", "budget"],
        "uncertain": {**PLANE["uncertain"], "beta": {"lower": 19, "upper": 21}},
        "demands": [{"output": "acceleration_x", "at_most": 1.5}],
    }  # fmt: skip
    del content["parameters"]
    drive = {"frequency": 50, "amplitude": "0.1 mm"}
    prepared = prepare_content({**content, "parameters": {**drive, "gamma": gamma}})
    whole = tabulate(prepared).to_xarray()
    for place, one in enumerate(gamma):
        alone = tabulate(prepare_content({**content, "parameters": {**drive, "gamma": one}}))
        for name, variable in alone.variables.items():
            part = whole[name].isel(gamma=place).values
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
    fixed = {"frequency": 50, "beta": 20}
    found = sensitive(
        parameters={**fixed, "friction": 0.3},
        uncertain={"amplitude": {"lower": 0.9 * edge, "upper": 1.1 * edge}},
        demands=[{"output": "acceleration_x", "at_least": -1e9}, {"regime": "flight"}],
    )  # fmt: skip
    left = float(found.acceleration_x_left_out)
    assert left == pytest.approx(0.5, abs=0.01)
    assert float(found.probability_flight) == left
    assert float(found.probability_acceleration_x_at_least) == 1 - left
    # Of an output that needs no floor nothing is left out.
    throw = sensitive(
        parameters=fixed, outputs=["throw_number"],
        uncertain={"amplitude": {"lower": 0.9 * edge, "upper": 1.1 * edge}},
    )  # fmt: skip
    assert float(throw.throw_number_left_out) == 0
    beyond = sensitive(parameters={**fixed, "friction": 0.3, "beta": 60, "frequency": 200},
                       uncertain={"amplitude": {"lower": edge, "upper": 2 * edge}})  # fmt: skip
    assert float(beyond.acceleration_x_left_out) == 1
    assert np.isnan(beyond.acceleration_x_mean)
    assert np.isnan(beyond.acceleration_x_first).all()


def test_a_stop_leaves_no_half_answer_and_progress_reaches_the_whole():
    prepared = prepare_content({"kind": "sensitivity", **LEVEL_WAVE})
    told, lock = [], threading.Lock()

    def advance(share):
        with lock:
            told.append(share)

    tabulate(prepared, Watch(advance))
    assert sum(told) == pytest.approx(1, abs=1e-6)
    with pytest.raises(StoppedError):
        tabulate(prepared, Watch(stop=lambda: True))


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


def test_every_error_is_told_with_its_place():
    both = [{"output": "acceleration_x", "at_least": 2, "at_most": 1}]
    told = problems(
        uncertain={"friction": {"mean": 0.3, "devation": 1}, "beta": {"lower": 3}},
        samples=300, quantiles=[0.5, 1.5], analyses=["sobol", "other"],
        outputs=["aceleration_x"],
    )  # fmt: skip
    assert "deviation" in told["uncertain.friction"]
    assert "distribution" in told["uncertain.beta"]
    assert "power of two" in told["samples"]
    assert "between 0 and 1" in told["quantiles"]
    assert "Did you mean" in told["outputs"]
    assert any(place.startswith("analyses") for place in told)
    assert "Write sobol" in problems(analyses=["morris", "sobol"])["analyses"]
    told = problems(
        uncertain={"friction": {"lower": 0.2, "upper": 0.3}, "beta": {"mean": 20, "deviation": 1}},
        demands=[*both, {}, {"output": "throw_number"}, {"regime": "hopping"}, {"regime": "hoping"},
                 {"output": "motion_status", "at_most": 1}, {"regime": "slip", "at_most": 1}],
        verify=3,
    )  # fmt: skip
    assert "parameters" in told["uncertain.beta"]
    assert "Swap" in told["demands.0"]
    assert "neither" in told["demands.1"]
    assert "at_least" in told["demands.2"]
    assert "names as values" in told["demands.5.output"]
    assert "a regime has no bounds" in told["demands.6"]
    assert "verify" in told
    told = problems(demands=[{"regime": "hopping"}, {"regime": "hoping"}])
    assert "flight" in told["demands.0.regime"]
    assert "hopping" in told["demands.1.regime"]
    assert "no parameter is uncertain" in problems(uncertain={})["uncertain"]
    assert "radius" in str(problems(uncertain={"radius": {"mean": 1, "deviation": 0.1}}))
    many = {"start": 0, "stop": 1, "num": 100_000}
    huge = problems(samples=1 << 20, parameters={**PLANE["parameters"], "gamma": many})
    assert "evaluations at most" in huge["samples"]
    wide = problems(samples=1 << 20, outputs=["acceleration_x", "throw_number", "drive_number"])
    assert wide  # more outputs than a design may have, or one that there is not


def test_the_command_line_tells_what_matters(tmp_path):
    study = tmp_path / "tolerances.toml"
    study.write_text(
        'kind = "sensitivity"\nscene = "rectangle-on-plane"\noutputs = ["acceleration_x"]\n'
        "samples = 256\n[uncertain]\nfriction = { mean = 0.3, deviation = 0.02 }\n"
        'beta = { lower = 19, upper = "21 deg" }\n[[demands]]\noutput = "acceleration_x"\n'
        'at_least = "1.5 m/s^2"\n[parameters]\nfrequency = "50 Hz"\namplitude = "0.1 mm"\n'
    )
    done = CliRunner().invoke(app, ["run", str(study), "-o", str(tmp_path / "told.nc")])
    assert done.exit_code == 0, done.output
    words = "probability of acceleration_x at least 1.5 m/s²", "friction matters most", "5 % below"
    for one in words:
        assert one in done.output
    plan = CliRunner().invoke(app, ["run", str(study), "--dry-run"])
    assert plan.exit_code == 0, plan.output
    assert "acceleration_x_total" in plan.output


def test_the_service_carries_it_out_and_does_not_measure_its_accuracy(tmp_path):
    study = {**PLANE, "demands": [{"output": "acceleration_x", "at_least": "2 m/s^2"}]}
    with local_client(create_app(Settings(data_directory=tmp_path))) as client:
        reply = client.post("/processes/sensitivity/execution", json=study)
        assert reply.status_code == 200, reply.text
        asked = {"kind": "sensitivity", **study}
        refused = client.post("/processes/accuracy/execution", json=asked)
    told = reply.json()["variables"]
    called = sensitive(study)
    for name in ("probability_acceleration_x_at_least", "acceleration_x_mean"):
        assert told[name]["data"] == float(called[name])
    assert told["acceleration_x_total"]["dims"] == ["uncertain"]
    assert reply.json()["coordinates"]["uncertain"]["flags"] == {"friction": 0}
    assert refused.status_code == 422
    assert "is not measured" in refused.text


def test_a_calibration_gives_its_density_to_who_has_the_file(tmp_path):
    friction = np.linspace(0.2, 0.4, 41)
    density = stats.norm(0.3, 0.02).pdf(friction) * (abs(friction - 0.3) < 0.07)
    result = xarray.Dataset(
        {"density_friction": ("friction", density)}, {"friction": friction}, {"title": "posterior"}
    )
    result.to_netcdf(tmp_path / "told.nc")
    study = tmp_path / "study.json"
    for named in ("told.nc", str(tmp_path / "told.nc")):
        content = {
            **PLANE,
            "kind": "sensitivity",
            "uncertain": {"friction": {"calibration": named}},
        }
        study.write_text(json.dumps(content))
        found = vibrafeed.sensitivity(study)
        normal = sensitive()
        for part, within in (("mean", 1e-3), ("deviation", 1e-2)):
            name = f"acceleration_x_{part}"
            assert float(found[name]) == pytest.approx(float(normal[name]), rel=within)
    assert len(found.vibrafeed.study.content()["uncertain"]["friction"]["values"]) < 41
    with pytest.raises(StudyError, match="only the command line and Python read files"):
        prepare_content(content)
    for wrong, says in (("none.nc", "cannot be read"), (3, "not the path of a file")):
        with pytest.raises(StudyError, match=says):
            sensitive(uncertain={"friction": {"calibration": wrong}})
    with pytest.raises(StudyError, match="It has those of friction"):
        sensitive(uncertain={"beta": {"calibration": named}})
