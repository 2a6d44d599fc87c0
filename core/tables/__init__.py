"""Tables as people have them: recordings, observations and designs, read by one reader."""

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = ["Column", "Table", "name_and_unit", "read_table", "stem_and_unit", "text_of"]

if TYPE_CHECKING:
    from vibrafeed.core.tables.headings import name_and_unit, stem_and_unit
    from vibrafeed.core.tables.read import read_table
    from vibrafeed.core.tables.table import Column, Table
    from vibrafeed.core.tables.text import text_of
else:
    __getattr__ = lazily(
        __name__,
        {
            "headings": ("name_and_unit", "stem_and_unit"),
            "read": ("read_table",),
            "table": ("Column", "Table"),
            "text": ("text_of",),
        },
    )
