"""The part of docs/thesis.md on the figures, and their pictures."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Mapping
from itertools import groupby

from PIL import Image

from benchmarks.figures import plane, track
from benchmarks.figures.judgement import Judgement
from benchmarks.figures.measures import beyond_lift_off, share, wall_pulls
from benchmarks.figures.studies import ROOT, data, is_surface, path_of, picture_of, study
from vibrafeed.core.plots.drawing import draw

PAGE = ROOT / "docs" / "thesis.md"
BEGIN = "<!-- Written by `python -m benchmarks.figures`: begin. -->"
END = "<!-- Written by `python -m benchmarks.figures`: end. -->"

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


def section() -> str:
    """Return the generated section of the page."""
    judged = {function: function() for function in dict.fromkeys(FIGURES.values())}
    return "\n".join([*_overview(judged), *_figures(judged)])


def _overview(judged: Mapping[Callable[[], list[Judgement]], list[Judgement]]) -> Iterator[str]:
    """Yield the lines of the overview table."""
    yield "| figure | shows | scene, output | beyond lift-off | wall pulls | verdict |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for number, function in FIGURES.items():
        track = study(number).scene == "rectangle-on-track"
        verdicts = "; ".join(dict.fromkeys(judgement.verdict for judgement in judged[function]))
        yield (
            f"| [5.{number}](figures/{picture_of(number).name}) | {_subject(number)} | "
            f"`{study(number).scene}`, `{study(number).outputs[0]}` | "
            f"{share(beyond_lift_off(number))} | {share(wall_pulls(number)) if track else ''} | "
            f"{verdicts} |"
        )


def _figures(judged: Mapping[Callable[[], list[Judgement]], list[Judgement]]) -> Iterator[str]:
    """Yield the lines of the section on each figure."""
    for function, numbers in groupby(FIGURES, FIGURES.__getitem__):
        group = list(numbers)
        names = " and ".join(f"5.{number}" for number in group)
        yield f"\n### Figure{'s' * (len(group) > 1)} {names}\n"
        subject = _subject(group[0]).removesuffix(" (surface)")
        studies = " and ".join(f"`configs/figures/{path_of(number).name}`" for number in group)
        yield f"{subject[0].upper()}{subject[1:]}; {studies}.\n"
        yield "| claim | verdict | numbers |"
        yield "| --- | --- | --- |"
        for judgement in judged[function]:
            cells = (text.replace("|", "\\|") for text in judgement)
            yield f"| {' | '.join(cells)} |"
        yield ""
        for number in group:
            if not is_surface(number):
                yield f"![Figure 5.{number}: {_subject(number)}](figures/{picture_of(number).name})"


def _subject(number: int) -> str:
    """Return the subject of a figure, from its study's title."""
    return (study(number).title or "").partition(": ")[2]


def page(text: str) -> str:
    """Return the page's text with its section on figures generated anew."""
    head, _, rest = text.partition(BEGIN)
    _, _, tail = rest.partition(END)
    return f"{head}{BEGIN}\n\n{section()}\n\n{END}{tail}"


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
