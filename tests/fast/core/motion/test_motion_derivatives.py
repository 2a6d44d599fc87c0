"""Derivatives of motion against exact ones, against closed forms, and against laws."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks.derivatives import OUTPUT, random_cells
from point_slopes import motion_sensitivities
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import open_lazily, tabulate
from vibrafeed.core.motion.prepare import choose_system
from vibrafeed.core.plan.differences import STATUS, derivatives
from vibrafeed.core.plan.plan import plan_scene
from vibrafeed.core.watch import Watch

PLANE = "rectangle-on-plane"
POINT = {
    "frequency": 50.0, "amplitude": 3e-4, "beta": 0.5, "gamma": 0.02, "friction": 0.3,
    "gravity": 9.81,
}  # fmt: skip
EXACT = Path(__file__).parents[3] / "data" / "planar_derivatives.json"


def plan_of(cells, *outputs, scene=PLANE):
    system, method, _ = choose_system(scene, None, cells)
    return plan_scene(system, method, outputs, cells)


# --- against exact ones


def test_motions_have_the_derivatives_that_were_carried_through_their_events():
    """Within the stated error, and 1e-8 of the larger of slope and value over parameter."""
    exact = json.loads(EXACT.read_text())
    names, outputs = exact["parameters"], exact["outputs"]
    points = np.array([one["point"] for one in exact["motions"]]).T
    cells = dict(zip(names, points, strict=True))
    found = derivatives(plan_of(cells, *outputs), cells, names)
    errors = []
    for row, output in enumerate(outputs):
        for column, name in enumerate(names):
            one = found[output, name]
            slope = np.array([m["slopes"][row][column] for m in exact["motions"]], dtype=float)
            known = np.isfinite(slope)
            assert known.sum() >= 10
            assert (np.isfinite(one.slope) == known).all(), (output, name)
            size = np.maximum(np.abs(slope), np.abs(one.value) / np.fmax(cells[name], 1e-3))[known]
            off = np.abs(one.slope - slope)[known]
            # Shares are counted without the last hops, up to 1e-7 of a period (theory 13.5).
            room = 1e-6 if output == "flight_fraction" else 1e-8
            assert (off <= 2 * one.error[known] + room * size).all(), (output, name)
            errors.extend(off[size > 0] / size[size > 0])
    assert np.median(errors) < 1e-9


# --- at kinks, at jumps, at ends


def by(point, *names):
    """Return the derivatives of the conveying velocity at a point by these parameters."""
    found = motion_sensitivities(PLANE, None, [OUTPUT], point, names)
    return [found[OUTPUT, name] for name in names]


def test_where_the_least_restitution_jumps_there_is_no_derivative_by_it_alone():
    # 51.2060 mm/s at 0, 51.1451 mm/s at 1e-12 to 1e-6 (`tests/laws/test_planar_means.py`).
    restitution, beta = by(
        {
            "frequency": 63.083, "amplitude": 0.184447e-3, "beta": math.radians(39.096),
            "friction_static": 1.0514, "friction_kinetic": 0.7356, "restitution": 0.0,
        },
        "restitution", "beta",
    )  # fmt: skip
    assert math.isnan(restitution.derivative)
    assert "kink" in restitution.note
    assert beta.note == ""


def test_a_landing_that_stops_a_slip_leaves_one_of_the_first_order():
    # Differences of an independent solver in quadruple precision give 0.1175554 m/s.
    point = {
        "frequency": 50.0, "amplitude": 0.5e-3, "beta": math.radians(40.0), "friction": 0.6,
        "restitution": 0.0,
    }  # fmt: skip
    (one,) = by(point, "restitution")
    assert one.derivative == pytest.approx(0.1175554, abs=5e-8)
    assert "from inside" in one.note


def test_equal_coefficients_of_friction_are_an_end_of_either():
    point = {name: value for name, value in POINT.items() if name != "friction"}
    point |= {"friction_static": 0.3, "friction_kinetic": 0.3}
    static, kinetic = by(point, "friction_static", "friction_kinetic")
    assert "from inside" in static.note
    assert "from inside" in kinetic.note
    (both,) = by(POINT, "friction")
    assert static.derivative + kinetic.derivative == pytest.approx(both.derivative, rel=1e-6)


@pytest.mark.parametrize("off", [0.0, 1e-9, 1e-6])
def test_next_to_a_border_nothing_is_told_that_belongs_to_neither_side(off):
    """At throw number 1 hops begin: derivatives beside it are those of their side, or none."""
    w = 2 * math.pi * POINT["frequency"]
    limit = POINT["gravity"] * math.cos(POINT["gamma"]) / (w * w * math.sin(POINT["beta"]))
    for side in (-1, 1):
        (far,), (near,) = (
            by({**POINT, "amplitude": limit * (1 + side * at)}, "gamma") for at in (2e-3, off)
        )
        assert far.note == ""
        assert near.note or near.derivative == pytest.approx(far.derivative, rel=0.05)
        assert near.note or off > 0


def test_what_is_stopped_is_not_computed():
    cells = random_cells(50, 1)
    found = derivatives(plan_of(cells, OUTPUT), cells, ["beta"], Watch(stop=lambda: True))
    assert (found[OUTPUT, "beta"].status == STATUS["not_computed"]).all()


# --- through the equations


def test_a_grid_tells_cell_by_cell_what_points_tell():
    outputs = ("conveying_velocity", "efficiency", "drive_power")
    one = POINT["gravity"] * math.cos(POINT["gamma"]) / (100 * math.pi) ** 2
    amplitudes = np.array([0.3, 1.0, 1.5, 3.5]) * one / math.sin(POINT["beta"])
    found = derivatives(plan_of(POINT, *outputs), {**POINT, "amplitude": amplitudes}, ["gamma"])
    found_at = found["efficiency", "gamma"].status == STATUS["differences"]
    assert found_at.tolist() == [True, False, True, True]
    for place, amplitude in enumerate(amplitudes.tolist()):
        point = {**POINT, "amplitude": amplitude}
        for key, at in motion_sensitivities(PLANE, None, outputs, point, ["gamma"]).items():
            np.testing.assert_allclose(found[key].slope[place], at.derivative, rtol=1e-9)


def test_a_push_across_presses_to_the_wall_and_has_no_two_sides():
    (on_plane,) = by({**POINT, "alpha": 0.0}, "alpha")
    assert on_plane.derivative == 0.0
    point = {**POINT, "alpha": 0.0, "delta": 0.0}
    names = ["alpha", "friction"]
    on_track = motion_sensitivities("rectangle-on-track", None, [OUTPUT], point, names)
    assert "kink" in on_track[OUTPUT, "alpha"].note
    assert on_track[OUTPUT, "friction"].note == ""


# --- as a key of a study

STUDY = {
    "kind": "simulate", "scene": PLANE, "outputs": ["conveying_velocity", "motion_status"],
    "sensitivities": True,
    "parameters": {
        "frequency": 50, "amplitude": ["0.1 mm", "0.3 mm"], "beta": "25 deg", "friction": 0.3,
    },
}  # fmt: skip


SWEEP = {
    "kind": "sweep", "scene": "rectangle-on-track", "outputs": ["throw_number", "acceleration_x"],
    "sensitivities": ["amplitude", "beta"],
    "parameters": {
        "frequency": 50, "amplitude": [1e-4, 2e-4, 3e-4], "beta": ["10 deg", "20 deg"],
        "alpha": "3 deg", "friction": 0.3, "gamma": 0, "delta": "2 deg",
    },
}  # fmt: skip
TUMBLES = {
    "kind": "simulate", "scene": "rectangle-isolated", "outputs": ["drift_velocity"],
    "sensitivities": True,
    "parameters": {
        "frequency": 50, "amplitude": 1e-4, "beta": 0.5, "friction": 0.3, "height": 0.01,
        "length": 0.02, "duration": 1.0, "restitution": 0.3, "pitch": 10,
    },
}  # fmt: skip


def told(**changes):
    return tabulate(prepare_content({**STUDY, **changes})).to_xarray()


@pytest.mark.parametrize("alpha", [0, "5 deg"])
def test_a_simulation_gives_derivatives_with_units_and_how_they_were_found(alpha):
    given = {**STUDY["parameters"], "alpha": alpha, "amplitude": ["0.1 mm", "0.105 mm"]}
    found = told(parameters=given, sensitivities=["beta", "gravity"])
    of_beta = found.derivative_conveying_velocity_by_beta
    assert of_beta.attrs["units"] == "m s-1 degree-1"
    assert of_beta.dims == ("amplitude",)
    ends = told(parameters={**given, "beta": [24.999, 25.001]}, sensitivities=False)
    step = ends.conveying_velocity.diff("beta").values[..., 0] / 2e-3
    np.testing.assert_allclose(of_beta, step, rtol=1e-6)
    exponent = found.sensitivity_conveying_velocity_to_beta
    np.testing.assert_allclose(exponent, of_beta * 25 / found.conveying_velocity, rtol=1e-12)
    assert (found.derivative_status_beta == STATUS["differences"]).all()
    assert "one_sided" in found.derivative_status_beta.attrs["flag_meanings"]
    error = found.derivative_conveying_velocity_by_beta_error
    assert error.attrs["units"] == "m s-1 degree-1"
    assert (error <= 1e-7 * abs(of_beta)).all()
    assert not [name for name in found if "motion_status_" in name]
    by_gravity = found.derivative_conveying_velocity_by_gravity
    assert by_gravity.attrs["units"] == "m s-1 m-1 s2"


@pytest.mark.parametrize(
    ("study", "words"),
    [
        ({**STUDY, "sensitivities": ["fricton"]}, "friction"),
        ({**STUDY, "sensitivities": []}, "a list of parameter names"),
        ({**STUDY, "sensitivities": "friction"}, r'such as \["friction"]'),
        ({**STUDY, "outputs": ["motion_status"]}, "no requested output has a derivative"),
        ({**STUDY, "parameters": {**STUDY["parameters"], "amplitude": {
            "start": 1e-4, "stop": 1e-3, "num": 600_000}}}, "2,400,000 derivatives"),
        ({**SWEEP, "reduce": {"over": ["amplitude"]}}, "combined with reduce"),
        ({**SWEEP, "sensitivities": ["length"]}, "no requested output depends on 'length'"),
        (TUMBLES, r"tumbl|has no period|not used"),
    ],
)  # fmt: skip
def test_what_cannot_be_derived_is_told(study, words):
    with pytest.raises(StudyError, match=words):
        prepare_content(study)


def test_a_parameter_of_the_regime_alone_is_no_parameter_of_an_output():
    study = {
        "kind": "sweep", "scene": "cone-on-plane",
        "outputs": ["cone_factor", "rolling_acceleration"],
        "parameters": {
            "frequency": 50, "amplitude": 1e-5, "beta": 20, "friction": 0.3, "height": 0.02,
            "diameter": 0.02, "small_diameter": 0.01, "axis_yaw": 80,
        },
    }  # fmt: skip
    derived = prepare_content({**study, "sensitivities": True}).derived
    assert "friction" not in derived.parameters
    assert "diameter" in derived.parameters
    with pytest.raises(StudyError, match="no requested output depends on 'friction'"):
        _ = prepare_content({**study, "sensitivities": ["friction"]}).derived


def test_a_sweep_is_derived_on_the_axes_that_each_output_has():
    found = tabulate(prepare_content(SWEEP)).to_xarray()
    exponent = found.sensitivity_throw_number_to_amplitude
    assert exponent.dims == ("amplitude", "beta")
    np.testing.assert_allclose(exponent, 1.0, rtol=1e-9)
    by_beta = found.derivative_throw_number_by_beta * found.throw_number**-1
    cotangent = np.radians(1 / np.tan(np.radians(found.beta)))
    np.testing.assert_allclose(by_beta, 0 * by_beta + cotangent, rtol=1e-9)
    assert (found.derivative_status_amplitude == STATUS["differences"]).all()


def test_a_sweep_with_derivatives_is_not_read_lazily():
    with pytest.raises(StudyError, match="cannot be computed cell by cell"):
        open_lazily(prepare_content(SWEEP))
