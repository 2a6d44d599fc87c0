"""The one way in: from a file, a request or keywords to a study that can be carried out."""

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = [
    "gather",
    "load_study",
    "parse_json",
    "parse_study",
    "parse_toml",
    "prepare_content",
    "read_content",
    "read_json",
    "read_toml",
    "study_and_fit",
    "study_of",
]

if TYPE_CHECKING:
    from vibrafeed.core.intake.forms import read_content, read_json, read_toml
    from vibrafeed.core.intake.keywords import gather
    from vibrafeed.core.intake.studies import (
        load_study,
        parse_json,
        parse_study,
        parse_toml,
        prepare_content,
        study_and_fit,
        study_of,
    )
else:
    __getattr__ = lazily(
        __name__,
        {
            "keywords": ("gather",),
            "studies": (
                "load_study",
                "parse_json",
                "parse_study",
                "parse_toml",
                "prepare_content",
                "study_and_fit",
                "study_of",
            ),
            "forms": ("read_content", "read_json", "read_toml"),
        },
    )
