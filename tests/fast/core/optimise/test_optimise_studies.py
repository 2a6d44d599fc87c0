"""Studies of optimisation, also of any number of a drive, and what is said of wrong ones."""

from pathlib import Path

import numpy as np
import pytest

import vibrafeed
from benchmarks.best_wave import motions, steps, study
from refusals import told_of
from vibrafeed.core.intake import load_study, parse_json, parse_study, prepare_content
from vibrafeed.core.kinds import run_study
from vibrafeed.core.optimise.optima import designs_of
from vibrafeed.core.optimise.prepare import prepare

# The data of figure 5.1 of the source, less strong: below lift-off at the best angles.
DATA = {"frequency": 60, "amplitude": "0.1 mm", "friction": 0.5, "gravity": 9.8}
SEVEN = ("friction", "gamma", "amplitude", "frequency", "gravity", "alpha", "beta")
RANGE = {"lower": 0.3, "upper": 0.5}
UNSURE = {
    "parameters": {name: value for name, value in DATA.items() if name != "friction"},
    "uncertain": {"friction": RANGE},
    "criterion": {"kind": "maximise", "output": "acceleration_x"},
}


def content(**change):
    return {
        "kind": "optimise",
        "scene": "rectangle-on-plane",
        "variant": "thesis",
        "criterion": {"kind": "limit", "limit": "0.5 m/s^2"},
        "parameters": DATA,
        **change,
    }


def problems(**change) -> dict[str, str]:
    return told_of(prepare_content, content(**change))


def test_all_mistakes_are_told_at_once():
    found = problems(
        variant="theses",
        colour="red",
        criterion={"kind": "limit", "limit": "5 kg", "weight": 2},
        variables={"beta": {"lower": "90 deg", "upper": 10}, "betta": {"lower": 0, "upper": 1}},
        constraints=[{"output": "throw_number", "uper": 1}],
        parameters={**DATA, "amplitude": "-1 mm"},
    )
    expected = {
        "variant": "thesis", "colour": "", "criterion.limit": "",
        "criterion.weight": "weight' is not a key of the criterion 'limit'",
        "variables.beta": "not above", "variables.betta": "Did you mean 'beta'",
        "constraints.0.uper": "", "parameters.amplitude": "",
    }  # fmt: skip
    assert found.keys() == expected.keys()
    assert all(words in found[place] for place, words in expected.items())


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        ({"criterion": {"kind": "limit"}}, "criterion.limit", "missing"),
        ({"criterion": {"kind": "limit", "limit": -1}}, "criterion.limit", "0 or more"),
        ({"criterion": {"kind": "limit", "limit": None}}, "criterion.limit", "number"),
        ({"criterion": {"kind": "maximise", "output": "regime"}}, "criterion.output", "names"),
        ({"constraints": [{"output": "regime", "upper": 1}]}, "constraints.0.output", "names"),
        ({"kind": "optimize", "constraints": 5}, "constraints", "is not a list"),
        ({"criterion": {"kind": "limits", "limit": 1}}, "criterion.kind", "Did you mean 'limit'"),
        ({"criterion": {"limit": 1}}, "criterion.kind", "missing"),
        ({"criterion": {"kind": "weighted", "weight": -1}}, "criterion.weight", "is too small"),
        ({"criterion": {"kind": "pareto", "points": 1}}, "criterion.points", "is too small"),
        (
            {"criterion": {"kind": "maximise", "output": "aceleration_x"}},
            "criterion.output",
            "Did you mean 'acceleration_",
        ),
        (
            {"criterion": {"kind": "weighted", "against": "acceleration_x"}},
            "criterion.against",
            "the same as the first",
        ),
        ({"variables": {"beta": {"lower": -200, "upper": 0}}}, "variables.beta", "at least -180"),
        ({"variables": {"beta": {"lower": 0}}}, "variables.beta", "bounds"),
        (
            {"variables": {"friction": {"lower": 0, "upper": 1}}},
            "variables.friction",
            "in [variables] and in [parameters]",
        ),
        ({"variables": {"mass": {"lower": 0.1, "upper": 1}}}, "variables.mass", "not used"),
        ({"constraints": [{"output": "throw_number"}]}, "constraints.0", "neither lower nor upper"),
        (
            {"constraints": [{"output": "throw_number", "lower": 2, "upper": 1}]},
            "constraints.0",
            "above",
        ),
        ({"constraints": [{"output": "throw_numbr", "upper": 1}]}, "constraints.0.output", "Did"),
        (
            {"constraints": [{"output": "throw_number", "upper": n} for n in (1, 2)]},
            "constraints.1",
            "set the same bound",
        ),
        ({"method": "serch"}, "method", "Did you mean 'search'"),
        ({"method": "newton"}, "method", "Known: exact, scipy, search"),
        ({"method": "exact", "parameters": {**DATA, "alpha": 0}}, "method", "Remove method"),
        ({"scene": "rectangle-isolated", "variant": None}, "criterion.output", "no output"),
        ({"parameters": {**DATA, "beta": 1, "alpha": 2}}, "variables", "no variables"),
        ({"parameters": {"frequency": 60, "friction": 0.5}}, "parameters.amplitude", "missing"),
        ({"outputs": ["speed_x"]}, "outputs", "no output"),
        (
            {"uncertain": dict.fromkeys(SEVEN, RANGE), "parameters": {}},
            "uncertain",
            "at most 6",
        ),
        ({**UNSURE, "robust": "quantile"}, "quantile", "0.05"),
        ({**UNSURE, "quantile": 0.05}, "quantile", "only robust = 'quantile' uses it"),
        ({**UNSURE, "parameters": DATA}, "uncertain.friction", "parameters"),
        ({**UNSURE, "criterion": {"kind": "pareto"}}, "uncertain", "trade-off"),
        ({**UNSURE, "method": "exact"}, "method", "exact solution"),
        ({"robust": "mean"}, "robust", "no parameter is uncertain"),
    ],
)  # fmt: skip
def test_a_mistake_is_told_with_its_place(change, place, words):
    found = problems(**change)
    assert place in found, found
    assert words in found[place], found


