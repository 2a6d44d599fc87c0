"""Print to PDF: the colours of a map fill its axes, dot by dot."""

from __future__ import annotations

import numpy as np
import pypdfium2
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page

from looking import opened

SYSTEMS = {
    "rectangle-on-plane": "question=speed",
    "cylinder-on-plane": "question=speed&kind=simulate&scene=cylinder-on-plane",
    "resting-part": "question=resting",
}
# Colours in a wide frame, in two colours that nothing else has.
MARKED = """() => {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(`
  .map > canvas { object-fit: none; object-position: 9999px 9999px; background: rgb(0 255 0); }
  .names, .marks, .cursor, .hatch, .borders, .axes > :not(.frame) { display: none; }
  .map .frame { stroke: rgb(255 0 255) !important; stroke-width: 6px !important; }
  `);
  document.adoptedStyleSheets = [sheet];
}"""
SCALE = 3  # dots a point of paper


def box_of(image: NDArray[np.uint8], colour: tuple[int, int, int]) -> list[int]:
    """Return the ends of the dots of a colour: left, top, right, bottom."""
    distance = np.abs(image[..., :3].astype(int) - colour).max(axis=2)
    rows, columns = np.nonzero(distance < 90)
    return [columns.min(), rows.min(), columns.max(), rows.max()]


@pytest.mark.parametrize("system", SYSTEMS)
def test_colours_meet_axes_on_paper(page: Page, address: str, system: str) -> None:
    opened(page, f"{address}/#{SYSTEMS[system]}")
    page.evaluate(MARKED)
    document = pypdfium2.PdfDocument(page.pdf(prefer_css_page_size=True))
    assert len(document) == 1
    image = document[0].render(scale=SCALE, rev_byteorder=True).to_numpy()
    colours, frame = box_of(image, (0, 255, 0)), box_of(image, (255, 0, 255))
    assert colours[2] - colours[0] > 100 * SCALE
    # The frame's line stands around the colours, on each side the same.
    outside = np.abs(np.subtract(colours, frame))
    assert outside.min() > 0
    assert np.ptp(outside) <= 2
