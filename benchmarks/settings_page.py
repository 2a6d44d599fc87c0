"""The page of the site on settings of the service: docs/generated/settings.md."""

from __future__ import annotations

from pydantic_core import PydanticUndefined

from vibrafeed.app.settings import Settings
from vibrafeed.core.report import markdown_table


def page() -> str:
    """Return the text of the page on settings."""
    rows = []
    for name, field in Settings.model_fields.items():
        known = field.default not in (PydanticUndefined, None, (), "")
        default = f"{field.default:,}" if known else ""
        rows.append((f"`VIBRAFEED_{name.upper()}`", default, field.description or ""))
    return "\n".join(
        [
            "# Settings of the service",
            "",
            "Environment variables of `vibrafeed serve`. `vibrafeed serve --show-settings` prints",
            "their values.",
            "",
            *markdown_table(("setting", "default", "meaning"), rows),
            "",
        ]
    )
