"""Recordings and observations as users have them: what is read, and what is said of the rest."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from recordings import DRIVE, csv_of, signal_of
from refusals import problems_of, words_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.intake.forms import resolve_files
from vibrafeed.core.intake.sections import read_rows
from vibrafeed.core.measured import Recording, read_signal
from vibrafeed.core.tables.headings import name_and_unit
from vibrafeed.core.tables.read import read_table

PLAIN = "time [s],ax [g],ay\n0,1,2\n0.1,3,-4e-1\n"
TEXT = csv_of(signal_of(DRIVE, count=400))
CHANNELS = Recording(along="ax", normal="az")


def refused(source, recording=CHANNELS):
    """Return the problems, as a user reads them."""
    return words_of(read_signal, source, recording).split("\n")


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
    assert {name: column.unit for name, column in table.columns.items()} == {
        "time": "s", "ax": "g", "ay": "",
    }  # fmt: skip
    values = [table.numbers(name, "")[0].tolist() for name in table.columns]
    assert values == [[0, 0.1], [1, 3], [2, -0.4]]


@settings(max_examples=50)
@given(
    st.lists(st.tuples(*[st.floats(allow_nan=False, allow_infinity=False)] * 2), min_size=1),
    st.sampled_from([",", ";", "\t"]),
)
def test_numbers_come_back_as_they_were(rows, delimiter):
    lines = [delimiter.join(map(repr, row)) for row in rows]
    if delimiter != ",":
        lines = [line.replace(".", ",") for line in lines]
    table = read_table("\n".join([delimiter.join("ab"), *lines]))
    read = np.stack([table.numbers(name, "")[0] for name in "ab"], axis=1)
    np.testing.assert_array_equal(read, rows)


@pytest.mark.parametrize(
    ("unit", "factor"), [("m/s^2", 1), ("mm s-2", 1e-3), ("g", 9.80665), ("mg", 9.80665e-3)]
)
def test_a_unit_stands_in_the_header_or_beside_it(unit, factor):
    plain = read_signal(TEXT, CHANNELS).values
    headed = read_signal(TEXT.replace("m s-2", unit), CHANNELS)
    # Columns that are not used may hold anything; a rate takes the place of times.
    untimed = TEXT.replace(" [m s-2]", "").replace("time [s]", "remark").replace("\n0", "\nit hums")
    rated = Recording(along="ax", normal="az", unit=unit, rate="2 kHz")
    beside = read_signal(untimed, rated)
    np.testing.assert_allclose(headed.values, factor * plain)
    np.testing.assert_array_equal(headed.values, beside.values)
    np.testing.assert_allclose(headed.times, beside.times, atol=1e-12)


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
    # Yaw, pitch, roll: about z, y and x of the sensor in turn.
    matrix = Rotation.from_euler("ZYX", angles, degrees=True).as_matrix()
    text = csv_of(three._replace(values=matrix.T @ track), names=("x", "y", "z"))
    for mounting in (angles, matrix.tolist()):
        read = read_signal(text, Recording(sensor=("x", "y", "z"), mounting=mounting))
        assert read.axes == ("along", "across", "normal")
        np.testing.assert_allclose(read.values, track, atol=1e-9)


SIGNAL = signal_of(DRIVE, count=400)


AT_ONCE = Recording(
    sensor=("ax", "az", "none"), mounting=(0, "up", 0), unit="V", rate="5 m", harmonics=11,
    line_frequency="3 mm", frequency=-1,
)  # fmt: skip


CREST = signal_of({"along": DRIVE["along"]}, frequency=49.6, rate=1000.0, count=5000)


EMPTY = "recording: the table is empty. Add a row of names and rows of numbers below it."


NOT_WHOLE = "Where a comma is a decimal comma, separate the cells by semicolons."


def with_times(times):
    return csv_of(SIGNAL._replace(times=times))


def crests(share):
    """As a motor was: crests of a millisecond, recorded every millisecond, and clipped."""
    rounded = np.round(CREST.values, 2)
    most = np.round(share * rounded.max(), 2)
    return csv_of(CREST._replace(values=np.minimum(rounded, most)), names=["ax"])


@pytest.mark.parametrize(
    ("text", "recording", "lines"),
    [
        ("", CHANNELS, [EMPTY]),
        ("# nothing\n\n", CHANNELS, [EMPTY]),
        ("ax,az\n", CHANNELS,
         ["recording: the table has no numbers. Add rows of numbers below the names."]),
        (TEXT.partition("\n")[2], Recording(along="ax", rate=2000, unit="g"),
         ["along: the table has no column 'ax'. The columns have no names: give a number from 1"]),
        (TEXT.replace("az", "ax"), Recording(along="ax"),
         ["along: two columns have the name 'ax'. Rename one."]),
        (30_000 * "a,", CHANNELS,
         ["recording: line 1 has 60,000 characters. Remove columns that are not used."]),
        *(("ax,az\n" + lines * "1,5,2,5\n", CHANNELS,
           ["recording: line 2 has 4 cells, but the heading has 2 "
            f"({lines} such lines). {NOT_WHOLE}"])
          for lines in (2, 5)),
        (TEXT, Recording(along="ay", normal="acceleration"),
         ["along: the table has no column 'ay'. Known: ax, az, time.",
          "normal: the table has no column 'acceleration'. Known: ax, az, time."]),
        (TEXT.replace("ax", "track_x"), Recording(along="trackx"),
         ["along: the table has no column 'trackx'. Did you mean 'track_x'?"]),
        *((changed(17, f"0.0075,{cell},1.5"), CHANNELS,
           [f"along: line 17 of column 'ax' is not a number: {cell!r}. Correct or"])
          for cell in ("", "nan", "-", "1e999", "0x10")),
        (TEXT.replace("-", "--"), Recording(along="ax", rate=2000),
         ["along: line 2 of column 'ax' is not a number: '--0.04814874387008761' (200 such cells"]),
        ("\n".join(TEXT.splitlines()[:50]).replace(" [m s-2]", ""), AT_ONCE,
         ["rate", "sensor.x", "sensor.y", "sensor.z", "mounting.pitch", "line_frequency",
          "frequency", "harmonics", "recording"]),
        (TEXT.replace("time [s]", "moment"), CHANNELS,
         ["rate: the recording has neither a sampling rate nor a time column. Give rate ="]),
        (TEXT, Recording(along="ax", time="time", rate=2000),
         ["rate: the recording has both a sampling rate (rate) and"]),
        (with_times(np.where(np.arange(400) == 100, SIGNAL.times[99], SIGNAL.times)), CHANNELS,
         ["time: the times in the recording's column 'time' do not increase in 1 place, first "
          "in line 102. Write the times with more digits, or give the sampling rate (rate) and "
          "leave time out."]),
        (csv_of(SIGNAL._replace(values=np.minimum(SIGNAL.values, 10.0))), CHANNELS,
         ["along: column 'ax' is clipped: ", "normal: "]),
        *((crests(share), Recording(along="ax"), ["along: column 'ax' is clipped: "])
          for share in (0.5, 0.9)),
        (TEXT, Recording(),
         ["along: the drive names no column of accelerations. Name the columns: along = ..., "]),
        (TEXT, Recording(along="ax", mounting=(0, 0, 90)),
         ["mounting: the mounting needs the three columns of a triaxial sensor"]),
        (TEXT, Recording(sensor=("ax", "az")),
         ["sensor: sensor does not name three columns of the recording. Name the columns"]),
        (TEXT, Recording(sensor="axy"), ["sensor: sensor does not name three columns"]),
        (TEXT, Recording(along="ax", sensor=("ax", "ax", "ax")),
         ["sensor: columns are given twice: three of a sensor (sensor) and others (along)"]),
        (TEXT, Recording(along="ax", unit="kg"),
         ["unit: 'kg' is not a unit of acceleration. Known:"]),
        (TEXT.replace("ax [m s-2]", "ax"), CHANNELS,
         ["unit: the unit of the recording's column 'ax' is not given. Give unit = one of m s-2, "
          "mm s-2, cm/s2, g, mg, mm/s, mm, or write the unit in the header: 'ax [g]'."]),
        (TEXT.replace("ax [m s-2]", "ax [V]"), CHANNELS,
         ["along: column 'ax' is a voltage (V). Give the sensor's sensitivity"]),
        *((TEXT, Recording(sensor=("ax", "az", "-ax"), mounting=mounting),
           [f"mounting: the mounting of the sensor is {words}"])
          for mounting, words in (
              ((0, 0), "neither three angles nor a rotation matrix"),
              ("level", "neither three angles nor a rotation matrix"),
              (((1, 0, 0), (0, 1, 0), (0, 0, 2)), "a matrix that is not a rotation"),
              (((1,), (0, 1, 0), (0, 0, 2)), "a matrix that is not a rotation"),
              (((1, 0, 0), (0, 1, 0), (0, 0, -1)), "a matrix that mirrors the axes"),
          )),
    ],
)  # fmt: skip
def test_what_is_no_recording_is_told(text, recording, lines):
    told = refused(text, recording)
    assert len(told) == len(lines), told
    for line in lines:
        assert any(one.startswith(line) for one in told), told


# --- what is refused


def test_files_that_are_too_large_or_no_text_are_refused(tmp_path, monkeypatch):
    file = tmp_path / "recording.bin"
    file.write_bytes(b"ax\0az")
    assert refused(file) == [
        "recording: recording.bin: it is not text in UTF-8, UTF-16 or Windows-1252. Export the "
        "table as CSV, in UTF-8."
    ]
    for content, limit, value, words in (
        (TEXT.encode(), "MAX_ROWS", 100, "recording: the table has more than 100 rows. Shorten it"),
        (bytes(5_000_000), "MAX_BYTES", 3_000_000, "has 5 MB, the limit is 3 MB. Shorten it"),
    ):
        file.write_bytes(content)
        monkeypatch.setattr(f"vibrafeed.core.tables.read.{limit}", value)
        assert words in refused(file)[0]


@pytest.mark.parametrize("frequency", [50.0, 50.0005])
@pytest.mark.parametrize(("digits", "noise"), [(0, 0.0), (1, 0.2), (3, 0.0)])
def test_a_crest_that_is_met_at_one_phase_is_not_clipped(digits, frequency, noise):
    """The rate is a multiple of the frequency, or nearly: one sample a period is the highest."""
    signal = signal_of({"along": DRIVE["along"]}, frequency=frequency, rate=1000.0, count=5000)
    jitter = noise * 0.1**digits * np.random.default_rng(1).normal(size=5000)
    rounded = signal._replace(values=np.round(signal.values + jitter, digits))
    assert read_signal(csv_of(rounded, names=["ax"]), Recording(along="ax")).axes == ("along",)


@pytest.mark.parametrize(("rate", "steps"), [(500.0, 3), (2000.0, 10), (2000.0, 100), (5e3, 30)])
def test_a_crest_that_is_rounded_is_not_clipped(steps, rate):
    signal = signal_of({"along": [(1e-4, 0.2)]}, frequency=49.9, rate=rate, count=int(rate))
    step = np.abs(signal.values).max() / steps
    rounded = signal._replace(values=step * np.round(signal.values / step))
    assert read_signal(csv_of(rounded, names=["ax"]), Recording(along="ax")).axes == ("along",)


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
    heading = "a" + " " * 100_000 + "[" * 100_000
    assert name_and_unit(heading) == (heading, "")


@pytest.mark.parametrize(
    ("rate", "size", "words"),
    [(1e-300, 1, "one sample every"), (1e300, 1, "one sample every"),
     (1000, 1e-300, "recorded values vary by"), (1000, 1e300, "recorded values vary by")],
)  # fmt: skip
def test_times_and_values_that_no_recorder_writes_are_refused(rate, size, words):
    """A rate of 1e-300 ended as an error of the program, not of the study."""
    values = size * np.sin(0.3 * np.arange(400)[:, None] + [0, 1])
    text = "ax [m/s2],az [m/s2]\n" + "\n".join(f"{a!r},{b!r}" for a, b in values.tolist())
    study = {
        "kind": "simulate", "scene": "rectangle-on-plane", "parameters": {"friction": 0.4},
        "drive": {"data": text, "along": "ax", "normal": "az", "rate": rate},
    }  # fmt: skip
    with np.errstate(all="raise"), pytest.raises(StudyError) as caught:
        prepare_content(study)
    (problem,) = caught.value.problems
    assert problem.place == "drive.data"
    assert words in problem.message


TIMES = np.arange(200) / 2000
ROWS = [f"{t:.4f},{a:.5f},{1 + a:.5f}" for t, a in zip(TIMES, np.sin(628 * TIMES), strict=True)]
AX_AZ = Recording(along="ax", normal="az")
G = 9.80665
MINUS = "\N{MINUS SIGN}"


def table(time="time [s]", along="ax [g]", normal="az [g]", separator=","):
    lines = [separator.join((time, along, normal)), *(r.replace(",", separator) for r in ROWS)]
    return "\n".join(lines) + "\n"


def signal(source, **more):
    return read_signal(source, Recording(along="ax", normal="az", **more))


def refusal(source, **more):
    return [str(problem) for problem in problems_of(signal, source, **more)]


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        ("(G)", G), ("(gn)", G), ("[mG]", G / 1000), ("[m·s⁻²]", 1), ("[m.s-2]", 1),
        (f"[m s{MINUS}2]", 1), ("[ms-2]", 1), ("[m s^-2]", 1), ("[mm s-2]", 1e-3),
        ("[cm/s2]", 0.01), ("[in/s²]", 0.0254),
    ],
)  # fmt: skip
def test_channels_have_the_units_of_studies(unit, factor):
    right = signal(table()).values / G * factor
    text = table(along=f"ax {unit}", normal=f"az {unit}", separator=";")
    for one in (text, text.replace("-0", f"{MINUS}0")):  # true minus signs
        np.testing.assert_allclose(signal(one).values, right, rtol=1e-15)


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("(sec)", 1), ("[Sec]", 1), ("(seconds)", 1), ("[ms]", 1e-3), ("[µs]", 1e-6), ("[μs]", 1e-6),
     ("(us)", 1e-6), ("[min]", 60)],
)  # fmt: skip
def test_times_have_the_units_of_studies(unit, factor):
    np.testing.assert_allclose(
        signal(table(time=f"time {unit}")).times, TIMES * factor, rtol=1e-12, atol=1e-15 * factor
    )


def test_the_key_unit_overrules_the_heading():
    unknown = table(along="ax [LSB]", normal="az [raw]")
    known = signal(table()).values
    for text in (unknown, table(along="ax [V]"), table(along="ax [mg]")):
        np.testing.assert_array_equal(signal(text, unit="g").values, known)
    for text, unit, words in (
        (unknown, None, "'LSB' is not a unit"),
        (unknown, "kg", "'kg' is not a unit of acceleration"),
    ):
        assert words in refusal(text, unit=unit)[0]


@pytest.mark.parametrize("rate", ["2000 samples/s", "2000 sps", "2 kHz", "120000/min"])
def test_a_rate_is_written_as_recorders_have_it(rate):
    untimed = table(time="number")
    np.testing.assert_array_equal(
        signal(untimed, rate=rate).times, signal(untimed, rate=2000).times
    )


RUNS = f"amplitude [µm];conveying_velocity [m s-1];gamma [º];error\n100;0,0035;{MINUS}2;5 %\n"
READ = [
    {"amplitude": "100 µm", "conveying_velocity": "0.0035 m s-1", "gamma": "-2 º", "error": "5 %"}
]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
def test_all_tables_are_read_in_the_encodings_of_spreadsheets(tmp_path, encoding):
    runs, drive = (tmp_path / name for name in ("runs.csv", "drive.csv"))
    text = RUNS if encoding != "cp1252" else RUNS.replace(MINUS, "-")
    runs.write_bytes(text.encode(encoding))
    assert read_rows(runs) == READ
    recorded = table(time="time [µs]", along="ax [m/s²]")
    drive.write_bytes(recorded.encode(encoding))
    assert signal(drive).values[0, 1] == pytest.approx(np.sin(0.314), abs=1e-5)
    content = {"kind": "simulate", "drive": {"file": str(drive), "along": "ax"}}
    assert resolve_files(content, "curl", tmp_path)["drive"]["data"] == recorded


BARE = ("-.05", f"{MINUS}0.05", "\N{EN DASH}0.05", "+5e-2", ".05", " 0.05", "0.05 ")


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        # A bare number never loses the unit of its heading.
        *((f"gamma [rad],amplitude [mm]\n{bare},1.\n", 1) for bare in BARE),
        # A line may name the separator and a cell its own unit.
        ("sep=;\n# bowl 3\nfrequency [rpm];amplitude [mm]\n3000;0,3\n50,5 Hz;300 um\n",
         [{"frequency": "3000 rpm", "amplitude": "0.3 mm"},
          {"frequency": "50.5 Hz", "amplitude": "300 um"}]),
        ("amplitude [mm],conveying_velocity [mm/s]\n0.35,20,,\n",
         [{"amplitude": "0.35 mm", "conveying_velocity": "20 mm/s"}]),
    ],
)  # fmt: skip
def test_rows_of_observations(tmp_path, text, rows):
    (tmp_path / "runs.csv").write_text(text, encoding="utf-8")
    found = read_rows(tmp_path / "runs.csv")
    if rows == 1:
        assert found[0]["gamma"].endswith(" rad")
        assert found[0]["amplitude"] == "1. mm"
    else:
        assert found == rows


HEAD = "frequency [rpm];amplitude [mm]\n"


@pytest.mark.parametrize(
    ("data", "words"),
    [
        # 3,000 rpm had been read as 3.000 rpm.
        *(((HEAD + cells).encode(), "thousands")
          for cells in ("3,000;0.3", "3.000;0,3", "3,000;1\n900;1", "3,000 rpm;0.3 mm")),
        # 0,35 between commas is two cells: the second had been dropped, and 0 mm was read.
        (b"amplitude [mm],conveying_velocity [mm/s]\n0,35,20,5\n",
         "line 2 has 4 cells, but the heading has 2"),
        (b'amplitude,friction\n"0,35",0.3\n', "one of the two marks separates thousands"),
        (b"amplitude [mm]\n1\n\0\n", "it is not text in UTF-8, UTF-16 or Windows"),
    ],
)  # fmt: skip
def test_rows_that_may_be_read_wrongly_are_refused(tmp_path, data, words):
    (tmp_path / "runs.csv").write_bytes(data)
    with pytest.raises(StudyError, match=words):
        read_rows(tmp_path / "runs.csv")


def test_cells_of_a_workbook_keep_their_sign_and_their_per_cent(tmp_path):
    book = pytest.importorskip("openpyxl").Workbook()
    sheet = book.active
    blank = [[None]] * 1_200  # blank rows, which once hid what is below them
    for line in (
        ["gamma [deg]", "amplitude [mm]", "error"],
        [f"{MINUS}5", 0.3, 0.05],
        *blank,
        [5, 0.4, 1],
    ):
        sheet.append(line)
    sheet["C2"].number_format = "0 %"
    book.save(tmp_path / "runs.xlsx")
    first, second = read_rows(tmp_path / "runs.xlsx")
    assert (first["gamma"], first["error"]) == ("-5 deg", "5 %")
    assert (second["gamma"], second["amplitude"]) == ("5 deg", "0.4 mm")
