"""`python -m benchmarks.keywords` writes the keywords that editors and `help` show of studies.

From quantities, scenes and the models of studies it writes `vibrafeed/_names.py`, and around the
functions of `vibrafeed/_functions.py`, which are written by hand, `vibrafeed/_studies.py`.
"""

from __future__ import annotations

import ast
import json
import math
import re
import textwrap
from collections.abc import Iterable
from pathlib import Path

from vibrafeed.core.catalogue import scene_parameters
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.motion.drive_units import PARAMETERS_OF_UNIT
from vibrafeed.core.motion.row_parts import CHOOSING
from vibrafeed.core.motion.systems import SYSTEMS
from vibrafeed.core.quantities import QUANTITIES, Quantity
from vibrafeed.core.quantities.bowl_track import BOWL_TRACK, MAX_STRETCHES, OF_STRETCHES
from vibrafeed.core.quantities.drive import DRIVE
from vibrafeed.core.quantities.row import MAX_NUMBERED, NUMBERS
from vibrafeed.core.scenes import SCENES

PACKAGE = Path(__file__).parents[1] / "vibrafeed"
NAMES, STUDIES_FILE = PACKAGE / "_names.py", PACKAGE / "_studies.py"
FUNCTIONS_FILE = PACKAGE / "_functions.py"
LENGTH = 100

FUNCTIONS = {
    "study": tuple(KINDS),
    **{name: (name,) for name in KINDS},
    "open_lazily": ("sweep",),
    "drive_error": ("simulate",),
}
"""The kinds of study of each function."""
OWN = ("study", "given", "draws", "seed")
"""Parameters of functions that are written by hand, unless their studies have such a key."""

MAPPING = "Mapping[str, Any]"
MAPPINGS = f"Mapping[str, {MAPPING}]"
TYPES = {
    "kind": f"Literal[{', '.join(map(json.dumps, KINDS))}]",
    "scene": "{scenes}",
    "outputs": "{outputs} | Sequence[{outputs}]",
    "variant": 'Literal["thesis", "derived", "physical"] | str',
    "method": "str",
    "criterion": MAPPING,
    "variables": "Mapping[str, Bounds]",
    "constraints": "Sequence[Mapping[str, Any]]",
    "uncertain": "Mapping[str, Mapping[str, Any]]",
    "analyses": 'Sequence[Literal["distribution", "sobol", "morris", "budget"]]',
    "demands": "Sequence[Mapping[str, Any]]",
    "quantiles": "Sequence[float]",
    "samples": "int",
    "seed": "int",
    "robust": 'Literal["worst", "mean", "quantile"]',
    "quantile": "float",
    "floor_contact": "bool",
    "wall_contact": "bool",
    "sensitivities": "bool | Sequence[str]",
    "observations": "str | Sequence[Mapping[str, Any]]",
    "error": "float | str",
    "unknowns": MAPPINGS,
    "offsets": MAPPINGS,
    "factors": MAPPINGS,
    "candidates": "Mapping[str, Values]",
    "discrepancy": "bool",
    "outlier_probability": "float",
    "points": "int",
    "trajectory": "int | Sequence[float]",
    "drive": MAPPING,
    "tolerance": "float",
    "max_periods": "int",
    "steps_per_period": "int",
    "slip_speed": "float",
    "contact_stiffness": "float",
    "precision": 'Literal["double", "single"]',
    "reduce": MAPPING,
    "verify": "int",
    "units": "str | Sequence[str]",
    "title": "str",
    "notes": "str",
    "parameters": "Mapping[str, Values]",
}
"""How the keys of studies are written in Python, in the order in which functions take them."""
FIRST = (
    "kind", "scene", "outputs", "variant", "method", "criterion", "variables", "constraints",
    "observations", "error", "unknowns",
)  # fmt: skip
"""Keys that stand before the parameters."""


def names_module() -> str:
    """Return the source of the module with type names of scenes, outputs and parameters."""
    lines = [
        '"""Names that editors offer and type checkers know; nothing loads them to run.',
        "",
        "Written by `python -m benchmarks.keywords` from scenes and quantities.",
        '"""',
        "",
        "from __future__ import annotations",
        "",
        "from typing import Literal, TypeAlias, TypedDict",
        "",
        "from vibrafeed._values import Values",
        "",
    ]
    for stem, registry in (("Swept", SCENES), ("Simulated", SYSTEMS)):
        outputs = {name for s in registry.values() for v in s.variants for name in s.outputs(v)}
        lines += _literal(f"{stem}Scene", registry)
        lines += _literal(f"{stem}Output", (name for name in QUANTITIES if name in outputs))
    lines += [
        "Output: TypeAlias = SweptOutput | SimulatedOutput",
        "",
        "",
        "class NoMore(TypedDict):",
        '    """No further keywords."""',
        "",
        "",
        "class DriveNumbers(TypedDict, total=False):",
        '    """Drives that are no plain sine: harmonics or steps (docs/drives.md)."""',
        "",
    ]
    for name in numbered():
        lines += [f"    {name}: Values", *_wrapped(f'"""{meaning(name)}"""', 4)]
    return "\n".join(lines) + "\n"


