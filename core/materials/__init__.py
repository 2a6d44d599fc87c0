"""Published friction, restitution and leaf springs: files of data, rows with sources."""

import functools
import tomllib
from collections.abc import Collection, Iterable, Mapping, Sequence
from importlib.resources import files
from typing import Any, Final

VALUES: Final = ("static", "kinetic", "coefficient", "restitution")
"""Ranges of a row [1]; `coefficient` where the source names neither static nor kinetic."""

WORDS: Final = ("part", "track", "surface", "note")
"""Columns of a row that are searched for words."""

OF_LEAVES: Final = ("elastic_modulus", "density")
"""Ranges that a material of leaf springs may have [GPa, kg/m3]."""

WORDS_OF_LEAVES: Final = ("material", "form", "note")
"""Columns of a material of leaf springs that are searched for words."""


def friction(words: str = "") -> dict[str, Any]:
    """Return published coefficients of friction and restitution that match some words, with notes.

    Parameters
    ----------
    words : str
        Rows that hold each of these words, as in ``"steel abs"``; all rows if empty. Capitals make
        no difference, and the beginning of a word is enough.

    Returns
    -------
    dict
        ``pairs``, each with part, track, surface, note, source, and the ranges static, kinetic or
        coefficient, None where the source has none; ``rebounds``, the same with restitution;
        ``about``, ``surfaces`` and ``restitution_notes``, lists of sentences; ``sources`` of the
        rows, by name, with title, by and address.

    Examples
    --------
    >>> (row,) = vibrafeed.friction("abs steel")["pairs"]
    >>> row["part"], row["track"], row["static"]
    ('ABS', 'steel', [0.3, 0.3])
    """
    data = _data("friction.toml")
    search_words = words.lower().split()
    pairs = _rows(data["pairs"], search_words, WORDS, VALUES[:3])
    rebound_columns = tuple(name for name in WORDS if name != "surface")
    rebounds = _rows(data["rebounds"], search_words, rebound_columns, VALUES[3:])
    return {
        **{name: list(data[name]) for name in ("about", "surfaces", "restitution_notes")},
        "pairs": pairs,
        "rebounds": rebounds,
        "sources": _sources(data, (*pairs, *rebounds)),
    }


def pairs() -> tuple[str, ...]:
    """Return the pairs of materials in the table of friction: ``steel on polyurethane``."""
    return tuple(dict.fromkeys(_pair_of(row) for row in friction()["pairs"]))


def rows_of_pair(pair: str) -> list[dict[str, Any]]:
    """Return the rows of the table of friction for a pair; which of both is the part counts not."""
    part, _, track = (text.strip() for text in pair.lower().partition(" on "))
    both_orders = {f"{part} on {track}", f"{track} on {part}"}
    return [row for row in friction()["pairs"] if _pair_of(row).lower() in both_orders]


def _pair_of(row: Mapping[str, Any]) -> str:
    return f"{row['part']} on {row['track']}"


def has_surface(row: Mapping[str, Any], surface: str) -> bool:
    """True if a row of the table of friction has all words of a surface; always without words."""
    return _holds(row, surface.lower().split(), ("surface",))


def ends(row: Mapping[str, Any], is_static: bool) -> list[float]:
    """Return the ends of friction in a row: of sliding, or at rest; else of what the row has."""
    columns = ("static", "kinetic") if is_static else ("kinetic", "static")
    values = (row[columns[0]] or row["coefficient"] or row[columns[1]]) or ()
    return list(values)


def leaf_springs(words: str = "") -> dict[str, Any]:
    """Return published moduli and densities of leaf springs that match some words, with notes.

    Parameters
    ----------
    words : str
        Rows that hold each of these words, as in ``"glass epoxy"``; all rows if empty.

    Returns
    -------
    dict
        ``materials``, each with material, form, note, source, and the ranges elastic_modulus [GPa]
        and density [kg/m3], None where the source has none; ``about``, a list of sentences;
        ``sources`` of the rows, by name, with title, by and address.

    Examples
    --------
    >>> (row,) = vibrafeed.leaf_springs("glass epoxy")["materials"]
    >>> row["form"], row["elastic_modulus"]
    ('cloth in epoxy, G10 or FR4, lengthwise', [18.6, 18.6])
    """
    data = _data("leaf_springs.toml")
    rows = _rows(data["materials"], words.lower().split(), WORDS_OF_LEAVES, OF_LEAVES)
    return {"about": list(data["about"]), "materials": rows, "sources": _sources(data, rows)}


def shown(row: Mapping[str, Any], value: str) -> str:
    """Return the range in a column of a table of materials as text: ``0.2`` or ``0.1 to 0.3``.

    `row` is a row of the table and `value` the column's name, such as ``static``; an empty text if
    the row has no such range (None).
    """
    ends = row[value]
    if ends is None:
        return ""
    lower, upper = (f"{number:g}" for number in ends)
    return lower if lower == upper else f"{lower} to {upper}"


def _rows(
    rows: Iterable[Mapping[str, Any]],
    search_words: Collection[str],
    text_columns: Sequence[str],
    number_columns: Sequence[str],
) -> list[dict[str, Any]]:
    return [
        {
            **{name: row.get(name, "") for name in text_columns},
            **{name: row.get(name) for name in number_columns},
            "source": row["source"],
        }
        for row in rows
        if _holds(row, search_words, text_columns)
    ]


def _sources(data: Mapping[str, Any], rows: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    used = {row["source"] for row in rows}
    return {name: dict(source) for name, source in data["sources"].items() if name in used}


def _holds(row: Mapping[str, Any], search_words: Iterable[str], columns: Iterable[str]) -> bool:
    text = " ".join(row.get(name, "") for name in columns).lower()
    for mark in "(),:":
        text = text.replace(mark, " ")
    words_in_row = text.split()
    return all(
        any(word_in_row.startswith(word_sought) for word_in_row in words_in_row)
        for word_sought in search_words
    )


@functools.cache
def _data(name: str) -> Mapping[str, Any]:
    return tomllib.loads((files(__name__) / name).read_text(encoding="utf-8"))
