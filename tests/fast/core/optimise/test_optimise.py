"""Optima: what they tell, what no optimum looks like, and what the user does not know."""

import math
from pathlib import Path

import numpy as np
import pytest

import vibrafeed
from night import spread
from vibrafeed.core.intake import load_study, parse_study, prepare_content
from vibrafeed.core.kinds import run_study, tabulate
from vibrafeed.core.optimise.check import knee
from vibrafeed.core.optimise.methods import METHODS
from vibrafeed.core.optimise.optimisation import BINDS
from vibrafeed.core.optimise.problem import STATUS
from vibrafeed.core.plots import landscape
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.style import Options
from vibrafeed.core.quantities import OPTIMUM_STATUSES, REGIMES
from vibrafeed.core.watch import Watch
from work import calls

CONFIGS = Path(__file__).parents[4] / "configs"
# The data of figure 5.1 of the source, less strong: below lift-off at the best angles.
DATA = {"frequency": 60, "amplitude": "0.1 mm", "friction": 0.5, "gravity": 9.8}


def content(**change):
    return {
        "kind": "optimise",
        "scene": "rectangle-on-plane",
        "variant": "thesis",
        "criterion": {"kind": "limit", "limit": "0.5 m/s^2"},
        "parameters": DATA,
        **change,
    }


def solved(**change):
    return run_study(parse_study(content(**change)))


def status(dataset) -> str:
    (name,) = [n for n, v in STATUS.items() if v == int(dataset.optimum_status)]
    return name


# --- what comes out


def test_the_dataset_tells_everything():
    dataset = solved(
        parameters={**DATA, "friction": [0.3, 0.5], "gamma": [0, 2, 4]},
        outputs=["throw_number"],
        constraints=[{"output": "throw_number", "upper": 0.5}],
    )
    assert dataset.sizes == {"friction": 2, "gamma": 3}
    limits = ("limit", "floor_contact", "throw_number_upper")
    assert {
        "objective", "acceleration_x", "acceleration_y", "throw_number",
        *(f"margin_{name}" for name in limits), *(f"binds_{name}" for name in limits),
        *(f"binds_{angle}_{end}" for angle in ("alpha", "beta") for end in ("lower", "upper")),
    } <= set(dataset)  # fmt: skip
    assert dataset.best_beta.attrs["units"] == "degree"
    assert dataset.objective.attrs["output"] == "acceleration_x"
    assert list(dataset.optimum_status.attrs["flag_values"]) == list(range(len(OPTIMUM_STATUSES)))
    assert dataset.binds_limit.attrs["flag_meanings"] == " ".join(BINDS)
    assert {"method", "message", "elapsed_seconds", "study", "study_sha256"} <= set(dataset.attrs)
    assert dataset.attrs["criterion"] == "largest acceleration_x with |acceleration_y| <= 0.5 m/s²"
    # Where it binds the margin is nothing, and the throw number its bound.
    tight = dataset.binds_throw_number_upper.values == 1
    assert tight.any()
    np.testing.assert_allclose(dataset.throw_number.values[tight], 0.5, rtol=1e-7)
    np.testing.assert_array_equal(dataset.margin_throw_number_upper.values[tight], 0.0)
    # The dense grid is never better by more than the method's own tolerance.
    assert (dataset.optimum_gap < 1e-8).all()


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"criterion": {"kind": "weighted", "weight": 0.3}},
        {"method": "search"},
        {"criterion": {"kind": "pareto", "points": 5}},
    ],
)
def test_a_batch_is_its_single_designs(change):
    parameters = {**DATA, "friction": [0.2, 0.8], "amplitude": [5e-5, 4e-4]}
    batch = solved(parameters=parameters, **change)
    for mu, amplitude in ((0.2, 4e-4), (0.8, 5e-5)):
        one = solved(parameters={**DATA, "friction": mu, "amplitude": amplitude}, **change)
        same = batch.sel(friction=mu, amplitude=amplitude)
        for name in ("best_alpha", "best_beta", "objective", "optimum_status"):
            np.testing.assert_array_equal(same[name], one[name], err_msg=name)


