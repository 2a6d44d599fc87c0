"""Eight states of the page, drawn wide and narrow: each is reached, and fits its screen."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from benchmarks import page_pictures

PAGE = (Path(__file__).parents[2] / "docs" / "page.md").read_text()


def size_of(png):
    return struct.unpack(">II", png[16:24])


@pytest.mark.night
def test_each_state_is_reached_and_fits_a_desk_and_a_phone(page, address):
    assert len(page_pictures.STATES) == 8
    for state in page_pictures.STATES:
        page_pictures.reach(page, address, state)
        for name, picture in page_pictures.pictures(page, state):
            wide = page.evaluate("document.documentElement.scrollWidth")
            assert wide <= page.viewport_size["width"], name
            assert size_of(picture) == tuple(page.viewport_size.values())
            assert f"(page/{name})" in PAGE
            assert size_of((page_pictures.FOLDER / name).read_bytes()) == size_of(picture)
