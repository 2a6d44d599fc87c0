"""`vibrafeed.scene`: all about a scene, for reading."""

from __future__ import annotations

from html.parser import HTMLParser

import pytest

import vibrafeed

WAYS = [
    (line["name"], {key: one})
    for line in vibrafeed.scenes()
    for key, choices in (("variant", line["variants"]), ("method", line["methods"]))
    for one in choices
]


class Cells(HTMLParser):
    """The texts of a table's cells; it fails where a tag is not closed in order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.texts: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        self.texts += [""] if tag in ("td", "th") else []

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1] in ("td", "th"):
            self.texts[-1] += data


@pytest.mark.parametrize(("name", "way"), WAYS, ids=str)
def test_a_card_fits_a_screen_and_tells_all(name, way):
    card = vibrafeed.scene(name, **way)
    text = repr(card)
    lines = text.splitlines()
    assert len(lines) <= 62
    assert max(map(len, lines)) <= 100
    assert f"{next(iter(way.values()))}*" in text
    reader = Cells()
    reader.feed(card._repr_html_())
    assert not reader.open
    for entry in vibrafeed.scenes(name, **way)["outputs"]:
        assert entry["name"] in text
        assert {entry["name"], entry["equation"]} <= set(reader.texts)
    for entry in vibrafeed.scenes(name, **way)["parameters"]:
        assert entry["name"] in reader.texts


def test_columns_are_aligned_and_say_units_bounds_and_defaults():
    lines = repr(vibrafeed.scene("rectangle-on-plane")).splitlines()
    head, *rows = lines[lines.index("") + 1 :][:18]
    rows = {row.split()[0]: row for row in rows}
    for column, name, cell in (
        ("unit", "gravity", "m/s²"), ("default", "gravity", "9.80665"), ("bounds", "width", "> 0"),
        ("bounds", "alpha", ">= -180, <= 180"), ("meaning", "frequency", "Drive frequency."),
    ):  # fmt: skip
        assert rows[name][head.index(column) :].startswith(cell)
    assert rows["friction"][head.index("unit") :].split()[:2] == [">=", "0"]  # no unit, no default
    assert "For amplitude" in rows["peak_to_peak"]


def test_a_family_of_numbered_parameters_is_one_line():
    assert "wiper_height_1 to 6" in repr(vibrafeed.scene("orienting-line"))
    assert "wiper_height_6" in vibrafeed.scene("orienting-line").parameters


def test_other_names_are_refused_as_elsewhere():
    with pytest.raises(vibrafeed.StudyError, match="Did you mean 'rectangle-on-track'"):
        vibrafeed.scene("rectangle-on-trak")
    for wrong in ({"variant": "printed"}, {"method": "exact"}):
        with pytest.raises(vibrafeed.StudyError):
            vibrafeed.scene("rectangle-on-plane", **wrong)
