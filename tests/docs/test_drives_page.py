"""What the page on drives shows is run: its studies, its speeds, its messages."""

import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study, prepare_content
from vibrafeed.core.kinds import run_study
from vibrafeed.core.quantities import MOTION_STATUSES

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "drives.md").read_text(encoding="utf-8")
PROSE = " ".join(TEXT.split())
FOUND = [tomllib.loads(block) for block in re.findall(r"```toml\n(.*?)```", TEXT, re.DOTALL)]
BLOCKS = [block for block in FOUND if "drive" not in block]
HEAD = {name: value for name, value in BLOCKS[0].items() if name != "parameters"}
ELLIPSE, TWO, STEPPED, PRESSED = (block["parameters"] for block in BLOCKS)
FRICTION = {"frequency": 50, "friction": 0.3}
SPEED = "conveying_velocity"


def run(given: dict[str, Any], **changes: Any) -> Any:
    return run_study(parse_study({**HEAD, "parameters": {**given, **changes}}))


@pytest.mark.parametrize("given", [block["parameters"] for block in BLOCKS])
def test_every_study_of_the_page_moves_a_part(given: dict[str, Any]) -> None:
    found = run(given)
    assert (found.motion_status == MOTION_STATUSES["periodic"].value).all()
    assert (np.abs(found[SPEED]) > 1e-3).all()


@pytest.mark.parametrize(
    ("given", "changes", "says"),
    [
        (ELLIPSE, {}, "speed is {:.2f} mm/s"),
        (ELLIPSE, {"phase_normal_1": 0}, "line and a speed of {:.2f} mm/s"),
        (ELLIPSE, {"phase_normal_1": 110}, "degrees gives {:.2f} mm/s"),
        (
            ELLIPSE,
            {"phase_normal_1": 0, "amplitude_normal_1": "0.095 mm"},
            "travels at {:.1f} mm/s",
        ),
        (ELLIPSE, {"amplitude_normal_1": "0.095 mm"}, "at {:.1f} mm/s with -70 degrees"),
        (TWO, {}, "moves at {:.2f} mm/s"),
        (STEPPED, {}, "{:.6f} mm/s"),
        (PRESSED, {}, "{:.3f} mm/s"),
    ],
)
def test_speeds_are_those_that_the_page_tells(given, changes, says) -> None:
    assert says.format(1e3 * float(run(given, **changes)[SPEED])) in PROSE


def test_the_recording_of_the_page_is_followed_once() -> None:
    (block,) = (one for one in FOUND if "drive" in one)
    drive = {name: value for name, value in block["drive"].items() if name != "file"}
    data = "time [s],ax [m/s^2],az [m/s^2]\n0,0,9.8\n0.01,9,9.8\n0.02,-9,9.8\n0.03,0,9.8"
    prepared = prepare_content({**block, "drive": {**drive, "data": data}})
    assert np.isfinite(run_study(prepared.study).burst_displacement).all()


def test_what_the_page_says_of_the_ellipse() -> None:
    given = {
        **ELLIPSE,
        "amplitude_normal_1": ["0.02 mm", "0.08 mm", "0.15 mm"],
        "phase_normal_1": list(range(-180, 181, 5)),
    }
    found = run(given)[SPEED]
    best = found.idxmax("phase_normal_1")
    assert ((best >= -80) & (best <= -70)).all()
    back = found.idxmin("phase_normal_1")
    assert ((back >= 100) & (back <= 110)).all()
    assert (np.abs(found.max("phase_normal_1") + found.min("phase_normal_1")) < 1e-12).all()


def test_a_wave_that_one_level_closes_is_the_one_that_gives_it() -> None:
    whole = run(STEPPED, acceleration_along_2="-19.62 m/s^2")
    assert float(whole[SPEED]) == pytest.approx(float(run(STEPPED)[SPEED]), rel=1e-14)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"acceleration_along_1": 4, "acceleration_along_2": -3}, "is not 0"),
        ({"acceleration_along_1": 4, "duration_1": 0}, "a drive in steps needs at least two steps"),
        ({"acceleration_along_1": 4, "duration_1": 0, "duration_2": 0}, "have a duration of 0"),
        ({"acceleration_along_1": 4, "amplitude_along_1": 1e-4}, "also gives harmonics"),
        ({"amplitude": 1e-4, "amplitude_along_1": 1e-4}, "belongs to the plain sine, but"),
        ({"beta": 20, "amplitude_along_1": 1e-4}, "belongs to the plain sine, but"),
        ({"phase_along_1": 20}, "it is missing"),
        ({"acceleration_along_1": 4, "acceleration_along_4": -4}, "it is missing"),
        ({"duration_1": 1}, "steps need an acceleration"),
        ({"kind": "sweep", "amplitude_along_1": 1e-4}, "supports only a plain sine"),
    ],
)
def test_an_incomplete_drive_is_refused(given: dict[str, Any], message: str) -> None:
    sweep = {"kind": "sweep", "outputs": ["acceleration_x"]} if given.pop("kind", "") else {}
    with pytest.raises(StudyError) as refused:
        prepare_content({**HEAD, **sweep, "parameters": {**FRICTION, **given}})
    assert message in " ".join(problem.message for problem in refused.value.problems)


def test_along_once_and_normal_twice_has_no_speed_of_its_own_if_it_hops() -> None:
    given = {"frequency": 50, "friction": 0.2, "amplitude_along_1": "0.3 mm"}
    hops = run(given, amplitude_normal_2="0.04 mm")
    assert int(hops.motion_status) == MOTION_STATUSES["limit_reached"].value
    # The slightest slope takes it to one end of the range, the other one to the other end.
    ends = [float(run(given, amplitude_normal_2="0.04 mm", gamma=g)[SPEED]) for g in (-1e-6, 1e-6)]
    assert ends[0] == pytest.approx(-ends[1], rel=1e-6)
    assert ends[0] > 0.06
    stays = run(given, amplitude_normal_2="0.02 mm")
    assert abs(float(stays[SPEED])) < 1e-15
