"""Cells at which a method, a search or a posterior has been wrong, with what is right there.

Those of waves are in `test_planar_means.py`, of derivatives in `test_motion_derivatives.py`.
"""

import warnings

import numpy as np
import pytest

import vibrafeed
from vibrafeed.core.quantities import MOTION_STATUSES, REGIMES

LEVEL = {"scene": "rectangle-on-plane", "frequency": 50, "friction": 0.5}
MEAN = ["conveying_velocity", "conveying_velocity_error", "period_multiple"]


def moved(**parameters):
    """Return mean velocity [m/s], its error, multiple and status of one part; no warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", ".*usual values are")
        found = vibrafeed.simulate(**parameters, outputs=MEAN)
    names = {flag.value: name for name, flag in MOTION_STATUSES.items()}
    return *(float(found[output]) for output in MEAN), names[int(found.motion_status)]


# --- methods


@pytest.mark.parametrize("method", ["events", "reference"])
@pytest.mark.parametrize("beta", [90, -90])
def test_a_part_that_is_only_lifted_goes_nowhere(method, beta):
    """The reference divided 0 by 0 and told `aperiodic`."""
    part = {**LEVEL, "amplitude": "0.25 mm", "beta": beta}
    velocity, error, multiple, status = moved(**part, method=method)
    assert (status, multiple) == ("periodic", 1)
    assert abs(velocity) <= error + 1e-15


@pytest.mark.parametrize("method", ["events", "reference"])
def test_a_drive_beyond_all_numbers_has_no_mean(method):
    """The reference did not return."""
    velocity, _, _, status = moved(**LEVEL, amplitude=1e200, beta=30, method=method)
    assert status == "limit_reached"
    assert np.isnan(velocity)


@pytest.mark.parametrize(
    ("friction", "right"),
    [(1e-2, 4.10), (3e-3, 3.58), (1e-3, 3.43), (1e-4, 3.36), (1e-9, 3.353)],
)
def test_a_part_that_long_loses_its_first_speed_has_a_mean(friction, right):
    """Right [mm/s]: by an own solver."""
    part = {**LEVEL, "friction": friction, "amplitude": "0.25 mm", "beta": 30}
    velocity, _, _, status = moved(**part)
    assert status == "periodic"
    assert 1e3 * velocity == pytest.approx(right, abs=6e-3)


# --- numbers at the end of floats


@pytest.mark.parametrize(("max_periods", "most"), [(60, 0.05), (11, 1.0)])
def test_a_part_on_its_way_to_the_wall_does_not_repeat(max_periods, most):
    """It hops alike while it nears the wall, at 82.7 mm/s; its mean over 2000 periods is 91.4."""
    velocity, error, _, status = moved(
        scene="rectangle-on-track", frequency=33, amplitude="1.32 mm", alpha=18, beta=17, gamma=-1,
        delta=14, friction=0.6, restitution=0.2, radius=0.8, method="reference",
        max_periods=max_periods,
    )  # fmt: skip
    assert status == "aperiodic"
    assert abs(velocity - 0.0914) < error < most


def test_a_reference_on_its_way_has_no_mean():
    """It told 23.757 +- 0.010 mm/s; right is 23.7885049, as followed on."""
    part = {
        "scene": "rectangle-on-track", "frequency": 94.77336081655253,
        "amplitude": 0.24976347661458185e-3, "beta": 15.821811376990269,
        "alpha": -23.300678233595903, "delta": 29.684382450095644,
        "radius": 0.2571147638571506, "friction": 0.6647636435674749,
    }  # fmt: skip
    early, _, _, status = moved(**part, method="reference")
    assert np.isnan(early)
    assert status == "limit_reached"


TRACK = {"scene": "rectangle-on-track", "frequency": 50}


@pytest.mark.parametrize(
    ("speed", "multiple", "part"),
    [
        (7.207885088146, 4,
         {"friction": 0.2, "alpha": -10, "beta": 20, "amplitude": "0.2 mm"}),
        (14.87615061775, 4,
         {"friction": 0.3, "alpha": 20, "beta": 20, "delta": 5, "amplitude": "0.25 mm"}),
        (10.48269781213, 4,
         {"friction": 0.4, "alpha": 5, "beta": 10, "delta": 2, "amplitude": "0.1 mm",
          "frequency": 100}),
        (18.36869230019, 1,
         {"friction": 0.02, "alpha": 10, "beta": 30, "delta": 5, "gamma": -0.344,
          "amplitude": "0.12 mm"}),
        (23.7885049, 2,
         {"frequency": 94.77336081655253, "amplitude": 0.24976347661458185e-3,
          "beta": 15.821811376990269, "alpha": -23.300678233595903, "delta": 29.684382450095644,
          "radius": 0.2571147638571506, "friction": 0.6647636435674749}),
    ],
)  # fmt: skip
def test_jumps_that_never_let_a_part_arrive(speed, multiple, part):
    """Told `aperiodic`, and up to 11 % off, before. Right [mm/s]: by the method `reference`."""
    velocity, error, *told = moved(**{**TRACK, **part})
    assert told == [multiple, "periodic"]
    assert abs(velocity - 1e-3 * speed) <= error + 5e-11
    assert error <= 1e-7


@pytest.mark.parametrize("friction", [1e-3, 1e-4, 1e-9])
def test_a_part_that_is_still_losing_speed_has_no_mean_yet(friction):
    """21.8 to 67.0 mm/s were told; 5.80 is right at 1e-3 (`reference`), 6.15 at 1e-4 by steps."""
    part = {"friction": friction, "alpha": 10, "beta": 30, "delta": 5, "amplitude": "0.25 mm"}
    velocity, _, _, status = moved(**TRACK, **part)
    assert np.isnan(velocity) == (status == "limit_reached")
    assert np.isnan(velocity) or velocity == pytest.approx(5.9e-3, abs=0.4e-3)


@pytest.mark.parametrize(
    ("across", "regime", "part"),
    [
        (4.474117741865, "wall_lost",
         {"friction": 0.3, "alpha": 20, "beta": 25, "delta": 2, "amplitude": "0.3 mm"}),
        (9.224367157722, "wall_lost",
         {"friction": 0.4, "alpha": 18.5, "beta": 30, "delta": 11, "amplitude": "0.4 mm"}),
        (0.0, "period_doubled",
         {"friction": 0.3, "alpha": 10, "beta": 25, "delta": 5, "amplitude": "0.2 mm"}),
        (4.712567625805, None, {"scene": "rectangle-on-plane", "friction": 0.3, "alpha": 20,
                                "beta": 20, "amplitude": "0.2 mm"}),
        (-4.712567625805, None, {"scene": "rectangle-on-plane", "friction": 0.3, "alpha": -20,
                                 "beta": 20, "amplitude": "0.2 mm"}),
    ],
)  # fmt: skip
def test_a_part_that_leaves_the_wall_for_good_says_so(across, regime, part):
    """By the velocity across [mm/s; right: `reference`], and by the regime."""
    found = vibrafeed.simulate(**{**TRACK, **part}, outputs=["velocity_across"])
    assert regime is None or int(found.regime) == REGIMES[regime].value
    assert float(found.velocity_across) == pytest.approx(1e-3 * across, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("restitution", [0.999, 1.0])
def test_the_fastest_landing_is_the_free_fall_of_the_highest_hop(restitution):
    """sqrt(2 g (H +- 2a)) +- a w, a the amplitude normal to the track, whatever the run of hops."""
    g, w, turn = 9.80665, 2 * np.pi * 50, np.radians(30)
    amplitude = 2.0 * g / (w * w * np.sin(turn))
    found = vibrafeed.simulate(
        **LEVEL, beta=30, gravity=g, amplitude=amplitude, restitution=restitution,
        outputs=["landing_speed", "hop_height"],
    )  # fmt: skip
    height, a = float(found.hop_height), amplitude * np.sin(turn)
    least, most = (np.sqrt(2 * g * (height + 2 * way * a)) + way * a * w for way in (-1, 1))
    assert int(found.motion_status) == MOTION_STATUSES["aperiodic"].value
    assert least <= float(found.landing_speed) <= most


@pytest.mark.parametrize("variant", ["thesis", "derived", "physical"])
@pytest.mark.parametrize(
    "scene", ["rectangle-on-plane", "cylinder-on-plane", "rectangle-on-track"]
)  # fmt: skip
def test_a_drive_too_large_for_a_float_is_data_and_no_warning(scene, variant):
    """An infinite acceleration is flight, as that just below is: no cell becomes valid."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", ".*usual values are")
        found = vibrafeed.sweep(
            scene=scene, variant=variant, frequency=50, amplitude=[1e300, 1e308, 1.7e308],
            beta=[30, 60], friction=0.5, alpha=10, outputs=["acceleration_x", "throw_number"],
        )  # fmt: skip
    assert np.isfinite(found.throw_number[0]).all()
    assert np.isposinf(found.throw_number[1:]).all()
    flying = [REGIMES[name].value for name in ("flight", "flight_and_wall_lost")]
    assert np.isin(found.regime, flying).all()


