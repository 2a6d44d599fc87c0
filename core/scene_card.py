"""The card of a scene: all that a study of it may say, as text and as tables of a notebook."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

from vibrafeed.core.study.shown import SI

WIDTH, LINES = 100, 60
"""Columns of the text, and lines beyond which outputs are named only."""
SHORT = 24
"""Characters below which a cell of a table is not broken."""
PARAMETER = ("parameter", "unit", "default", "bounds", "meaning")
OUTPUT = ("output", "unit", "source", "equation")


class SceneCard:
    """The parameters and outputs of one scene, as `vibrafeed.scene` returns them.

    Attributes
    ----------
    content : dict
        All about the scene, as `vibrafeed.scenes` returns it.
    name, title, validity : str
        Its name, what it describes, and where it holds.
    parameters, outputs : dict
        The description of each by its name: unit, bounds, default, equation and so on.
    """

    def __init__(self, content: Mapping[str, Any]) -> None:
        self.content = dict(content)
        self.name, self.title = content["name"], content["title"]
        self.validity: str = content["validity"]
        self.parameters = {entry["name"]: entry for entry in content["parameters"]}
        self.outputs = {entry["name"]: entry for entry in content["outputs"]}

    def __repr__(self) -> str:
        choices = (line for choice in self._choices() for line in _wrapped(choice))
        head = [*_wrapped(f"{self.name}: {self.title}"), *choices]
        families: dict[str, list[str]] = {}
        for name in self.parameters:
            families.setdefault(re.sub(r"_\d+$", "", name), []).append(name)
        rows = []
        for first, *more in families.values():
            to = f" to {more[-1].rpartition('_')[2]}" if more else ""
            rows.append((first + to, *_parameter(self.parameters[first])[1:]))
        tail = [
            "",
            *_wrapped(f"Validity: {self.validity}"),
            *_wrapped(f"Regimes: {self._regimes()}"),
        ]
        top = [*head, "", *_aligned(PARAMETER, rows)]
        listed = _aligned(OUTPUT, map(_output, self.outputs.values()))
        if len(top) + len(listed) + len(tail) > LINES:
            named = ", ".join(f"{name} [{_unit(one)}]" for name, one in self.outputs.items())
            listed = _wrapped(f"Outputs: {named.replace(' []', '')}. `.outputs[name]` says more.")
        return "\n".join([*top, "", *listed, *tail])

    def _repr_html_(self) -> str:
        outputs = [(*_output(entry), entry["description"]) for entry in self.outputs.values()]
        return "".join([
            f"<h4>{escape(self.name)}: {escape(self.title)}</h4>",
            *(f"<p>{escape(line)}</p>" for line in (*self._choices(), self.validity)),
            _table(PARAMETER, map(_parameter, self.parameters.values())),
            _table((*OUTPUT, "meaning"), outputs),
            f"<p>Regimes: {escape(self._regimes())}</p>",
        ])  # fmt: skip

    def _choices(self) -> list[str]:
        chosen = self.content.get("method") or self.content["variant"]
        ways = {"variant (sweep)": "variants", "method in time (simulate)": "methods"}
        lines = [
            f"{way}: {', '.join(f'{one}*' if one == chosen else one for one in self.content[key])}"
            for way, key in ways.items()
            if self.content[key]
        ]
        return [*lines, "* shown here; a parameter without default is given if an output needs it"]

    def _regimes(self) -> str:
        return ", ".join(entry["name"] for entry in self.content["regimes"])


def _unit(entry: Mapping[str, Any]) -> str:
    return SI.get(entry["unit"], entry["unit"])


def _parameter(entry: Mapping[str, Any]) -> tuple[str, ...]:
    least, most = entry["lower"], entry["upper"]
    ends = [] if least is None else [f"{'>' if entry['lower_excluded'] else '>='} {least:g}"]
    ends += [] if most is None else [f"<= {most:g}"]
    default = "" if entry["default"] is None else f"{entry['default']:g}"
    others = f"For {', '.join(entry['instead_of'])}: " if entry["instead_of"] else ""
    return (entry["name"], _unit(entry), default, ", ".join(ends), others + entry["description"])


def _output(entry: Mapping[str, Any]) -> tuple[str, ...]:
    return (entry["name"], _unit(entry), entry["source"], entry["equation"])


def _aligned(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    table = [heads, *rows]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)][:-1]
    lines = []
    for row in table:
        begin = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=False))
        left = max(20, WIDTH - len(begin) - 2)
        lines.append(f"{begin}  {textwrap.shorten(row[-1], left, placeholder=' ...')}".rstrip())
    return lines


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, subsequent_indent="  ", break_on_hyphens=False)


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    style = "text-align: left; white-space:"
    lines = [
        "".join(
            f'<{tag} style="{style} {"nowrap" if len(cell) < SHORT else "normal"}">'
            f"{escape(cell)}</{tag}>"
            for cell in cells
        )
        for tag, cells in (("th", heads), *(("td", row) for row in rows))
    ]
    return f"<table><tr>{'</tr><tr>'.join(lines)}</tr></table>"
