"""What a test looks at on the page, and when it is at rest."""

import json
import re
import urllib.request
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from playwright.sync_api import BrowserContext, Locator, Page, expect

from waiting import PATIENCE

expect.set_options(timeout=1000 * PATIENCE)  # ms; a busy machine takes its time

NUMBER = "#answer .answer strong"
SENTENCE = "#answer .sentence"


@contextmanager
def watched(context: BrowserContext) -> Iterator[Page]:
    """Yield a new page that asks nobody else for anything, and complains of nothing.

    Motions stand still at first, as for who asks for reduced motion: to play them takes longer than
    all else that most tests do.
    """
    page = context.new_page()
    page.emulate_media(reduced_motion="reduce")
    asked: list[str] = []
    complaints: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(f"{error}\n{error.stack}"))
    page.set_default_timeout(1000 * PATIENCE)
    yield page
    page.close()
    local = ("http://127.0.0.1:", "data:", "blob:")
    assert all(url.startswith(local) for url in asked), asked
    # A refusal is told by the page; the browser tells it as well.
    left = [text for text in complaints if not text.startswith("Failed to load resource")]
    assert left == []


def settled(page: Page) -> None:
    """Wait until answer and picture are those of the fields."""
    for place in ("#answer", "#picture", "#detail"):
        expect(page.locator(place)).not_to_have_attribute("aria-busy", "true")


def opened(page: Page, link: str) -> None:
    """Open a link as if it came by mail, and wait for its answer and picture."""
    page.goto("about:blank")
    page.goto(link)
    settled(page)


def shows(page: Page, expected: Mapping[str, str | re.Pattern[str]]) -> None:
    """Expect a text in each of some places."""
    for place, text in expected.items():
        expect(page.locator(place).first).to_contain_text(text)


def typed(page: Page, field: str, text: str) -> None:
    """Type into a field, and wait for what follows; its menu is opened where it is closed."""
    entered(page, field, text)
    settled(page)


def entered(page: Page, field: str, text: str) -> None:
    """Type into a field, and wait for nothing."""
    revealed(page, field)
    page.locator(field).fill(text)
    page.locator(field).press("Enter")


def chosen(page: Page, field: str, *which: str, **how: str) -> None:
    """Choose from a list, and wait for what follows."""
    revealed(page, field)
    page.locator(field).select_option(*which, **how)
    settled(page)


def clicked(page: Page, name: str | re.Pattern[str]) -> None:
    """Click a button, and wait for what follows."""
    page.get_by_role("button", name=name).first.click()
    settled(page)


def pressed(page: Page, place: Locator | str, *keys: str) -> None:
    """Give an element the focus, and press keys."""
    (page.locator(place) if isinstance(place, str) else place).focus()
    for key in keys:
        page.keyboard.press(key)


def middle(place: Locator) -> tuple[float, float]:
    """Return the middle of an element, in pixels of the window."""
    box = place.bounding_box()
    assert box is not None
    return box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]


@contextmanager
def held(page: Page, place: Locator, x: float, y: float) -> Iterator[None]:
    """Drag an element by some pixels, and hold it while the block runs."""
    place.scroll_into_view_if_needed()
    left, top = middle(place)
    page.mouse.move(left, top)
    page.mouse.down()
    page.mouse.move(left + x, top + y, steps=5)
    yield
    page.mouse.up()
    settled(page)


def revealed(page: Page, place: str) -> None:
    """Open the menus that hide an element."""
    page.locator(place).first.wait_for(state="attached")
    for menu in ("#expert", "#part"):
        found = page.locator(f"{menu}:not([open]):has({place})")
        if found.count():
            found.locator("summary").first.click()


def value(page: Page, name: str) -> float:
    """Return the number in the field of a parameter."""
    return float(page.locator(f"#value-{name}").input_value())


def numbers(text: str) -> list[float]:
    """Return the numbers in a text of the page."""
    found = re.findall(r"([\u2212]?[\d.]+(?:e[\u2212\d]+)?)", text)
    return [float(word.replace("\u2212", "-")) for word in found]


def number(page: Page) -> float:
    """Return the number that answers the question."""
    return numbers(page.locator(NUMBER).inner_text())[0]


def posted(address: str, study: dict[str, Any]) -> dict[str, Any]:
    """Return the values of a study that the service carries out, by variable."""
    request = urllib.request.Request(
        f"{address}/processes/{study['kind']}/execution",
        json.dumps(study).encode(),
        {"Content-Type": "application/json"},
    )
    with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
        variables: dict[str, Any] = json.load(reply)["variables"]
    return {name: one["data"] for name, one in variables.items()}


def speed(address: str, **parameters: float | str) -> float:
    """Return the conveying velocity of a block on a plane [mm/s]."""
    study = {"kind": "simulate", "scene": "rectangle-on-plane", "parameters": parameters}
    return 1e3 * posted(address, study)["conveying_velocity"]


def taken_away(page: Page, name: str) -> bytes:
    """Return what an entry of the menu saves."""
    page.locator("#take-away").click()
    with page.expect_download() as download:
        page.get_by_role("button", name=name, exact=True).click()
    return download.value.path().read_bytes()
