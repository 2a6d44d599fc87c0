"""One truth under hundreds of heads: read right, or right after the advice has been followed."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from night import spread
from vibrafeed.core.errors import StudyError
from vibrafeed.core.measured import Recording, read_signal

TIMES = np.arange(120) / 2000
ALONG = np.round(1.5 * np.sin(628.0 * TIMES), 4)
NORMAL = np.round(1.0 + 0.5 * np.cos(628.0 * TIMES), 4)
PREAMBLES = {
    "none": "",
    "words": "Gerät X1\nVon Hand, mit Sorgfalt für µm\n",
    "pairs": "Date;2024-01-02\nRate;2000\nChannels;3\n\n",
    "remarks": "# Recorder X1\n# rate: 2000\n",
}
HEADS = {
    "brackets": (["time [s]", "ax [g]", "az [g]"], []),
    "round": (["time (sec)", "ax (G)", "az (G)"], []),
    "row": (["time", "ax", "az"], ["s", "g", "g"]),
    "row in brackets": (["time", "ax", "az"], ["(s)", "[g]", "[g]"]),
    "endings": (["time_s", "ax_g", "az_g"], []),
    "spoken": (["Zeit [s]", "ax [g]", "az [g]"], []),
    "behind a sign": (["#time [s]", "ax [g]", "az [g]"], []),
}
CLOCKS = {
    "plain": lambda t: f"{t:.4f}",
    "long": lambda t: f"{1234.5 + t:.6f}",
    "iso": lambda t: f"2024-01-02T03:04:{5 + t:09.6f}",
    "clock": lambda t: f"12:30:{5 + t:09.6f}",
}
SEPARATORS = {"comma": ",", "semicolon": ";", "tab": "\t", "bar": "|", "blank": " "}
ENCODINGS = "utf-8", "utf-8-sig", "cp1252", "utf-16", "utf-16-le", "utf-16-be"


def text(separator=",", comma=False, preamble="none", head="brackets", clock="plain"):
    """Return the recording under a head."""
    names, units = HEADS[head]
    rows = [
        [CLOCKS[clock](t), f"{a:.4f}", f"{n:.4f}"]
        for t, a, n in zip(TIMES.tolist(), ALONG.tolist(), NORMAL.tolist(), strict=True)
    ]
    if comma:
        rows = [[cell.replace(".", ",") for cell in row] for row in rows]
    lines = [separator.join(row) for row in [names, *([units] if units else []), *rows]]
    return PREAMBLES[preamble] + "\n".join(lines) + "\n"


def is_read_right(source, along="ax", normal="az", **more):
    """True if a source is read as the truth."""
    read = read_signal(source, Recording(along=along, normal=normal, **more))
    values = np.stack([ALONG, NORMAL]) * 9.80665
    return np.allclose(read.values, values) and np.allclose(read.times, TIMES, atol=1e-9)


def names_of(head):
    """Return the names of the channels under a head."""
    return ("ax_g", "az_g") if head == "endings" else ("ax", "az")


CROSSED = [*product(SEPARATORS, (False, True), PREAMBLES, HEADS, CLOCKS, ENCODINGS)]


@pytest.mark.parametrize("part", range(10))
def test_every_head_in_every_encoding_is_read_right_or_after_its_advice(tmp_path, part):
    """Commas between cells and in numbers are refused, and read once semicolons separate them."""
    path = tmp_path / "drive.csv"
    for separator, comma, preamble, head, clock, encoding in spread(CROSSED, 300)[part::10]:
        case = separator, comma, preamble, head, clock, encoding
        mark = SEPARATORS[separator]
        path.write_bytes(text(mark, comma, preamble, head, clock).encode(encoding))
        if mark == "," and comma:
            with pytest.raises(StudyError, match="separate the cells by semicolons"):
                is_read_right(path, *names_of(head))
            path.write_bytes(text(";", comma, preamble, head, clock).encode(encoding))
        assert is_read_right(path, *names_of(head)), case


def test_a_line_may_name_the_separator():
    for separator, comma in product(SEPARATORS.values(), (False, True)):
        if separator != "," or not comma:
            assert is_read_right(f'"sep={separator}"\n' + text(separator, comma))
            assert is_read_right(f"sep={separator}\n" + text(separator, comma))


def test_columns_without_names_have_numbers():
    headless = "\n".join(text().splitlines()[1:])
    assert is_read_right(headless, "2", "3", unit="g", time="1")
    assert is_read_right(headless, "2", "3", unit="g", rate=2000)
    with pytest.raises(StudyError, match="The columns have no names: give a number from 1 to 3"):
        is_read_right(headless, unit="g", time="1")


@pytest.mark.parametrize(
    ("unit", "factor", "start", "period"),
    [("ms", 1e3, 65_530, 2**16), ("us", 1e6, 2**32 - 700, 2**32), ("s", 1, 59.99, 60.0)],
)
def test_counters_that_begin_anew_are_continued(unit, factor, start, period):
    lines = text().splitlines()
    counts = np.mod(start + np.arange(120) * (0.5e-3 * factor), period)
    rows = [f"{count!r},{line.split(',', 1)[1]}" for count, line in
            zip(counts.tolist(), lines[1:], strict=True)]  # fmt: skip
    source = "\n".join([lines[0].replace("[s]", f"[{unit}]"), *rows])
    assert is_read_right(source)


def test_days_of_spreadsheets_are_times():
    lines = text().splitlines()
    rows = [f"{45_000.5 + t / 86_400:.12f},{line.split(',', 1)[1]}" for t, line in
            zip(TIMES.tolist(), lines[1:], strict=True)]  # fmt: skip
    source = "\n".join([lines[0].replace(" [s]", ""), *rows])
    read = read_signal(source, Recording(along="ax", normal="az"))
    np.testing.assert_allclose(read.times, TIMES, atol=1e-6)


def test_what_is_not_asked_for_is_passed_over():
    lines = text().splitlines()
    more = [lines[0] + ",note,ax 2", *(f"{line},it hums,{k}" for k, line in enumerate(lines[1:]))]
    more[40] += ",knocked, twice"
    assert is_read_right("\n".join([*more, "End of record"]))


def test_equal_names_are_refused_only_where_they_are_asked_for():
    assert is_read_right(text().replace("az [g]", "az [g],n,n", 1).replace("0\n", "0,1,2\n"))
    with pytest.raises(StudyError, match="two columns have the name 'ax'"):
        is_read_right(text().replace("az [g]", "ax [g]", 1), normal="ax")


PLAIN = text()
ROWS = PLAIN.splitlines()
ADVICE = {
    "Rename one": (
        PLAIN.replace("az [g]", "ax [g]", 1), {"normal": "ax"}, PLAIN, {},
    ),
    "Correct or remove the line": (
        "\n".join([*ROWS[:50], "0.0245,knock,1.0", *ROWS[51:]]), {},
        "\n".join([*ROWS[:50], ROWS[50], *ROWS[51:]]), {},
    ),
    "or write the unit in the header: 'ax [g]'": (
        PLAIN.replace("ax [g],az [g]", "ax,az"), {}, PLAIN, {},
    ),
    "Give unit = one of m s-2, mm s-2, cm/s2, g, mg": (
        PLAIN.replace("ax [g],az [g]", "ax,az"), {},
        PLAIN.replace("ax [g],az [g]", "ax,az"), {"unit": "g"},
    ),
    "Give rate = the samples per second, or time = the name": (
        PLAIN.replace("time [s]", "x [Hz]"), {},
        PLAIN.replace("time [s]", "x [Hz]"), {"rate": 2000},
    ),
    "Known: m s-2, mm s-2, cm/s2, g, mg": (
        PLAIN.replace("[g]", "[flups]"), {}, PLAIN.replace("[g]", "[flups]"), {"unit": "g"},
    ),
    'sensitivity = "100 mV/g"': (
        PLAIN.replace("[g]", "[V]"), {},
        PLAIN.replace("[g]", "[V]"), {"sensitivity": "1 V/g"},
    ),
    "Known: ax, az, time": (PLAIN, {"normal": "ay"}, PLAIN, {}),
    "Name only columns of one quantity": (PLAIN.replace("az [g]", "az [mm]"), {}, PLAIN, {}),
    "Sort the rows by their times": ("\n".join([ROWS[0], *ROWS[:0:-1]]), {}, PLAIN, {}),
    "give the sampling rate (rate) and leave time out": (
        PLAIN.replace("\n0.0010,", "\n0.0005,"), {},
        PLAIN.replace("\n0.0010,", "\n0.0005,").replace("time", "x"), {"rate": 2000},
    ),
    "Write s, ms, us or min in the header": (
        PLAIN.replace("time [s]", "time [g]"), {}, PLAIN, {},
    ),
    "Add a row of names and rows of numbers below it": ("\n\n", {}, PLAIN, {}),
    "Add rows of numbers below the names": (ROWS[0], {}, PLAIN, {}),
}  # fmt: skip


@pytest.mark.parametrize("advice", ADVICE)
def test_the_advice_of_a_refusal_makes_it_right(advice):
    wrong, keys, mended, more = ADVICE[advice]
    with pytest.raises(StudyError) as caught:
        is_read_right(wrong, **keys)
    assert advice in str(caught.value)
    assert is_read_right(mended, **more)
