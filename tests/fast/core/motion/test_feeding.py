"""Parts a minute, and which way they travel."""

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
    study = {"kind": "simulate", "scene": scene, "outputs": outputs}
    return tabulate(prepare_content({**study, "parameters": {**DRIVE, **changes}}))


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
    touching, with_gap, occupied = (
        values(result("feed_rate", length="8 mm", **more), "feed_rate")
        for more in ({}, {"part_gap": "2 mm"}, {"occupancy": 0.8})
    )
    assert with_gap == pytest.approx(0.8 * touching, rel=1e-14)
    assert occupied == pytest.approx(with_gap, rel=1e-14)


@pytest.mark.parametrize(
    ("output", "given", "says"),
    [
        ("feed_rate", {"length": "8 mm", "occupancy": 0.8, "part_gap": "2 mm"},
         "Give either occupancy or part_gap"),
        ("feed_rate", {"occupancy": 0.8}, "Length of the part, measured along the track"),
        ("oriented_feed_rate", {"length": "8 mm", "line_yield": 0.79},
         "line_purity: it is missing"),
    ],
)  # fmt: skip
def test_what_a_rate_lacks_is_said(output, given, says) -> None:
    with pytest.raises(StudyError, match=says):
        result(output, **given)


def test_oriented_parts_in_one_study_and_what_goes_backwards() -> None:
    sizes = {"length": "8 mm", "line_yield": 0.79, "line_purity": 0.9, "beta": [20, 160]}
    found = result("feed_rate", "line_feed_rate", "oriented_feed_rate", **sizes)
    ahead, back = values(found, "feed_rate")
    assert back == pytest.approx(-ahead, rel=1e-9)
    assert values(found, "line_feed_rate") == pytest.approx([0.79 * ahead, 0.0], rel=1e-14)
    assert values(found, "oriented_feed_rate") == pytest.approx([0.711 * ahead, 0.0], rel=1e-14)


def test_directions_are_flags_with_words() -> None:
    found = result("direction", beta=[20, 90, 160])
    assert values(found, "direction").tolist() == [FORWARDS, RESTS, BACKWARDS]
    attributes = found.variables["direction"].attributes
    assert attributes["flag_meanings"] == "rests forwards backwards unknown"
    assert attributes["flag_values"].tolist() == [0, 1, 2, 3]


def motion(velocity: float, error: float, status: str) -> Motion:
    fields = dict.fromkeys(Motion._fields, np.asarray(0.0))
    given = {"velocity": velocity, "error": error, "status": STATUS[status], "forward": 1.0}
    return Motion(**fields | {name: np.asarray(value) for name, value in given.items()})


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


@pytest.mark.parametrize(
    ("output", "beta", "words"),
    [
        ("direction", [20, 90], ""),
        ("feed_rate", [20, 160],
         "50\N{NO-BREAK SPACE}% of the cells travel backwards, against x."),
        ("conveying_velocity", [150, 160], "All cells travel backwards, against x."),
        ("direction", 160, "The part travels backwards, against x."),
        ("hop_height", 160, ""),
    ],
)  # fmt: skip
def test_a_line_says_what_travels_backwards(output, beta, words) -> None:
    length = {"length": "8 mm"} if output == "feed_rate" else {}
    assert travel_in_words(result(output, beta=beta, **length)) == words


@pytest.mark.parametrize("scene", ["rectangle-on-plane", "cylinder-on-plane", "rectangle-on-track"])
def test_what_impacts_take_from_a_part_is_an_output_of_every_motion(scene) -> None:
    given = {"scene": scene, "amplitude": "0.5 mm", "beta": 40, "mass": "2 g"}
    found = result("impact_work", "part_impact_work", **given)
    per_mass = values(found, "impact_work")
    assert per_mass > 0
    assert values(found, "part_impact_work") == pytest.approx(0.002 * per_mass, rel=1e-14)


def test_what_a_tumbling_part_loses() -> None:
    study = {
        "kind": "simulate", "scene": "rectangle-isolated",
        "outputs": ["part_energy_lost", "specific_energy_lost"],
        "parameters": {
            "length": 0.02, "height": 0.01, "friction": 0.3, "restitution": 0.3,
            "duration": 0.2, "drop_height": 0.01, "pitch": 20, "mass": 0.002,
        },
    }  # fmt: skip
    tumbled = tabulate(prepare_content(study))
    lost = values(tumbled, "specific_energy_lost")
    assert lost > 0
    assert values(tumbled, "part_energy_lost") == pytest.approx(0.002 * lost, rel=1e-14)
