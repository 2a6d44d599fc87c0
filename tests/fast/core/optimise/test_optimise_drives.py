"""Any number of a drive as a variable of an optimisation, and what is said of wrong ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.best_wave import motions, steps, study
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import load_study, parse_study, prepare_content
from vibrafeed.core.kinds import run_study
from vibrafeed.core.optimise.optima import designs_of
from vibrafeed.core.optimise.prepare import prepare

CONFIGS = Path(__file__).parents[4] / "configs"
PARAMETERS = study()["parameters"]


def test_the_best_phase_of_a_normal_drive() -> None:
    content = study(constraints=[], outputs=["throw_number"])
    content["variables"] = {"phase_normal_1": {"lower": "-180 deg", "upper": "180 deg"}}
    content["parameters"] = PARAMETERS | {"amplitude_along_1": 2e-4, "amplitude_normal_1": 8e-5}
    found = run_study(parse_study(content))
    phases = np.linspace(-np.pi, np.pi, 181)
    given = {name: np.full_like(phases, value) for name, value in content["parameters"].items()}
    best = motions(("conveying_velocity",), {**given, "phase_normal_1": phases})
    velocity = best["conveying_velocity"]
    assert float(found.objective) >= velocity.max() * (1 - 1e-9)
    at = np.deg2rad(float(found.best_phase_normal_1))
    assert abs(at - phases[velocity.argmax()]) < 0.05


def test_the_worst_case_is_that_of_every_value_by_itself() -> None:
    prepared = prepare(load_study(CONFIGS / "optimise-robust-steps.toml"))
    problem, design = prepared.problem, designs_of(prepared.problem, prepared.designs)
    lower, upper = problem.lower[:, None], problem.upper[:, None]
    x = lower + np.random.default_rng(2).random((4, 50)) * (upper - lower)
    found, *_ = problem.judged(x, design, problem.scales(design))
    alone = [
        problem.objective(problem.known(x, {**design, "friction": np.array([friction])}))
        for friction in problem.uncertain.values["friction"]
    ]
    worst = np.min(alone, axis=0)
    sound = np.isfinite(worst)
    assert sound.sum() > 20
    np.testing.assert_array_equal(found[sound], worst[sound])


@pytest.mark.parametrize(
    ("changes", "problems"),
    [
        ({"variables": {**steps(3), "amplitude_along_2": {"lower": 0, "upper": "1 mm"}}},
         {"variables.acceleration_along_1": "also gives harmonics"}),
        ({"parameters": {**PARAMETERS, "amplitude_along_2": "1 mm"}},
         {"variables.acceleration_along_1": "also gives harmonics"}),
        ({"criterion": {"kind": "maximise", "output": "acceleration_x"}},
         {"criterion.output": "closed form of the plain sine"}),
        ({"parameters": {**PARAMETERS, "amplitude": 1e-3}},
         {"parameters.amplitude": "belongs to the plain sine"}),
        ({"parameters": {**PARAMETERS, "acceleration_normal_1": 1.0}},
         {"parameters.acceleration_normal_2": "", "parameters.acceleration_normal_3": ""}),
        ({"variables": steps(6)}, {"variables": "there are 10 of them. Choose at most 8"}),
        # An unsound study knows its variables and what is uncertain.
        ({"title": 3, "uncertain": {"friction": {"lower": 0.3, "upper": 0.5}},
          "parameters": {"frequency": 50.0}}, {"title": ""}),
    ],
)  # fmt: skip
def test_what_is_said_of_wrong_drives(changes, problems) -> None:
    with pytest.raises(StudyError) as caught:
        prepare_content(study(variables=steps(3)) | changes)
    told = {problem.place: f"{problem.message}. {problem.fix}" for problem in caught.value.problems}
    assert told.keys() == problems.keys()
    assert all(words in told[place] for place, words in problems.items())
