"""What axe-core finds wrong with a page that lets no text become a script."""

import json
from pathlib import Path
from typing import Any

import axe_playwright_python

AXE = Path(axe_playwright_python.__file__).parent / "axe.min.js"
RUN = (
    "axe.run().then(r => JSON.stringify(r.violations.map("
    "v => [v.id, v.nodes.map(n => n.html.slice(0, 120))])))"
)


def audited(page: Any) -> list[Any]:
    """Return what axe-core finds wrong: each rule with the elements that break it."""
    # The page's policy stops scripts that are added to it: axe comes by the browser's own door.
    session = page.context.new_cdp_session(page)
    session.send("Runtime.evaluate", {"expression": AXE.read_text()})
    answer = session.send("Runtime.evaluate", {"expression": RUN, "awaitPromise": True})
    session.detach()
    found: list[Any] = json.loads(answer["result"]["value"])
    return found
