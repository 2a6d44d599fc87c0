"""`vibrafeed.scene`: all about a scene, for reading."""

from xml.etree import ElementTree

import pytest

import vibrafeed
from night import spread

WAYS = [
    (line["name"], {key: one})
    for line in vibrafeed.scenes()
    for key, choices in (("variant", line["variants"]), ("method", line["methods"]))
    for one in choices
]


@pytest.mark.parametrize(("name", "way"), spread(WAYS, 14), ids=str)
def test_a_card_fits_a_screen_and_tells_all(name, way):
    card = vibrafeed.scene(name, **way)
    text = repr(card)
    lines = text.splitlines()
    assert len(lines) <= 62
    assert max(map(len, lines)) <= 100
    assert f"{next(iter(way.values()))}*" in text
    table = ElementTree.fromstring(f"<div>{card._repr_html_()}</div>")  # each tag is closed
    cells = {"".join(cell.itertext()) for cell in table.iter() if cell.tag in ("td", "th")}
    for entry in vibrafeed.scenes(name, **way)["outputs"]:
        assert entry["name"] in text
        assert {entry["name"], entry["equation"]} <= cells
    for entry in vibrafeed.scenes(name, **way)["parameters"]:
        assert entry["name"] in cells


def test_columns_are_aligned_and_say_units_bounds_and_defaults():
    lines = repr(vibrafeed.scene("rectangle-on-plane")).splitlines()
    head, *rows = lines[lines.index("") + 1 :][:18]
    rows = {row.split()[0]: row for row in rows}
    for column, name, cell in (
        ("unit", "gravity", "m/s²"), ("default", "gravity", "9.80665"), ("bounds", "width", "> 0"),
        ("bounds", "alpha", ">= -180, <= 180"), ("meaning", "frequency", "Frequency of the drive."),
    ):  # fmt: skip
        assert rows[name][head.index(column) :].startswith(cell)
    assert rows["friction"][head.index("unit") :].split()[:2] == [">=", "0"]  # no unit, no default
    assert "For amplitude" in rows["peak_to_peak"]
    line = vibrafeed.scene("orienting-line")
    assert "wiper_height_1 to 6" in repr(line)  # a family of parameters is one line
    assert "wiper_height_6" in line.parameters


def test_other_names_are_refused_as_elsewhere():
    with pytest.raises(vibrafeed.StudyError, match="Did you mean 'rectangle-on-track'"):
        vibrafeed.scene("rectangle-on-trak")