def test_equal_studies_share_one_key_and_come_back_from_their_canonical_form():
    one = parse_study(content())
    two = parse_study(
        content(
            criterion={"kind": "limit", "limit": 0.5, "output": "acceleration_x"},
            parameters={**DATA, "amplitude": 1e-4},
        )
    )
    assert one.key() == two.key()
    assert parse_json(one.canonical()).key() == one.key()
    wide = parse_study(content(variables={"beta": {"lower": "0.1 rad", "upper": 80}}))
    assert parse_json(wide.canonical()).key() == wide.key() != one.key()


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
        problem.objective(problem.quantities(x, {**design, "friction": np.array([friction])}))
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
         {"criterion.output": "only for a plain sine"}),
        ({"parameters": {**PARAMETERS, "amplitude": 1e-3}},
         {"parameters.amplitude": "belongs to the plain sine"}),
        ({"parameters": {**PARAMETERS, "acceleration_normal_1": 1.0}},
         {"parameters.acceleration_normal_2": "", "parameters.acceleration_normal_3": ""}),
        ({"variables": steps(6)}, {"variables": "the study has 10 variables, at most 8"}),
        # An unsound study knows its variables and what is uncertain.
        ({"title": 3, "uncertain": {"friction": {"lower": 0.3, "upper": 0.5}},
          "parameters": {"frequency": 50.0}}, {"title": ""}),
    ],
)  # fmt: skip
def test_what_is_said_of_wrong_drives(changes, problems) -> None:
    told = told_of(prepare_content, study(variables=steps(3)) | changes)
    assert told.keys() == problems.keys()
    assert all(words in told[place] for place, words in problems.items())


@pytest.mark.parametrize(("target", "distance"), [(0.8, 0.0), (9.0, None)])
def test_a_target_is_reached_or_approached(target, distance):
    """Gamma = A w^2 sin(beta)/g; the target beyond the bounds is approached at their end."""
    found = vibrafeed.optimise(
        scene="rectangle-on-plane", frequency=50, amplitude="0.3 mm", floor_contact=False,
        criterion={"kind": "reach", "output": "throw_number", "target": target},
        variables={"beta": {"lower": 1, "upper": 60}},
    )  # fmt: skip
    largest = 3e-4 * (100.0 * np.pi) ** 2 / 9.80665
    beta = 60.0 if distance is None else np.degrees(np.arcsin(target / largest))
    distance = target - largest * np.sin(np.radians(beta)) if distance is None else distance
    assert float(found.best_beta) == pytest.approx(beta, rel=1e-6)
    assert float(found.objective) == pytest.approx(distance, abs=1e-9)
    assert found.attrs["message"].startswith("target_missed: " if distance else "optimal: ")


def test_a_target_is_read_in_the_unit_of_its_output():
    content = {
        "kind": "optimise", "scene": "rectangle-on-plane",
        "criterion": {"kind": "reach", "target": "80 mm/s"},
        "variables": {"beta": {"lower": 1, "upper": 60}},
        "parameters": {"frequency": 50, "amplitude": "0.3 mm", "friction": 0.3},
    }  # fmt: skip
    assert prepare_content(content).study.criterion.target == 0.08
    wrong = {**content, "criterion": {"kind": "reach", "target": "80 kg"}}
    (said,) = told_of(prepare_content, wrong).values()
    assert "'kg' does not measure conveying velocity" in said
