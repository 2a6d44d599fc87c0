"""Studies whose drive is a recording: what they become, what is refused, what speeds are worth."""

from __future__ import annotations

import hashlib
import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

import vibrafeed
from benchmarks.measured_errors import CASES, fitted
from benchmarks.measured_speeds import PARTS, stated, study_of, true_speed
from night import first_by_day
from recordings import DRIVE, csv_of, signal_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import gather, load_study, parse_json, parse_study, prepare_content
from vibrafeed.core.intake import section as measured
from vibrafeed.core.intake import study_of as sound
from vibrafeed.core.motion.drive_error import drive_error

ROOT = Path(__file__).parents[3]
TEXT = csv_of(signal_of(DRIVE))
DATA = {"data": TEXT, "along": "ax", "normal": "az"}


def study(drive=DATA, **changes):
    content = {
        "kind": "simulate",
        "scene": "rectangle-on-plane",
        "drive": drive,
        "parameters": {"friction": 0.3},
    }
    return content | changes


def refused(content, *, files=True):
    with pytest.raises(StudyError) as caught:
        prepare_content(content, files=files)
    return [str(problem) for problem in caught.value.problems]


def test_the_numbers_of_the_fit_become_parameters():
    found = sound(study())
    values = {name: value.value for name, value in found.values().items()}
    for axis, orders in DRIVE.items():
        for order, (amplitude, phase) in enumerate(orders, start=1):
            assert values[f"amplitude_{axis}_{order}"] == pytest.approx(amplitude, rel=1e-6)
            assert values[f"phase_{axis}_{order}"] == pytest.approx(np.degrees(phase), abs=1e-4)
    assert values["frequency"] == pytest.approx(50.0)
    assert found.drive.name == "data"
    assert found.drive.sha256 == hashlib.sha256(TEXT.encode()).hexdigest()
    assert found.drive.numbers == {n: v for n, v in values.items() if n != "friction"}


def test_a_mounting_may_be_an_array():
    sensor = {"sensor": ["ax", "az", "ax"], "data": TEXT, "mounting": np.eye(3)}
    content = gather(None, {"scene": "rectangle-on-plane", "drive": sensor}, "simulate")
    assert content["drive"]["mounting"] == np.eye(3).tolist()


def test_a_canonical_study_is_read_again_without_its_recording(tmp_path):
    (tmp_path / "recording.csv").write_text(TEXT)
    drive = 'file = "recording.csv"\nalong = "ax"\nnormal = "az"\nline_frequency = "50 Hz"\n'
    path = tmp_path / "study.toml"
    path.write_text(
        'kind = "simulate"\nscene = "rectangle-on-plane"\n[parameters]\nfriction = 0.3\n'
        f"[drive]\n{drive}"
    )
    found = load_study(path)
    assert found == vibrafeed.load_study(path)
    (tmp_path / "recording.csv").unlink()
    again = parse_json(found.canonical())
    assert again.key() == found.key()
    assert str(tmp_path) not in found.canonical()
    assert found.drive.name == "recording.csv"
    assert found.drive.clock_error == pytest.approx(0.0, abs=1e-6)
    prepare_content(json.loads(found.canonical()))  # what a worker does


def test_what_a_study_gives_itself_stays_and_the_dataset_says_so():
    own = {"friction": 0.3, "frequency": [45, 50], "phase_normal_1": 90, "drive_factor": 0.5}
    dataset = vibrafeed.simulate(study(parameters=own))
    assert dataset.sizes == {"frequency": 2}
    assert float(dataset.phase_normal_1) == 90.0
    told = dataset.attrs["drive"]
    assert told.startswith("fitted to data (SHA-256 ")
    assert told.endswith("; not from it frequency, phase_normal_1")
    assert "not from it" not in vibrafeed.simulate(study()).attrs["drive"]


def test_keywords_replace_numbers_of_a_study_that_has_been_read():
    dataset = vibrafeed.simulate(sound(study()), frequency=40)
    assert dataset.attrs["drive"].endswith("; not from it frequency")


def test_a_measured_drive_can_be_optimised():
    content = study(
        kind="optimise",
        criterion={"kind": "maximise", "output": "conveying_velocity"},
        variables={"drive_factor": {"lower": 0.5, "upper": 1.0}},
    )
    assert prepare_content(content).problem.names == ("drive_factor",)
    phase = prepare_content(content | {"variables": {"phase_normal_1": {"lower": 0, "upper": 90}}})
    assert "phase_normal_1" not in phase.study.values()
    closed = content | {"criterion": {"kind": "maximise", "output": "acceleration_x"}}
    (problem,) = refused(closed)
    assert problem == (
        "criterion.output: 'acceleration_x' is a closed form of the plain sine, and the study "
        "gives another drive. Take an output of the motion, such as conveying_velocity."
    )


def test_a_sweep_of_closed_forms_has_no_measured_drive():
    assert refused(study(kind="sweep", outputs=["acceleration_x"]))[0] == (
        "drive: closed forms support only the plain sine of amplitude, alpha and beta. "
        'Write kind = "simulate", or give these.'
    )


def test_a_part_that_tumbles_has_no_measured_drive():
    assert refused(study(scene="rectangle-isolated")) == [
        "drive: rectangle-isolated takes only a sine drive, not a section drive. Choose among "
        "rectangle-on-plane, "
        "cylinder-on-plane, rectangle-on-track."
    ]


