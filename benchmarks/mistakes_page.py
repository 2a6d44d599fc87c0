"""The page of the site on mistakes and their messages: docs/generated/mistakes.md.

Each mistake is made in a folder of its own by the command
line, or in Python, and has to get one message.
"""

from __future__ import annotations

import json
import os
import shlex
import tempfile
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from typer.testing import CliRunner

MOTION = """\
kind = "simulate"
scene = "rectangle-on-plane"
outputs = ["conveying_velocity"]

[parameters]
frequency = "50 Hz"
amplitude = "0.3 mm"
beta = "20 deg"
friction = 0.3
"""
BOWL = MOTION.replace("on-plane", "on-track")
SWEEP = """\
kind = "sweep"
scene = "rectangle-on-plane"
outputs = ["acceleration_x"]

[parameters]
frequency = "50 Hz"
amplitude = { start = "0.05 mm", stop = "0.75 mm", num = 30 }
beta = ["10 deg", "20 deg", "30 deg"]
friction = 0.3
"""
CHECK = "vibrafeed run study.toml --dry-run"


@dataclass(frozen=True)
class Mistake:
    """One mistake: what somebody typed, and how it is made.

    Attributes
    ----------
    typed : str
        What was typed, as the page shows it.
    make : callable
        Makes it in the current folder; returns the lines that were said.
    """

    typed: str
    make: Callable[[], list[str]]


def command(line: str, **files: str) -> list[str]:
    """Return the output of a vibrafeed command on files, whose names have _ for the dot."""
    from vibrafeed.app.cli import app

    for name, text in files.items():
        Path(name.replace("_", ".")).write_text(text, encoding="utf-8")
    _, *words = shlex.split(line)
    said = CliRunner().invoke(app, words).stderr.splitlines()
    counts = ("1 problem", "problems", "1 warning")
    return [text.strip() for text in said if not text.endswith(counts)]


def in_study(wrong: str, right: str = "", study: str = MOTION, typed: str = "") -> Mistake:
    """Return a mistake in a line of a study; `right` is the correct line."""
    text = study.replace(right, wrong) if right else f"{study}{wrong}\n"
    return Mistake(typed or wrong, lambda: command(CHECK, study_toml=text))


def on_the_line(line: str, **files: str) -> Mistake:
    """Return a mistake on the command line."""
    return Mistake(line, lambda: command(line, **files))


def in_python(code: str) -> Mistake:
    """Return a mistake in a line of Python."""

    def make() -> list[str]:
        """Run the wrong line and return the error."""
        import numpy as np

        import vibrafeed as vf

        Path("study.toml").write_text(MOTION, encoding="utf-8")
        try:
            eval(code, {"vf": vf, "np": np})
        except vf.StudyError as error:
            return str(error).splitlines()
        return []

    return Mistake(code, make)


def plotted(line: str) -> Mistake:
    """Return a mistake in drawing a result."""

    def make() -> list[str]:
        """Run the wrong command and return its output."""
        _result(Path("study.nc"))
        return command(line)

    return Mistake(line, make)


def _result(path: Path) -> None:
    """Write a result file."""
    import vibrafeed as vf

    vf.sweep(tomllib.loads(SWEEP)).to_netcdf(path)


