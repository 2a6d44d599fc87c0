"""`python -m benchmarks.validation_page` writes docs/validation.md from the known answers.

The results are computed anew; those of the physics engines are read from
docs/generated/validation-engines.json, which `python -m benchmarks.validation_engines` writes.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

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

With published inputs the predicted way of a part is off by 40 % of the travel; with friction and
force measured in the run, by 9 %. The model is not the reason: friction is no constant of a
material. So [calibrate](calibrate.md), or give
[friction as a range](friction.md#or-give-the-pair)."""

MEASURED = (
    (
        "Ten tracked courses of a part of 9 g, -2.6 to 13.4 mm/s [1]",
        "mean position error 0.52 mm, 40 % of the largest travel; the sign is right in 9 of 10",
        "kinetic friction and the force of each run: 0.164 mm, 9.3 % (the authors' model: 11.9 %)",
        "friction and normal force of the run",
    ),
    (
        "43 speeds on a rail, two-level waves, 3.4 to 44 mm/s [2]",
        "11.2, 9.8 and 11.8 mm/s (root mean square) with the three published masses",
        "mu/m: 3.06 mm/s, 15.6 %",
        "the moving mass; friction scatters by 14 % between repeats on one rig",
    ),
    (
        "15 steel cuboids, 9,329 throws [3]",
        "3.1 points (thrown), 14.7 (let down)",
        "none",
        "the momentum of the throw: the shares are a bracket",
    ),
    ("Two thick coins [4]", "between let down and thrown", "none", "the same"),
    (
        "The least acceleration that starts a part; their measurements confirm their formula [5]",
        "by the formula: starts at 1.0001, rests at 0.9999 of the threshold",
        "none",
        "nothing",
    ),
)
"""Measured families: what was measured, without a fit, with what is fitted, what is missing."""

MODEL_ENDS = """\
1. Yako, Nowak, Yuan, Salisbury, 2025, arXiv 2502.05693. Their raw data are public:
   `python -m benchmarks.tracked_courses FOLDER` reads them, and follows each recording once.
2. D. Yako, Y. Yuan, K. Salisbury, 2026, arXiv 2605.30780.
3. The Mathematical Gazette 97.16, 2013, table 1.
4. M. Parker's throws, in the repository iaroslav-ai/coin-experiment.
5. Journal of the Japan Society of Precision Engineering 33/391, 1967.

**Where the model ends.** Rigid contacts with Coulomb friction describe feeders of mains frequency.
Above about 1 kHz (piezo and ultrasonic drives) contacts give way before they slip, and vibration
lowers friction by itself. The model has no adhesion, which holds parts below about a millimetre,
no air, and no part that rocks while it travels."""

HEAD = """\
## Known answers

Does vibrafeed find the answers that are known? {count} of them are data in `tests/known_answers`:
TOML files with study, value, tolerance and source. One test compares all of them;
`python -m benchmarks.validation_page` writes this page from them.

An answer is a study and the value of its output, in the units of result files:

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
reader of 100 lines. `shown` answers are set beside a result and not judged; the scatter of their
whole set is."""

WITHOUT = """\
Two-level waves: D. Quaid, 1999; D. Yako, 2026. Best level wave: P. Umbanhowar and K. M. Lynch,
2008; the [proof](best-wave.md) is ours. Winkler's wave: G. Winkler, 1978. Drives far above
friction: the principle is D. Reznik's and J. Canny's. Answers whose name has `-r1.` have random
inputs, and the value of the formula that `source` states."""

ENGINES = """\
## Physics engines on the same problems

Five engines on six of these problems, with one coefficient of friction, which is all that they
know. The track stands still. Before each step, gravity becomes that of a frame which moves with
the track: less the mean acceleration of the track over that step. No engine has to move a plate,
and the drive is exact at any step. The block cannot turn. MuJoCo's contacts are as stiff
as its step allows; nothing else was tuned. Siconos is asked for the law of friction to 1e-12.
`Fast ellipse` is compared with the exact answer for mu g/(A_x w^2) = 0.05. Errors are shares of the
answer."""

