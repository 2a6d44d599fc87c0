"""Studies of optimisation: what they accept, and every way to carry one out."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from local_client import local_client
from night import spread
from schemas import expanded, whole_schema
from vibrafeed.app.cli import app
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import load_study, parse_json, parse_study, prepare_content
from vibrafeed.core.kinds import KINDS, run_study
from vibrafeed.core.optimise import METHODS
from vibrafeed.core.optimise.problem import STATUS
from vibrafeed.core.quantities import REGIMES

CONFIGS = sorted((Path(__file__).parents[4] / "configs").glob("optimise-*.toml"))
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


def problems(**change) -> dict[str, str]:
    with pytest.raises(StudyError) as caught:
        prepare_content(content(**change))
    return {problem.place: f"{problem.message}. {problem.fix}" for problem in caught.value.problems}


# --- what a study may say


@pytest.mark.parametrize("path", spread(CONFIGS, 4), ids=lambda path: path.stem)
def test_every_example_has_an_optimum_everywhere(path):
    dataset = run_study(load_study(path))
    assert (dataset.optimum_status == STATUS["optimal"]).all()
    for name, variable in dataset.data_vars.items():
        assert np.isfinite(variable).all(), name
        assert variable.dims == dataset.regime.dims, name
    assert set(np.unique(dataset.regime)) <= set(dataset.regime.attrs["flag_values"])
    assert (dataset.regime != REGIMES["not_assessed"].value).all()


def test_there_is_an_example_of_every_criterion():
    kinds = {tomllib.loads(path.read_text())["criterion"]["kind"] for path in CONFIGS}
    assert kinds == {"weighted", "limit", "pareto", "maximise", "minimise"}


def test_all_mistakes_are_told_at_once():
    found = problems(
        variant="theses",
        colour="red",
        criterion={"kind": "limit", "limit": "5 kg", "weight": 2},
        variables={"beta": {"lower": "90 deg", "upper": 10}, "betta": {"lower": 0, "upper": 1}},
        constraints=[{"output": "throw_number", "uper": 1}],
        parameters={**DATA, "amplitude": "-1 mm"},
    )
    assert set(found) == {
        "variant",
        "colour",
        "criterion.limit",
        "criterion.weight",
        "variables.beta",
        "variables.betta",
        "constraints.0.uper",
        "parameters.amplitude",
    }
    assert "thesis" in found["variant"]
    assert "weight' is not a key of the criterion 'limit'" in found["criterion.weight"]
    assert "not above" in found["variables.beta"]
    assert "Did you mean 'beta'" in found["variables.betta"]


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        ({"criterion": {"kind": "limit"}}, "criterion.limit", "missing"),
        ({"criterion": {"kind": "limit", "limit": -1}}, "criterion.limit", "0 or more"),
        ({"criterion": {"kind": "limit", "limit": None}}, "criterion.limit", "number"),
        ({"criterion": {"kind": "maximise", "output": "regime"}}, "criterion.output", "as values"),
        ({"constraints": [{"output": "regime", "upper": 1}]}, "constraints.0.output", "as values"),
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
            "the same bound twice",
        ),
        ({"method": "serch"}, "method", "Did you mean 'search'"),
        ({"method": "minimize_scalar"}, "method", 'Write method = "scipy"'),
        ({"method": "population"}, "method", 'Write method = "search"'),
        ({"method": "newton"}, "method", 'Write method = "exact"'),
        ({"method": "exact", "parameters": {**DATA, "alpha": 0}}, "method", "Leave method out"),
        ({"scene": "rectangle-isolated", "variant": None}, "criterion.output", "no output"),
        ({"parameters": {**DATA, "beta": 1, "alpha": 2}}, "variables", "there are no variables"),
        ({"parameters": {"frequency": 60, "friction": 0.5}}, "parameters.amplitude", "missing"),
        ({"outputs": ["speed_x"]}, "outputs", "no output"),
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


def test_the_schema_tells_criteria_apart_and_names_the_methods(tmp_path_factory):
    whole = whole_schema(tmp_path_factory)
    schema = expanded(whole["oneOf"][[*KINDS].index("optimise")], whole)
    assert set(schema["properties"]["criterion"]["discriminator"]["mapping"]) == {
        "weighted", "limit", "pareto", "maximise", "minimise",
    }  # fmt: skip
    assert schema["properties"]["method"]["enum"] == [*METHODS, None]
    assert "conveying_velocity" in schema["properties"]["outputs"]["items"]["enum"]
    json.dumps(schema, allow_nan=False)


# --- by command and by request


def test_by_command_by_request_and_by_call(tmp_path):
    import xarray

    path = next(path for path in CONFIGS if "pareto" in path.stem)
    study = tomllib.loads(path.read_text())
    called = run_study(parse_study(study))
    ran = CliRunner().invoke(app, ["run", str(path), "-o", str(tmp_path / "front.nc")])
    assert ran.exit_code == 0, ran.output
    assert "the whole front, method exact" in ran.output
    xarray.testing.assert_equal(xarray.load_dataset(tmp_path / "front.nc"), called)
    planned = CliRunner().invoke(app, ["run", "--dry-run", str(path)])
    assert planned.exit_code == 0
    assert "by the choice of alpha, beta" in planned.output
    with local_client(create_app(Settings(data_directory=tmp_path / "data"))) as client:
        reply = client.post("/processes/optimise/execution", json={"inputs": {"study": study}})
        assert reply.status_code == 200, reply.text
        wrong = client.post("/processes/optimise/execution", json={**study, "kind": "sweep"})
        assert wrong.status_code == 422
        stopped = local_client(
            create_app(
                Settings(
                    data_directory=tmp_path / "more", max_execution_seconds=1e-9, grace_seconds=300
                )
            )
        )
        with stopped:
            left = stopped.post(
                "/processes/optimise/execution", json={**content(), "method": "scipy"}
            )
    body = reply.json()
    assert body["complete"]
    assert body["cells"] == 400
    best = np.array(body["variables"]["best_alpha"]["data"])
    np.testing.assert_array_equal(best, called.best_alpha.values)
    assert body["variables"]["optimum_status"]["flags"]["optimal"] == 0
    assert left.status_code == 201  # it goes on as a job
    assert left.json()["processID"] == "optimise"
