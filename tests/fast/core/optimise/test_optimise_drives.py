"""Any number of a drive as a variable of an optimisation, and what is said of wrong ones."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.best_wave import harmonics, known_best, motions, steps, study
from night import spread
from point_slopes import motion_sensitivities
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import load_study, parse_study, prepare_content
from vibrafeed.core.kinds import run_study
from vibrafeed.core.optimise.optima import designs_of
from vibrafeed.core.optimise.prepare import prepare

CONFIGS = Path(__file__).parents[4] / "configs"
PARAMETERS = study()["parameters"]


def problems(**changes: Any) -> dict[str, str]:
    with pytest.raises(StudyError) as caught:
        prepare_content(study(variables=steps(3)) | changes)
    return {problem.place: f"{problem.message}. {problem.fix}" for problem in caught.value.problems}


@pytest.mark.parametrize("count", spread([3, 4], 1))
def test_free_switching_times_find_the_fastest_wave(count: int) -> None:
    found = run_study(parse_study(study(variables=steps(count))))
    assert 1 - 1e-6 < float(found.share_of_fastest) < 1 + 1e-9
    assert float(found.largest_acceleration_along) <= 30 * (1 + 1e-12)
    assert found.binds_largest_acceleration_along_upper == 1


def test_the_best_phase_of_a_normal_drive() -> None:
    content = study(constraints=[], outputs=["throw_number"])
    content["variables"] = {"phase_normal_1": {"lower": "-180 deg", "upper": "180 deg"}}
    amplitudes = {"amplitude_along_1": 2e-4, "amplitude_normal_1": 8e-5}
    content["parameters"] = PARAMETERS | amplitudes
    found = run_study(parse_study(content))
    phases = np.linspace(-np.pi, np.pi, 721)
    given = {name: np.full_like(phases, value) for name, value in content["parameters"].items()}
    looked = motions(("conveying_velocity",), {**given, "phase_normal_1": phases})
    best = looked["conveying_velocity"]
    assert float(found.objective) >= best.max() * (1 - 1e-9)
    at = np.deg2rad(float(found.best_phase_normal_1))
    assert abs(at - phases[best.argmax()]) < 0.02


@pytest.mark.night
def test_a_stroke_is_kept() -> None:
    limits = [
        {"output": "stroke_along", "upper": 1e-4},
        {"output": "largest_jerk_along", "upper": 2e4},
    ]
    found = run_study(parse_study(study(variables=harmonics(2), constraints=limits)))
    assert float(found.stroke_along) <= 1e-4 * (1 + 1e-9)
    assert float(found.largest_jerk_along) <= 2e4 * (1 + 1e-9)
    assert float(found.objective) > 0


@pytest.mark.night
def test_the_robust_wave_does_better_in_the_worst_case() -> None:
    found = run_study(load_study(CONFIGS / "optimise-robust-steps.toml"))
    friction = np.linspace(0.36, 0.44, 201)
    given = {name: np.full_like(friction, value) for name, value in
             {**known_best(0.4, 0.4), "frequency": 50.0, "gravity": 9.81}.items()}  # fmt: skip
    nominal = motions(("conveying_velocity",), {**given, "friction": friction})
    assert float(found.objective) > 1.01 * nominal["conveying_velocity"].min()
    assert "worst case over friction from 0.36 to 0.44" in found.attrs["criterion"]


def test_the_worst_case_is_that_of_every_value_by_itself() -> None:
    prepared = prepare(load_study(CONFIGS / "optimise-robust-steps.toml"))
    problem, design = prepared.problem, designs_of(prepared.problem, prepared.designs)
    x = problem.lower[:, None] + np.random.default_rng(2).random((4, 50)) * (
        problem.upper - problem.lower
    ).reshape(-1, 1)
    found, beyond, _ = problem.judged(x, design, problem.scales(design))
    alone = []
    assert problem.uncertain is not None
    for friction in problem.uncertain.values["friction"]:
        known = problem.known(x, {**design, "friction": np.array([friction])})
        alone.append(problem.objective(known))
    worst = np.min(alone, axis=0)
    sound = np.isfinite(worst)
    assert sound.sum() > 20
    np.testing.assert_array_equal(found[sound], worst[sound])
    assert found.shape == beyond.shape == (50,)


def test_sensitivities_of_a_wave() -> None:
    point = {**known_best(0.5, 0.4), "frequency": 50.0, "gravity": 9.81}
    point |= {"friction_static": 0.6, "friction_kinetic": 0.39}
    told = motion_sensitivities(
        "rectangle-on-plane", None, ["conveying_velocity"], point, ["frequency"]
    )
    # v/(g/w) depends on accelerations over gravity, durations and friction alone.
    assert told["conveying_velocity", "frequency"].logarithmic == pytest.approx(-1, abs=1e-6)


# --- what is said of wrong ones


def test_two_kinds_of_drive_are_told_once_where_they_stand() -> None:
    mixed = {**steps(3), "amplitude_along_2": {"lower": 0, "upper": "1 mm"}}
    told = problems(variables=mixed)
    assert list(told) == ["variables.acceleration_along_1"]
    assert "also gives harmonics" in told["variables.acceleration_along_1"]
    told = problems(parameters={**PARAMETERS, "amplitude_along_2": "1 mm"})
    assert list(told) == ["variables.acceleration_along_1"]


def test_closed_forms_of_the_plain_sine_are_told() -> None:
    told = problems(criterion={"kind": "maximise", "output": "acceleration_x"})
    assert "closed form of the plain sine" in told["criterion.output"]


def test_the_plain_amplitude_beside_steps_is_of_another_drive() -> None:
    told = problems(parameters={**PARAMETERS, "amplitude": 1e-3})
    assert "belongs to the plain sine" in told["parameters.amplitude"]


def test_an_axis_lacks_its_other_levels() -> None:
    told = problems(parameters={**PARAMETERS, "acceleration_normal_1": 1.0})
    assert {"parameters.acceleration_normal_2", "parameters.acceleration_normal_3"} == set(told)


def test_there_are_at_most_eight_variables() -> None:
    assert problems(variables=steps(6)) == {"variables": "there are 10 of them. Choose at most 8"}


def test_an_unsound_study_knows_its_variables_and_what_is_uncertain() -> None:
    told = problems(
        title=3,
        uncertain={"friction": {"lower": 0.3, "upper": 0.5}},
        parameters={"frequency": 50.0},
    )
    assert list(told) == ["title"]
