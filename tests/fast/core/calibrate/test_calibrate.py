"""Calibrations: what measured speeds tell of unknowns, against closed answers and dense grids."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from statistics import NormalDist

import numpy as np
import pytest
from matplotlib.text import Text

import vibrafeed
from vibrafeed.core.calibrate import calibration
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import load_study, parse_study, prepare_content
from vibrafeed.core.intake.forms import resolve_files
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.watch import Watch

ROOT = Path(__file__).parents[4]
DRIVE = {"frequency": "50 Hz", "beta": 40, "gamma": 2}
FRICTION = {"friction": {"lower": 0.05, "upper": 0.8}}


def study(observations, unknowns=FRICTION, parameters=DRIVE, points=1_000, **more):
    return {
        "kind": "calibrate", "scene": "rectangle-on-plane", "parameters": parameters,
        "observations": observations, "unknowns": unknowns, "points": points, **more,
    }  # fmt: skip


def speeds(friction, amplitudes, **more):
    found = vibrafeed.simulate(
        scene="rectangle-on-plane", **{**DRIVE, **more}, friction=friction, amplitude=amplitudes
    )
    return found.conveying_velocity.values.tolist()


def runs(friction, amplitudes, error=3e-4):
    return [
        {"amplitude": amplitudes, "conveying_velocity": speeds(friction, amplitudes),
         "error": error}
    ]  # fmt: skip


# --- a drive unit


UNIT = {"moving_mass": 10, "base_mass": 30}
FREQUENCIES = [40.0, 44.0, 47.0, 50.0, 52.0, 54.0, 56.0, 60.0]


@pytest.mark.parametrize("stiffness", ["ring_down_frequency", "spring_stiffness"])
def test_amplitudes_over_frequency_give_force_stiffness_and_damping(stiffness):
    truth = {"drive_force": 100.0, stiffness: 53.0, "damping_ratio": 0.02}
    if stiffness == "spring_stiffness":
        truth[stiffness] = 8e5
    scene = {"scene": "linear-drive-unit", **UNIT}
    variant = "measured" if stiffness == "ring_down_frequency" else "springs"
    found = vibrafeed.sweep(
        **scene, **truth, variant=variant, frequency=FREQUENCIES, outputs=["track_amplitude"]
    )
    noise = 1.0 + 0.02 * np.random.default_rng(0).standard_normal(len(FREQUENCIES))
    amplitudes = (found.track_amplitude.values * noise).tolist()
    told = vibrafeed.calibrate(
        **scene,
        observations={"frequency": FREQUENCIES, "track_amplitude": amplitudes, "error": "2 %"},
        unknowns={name: {"lower": 0.7 * one, "upper": 1.4 * one} for name, one in truth.items()},
        points=4_000,
    )
    for name, value in truth.items():
        away = float(told[f"best_{name}"]) - value
        assert abs(away) < 3.0 * float(told[f"deviation_{name}"]) < 0.2 * value


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"method": "events"}, "method: a drive unit has only closed forms"),
        ({"observations": [{"frequency": 50, "track_amplitude": 1e-4, "regime": "hops"}]},
         "observations row 1, regime: a drive unit has no regime of a part"),
        ({"observations": [{"frequency": 50, "conveying_velocity": 0.1}]},
         "observations: a drive unit has no conveying_velocity. Give the measured track_amplitude"),
        ({"parameters": {**UNIT, "amplitude": 1e-3}}, "amplitude is computed from the drive unit"),
    ],
)  # fmt: skip
def test_what_is_no_calibration_of_a_unit_is_refused(change, words):
    content = {
        **study([{"frequency": 50, "track_amplitude": 1e-4}], error="2 %"),
        "scene": "linear-drive-unit",
        "parameters": {**UNIT, "ring_down_frequency": 50, "damping_ratio": 0.02},
        "unknowns": {"drive_force": {"lower": 50, "upper": 200}},
        **change,
    }
    with pytest.raises(StudyError) as caught:
        prepare_content(content)
    assert words in str(caught.value)


FORCE = {"drive_force": {"lower": 50, "upper": 200}}


@pytest.fixture(scope="module")
def amplitudes():
    """Return amplitudes of a unit with 100 N, of which the fourth is read wrong by a half."""
    found = vibrafeed.sweep(
        scene="linear-drive-unit", variant="measured", **UNIT, ring_down_frequency=53,
        damping_ratio=0.02, drive_force=100, frequency=FREQUENCIES, outputs=["track_amplitude"],
    ).track_amplitude.values  # fmt: skip
    found *= 1.0 + 0.02 * np.random.default_rng(1).standard_normal(len(FREQUENCIES))
    found[3] *= 1.5
    return found.tolist()


@pytest.mark.parametrize("errors", [{}, {"error": "2 %"}])
def test_the_run_that_does_not_fit_is_named_and_counts_little_if_errors_have_tails(
    amplitudes, errors
):
    rows = {"frequency": FREQUENCIES, "track_amplitude": amplitudes, **errors}
    unit = {**UNIT, "ring_down_frequency": 53, "damping_ratio": 0.02}
    told = {
        likelihood: vibrafeed.calibrate(
            scene="linear-drive-unit", **unit, observations=rows, unknowns=FORCE, points=1_000,
            likelihood=likelihood,
        )
        for likelihood in ("normal", "student_t")
    }  # fmt: skip
    for one in told.values():
        sentence = one.findings.splitlines()[0]  # before the estimate that it spoils
        assert sentence.startswith("Run 4 does not fit: it is ")
        without = float(sentence.split("drive_force is ")[1].split(" N")[0])
        assert without == pytest.approx(100.0, abs=3.0)
    away = [abs(float(one.best_drive_force) - 100.0) for one in told.values()]
    assert away[1] < min(3.0, 0.5 * away[0])
    rows["track_amplitude"] = [*amplitudes[:3], amplitudes[3] / 1.5, *amplitudes[4:]]
    one = vibrafeed.calibrate(
        scene="linear-drive-unit", **unit, observations=rows, unknowns=FORCE, points=1_000
    )
    assert "does not fit" not in one.findings


# --- the measured set


RAIL = ROOT / "configs" / "calibrate-rail.toml"


@pytest.fixture(scope="module")
def unsettled():
    """Every fourth of the runs, and the mass unknown, too."""
    content = load_study(RAIL).content()
    some = {"observations": content["observations"][::4], "points": 1_000}
    return vibrafeed.calibrate({**content, **some})


def test_the_moving_mass_of_the_rail_is_what_the_data_cannot_settle(unsettled):
    assert unsettled.upper_95_mass > 2 * unsettled.lower_95_mass
    first, *others = unsettled.attrs["findings"].splitlines()
    assert "only the ratio friction / mass, 0." in "\n".join([first, *others])
    assert "best" not in first


# --- the posterior


def test_the_posterior_is_that_of_a_dense_grid():
    """Two unknowns by brute force: equal weights of 121 x 121 points, no leaf and no slope."""
    amplitudes = [1.2e-4, 1.6e-4, 2.4e-4, 3.1e-4]
    measured = np.array(speeds(0.31, [1.04 * a for a in amplitudes]))
    measured += np.array([1.1e-3, -0.4e-3, -1.3e-3, 0.9e-3])
    rows = [{"amplitude": amplitudes, "conveying_velocity": measured.tolist(), "error": 1e-3}]
    factors = {"amplitude": {"lower": 0.85, "upper": 1.25}}
    prepared = prepare_content(study(rows, factors=factors, discrepancy=False, points=8_000))
    found, count = tabulate(prepared).to_xarray(), 121
    ends = [(0.26, 0.36), (0.99, 1.09)]  # beyond them is next to nothing
    shares = (np.arange(count) + 0.5) / count
    axes = [low + shares * (high - low) for low, high in ends]
    points = np.array([*itertools.product(*axes)])
    value = prepared.model.predict(points, Watch()).value
    weight = np.exp(-0.5 * np.square((value - measured) / 1e-3).sum(axis=1))
    weight /= weight.sum()
    mean = weight @ points
    deviation = np.sqrt(weight @ np.square(points - mean))
    best = points[np.argmax(weight)]
    for k, name in enumerate(("friction", "factor_amplitude")):
        mass = weight.reshape(count, count).sum(axis=1 - k)
        low, high = np.interp((0.025, 0.975), np.cumsum(mass) - 0.5 * mass, axes[k])
        known = {"mean": mean[k], "deviation": deviation[k], "lower_95": low, "upper_95": high}
        for word, expected in known.items():
            assert found[f"{word}_{name}"] == pytest.approx(expected, abs=0.06 * deviation[k])
        assert float(found[f"density_{name}"].integrate(name)) == pytest.approx(1.0, abs=0.01)
        # The best values are those of least squares.
        step = (ends[k][1] - ends[k][0]) / count
        assert found[f"best_{name}"] == pytest.approx(best[k], abs=2 * step)
    both = ((points - mean).prod(axis=1) @ weight) / deviation.prod()
    assert found.correlation_friction_factor_amplitude == pytest.approx(both, abs=0.02)


def test_what_two_frictions_explain_has_two_modes():
    """Steep drives are fastest at some friction: every lower speed belongs to two."""
    (speed,) = speeds(0.29, [1e-4])
    found = vibrafeed.calibrate(
        study([{"amplitude": "0.1 mm", "conveying_velocity": speed, "error": "2 %"}],
              candidates={"amplitude": {"start": 1e-4, "stop": 4e-4, "num": 7}}),
    )  # fmt: skip
    one, other = sorted(found.mode_friction.values)
    assert one == pytest.approx(0.29, abs=1e-6)
    assert other > 0.45
    assert speeds(other, [1e-4])[0] == pytest.approx(speed, rel=1e-6)
    assert "The data cannot separate friction 0." in found.attrs["findings"]
    # What to run next is where both go different ways, and it settles which it is.
    gain, left = found.information, found.deviation_after_friction
    assert float(gain.max()) > max(0.9, 2 * float(gain[0]))
    assert float(left.min()) < 0.1 * float(found.deviation_friction)
    assert (left <= found.deviation_friction).all()
    assert "the 95 % interval of friction is expected to be 0." in found.attrs["findings"]
    best = [float(gain.candidate_amplitude[int(gain.values.argmax())])]
    slow, fast = sorted(speeds(mode, best)[0] for mode in (one, other))
    assert fast - slow > 0.05 * fast


def test_the_best_values_are_those_of_the_highest_density_and_not_of_the_heaviest_mode():
    """The speed falls slowly beyond its top, so that the mode there is wide, and heavy."""
    first, second = speeds(0.24, [1e-4, 3e-4])
    rows = [
        {"amplitude": "0.1 mm", "conveying_velocity": first, "error": "2 %"},
        {"amplitude": "0.3 mm", "conveying_velocity": second, "error": "15 mm/s"},
    ]
    with pytest.warns(UserWarning, match="run 1 has an error of 0.092 mm/s"):
        found = vibrafeed.calibrate(study(rows, discrepancy=False))
    heavy, light = found.mode_friction.values
    assert found.mode_share[0] > 0.55
    assert [light, float(found.best_friction)] == pytest.approx([0.24] * 2, abs=1e-6)
    assert heavy > 0.6
    assert np.abs(found.residual).max() < 1e-7


def test_a_flat_posterior_is_one_mode():
    content = study(
        [{"amplitude": "0.385 mm", "beta": 57.8, "conveying_velocity": "58.43 mm/s",
          "error": "0.35 mm/s"}],
        {"friction": {"lower": 0.05, "upper": 1.5}}, {"frequency": "50 Hz", "gamma": 2},
        points=20_000, discrepancy=False,
    )  # fmt: skip
    found = vibrafeed.calibrate(content)
    assert found.mode_share.values == pytest.approx([1.0])
    assert "say next to nothing about friction" in found.attrs["findings"]
    assert "cannot separate" not in found.attrs["findings"]


def test_intervals_with_a_discrepancy_are_those_of_half_a_cauchy_distribution():
    """One unknown by brute force: 3,001 frictions, 2,000 sizes of equal mass."""
    amplitudes = np.linspace(1e-4, 3.4e-4, 6).tolist()
    measured = np.array(speeds(0.3, amplitudes)) + 4e-4 * np.array([1, -1, 0.3, -0.8, 1.4, 0.6])
    prepared = prepare_content(
        study([{"amplitude": amplitudes, "conveying_velocity": measured.tolist(), "error": 3e-4}],
              points=4_000)
    )  # fmt: skip
    found = tabulate(prepared).to_xarray()
    friction = np.linspace(0.26, 0.34, 3_001)
    away = prepared.model.predict(friction[:, None], Watch()).value - measured
    square = np.square(away).sum(axis=1)
    sizes = 3e-4 * np.tan(np.pi / 2 * (np.arange(2_000) + 0.5) / 2_000)
    weight = 0.9 * np.exp(-0.5 * square / 3e-4**2)
    for size in sizes:
        share = 3e-4 / np.hypot(3e-4, size)
        weight += 0.1 / 2_000 * share**6 * np.exp(-0.5 * square * (share / 3e-4) ** 2)
    below = (np.cumsum(weight) - 0.5 * weight) / weight.sum()
    low, high = np.interp((0.025, 0.975), below, friction)
    assert found.lower_95_friction == pytest.approx(low, abs=0.01 * (high - low))
    assert found.upper_95_friction == pytest.approx(high, abs=0.01 * (high - low))


def test_a_share_of_a_speed_near_0_is_an_error_that_outweighs_all_others():
    amplitudes = [1e-4, 2e-4, 3e-4]
    value = [-1.2e-5, *speeds(0.3, amplitudes[1:])]
    row = {"amplitude": amplitudes, "conveying_velocity": value}
    (question,) = prepare_content(study([{**row, "error": "5 %"}])).questions
    assert question.startswith("run 1 has an error of 0.0006 mm/s, and the other runs of about ")
    assert not prepare_content(study([{**row, "error": "0.5 mm/s"}])).questions


def test_what_a_measurement_leaves_is_that_of_the_normal_distribution():
    """A speed that is linear in a normal unknown: sigma s / sqrt(s^2 + a^2 sigma^2) is left."""
    count, sigma, slope = 2_000, 0.02, 0.3
    normal = NormalDist(0.3, sigma)
    unknown = np.array([normal.inv_cdf(share) for share in (np.arange(count) + 0.5) / count])
    other = np.random.default_rng(1).permutation(unknown)  # which the speed does not tell
    points = np.stack([unknown, other], axis=1)
    error = np.array([0.001, 0.006, 0.03])
    value = np.broadcast_to(slope * unknown[:, None], (count, 3))
    ratio = slope * sigma / error
    gain, (told, kept) = calibration._information_gain(value, np.tile(error, (count, 1)), points)
    np.testing.assert_allclose(told, 1 / np.sqrt(1 + ratio**2), rtol=0.01)
    np.testing.assert_allclose(gain, 0.5 * np.log2(1 + ratio**2), rtol=0.01)
    assert (kept > 0.9).all()
    # Half of the points have no speed there: they keep what they had.
    value = np.where(np.arange(count)[:, None] % 2, np.nan, value)
    _, (told, _) = calibration._information_gain(value, np.tile(error, (count, 1)), points)
    np.testing.assert_allclose(told, np.sqrt(0.5 + 0.5 / (1 + ratio**2)), rtol=0.02)


def test_a_discrepancy_is_found_where_errors_do_not_explain_the_speeds():
    amplitudes = np.linspace(1e-4, 4e-4, 6).tolist()
    away = 3e-3 * np.array([1, -1, 0.5, -1.5, 1.2, -0.6])
    value = (np.array(speeds(0.3, amplitudes)) + away).tolist()
    rows = [{"amplitude": amplitudes, "conveying_velocity": value, "error": 3e-4}]
    found = vibrafeed.calibrate(study(rows))
    assert found.discrepancy_probability > 0.99
    assert found.discrepancy_lower_95 < 3e-3 < found.discrepancy_upper_95
    assert "(more than 99 % likely); no unknown" in found.attrs["findings"]
    without = vibrafeed.calibrate(study(rows, discrepancy=False))
    assert without.deviation_friction < 0.3 * found.deviation_friction
    explained = vibrafeed.calibrate(study(runs(0.3, [1e-4, 2e-4])))
    assert explained.best_friction == pytest.approx(0.3, abs=1e-7)
    assert explained.discrepancy_probability < 0.1
    assert without.discrepancy == explained.discrepancy == 0


def test_what_was_seen_tells_friction_without_a_speed():
    """A part that a weak drive does not start: friction above the push over the weight."""
    seen = {"5e-5 m": "does not start", "8e-5 m": "moves forwards"}
    rows = [{"amplitude": amplitude, "regime": word} for amplitude, word in seen.items()]
    unknown, drive = {"friction": {"lower": 0.1, "upper": 1.0}}, {"frequency": 50, "beta": 20}
    found = vibrafeed.calibrate(study(rows, unknown, drive, points=2_000))
    # No start up to friction (g - P sin(beta)) = P cos(beta), P = A w^2.
    push = np.array([5e-5, 8e-5]) * (2 * np.pi * 50) ** 2
    least, most = push * np.cos(np.pi / 9) / (9.80665 - push * np.sin(np.pi / 9))
    assert least < found.lower_68_friction < found.upper_68_friction < most
    assert (found.probability_of_seen > 0.95).all()
    wrong = vibrafeed.calibrate(study([{**rows[0], "regime": "hops"}], unknown, drive))
    assert "Not as it was seen: run 1 (hops)" in wrong.attrs["findings"]


def test_the_spread_of_motion_that_does_not_repeat_is_an_error_of_its_own():
    drive = {"frequency": 50, "beta": 30, "restitution": 0.8}
    row = {"amplitude": "0.6 mm", "conveying_velocity": 0.1, "error": 1e-5}
    model = prepare_content(study([row], parameters=drive)).model
    names = ["conveying_velocity_spread", "conveying_velocity_error"]
    alone = vibrafeed.simulate(
        scene="rectangle-on-plane", friction=0.3, amplitude="0.6 mm", **drive, outputs=names
    )
    spread, error = (float(alone[name]) for name in names)
    assert spread > 1e-4
    variance = model.predict(np.array([[0.3]]), Watch()).variance[0, 0]
    assert variance == pytest.approx(spread**2 + error**2)


def test_static_friction_is_never_below_the_kinetic_one():
    names = ("friction_static", "friction_kinetic")
    both = dict.fromkeys(names, FRICTION["friction"])
    found = vibrafeed.calibrate(study(runs(0.3, [5e-5, 1e-4, 2e-4]), both, points=1_500))
    density = np.exp(found.log_density)
    below = density.where(found.friction_static < found.friction_kinetic - 1e-12, 0.0)
    assert float(below.max()) < 1e-200
    assert found.lower_95_friction_static > found.lower_95_friction_kinetic


def test_feed_rates_calibrate_as_their_speeds_do():
    amplitudes = [1e-4, 2e-4, 3e-4]
    rates = [60 * v / 0.012 for v in speeds(0.3, amplitudes)]
    rows = [{"amplitude": amplitudes, "feed_rate": rates, "error": "1 %"}]
    row = {**DRIVE, "length": "10 mm", "part_gap": "2 mm"}
    found = vibrafeed.calibrate(study(rows, parameters=row))
    assert found.best_friction == pytest.approx(0.3, abs=1e-7)
    assert found.predicted_best.units == "min-1"


def test_a_prior_counts():
    rows = [{"amplitude": "0.2 mm", "conveying_velocity": 0.02, "error": 0.5}]  # tells nothing
    found = vibrafeed.calibrate(study(rows, {"friction": {"mean": 0.3, "deviation": 0.04}}))
    assert found.mean_friction == pytest.approx(0.3, abs=1e-3)
    assert found.deviation_friction == pytest.approx(0.04, rel=0.02)
    assert "say next to nothing about friction" in found.attrs["findings"]


SPAN = {"lower": 0.1, "upper": 0.5}


MEASURED = [{"amplitude": "0.1 mm", "conveying_velocity": "3 mm/s", "error": 3e-4}]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"unknowns": {"friction": {"median": 0.3, "factor": 1.2}}},
         "friction is neither a range nor a normal distribution. Write { lower"),
        ({"unknowns": dict.fromkeys(("friction_static", "friction_kinetic", "restitution"), SPAN),
          "offsets": {angle: {"lower": -1, "upper": 1} for angle in ("beta", "gamma")}},
         "unknowns: the study has 5 unknowns"),
        ({"observations": [{"amplitude": [1e-4, 2e-4], "conveying_velocity": [0.01, 0.02]}]},
         "error: the error of the measured values is not given, and 2 runs are too few"),
        ({"offsets": {"amplitude": {"lower": -1, "upper": 0}}},
         "offsets.amplitude: its range lets amplitude go below 0 m"),
    ],
)  # fmt: skip
def test_what_cannot_be_calibrated_is_refused(change, words):
    (told,) = problems({**study(MEASURED), **change})
    assert words in told


# --- what is wrong


def problems(content, **more):
    with pytest.raises(StudyError) as error:
        prepare_content({**content, **more})
    return [str(problem) for problem in error.value.problems]


def test_every_wrong_cell_is_told_with_its_row_and_column():
    rows = [
        {"amplitude": "0.1 mm", "conveying_velocity": "3 mm/s", "error": "5 %"},
        {"amplitude": "0.1 mmm", "conveying_velocity": "fast", "error": "5 %"},
        {"amplitud": "0.1 mm", "conveying_velocity": "3 mm/s", "error": "-5 %"},
        {"amplitude": "0.1 mm", "regime": "hop"},
    ]
    told = problems(study(rows))
    assert [line.split(":")[0] for line in told[:5]] == [
        "observations row 2, amplitude", "observations row 2, conveying_velocity",
        "observations row 3, error", "observations row 3, amplitud", "observations row 4, regime",
    ]  # fmt: skip
    assert "Did you mean 'amplitude'?" in told[3]
    assert "Did you mean 'hops'?" in told[4]


def test_a_study_as_a_whole_is_told_all_its_problems():
    rows = [
        {"amplitude": "0.1 mm", "frequency": 50, "conveying_velocity": "3 mm/s", "error": "1 mm/s"},
        {"frequency": 50, "conveying_velocity": "3 mm/s"},
        {"amplitude": "0.1 mm", "frequency": 50},
    ]
    told = "\n".join(
        problems(
            study(rows, {"beta": {"lower": 0, "upper": 5}}), verify=3, tolerance=1e-9,
            parameters={**DRIVE, "gamma": [1, 2]},
            offsets={"alpha": {"lower": -1, "upper": 1}},
            factors={"amplitude": {"lower": 0.5, "upper": 2}},
            candidates={"beta": [1, 2]},
        )
    )  # fmt: skip
    for line in (
        "verify: a calibration cannot be verified",
        "parameters.gamma: gamma has several values",
        "observations row 2, amplitude: this run has no amplitude",
        "observations row 2, error: this run has no error",
        "observations row 3: this run has no measured value",
        "parameters.frequency: frequency is given twice",
        "unknowns.beta: beta is an unknown, but the parameters give its value",
        "offsets.alpha: [offsets] changes alpha, which has no value",
        "candidates.beta: all runs share beta",
    ):
        assert line in told


def test_its_cost_is_known_beforehand():
    more = {"amplitude": [1e-4, 2e-4]}
    prepared = prepare_content(study(runs(0.3, [1e-4, 2e-4]), points=2_000, candidates=more))
    assert prepared.cells == 2_000 * 2 + 300 * 2
    assert tabulate(prepared).attributes["motions_followed"] <= prepared.cells
    assert prepared.seconds > 0


def test_a_study_is_the_same_after_a_round_through_its_canonical_form():
    one = parse_study(study(
        MEASURED, factors={"amplitude": {"mean": 1, "deviation": 0.1}},
        candidates={"amplitude": {"start": 1e-4, "stop": 4e-4, "num": 4}},
    ))  # fmt: skip
    assert parse_study(one.content()) == one
    assert parse_study(one.content()).key() == one.key()


# --- files of observations

LINES = """# by hand, 3 March
amplitude [mm];conveying_velocity [mm/s];error;regime
0,1;6,5;5 %;
0,2;;;hops
"""


def test_observations_stand_in_a_csv_beside_the_study(tmp_path):
    (tmp_path / "runs.csv").write_text(LINES, encoding="utf-8-sig")
    path = tmp_path / "study.json"
    path.write_text(json.dumps(study("runs.csv")))
    found = [
        (run.amplitude, run.conveying_velocity, run.error, run.regime)
        for run in load_study(path).observations
    ]
    speed = 6.5e-3
    assert found[0] == pytest.approx((1e-4, speed, 0.05 * speed, None))
    assert (found[1][1], found[1][3]) == (None, "hops")
    sent = resolve_files(study(str(tmp_path / "runs.csv")), "curl", tmp_path)["observations"]
    assert sent[0] == {"amplitude": "0.1 mm", "conveying_velocity": "6.5 mm/s", "error": "5 %"}
    kept = resolve_files(study(str(tmp_path / "runs.csv")), "toml", tmp_path)
    assert kept["observations"] == "runs.csv"


def test_observations_stand_in_a_workbook(tmp_path):
    book = pytest.importorskip("openpyxl").Workbook()
    for line in (["amplitude [mm]", "conveying_velocity [mm/s]"], [0.1, 6.5], [0.2, None]):
        book.active.append(line)
    book.save(tmp_path / "runs.xlsx")
    content = study(str(tmp_path / "runs.xlsx"), error="5 %")
    for files, words in (
        (False, "observations: the service cannot read files. Send the rows as a list of objects."),
        (True, "observations row 2: this run has no measured value"),
    ):
        with pytest.raises(StudyError) as error:
            prepare_content(content, files=files)
        (problem,) = error.value.problems
        assert str(problem).startswith(words)


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("runs.csv", "0.1,0.2\n0.3,0.4\n", "has no row of column names"),
        ("runs.csv", "amplitude [mm]\n", "has no numbers"),
        ("runs.csv", "amplitude,amplitude\n1,2\n", "two columns have the name 'amplitude'"),
        ("runs.txt", "", "the table is empty"),
        ("none.csv", None, "cannot be read"),
        ("runs.xlsx", "no workbook", "runs.xlsx is damaged, or is not a file of its kind"),
    ],
)
def test_a_file_that_holds_no_observations_is_told(tmp_path, name, text, told):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(StudyError, match=told):
        prepare_content(study(str(tmp_path / name)), files=True)


# --- pictures


@pytest.mark.parametrize("kind", [None, "posterior"])
def test_pictures_of_a_calibration_are_drawn(unsettled, kind):
    figure = vibrafeed.plot(unsettled, kind=kind, small=kind is None)
    figure.draw_without_rendering()
    texts = [text.get_text() for text in figure.findobj(Text)]
    assert {"Friction coefficient", "Part mass (kg)"} <= {*texts}


def test_other_pictures_are_not_those_of_a_calibration(unsettled):
    with pytest.raises(PlotError, match="cannot be drawn as kind contour"):
        vibrafeed.plot(unsettled, kind="contour")
    point = {**DRIVE, "friction": 0.3, "amplitude": [1e-4, 2e-4]}
    with pytest.raises(PlotError, match="has no posterior"):
        vibrafeed.plot(vibrafeed.simulate(scene="rectangle-on-plane", **point), kind="posterior")
