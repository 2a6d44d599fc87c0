"""Decimal marks of a table's columns: a comma cannot part thousands here and decimals there."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

ONE_MARK = (
    "Export it without separators of thousands, and the numbers of a column with equally many "
    "decimals"
)
"""What to do where the marks of a table contradict each other."""
_WITH_MARK = re.compile(r"[-+]?\d*([.,])\d*(?:[eE][-+]?\d+)?")
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}[.,]\d{3}")
_WHOLE = re.compile(r"[-+]?\d+")


def contradictions(columns: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Return the contradictions of a table's decimal marks, in words, by the name of a column.

    `columns` holds the cells of each column as they were written. In the cells that are numbers
    either commas or points are decimal marks. Columns that disagree, or one that has both, part
    thousands by one of the two; so does a column in which the mark stands before three digits
    everywhere, never behind a zero, and is missing from whole numbers below a thousand only.
    """
    examples = {name: _examples(cells) for name, cells in columns.items()}
    marked = {mark: [n for n, found in examples.items() if mark in found] for mark in ".,"}
    faults: dict[str, str] = {}
    for mark, other in (",.", ".,"):
        for name in marked[mark]:
            if marked[other]:
                beside = next((n for n in marked[other] if n != name), name)
                faults[name] = (
                    f"column '{name}' has '{examples[name][mark]}' and column '{beside}' "
                    f"'{examples[beside][other]}': one of the two marks separates thousands"
                )
    for name in {*marked[","], *marked["."]} - faults.keys():
        short = _thousands(columns[name])
        if short is not None:
            seen = next(iter(examples[name].values()))
            faults[name] = f"column '{name}' has '{seen}' beside '{short}': thousands are separated"
    return faults


def _examples(cells: Sequence[str]) -> dict[str, str]:
    """Return for each mark that the numbers among the cells have, the first number with it."""
    examples: dict[str, str] = {}
    for cell in cells:
        match = _WITH_MARK.fullmatch(cell.strip())
        if match and match[1] not in examples:
            examples[match[1]] = cell.strip()
            if len(examples) > 1:
                break
    return examples


def _thousands(cells: Sequence[str]) -> str | None:
    """Return a whole number without a mark if the other cells have marks of thousands, else None.

    `cells` are those of a column that has one kind of mark.
    """
    short = None
    for cell in map(str.strip, cells):
        if _WHOLE.fullmatch(cell):
            if len(cell.lstrip("+-")) > 3:
                return None
            short = cell
        elif cell and not _THOUSANDS.fullmatch(cell):
            return None
    return short