def _literal(name: str, values: Iterable[str]) -> list[str]:
    """Return the lines of a type alias of literals."""
    entries = [f'        "{value}",' for value in values]
    return [f"{name}: TypeAlias = (", "    Literal[", *entries, "    ]", "    | str", ")"]


def numbered() -> list[str]:
    """Return the numbered parameters: of drives, parts of rows, tracks."""
    of_drives = [name for name, quantity in DRIVE.items() if quantity.parameter]
    of_parts = [f"{stem}_{n + 1}" for stem in NUMBERS for n in range(MAX_NUMBERED)]
    of_tracks = [f"{stem}_{n + 1}" for stem in OF_STRETCHES for n in range(MAX_STRETCHES)]
    return [*of_drives, *of_parts, *of_tracks]


def parameters(kinds: Iterable[str]) -> list[str]:
    """Return the other parameters that scenes of these kinds take."""
    taken = {
        name
        for kind in kinds
        for registry in KINDS[kind].scenes
        for scene in registry.values()
        for variant in scene.variants
        for name in scene_parameters(scene, variant)
    }
    if any(KINDS[kind].scenes[-1] is SYSTEMS for kind in kinds):
        # A part in time may stand on a drive unit or on a bowl's track, a row at a stop.
        taken |= {
            *PARAMETERS_OF_UNIT,
            *CHOOSING,
            *(n for n in BOWL_TRACK if QUANTITIES[n].parameter),
        }
    return [name for name in QUANTITIES if name in taken and name not in numbered()]


def keys(kinds: Iterable[str]) -> dict[str, str]:
    """Return the keys of studies of these kinds, with descriptions.

    Raises
    ------
    KeyError
        If `TYPES` does not say how one is written.
    """
    fields = {
        name: field for kind in kinds for name, field in KINDS[kind].model.model_fields.items()
    }
    missing = fields.keys() - TYPES.keys()
    if missing:
        raise KeyError(f"TYPES of {Path(__file__).name} has no {', '.join(sorted(missing))}")
    return {name: str(fields[name].description) for name in TYPES if name in fields}


def annotations(function: str) -> dict[str, str]:
    """Return the keywords of a function with their types, in order."""
    kinds = FUNCTIONS[function]
    own = keys(kinds)
    if function != "study":
        del own["kind"]  # the function says it
    registries = [registry for kind in kinds for registry in KINDS[kind].scenes]
    stem = "Swept" if registries[0] is SCENES else "Simulated"
    stem = stem if len(registries) == 1 else ""
    words = {"scenes": f"{stem or 'Swept'}Scene", "outputs": f"{stem}Output"}
    written = {name: TYPES[name].format(**words) for name in own}
    first = {name: written.pop(name) for name in FIRST if name in written}
    return first | dict.fromkeys(parameters(kinds), "Values") | written


def meaning(name: str) -> str:
    """Return the description of a parameter: meaning, unit, bounds, examples."""
    quantity = QUANTITIES[name]
    unit = {"1": "", "degree": "In degrees"}.get(quantity.unit, f"In {quantity.unit}")
    facts = [fact for fact in (unit, _bounds(quantity)) if fact]
    examples = [f'"{one}"' if _has_unit(one) else one for one in quantity.examples]
    if examples:
        facts.append(f"for example {' or '.join(examples)}")
    told = ", ".join(facts)
    return f"{quantity.description} {told[:1].upper()}{told[1:]}." if told else quantity.description


def _has_unit(example: str) -> bool:
    """True if an example value has a unit."""
    return not example.replace(".", "").isdecimal()


def _bounds(quantity: Quantity) -> str:
    """Return the bounds of a quantity in words."""
    least, most = quantity.lower, quantity.upper
    if math.isfinite(least) and math.isfinite(most):
        return f"from {least:g} to {most:g}"
    if math.isfinite(least):
        return f"above {least:g}" if quantity.strict else f"{least:g} or more"
    return f"at most {most:g}" if math.isfinite(most) else ""


