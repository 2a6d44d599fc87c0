"""The questions of `vibrafeed new`, and the checks of their answers."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

NOTHING: Final[Mapping[str, str]] = MappingProxyType({})
DRIVE_FROM_THE_SIDE = r"""
           / drive, to and fro: half of its stroke is the amplitude
         /
       /  ) angle
  ---/----------------> track, direction of transport
"""


@dataclass(frozen=True)
class Question:
    """One thing that a starter study has to know.

    Attributes
    ----------
    name : str
        Its name, which is that of the option, too.
    asks : str
        What a person is asked; empty if it is only taken from its option.
    default : str
        The answer of who presses the return key.
    choices : mapping of str to str
        The words that answer it, and what they mean; none if a value with a unit does.
    parameter : str
        The parameter whose value answers it.
    says : str
        What the study says above that parameter: what to change, and why.
    needs : mapping of str to str
        Earlier questions, and the words of which one must be their answer, spaces between.
    unless : str
        A question whose answer replaces this one.
    values : int
        How many values from 0 to the answer the study takes; 1 for the answer alone.
    sketch : str
        A drawing in letters, printed above the question.
    """

    name: str
    asks: str
    default: str
    choices: Mapping[str, str] = field(default_factory=lambda: NOTHING)
    parameter: str = ""
    says: str = ""
    needs: Mapping[str, str] = field(default_factory=lambda: NOTHING)
    unless: str = ""
    values: int = 1
    sketch: str = ""

    def belongs(self, answers: Mapping[str, str]) -> bool:
        """True if the question applies, given the answers to earlier questions."""
        return self.unless not in answers and all(
            answers.get(name) in words.split() for name, words in self.needs.items()
        )

    def read(self, text: str) -> str:
        """Return a typed answer in the form that the study takes: one of the choices, or a value.

        A choice may be typed by a synonym; a value is a number with or without unit, and is
        checked.

        Raises
        ------
        UnitError
            If the answer is invalid; the message says what is valid.
        """
        from vibrafeed.core.quantities import QUANTITIES
        from vibrafeed.core.study.units import UnitError, read_number
        from vibrafeed.core.suggestions import by_synonym, nearest

        text = text.strip()
        if self.choices:
            choice = text if text in self.choices else by_synonym(text, self.choices)
            if choice is None:
                similar = nearest(text, self.choices)
                all_choices = f"Please answer {' or '.join(self.choices)}"
                fix = f"Did you mean '{similar}'?" if similar else all_choices
                raise UnitError(f"'{text[:40]}' is not one of the answers", fix)
            return choice
        read_number(self.parameter, QUANTITIES[self.parameter], parse_typed(text))
        return text

    def warning(self, text: str) -> str:
        """Return a line that asks to confirm an unusual number; empty if the number is usual."""
        from vibrafeed.core.study.unusual import questions

        return " ".join(questions({"parameters": {self.parameter: parse_typed(text)}}))


def parse_typed(text: str) -> float | int | str:
    """Return a typed answer as TOML holds it: a number without unit becomes a plain number."""
    for number in (int, float):
        try:
            return number(text)
        except ValueError:
            continue
    return text


_IN_TIME = "speed drive springs"
_OF_SPRINGS: Final = {"question": "springs"}
_DRIVEN: Final = {"question": "speed drive forces springs"}
_OF_LINE: Final = {"question": "which-way"}

QUESTIONS: Final = (
    Question(
        "question", "What do you want to know?", "speed",
        choices={
            "speed": "how fast a part travels, how many a minute, whether it hops",
            "drive": "which angle of the drive makes it fastest",
            "forces": "forces and accelerations at the drive's peak",
            "springs": "what amplitude my springs give, and how many parts a minute",
            "which-way": "how many parts lie the right way up after a wiper",
        },
    ),
    Question(
        "path", "Which way may the track move?", "line", needs={"question": "drive"},
        choices={
            "line": "to and fro on a line",
            "ellipse": "around an ellipse: faster, and gentler, than any line",
        },
    ),
    Question(
        "hop", "May the part hop?", "yes", needs={"question": "drive"},
        choices={"yes": "hops are fine", "no": "it stays on the floor: throw number at most 1"},
    ),
    Question(
        "known", "How well do you know the friction?", "well", needs={"question": "drive"},
        choices={
            "well": "it is one number",
            "roughly": "within a fifth either way: the worst case is what counts",
        },
    ),
    Question(
        "part", "What shape is the part?", "rectangle",
        choices={
            "rectangle": "a block, a plate or a nut, lying flat",
            "cylinder": "round, lying along the track",
        },
        needs=_DRIVEN,
    ),
    Question(
        "track", "What does it lie on?", "straight",
        choices={"straight": "a straight track", "bowl": "the track of a bowl, with its wall"},
        needs={"part": "rectangle", "question": "speed drive forces"},
    ),
    Question(
        "radius", "Radius of the bowl, at the track", "150 mm", parameter="radius",
        says="Radius of the track's wall.", needs={"track": "bowl"},
    ),
    Question(
        "lean", "Lean of the track towards its wall", "5 deg", parameter="delta",
        says="Lean of the track: it keeps the part at the wall. 0 for a level one.",
        needs={"track": "bowl"},
    ),
    Question(
        "climb", "Climb of the track", "2 deg", parameter="gamma",
        says="Climb of the track; 0 if it is level, negative if it descends.", needs=_DRIVEN,
    ),
    Question(
        "frequency", "Frequency of the drive", "50 Hz", parameter="frequency",
        says='Frequency of the drive; "3000 rpm" is 50 Hz, too.', needs=_DRIVEN,
    ),
    Question(
        "peak_to_peak", "", "", parameter="peak_to_peak",
        says="Stroke of the drive, peak to peak, along the drive's direction.",
    ),
    Question(
        "amplitude", "Amplitude of the drive, half of its stroke", "0.3 mm",
        parameter="amplitude", needs={"question": "speed drive"}, unless="peak_to_peak",
        says="Amplitude of the drive, from zero to peak: half of the stroke, along the drive.\n"
        "Of a gauge that reads upwards, give vertical_amplitude in its place.",
    ),
    Question(
        "amplitude", "Amplitude of the drive, half of its stroke", "0.2 mm",
        parameter="amplitude", needs={"question": "forces"}, unless="peak_to_peak",
        says="Amplitude of the drive, from zero to peak: half of the stroke, along the drive.\n"
        "Of a gauge that reads upwards, give vertical_amplitude in its place.",
    ),
    Question(
        "angle", "Angle of the drive above the track", "20 deg", parameter="beta",
        says="Angle between the drive's direction and the track; 0 is along the track.",
        needs={"question": "speed forces"}, sketch=DRIVE_FROM_THE_SIDE,
    ),
    Question(
        "moving_mass", "Mass of trough or bowl", "10 kg", parameter="moving_mass",
        says="Mass of the trough or bowl, with everything fixed to it.", needs=_OF_SPRINGS,
    ),
    Question(
        "base_mass", "Mass of the base", "30 kg", parameter="base_mass",
        says="Mass of the base, or counter-mass.", needs=_OF_SPRINGS,
    ),
    Question(
        "rings", "Frequency in which the empty unit rings after a knock", "53 Hz",
        parameter="ring_down_frequency",
        says="Natural frequency, measured: docs/tuning.md says how, and what to do without it.",
        needs=_OF_SPRINGS,
    ),
    Question(
        "damping", "Damping ratio, logarithmic decrement over 2 pi", "0.02",
        parameter="damping_ratio",
        says="Damping ratio: of a ring-down ln(one stroke over the next)/(2 pi).",
        needs=_OF_SPRINGS,
    ),
    Question(
        "pull", "Amplitude of the magnet's force", "60 N", parameter="drive_force",
        says="Amplitude of the force between both masses at the drive's frequency.",
        needs=_OF_SPRINGS,
    ),
    Question(
        "tilt", "Tilt of the springs from the vertical", "20 deg", parameter="spring_angle",
        says="Tilt of the leaves from the vertical: the line of a straight track is as steep.",
        needs=_OF_SPRINGS,
    ),
    Question(
        "load", "Mass of all parts on a full track", "2 kg", parameter="conveyed_mass",
        says="Mass of all parts that travel, up to a full track: the rate against the load.",
        needs=_OF_SPRINGS, values=41,
    ),
    Question(
        "friction", "Friction between part and track", "0.3", parameter="friction",
        says="Coefficient of friction between part and track; `vibrafeed materials` lists some.",
        needs=_DRIVEN,
    ),
    Question(
        "length", "Length of the part, along the track", "20 mm", parameter="length",
        says="Length of the part along the track; how many a minute depends on it.",
        needs={"question": _IN_TIME},
    ),
    Question(
        "length", "Length of the part, along the track", "20 mm", parameter="length",
        says="Length of the part along the track; whether it tips depends on it.",
        needs={"question": "forces", "part": "rectangle"},
    ),
    Question(
        "height", "Height of the part", "5 mm", parameter="height",
        says="Height of the part; where the floor's force acts depends on it.",
        needs={"question": "forces", "part": "rectangle"},
    ),
    Question(
        "diameter", "Diameter of the part", "8 mm", parameter="diameter",
        says="Diameter of the part.", needs={"question": "forces", "part": "cylinder"},
    ),
    Question(
        "mass", "Mass of the part", "5 g", parameter="mass", says="Mass of the part.",
        needs={"question": "forces"},
    ),
    Question(
        "length", "Length of the part", "30 mm", parameter="length",
        says="Length of the part.", needs=_OF_LINE,
    ),
    Question(
        "width", "Width of the part", "20 mm", parameter="width",
        says="Width of the part.", needs=_OF_LINE,
    ),
    Question(
        "height", "Height of the part as it lies flat", "10 mm", parameter="height",
        says="Height of the part as it lies flat.", needs=_OF_LINE,
    ),
    Question(
        "wiper", "Height of the wiper over the track", "12 mm", parameter="wiper_height_1",
        says="A wiper at the first place: passes parts that are no higher. More devices, such as\n"
        "turned_share_1, gap_length_2 or outlet_capacity_3: docs/which-way-up.md.", needs=_OF_LINE,
    ),
    Question(
        "wanted", "How parts are to leave: 1 flat, 2 on their side, 3 on an end", "1",
        parameter="wanted_aspect", says="How parts are to leave: 1 flat, 2 on their side, 3 on an "
        "end.", needs=_OF_LINE,
    ),
    Question(
        "arrivals", "Parts a minute that reach the wiper", "300 1/min", parameter="arrival_rate",
        says="Parts a minute that arrive: the feed_rate of a study of their motion.",
        needs=_OF_LINE,
    ),
)  # fmt: skip
"""In the order in which they are asked; of two with one name, no more than one belongs."""
