"""Studies whose drive is a recording: what they become, what is refused, what speeds are worth."""

import hashlib
import json

import numpy as np
import pytest

import vibrafeed
from benchmarks.measured_errors import CASES, fitted
from benchmarks.measured_speeds import study_of
from recordings import DRIVE, csv_of, signal_of
from refusals import problems_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import load_study, parse_json, parse_study, prepare_content
from vibrafeed.core.intake import section as measured
from vibrafeed.core.intake import study_of as sound
from vibrafeed.core.motion.drive_error import drive_error

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
    return [str(problem) for problem in problems_of(prepare_content, content, files=files)]


def test_the_numbers_of_the_fit_become_parameters():
    found = sound(study())
    expected = {"frequency": 50.0}
    for axis, orders in DRIVE.items():
        for order, (amplitude, phase) in enumerate(orders, start=1):
            expected[f"amplitude_{axis}_{order}"] = amplitude
            expected[f"phase_{axis}_{order}"] = np.degrees(phase)
    values = {name: value.value for name, value in found.values().items()}
    assert values == pytest.approx({**expected, "friction": 0.3}, rel=1e-6)
    assert found.drive.numbers.keys() == expected.keys()
    assert found.drive.name == "data"
    assert found.drive.sha256 == hashlib.sha256(TEXT.encode()).hexdigest()


def test_a_canonical_study_is_read_again_without_its_recording(tmp_path):
    (tmp_path / "recording.csv").write_text(TEXT)
    drive = {"file": "recording.csv", "along": "ax", "normal": "az", "line_frequency": "50 Hz"}
    path = tmp_path / "study.json"
    path.write_text(json.dumps(study(drive)))
    found = load_study(path)
    (tmp_path / "recording.csv").unlink()
    assert parse_json(found.canonical()).key() == found.key()
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
    again = vibrafeed.simulate(sound(study()), frequency=40)
    assert again.attrs["drive"].endswith("; not from it frequency")


def test_a_measured_drive_can_be_optimised():
    content = study(kind="optimise", criterion={"kind": "maximise", "output": "conveying_velocity"})
    for name, lower, upper in (("drive_factor", 0.5, 1.0), ("phase_normal_1", 0, 90)):
        content["variables"] = {name: {"lower": lower, "upper": upper}}
        prepared = prepare_content(content)
        assert prepared.problem.names == (name,)
        assert name not in prepared.study.values()


@pytest.mark.parametrize(
    ("changes", "problems"),
    [
        ({"kind": "optimise", "criterion": {"kind": "maximise", "output": "acceleration_x"},
          "variables": {"drive_factor": {"lower": 0.5, "upper": 1.0}}},
         ["criterion.output: acceleration_x can be computed only for a plain sine, but the study "
          "gives another drive. Use an output of the motion, such as conveying_velocity."]),
        ({"kind": "sweep", "outputs": ["acceleration_x"]},
         ["drive: closed forms cannot use a recorded drive, only a plain sine (amplitude, alpha, "
          'beta). Write kind = "simulate", or give these.']),
        ({"scene": "rectangle-isolated"},
         ["drive: rectangle-isolated cannot use a recorded drive, only a sine. Choose among "]),
        ({"parameters": {"fricton": 0.3}, "drive": {**DATA, "along": "bx"}},
         ["parameters.fricton: ", "drive.along: "]),
        ({"parameters": {"friction": 0.3, "amplitude": "0.2 mm"}}, ["parameters.amplitude: "]),
    ],
)  # fmt: skip
def test_what_has_no_measured_drive_is_refused(changes, problems):
    found = refused(study(**changes))[: len(problems)]
    assert all(one.startswith(words) for one, words in zip(found, problems, strict=True)), found


@pytest.mark.parametrize(
    ("drive", "problems"),
    [
        ({"alogn": "ax", "data": TEXT},
         ["drive.alogn: 'alogn' is not a key of the section drive. Did you mean 'along'?"]),
        ({"along": "ax"},
         ["drive: the section drive names no recording. Give the path of the recording as file, "
          "or the text of the recording's CSV as data."]),
        (DATA | {"file": "x.csv"},
         ["drive: the section drive has both file and data. Give the path of the recording as "
          "file, or the text of the recording's CSV as data."]),
        ({"file": "absent.csv", "along": "ax"},
         ["drive.file: the file cannot be read: No such file or directory. Give the path of a CSV "
          "file, from the folder of the study."]),
        (DATA | {"along": "bx", "harmonics": 20},
         ["drive.along: the table has no column 'bx'. Known: ax, az, time.",
          "drive.harmonics: a fit of 20 harmonics is not possible. Give a whole number from 1 to "
          "10, or leave harmonics out."]),
        ({"data": "", "along": "ax"},
         ["drive.data: the table is empty. Add a row of names and rows of numbers below it."]),
        ("recording.csv",
         ["drive: 'recording.csv' does not say how to read a recording. Write [drive] with file "
          '= "recording.csv" and the columns along and normal.']),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_recording_is_told_and_nothing_that_follows_from_it(drive, problems):
    found = refused(study(drive))
    assert [one for one in found if one.startswith("drive")] == problems
    assert drive == "recording.csv" or found == problems


def test_a_study_of_the_network_reads_no_file_and_no_long_recording(tmp_path, monkeypatch):
    path = tmp_path / "recording.csv"
    path.write_text(TEXT)
    assert refused(study({"file": str(path), "along": "ax"}), files=False) == [
        "drive.file: the service cannot read the recording from your computer. Give "
        "the text of the recording's CSV as data."
    ]
    monkeypatch.setattr(measured, "MAX_ROWS_SENT", 700)
    assert refused(study(), files=False) == [
        "drive.data: the recording has 800 rows, the limit over HTTP is 700. Shorten the "
        "recording: one second of motion is enough."
    ]
    prepare_content(study(), files=True)


def test_a_study_that_is_only_parsed_says_that_nothing_has_been_fitted():
    with pytest.raises(
        StudyError, match="drive: the recording of the drive has not been fitted yet"
    ):
        parse_study(study())


# --- the error of a speed


def test_the_error_of_a_speed_is_that_of_what_comes_from_the_recording():
    fit = fitted(0, CASES["white"])
    numbers = {**fit.parameters(), "friction": 0.3}
    whole, rest = (
        drive_error(study_of(numbers | more), fit) for more in ({}, {"amplitude_along_1": 1.1e-4})
    )
    assert (whole.draws, whole.without) == (200, 0)
    assert 0 < rest.standard_deviation != whole.standard_deviation
    plain = {"frequency": 49, "amplitude": 1e-4, "beta": 20, "friction": [0.2, 0.3]}
    assert [
        str(problem) for problem in problems_of(drive_error, study_of(plain), fit, draws=3)
    ] == [
        "parameters.friction: friction has several values, but the error is computed for a single "
        "design. Give one value of friction.",
        "drive: the study gives all parameters of the drive itself, and uses no recorded value. "
        "Remove these parameters, so that they come from the recording.",
        "draws: 3 draws are outside the limits. Give 20 to 10,000 draws.",
    ]


def test_equal_seeds_give_equal_errors_from_python():
    one, same, other = (vibrafeed.drive_error(study(), draws=20, seed=seed) for seed in (1, 1, 2))
    assert one == same != other
    assert one.velocity == float(vibrafeed.simulate(study()).conveying_velocity)
    with pytest.raises(StudyError, match="the study has no drive from a recording"):
        vibrafeed.drive_error(sound(study()))
