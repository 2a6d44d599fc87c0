"""The study that `vibrafeed new` writes: answers in, commented TOML out."""

import textwrap
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Final

import tomlkit

from vibrafeed.app.cli.questions import QUESTIONS, parse_typed
from vibrafeed.core.intake.forms import to_toml
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.shown import SI
from vibrafeed.core.study.units import read_number

SCENES: Final[Mapping[str, str]] = {
    "straight": "rectangle-on-plane",
    "bowl": "rectangle-on-track",
}
"""The scene of a track; of a round part, `ROUND`."""
ROUND: Final = "cylinder-on-plane"
LINE: Final = "orienting-line"
WIDTH: Final = 96


@dataclass(frozen=True)
class Starter:
    """The study that answers a question of `vibrafeed new`.

    Attributes
    ----------
    says : tuple of str
        The comment lines at its head.
    kind, kind_says : str
        Its kind, and a comment on it.
    outputs : tuple of str
        Its outputs.
    outputs_of : mapping of str to tuple of str
        Further outputs by the scene that has them.
    tables : mapping of str to mapping
        Further tables, before the parameters.
    tables_say : mapping of str to str
        The comment at the head of each table.
    """

    says: tuple[str, ...]
    kind: str
    kind_says: str
    outputs: tuple[str, ...]
    outputs_of: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: MappingProxyType({}))
    tables: Mapping[str, Mapping[str, Any]] = field(default_factory=lambda: MappingProxyType({}))
    tables_say: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))


STARTERS: Final[Mapping[str, Starter]] = {
    "speed": Starter(
        ("How fast does the part travel, how many a minute, and does it hop?",),
        "simulate",
        "the motion in time, until it repeats",
        ("conveying_velocity", "feed_rate", "direction", "flight_fraction", "throw_number"),
    ),
    "drive": Starter(
        ("Which angle of the drive makes the part fastest?",),
        "optimise",
        "look for the best drive",
        ("feed_rate", "flight_fraction", "throw_number"),
        tables={
            "criterion": {"kind": "maximise", "output": "conveying_velocity"},
            "variables": {"beta": {"lower": "5 deg", "upper": "60 deg"}},
        },
        tables_say={
            "criterion": "The objective: the largest mean speed along the track.",
            "variables": "The variables and their bounds: beta is the angle of the "
            "drive\nabove the track. Others may stand here instead of below, such as frequency.",
        },
    ),
    "springs": Starter(
        (
            "Which amplitude do the springs give, and how many parts a minute does it make?",
            "Amplitude and angle follow from masses, springs and force: docs/tuning.md.",
        ),
        "simulate",
        "the motion in time, of parts and drive together",
        (
            "feed_rate",
            "conveying_velocity",
            "track_amplitude",
            "vibration_angle",
            "natural_frequency",
            "phase",
            "throw_number",
        ),
    ),
    "which-way": Starter(
        (
            "How many parts a minute leave the bowl as wanted, and how often does a part go round?",
            "Shares of the ways in which parts lie follow from their size, between let down and",
            "thrown; counts of a drop test are better: docs/which-way-up.md.",
        ),
        "sweep",
        "closed forms, over any ranges of parameters",
        (
            "oriented_feed_rate_lower",
            "oriented_feed_rate_upper",
            "line_feed_rate_upper",
            "purity_lower",
            "laps_upper",
            "return_rate_upper",
        ),
    ),
    "forces": Starter(
        (
            "Which forces and accelerations act on the part?",
            "These are values at the drive's peak, from closed forms. They hold as long as the",
            "part does not leave the track: while throw_number is below 1.",
        ),
        "sweep",
        "closed forms, over any ranges of parameters",
        ("acceleration_x", "throw_number", "floor_force"),
        {
            "rectangle-on-plane": ("pressure_offset_x",),
            "rectangle-on-track": ("pressure_offset_x", "wall_force"),
            "cylinder-on-plane": ("angular_acceleration",),
        },
    ),
}

RANGES: Final = """\
Each value is a number with its unit; without a unit it is in m, kg, Hz or degrees.
For a curve or a map, give one or two of them several values: a list,
amplitude = ["0.1 mm", "0.2 mm"], or a range,
amplitude = { start = "0.1 mm", stop = "0.5 mm", num = 41 }. `vibrafeed plot` draws them.
"""


def scene_of(answers: Mapping[str, str]) -> str:
    """Return the name of the scene for the part and the track in the answers."""
    if answers["question"] == "which-way":
        return LINE
    return ROUND if answers["part"] == "cylinder" else SCENES[answers.get("track", "straight")]


