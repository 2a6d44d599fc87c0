"""`python -m benchmarks.friction_page` writes docs/generated/friction.md from the table of data."""

from __future__ import annotations

from pathlib import Path

from vibrafeed.core.materials import friction, shown

PAGE = Path(__file__).parents[1] / "docs" / "generated" / "friction.md"


def page() -> str:
    """Return the text of the page on published friction."""
    found = friction()
    numbers = {name: number for number, name in enumerate(found["sources"], 1)}
    lines = [
        "# Coefficients of friction",
        "",
        "`python -m benchmarks.friction_page` writes this page from",
        "`core/materials/friction.toml`.",
        "`vibrafeed materials`, `GET /friction` and `vibrafeed.friction()` return the same table.",
        "",
        "## How far to trust them",
        "",
        *(f"- {line}" for line in found["about"]),
        "",
        "## What lubricants and coatings do",
        "",
        *(f"- {line}" for line in found["surfaces"]),
        "",
        "## Pairs",
        "",
        "Part and track can be exchanged. The last column gives the number of the source below.",
        "",
        "| part | track | surface | static | kinetic | kind not stated | source |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for row in found["pairs"]:
        surface = "; ".join(text for text in (row["surface"], row["note"]) if text)
        values = " | ".join(shown(row, name) for name in ("static", "kinetic", "coefficient"))
        source = numbers[row["source"]]
        lines.append(f"| {row['part']} | {row['track']} | {surface} | {values} | {source} |")
    lines += [
        "",
        "## Rebound",
        "",
        *(f"- {line}" for line in found["restitution_notes"]),
        "",
        "| part | track | restitution | note | source |",
        "| --- | --- | --- | --- | --- |",
    ]
    for row in found["rebounds"]:
        told = (row["part"], row["track"], shown(row, "restitution"), row["note"])
        lines.append(f"| {' | '.join(told)} | {numbers[row['source']]} |")
    lines += ["", "## Sources", ""]
    lines += [
        f"{numbers[name]}. {source['title']}. {source['by']}. <{source['address']}>"
        for name, source in found["sources"].items()
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE.name}")
