"""The page of the site on quantities, from their declarations: docs/generated/quantities.md."""

from __future__ import annotations

import math

from vibrafeed.core.quantities import MOTION_STATUSES, QUANTITIES, REGIMES, WORD_OF, Quantity


def page() -> str:
    """Return the text of the page on quantities."""
    lines = [
        "# Quantities and regimes",
        "",
        "This page is written from `core/quantities`.",
        "",
        "## Parameters",
        "",
        "| name | symbol | unit | bounds | written as | meaning |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for name, q in QUANTITIES.items():
        if q.parameter:
            names = f"`{name}`, `{WORD_OF[name]}`" if name in WORD_OF else f"`{name}`"
            written = ", ".join(f"`{example}`" for example in q.examples)
            lines.append(
                f"| {names} | {_cell(q.symbol)} | {q.unit} | {_bounds(q)} | {written} | "
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
    for title, flags in (("Regimes", REGIMES), ("Statuses of motion", MOTION_STATUSES)):
        lines += ["", f"## {title}", "", "| value | name | values describe a real part | meaning |"]
        lines += ["| --- | --- | --- | --- |"]
        lines += [
            f"| {flag.value} | `{name}` | {'yes' if flag.valid else 'no'} | {flag.description} |"
            for name, flag in flags.items()
        ]
    return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    """Return a text for a table cell."""
    return text.replace("|", "\\|")


def _bounds(quantity: Quantity) -> str:
    """Return the bounds of a quantity in short notation."""
    least = (
        ""
        if math.isinf(quantity.lower)
        else f"{'>' if quantity.strict else '≥'} {quantity.lower:g}"
    )
    most = "" if math.isinf(quantity.upper) else f"≤ {quantity.upper:g}"
    return ", ".join(part for part in (least, most) if part)