@pytest.mark.parametrize("method", spread(METHODS, 6))
def test_every_method_finds_the_best_elevation(method):
    # alpha given, the limit of no concern: beta = atan(mu) (theory 12.1) needs full azimuth.
    dataset = solved(
        criterion={"kind": "maximise"},
        parameters={**DATA, "alpha": 0},
        method=None if method == "exact" else method,  # its closed forms are for both angles
    )
    # 26.565 deg; at a smooth top the angle is known to the square root of the objective's error.
    assert float(dataset.best_beta) == pytest.approx(np.degrees(np.arctan(0.5)), abs=0.02)
    assert abs(float(dataset.optimum_gap)) < 1e-6
    assert "best_alpha" not in dataset


def test_frequency_and_amplitude_can_be_variables():
    # The strongest drive below lift-off at beta = 20 deg: the bound of the throw number binds.
    dataset = solved(
        variant="physical",
        criterion={"kind": "maximise"},
        variables={
            "amplitude": {"lower": "0.01 mm", "upper": "1 mm"},
            "frequency": {"lower": 40, "upper": "60 Hz"},
        },
        parameters={"friction": 0.3, "beta": 20, "gravity": 9.8},
        constraints=[{"output": "throw_number", "upper": 0.9}],
    )
    assert int(dataset.binds_throw_number_upper) == 1
    drive = float(dataset.best_amplitude) * (2 * np.pi * float(dataset.best_frequency)) ** 2
    up, along = drive * np.sin(np.radians(20)), drive * np.cos(np.radians(20))
    assert up == pytest.approx(0.9 * 9.8, rel=1e-8)
    assert float(dataset.objective) == pytest.approx(along - 0.3 * (9.8 - up), rel=1e-12)


def test_a_constraint_on_the_absolute_value_is_the_limit():
    limit = {"output": "acceleration_y", "absolute": True, "upper": 0.5}
    one, two = solved(), solved(criterion={"kind": "maximise"}, constraints=[limit])
    assert one.attrs["message"].startswith("optimal: ")
    assert one.attrs["message"].endswith("binding: limit")
    assert two.attrs["method"] == "search"
    assert float(two.objective) == pytest.approx(float(one.objective), rel=1e-9)
    assert int(two.binds_acceleration_y_absolute_upper) == 1


def test_bounds_of_the_angles_are_kept_and_told():
    within = {"alpha": {"lower": 10, "upper": 20}, "beta": {"lower": 0, "upper": 5}}
    dataset = solved(variables=within, criterion={"kind": "maximise"})
    names = ("best_alpha", "best_beta", "binds_alpha_lower", "binds_beta_upper")
    found = [float(dataset[name]) for name in names]
    assert found == pytest.approx([10.0, 5.0, 1, 1], rel=1e-15)
    assert dataset.attrs["method"] == "search"


def test_floor_contact_can_be_given_up():
    kept, free = (
        solved(
            criterion={"kind": "maximise"},
            parameters={**DATA, "amplitude": "0.5 mm"},
            floor_contact=contact,
        )
        for contact in (True, False)
    )
    # The thesis's own answer, atan(mu), is beyond lift-off (theory 12.1).
    assert float(free.best_beta) == pytest.approx(np.degrees(np.arctan(0.5)), abs=1e-9)
    assert float(kept.best_beta) < float(free.best_beta)
    told = int(free.regime), int(kept.regime), int(kept.binds_floor_contact)
    assert told == (REGIMES["flight"].value, REGIMES["slip"].value, 1)
    assert float(kept.margin_floor_contact) == 0


def test_the_fastest_true_motion():
    dataset = run_study(load_study(CONFIGS / "optimise-velocity.toml"))
    # By a plain grid of the simulated motion: 0.17 m/s near 22 deg, far beyond lift-off (7.9 deg).
    assert float(dataset.best_beta) == pytest.approx(21.8, abs=0.1)
    assert float(dataset.throw_number) > 2
    assert abs(float(dataset.optimum_gap)) < 1e-2


def test_a_small_feasible_corner_is_searched_as_a_whole():
    # Both contacts leave a tenth of the angles, with a low point in each of its corners.
    dataset = solved(
        scene="rectangle-on-track",
        variant="physical",
        criterion={"kind": "minimise"},
        parameters={
            "frequency": 25.775, "amplitude": 0.0013445, "gravity": 9.81, "gamma": -9.096,
            "friction": 0.0941, "delta": 39.83,
        },
    )  # fmt: skip
    assert status(dataset) == "optimal"
    assert float(dataset.optimum_gap) < 1e-9


