"""Each state of number, field, stage and map is reached, and nothing that is old looks new."""

from __future__ import annotations

import re
from contextlib import suppress

from playwright.sync_api import Error, Page, Route, expect

from looking import (
    NUMBER,
    SENTENCE,
    chosen,
    clicked,
    entered,
    number,
    opened,
    revealed,
    settled,
    shows,
    typed,
)

STALE = re.compile("stale")
PLACES = ("#answer", "#stage", "#detail", "#picture")
POSTS = re.compile("/(execution|sweeps)$")
WEIGHT = "one => getComputedStyle(one).fontWeight"


def test_a_number_that_is_not_of_the_fields_is_dimmed(page: Page, address: str) -> None:
    opened(page, address)
    held: list[Route] = []
    page.route(POSTS, lambda route: held.append(route))
    entered(page, "#value-friction", "0.6")
    for place in PLACES:
        expect(page.locator(place)).to_have_class(STALE)
    assert number(page) == 49.9
    assert page.locator(NUMBER).evaluate(WEIGHT) == "400"
    shows(page, {SENTENCE: "for the old values. Computing."})
    expect(page.locator("#answer .progress-bar")).to_be_visible()
    expect(page.locator("#picture .mark text").first).to_be_empty()  # no old value at the ring
    # What is typed meanwhile and is no number stays with its complaint.
    entered(page, "#value-beta", "abc")
    told = page.locator("[data-name=beta] [role=alert]")
    expect(told).to_have_text(
        re.compile(r'"abc" is not a number.*; 20 ° holds until it is corrected\.$')
    )
    page.unroute(POSTS)
    for route in held:
        with suppress(Error):  # one that the page has left meanwhile
            route.continue_()
    for place in PLACES:
        expect(page.locator(place)).not_to_have_class(STALE)
    expect(page.locator(NUMBER)).to_have_text("75.5")
    assert page.locator(NUMBER).evaluate(WEIGHT) == "700"
    expect(told).to_be_visible()
    expect(page.locator("#value-beta")).to_have_value("abc")
    expect(page.locator("[data-name=beta] .slot")).to_have_css("border-top-width", "2px")
    typed(page, "#value-beta", "25")
    expect(told).to_have_count(0)
    # The service is away.
    page.route(POSTS, lambda route: route.abort())
    entered(page, "#value-beta", "30")
    away = "for the old values. The service does not answer; asking again in 2 s."
    shows(page, {SENTENCE: away})
    expect(page.locator("#answer")).to_have_class(STALE)
    before = number(page)
    page.unroute(POSTS)
    clicked(page, "Ask now")
    expect(page.locator("#answer")).not_to_have_class(STALE)
    assert number(page) != before


def test_what_cannot_be_computed_says_so_and_one_click_helps(page: Page, address: str) -> None:
    opened(page, address)
    typed(page, "#value-friction", "-1")
    shows(
        page,
        {
            NUMBER: "\u2013",
            SENTENCE: "Friction is -1",
            "#wrong-friction": "at least 0",
            "#stale": "Not drawn.",
        },
    )
    expect(page.locator("#picture")).to_have_class(STALE)
    clicked(page, "Go back")
    assert number(page) == 49.9
    expect(page.locator("#wrong-friction")).to_be_empty()
    typed(page, "#value-beta", "200")  # an axis of the map, which stands
    shows(page, {SENTENCE: "Angle of vibration is 200°"})
    expect(page.locator("#detail")).to_be_hidden()
    expect(page.locator("#stale")).to_be_empty()
    typed(page, "#value-beta", "20")
    typed(page, "#value-gravity", "-1")
    shows(page, {"#wrong-gravity": "Gravity is"})
    expect(page.locator("#wrong-gravity")).not_to_contain_text("m s-2")
    typed(page, "#value-gravity", "9.81")
    typed(page, "#value-friction", "0.9")
    expect(page.locator("#answer")).to_have_class(re.compile("odd"))
    expect(page.locator("#answer .unusual")).to_have_text("Friction: above the usual 0.06 to 0.6.")
    shows(page, {"#unusual-friction": "Above the usual"})


def test_a_method_that_gives_means_has_its_part_at_rest(page: Page, address: str) -> None:
    opened(page, f"{address}/#question=speed&kind=simulate&scene=sphere-on-plane")
    shows(page, {SENTENCE: "Nothing conveys the part", "#at-rest": "gives means only"})
    expect(page.locator("#detail")).to_be_hidden()


def test_a_parameter_is_added_with_what_it_needs_and_taken_away_again(
    page: Page, address: str
) -> None:
    opened(page, address)
    first = number(page)
    field = "#choose-add-a-parameter"
    revealed(page, field)
    options = page.locator(f"{field} option")
    names = [*filter(None, options.evaluate_all("all => all.map(one => one.value)"))]
    assert "mass" not in names  # which nothing uses alone
    for name in names:
        chosen(page, field, name)
        expect(page.locator("#answer")).not_to_have_class(re.compile("failed"))
        expect(page.locator(f"#value-{name}")).to_be_attached()
        clicked(page, re.compile("^Remove "))
        expect(page.locator(f"#value-{name}")).to_have_count(0)
        assert number(page) == first
    # The same design, by its amplitude or from peak to peak.
    chosen(page, "#choose-amplitude", "stroke")
    expect(page.locator("#value-peak_to_peak")).to_have_value("1")
    assert number(page) == first
    assert "x=peak_to_peak" in page.url
    assert "amplitude" not in page.url
    page.go_back()
    expect(page.locator("#value-amplitude")).to_have_value("0.5")
    settled(page)
    page.locator("#choose-output").focus()
    chosen(page, "#choose-output", "hop_height")
    assert page.evaluate("document.activeElement.id") == "choose-output"
    page.go_back()
    settled(page)
    expect(page.locator("#choose-output")).to_have_value("conveying_velocity")