def section(function: str) -> list[str]:
    """Return the docstring entries of a function's keywords."""
    words, lines = keys(FUNCTIONS[function]), []
    for name, written in annotations(function).items():
        lines.append(f"    {name} : {_in_words(written)}, optional")
        lines += _wrapped(words[name] if name in words else meaning(name), 8)
    if function != "sweep":
        families: dict[str, list[str]] = {}
        for name in numbered():
            families.setdefault(re.sub(r"\d+$", "", name), []).append(name)
        for family in families.values():
            last = family[-1].rpartition("_")[2]
            many = f"{family[0]} to _{last}" if len(family) > 1 else family[0]
            lines += [f"    {many} : values, optional", *_wrapped(meaning(family[0]), 8)]
    return lines


def _in_words(written: str) -> str:
    """Return a type in the words of a docstring."""
    for name, word in (
        ("Mapping[str, Mapping[str, Any]]", "mapping of str to mapping"),
        ("Mapping[str, Any]", "mapping"),
        ("Mapping[str, Bounds]", "mapping of str to bounds"),
        ("Mapping[str, Values]", "mapping of str to values"),
        ("Values", "values"),
    ):
        written = written.replace(name, word)
    if written.startswith("Literal"):
        return written.removesuffix(" | str").removeprefix("Literal[").rstrip("]").join("{}")
    written = re.sub(r"\w+(?:Scene|Output)|\bOutput", "str", written)
    return re.sub(r"Sequence\[(.*)\]", r"sequence of \1", written).replace(" | ", " or ")


def _wrapped(text: str, indent: int) -> list[str]:
    """Return a text wrapped with an indent."""
    margin = " " * indent
    return textwrap.wrap(text, LENGTH, initial_indent=margin, subsequent_indent=margin)


HEAD = '''"""Making a study, and carrying it out: what users call with keywords.

Written by `python -m benchmarks.keywords` from `vibrafeed/_functions.py`, and from quantities,
scenes and the models of studies.
"""

from __future__ import annotations

from vibrafeed import _functions

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Any, Literal, Unpack

    import xarray

    from vibrafeed.core.intake.keywords import StudyLike
    from vibrafeed.core.motion.drive_error import DriveError
    from vibrafeed.core.study import Study
    from vibrafeed._names import (
        DriveNumbers,
        NoMore,
        Output,
        SimulatedOutput,
        SimulatedScene,
        SweptOutput,
        SweptScene,
    )
    from vibrafeed._values import Bounds, Values
'''


def studies_module(source: str) -> str:
    """Return the source of the functions with keywords, from the one without."""
    lines = source.splitlines()
    functions = [node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)]
    written = [HEAD]
    for node in functions:
        if node.name not in FUNCTIONS:
            continue
        docstring = lines[node.body[0].lineno - 1 : node.body[0].end_lineno]
        if node.name in KINDS:
            end = docstring.index("", docstring.index("    Parameters"))
            docstring[end:end] = section(node.name)
        study = node.args.posonlyargs[0].arg
        call = f"    return _functions.{node.name}({study}, **keywords)"
        said = "    keywords = _functions.said(locals())"
        written += ["", *_signature(node), *docstring, said, call, ""]
    return "\n".join(written)


def own_of(function: str) -> list[str]:
    """Return the parameters of a function that are written by hand."""
    return [name for name in OWN if name not in keys(FUNCTIONS[function])]


def _signature(node: ast.FunctionDef) -> list[str]:
    """Return the lines of a function's signature."""
    rest = "others: Unpack[NoMore]"
    if FUNCTIONS[node.name] != ("sweep",):
        rest = "numbered: Unpack[DriveNumbers]"
    own = [
        f"    {ast.unparse(arg)} = {ast.unparse(value)},"
        for arg, value in zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True)
        if arg.arg in own_of(node.name) and value is not None
    ]
    return [
        f"def {node.name}(",
        *(f"    {arg.arg}: StudyLike | None = None," for arg in node.args.posonlyargs),
        "    /,",
        "    *,",
        *own,
        *(f"    {name}: {how} | None = None," for name, how in annotations(node.name).items()),
        f"    **{rest},",
        f") -> {ast.unparse(node.returns or ast.Constant(None))}:",
    ]


if __name__ == "__main__":
    NAMES.write_text(names_module(), encoding="utf-8")
    STUDIES_FILE.write_text(studies_module(FUNCTIONS_FILE.read_text("utf-8")), encoding="utf-8")
