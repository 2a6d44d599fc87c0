"""The page of the site on kinds of study, from their records: docs/generated/kinds.md."""

from __future__ import annotations

from vibrafeed.core.intake.forms import to_toml
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.plan.pieces import Kind


def page() -> str:
    """Return the text of the page on kinds of study."""
    lines = [
        "# Kinds of study",
        "",
        "This page is written from the records of `core/kinds`. A kind is",
        "the value of the key `kind`, a process of the service and a function of `vibrafeed`;",
        "`vibrafeed new --kind NAME` writes its example.",
        "",
        "| kind | purpose |",
        "| --- | --- |",
        *(f"| [`{name}`](#{name}) | {kind.title} |" for name, kind in KINDS.items()),
    ]
    for kind in KINDS.values():
        lines += _section(kind)
    return "\n".join(lines) + "\n"


def _section(kind: Kind) -> list[str]:
    """Return the section on a kind: purpose, keys, example."""
    return [
        "",
        f"## {kind.name}",
        "",
        kind.description,
        "",
        "| key | needed | meaning |",
        "| --- | --- | --- |",
        *(
            f"| `{name}` | {'yes' if field.is_required() else ''} | {field.description or ''} |"
            for name, field in kind.model.model_fields.items()
        ),
        "",
        "```toml",
        to_toml(kind.example).rstrip(),
        "```",
    ]