GROUPS: dict[str, tuple[Mistake, ...]] = {
    "Names": (
        in_study("mu = 0.3", "friction = 0.3"),
        in_study("friction_coefficient = 0.3", "friction = 0.3"),
        in_study('slope = "3 deg"'),
        in_study('launch_angle = "20 deg"', 'beta = "20 deg"'),
        in_study('stroke = "0.6 mm"', 'amplitude = "0.3 mm"'),
        in_study("freq = 50", 'frequency = "50 Hz"'),
        in_study('coating = "PTFE"'),
        in_study('scene = "bowl"', 'scene = "rectangle-on-plane"'),
        in_study('kind = "simulation"', 'kind = "simulate"'),
        in_study('outputs = ["velocity"]', 'outputs = ["conveying_velocity"]'),
        in_study('outputs = ["transport_velocity"]', 'outputs = ["conveying_velocity"]', BOWL),
        in_study('outputs = ["conveying_velocity"]', 'outputs = ["acceleration_x"]', SWEEP),
        in_study('method = "event"\n\n[parameters]', "[parameters]", typed='method = "event"'),
    ),
    "Numbers and units": (
        in_study("amplitude = 0.5", 'amplitude = "0.3 mm"'),
        in_study("frequency = 5000", 'frequency = "50 Hz"'),
        in_study("beta = 0.35", 'beta = "20 deg"'),
        in_study("friction = 30", "friction = 0.3"),
        in_study('amplitude = "0,3 mm"', 'amplitude = "0.3 mm"'),
        in_study('frequency = "50 mm"', 'frequency = "50 Hz"'),
        in_study('frequency = "314 rad/s"', 'frequency = "50 Hz"'),
        in_study("friction = -0.3", "friction = 0.3"),
        in_study('amplitude = ["0.2 mm", "0.1 mm", "0.3 mm"]', 'amplitude = "0.3 mm"'),
        in_study('frequency = { start = "20 Hz", stop = "120 Hz" }', 'frequency = "50 Hz"'),
        in_study('frequency = { start = 120, stop = 120, num = 11 }', 'frequency = "50 Hz"'),
    ),
    "What belongs together": (
        in_study("", "friction = 0.3\n", typed="no line `friction`"),
        in_study('radius = "0.2 m"'),
        in_study('peak_to_peak = "0.6 mm"'),
        in_study("", "[parameters]\n", typed="no line `[parameters]`"),
        in_study('outputs = ["direction"]', typed='outputs = ["direction"] below [parameters]'),
    ),
    "Files": (
        in_study("beta = 20 deg", 'beta = "20 deg"'),
        on_the_line("vibrafeed run study.json", study_json=MOTION),
        on_the_line("vibrafeed run study.toml", study_toml=json.dumps(tomllib.loads(MOTION))),
        on_the_line("vibrafeed run study.nc", study_nc=""),
        on_the_line("vibrafeed run stduy.toml"),
        on_the_line("vibrafeed run study.toml -o study.docx", study_toml=MOTION),
        on_the_line("vibrafeed run study.toml -o old.nc", study_toml=MOTION, old_nc=""),
        on_the_line("vibrafeed convert study.toml --to yaml", study_toml=MOTION),
        on_the_line("vibrafeed new --yes", study_toml=MOTION),
        on_the_line("vibrafeed new --yes --radius '0.2 m'"),
    ),
    "Pictures": (
        plotted("vibrafeed plot study.nc --at 'amplitude=0.7 mm' --axes beta"),
        plotted("vibrafeed plot study.nc --variable velocity"),
        plotted("vibrafeed plot study.nc --kind contour --axes beta"),
    ),
    "Python": (
        in_python('vf.sweep("study.toml")'),
        in_python('vf.simulate("study.toml", mu=0.3)'),
        in_python('vf.simulate("study.toml", frequency=np.ones((2, 2)))'),
    ),
}  # fmt: skip


def made() -> dict[str, list[tuple[str, list[str]]]]:
    """Return the mistakes of each group with the messages they cause."""
    found: dict[str, list[tuple[str, list[str]]]] = {}
    for group, mistakes in GROUPS.items():
        found[group] = []
        for mistake in mistakes:
            with _folder():
                found[group].append((mistake.typed, mistake.make()))
    return found


@contextmanager
def _folder() -> Iterator[None]:
    """Run the block in a temporary folder."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


def page() -> str:
    """Return the text of the page on mistakes."""
    lines = [
        "# Error messages",
        "",
        "A program makes each of these mistakes and writes the message. Lines that are not",
        "commands are in an otherwise correct `study.toml`, checked by",
        "`vibrafeed run study.toml --dry-run`. The line before a message, which names the file and",
        "counts its problems, is left out. Questions about a number are warnings; the study runs.",
    ]
    number = 0
    for group, rows in made().items():
        lines += ["", f"## {group}", "", "| | typed | said |", "| --- | --- | --- |"]
        for typed, said in rows:
            (message,) = said
            number += 1
            shown = typed if "`" in typed else f"`{typed}`"
            lines.append(f"| {number} | {_cell(shown)} | {_cell(message)} |")
    return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    """Return a text for a table cell."""
    return text.replace("|", "\\|")
