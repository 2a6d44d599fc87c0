"""Scenes on the command line: parameters, outputs, regimes."""

from collections.abc import Mapping, Sequence
from typing import Any

from vibrafeed.app.cli.console import say, table, tell
from vibrafeed.app.cli.units import DEFAULT_DIGITS, format_number
from vibrafeed.core.quantities import WORD_OF
from vibrafeed.core.study.shown import ShownUnits

SCENES = ("scene", "variants", "methods in time", "title")
PARAMETERS = ("parameter", "symbol", "unit", "bounds", "default", "meaning")
OUTPUTS = ("output", "symbol", "unit", "source", "needs", "equation")
REGIMES = ("regime", "value", "meaning")


def show_scenes(lines: Sequence[Mapping[str, Any]]) -> None:
    """Print a table of all scenes: name, variants (the default marked by *), methods, title.

    `lines` are the entries of the catalogue, as `vibrafeed.core.catalogue.describe_all` returns
    them.
    """
    rows = []
    for line in lines:
        names = (
            f"{variant}*" if variant == line["default_variant"] else variant
            for variant in line["variants"]
        )
        rows.append((line["name"], ", ".join(names), ", ".join(line["methods"]), line["title"]))
    table(SCENES, rows)
    say("  * default; `vibrafeed scenes NAME` says more, with --method about its motion in time")


def show_scene(scene: Mapping[str, Any], units: ShownUnits) -> None:
    """Print everything about one scene: validity, parameters, outputs and regimes."""
    source = f" (section {scene['source']} of the thesis)" if scene["source"] else ""
    say(f"{scene['name']}: {scene['title']}{source}")
    if "method" in scene:
        say(f"motion in time, method {scene['method']} of {', '.join(scene['methods'])}")
    else:
        say(f"variant {scene['variant']} of {', '.join(scene['variants'])}")
    tell(scene["validity"])
    table(PARAMETERS, [_parameter_row(entry, units) for entry in scene["parameters"]])
    tell(
        '  In a study, write numbers with their unit, as in "0.5 mm". A number alone is in m, '
        "m/s, s, kg, N and so on, an angle in degrees."
    )
    for drive in scene.get("other_drives", ()):
        examples = [name for name in drive["parameters"] if name.endswith(("_1", "factor"))]
        say(f"  or a drive of {drive['kind']}: {', '.join(examples)} and so on (docs/drives.md)")
    rows = [
        (
            entry["name"],
            entry["symbol"],
            units.of(entry["unit"], 0.0).unit,
            entry["source"],
            ", ".join(entry["parameters"]),
            entry["equation"],
        )
        for entry in scene["outputs"]
    ]
    table(OUTPUTS, rows)
    regimes = [
        (entry["name"], str(entry["value"]), entry["description"]) for entry in scene["regimes"]
    ]
    table(REGIMES, regimes)


def _parameter_row(parameter: Mapping[str, Any], units: ShownUnits) -> tuple[str, ...]:
    """Return the row of a parameter in the table of a scene, numbers in the unit for printing.

    `parameter` is its entry of the catalogue; the cells are name, symbol, unit, bounds, default and
    description.
    """
    name, shown = parameter["name"], units.of(parameter["unit"], 0.0)
    default = ""
    if parameter["default"] is not None:
        default = format_number(shown.factor * parameter["default"], DEFAULT_DIGITS)
    bounds = []
    if parameter["lower"] is not None:
        sign = ">" if parameter["lower_excluded"] else ">="
        bounds.append(f"{sign} {format_number(shown.factor * parameter['lower'])}")
    if parameter["upper"] is not None:
        bounds.append(f"<= {format_number(shown.factor * parameter['upper'])}")
    return (
        f"{name}, {WORD_OF[name]}" if name in WORD_OF else name, parameter["symbol"], shown.unit,
        " ".join(bounds), default, parameter["description"],
    )  # fmt: skip
