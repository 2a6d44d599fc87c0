"""`python -m benchmarks.keywords` writes the parameters of scenes as types, for editors.

From quantities and scenes it writes `vibrafeed/parameters.py`.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from pathlib import Path

from vibrafeed.core.catalogue import scene_parameters
from vibrafeed.core.motion.drive_units import PARAMETERS_OF_UNIT
from vibrafeed.core.motion.row_scene import STOP_GAPS
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.quantities.drives import BOWL_TRACK, DRIVE
from vibrafeed.core.quantities.plate import PLATE
from vibrafeed.core.quantities.row import MAX_NUMBERED, NUMBERS
from vibrafeed.core.scenes import SCENES

FILE = Path(__file__).parents[1] / "vibrafeed" / "parameters.py"
LENGTH = 100

HEAD = '''"""The parameters of each scene, as types for editors and type checkers.

Written by `python -m benchmarks.keywords`. The type of a parameter names the unit of numbers that
are given without one. `vibrafeed.scene` says more of each parameter.

>>> from vibrafeed.parameters import RectangleOnPlane
>>> design: RectangleOnPlane = {"frequency": "50 Hz", "beta": 20, "friction": 0.3}
>>> design["amplitude"] = ["0.2 mm", "0.3 mm"]
>>> vibrafeed.simulate("rectangle-on-plane", **design).conveying_velocity.dims
('amplitude',)
"""

# fmt: off
# ruff: noqa: D204, UP013
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias, TypedDict

from vibrafeed._values import Values
'''


def in_time() -> set[str]:
    """Return the parameters that motion in time takes in any scene: drives, units, tracks, rows."""
    rows = (f"{stem}_{n + 1}" for stem in NUMBERS for n in range(MAX_NUMBERED))
    registries = [
        name for one in (DRIVE, BOWL_TRACK, PLATE) for name in one if QUANTITIES[name].parameter
    ]
    choosing = ("friction_spread", "friction_seed", *STOP_GAPS)
    return {*registries, *PARAMETERS_OF_UNIT, *choosing, *rows}


def taken(name: str) -> set[str]:
    """Return the parameters that a scene takes, by closed forms or in time."""
    scenes = [registry[name] for registry in (SCENES, SYSTEMS) if name in registry]
    return {
        parameter
        for scene in scenes
        for variant in scene.variants
        for parameter in scene_parameters(scene, variant)
    }


def class_name(scene: str) -> str:
    """Return the name of the type of a scene's parameters: RectangleOnPlane."""
    return "".join(word.capitalize() for word in scene.split("-"))


def unit_name(unit: str) -> str:
    """Return the name of the type of values in a unit: m_per_s for m s-1."""
    if unit == "1":
        return "number"
    factors = (re.fullmatch(r"([A-Za-z]+)(-?)(\d*)", one) for one in unit.split())
    named = (("per_" if f[2] else "") + f[1] + f[3].removeprefix("1") for f in factors if f)
    return "_".join(named)


def typed_dict(name: str, parameters: Iterable[str]) -> str:
    """Return the source of a type of these parameters."""
    wanted = set(parameters)
    fields = (f'"{p}": {unit_name(QUANTITIES[p].unit)},' for p in QUANTITIES if p in wanted)
    packed = " ".join(field.replace(" ", "\0") for field in fields)  # a field is not broken
    lines = [f"    {line}".replace("\0", " ") for line in textwrap.wrap(packed, LENGTH - 4)]
    return "\n".join([f'{name} = TypedDict("{name}", {{', *lines, "}, total=False)"])


def literal(name: str, values: Iterable[str]) -> str:
    """Return the source of a type of these texts."""
    listed = " ".join(f'"{value}",' for value in values)
    texts = textwrap.fill(listed, LENGTH - 4, break_on_hyphens=False)
    return f"{name}: TypeAlias = Literal[\n{textwrap.indent(texts, '    ')}\n]"


def module() -> str:
    """Return the source of the module."""
    moving, everything = in_time(), set().union(*map(taken, SCENES))
    units = {QUANTITIES[name].unit for name in everything | moving}
    outputs = {
        name
        for scene in (*SCENES.values(), *SYSTEMS.values())
        for variant in scene.variants
        for name in scene.outputs(variant)
    }
    everywhere = ", ".join(map(class_name, SCENES))
    parts = [HEAD]
    parts += [f"{unit_name(unit)}: TypeAlias = Values" for unit in sorted(units)]
    parts += [
        literal("SceneName", SCENES),
        literal("Output", (name for name in QUANTITIES if name in outputs)),
        "Outputs: TypeAlias = Output | str | Sequence[Output | str]",
        "# Other drives, drive units, tracks of bowls, and single parts of rows (docs/drives.md).",
        typed_dict("InTime", moving),
    ]
    for scene in SCENES.values():
        name = class_name(scene.name)
        if scene.name in SYSTEMS:
            parts.append(typed_dict(f"_{name}", taken(scene.name) - moving))
            parts.append(f"class {name}(_{name}, InTime, total=False):")
            parts.append(f'    """{scene.title}."""')
        else:
            parts += [f"# {scene.title}.", typed_dict(name, taken(scene.name))]
    parts += [
        textwrap.fill(
            f"class Keywords({everywhere}, total=False):", LENGTH, subsequent_indent=" " * 8
        ),
        '    """Keywords of studies that their functions do not name."""',
        "    scene: SceneName | str",
        "    parameters: Mapping[str, Values]",
        "    units: str | Sequence[str]",
        "    title: str",
        "    notes: str",
        "    designs: Mapping[str, Any] | Sequence[Mapping[str, Values]]",
    ]
    return "\n".join(parts) + "\n"


if __name__ == "__main__":
    FILE.write_text(module(), encoding="utf-8")
