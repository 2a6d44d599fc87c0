"""`python -m benchmarks.page_pictures` makes docs/page: eight states of the page, wide and narrow.

Each state is a link, and what has to be there before it counts as reached.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from PIL import Image

from benchmarks.browsing import browsed
from benchmarks.serving import served

FOLDER = Path(__file__).parents[1] / "docs" / "page"
SIZES = {1280: 900, 390: 844}  # height of each width, dots
COLOURS = 256  # of a PNG
FREQUENT = 160  # of them, taken as they are
PATIENCE = 60_000  # ms
DRAWN = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
SNAPSHOT = (
    "kind=sweep&scene=rectangle-on-plane&choice=physical&output=acceleration_x"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4&p.alpha=20"
)


@dataclass(frozen=True)
class State:
    """A state of the page.

    Attributes
    ----------
    name : str
        Its name, which its pictures bear.
    link : str
        What restores it, after `#`.
    reached : tuple of (str, str or None)
        What has to be there: selectors, each with words that stand in it.
    does : callable or None
        What is done with the page then.
    seen : str
        What the screen is scrolled to.
    height : int or None
        Height of the wide screen in dots, where it shows more than others.
    is_dark : bool
        Whether it is shown in dark colours.
    """

    name: str
    link: str
    reached: tuple[tuple[str, str | None], ...]
    does: Callable[[Any], None] | None = None
    seen: str = "body"
    height: int | None = None
    is_dark: bool = False


def _flies(page: Any) -> None:
    """Choose the moment in which the part is highest."""
    page.locator("#now").focus()
    for _ in range(40):
        page.keyboard.press("ArrowRight")


def _mistakes(page: Any) -> None:
    """Type what is no number, and a value that is unusual."""
    page.locator("#part > summary").click()
    for place, text in (("#value-friction", "0.9"), ("#value-frequency", "fast")):
        page.locator(place).fill(text)
        page.locator(place).press("Enter")


STATES = (
    State("start", "", (("#answer .answer", "49.9"), ("#picture .names", "hops"))),
    State("dark", "", (("#answer .answer", "49.9"),), does=_flies, is_dark=True),
    State(
        "best",
        "question=drive",
        (("#answer .unit", "times as fast"), ("#chip-still", "20.6"), ("#best-told", "remain")),
    ),
    State("resting", "question=resting", (("#answer .answer", "65"), ("#aspects", "On end"))),
    State(
        "springs", "question=springs", (("#answer .answer", "1.04"), ("#resonance path.line", None))
    ),
    State(
        "trade-off",
        f"question=drive&{SNAPSHOT}&best=pareto&against=acceleration_y&points=9&vary=frequency:30:80&found=1",
        (("#front .measured", None),),
        is_dark=True,
    ),
    State("thesis", "question=thesis", (("#figures", "Verdict"), ("#values", "Throw number"))),
    State(
        "mistake",
        "",
        (("#answer .unusual", "above"), (".slot [aria-invalid]", None)),
        does=_mistakes,
    ),
)


def reach(page: Any, address: str, state: State) -> None:
    """Bring a page into a state, on a wide screen.

    Raises
    ------
    AssertionError
        Where something is not there in time.
    """
    from playwright.sync_api import expect

    wide = max(SIZES)
    page.set_viewport_size({"width": wide, "height": state.height or SIZES[wide]})
    page.emulate_media(color_scheme="dark" if state.is_dark else "light", reduced_motion="reduce")
    page.goto("about:blank")
    page.goto(f"{address}/#{state.link}")
    for place in ("#picture", "#answer"):
        expect(page.locator(place)).to_have_attribute("aria-busy", "false", timeout=PATIENCE)
    if state.does:
        state.does(page)
    for selector, words in state.reached:
        found = page.locator(selector).filter(has_text=words or "").first
        expect(found).to_be_attached(timeout=PATIENCE)


def pictures(page: Any, state: State) -> Iterator[tuple[str, bytes]]:
    """Yield name and PNG of a state's pictures, one for each width."""
    for width, height in SIZES.items():
        tall = state.height if width == max(SIZES) and state.height else height
        page.set_viewport_size({"width": width, "height": tall})
        where = state.seen if width == min(SIZES) or not state.height else "body"
        page.evaluate(
            "where => document.querySelector(where).scrollIntoView()",
            where,
        )
        page.evaluate(DRAWN)  # anew, where the width changed
        yield f"{state.name}-{width}.png", page.screenshot()


def _written(content: bytes, target: Path) -> None:
    """Write a picture with few colours."""
    image = Image.open(io.BytesIO(content)).convert("RGB")
    image.quantize(palette=_palette(image), dither=Image.Dither.NONE).save(
        target, format="PNG", optimize=True
    )


def _palette(image: Image.Image) -> Image.Image:
    """Return a palette: the most frequent colours, and few for the others.

    Each of the others counts once, so that the small marks of a legend keep their colours.
    """
    counted = image.getcolors(image.width * image.height)
    ordered = [colour for _, colour in sorted(counted, reverse=True)]
    others = Image.new("RGB", (len(ordered), 1))
    others.putdata(ordered)
    few = others.quantize(COLOURS - FREQUENT, method=Image.Quantize.MAXCOVERAGE).getpalette()[
        : 3 * (COLOURS - FREQUENT)
    ]
    palette = Image.new("P", (1, 1))
    palette.putpalette([part for colour in ordered[:FREQUENT] for part in colour] + few)
    return palette


def main() -> None:
    """Make all pictures of the page."""
    FOLDER.mkdir(exist_ok=True)
    with served(workers=1) as server, browsed() as browser:
        page = browser.new_page()
        for state in STATES:
            reach(page, server.address, state)
            for name, content in pictures(page, state):
                target = FOLDER / name
                _written(content, target)
                print(f"{target.name}: {target.stat().st_size:,} bytes")


if __name__ == "__main__":
    main()