def starter_study(answers: Mapping[str, str], file: str) -> str:
    """Return the TOML text of a study made from answers, with comments.

    `answers` are by the names of the questions; `file` is the name that the study will have.
    """
    starter, scene = STARTERS[answers["question"]], scene_of(answers)
    document = tomlkit.document()
    _add_comment(document, "\n".join(starter.says))
    method = " --method events" if starter.kind != "sweep" else ""
    _add_comment(document, f"\nCarry it out:              vibrafeed run {file}")
    _add_comment(document, f"Other outputs, parameters: vibrafeed scenes {scene}{method}")
    document.add(tomlkit.nl())
    document.add("kind", tomlkit.item(starter.kind).comment(starter.kind_says))
    document.add("scene", tomlkit.item(scene))
    outputs = tomlkit.array()
    for name in (*starter.outputs, *starter.outputs_of.get(scene, ())):
        quantity = QUANTITIES[name]
        unit = SI.get(quantity.unit, quantity.unit)
        outputs.add_line(name, comment=quantity.description[:-1] + (f" [{unit}]" if unit else ""))
    document.add("outputs", outputs.multiline(True))
    tables = _tables_of_answers(answers)
    if "robust" in tables:
        document.add("robust", tomlkit.item("worst").comment("the worst case over [uncertain]"))
    for name, content in {**starter.tables, **tables}.items():
        comment = starter.tables_say.get(name, "")
        if name in tables:
            comment = TABLES_SAY.get((name, answers.get("path")), comment)
        if name == "constraints":
            document.add(name, _constraints(content))
        elif name != "robust":
            document.add(name, _table(comment or TABLES_SAY[name, None], content))
    replaced = {*tables.get("uncertain", ()), *(AMPLITUDES if "variables" in tables else ())}
    document.add("parameters", _parameters(answers, replaced))
    return tomlkit.dumps(document)


def _parameters(answers: Mapping[str, str], replaced: Container[str]) -> Any:
    """Return the TOML table of the parameters in answers, but those that others have replaced."""
    table = _table(RANGES, {})
    for question in QUESTIONS:
        is_answered = question.name in answers and question.belongs(answers)
        if question.parameter and question.parameter not in replaced and is_answered:
            _add_comment(table, question.says)
            value: Any = parse_typed(answers[question.name])
            if question.values > 1:
                stop, value = value, tomlkit.inline_table()
                value.update({"start": 0, "stop": stop, "num": question.values})
            table.add(question.parameter, value)
    return table


TABLES_SAY: Final = {
    ("variables", "ellipse"): "The variables and their bounds: an ellipse, by the "
    "amplitude along the\ntrack, that off the floor, and the phase of the one behind the other.",
    ("variables", "line"): "The variables and their bounds: amplitude, and beta, the "
    "angle of the\ndrive above the track.",
    ("uncertain", None): "Uncertain parameters, with the bounds between which they lie.",
}
"""What is said at the head of a table that an answer changes."""


AMPLITUDES: Final = ("amplitude", "peak_to_peak")
"""Parameters that are not fixed in a study whose amplitude is a variable."""


def _tables_of_answers(answers: Mapping[str, str]) -> dict[str, Any]:
    """Return the TOML tables of an optimisation, by name, from the answers about the best drive.

    `robust` is a plain key of the study.
    """
    tables: dict[str, Any] = {}
    may_hop = answers.get("hop") != "no"
    if not may_hop:
        tables["constraints"] = [{"output": "throw_number", "upper": 1}]
    if not may_hop or answers.get("path") == "ellipse":
        tables["variables"] = _variables(answers)
    if answers.get("known") == "roughly":
        friction = float(answers["friction"])
        bounds = {"lower": round(0.8 * friction, 6), "upper": round(1.2 * friction, 6)}
        tables |= {"robust": "worst", "uncertain": {"friction": bounds}}
    return tables


def _variables(answers: Mapping[str, str]) -> dict[str, Any]:
    """Return the variables of an optimisation with their bounds, by parameter, as TOML holds them.

    The largest amplitude is the answer to its question, or half the stroke. `answers` are by
    question; a drive along an ellipse has three variables.
    """
    largest = answers.get("amplitude")
    if largest is None:
        typed = parse_typed(answers["peak_to_peak"])
        stroke = read_number("peak_to_peak", QUANTITIES["peak_to_peak"], typed)  # m
        largest = f"{1e3 * stroke / 2:.6g} mm"
    if answers.get("path") == "ellipse":
        amplitude = {"lower": "0 mm", "upper": largest}
        return {
            "amplitude_along_1": amplitude,
            "amplitude_normal_1": amplitude,
            "phase_normal_1": {"lower": "0 deg", "upper": "360 deg"},
        }
    amplitude = {"lower": "0.01 mm", "upper": largest}
    return {"amplitude": amplitude, **STARTERS["drive"].tables["variables"]}


def _constraints(rows: Sequence[Mapping[str, Any]]) -> Any:
    """Return limits of outputs as an array of TOML tables; `rows` holds the keys of each limit."""
    array = tomlkit.aot()
    for row in rows:
        array.append(_table("Limits that outputs must keep.", row))
    return array


def example_study(kind: str, file: str) -> str:
    """Return the TOML text of the example of a kind, with comments at its head.

    `file` is the name that the study will have.
    """
    record = KINDS[kind]
    description = [f"{record.title}.", *textwrap.wrap(record.description, WIDTH)]
    lines = [*description, "", f"Carry it out: vibrafeed run {file}"]
    comments = "".join(f"# {line}".rstrip() + "\n" for line in lines)
    return f"{comments}\n{to_toml(record.example)}"


def _add_comment(container: Any, text: str) -> None:
    for line in text.split("\n"):
        container.add(tomlkit.comment(line))


def _table(comment: str, content: Mapping[str, Any]) -> Any:
    """Return a TOML table that begins with a comment; mappings in it become inline tables."""
    table = tomlkit.table()
    _add_comment(table, comment)
    for name, value in content.items():
        if isinstance(value, Mapping):
            inline = tomlkit.inline_table()
            inline.update(value)
            table.add(name, inline)
        else:
            table.add(name, value)
    return table
