"""Recordings as users have them: what is read, and what they are told of what is not."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from recordings import DRIVE, csv_of, signal_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.measured import Recording, fit_drive, read_signal
from vibrafeed.core.tables import text
from vibrafeed.core.tables.headings import name_and_unit
from vibrafeed.core.tables.read import read_table

PLAIN = "time [s],ax [g],ay\n0,1,2\n0.1,3,-4e-1\n"
TEXT = csv_of(signal_of(DRIVE, count=400))
CHANNELS = Recording(along="ax", normal="az")


def refused(source, recording=CHANNELS):
    """Return the problems, as a user reads them."""
    with pytest.raises(StudyError) as caught:
        read_signal(source, recording)
    return str(caught.value).split("\n")


def changed(line, cells):
    """Return the recording with another line."""
    lines = TEXT.split("\n")
    lines[line - 1] = cells
    return "\n".join(lines)


# --- what is read


@pytest.mark.parametrize(
    "text",
    [
        PLAIN,
        "\ufeff" + PLAIN,
        "# made by hand\n\n" + PLAIN.replace("\n", "\n\n"),
        PLAIN.replace("\n", "\r\n"),
        PLAIN.replace(",", "\t"),
        PLAIN.replace(",", ";").replace(".", ","),
        PLAIN.replace("\n", ",\n"),
        PLAIN.replace("time [s]", '"time (s)"').replace("0.1", '"0.1"'),
        "time,ax,ay\n[s],[g],[]\n0,1,2\n0.1,3,-4e-1",
    ],
)
def test_the_ways_to_write_a_table(text):
    table = read_table(text)
    assert list(table.columns) == ["time", "ax", "ay"]
    assert [column.unit for column in table.columns.values()] == ["s", "g", ""]
    np.testing.assert_array_equal(table.numbers("time", "")[0], [0, 0.1])
    np.testing.assert_array_equal(table.numbers("ay", "")[0], [2, -0.4])


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252"])
def test_files_of_spreadsheets_are_read(tmp_path, encoding):
    file = tmp_path / "recording.csv"
    file.write_bytes("t (ms);ax [m/s²]\n0;1,5\n1;2,5\n".encode(encoding))
    table = read_table(file)
    assert table.columns["ax"].unit == "m/s²"
    np.testing.assert_array_equal(table.numbers("ax", "")[0], [1.5, 2.5])


@settings(max_examples=50)
@given(
    st.lists(st.tuples(*[st.floats(allow_nan=False, allow_infinity=False)] * 2), min_size=1),
    st.sampled_from([",", ";", "\t"]),
)
def test_numbers_come_back_as_they_were(rows, delimiter):
    comma = delimiter != ","
    lines = [delimiter.join(map(repr, row)) for row in rows]
    text = "\n".join(
        [delimiter.join("ab"), *(line.replace(".", ",") if comma else line for line in lines)]
    )
    table = read_table(text)
    read = zip(table.numbers("a", "")[0], table.numbers("b", "")[0], strict=True)
    assert [tuple(map(float, row)) for row in read] == rows


def test_columns_that_are_not_used_may_hold_anything():
    text = "\n".join(
        line + (",remark" if number == 0 else ",it hums")
        for number, line in enumerate(TEXT.splitlines())
    )
    np.testing.assert_array_equal(
        read_signal(text, CHANNELS).values, read_signal(TEXT, CHANNELS).values
    )


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("m s-2", 1), ("m/s^2", 1), ("m/s²", 1), ("mm s-2", 1e-3), ("g", 9.80665), ("mg", 9.80665e-3)],
)
def test_a_unit_stands_in_the_header_or_beside_it(unit, factor):
    plain = read_signal(TEXT, CHANNELS).values
    headed = read_signal(TEXT.replace("m s-2", unit), CHANNELS).values
    beside = read_signal(
        TEXT.replace(" [m s-2]", ""), Recording(along="ax", normal="az", unit=unit)
    ).values
    np.testing.assert_allclose(headed, factor * plain)
    np.testing.assert_array_equal(headed, beside)


def test_a_rate_takes_the_place_of_times():
    timed = read_signal(TEXT, CHANNELS)
    rated = read_signal(TEXT, Recording(along="ax", normal="az", rate="2 kHz"))
    np.testing.assert_allclose(timed.times, rated.times, atol=1e-12)


def test_times_rounded_by_the_recorder_are_made_even():
    signal = signal_of(DRIVE, rate=3000.0, count=600)
    rounded = read_signal(csv_of(signal._replace(times=np.round(signal.times, 4))), CHANNELS)
    np.testing.assert_allclose(np.diff(rounded.times), 1 / 3000, rtol=1e-3)
    jitter = np.random.default_rng(1).uniform(-0.05, 0.05, 600) / 3000
    kept = read_signal(csv_of(signal._replace(times=signal.times + jitter)), CHANNELS)
    np.testing.assert_allclose(kept.times, signal.times + jitter - jitter[0], atol=1e-12)


# --- mounting


@settings(max_examples=10, deadline=None)
@given(st.tuples(*[st.floats(-180, 180)] * 3))
def test_a_turned_sensor_shows_the_same_drive(angles):
    three = signal_of({**DRIVE, "across": [(3e-5, 1.0)]}, count=400)
    along, normal, across = three.values
    track = np.array([along, across, normal])
    yaw, pitch, roll = np.radians(angles)
    matrix = (
        Rotation.from_rotvec([0, 0, yaw])
        * Rotation.from_rotvec([0, pitch, 0])
        * Rotation.from_rotvec([roll, 0, 0])
    ).as_matrix()
    sensor = three._replace(values=matrix.T @ track)
    text = csv_of(sensor, names=("x", "y", "z"))
    for mounting in (angles, matrix.tolist()):
        read = read_signal(text, Recording(sensor=("x", "y", "z"), mounting=mounting))
        assert read.axes == ("along", "across", "normal")
        np.testing.assert_allclose(read.values, track, atol=1e-9)


def test_yaw_turns_the_sensor_from_along_to_across():
    signal = signal_of({"along": [(1e-4, 0.0)], "across": [(0.0, 0.0)], "normal": [(0.0, 0.0)]})
    text = csv_of(signal, names=("x", "y", "z"))
    fit = fit_drive(text, Recording(sensor=("x", "y", "z"), mounting=(90, 0, 0)))
    # The sensor's x points to the left of the transport.
    assert fit.parameters()["amplitude_across_1"] == pytest.approx(1e-4)
    assert "amplitude_along_1" not in fit.parameters()


# --- what is refused


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the table is empty. Give a row of names, and rows of numbers below."),
        (
            "# nothing\n\n",
            "the table is empty. Give a row of names, and rows of numbers below.",
        ),
        ("ax,az\n", "the table holds no numbers. Give rows of numbers below the names."),
        (
            "ax,az\n1,2,3",
            "line 2 has 3 cells, but the heading has 2. Where a comma is a decimal comma, separate "
            "the cells by semicolons.",
        ),
    ],
)
def test_what_is_no_table(text, message):
    (line,) = refused(text)
    assert line.startswith(f"recording: {message}")


def test_endless_lines_are_not_taken_apart():
    assert refused(30_000 * "a,") == [
        "recording: line 1 has 60,000 letters. Keep the columns in use."
    ]


def test_decimal_commas_between_commas_are_guessed():
    lines = refused("ax,az\n" + 5 * "1,5,2,5\n")
    assert lines[-1] == (
        "recording: line 2 has 4 cells, but the heading has 2 (5 such lines). Where a comma is a "
        "decimal comma, separate the cells by semicolons."
    )


def test_files_that_are_too_large_or_no_text_are_refused(tmp_path, monkeypatch):
    file = tmp_path / "recording.bin"
    file.write_bytes(b"ax\0az")
    assert refused(file) == [
        "recording: recording.bin: it is not text in UTF-8, UTF-16 or Windows-1252. Export the "
        "table as CSV, in UTF-8."
    ]
    monkeypatch.setattr("vibrafeed.core.tables.read.MAX_BYTES", 1000)
    file.write_bytes(TEXT.encode())
    assert "MB, the limit is 0 MB. Shorten it" in refused(file)[0]
    monkeypatch.undo()
    monkeypatch.setattr("vibrafeed.core.tables.read.MAX_ROWS", 100)
    told = refused(TEXT)[0]
    assert told.startswith("recording: it has more than 100 rows. Shorten it")


def test_unknown_columns_are_named_with_what_is_there():
    assert refused(TEXT, Recording(along="ay", normal="acceleration")) == [
        "along: the table has no column 'ay'. Known: ax, az, time.",
        "normal: the table has no column 'acceleration'. Known: ax, az, time.",
    ]
    text = TEXT.replace("ax", "track_x")
    assert refused(text, Recording(along="trackx")) == [
        "along: the table has no column 'trackx'. Did you mean 'track_x'?"
    ]


@pytest.mark.parametrize("cell", ["", "nan", "inf", "-", "1e999", "0x10"])
def test_cells_that_are_no_numbers_are_told_by_line(cell):
    (line,) = refused(changed(17, f"0.0075,{cell},1.5"))
    assert line == (
        f"along: line 17 of column 'ax' is not a number: {cell!r}. Correct the line, or remove it."
    )


def test_of_many_faulty_cells_the_first_is_shown():
    (line,) = refused(TEXT.replace("-", "--"), Recording(along="ax"))
    assert "line 2 of column 'ax' is not a number" in line
    assert "such cells). Correct the line" in line


def test_everything_that_is_wrong_is_told_at_once():
    recording = Recording(
        sensor=("ax", "az", "none"), mounting=(0, "up", 0), unit="Pa", rate="5 m", harmonics=11,
        line_frequency="3 mm", frequency=-1,
    )  # fmt: skip
    text = "\n".join(TEXT.splitlines()[:50]).replace(" [m s-2]", "")
    places = [line.split(":")[0] for line in refused(text, recording)]
    assert sorted(places) == sorted(
        [
            "rate",
            "unit",
            "sensor.z",
            "mounting.pitch",
            "line_frequency",
            "frequency",
            "harmonics",
            "recording",
        ]
    )


def test_times_that_are_none():
    assert refused(TEXT.replace("time [s]", "moment")) == [
        "rate: the recording has neither a sampling rate nor a column of times. Give rate = the "
        "samples per second, or time = the name of the column of times."
    ]
    assert refused(TEXT.replace("time [s]", "time [kg]"))[0].startswith(
        "time: the recording's time column has the unit 'kg', which is not a unit of time"
    )
    both = Recording(along="ax", time="time", rate=2000)
    assert refused(TEXT, both)[0].startswith(
        "rate: the recording has both a sampling rate (rate) and"
    )
    signal = signal_of(DRIVE, count=400)
    back = signal.times.copy()
    back[100] = back[99]
    assert refused(csv_of(signal._replace(times=back))) == [
        "time: the times in the recording's column 'time' do not increase in 1 place, first "
        "in line 102. Write the "
        "times with more digits, or give the sampling rate (rate) and leave time out."
    ]


def test_of_a_recording_with_a_large_gap_the_longest_piece_is_used():
    signal = signal_of(DRIVE, count=400)
    read = read_signal(
        csv_of(signal._replace(times=signal.times + 0.05 * (np.arange(400) > 99))), CHANNELS
    )
    np.testing.assert_array_equal(read.values, signal.values[:, 100:])
    np.testing.assert_allclose(read.times, signal.times[:300], atol=1e-12)
    assert read.notes == (
        "the recording has 1 gap: the fit uses the longest piece without one, 300 of 400 samples",
    )


def test_a_clipped_channel_is_told():
    signal = signal_of(DRIVE, count=400)
    held = signal._replace(values=np.minimum(signal.values, 10.0))
    lines = refused(csv_of(held))
    assert [line.split(":")[0] for line in lines] == ["along", "normal"]
    assert "column 'ax' is clipped: " in lines[0]
    assert lines[0].endswith(
        "samples hold its highest value 10, first in line 31. Record again with a wider range of "
        "the sensor."
    )


@pytest.mark.parametrize("share", [0.5, 0.9])
def test_a_channel_that_is_clipped_for_less_than_two_samples_is_told(share):
    """As a motor was: crests of a millisecond, recorded every millisecond."""
    signal = signal_of({"along": DRIVE["along"]}, frequency=49.6, rate=1000.0, count=5000)
    rounded = np.round(signal.values, 2)
    most = np.round(share * rounded.max(), 2)
    held = signal._replace(values=np.minimum(rounded, most))
    (line,) = refused(csv_of(held, names=["ax"]), Recording(along="ax"))
    assert f"samples hold its highest value {most:g}, first in line" in line


@pytest.mark.parametrize("digits", [0, 1, 3])
@pytest.mark.parametrize("frequency", [50.0, 50.0005, 50.01])
@pytest.mark.parametrize("noise", [0.0, 0.2])
def test_a_crest_that_is_met_at_one_phase_is_not_clipped(digits, frequency, noise):
    """The rate is a multiple of the frequency, or nearly: one sample a period is the highest."""
    signal = signal_of({"along": DRIVE["along"]}, frequency=frequency, rate=1000.0, count=5000)
    jitter = noise * 0.1**digits * np.random.default_rng(1).normal(size=5000)
    rounded = signal._replace(values=np.round(signal.values + jitter, digits))
    assert read_signal(csv_of(rounded, names=["ax"]), Recording(along="ax")).axes == ("along",)


@pytest.mark.parametrize("steps", [3, 10, 30, 100, 1000])
@pytest.mark.parametrize("rate", [500.0, 2000.0, 20_000.0])
def test_a_crest_that_is_rounded_is_not_clipped(steps, rate):
    signal = signal_of({"along": [(1e-4, 0.2)]}, frequency=49.9, rate=rate, count=int(rate))
    step = np.abs(signal.values).max() / steps
    rounded = signal._replace(values=step * np.round(signal.values / step))
    assert read_signal(csv_of(rounded, names=["ax"]), Recording(along="ax")).axes == ("along",)


@pytest.mark.parametrize(
    ("recording", "message"),
    [
        (
            Recording(),
            "along: the drive names no column of accelerations. Name the "
            "columns: along = ..., normal = ...",
        ),
        (
            Recording(along="ax", mounting=(0, 0, 90)),
            "mounting: the mounting is that of a sensor of three columns",
        ),
        (
            Recording(sensor=("ax", "az")),
            "sensor: sensor does not name three columns of the recording. Name the columns",
        ),
        (
            Recording(sensor="axy"),
            "sensor: sensor does not name three columns of the recording. Name the columns",
        ),
        (
            Recording(along="ax", sensor=("ax", "ax", "ax")),
            "sensor: the drive names the columns of a sensor, and single ones (along)",
        ),
        (
            Recording(along="ax", unit="fortnight"),
            "unit: 'fortnight' is not a unit of acceleration. Known:",
        ),
    ],
)
def test_channels_that_cannot_be_told(recording, message):
    assert refused(TEXT, recording)[0].startswith(message)


def test_a_channel_without_a_unit_is_told_where_to_write_it():
    assert refused(TEXT.replace("ax [m s-2]", "ax")) == [
        "unit: the unit of the recording's column 'ax' is not given. Give unit = one of m "
        "s-2, mm s-2, cm/s2, g, mg, mm/s, mm, or write the unit in the header: 'ax [g]'."
    ]
    assert refused(TEXT.replace("ax [m s-2]", "ax [V]"))[0].startswith(
        "along: column 'ax' is a voltage (V). Give the sensor's sensitivity"
    )
    assert refused(TEXT.replace("ax [m s-2]", "ax [Pa]"))[0].startswith(
        "along: 'Pa' is not a unit of acceleration. Known: m s-2"
    )


@pytest.mark.parametrize(
    ("mounting", "message"),
    [
        ((0, 0), "the mounting of the sensor is neither three angles nor a matrix"),
        ("level", "the mounting of the sensor is neither three angles nor a matrix"),
        (
            ((1, 0, 0), (0, 1, 0), (0, 0, 2)),
            "the mounting of the sensor is a matrix that is not a rotation",
        ),
        (
            ((1,), (0, 1, 0), (0, 0, 2)),
            "the mounting of the sensor is a matrix that is not a rotation",
        ),
        (
            ((1, 0, 0), (0, 1, 0), (0, 0, -1)),
            "the mounting of the sensor is a matrix that mirrors the axes",
        ),
    ],
)
def test_mountings_that_are_none(mounting, message):
    three = Recording(sensor=("ax", "az", "-ax"), mounting=mounting)
    assert refused(TEXT, three)[0].startswith(f"mounting: {message}")


@pytest.mark.parametrize(
    ("heading", "name", "unit"),
    [
        ("ax", "ax", ""), (" ax [m/s2] ", "ax", "m/s2"), ("ax (g)", "ax", "g"),
        ("speed (x) [mm/s]", "speed (x)", "mm/s"), ("[g]", "[g]", ""), ("a]", "a]", ""),
        ("a [b] c", "a [b] c", ""), ("a [b", "a [b", ""), ("a []", "a", ""), ("", "", ""),
        ("a [b)", "a", "b"), ("a (b (c))", "a (b (c))", ""),
    ],
)  # fmt: skip
def test_a_heading_has_a_name_and_perhaps_a_unit(heading, name, unit):
    assert name_and_unit(heading) == (name, unit)


def test_no_pattern_of_headings_tries_one_place_after_the_other():
    """Blanks between name and bracket, 20,000 of them, held the interpreter for seconds."""
    source = Path(text.__file__).read_text()
    patterns = re.findall(r're\.compile\(r"(.*?)"\)', source)
    assert patterns
    for pattern in patterns:
        assert ".*?" not in pattern, pattern
        assert r"\s*" not in pattern, pattern
    assert name_and_unit("a" + " " * 100_000 + "[" * 100_000) == (
        "a" + " " * 100_000 + "[" * 100_000, "",
    )  # fmt: skip


@pytest.mark.parametrize("size", [1e-300, 1e-12, 1e300])
@pytest.mark.parametrize("what", ["rate", "values"])
def test_times_and_values_that_no_recorder_writes_are_refused(what, size):
    """A rate of 1e-300 ended as an error of the program, not of the study."""
    phases = 0.3 * np.arange(400)
    values = np.stack([np.sin(phases), np.cos(phases)], axis=1) * (size if what == "values" else 1)
    text = "ax [m/s2],az [m/s2]\n" + "\n".join(f"{a!r},{b!r}" for a, b in values.tolist())
    drive = {"data": text, "along": "ax", "normal": "az"}
    drive["rate"] = size if what == "rate" else 1000
    study = {"kind": "simulate", "scene": "rectangle-on-plane", "parameters": {"friction": 0.4}}
    with np.errstate(all="raise"), pytest.raises(StudyError) as refused:
        prepare_content({**study, "drive": drive})
    (problem,) = refused.value.problems
    assert problem.place == "drive.data"
    assert (
        "a sample every" if what == "rate" else "of the recording range over"
    ) in problem.message
