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
        ("(G)", G), ("[g]", G), ("(gn)", G), ("[mG]", G / 1000), ("[mg]", G / 1000),
        ("[m·s⁻²]", 1), ("[m/s²]", 1), ("(m s-2)", 1), ("[m.s-2]", 1), (f"[m s{MINUS}2]", 1),
        ("[ms-2]", 1), ("[m s^-2]", 1), ("[mm s-2]", 1e-3), ("(mm/s^2)", 1e-3), ("[cm/s2]", 0.01),
        ("[in/s²]", 0.0254),
    ],
)  # fmt: skip
@pytest.mark.parametrize("separator", [",", ";"])
def test_channels_have_the_units_of_studies(unit, factor, separator):
    right = signal(table()).values / G * factor
    read = signal(table(along=f"ax {unit}", normal=f"az {unit}", separator=separator))
    np.testing.assert_allclose(read.values, right, rtol=1e-15)


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
    np.testing.assert_array_equal(signal(unknown, unit="g").values, signal(table()).values)
    assert len(refusal(unknown)) == 2
    for other in ("[V]", "[mg]"):
        np.testing.assert_array_equal(
            signal(table(along=f"ax {other}"), unit="g").values, signal(table()).values
        )
    assert "'kg' is not a unit of acceleration" in refusal(unknown, unit="kg")[0]


@pytest.mark.parametrize("rate", ["2000 samples/s", "2000 sps", "2 kHz", "120000/min"])
def test_a_rate_is_written_as_recorders_have_it(rate):
    untimed = table(time="number")
    np.testing.assert_array_equal(
        signal(untimed, rate=rate).times, signal(untimed, rate=2000).times
    )


def test_a_recording_may_have_true_minus_signs():
    text = table().replace("-", MINUS)
    np.testing.assert_array_equal(signal(text).values, signal(table()).values)


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
    drive.write_bytes(table(time="time [µs]", along="ax [m/s²]").encode(encoding))
    assert signal(drive).values[0, 1] == pytest.approx(np.sin(0.314), abs=1e-5)


def test_a_recording_in_windows_1252_is_sent_whole(tmp_path):
    path = tmp_path / "drive.csv"
    path.write_bytes(table(time="time [µs]").encode("cp1252"))
    content = {"kind": "simulate", "drive": {"file": str(path), "along": "ax"}}
    assert resolve_files(content, "curl", tmp_path)["drive"]["data"] == table(time="time [µs]")


def test_bytes_that_are_no_text_are_told(tmp_path):
    path = tmp_path / "runs.csv"
    path.write_bytes(b"amplitude [mm]\n1\n\0\n")
    with pytest.raises(StudyError, match="it is not text in UTF-8, UTF-16 or Windows-1252"):
        read_rows(path)


def test_a_bare_number_never_loses_the_unit_of_its_heading(tmp_path):
    path = tmp_path / "runs.csv"
    for written in ("-.05", f"{MINUS}0.05", "\N{EN DASH}0.05", "+5e-2", ".05", " 0.05", "0.05 "):
        path.write_text(f"gamma [rad],amplitude [mm]\n{written},1.\n", encoding="utf-8")
        assert str(read_rows(path)[0]["gamma"]).endswith(" rad")
        assert read_rows(path)[0]["amplitude"] == "1. mm"


def test_tables_with_two_decimal_marks_are_refused(tmp_path):
    """3,000 rpm had been read as 3.000 rpm."""
    path = tmp_path / "runs.csv"
    for cells in ("3,000;0.3", "3.000;0,3", "3,000;1\n900;1", "3,000 rpm;0.3 mm"):
        path.write_text(f"frequency [rpm];amplitude [mm]\n{cells}\n")
        with pytest.raises(StudyError, match="thousands"):
            read_rows(path)


def test_a_line_may_name_the_separator_and_a_cell_its_own_unit(tmp_path):
    path = tmp_path / "runs.csv"
    path.write_text("sep=;\n# bowl 3\nfrequency [rpm];amplitude [mm]\n3000;0,3\n50,5 Hz;300 um\n")
    assert read_rows(path) == [
        {"frequency": "3000 rpm", "amplitude": "0.3 mm"},
        {"frequency": "50.5 Hz", "amplitude": "300 um"},
    ]


def test_a_row_with_more_cells_than_the_heading_is_refused(tmp_path):
    """0,35 between commas is two cells: the second had been dropped, and 0 mm was read."""
    path = tmp_path / "runs.csv"
    path.write_text("amplitude [mm],conveying_velocity [mm/s]\n0,35,20,5\n")
    with pytest.raises(StudyError, match="line 2 has 4 cells, but the heading has 2"):
        read_rows(path)
    path.write_text("amplitude [mm],conveying_velocity [mm/s]\n0.35,20,,\n")
    assert read_rows(path) == [{"amplitude": "0.35 mm", "conveying_velocity": "20 mm/s"}]
    path.write_text('amplitude,conveying_velocity [mm/s]\n"0,35",20\n')
    assert read_rows(path)[0]["amplitude"] == "0,35"  # which is refused with the reason


def test_cells_of_a_workbook_keep_their_sign_and_their_per_cent(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.append(["gamma [deg]", "amplitude [mm]", "conveying_velocity [mm/s]", "error"])
    sheet.append([f"{MINUS}5", 0.3, 20, 0.05])
    sheet["D2"].number_format = "0 %"
    for _ in range(1_200):  # blank rows, which once hid what is below them
        sheet.append([None])
    sheet.append([5, 0.3, 21, "1 mm/s"])
    book.save(tmp_path / "runs.xlsx")
    first, second = read_rows(tmp_path / "runs.xlsx")
    assert (first["gamma"], first["error"]) == ("-5 deg", "5 %")
    assert second == {
        "gamma": "5 deg", "amplitude": "0.3 mm", "conveying_velocity": "21 mm/s", "error": "1 mm/s"
    }  # fmt: skip
