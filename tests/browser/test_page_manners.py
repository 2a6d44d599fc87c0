"""Manners of the page: keys, jobs that are cancelled or left, a service that is started again."""

from __future__ import annotations

import json
import re
import urllib.request

import pytest
from playwright.sync_api import Route, expect

from access import KEY, lock
from looking import revealed, settled, taken_away
from services import services
from waiting import PATIENCE, wait_for

MOTION = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4"
)
SLOW = f"{MOTION}&choice=reference"  # half a minute


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    with services(tmp_path_factory) as start:
        # Also short studies count as long, of which one at a time is computed.
        queue = {"concurrent_jobs": 1, "block_seconds": 0.05, "lease_seconds": 3}
        found = start(workers=1, max_synchronous_seconds=0.3, **queue)
        lock(found.address, found.folder / "data")
        yield found


def entered(page, service, link=""):
    """Open the page, and give the key it asks for."""
    page.goto(f"{service.address}/{link}")
    page.locator("#key").fill(KEY)
    page.keyboard.press("Enter")


def shown(page):
    settled(page)
    expect(page.locator("#progress")).to_have_text("Shown.")


def asked(service, path, study=None, method=None):
    headers = {"Authorization": f"Bearer {KEY}", "Content-Type": "application/json"}
    body = study and json.dumps(study).encode()
    request = urllib.request.Request(service.address + path, body, headers, method=method)
    with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
        return json.load(reply)


def test_a_key_is_kept_for_the_tab_and_in_no_link(page, service, browser):
    page.goto(f"{service.address}/{MOTION}")
    said = page.locator("#notice p")
    expect(said).to_have_text("The service needs an access key: enter yours.")
    for wrong, sentence in [
        ("wrong", "The access key is unknown."),
        (
            "ключ",
            "An access key consists of English letters, digits and punctuation, without spaces.",
        ),
    ]:
        page.get_by_label("Access key, stored until this tab is closed").fill(wrong)
        page.get_by_role("button", name="Use it").click()
        expect(said).to_have_text(sentence)
    page.locator("#key").fill(KEY)
    page.get_by_role("button", name="Use it").click()
    shown(page)
    expect(page.locator("#notice")).to_be_empty()
    assert KEY not in page.url
    assert page.evaluate("[localStorage.length, document.cookie]") == [0, ""]
    taken_away(page, "Code for curl")
    command = page.locator("#away pre")
    expect(command).to_contain_text('-H "Authorization: Bearer $VIBRAFEED_KEY"')
    expect(command).not_to_contain_text(KEY)
    page.reload()
    shown(page)  # without asking again
    with browser.expect_page() as another:
        page.evaluate("window.open(location.href, '_blank', 'noopener'); 0")
    expect(another.value.locator("#key")).to_be_visible()
    another.value.close()


def test_a_late_refusal_of_one_key_says_nothing_of_another(page, service):
    sent: list[Route] = []

    def hold_the_second(route: Route) -> None:
        sent.append(route)
        if len(sent) != 2:
            route.continue_()

    def given(key: str) -> None:
        page.locator("#key").fill(key)
        page.get_by_role("button", name="Use it").click()

    page.goto(f"{service.address}/{MOTION}")
    expect(page.locator("#key")).to_be_visible()
    page.route(lambda url: "/modules/" not in url, hold_the_second)
    given("wrong")
    expect(page.locator("#notice p")).to_have_text("The access key is unknown.")
    assert len(sent) >= 2
    given(KEY)
    expect(page.locator("#key")).to_have_count(0)
    sent[1].continue_()
    shown(page)
    expect(page.locator("#notice")).to_be_empty()


def test_a_job_is_cancelled_and_one_that_is_left_is_dismissed(page, service):
    # On a slow machine the maps of other tests, and the sweep at the end, are jobs as well.
    others = {job["jobID"] for job in asked(service, "/jobs")["jobs"]}
    entered(page, service, SLOW)
    over = page.locator("#stale")
    over.get_by_role("button", name="Compute it").click()
    cancel = over.get_by_role("button", name="Cancel")
    expect(over).to_contain_text("%")
    cancel.click()
    expect(over.locator("p")).to_have_text("Cancelled.")
    expect(page.locator("#picture")).to_have_attribute("aria-busy", "false")
    over.get_by_role("button", name="Compute").click()
    expect(over).to_contain_text("the whole picture takes about")
    over.get_by_role("button", name="Compute it").click()
    expect(cancel).to_be_visible()
    # The same again, but now something else is looked at.
    page.locator("#question-thesis").click()
    shown(page)
    expect(page.locator("#jobs")).to_contain_text("another view was opened")
    expect(page.locator("#notice")).to_be_empty()

    def left() -> list[tuple[str, str]]:
        return [
            (job["jobID"], job["status"])
            for job in asked(service, "/jobs")["jobs"]
            if job["jobID"] not in others and job["processID"] == "simulate" and job["cells"] > 1000
        ]

    def all_dismissed() -> bool:
        return {status for _, status in left()} == {"dismissed"}

    wait_for(all_dismissed, left)


def test_a_service_that_starts_again_is_waited_for(page, service):
    lines = MOTION.replace("y=beta:5:60", "y=&p.beta=30").replace("0.0001:0.0007", "2e-5:8e-5")
    entered(page, service, lines)
    shown(page)
    service.kill()
    revealed(page, "#value-friction")
    page.locator("#value-friction").fill("0.6")
    page.locator("#value-friction").press("Enter")
    said = page.locator("#answer .sentence")
    expect(said).to_contain_text("The service does not answer; asking again in")
    expect(page.locator("#answer")).to_have_class(re.compile("stale"))
    service.start()
    shown(page)
    expect(page.locator("#answer")).not_to_have_class(re.compile("stale"))
    assert "p.friction=0.6" in page.url
