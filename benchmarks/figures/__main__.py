"""Writes docs/generated/thesis-figures.md and its pictures: `python -m benchmarks.figures`."""

from __future__ import annotations

from benchmarks.figures.page import FIGURES, PAGE, draw_picture, page
from benchmarks.figures.studies import PICTURES, is_surface, picture_of

if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE.name}")
    PICTURES.mkdir(exist_ok=True)
    drawn = [number for number in FIGURES if not is_surface(number)]
    for number in drawn:
        draw_picture(number)
    sizes = [picture_of(number).stat().st_size for number in drawn]
    print(
        f"drew {len(sizes)} pictures, {sum(sizes) / 1e6:.2f} MB, at most {max(sizes) / 1e3:.0f} kB"
    )
