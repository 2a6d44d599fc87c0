"""Keys that were called otherwise in an earlier version still work in this one."""

from __future__ import annotations

import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study, prepare_content

CONTENT = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "outputs": ["conveying_velocity"],
    "parameters": {"frequency": 50, "amplitude": "0.3 mm", "beta": 20, "friction": 0.3},
}


def test_the_old_key_of_the_limit_of_periods_still_works():
    old, new = (parse_study({**CONTENT, key: 64}) for key in ("most_periods", "max_periods"))
    assert old.canonical() == new.canonical()
    assert "most_periods" not in str(old.canonical())
    assert prepare_content({**CONTENT, "most_periods": 64}).study.max_periods == 64


def test_a_wrong_value_under_the_old_key_is_refused():
    with pytest.raises(StudyError, match="periods"):
        parse_study({**CONTENT, "most_periods": 2})
