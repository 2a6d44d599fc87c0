"""`python -m benchmarks.validation_page` writes docs/validation.md from the known answers.

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
from benchmarks.known_answers import FILES, Known, answer, fault, found, known_answers
from benchmarks.validation_engines import ASKED, NAMES, PICTURE, RESULTS
from vibrafeed.core.dataset.table import Table
from vibrafeed.core.report import markdown_table

DOCS = Path(__file__).parents[1] / "docs"
PAGE = DOCS / "validation.md"
FIRST = ("dice", "coins", "starts", "rail", "thesis-figures", "worked-values")
"""Files in the order of the page: measured answers first, then figures and worked values."""
SHOWN_STEPS = (100, 2000)

BEGIN = """\
# Validation

With published inputs the predicted displacement of a part is off by 40 % of its travel; with
friction and force measured in the same run, by 9 %. The difference comes from friction, which
varies between runs, not from the model. Therefore [calibrate](friction.md#calibrate), or give
[friction as a range](friction.md#or-give-the-pair)."""

MEASURED = (
    (
        "Ten tracked parts of 9 g, -2.6 to 13.4 mm/s [1]",
        "mean position error 0.52 mm, 40 % of the largest travel; sign right in 9 of 10",
        "kinetic friction and force of each run: 0.164 mm, 9.3 % (the authors' model: 11.9 %)",
        "friction and normal force of the run",
    ),
    (
        "43 speeds on a rail, two-level waves, 3.4 to 44 mm/s [2]",
        "11.2, 9.8 and 11.8 mm/s (root mean square) with the three published masses",
        "mu/m: 3.06 mm/s, 15.6 %",
        "the moving mass; friction scatters by 14 % between repeats",
    ),
    (
        "15 steel cuboids, 9,329 throws [3]",
        "3.1 points (thrown), 14.7 (let down)",
        "none",
        "the momentum of the throw: the shares are a bracket",
    ),
    ("Two thick coins [4]", "between let down and thrown", "none", "the same"),
    (
        "Least acceleration that starts a part; the measurements confirm the authors' formula [5]",
        "by the formula: starts at 1.0001, rests at 0.9999 of the threshold",
        "none",
        "nothing",
    ),
)
"""Measured families: case, error without a fit, error with a fit, missing inputs."""

MODEL_ENDS = """\
1. Yako, Nowak, Yuan, Salisbury, 2025, arXiv 2502.05693, with public raw data, which
   `python -m benchmarks.tracked_courses FOLDER` follows once.
2. D. Yako, Y. Yuan, K. Salisbury, 2026, arXiv 2605.30780.
3. The Mathematical Gazette 97.16, 2013, table 1.
4. M. Parker's throws, in the repository iaroslav-ai/coin-experiment.
5. Journal of the Japan Society of Precision Engineering 33/391, 1967.

**Limits of the model.** Rigid contacts with Coulomb friction describe feeders of mains frequency.
Above about 1 kHz (piezo and ultrasonic drives) contacts deform before they slip, and vibration
lowers friction. The model has no adhesion, which holds parts below about a millimetre, no air, and
no parts that rock while they travel."""

HEAD = """\
## Known answers

{count} answers that are known from elsewhere are data in `tests/known_answers`: TOML files with
study, value, tolerance and source. One test compares all of them, and
`python -m benchmarks.validation_page` writes this page from them. An answer is a study and the
value of its output, in the units of result files:

```toml
[[answers]]
name = "W-winkler-1"
study = {{ kind = "simulate", scene = "rectangle-on-plane", ... }}
times = 1000.0       # the output in mm/s
value = 3.32687
tolerance = 5e-06
source = "family: G. Winkler, 1978; value: derived by us"
```

Other programs can read the same files: `benchmarks/known_answers.py` describes the keys and has a
reader of 100 lines. `shown` answers are not judged one by one; the scatter of their set is."""

WITHOUT = """\
Sources: two-level waves, D. Quaid, 1999, and D. Yako, 2026; best level wave, P. Umbanhowar and K.
M. Lynch, 2008 (the [proof](theory/best-drive.md) is ours); Winkler's wave, G. Winkler, 1978;
drives far above friction, the principle of D. Reznik and J. Canny. Answers with `-r1.` in their
name have random inputs and the value of the formula in `source`."""

ENGINES = """\
## Physics engines on the same problems

Five engines solve six of these problems, with one coefficient of friction, which is all that they
support. The track is at rest, and gravity is that of a frame that moves with the track: before each
step, minus the mean acceleration of the track over that step. The drive is therefore exact at any
step. The block cannot turn. MuJoCo's contacts are as stiff as its step allows, and Siconos solves
friction to 1e-12; nothing else was tuned. `Fast ellipse` is compared with the exact answer for
mu g/(A_x w^2) = 0.05. Errors are shares of the answer."""

AFTER = """\
The time is processor time of one answer: the periods until the motion repeats, and 20 more.
vibrafeed is exact to rounding; its time is that of a cell among many. PyBullet, pymunk, DART and
Siconos give the same numbers, because each of their steps is Coulomb's law on impulses. Their error
is of first order in the step and erratic, because slip can only reverse at the end of a step.
MuJoCo's contacts are soft, which matters where the load is near 0 for a while, as in the ellipse.

`python -m benchmarks.validation_engines` runs the installed engines, at 20 to 2,000 steps. The
[extra](install.md#extras) `engines` installs MuJoCo, PyBullet and pymunk; `pip install dartpy`
DART; Debian's package `python3-siconos` (4.4.0, which reports 4.5.0) Siconos, for Debian's own
Python (`--python siconos=/usr/bin/python3`). Times are of two shared cores. Siconos was not
available when the last problem was added."""


def page() -> str:
    """Return the text of the validation page."""
    files = [*FIRST, *(file for file in FILES if file not in FIRST)]
    tables: dict[str, Table] = {}
    count = sum(len(known_answers(file)) for file in files)
    columns = ("measured", "inputs as published, no fit", "fitted", "what is missing")
    lines = [
        BEGIN,
        "",
        "## Measurements",
        "",
        *markdown_table(columns, MEASURED),
        "",
        MODEL_ENDS,
        "",
        HEAD.format(count=count),
        "",
        "## All answers",
        "",
        *_groups(files, tables),
        "",
        WITHOUT,
    ]
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
    text = (DOCS / "thesis.md").read_text(encoding="utf-8").partition("by `python -m")[2]
    counts = {name: text.count(f" | {name} | ") for name in VERDICTS}
    told = ", ".join(f"{name} {count}" for name, count in counts.items())
    yield "## Figures of the thesis"
    yield ""
    yield (
        f"Verdicts on {sum(counts.values())} claims of chapter 5: {told}. "
        "[The thesis](thesis.md#figures-of-chapter-5) lists them with their numbers."
    )


def _engines() -> Iterator[str]:
    """Yield the section on other engines."""
    rows: list[dict[str, Any]] = json.loads(RESULTS.read_text(encoding="utf-8"))
    known = {(row["engine"], row["problem"], row["steps"]): row for row in rows}
    yield ENGINES
    yield ""
    yield f"![Error of each engine over the time of an answer](generated/{PICTURE.name})"
    yield ""
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
    yield ""
    yield AFTER


def _seconds(seconds: float) -> str:
    return f"{seconds:.2g} s" if seconds >= 1e-3 else f"{1e6 * seconds:.2g} µs"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE.name}")
