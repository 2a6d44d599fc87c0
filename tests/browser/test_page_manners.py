"""Manners of the page: keys, jobs that are cancelled or left, a service that is started again."""

from __future__ import annotations

import json
import os
import re
import subprocess
import urllib.request

import pytest
from playwright.sync_api import expect

from access import KEY, lock
from looking import SENTENCE, entered, settled, shows, taken_away
from services import services
from tools import tool
from waiting import PATIENCE, wait_for

MOTION = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4"
)
SLOW = f"{MOTION}&choice=reference"  # half a minute
STALE = re.compile("stale")


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    with services(tmp_path_factory) as start:
        # Also short studies count as long, of which one at a time is computed.
        queue = {"concurrent_jobs": 1, "block_seconds": 0.05, "lease_seconds": 3}
        found = start(workers=1, max_synchronous_seconds=0.3, **queue)
        lock(found.address, found.folder / "data")
        yield found


def given(page, key):
    page.locator("#key").fill(key)
    page.get_by_role("button", name="Use it").click()


def shown(page):
    settled(page)
    expect(page.locator("#progress")).to_have_text("Shown.")
    expect(page.locator("#notice")).to_be_empty()


def test_a_key_is_kept_for_the_tab_and_in_no_link(page, service, browser):
    page.goto(f"{service.address}/{MOTION}")
    said = page.locator("#key-form p")
    expect(said).to_have_text("The service needs an access key: enter yours.")
    expect(page.get_by_label("Access key, stored until this tab is closed")).to_be_visible()
    letters = "An access key consists of English letters, digits and punctuation, without spaces."
    for wrong, sentence in (("wrong", "The access key is unknown."), ("ключ", letters)):
        given(page, wrong)
        expect(said).to_have_text(sentence)
    given(page, KEY)
    shown(page)
    assert KEY not in page.url
    assert page.evaluate("[localStorage.length, document.cookie]") == [0, ""]
    command = taken_away(page, "Code for curl").decode()
    assert '-H "Authorization: Bearer $VIBRAFEED_KEY"' in command
    assert KEY not in command
    environment = {**os.environ, "VIBRAFEED_KEY": KEY}
    done = subprocess.run(
        [tool("sh"), "-c", command], env=environment, capture_output=True, check=True
    )
    assert json.loads(done.stdout).keys() & {"jobID", "variables"}
    page.reload()
    shown(page)  # without asking again
    with browser.expect_page() as another:
        page.evaluate("window.open(location.href, '_blank', 'noopener'); 0")
    expect(another.value.locator("#key")).to_be_visible()
    another.value.close()


def test_a_job_is_cancelled_and_one_that_is_left_is_dismissed(page, service):
    def jobs() -> dict[str, str]:
        """Return the states of the long jobs by their numbers."""
        headers = {"Authorization": f"Bearer {KEY}"}
        request = urllib.request.Request(f"{service.address}/jobs", headers=headers)
        with urllib.request.urlopen(request, timeout=PATIENCE) as reply:
            found = json.load(reply)["jobs"]
        return {
            job["jobID"]: job["status"]
            for job in found
            if job["processID"] == "simulate" and job["cells"] > 1000
        }

    # On a slow machine the maps of other tests, and the sweep at the end, are jobs as well.
    others = jobs().keys()
    page.goto(f"{service.address}/{SLOW}")
    given(page, KEY)
    over = page.locator("#stale")
    agree, cancel = (over.get_by_role("button", name=one) for one in ("Compute it", "Cancel"))
    expect(over).to_contain_text("the whole picture takes about")
    expect(page.locator("#picture .map")).to_have_attribute("data-size", "10 x 10")
    agree.click()
    expect(over).to_contain_text("%")
    cancel.click()
    expect(over.locator("p")).to_have_text("Cancelled.")
    expect(page.locator("#picture")).to_have_attribute("aria-busy", "false")
    over.get_by_role("button", name="Compute").click()
    expect(over).to_contain_text("the whole picture takes about")
    agree.click()
    expect(cancel).to_be_visible()
    # The same again, but now something else is looked at.
    page.locator("#question-thesis").click()
    shown(page)

    def left() -> set[str]:
        return {status for number, status in jobs().items() if number not in others}

    wait_for(lambda: left() == {"dismissed"}, jobs)
    # And so it is when the page itself is left.
    page.go_back()
    agree.click()
    wait_for(lambda: left() & {"accepted", "running"}, jobs)
    page.goto("about:blank")
    wait_for(lambda: left() == {"dismissed"}, jobs)


def test_a_service_that_starts_again_is_waited_for(page, service):
    lines = MOTION.replace("y=beta:5:60", "y=&p.beta=30").replace("0.0001:0.0007", "2e-5:8e-5")
    page.goto(f"{service.address}/{lines}")
    given(page, KEY)
    shown(page)
    service.kill()
    entered(page, "#value-friction", "0.6")
    shows(page, {SENTENCE: "The service does not answer; asking again in"})
    expect(page.locator("#answer")).to_have_class(STALE)
    service.start()
    shown(page)
    expect(page.locator("#answer")).not_to_have_class(STALE)
    assert "p.friction=0.6" in page.url
