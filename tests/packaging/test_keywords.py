"""What editors, `help` and type checkers show of studies."""

from __future__ import annotations

import inspect
import pydoc

import pytest

import vibrafeed
from benchmarks import keywords
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.grid_study import PARAMETERS

POINT = {
    "scene": "rectangle-on-plane", "frequency": "50 Hz", "amplitude": "0.25 mm", "beta": 30,
    "friction": 0.5,
}  # fmt: skip


def test_they_are_those_of_today():
    """`python -m benchmarks.keywords` writes them again."""
    assert keywords.NAMES.read_text(encoding="utf-8") == keywords.names_module()
    by_hand = keywords.FUNCTIONS_FILE.read_text(encoding="utf-8")
    text = keywords.STUDIES_FILE.read_text(encoding="utf-8")
    assert text == keywords.studies_module(by_hand)


def test_what_is_written_by_hand_has_no_keyword_of_a_study():
    """So nothing in it can be out of date."""
    by_hand = keywords.FUNCTIONS_FILE.read_text(encoding="utf-8")
    name = "    frequency: Values"
    assert by_hand.count(name) == by_hand.count("    frequency : ") == 0
    assert keywords.studies_module(by_hand).count(name) > 6


def test_a_parameter_that_is_gone_is_a_keyword_no_more(monkeypatch):
    by_hand = keywords.FUNCTIONS_FILE.read_text(encoding="utf-8")
    assert "    amplitude: Values" in keywords.studies_module(by_hand)
    left = {name: quantity for name, quantity in QUANTITIES.items() if name != "amplitude"}
    monkeypatch.setattr(keywords, "QUANTITIES", left)
    assert "    amplitude: Values" not in keywords.studies_module(by_hand)


@pytest.mark.parametrize("kind", KINDS)
def test_every_key_and_parameter_is_a_keyword_with_words(kind):
    function = getattr(vibrafeed, kind)
    signature = inspect.signature(function)
    told = pydoc.plain(pydoc.render_doc(function))
    for name in (*keywords.keys([kind]), *keywords.parameters([kind])):
        if name != "kind":
            assert signature.parameters[name].annotation not in ("", "Any")
            assert f"\n        {name} : " in told or f"\n    {name} : " in told, name
    assert "Drive frequency. In Hz, 0 or more, for example" in told
    assert str(QUANTITIES["friction"].description) in told


def test_no_parameter_is_left_out():
    """What no function takes, the sweeps and simulations of no scene take."""
    taken = {*keywords.parameters(KINDS), *keywords.numbered()}
    assert taken == set(PARAMETERS)


def test_a_key_without_a_type_is_told_by_name(monkeypatch):
    monkeypatch.delitem(keywords.TYPES, "verify")
    with pytest.raises(KeyError, match="verify"):
        keywords.annotations("sweep")


def test_a_wrong_keyword_is_a_problem_among_others():
    with pytest.raises(vibrafeed.StudyError) as caught:
        vibrafeed.sweep(**POINT, outputs="acceleration_x", frictoin=0.3, verify="many")
    assert [problem.place for problem in caught.value.problems] == [
        "parameters.frictoin", "verify",
    ]  # fmt: skip


def test_none_is_a_keyword_left_out():
    study = vibrafeed.study(kind="sweep", outputs="acceleration_x", **POINT)
    assert vibrafeed.study(study, beta=None, title=None) == study
    same = vibrafeed.study(kind="simulate", **POINT, phase_along_1=None)
    assert same == vibrafeed.study(kind="simulate", **POINT)


def test_numbers_of_a_drive_are_taken():
    motion = vibrafeed.simulate(
        scene="rectangle-on-plane", frequency="50 Hz", friction=0.2, amplitude_along_1="0.3 mm",
        amplitude_along_2="0.075 mm", phase_along_2="180 deg",
    )  # fmt: skip
    assert motion.conveying_velocity.item() == pytest.approx(0.0461, abs=1e-5)  # docs/drives.md


def test_what_programs_write_says_so():
    """`.gitattributes` names it, so that who reviews a change is not shown it."""
    named = (keywords.PACKAGE.parent / ".gitattributes").read_text(encoding="utf-8").split()
    for file in (keywords.NAMES, keywords.STUDIES_FILE):
        place = named.index(file.relative_to(keywords.PACKAGE.parent).as_posix())
        assert named[place + 1] == "linguist-generated"
