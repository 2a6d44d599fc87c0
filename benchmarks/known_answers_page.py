"""`python -m benchmarks.known_answers_page` writes docs/generated/known-answers.md.

The results are computed anew; those of the physics engines are read from
docs/generated/validation-engines.json, which `python -m benchmarks.validation_engines` writes.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.figures.judgement import VERDICTS
from benchmarks.figures.page import PAGE as CLAIMS
from benchmarks.known_answers import FILES, Known, answer, fault, found, known_answers
from benchmarks.validation_engines import ASKED, NAMES, RESULTS
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.report import markdown_table

PAGE = Path(__file__).parents[1] / "docs" / "generated" / "known-answers.md"
FIRST = ("dice", "coins", "starts", "rail", "thesis-figures", "worked-values")
"""Files in the order of the page: measured answers first, then figures and worked values."""
SHOWN_STEPS = (100, 2000)

HEAD = """\
# Known answers

{count} answers from elsewhere, and the results of vibrafeed.
`python -m benchmarks.known_answers_page` writes this page. [Validation](../validation.md) explains
the columns and the sources.

## All answers
"""

ENGINES = """\
## Physics engines

Errors are shares of the answer; [validation](../validation.md#physics-engines-on-the-same-problems)
describes the problems. `Fast ellipse` is compared with the exact answer for mu g/(A_x w^2) = 0.05.
The time is processor time of one answer on two shared cores: the periods until the motion repeats,
and 20 more. That of vibrafeed is the time of a cell among many.
"""


def page() -> str:
    """Return the text of the page of known answers."""
    files = [*FIRST, *(file for file in FILES if file not in FIRST)]
    tables: dict[str, Table] = {}
    count = sum(len(known_answers(file)) for file in files)
    lines = [HEAD.format(count=count), *_groups(files, tables)]
    lines += ["", *_measured(tables), "", *_thesis(), "", *_engines()]
    return "\n".join(lines) + "\n"


def _groups(files: list[str], tables: dict[str, Table]) -> Iterator[str]:
    """Yield the table of all groups: files, answers, evidence, and wrong answers."""
    rows = []
    for group, members in groupby(files, lambda file: known_answers(file)[0].group.split(":")[0]):
        names = list(members)
        answers = [one for file in names for one in known_answers(file)]
        wrong = [one.name for one in answers if fault(one, tables)]
        judged = [one for one in answers if one.relation != "shown"]
        evidence = ", ".join(dict.fromkeys(one.evidence for one in answers))
        right = f"{len(judged)} of {len(judged)} right"
        verdict = f"**wrong: {', '.join(wrong)}**" if wrong else right
        file = names[0] if len(names) == 1 else f"{names[0].split('-')[0]}-*"
        rows.append((group, f"`{file}.toml`", str(len(answers)), evidence, verdict))
    yield from markdown_table(("group", "file", "answers", "evidence", "judged"), rows)


def _measured(tables: dict[str, Table]) -> Iterator[str]:
    """Yield the sections on measured throws and on the measured rail."""

    def value(known: Known) -> float:
        return float(found(known, tables).value)

    yield "## Measured: dice and coins"
    yield ""
    yield (
        "Shares of steel cuboids x : y : y that came to rest on a square side, and of coins that "
        "came to rest on their edge, compared with the shares of let-down and thrown parts. "
        f"Sources: {answer('D-thrown-1').source}; {answer('C-thrown-1').source}."
    )
    yield ""
    rows = []
    for file, part in (("dice", "cuboid"), ("coins", "coin")):
        for known in known_answers(file):
            letter, way, number = known.name.replace("let-down", "down").split("-")
            if way == "thrown":
                down = value(answer(f"{letter}-let-down-{number}"))
                ratio, throws = known.inputs["ratio"], known.inputs.get("throws", "")
                shares = (f"{one:.3f}" for one in (known.value, down, value(known)))
                rows.append((f"{part} {ratio:g}", str(throws), *shares))
    columns = ("x/y, or height over diameter", "throws", "measured", "let down", "thrown")
    yield from markdown_table([*columns], (map(str, row) for row in rows))
    yield ""
    left = 100 * value(answer("D-scatter-1"))
    yield (
        f"Thrown shares leave a root mean square error of {left:.1f} points for the cuboids. Coins "
        "lie between both shares, and no one law fits both."
    )
    yield ""
    scatter = answer("Y-scatter-1")
    yield "## Measured: a rail of cast iron"
    yield ""
    yield f"{scatter.about} Source: {answer('Y-run-1').source} (`configs/rail-of-cast-iron.csv`)."
    yield ""
    apart = [
        value(one) - one.value
        for one in known_answers("rail")
        if one.relation == "shown" and one.inputs["force"] >= 38.0
    ]
    yield (
        f"In {len(apart)} runs F >= 38 N; below that the part loses contact. The formula leaves a "
        f"root mean square error of {value(scatter):.2f} mm/s ({scatter.value:.2f} expected), and "
        f"at most {np.abs(apart).max():.1f} mm/s. The data do not determine the moving mass: only "
        "mu_k/m counts, and with 0.358 kg and the printed mu_k of 0.34 the error is three times as "
        "large."
    )


def _thesis() -> Iterator[str]:
    """Yield the number of claims on thesis figures with each verdict."""
    text = CLAIMS.read_text(encoding="utf-8")
    counts = {name: text.count(f" | {name} | ") for name in VERDICTS}
    told = ", ".join(f"{name} {count}" for name, count in counts.items())
    yield "## Figures of the thesis"
    yield ""
    yield (
        f"Verdicts on {sum(counts.values())} claims of chapter 5: {told}. "
        "[Figures of the thesis](thesis-figures.md) lists them with their numbers."
    )


def _engines() -> Iterator[str]:
    """Yield the section on other engines."""
    rows: list[dict[str, Any]] = json.loads(RESULTS.read_text(encoding="utf-8"))
    known = {(row["engine"], row["problem"], row["steps"]): row for row in rows}
    yield ENGINES
    columns = ["engine", "steps a period"]
    for name, (title, _) in ASKED.items():
        columns += [f"{title} ({name})", "time"]
    versions = {row["engine"]: row["version"] for row in rows}
    lines = []
    for name in (name for name in NAMES if name in versions):
        for steps in SHOWN_STEPS:
            cells = [f"{NAMES[name]} {versions[name]}", f"{steps:,}"]
            for case in ASKED:
                row = known.get((name, case, steps))  # None where the engine did not run
                cells += (
                    [f"{100 * row['error']:.2g} %", _seconds(row["seconds"])] if row else ["", ""]
                )
            lines.append(cells)
    own = ["vibrafeed, events", ""]
    for case in ASKED:
        own += ["rounding", _seconds(known["vibrafeed", case, 0]["seconds"])]
    yield from markdown_table(columns, [*lines, own])


def _seconds(seconds: float) -> str:
    return f"{seconds:.2g} s" if seconds >= 1e-3 else f"{1e6 * seconds:.2g} µs"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE.name}")