@pytest.mark.parametrize(
    ("drive", "problems"),
    [
        ({"alogn": "ax", "data": TEXT},
         ["drive.alogn: 'alogn' is not a key of the section drive. Did you mean 'along'?"]),
        ({"along": "ax"},
         ["drive: the drive names no recording. Give file = the name of the recording, or data = "
          "the text of the "
          "recording's CSV."]),
        (DATA | {"file": "x.csv"},
         ["drive: the drive gives both file and data. Give file = the name of the recording, or "
          "data = the text of the "
          "recording's CSV."]),
        ({"file": "absent.csv", "along": "ax"},
         ["drive.file: it cannot be read: No such file or directory. Name a CSV file by "
          "its path from the folder of the study."]),
        (DATA | {"along": "bx", "harmonics": 20},
         ["drive.along: the table has no column 'bx'. Known: ax, az, time.",
          "drive.harmonics: 20 orders cannot be fitted. Give a whole number from 1 to 10, or leave "
          "it out."]),
        ({"data": "", "along": "ax"},
         ["drive.data: the table is empty. Give a row of names, and rows of numbers below."]),
        ("recording.csv",
         ["drive: 'recording.csv' does not say how to read a recording. Write [drive] with file "
          '= "recording.csv" and the columns along and normal.']),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_recording_is_told_and_nothing_that_follows_from_it(drive, problems):
    found = refused(study(drive))
    assert [one for one in found if one.startswith("drive")] == problems
    assert drive == "recording.csv" or found == problems


def test_problems_of_study_and_recording_are_told_together():
    content = study(DATA | {"along": "bx"}, parameters={"fricton": 0.3})
    assert [problem.split(":")[0] for problem in refused(content)] == [
        "parameters.fricton", "drive.along",
    ]  # fmt: skip


def test_a_plain_sine_beside_a_recording_is_refused():
    (problem,) = refused(study(parameters={"friction": 0.3, "amplitude": "0.2 mm"}))
    assert problem.startswith("parameters.amplitude: ")


def test_a_study_of_the_network_reads_no_file_and_no_long_recording(tmp_path, monkeypatch):
    path = tmp_path / "recording.csv"
    path.write_text(TEXT)
    assert refused(study({"file": str(path), "along": "ax"}), files=False) == [
        "drive.file: the service cannot read the recording from your computer. Give data = "
        "the text of the "
        "recording's CSV."
    ]
    prepare_content(study())
    monkeypatch.setattr(measured, "MAX_ROWS_SENT", 700)
    assert refused(study(), files=False) == [
        "drive.data: the recording has 800 rows, the limit over HTTP is 700. Shorten the "
        "recording: one "
        "second of motion is enough."
    ]
    prepare_content(study(), files=True)


def test_a_study_that_is_only_parsed_says_that_nothing_has_been_fitted():
    with pytest.raises(StudyError, match="drive: its recording has not been fitted yet"):
        parse_study(study())


def test_the_config_runs_beside_its_recording():
    path = ROOT / "configs" / "measured-drive.toml"
    assert tomllib.loads(path.read_text())["drive"]["file"] == "../examples/accelerometer.csv"
    assert load_study(path).drive.name == "accelerometer.csv"


# --- the error of a speed


@pytest.mark.parametrize("part", first_by_day(PARTS))
def test_a_known_drive_has_a_speed_within_the_stated_error(part):
    """Of 30 sound ones 95 % have 26 or more within, but for one time in 300."""
    true = true_speed(PARTS[part])
    told = [stated("white", seed, PARTS[part], draws=100) for seed in range(30)]
    assert sum(one.lower <= true <= one.upper for one in told) >= 26
    away = np.array([(one.velocity - true) / one.standard_deviation for one in told])
    assert 0.6 < away.std() < 1.5


def test_the_error_of_a_speed_is_that_of_what_comes_from_the_recording():
    fit = fitted(0, CASES["white"])
    numbers = {**fit.parameters(), "friction": 0.3}
    whole = drive_error(study_of(numbers), fit)
    assert whole.draws == 200
    assert whole.without == 0
    rest = drive_error(study_of(numbers | {"amplitude_along_1": 1.1e-4}), fit)
    assert 0 < rest.standard_deviation != whole.standard_deviation
    with pytest.raises(StudyError) as caught:
        drive_error(study_of({"frequency": 49, "amplitude": 1e-4, "beta": 20,
                              "friction": [0.2, 0.3]}), fit, draws=3)  # fmt: skip
    assert [str(problem) for problem in caught.value.problems] == [
        "parameters.friction: friction has several values, but the error is computed for one cell. "
        "Give one value.",
        "drive: the study takes no number from the recording. Remove the parameters of the "
        "drive, so that "
        "they come from the recording.",
        "draws: draws is 3, which is outside the limits. Give 20 to 10,000 draws.",
    ]


def test_equal_seeds_give_equal_errors_from_python():
    one, same, other = (vibrafeed.drive_error(study(), draws=20, seed=seed) for seed in (1, 1, 2))
    assert one == same != other
    assert one.velocity == float(vibrafeed.simulate(study()).conveying_velocity)
    with pytest.raises(
        StudyError, match="drive: the drive of this study names no recording to fit"
    ):
        vibrafeed.drive_error(sound(study()))
