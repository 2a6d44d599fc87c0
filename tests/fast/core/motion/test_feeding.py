"""Parts a minute, and which way they travel."""

from __future__ import annotations

import numpy as np
import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.motion.feeding import direction, travel_in_words
from vibrafeed.core.motion.method import STATUS, Motion
from vibrafeed.core.quantities import DIRECTIONS

FORWARDS, BACKWARDS, RESTS, UNKNOWN = (
    DIRECTIONS[name].value for name in ("forwards", "backwards", "rests", "unknown")
)
DRIVE = {"frequency": 50, "amplitude": 3e-4, "beta": 20, "friction": 0.3}


def result(*outputs: str, scene: str = "rectangle-on-plane", **changes: object):
    parameters = {**DRIVE, **changes}
    return tabulate(
        prepare_content(
            {"kind": "simulate", "scene": scene, "outputs": outputs, "parameters": parameters}
        )
    )


def values(table, name: str):
    return np.asarray(table.variables[name].values)


@pytest.mark.parametrize("scene", ["rectangle-on-plane", "cylinder-on-plane", "rectangle-on-track"])
def test_the_rate_is_that_of_parts_and_gaps(scene: str) -> None:
    # 60 s/min of 20 mm/s over 10 mm from the front of one part to that of the next.
    found = result(
        "conveying_velocity", "feed_rate", scene=scene, length="8 mm", part_gap="2 mm"
    )  # fmt: skip
    speed = values(found, "conveying_velocity")
    assert values(found, "feed_rate") == pytest.approx(60 * speed / 0.010, rel=1e-14)
    assert found.variables["feed_rate"].attributes["units"] == "min-1"


def test_occupancy_stands_in_the_place_of_a_gap() -> None:
    touching = values(result("feed_rate", length="8 mm"), "feed_rate")
    with_gap = values(result("feed_rate", length="8 mm", part_gap="2 mm"), "feed_rate")
    occupied = values(result("feed_rate", length="8 mm", occupancy=0.8), "feed_rate")
    assert with_gap == pytest.approx(0.8 * touching, rel=1e-14)
    assert occupied == pytest.approx(with_gap, rel=1e-14)
    with pytest.raises(StudyError, match="Give either occupancy or part_gap"):
        result("feed_rate", length="8 mm", occupancy=0.8, part_gap="2 mm")
    with pytest.raises(StudyError, match="Length of the part, along the track"):
        result("feed_rate", occupancy=0.8)


def test_oriented_parts_of_a_drive_unit_in_one_study() -> None:
    sizes = {"length": "8 mm", "line_yield": 0.79, "line_purity": 0.9, "beta": [20, 160]}
    found = result("feed_rate", "line_feed_rate", "oriented_feed_rate", **sizes)
    ahead, _ = values(found, "feed_rate")
    leaving = [0.79 * ahead, 0.0]
    assert values(found, "line_feed_rate") == pytest.approx(leaving, rel=1e-14)
    assert values(found, "oriented_feed_rate") == pytest.approx(
        [0.9 * one for one in leaving], rel=1e-14
    )
    with pytest.raises(StudyError, match="line_purity: it is missing"):
        result("oriented_feed_rate", length="8 mm", line_yield=0.79)


def test_a_rate_backwards_is_below_0() -> None:
    ahead, back = values(result("feed_rate", beta=[20, 160], length="8 mm"), "feed_rate")
    assert ahead > 0
    assert back == pytest.approx(-ahead, rel=1e-9)


def test_directions_are_flags_with_words() -> None:
    found = result("direction", beta=[20, 90, 160])
    assert values(found, "direction").tolist() == [FORWARDS, RESTS, BACKWARDS]
    attributes = found.variables["direction"].attributes
    assert attributes["flag_meanings"] == "rests forwards backwards unknown"
    assert attributes["flag_values"].tolist() == [0, 1, 2, 3]
    held = result("direction", amplitude=1e-6)
    assert values(held, "direction") == RESTS


def motion(velocity: float, error: float, status: str, stick: float = 0.0) -> Motion:
    one = np.asarray
    fields = dict.fromkeys(Motion._fields, one(0.0))
    fields |= {"velocity": one(velocity), "error": one(error), "status": one(STATUS[status])}
    return Motion(**{**fields, "stick": one(stick), "forward": one(1.0 - stick)})


@pytest.mark.parametrize(
    ("velocity", "error", "status", "expected"),
    [
        (-1e-16, 0.0, "periodic", RESTS),  # the last bit decides nothing
        (1e-3, 2e-3, "periodic", RESTS),  # no further from 0 than the method's own error
        (-3e-3, 2e-3, "periodic", BACKWARDS),
        (-1e-7, 0.0, "periodic", BACKWARDS),  # slow, and sure
        (0.1, 0.0, "aperiodic", FORWARDS),
        (0.1, np.nan, "neutral", FORWARDS),
        (np.nan, np.nan, "runaway", UNKNOWN),
        (np.nan, np.nan, "not_computed", UNKNOWN),
        (0.0, 0.0, "limit_reached", UNKNOWN),
    ],
)
def test_rest_is_told_by_errors(velocity, error, status, expected) -> None:
    told = direction(motion=motion(velocity, error, status), drive_number=np.asarray(3.0))
    assert int(told) == expected
    assert told.dtype == np.int8


@pytest.mark.parametrize("output", ["direction", "conveying_velocity", "feed_rate"])
def test_a_line_says_what_travels_backwards(output: str) -> None:
    length = {"length": "8 mm"} if output == "feed_rate" else {}
    assert travel_in_words(result(output, beta=[20, 90], **length)) == ""
    assert travel_in_words(result(output, beta=[20, 160], **length)) == (
        "50\N{NO-BREAK SPACE}% of the cells travel backwards, against x."
    )
    assert travel_in_words(result(output, beta=[150, 160], **length)) == (
        "All cells travel backwards, against x."
    )
    assert travel_in_words(result(output, beta=160, **length)) == (
        "The part travels backwards, against x."
    )
    assert travel_in_words(result("hop_height", beta=160)) == ""


def test_what_impacts_take_from_a_part_is_an_output_of_every_motion() -> None:
    for scene in ("rectangle-on-plane", "cylinder-on-plane", "rectangle-on-track"):
        found = result(
            "impact_work", "part_impact_work", "part_friction_work", "part_drive_work",
            scene=scene, amplitude="0.5 mm", beta=40, mass="2 g",
        )  # fmt: skip
        per_mass = values(found, "impact_work")
        assert per_mass > 0
        assert values(found, "part_impact_work") == pytest.approx(0.002 * per_mass, rel=1e-14)
    tumbled = tabulate(
        prepare_content(
            {
                "kind": "simulate",
                "scene": "rectangle-isolated",
                "outputs": ["part_energy_lost", "specific_energy_lost"],
                "parameters": {
                    "length": 0.02, "height": 0.01, "friction": 0.3, "restitution": 0.3,
                    "duration": 0.2, "drop_height": 0.01, "pitch": 20, "mass": 0.002,
                },
            }
        )
    )  # fmt: skip
    lost = values(tumbled, "specific_energy_lost")
    assert lost > 0
    assert values(tumbled, "part_energy_lost") == pytest.approx(0.002 * lost, rel=1e-14)
