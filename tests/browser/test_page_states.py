"""Each state of number, field, stage and map is reached, and nothing that is old looks new."""

from __future__ import annotations

import re
from contextlib import suppress

import pytest
from playwright.sync_api import Error, Page, Route, expect

from looking import NUMBER, SENTENCE, opened, revealed, settled, typed
from waiting import wait_for

SLOW = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&choice=reference"
    "&output=conveying_velocity&x=amplitude:0.0001:0.001&y=beta:0:60"
)
STALE = re.compile("stale")
BOXES = """() => [...document.querySelectorAll("#host .map canvas, #host .map .axes .frame")]
  .map((one) => one.getBoundingClientRect()).map((box) => [box.x, box.y, box.width, box.height])"""
POSTS = re.compile("/(execution|sweeps)$")


class Held:
    """Requests that compute something, held back until they are let go."""

    def __init__(self, page: Page) -> None:
        self.routes: list[Route] = []
        self.holds = True
        page.route(POSTS, self.hear)

    def hear(self, route: Route) -> None:
        if self.holds:
            self.routes.append(route)
        else:
            route.continue_()

    def let_go(self) -> None:
        self.holds = False
        for route in self.routes:
            with suppress(Error):  # one that the page has left meanwhile
                route.continue_()


def test_a_number_that_is_not_of_the_fields_is_dimmed(page: Page, address: str) -> None:
    opened(page, address)
    held = Held(page)
    revealed(page, "#value-friction")
    page.locator("#value-friction").fill("0.6")
    page.locator("#value-friction").press("Enter")
    for place in ("#answer", "#stage", "#detail", "#picture"):
        expect(page.locator(place)).to_have_class(STALE)
    expect(page.locator(NUMBER)).to_have_text("49.9")
    assert page.locator(NUMBER).evaluate("one => getComputedStyle(one).fontWeight") == "400"
    expect(page.locator(SENTENCE)).to_contain_text("for the old values. Computing.")
    expect(page.locator("#answer .progress-bar")).to_be_visible()
    expect(page.locator("#picture .mark text").first).to_be_empty()  # no old value at the ring
    held.let_go()
    for place in ("#answer", "#stage", "#detail", "#picture"):
        expect(page.locator(place)).not_to_have_class(STALE)
    expect(page.locator(NUMBER)).to_have_text("75.5")
    assert page.locator(NUMBER).evaluate("one => getComputedStyle(one).fontWeight") == "700"


def test_a_service_that_is_away_is_told_beside_the_number(page: Page, address: str) -> None:
    opened(page, address)
    page.route(POSTS, lambda route: route.abort())
    page.locator("#value-beta").fill("30")
    page.locator("#value-beta").press("Enter")
    expect(page.locator(SENTENCE)).to_have_text(
        re.compile("for the old values. The service does not answer; asking again in 2 s.")
    )
    expect(page.locator("#answer")).to_have_class(STALE)
    page.unroute(POSTS)
    page.get_by_role("button", name="Ask now").first.click()
    settled(page)
    expect(page.locator("#answer")).not_to_have_class(STALE)
    expect(page.locator(NUMBER)).not_to_have_text("49.9")


def test_what_cannot_be_computed_says_so_and_one_click_helps(page: Page, address: str) -> None:
    opened(page, address)
    typed(page, "#value-friction", "-1")
    expect(page.locator(NUMBER)).to_have_text("\u2013")
    expect(page.locator(SENTENCE)).to_contain_text("Friction coefficient is -1")
    expect(page.locator("#wrong-friction")).to_contain_text("at least 0")
    expect(page.locator("#stale")).to_contain_text("Not drawn.")
    expect(page.locator("#picture")).to_have_class(STALE)
    page.get_by_role("button", name="Go back").click()
    settled(page)
    expect(page.locator(NUMBER)).to_have_text("49.9")
    expect(page.locator("#wrong-friction")).to_be_empty()
    typed(page, "#value-beta", "200")  # an axis of the map, which stands
    expect(page.locator(SENTENCE)).to_contain_text("Drive elevation is 200°")
    expect(page.locator("#detail")).to_be_hidden()
    expect(page.locator("#stale")).to_be_empty()


def test_text_that_is_no_number_stays_with_its_complaint(page: Page, address: str) -> None:
    opened(page, address)
    held = Held(page)
    page.locator("#value-amplitude").fill("0.4")
    page.locator("#value-amplitude").press("Enter")
    field = page.locator("#value-beta")
    field.fill("abc")
    field.press("Enter")
    said = page.locator("[data-name=beta] [role=alert]")
    expect(said).to_have_text(
        re.compile(r'"abc" is not a number.*; 20 ° holds until it is corrected\.$')
    )
    held.let_go()  # a computation that ends wipes nothing
    settled(page)
    expect(said).to_be_visible()
    expect(field).to_have_value("abc")
    expect(page.locator("[data-name=beta] .slot")).to_have_css("border-top-width", "2px")
    typed(page, "#value-beta", "25")
    expect(said).to_have_count(0)


