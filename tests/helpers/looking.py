"""What a test looks at on the page, and when it is at rest."""

import json
import re
import urllib.request
from typing import Any

from playwright.sync_api import Page, expect

from waiting import PATIENCE

NUMBER = "#answer .answer strong"
SENTENCE = "#answer .sentence"
IDLE = re.compile("false")


def settled(page: Page) -> None:
    """Wait until answer and picture are those of the fields."""
    for place in ("#answer", "#picture", "#detail"):
        expect(page.locator(place)).not_to_have_attribute("aria-busy", "true")


def opened(page: Page, link: str) -> None:
    """Open a link as if it came by mail, and wait for its answer and picture."""
    page.goto("about:blank")
    page.goto(link)
    settled(page)


def typed(page: Page, field: str, text: str) -> None:
    """Type into a field, and wait for what follows; its menu is opened where it is closed."""
    revealed(page, field)
    page.locator(field).fill(text)
    page.locator(field).press("Enter")
    settled(page)


def revealed(page: Page, place: str) -> None:
    """Open the menus that hide an element."""
    page.locator(place).first.wait_for(state="attached")
    for menu in ("#expert", "#part"):
        found = page.locator(f"{menu}:not([open]):has({place})")
        if found.count():
            found.locator("summary").first.click()


def numbers(text: str) -> list[float]:
    """Return the numbers in a text of the page."""
    found = re.findall(r"([\u2212]?[\d.]+(?:e[\u2212\d]+)?)", text)
    return [float(word.replace("\u2212", "-")) for word in found]


def posted(address: str, study: dict[str, Any]) -> dict[str, Any]:
    """Return the variables of a study that the service carries out."""
    request = urllib.request.Request(
        f"{address}/processes/{study['kind']}/execution",
        json.dumps(study).encode(),
        {"Content-Type": "application/json"},
    )
    with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
        found: dict[str, Any] = json.load(reply)["variables"]
    return found


def taken_away(page: Page, name: str) -> Any:
    """Return the path of what an entry of the menu saves."""
    page.locator("#take-away").click()
    with page.expect_download() as download:
        page.get_by_role("menuitem", name=name, exact=True).click()
    return download.value