def test_a_drive_just_strong_enough_moves_the_part():
    # Friction holds the part at all but a few angles: the choice matters.
    amplitude = 1.0005 * 0.5 * 9.8 / np.sqrt(1.25) / (2 * np.pi * 60) ** 2
    parameters = {**DATA, "amplitude": amplitude}
    dataset = solved(variant="physical", criterion={"kind": "maximise"}, parameters=parameters)
    assert status(dataset) == "optimal"
    assert float(dataset.best_beta) == pytest.approx(np.degrees(np.arctan(0.5)), abs=1e-7)


# --- the trade-off


def of_case_b(criterion):
    given = {"frequency": 60, "amplitude": 1e-4, "friction": 0.5, "gravity": 9.81}
    return parse_study(content(criterion=criterion, parameters=given))


def test_the_front_of_case_b_is_the_curve():
    """Below lift-off beta = atan(mu (cos alpha + sin alpha)), theory 12.1."""
    dataset = run_study(of_case_b({"kind": "pareto", "points": 200}))
    alpha, beta = np.radians(dataset.best_alpha.values), np.radians(dataset.best_beta.values)
    curve = np.arctan(0.5 * (np.cos(alpha) + np.sin(alpha)))
    np.testing.assert_allclose(beta, curve, rtol=0, atol=1e-8)
    a_x, a_y = dataset.acceleration_x.values, np.abs(dataset.acceleration_y.values)
    assert np.all(np.diff(a_x) < 0)
    assert np.all(np.diff(a_y) < 0)
    assert (alpha[0], dataset.front.values[0], dataset.front.values[-1]) == (0.0, 0.0, 1.0)
    assert a_y[-1] < 1e-14
    assert dataset.optimum_gap.max() < 1e-12
    # The knee: no point lies farther from the chord between the ends.
    share = (a_x - a_x[-1]) / (a_x[0] - a_x[-1]) - (a_y - a_y[-1]) / (a_y[0] - a_y[-1])
    assert dataset.knee.values.sum() == 1
    assert share[dataset.knee.values == 1][0] == share.max() > 0.2


def test_a_front_of_200_points_takes_less_work_than_ten_single_limits():
    single = of_case_b({"kind": "limit", "limit": 1.0})
    front = of_case_b({"kind": "pareto", "points": 200})
    assert calls(lambda: run_study(front)) < 10 * calls(lambda: run_study(single))


def test_knees():
    corner = np.array([[4.0, 3.9, 3.0, 0.0]])
    other = np.array([[4.0, 1.0, 0.5, 0.0]])
    np.testing.assert_array_equal(knee(corner, -other), [[0, 1, 0, 0]])
    np.testing.assert_array_equal(knee(np.full((1, 3), np.nan), np.zeros((1, 3))), [[1, 0, 0]])


# --- pictures


def test_a_front_and_its_knee_are_drawn():
    dataset = solved(
        parameters={**DATA, "friction": [0.3, 0.5]}, criterion={"kind": "pareto", "points": 20}
    )
    assert (dataset.front_points == 20).all()
    assert "no trade-off" not in dataset.attrs["message"]
    figure = landscape.draw(dataset, Options(kind="front"))
    curves = [line for line in figure.axes[0].lines if len(line.get_xdata()) == 20]
    for curve, values in zip(curves, dataset.acceleration_x, strict=True):
        np.testing.assert_array_equal(curve.get_ydata(), values)
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names[:2] == ["friction 0.3", "friction 0.5"]


@pytest.mark.parametrize(
    ("options", "left_out", "words"),
    [
        (Options(kind="front"), (), "no trade-off front"),
        (Options(at={"gamma": 1}), (), "has no range"),
        (Options(kind="front"), ("optimum_status",), "not the result of an optimisation"),
    ],
)
def test_what_cannot_be_drawn_is_refused(options, left_out, words):
    with pytest.raises(PlotError, match=words):
        landscape.draw(solved().drop_vars(left_out), options)


# --- no optimum


