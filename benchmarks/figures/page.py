"""The page docs/generated/thesis-figures.md, and its pictures."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from itertools import groupby

from PIL import Image

from benchmarks.figures import plane, track
from benchmarks.figures.judgement import Judgement
from benchmarks.figures.measures import beyond_lift_off, share, wall_pulls
from benchmarks.figures.studies import ROOT, data, picture_of, study
from vibrafeed.core.plots.drawing import draw
from vibrafeed.core.report import markdown_table

PAGE = ROOT / "docs" / "generated" / "thesis-figures.md"
HEAD = """\
# Figures of the thesis

`python -m benchmarks.figures` evaluates the studies of `configs/figures` in the variant `thesis`,
judges each claim of [chapter 5](../thesis.md) by the numbers, and writes this page. Percentages are
shares of cells where the part has left the floor, and where the wall would have to pull.

| verdict | meaning |
| --- | --- |
| holds | the printed formula confirms the claim |
| reproduced | it does so with the numbers of the claim |
| not reproduced | it does not |
| artefact beyond lift-off | it does, but only where the part has left the floor |
| cannot be reproduced | data are missing |
"""

DPI = 84
COLOURS = 256  # of a picture's palette

FIGURES: dict[int, Callable[[], list[Judgement]]] = {
    1: plane.best_region,
    2: plane.best_region,
    3: plane.friction_and_elevation,
    4: plane.friction_and_elevation,
    5: plane.friction_and_frequency,
    6: plane.friction_and_frequency,
    7: plane.elevation_and_frequency,
    8: plane.elevation_and_frequency,
    9: plane.amplitude_and_frequency,
    10: plane.amplitude_and_frequency,
    11: plane.across_the_track,
    12: plane.across_the_track,
    13: plane.across_by_friction,
    14: plane.across_by_friction,
    15: plane.across_by_frequency,
    16: plane.across_by_frequency,
    17: plane.across_by_friction_and_frequency,
    18: plane.across_by_friction_and_frequency,
    19: plane.angular_over_angles,
    20: plane.angular_over_angles,
    21: plane.angular_over_frequency,
    22: track.velocity_over_drive,
    23: track.velocity_over_elevation,
    24: track.velocity_over_frequency,
    25: track.velocity_over_angles,
    26: track.velocity_over_inclination,
    27: track.velocity_over_friction,
    28: track.wolfsteiner_and_pfeiffer,
    29: track.boothroyd,
}


def page() -> str:
    """Return the text of the page: a row for each claim, with its figures."""
    table = markdown_table(("figures", "claim", "verdict", "numbers"), _claims())
    return "\n".join([HEAD, *table]) + "\n"


def _claims() -> Iterator[list[str]]:
    """Yield the cells of each claim; the first one of a figure names it and links its picture."""
    for function, numbers in groupby(FIGURES, FIGURES.__getitem__):
        group = list(numbers)
        number = group[-1]
        facts = f"{share(beyond_lift_off(number))} in flight"
        if study(number).scene == "rectangle-on-track":
            facts += f", {share(wall_pulls(number))} wall pulls"
        names = ", ".join(f"5.{one}" for one in group)
        figures = f"[{names}](../figures/{picture_of(number).name}) {_subject(number)}: {facts}"
        for judgement in function():
            yield [figures, *judgement]
            figures = ""


def _subject(number: int) -> str:
    """Return the subject of a figure, from its study's title."""
    title = (study(number).title or "").partition(": ")[2]
    return title.removesuffix(" (contour lines)")


def draw_picture(number: int) -> None:
    """Draw a figure as a small PNG."""
    figure = draw(data(number), variable=study(number).outputs[0], kind="contour")
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=DPI)
    with Image.open(picture) as image:
        # Of the ways to choose a palette, this one keeps the colours of the colour bar.
        small = image.convert("RGB").quantize(
            COLOURS, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE
        )
        small.save(picture_of(number), format="PNG", optimize=True)
