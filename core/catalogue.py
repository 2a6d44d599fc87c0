"""The catalogue: what every scene takes and gives, for programs, and as a card for people."""

import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

from vibrafeed.core.motion.plate import PLATE
from vibrafeed.core.motion.systems import CONTACTS, SYSTEMS, methods_of
from vibrafeed.core.plan.plan import find_scene, scene_parameters
from vibrafeed.core.quantities import QUANTITIES, REGIMES
from vibrafeed.core.quantities.drives import DRIVE
from vibrafeed.core.quantities.pictures import INKS, LEVELS, colour_of
from vibrafeed.core.quantities.plate import TURNS
from vibrafeed.core.scenes import SCENES, Equation, Scene, instead_of
from vibrafeed.core.scenes.scene import behind
from vibrafeed.core.study.shown import SI
from vibrafeed.core.study.units import read_number

DRIVES = {
    "harmonics": ("amplitude_", "phase_", "drive_factor"),
    "steps": ("acceleration_", "duration_", "drive_factor"),
}
"""How the parameters begin of each drive that may replace the plain sine."""
WIDTH, LINES = 100, 60
"""Columns of the text, and lines beyond which outputs are named only."""
SHORT = 24
"""Characters below which a cell of a table is not broken."""
PARAMETER = ("parameter", "unit", "default", "bounds", "meaning")
OUTPUT = ("output", "unit", "source", "equation")


def describe_all() -> list[dict[str, Any]]:
    """Return one line for each scene, as a list for menus of the command line and the web page."""
    return [
        {
            "name": scene.name,
            "title": scene.title,
            "source": scene.source,
            "variants": list(scene.variants),
            "default_variant": scene.default_variant,
            "methods": list(SYSTEMS[scene.name].variants) if scene.name in SYSTEMS else [],
        }
        for scene in SCENES.values()
    ]


def describe(name: str, variant: str | None = None, *, method: str | None = None) -> dict[str, Any]:
    """Return the description of a scene: parameters, outputs, equations, regimes, validity.

    `variant` is that of the closed forms, by default the scene's own; with a `method` of simulation
    the description is that of the scene's motion in time. Raises `StudyError` if there is none of
    them.
    """
    scene, chosen = find_scene(name, variant)
    description = next(line for line in describe_all() if line["name"] == name)
    if method is not None:
        scene, chosen = find_scene(name, method, SYSTEMS)
        has_path = methods_of(name)[chosen].course is not None
        description |= {"title": scene.title, "trajectory": has_path}
        drives = {**DRIVE, **TURNS} if name == PLATE else DRIVE
        if name in CONTACTS:
            description["other_drives"] = [
                {
                    "kind": kind,
                    "parameters": [n for n in drives if n.startswith(stems)],
                    "instead_of": ["amplitude", "alpha", "beta"],
                }
                for kind, stems in DRIVES.items()
            ]
    conditions = scene.conditions[chosen]
    regimes = {condition.regime for condition in conditions} | {
        condition.otherwise for condition in conditions
    }
    return {
        **description,
        scene.choice: chosen,
        "validity": scene.validity,
        "parameters": [
            _describe_parameter(scene, chosen, parameter)
            for parameter in scene_parameters(scene, chosen)
        ],
        "outputs": [
            _describe_output(scene, chosen, equation)
            for equation in scene.variants[chosen]
            if equation.gives in scene.outputs(chosen)
        ],
        "regimes": [
            {
                "name": regime,
                "value": REGIMES[regime].value,
                "description": REGIMES[regime].description,
                "valid": REGIMES[regime].valid,
                "colour": colour_of(regime),
                "ink": INKS[regime],
            }
            for regime in sorted(
                (regimes | {"not_assessed"}) - {""}, key=lambda name: REGIMES[name].value
            )
        ],
    }


def needed_parameters(scene: Scene, variant: str, output: str) -> tuple[str, ...]:
    """Return the parameters that the equations of one output need, in the order of all quantities.

    What its regime needs besides is not among them.
    """
    reached = behind((output,), scene.producers(variant).get)
    needed = {name for name, equation in reached.items() if equation is None}
    return tuple(name for name in QUANTITIES if name in needed)


def asked_parameters(
    scene: Scene, variant: str, output: str, *, required: bool = False
) -> tuple[str, ...]:
    """Return the parameters that a study of one output may set, for the output and its regime.

    With `required` those only that such a study has to give, as they have no default. A simulation
    always includes those of its status, as it follows the part in any case.
    """
    regimes = (condition for condition in scene.conditions[variant] if output in condition.outputs)
    produced, defaults = scene.producers(variant), scene.defaults_of(variant)
    always = [name for name in ("motion_status",) if name in produced]
    needed_quantities = (
        output,
        *always,
        *(name for condition in regimes for name in condition.inputs),
    )
    # A default replaces the equation of a quantity, unless that quantity itself is the output.
    given_by_default = set(defaults) - {output} if required else set()
    reached = behind(
        needed_quantities, lambda name: None if name in given_by_default else produced.get(name)
    )
    parameters = {name for name, equation in reached.items() if equation is None} - given_by_default
    return tuple(name for name in QUANTITIES if name in parameters)


