"""The /docs page in a real browser: it renders, and nothing leaves this machine."""

from __future__ import annotations


def test_docs_render_and_try_a_route_under_the_policy_of_the_page(page, address, tmp_path):
    # What the policy refuses is told on the console, and what is told there fails the test.
    reply = page.goto(f"{address}/docs")
    assert "unsafe" not in reply.headers["content-security-policy"]
    page.get_by_text("Post a sweep study").click()
    page.get_by_role("button", name="Try it out").click()
    page.get_by_role("button", name="Execute").click()
    page.locator(".live-responses-table td", has_text="201").first.wait_for()
    page.screenshot(path=tmp_path / "docs.png", full_page=True)
    assert (tmp_path / "docs.png").stat().st_size > 10_000
