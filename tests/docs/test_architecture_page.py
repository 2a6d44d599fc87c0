"""The drawing of the architecture says what the import contracts and docstrings say today."""

from xml.etree import ElementTree

from benchmarks.architecture_page import DRAWING, WAY, contracts, drawing, layers

SVG = "{http://www.w3.org/2000/svg}"


def test_the_drawing_is_up_to_date():
    assert drawing() == DRAWING.read_text(encoding="utf-8"), (
        "python -m benchmarks.architecture_page"
    )


def test_every_package_of_the_contracts_is_drawn_once():
    rooms = [room for layer in layers(contracts()) for room in layer]
    names = [room.name for room in rooms]
    assert len(names) == len(set(names)) > 30
    drawn = [text.text for text in ElementTree.fromstring(drawing()).iter(f"{SVG}text")]
    assert [name for name in drawn if name in set(names)] == names
    assert set(WAY) <= set(names)
    rules = {room.name: room.rules for room in rooms}
    assert "the physics knows arrays only" in rules["vibrafeed.core.mechanics"]
    assert rules["vibrafeed.core.plots"] == ()