@pytest.mark.parametrize("method", [None, "search", "scipy"])
def test_a_drive_too_weak_to_move(method):
    parameters = {**DATA, "amplitude": "1 um"}
    change = {"variant": "physical", "criterion": {"kind": "maximise"}, "method": method}
    assert status(solved(**change, parameters=parameters)) == "no_motion"


def test_a_part_that_only_slides_back_is_not_one_that_rests():
    """So flat a drive carries nothing up a climb of 5 degrees, and something along the level."""
    plane = {"scene": "rectangle-on-plane", "frequency": 50, "amplitude": "0.1 mm", "friction": 0.2}
    dataset = vibrafeed.optimise(
        criterion={"kind": "maximise", "output": "conveying_velocity"},
        variables={"beta": {"lower": 0, "upper": 10}}, gamma=[0, 5], **plane,
    )  # fmt: skip
    assert [status(dataset.isel(gamma=k)) for k in range(2)] == ["optimal", "only_backward"]
    back = dataset.isel(gamma=1)
    assert float(back.objective) < -float(back.objective_error)
    held = vibrafeed.simulate(
        outputs=["conveying_velocity"], gamma=5, beta=float(back.best_beta), **plane
    )
    assert float(held.conveying_velocity) == pytest.approx(float(back.objective))


def test_a_worst_case_that_goes_backwards_is_no_optimum_without_a_word():
    """At the middle friction the best drive goes up the climb; with the least one it goes down."""
    study = {
        "kind": "optimise",
        "scene": "rectangle-on-plane",
        "criterion": {"kind": "maximise", "output": "conveying_velocity"},
        "variables": {"beta": {"lower": 0, "upper": 14}},
        "parameters": {"frequency": 50, "amplitude": "0.1 mm", "gamma": 2},
        "uncertain": {"friction": {"lower": 0.25, "upper": 0.45}},
    }
    worst = vibrafeed.optimise({**study, "robust": "worst"})
    assert status(worst) == "only_backward"
    assert float(worst.objective) < -float(worst.objective_error)
    assert float(worst.conveying_velocity) > 0  # at the middle
    assert "only_backward" in worst.attrs["message"]
    assert status(vibrafeed.optimise({**study, "robust": "mean"})) == "optimal"


def test_a_choice_that_does_not_matter():
    # Straight up, every azimuth is the same direction.
    dataset = solved(
        criterion={"kind": "minimise"},
        parameters={**DATA, "amplitude": "10 um", "beta": 90},
        method="search",
    )
    assert status(dataset) == "flat"
    assert "does not matter" in dataset.attrs["message"]


@pytest.mark.parametrize("method", [None, "search", "scipy"])
def test_bounds_that_exclude_everything(method):
    dataset = solved(
        parameters={**DATA, "amplitude": "0.5 mm"},
        variables={"alpha": {"lower": 0, "upper": 90}, "beta": {"lower": 60, "upper": 90}},
        method=method,
    )
    assert status(dataset) == "infeasible"
    assert np.isnan([dataset.best_beta, dataset.objective]).all()
    assert int(dataset.regime) == REGIMES["not_assessed"].value
    assert dataset.attrs["message"].startswith("infeasible: no choice satisfies")


@pytest.mark.parametrize("method", spread(["search", "scipy"], 1))
def test_outputs_without_a_value(method):
    # In flight the floor's resultant is nowhere: NaN would end scipy's differential evolution.
    nowhere, partly = (
        solved(
            variant="physical",
            criterion={"kind": "maximise", "output": "pressure_offset_x"},
            parameters={**DATA, "amplitude": "0.5 mm", "height": "10 mm", "length": "20 mm"},
            floor_contact=False,
            method=method,
            variables={"beta": {"lower": lower, "upper": 90}},
        )
        for lower in (30, 0)
    )
    assert (status(nowhere), status(partly)) == ("no_value", "optimal")
    # Sliding: mu times half the height, theory 4.4.
    assert float(partly.objective) == pytest.approx(0.5 * 0.005, rel=1e-9)


@pytest.mark.parametrize("method", ["search", "scipy"])
def test_what_was_never_begun_is_not_computed(method):
    dataset = run_study(parse_study(content(method=method)), watch=Watch(deadline=0.0))
    assert status(dataset) == "not_computed"


