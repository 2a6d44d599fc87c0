"""How far an optimisation is, told while a design is searched, not only when it is found."""

from __future__ import annotations

import pytest

from vibrafeed.core.intake import parse_study
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.optimise.prepare import prepare
from vibrafeed.core.watch import Watch

STUDY = {
    "kind": "optimise",
    "scene": "rectangle-on-plane",
    "criterion": {"kind": "minimise", "output": "vibration_acceleration"},
    "constraints": [{"output": "acceleration_x", "lower": "5 m/s^2"}],
    "variables": {"amplitude": {"lower": "0.01 mm", "upper": "1 mm"}},
    "parameters": {"frequency": 50, "friction": 0.3, "gamma": 2, "beta": 20},
}


@pytest.mark.parametrize("method", ["search", "scipy"])
def test_the_bar_moves_within_a_design_and_ends_at_its_end(method):
    told: list[float] = []
    tabulate(prepare(parse_study({**STUDY, "method": method})), watch=Watch(told.append))
    assert sum(told) == pytest.approx(1)
    assert min(told) >= 0
    assert max(told) < 0.9
    assert sum(share > 0 for share in told) > 10