# --- searches and reductions


def test_a_limit_that_nothing_keeps_is_infeasible():
    """Each choice moves the part; the least |a_y| is 10.4 m/s^2."""
    found = vibrafeed.optimise({
        "kind": "optimise", "scene": "rectangle-on-plane", "variant": "physical",
        "method": "search",
        "criterion": {"kind": "limit", "limit": "2.17 m/s^2"},
        "variables": {"alpha": {"lower": 6, "upper": 72}, "beta": {"lower": 0, "upper": 90}},
        "parameters": {
            "frequency": 96.84, "amplitude": "0.29 mm", "friction": 0.7646, "gamma": 7.67,
        },
    })  # fmt: skip
    assert found.attrs["message"].startswith("infeasible: no choice satisfies")


# --- calibrations


def test_a_speed_with_its_unit_forgotten_has_one_mode_at_the_edge():
    """It was 0.461 to 0.461, and "cannot tell friction 0.6 (98 %) from friction 0.6 (2 %)"."""
    found = vibrafeed.calibrate({
        "kind": "calibrate", "scene": "rectangle-on-plane", "discrepancy": False,
        "parameters": {"frequency": 50, "beta": 20, "gamma": 0},
        "observations": [{"amplitude": 2e-4, "conveying_velocity": 5.0, "error": 1e-6}],
        "unknowns": {"friction": {"lower": 0.05, "upper": 0.6}},
    })  # fmt: skip
    assert found.mode_friction.size == 1
    for name in ("best_friction", "lower_95_friction", "upper_95_friction"):
        assert float(found[name]) == pytest.approx(0.6, abs=1e-6)
    assert "cannot tell" not in found.attrs["findings"]