def _describe_parameter(scene: Scene, variant: str, name: str) -> dict[str, Any]:
    quantity = QUANTITIES[name]
    return {
        "name": name,
        "label": quantity.label,
        "symbol": quantity.symbol,
        "unit": quantity.unit,
        "description": quantity.description,
        "lower": None if quantity.lower == -float("inf") else quantity.lower,
        "lower_excluded": quantity.strict,
        "upper": None if quantity.upper == float("inf") else quantity.upper,
        "default": scene.defaults_of(variant).get(name),
        "instead_of": list(instead_of(name)),
        "examples": list(quantity.examples),
        "example": read_number(name, quantity, quantity.examples[0]) if quantity.examples else None,
    }


def _describe_output(scene: Scene, variant: str, equation: Equation) -> dict[str, Any]:
    quantity = QUANTITIES[equation.gives]
    level, begins = LEVELS.get(equation.gives, (None, ""))
    return {
        "name": equation.gives,
        "label": quantity.label,
        "symbol": quantity.symbol,
        "unit": quantity.unit,
        "description": quantity.description,
        "level": level,
        "begins": begins,
        "equation": equation.summary,
        "source": equation.source,
        "variant": scene.variant_of(variant, equation.gives),
        "parameters": list(needed_parameters(scene, variant, equation.gives)),
        "asks": list(asked_parameters(scene, variant, equation.gives)),
        "required": list(asked_parameters(scene, variant, equation.gives, required=True)),
        "regimes": [
            condition.regime
            for condition in scene.conditions[variant]
            if equation.gives in condition.outputs
        ],
    }


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
        heading = [*_wrapped(f"{self.name}: {self.title}"), *choices]
        # Parameters that differ by a number at the end share a row: `gap_1 to 9`.
        families: dict[str, list[str]] = {}
        for name in self.parameters:
            families.setdefault(re.sub(r"_\d+$", "", name), []).append(name)
        rows = []
        for first, *others in families.values():
            last_number = f" to {others[-1].rpartition('_')[2]}" if others else ""
            rows.append((first + last_number, *_parameter(self.parameters[first])[1:]))
        below_outputs = [
            "",
            *_wrapped(f"Validity: {self.validity}"),
            *_wrapped(f"Regimes: {self._regimes()}"),
        ]
        above_outputs = [*heading, "", *_aligned(PARAMETER, rows)]
        output_lines = _aligned(OUTPUT, map(_output, self.outputs.values()))
        if len(above_outputs) + len(output_lines) + len(below_outputs) > LINES:
            names_and_units = ", ".join(
                f"{name} [{_unit(entry)}]" for name, entry in self.outputs.items()
            )
            output_lines = _wrapped(
                f"Outputs: {names_and_units.replace(' []', '')}. `.outputs[name]` says more."
            )
        return "\n".join([*above_outputs, "", *output_lines, *below_outputs])

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
        keys = {"variant (sweep)": "variants", "method in time (simulate)": "methods"}
        names = {
            title: [f"{name}*" if name == chosen else name for name in self.content[key]]
            for title, key in keys.items()
        }
        lines = [f"{title}: {', '.join(marked)}" for title, marked in names.items() if marked]
        return [*lines, "* shown here; a parameter without default is given if an output needs it"]

    def _regimes(self) -> str:
        return ", ".join(entry["name"] for entry in self.content["regimes"])


def _unit(entry: Mapping[str, Any]) -> str:
    return SI.get(entry["unit"], entry["unit"])


def _parameter(entry: Mapping[str, Any]) -> tuple[str, ...]:
    lower, upper = entry["lower"], entry["upper"]
    ends = [] if lower is None else [f"{'>' if entry['lower_excluded'] else '>='} {lower:g}"]
    ends += [] if upper is None else [f"<= {upper:g}"]
    default = "" if entry["default"] is None else f"{entry['default']:g}"
    others = f"For {', '.join(entry['instead_of'])}: " if entry["instead_of"] else ""
    return (entry["name"], _unit(entry), default, ", ".join(ends), others + entry["description"])


def _output(entry: Mapping[str, Any]) -> tuple[str, ...]:
    return (entry["name"], _unit(entry), entry["source"], entry["equation"])


def _aligned(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    # Columns of equal width; the last one has what is left of the line.
    table = [headings, *rows]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)][:-1]
    lines = []
    for row in table:
        beginning = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=False))
        width_left = max(20, WIDTH - len(beginning) - 2)
        lines.append(
            f"{beginning}  {textwrap.shorten(row[-1], width_left, placeholder=' ...')}".rstrip()
        )
    return lines


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, subsequent_indent="  ", break_on_hyphens=False)


def _table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    style = "text-align: left; white-space:"
    lines = [
        "".join(
            f'<{tag} style="{style} {"nowrap" if len(cell) < SHORT else "normal"}">'
            f"{escape(cell)}</{tag}>"
            for cell in cells
        )
        for tag, cells in (("th", headings), *(("td", row) for row in rows))
    ]
    return f"<table><tr>{'</tr><tr>'.join(lines)}</tr></table>"
