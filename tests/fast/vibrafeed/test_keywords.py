"""What editors and `help` show of studies."""

import inspect
import pydoc

import pytest

import vibrafeed
from benchmarks import keywords
from vibrafeed.core.catalogue import describe_all
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.study.grid_study import PARAMETERS

POINT = {"frequency": "50 Hz", "amplitude": "0.25 mm", "beta": 30, "friction": 0.5}
EVERY = (
    "kind",
    "scene",
    "parameters",
    "units",
    "title",
    "notes",
    "designs",
)  # `help(vibrafeed)` names them


def test_every_parameter_is_a_keyword_of_its_scene():
    from vibrafeed import parameters

    assert set(parameters.Keywords.__annotations__) - set(EVERY) == set(PARAMETERS)
    for line in describe_all():
        name = line["name"]
        own = getattr(parameters, keywords.class_name(name)).__annotations__
        ways = [{"variant": one} for one in line["variants"]]
        for way in (*ways, *({"method": one} for one in line["methods"])):
            assert vibrafeed.scene(name, **way).parameters.keys() <= own.keys()
    assert parameters.RectangleOnPlane.__annotations__["gravity"] is parameters.m_per_s2
    assert "spring_count" not in parameters.RectanglePairImpact.__annotations__


@pytest.mark.parametrize("kind", KINDS)
def test_every_key_of_a_study_is_a_keyword_with_words(kind):
    function = getattr(vibrafeed, kind)
    told = pydoc.plain(pydoc.render_doc(function))
    for name in KINDS[kind].model.model_fields:
        if name not in EVERY:
            assert name in inspect.signature(function).parameters
            assert name in told.partition("Parameters")[2]


def test_a_wrong_keyword_is_a_problem_among_others():
    with pytest.raises(vibrafeed.StudyError) as caught:
        vibrafeed.sweep(
            "rectangle-on-plane", **POINT, outputs="acceleration_x", frictoin=0.3, verify="x"
        )
    assert [problem.place for problem in caught.value.problems] == [
        "parameters.frictoin", "verify",
    ]  # fmt: skip


def test_none_is_a_keyword_left_out():
    study = vibrafeed.study("rectangle-on-plane", kind="sweep", outputs="throw_number", **POINT)
    assert vibrafeed.study(study, beta=None, title=None) == study
    assert vibrafeed.study("rectangle-on-plane", kind="simulate", **POINT, phase_along_1=None) == (
        vibrafeed.study(kind="simulate", scene="rectangle-on-plane", **POINT)
    )


def test_a_study_is_given_in_four_ways(tmp_path):
    by_name = vibrafeed.study("rectangle-on-plane", kind="simulate", **POINT)
    path = tmp_path / "point.toml"
    path.write_text(
        'scene = "rectangle-on-plane"\nkind = "simulate"\n[parameters]\nfriction = 0.2\n'
    )
    mapping = {"scene": "rectangle-on-plane", "friction": 0.2}
    for first in (path, str(path), mapping, vibrafeed.study(path), "rectangle-on-plane"):
        assert vibrafeed.study(first, kind="simulate", **POINT) == by_name
        changed = vibrafeed.study(first, kind="simulate", scene="sphere-on-plane", friction=0.1)
        assert changed.scene == "sphere-on-plane"
        assert changed.content()["parameters"]["friction"] == 0.1
    assert vibrafeed.study(kind="simulate", scene="rectangle-on-plane", **POINT) == by_name
    speed = vibrafeed.simulate("rectangle-on-plane", **POINT).conveying_velocity
    assert vibrafeed.simulate(path, **POINT).conveying_velocity == speed


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("rectangle-on-plan", "Did you mean 'rectangle-on-plane'"),
        ("bowl", "'bowl' is not a scene"),
        ("rectangle-on-plan.toml", "cannot be read"),
        ("studies/rectangle-on-plan", "cannot be read"),
    ],
)
def test_a_name_that_is_neither_a_scene_nor_a_file_is_one_problem(name, words):
    with pytest.raises(vibrafeed.StudyError, match=words) as caught:
        vibrafeed.simulate(name, **POINT)
    assert len(caught.value.problems) == 1