def test_an_unusual_value_is_amber_and_what_a_question_begins_with_is_not(
    page: Page, address: str
) -> None:
    opened(page, address)
    typed(page, "#value-friction", "0.9")
    expect(page.locator("#answer")).to_have_class(re.compile("odd"))
    expect(page.locator("#answer .unusual")).to_have_text("Friction: above the usual 0.06 to 0.6.")
    expect(page.locator("#unusual-friction")).to_contain_text("Above the usual")
    for question in ("resting", "springs", "orienting", "measured", "thesis"):
        opened(page, f"{address}/#question={question}")
        assert (
            page.locator(".unusual").all_inner_texts().count("") == page.locator(".unusual").count()
        ), question


def test_a_method_that_gives_means_has_its_part_at_rest(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=speed&kind=simulate&scene=sphere-on-plane")
    expect(page.locator(SENTENCE)).to_contain_text("Nothing conveys the part")
    expect(page.locator("#at-rest")).to_contain_text("gives means only")
    expect(page.locator("#detail")).to_be_hidden()


def test_a_slow_method_begins_coarse_and_asks_before_a_minute_is_spent(
    page: Page, address: str
) -> None:
    opened(page, f"{address}/{SLOW}")
    expect(page.locator(NUMBER)).to_have_text("49.9")
    expect(page.locator("#stale")).to_contain_text("the whole picture takes about")
    agree = page.locator("#stale").get_by_role("button", name="Compute it")
    expect(page.locator("#picture .map")).to_have_attribute("data-size", "10 x 10")
    agree.click()
    expect(page.locator("#stale").get_by_role("button", name="Cancel")).to_be_visible()
    page.locator("#stale").get_by_role("button", name="Cancel").click()
    expect(page.locator("#stale")).to_contain_text("Cancelled.")


def test_a_job_ends_with_its_page(page: Page, address: str) -> None:
    opened(page, f"{address}/{SLOW}")
    page.locator("#stale").get_by_role("button", name="Compute it").click()

    def active() -> list[str]:
        jobs = page.request.get(f"{address}/jobs").json()["jobs"]
        return [one["jobID"] for one in jobs if one["status"] in ("accepted", "running")]

    wait_for(active)
    page.goto("about:blank")
    wait_for(lambda: not active(), active)


@pytest.mark.parametrize("question", ["hop", "speed", "rows", "resting"])
def test_a_search_that_is_left_moves_no_other_design(
    page: Page, address: str, question: str
) -> None:
    held: list[Route] = []
    page.route(re.compile("/optimise/"), lambda route: held.append(route))
    page.goto(f"{address}/#question=drive")
    expect(page.locator("#chips")).to_contain_text("searching")
    wait_for(lambda: held)
    page.locator(f"#question-{question}").click()
    settled(page)
    before = page.url, page.locator(NUMBER).inner_text()
    for route in held:
        route.continue_()
    page.wait_for_timeout(500)
    settled(page)
    assert (page.url, page.locator(NUMBER).inner_text()) == before


def test_a_parameter_is_added_with_what_it_needs_and_taken_away_again(
    page: Page, address: str
) -> None:
    opened(page, address)
    first = page.locator(NUMBER).inner_text()
    revealed(page, "#choose-add-a-parameter")
    choice = page.locator("#choose-add-a-parameter")
    names = choice.locator("option").evaluate_all("all => all.map(one => one.value)")
    assert "mass" not in names  # which nothing uses alone
    for name in filter(None, names):
        choice.select_option(name)
        settled(page)
        expect(page.locator("#answer")).not_to_have_class(re.compile("failed"))
        expect(page.locator(f"#value-{name}")).to_be_attached()
        page.get_by_role("button", name=re.compile("^Remove ")).first.click()
        settled(page)
        expect(page.locator(f"#value-{name}")).to_have_count(0)
        expect(page.locator(NUMBER)).to_have_text(first)


@pytest.mark.parametrize("question", ["speed", "drive", "resting"])
def test_printed_colours_meet_their_axes(page: Page, address: str, question: str) -> None:
    opened(page, f"{address}/#question={question}")
    page.emulate_media(media="print")
    page.set_viewport_size({"width": 690, "height": 1000})  # of paper; nobody redraws anything
    page.locator("#sheet").wait_for()
    canvas, frame = page.evaluate(BOXES)
    assert canvas == pytest.approx(frame, abs=1)
    for place in ("nav", "#controls", "#expert", "header"):
        assert not page.locator(place).is_visible()
    expect(page.locator("#sheet")).to_contain_text(page.url)
    assert page.pdf(prefer_css_page_size=True).count(b"/Type /Page\n") == 1