def test_a_study_that_is_stopped_keeps_what_is_finished():
    told: list[float] = []
    prepared = prepare_content(content(parameters={**DATA, "friction": [0.3, 0.5]}, method="scipy"))
    watch = Watch(told.append, lambda: sum(told) >= 0.5 * (1 - 1e-9))  # the first is half
    dataset = tabulate(prepared, watch).to_xarray()
    told = [status(dataset.isel(friction=k)) for k in range(2)]
    assert told == ["optimal", "not_computed"]
    assert np.isnan(dataset.best_beta).values.tolist() == [False, True]


@pytest.mark.parametrize("method", ["search", "scipy"])
def test_the_bar_moves_within_a_design_and_ends_at_its_end(method):
    study = content(
        method=method, variant="physical",
        criterion={"kind": "minimise", "output": "vibration_acceleration"},
        constraints=[{"output": "acceleration_x", "lower": "5 m/s^2"}],
        variables={"amplitude": {"lower": "0.01 mm", "upper": "1 mm"}},
        parameters={"frequency": 50, "friction": 0.3, "gamma": 2, "beta": 20},
    )  # fmt: skip
    told: list[float] = []
    tabulate(prepare_content(study), Watch(told.append))
    assert sum(told) == pytest.approx(1)
    assert 0 <= min(told) <= max(told) < 0.9
    assert sum(share > 0 for share in told) > 10


# --- what the user does not know, and what matters


def uncertain(**change):
    parameters = {name: value for name, value in DATA.items() if name != "friction"}
    return {
        "parameters": parameters,
        "uncertain": {"friction": {"lower": 0.3, "upper": 0.5}},
        "criterion": {"kind": "maximise", "output": "acceleration_x"},
        **change,
    }


class TestRobust:
    def test_the_worst_friction_of_a_sliding_part_is_the_largest(self):
        # On the floor a_x = D_x - mu n0 falls with mu: the worst case is the upper end.
        robust = solved(**uncertain())
        known = solved(criterion={"kind": "maximise"}, method="search")
        assert float(robust.objective) == pytest.approx(float(known.objective), rel=1e-9)
        # A maximum is flat: an error of 1e-9 of the value is one of 3e-5 of the angle.
        assert float(robust.best_beta) == pytest.approx(float(known.best_beta), abs=3e-3)
        assert "in the worst case over friction from 0.3 to 0.5" in robust.attrs["criterion"]

    def test_constraints_hold_over_the_whole_interval(self):
        limit = {"kind": "limit", "limit": "0.5 m/s^2"}
        robust = solved(**uncertain(criterion=limit))
        at = {"alpha": float(robust.best_alpha), "beta": float(robust.best_beta)}
        for friction in np.linspace(0.3, 0.5, 41):
            parameters = {**DATA, "friction": float(friction), **at}
            study = {"kind": "sweep", "scene": "rectangle-on-plane", "variant": "thesis",
                     "outputs": ["acceleration_y"], "parameters": parameters}  # fmt: skip
            assert abs(float(run_study(parse_study(study)).acceleration_y)) <= 0.5 + 1e-6


