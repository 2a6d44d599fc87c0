"""The pages as any browser gets them: how fast, how large, under which policy, by which links."""

from __future__ import annotations

import itertools

import pytest

from benchmarks.page import WITNESS, dragged, finished, loaded, moved
from links import links
from night import NIGHT, count

LINKS = count(8, 500, "VIBRAFEED_FUZZ_LINKS")

# Follow a link within the page; return what it shows once it is at rest.
FOLLOWED = """async (link) => {
  if (link && location.hash !== link) {
    const heard = new Promise((done) => addEventListener("hashchange", done, { once: true }));
    location.hash = link;
    await heard;
  }
  const isBusy = () => ["picture", "answer"].some(
    (id) => document.getElementById(id).getAttribute("aria-busy") !== "false",
  );
  while (isBusy()) await new Promise((done) => setTimeout(done, 5));
  const told = (places) =>
    [...document.querySelectorAll(places)].map((one) => one.textContent).filter(Boolean);
  return {
    notice: told("#notice p"),
    fields: told("#controls .wrong, #expert .wrong"),
    isDrawn: Boolean(document.querySelector("#picture svg, #picture canvas")),
    choices: document.querySelectorAll("#expert select").length,
    harmed: window.harmed ?? null,
    added: Object.keys(Object.prototype),
    title: document.title,
  };
}"""


def shortened(route):
    """Give the page a description of one route, of a body of any kind.

    To lay out the whole megabyte takes it half a minute.
    """
    document = route.fetch().json()
    posted = document["paths"]["/sweeps"]["post"]
    posted["requestBody"]["content"]["application/json"]["schema"] = {"type": "object"}
    posted["responses"] = {"201": {"description": "Posted"}}
    document["components"] = {"securitySchemes": document["components"]["securitySchemes"]}
    route.fulfill(json={**document, "paths": {"/sweeps": {"post": posted}}})


def test_docs_render_and_try_a_route_under_the_policy_of_the_page(page, address, tmp_path):
    # What the policy refuses is told on the console, and what is told there fails the test.
    if not NIGHT:
        page.route("**/openapi.json", shortened)
    reply = page.goto(f"{address}/docs")
    assert "unsafe" not in reply.headers["content-security-policy"]
    page.get_by_text("Post a sweep study").click()
    page.get_by_role("button", name="Try it out").click()
    page.get_by_role("button", name="Execute").click()
    page.locator(".live-responses-table td", has_text="201").first.wait_for()
    page.screenshot(path=tmp_path / "docs.png", full_page=True)
    assert (tmp_path / "docs.png").stat().st_size > 10_000


def test_pictures_come_and_follow_and_little_is_loaded(page, address):
    # How soon and how smoothly is measured by benchmarks/page.py, on a quiet machine.
    page.add_init_script(WITNESS)
    _, _, kilobytes = loaded(page, address)
    frames, slice_ = dragged(page, address, steps=count(20, 40, "VIBRAFEED_DRAG_STEPS"))
    _, map_ = moved(page, address, friction=0.35)
    assert kilobytes < 330
    assert (slice_, map_) == ((200, 200), (100, 100))
    assert frames > 0


@pytest.fixture(scope="module")
def scenes(server):
    found = {}
    for line in server.get("/scenes"):
        about = f"/scenes/{line['name']}"
        found[line["name"]] = {"sweep": server.get(about)}
        for method in line["methods"][:1]:
            found[line["name"]]["simulate"] = server.get(f"{about}?method={method}")
    return found


def test_any_link_leaves_a_working_page_and_a_sentence(page, address, scenes):
    page.on("dialog", lambda dialog: pytest.fail("something of a link was run"))
    page.goto(f"{address}/#question=all")
    finished(page)
    kinds = []
    for number, (kind, link) in zip(itertools.count(), links(LINKS, 1, scenes)):
        if number % 15 == 14:  # as if it came by mail
            page.goto("about:blank")
            page.goto(f"{address}/{link}")
            found = page.evaluate(FOLLOWED, "")
        else:
            found = page.evaluate(FOLLOWED, link)
        assert (found["harmed"], found["added"]) == (None, []), link
        assert found["title"] == "vibrafeed"
        assert found["isDrawn"], link
        assert found["choices"] > 4, link
        if kind == "valid":
            assert found["notice"] + found["fields"] == [], link
        else:
            assert len(found["notice"]) <= 1, link
            kinds.append(bool(found["notice"] or found["fields"]))
    # Hardly anything that means harm makes a sense by chance: one of a few, a tenth of many.
    assert len(kinds) - sum(kinds) <= max(1, 0.1 * len(kinds))
    page.locator("#question-speed").click()
    finished(page)
