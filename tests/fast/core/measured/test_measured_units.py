"""Recordings and observations share units, encodings and signs of numbers."""

from __future__ import annotations

import numpy as np
import pytest

from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake.forms import resolve_files
from vibrafeed.core.intake.sections import read_rows
from vibrafeed.core.measured import Recording, read_signal

TIMES = np.arange(200) / 2000
ROWS = [f"{t:.4f},{a:.5f},{1 + a:.5f}" for t, a in zip(TIMES, np.sin(628 * TIMES), strict=True)]
CHANNELS = Recording(along="ax", normal="az")
G = 9.80665
MINUS = "\N{MINUS SIGN}"


def table(time="time [s]", along="ax [g]", normal="az [g]", separator=","):
    lines = [separator.join((time, along, normal)), *(r.replace(",", separator) for r in ROWS)]
    return "\n".join(lines) + "\n"


def signal(source, **more):
    return read_signal(source, Recording(along="ax", normal="az", **more))


def refusal(source, **more):
    with pytest.raises(StudyError) as caught:
        signal(source, **more)
    return [str(problem) for problem in caught.value.problems]


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        ("(G)", G), ("(gn)", G), ("[mG]", G / 1000), ("[m·s⁻²]", 1), ("[m.s-2]", 1),
        (f"[m s{MINUS}2]", 1), ("[ms-2]", 1), ("[m s^-2]", 1), ("[mm s-2]", 1e-3),
        ("[cm/s2]", 0.01), ("[in/s²]", 0.0254),
    ],
)  # fmt: skip
def test_channels_have_the_units_of_studies(unit, factor):
    right = signal(table()).accelerations / G * factor
    text = table(along=f"ax {unit}", normal=f"az {unit}", separator=";")
    for one in (text, text.replace("-0", f"{MINUS}0")):  # true minus signs
        np.testing.assert_allclose(signal(one).accelerations, right, rtol=1e-15)


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("(sec)", 1), ("[Sec]", 1), ("(seconds)", 1), ("[ms]", 1e-3), ("[µs]", 1e-6), ("[μs]", 1e-6),
     ("(us)", 1e-6), ("[min]", 60)],
)  # fmt: skip
def test_times_have_the_units_of_studies(unit, factor):
    np.testing.assert_allclose(
        signal(table(time=f"time {unit}")).times, TIMES * factor, rtol=1e-12, atol=1e-15 * factor
    )


def test_the_key_unit_overrules_a_word_that_is_no_unit():
    unknown = table(along="ax [LSB]", normal="az [raw]")
    known = signal(table()).accelerations
    np.testing.assert_array_equal(signal(unknown, unit="g").accelerations, known)
    for text, unit, words in (
        (unknown, None, "'LSB' is not a unit"),
        (unknown, "kg", "'kg' is not a unit of acceleration"),
        (table(along="ax [V]"), "g", "'V' is not a unit of acceleration"),
        (table(along="ax [mg]"), "g", "has two units: mg in its header"),
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
    assert signal(drive).accelerations[0, 1] == pytest.approx(np.sin(0.314), abs=1e-5)
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
        # This is refused later, with the reason.
        ('amplitude,friction\n"0,35",0.3\n', [{"amplitude": "0,35", "friction": 0.3}]),
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
         r"row 1 of runs\.csv has more cells than the heading"),
        # Without a mark it may be anything.
        ("amplitude [mm]\n1\n".encode("utf-16-le"), "it is not text in UTF-8, UTF-16 or Windows"),
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
