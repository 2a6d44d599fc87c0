"""A value of another type is told with its place, what it is, and what would be right."""

from __future__ import annotations

import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content

PARAMETERS = {"frequency": 50, "amplitude": 3e-4, "beta": 30, "friction": 0.3}
STUDY = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity"],
    "parameters": PARAMETERS,
}
NUMBER = "Write friction = 0.3 (a plain number)"
TEXT = "Write a text in quotes"
WRONG = [
    (
        {"parameters": {**PARAMETERS, "friction": True}},
        "parameters.friction",
        "true is not a number",
        NUMBER,
    ),
    (
        {"parameters": {**PARAMETERS, "amplitude": []}},
        "parameters.amplitude",
        "the list of values of amplitude is empty",
        "Give at least one value",
    ),
    (
        {"parameters": []},
        "parameters",
        "an empty list is not a table of keys and values",
        "Write a table, in JSON an object",
    ),
    ({"scene": 3}, "scene", "3 is not a text", TEXT),
    ({"scene": {"a": 1}}, "scene", "a table is not a text", TEXT),
    ({"title": ["x"]}, "title", "a list is not a text", TEXT),
    ({"outputs": "x"}, "outputs", "'x' is not a list", "Write a list in brackets"),
    ({"outputs": []}, "outputs", "it has too few entries", "Give at least 1"),
    ({"max_periods": 99.5}, "max_periods", "99.5 is not a whole number", "Write a whole number"),
    ({"max_periods": 3}, "max_periods", "3 is too small", "Write at least 8"),
    ({"tolerance": True}, "tolerance", "true is not a number", "Write a plain number"),
    ({"tolerance": {}}, "tolerance", "an empty table is not a number", "Write a plain number"),
    ({"tolerance": 3}, "tolerance", "3 is too large", "Write at most 1"),
    (
        {"verify": "x" * 100},
        "verify",
        f"'{'x' * 60}...' is not a whole number",
        "Write a whole number",
    ),
]


@pytest.mark.parametrize(("change", "place", "message", "fix"), WRONG)
def test_another_type_is_told(change, place, message, fix):
    with pytest.raises(StudyError) as raised:
        prepare_content({**STUDY, **change})
    told = [(one.place, one.message, one.fix) for one in raised.value.problems]
    assert (place, message, fix) in told