AFTER = """\
The time is processor time of one answer: the periods until the motion repeats, and 20
more. vibrafeed is exact to rounding; its time is that of a cell among many. PyBullet, pymunk,
DART and Siconos find the same numbers: in the frame of the track each of their steps is Coulomb's
law on impulses, and only the time differs. Their error is of first order in the step, and
erratic: slip turns at the end of a step, never within it. Contacts of MuJoCo give way, which
counts where the load is near 0 for a while, as under the ellipse.

`python -m benchmarks.validation_engines` runs the installed engines, at 20 to 2,000 steps: the
[extra](install.md#extras) `engines` brings MuJoCo, PyBullet and pymunk, `pip install dartpy`
DART, Debian's package `python3-siconos` (4.4.0, which calls itself 4.5.0) Siconos, for Debian's
own Python (`--python siconos=/usr/bin/python3`). Times depend on the machine: these are of two
cores that others used too. Siconos was missing when the last of these problems came."""


def page() -> str:
    """Return the text of the validation page."""
    files = [*FIRST, *(file for file in FILES if file not in FIRST)]
    tables: dict[str, Table] = {}
    count = sum(len(known_answers(file)) for file in files)
    columns = ("measured", "inputs as published, no fit", "fitted", "what is missing")
    lines = [
        BEGIN,
        "",
        "## What was measured",
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
    """Yield the table of all files: answers, wrong ones, and the evidence for them."""
    rows = []
    for file in files:
        answers = known_answers(file)
        wrong = [one.name for one in answers if fault(one, tables)]
        judged = [one for one in answers if one.relation != "shown"]
        evidence = ", ".join(dict.fromkeys(one.evidence for one in answers))
        right = f"{len(judged)} of {len(judged)} right"
        verdict = f"**wrong: {', '.join(wrong)}**" if wrong else right
        rows.append((answers[0].group, f"`{file}.toml`", str(len(answers)), evidence, verdict))
    yield from markdown_table(("group", "file", "answers", "evidence", "judged"), rows)


def _measured(tables: dict[str, Table]) -> Iterator[str]:
    """Yield the sections on measured throws and on the measured rail."""

    def value(known: Known) -> float:
        return float(found(known, tables).value)

    yield "## Measured: dice and coins"
    yield ""
    yield (
        "The share of steel cuboids x : y : y that came to rest on either square, and of coins "
        "that came to rest on their side, beside the shares of let-down and thrown parts. Sources: "
        f"{answer('D-thrown-1').source}; {answer('C-thrown-1').source}."
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
        f"The shares of thrown parts leave {left:.1f} points of the cuboids, as a root of the mean "
        "square. Coins lie between both ends, at neither: no one law fits both, and the distance "
        "of both shares is the error of either."
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
        f"{len(apart)} runs have F >= 38 N; below that the authors lose contact of the plane. The "
        f"formula leaves {value(scatter):.2f} mm/s as a root of their mean square, "
        f"{scatter.value:.2f} being expected, and {np.abs(apart).max():.1f} mm/s at most. These "
        "data do not settle the moving mass: only mu_k/m counts, and with 0.358 kg and the "
        "printed mu_k of 0.34 the formula leaves three times as much."
    )


def _thesis() -> Iterator[str]:
    """Yield the number of claims on thesis figures with each verdict."""
    text = (DOCS / "thesis.md").read_text(encoding="utf-8").partition("### Figures 5.1")[2]
    verdicts = ("holds", "reproduced", "artefact beyond lift-off", "not reproduced",
                "cannot be reproduced")  # fmt: skip
    counts = {name: len(re.findall(rf"^\| [^|]+ \| {name} \|", text, re.M)) for name in verdicts}
    told = ", ".join(f"{name} {count}" for name, count in counts.items())
    yield "## Figures of the thesis"
    yield ""
    yield (
        f"Verdicts on {sum(counts.values())} claims about the figures of chapter 5: {told}. "
        "[thesis.md](thesis.md#figures-of-chapter-5) has each with its numbers."
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
