"""Observations as a stopwatch gives them: a distance, and the time that a part takes for it."""

from __future__ import annotations

import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study
from vibrafeed.core.intake.sections import read_rows

STUDY = {
    "kind": "calibrate", "scene": "rectangle-on-plane", "parameters": {"frequency": 50, "beta": 30},
    "unknowns": {"friction": {"lower": 0.05, "upper": 0.8}},
}  # fmt: skip


def runs(rows):
    return parse_study({**STUDY, "observations": rows}).observations


def test_a_distance_and_a_time_are_a_speed(tmp_path):
    (run,) = runs([{"amplitude": "0.3 mm", "distance": "40 cm", "time": "20 s", "error": "5 %"}])
    assert run.conveying_velocity == pytest.approx(0.02, rel=1e-15)
    assert run.error == pytest.approx(0.001)
    several = runs({"amplitude": ["0.2 mm", "0.3 mm"], "distance": "0.4 m", "time": [40, 20]})
    assert [one.conveying_velocity for one in several] == [0.01, 0.02]
    table = tmp_path / "runs.csv"
    table.write_text("amplitude (mm);distance_mm;time [s];Bemerkung\n0,3;400;20;gut\n")
    assert runs(read_rows(table))[0].conveying_velocity == pytest.approx(0.02)


def test_no_time_is_no_speed():
    with pytest.raises(StudyError, match="the time of a part over the distance is 0 s"):
        runs([{"amplitude": "0.3 mm", "distance": "40 cm", "time": 0}])
    with pytest.raises(StudyError, match="'s' does not measure effective distance"):
        runs([{"amplitude": "0.3 mm", "distance": "40 s", "time": 1}])
