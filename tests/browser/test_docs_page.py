"""The /docs page in a real browser: it renders, and nothing leaves this machine."""

from __future__ import annotations


def test_docs_render_without_leaving_the_machine(page, address, tmp_path):
    page.goto(f"{address}/docs")
    page.get_by_text("Post a sweep study").wait_for()
    page.screenshot(path=tmp_path / "docs.png", full_page=True)
    assert (tmp_path / "docs.png").stat().st_size > 10_000