class TestSensitivities:
    def test_powers_are_exponents(self):
        # P cos(beta) goes with the square of frequency, and with amplitude; not with friction.
        found = solved(
            criterion={"kind": "maximise", "output": "drive_along"},
            parameters={"frequency": 60, "amplitude": ["0.1 mm", "0.2 mm"], "alpha": 0},
            variables={"beta": {"lower": "20 deg", "upper": "60 deg"}},
            floor_contact=False,
            sensitivities=True,
        )
        np.testing.assert_allclose(found.sensitivity_frequency, 2, rtol=1e-9)
        np.testing.assert_allclose(found.sensitivity_amplitude, 1, rtol=1e-9)
        beta = np.deg2rad(found.best_beta)
        np.testing.assert_allclose(found.sensitivity_beta, -beta * np.tan(beta), rtol=1e-9)
        assert "sensitivity_friction" not in found

    def test_a_variable_that_only_a_constraint_needs_has_none(self):
        """A0 (2 pi f)^2 does not know beta; the study was refused once its answers were there."""
        gentle = load_study(CONFIGS / "optimise-minimise.toml")
        found = run_study(gentle.model_copy(update={"sensitivities": True}))
        np.testing.assert_array_equal(found.sensitivity_beta, 0.0)
        np.testing.assert_allclose(found.sensitivity_amplitude, 1, rtol=1e-9)
        np.testing.assert_allclose(found.sensitivity_frequency, 2, rtol=1e-9)

    def test_an_optimum_on_the_edge_of_a_contact_is_derived_from_inside(self):
        """At the best angles the wall carries nothing: a larger amplitude takes the part off it."""
        found = solved(
            scene="rectangle-on-track", variant="physical", criterion={"kind": "maximise"},
            sensitivities=True, parameters={**DATA, "delta": 10},
        )  # fmt: skip
        assert found.binds_wall_contact == 1
        alpha, beta = np.deg2rad(found.best_alpha), np.deg2rad(found.best_beta)
        mu, P = 0.5, 1e-4 * (2 * math.pi * 60) ** 2
        # a_x = drive - mu g (sin(delta) + cos(delta)) by theory 4.4, at rest with both contacts.
        drive = P * (np.cos(beta) * (np.cos(alpha) + mu * np.sin(alpha)) + mu * np.sin(beta))
        lean = math.radians(10)
        a_x = drive - mu * 9.8 * (math.sin(lean) + math.cos(lean))
        np.testing.assert_allclose(found.objective, a_x, rtol=1e-12)
        np.testing.assert_allclose(found.sensitivity_amplitude, drive / a_x, rtol=1e-8)
        np.testing.assert_allclose(found.sensitivity_frequency, 2 * drive / a_x, rtol=1e-8)
        np.testing.assert_allclose(found.sensitivity_gravity, 1 - drive / a_x, rtol=1e-8)
        by_alpha = P * np.cos(beta) * (mu * np.cos(alpha) - np.sin(alpha))
        np.testing.assert_allclose(found.sensitivity_alpha, alpha * by_alpha / a_x, rtol=1e-8)

    def test_motion_is_derived_inside_its_regime(self):
        found = run_study(load_study(CONFIGS / "optimise-robust.toml"))
        # v/(g/w) depends on p = A0 w^2/g alone: d ln v/d ln f = 2 d ln v/d ln A0 - 1.
        np.testing.assert_allclose(
            found.sensitivity_frequency, 2 * found.sensitivity_amplitude - 1, atol=1e-3
        )


ON_TRACK = {
    "scene": "rectangle-on-track",
    "criterion": {"kind": "pareto", "points": 7},
    "variables": {"alpha": {"lower": -45, "upper": 45}, "beta": {"lower": 0, "upper": 60}},
    "parameters": {
        "frequency": 50, "amplitude": "0.05 mm", "friction": 0.3, "gamma": 2, "delta": 5,
        "radius": "150 mm",
    },
}  # fmt: skip


def test_a_front_without_a_trade_off_is_one_point_and_says_so():
    parameters = {**ON_TRACK["parameters"], "frequency": [25, 50]}  # nothing moves at 25 Hz
    front = vibrafeed.optimise({**ON_TRACK, "parameters": parameters})
    assert (front.front_points == 1).all()
    assert front.attrs["message"] == (
        "of 2 answers: optimal 1, no_motion 1; no trade-off in 2 of 2 designs: acceleration_y = 0 "
        "is reached at the largest acceleration_x"
    )
    best = front.isel(frequency=1, front=0)
    assert abs(float(best.acceleration_y)) < 1e-9
    # The drive just unloads the wall: P cos(beta) sin(alpha) = g cos(gamma) sin(delta).
    alpha, beta = np.deg2rad(best.best_alpha), np.deg2rad(best.best_beta)
    peak = 0.05e-3 * (2 * math.pi * 50) ** 2
    unloads = 9.80665 * math.cos(math.radians(2)) * math.sin(math.radians(5))
    assert float(peak * np.cos(beta) * np.sin(alpha)) == pytest.approx(unloads, rel=1e-6)
    # It is drawn over the designs.
    figure = vibrafeed.plot(front)
    assert "No trade-off" in figure.get_suptitle()
    assert figure.axes[0].lines[0].get_ydata()[1] == pytest.approx(float(best.best_alpha))
