"""Writes docs/quantities.md from the declarations: `python -m benchmarks.quantities_page`."""

from __future__ import annotations

import math
from pathlib import Path

from core.quantities import QUANTITIES, REGIMES, Quantity

PAGE = Path(__file__).parents[1] / "docs" / "quantities.md"


def page() -> str:
    """Return the page."""
    lines = [
        "# Quantities and regimes",
        "",
        "Written by `python -m benchmarks.quantities_page` from `core/quantities.py`.",
        "",
        "## Parameters",
        "",
        "| name | symbol | unit | bounds | written as | meaning |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for name, q in QUANTITIES.items():
        if q.parameter:
            written = ", ".join(f"`{example}`" for example in q.examples)
            lines.append(
                f"| `{name}` | {_cell(q.symbol)} | {q.unit} | {_bounds(q)} | {written} | "
                f"{q.description} |"
            )
    lines += [
        "",
        "## Outputs",
        "",
        "| name | symbol | unit | meaning |",
        "| --- | --- | --- | --- |",
    ]
    lines += [
        f"| `{name}` | {_cell(q.symbol)} | {q.unit} | {q.description} |"
        for name, q in QUANTITIES.items()
        if not q.parameter and not q.bundle
    ]
    lines += ["", "## Regimes", "", "| value | name | closed forms valid | meaning |"]
    lines += ["| --- | --- | --- | --- |"]
    lines += [
        f"| {r.value} | `{name}` | {'yes' if r.valid else 'no'} | {r.description} |"
        for name, r in REGIMES.items()
    ]
    return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _bounds(quantity: Quantity) -> str:
    least = (
        ""
        if math.isinf(quantity.lower)
        else f"{'>' if quantity.strict else '≥'} {quantity.lower:g}"
    )
    most = "" if math.isinf(quantity.upper) else f"≤ {quantity.upper:g}"
    return ", ".join(part for part in (least, most) if part)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE.name}")
