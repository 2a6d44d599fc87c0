"""`python -m benchmarks.validation_page` writes docs/validation.md: problems, answers, engines.

Answers are computed anew; what engines found is read from docs/generated/validation-engines.json,
which `python -m benchmarks.validation_engines` writes.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from benchmarks.validation_engines import ASKED, NAMES, PICTURE, RESULTS, STEPS
from vibrafeed.core.assurance.case import EVIDENCE, RELATIONS
from vibrafeed.core.assurance.catalogue import FAMILIES, NOT_CLAIMED, cases
from vibrafeed.core.assurance.forms import Form, forms
from vibrafeed.core.assurance.judge import Outcome, run_cases
from vibrafeed.core.assurance.tables import expected, number
from vibrafeed.core.assurance.worked import rail, throws
from vibrafeed.core.dataset.markdown import markdown_table

DOCS = Path(__file__).parents[1] / "docs"
PAGE = DOCS / "validation.md"
DIGITS = 10  # of what is found: all processors agree on them

HEAD = """\
# Validation

Does vibrafeed give the values that are known? This page has what is known about parts on vibrating
tracks, and what vibrafeed says: exact
solutions from the literature and our own, limits, laws that every drive keeps, measured sets,
worked values, and general physics engines on the same problems. Written by `python -m
benchmarks.validation_page`.

```
vibrafeed validate                        # a row a family; exit code 1 if an answer is wrong
vibrafeed validate --family Q,W           # every problem of these families
vibrafeed validate --random 1000 --seed 7 # more members of each family, with random inputs
vibrafeed validate -o validation.md       # all as a page; .json for programs, .txt as lines
```

Each family is a formula over its inputs. A few members are listed with the digits of their
source; any number of others is drawn at random, with climbs, forces that hold the part down and
static above kinetic friction where the formula has them. `vibrafeed validate --random 400` finds
all of some 8,600 right, in a minute."""

ENTER = """\
## Enter your own program

`vibrafeed validate --problems -o problems.json` writes every problem in words and numbers: what
happens, the inputs with their units, the source, the expected value with its tolerance and the
reason for it, and the studies of vibrafeed that answer it. Answer as many as you like, each by
its name, and `null` where your program tried and has none:

```json
{"format": "vibrafeed-answers-1", "program": "Another 1.2",
 "answers": {"Q-two-levels-1": 15.8828, "W-winkler-1": 3.3269, "M-ellipse-r7.12": -0.2811}}
```

`vibrafeed validate --answers answers.json` judges them by the same tolerances, and says how far
off each is. The name of a member with random inputs shows its seed and its place:
`M-ellipse-r7.12` is the twelfth of `vibrafeed validate --problems --seed 7 --random 12`."""

ENGINES = """\
## Physics engines on the same problems

Five engines on six of these problems, with one coefficient of friction, which is all that they
know. The track stands still, and before each step gravity is set to what a part on a vibrating
track feels, less the mean acceleration of the track over that step: no engine has to move a
plate, and the drive is exact at any step. The block cannot turn. MuJoCo's contacts are as stiff
as its step allows; nothing else was tuned. Siconos is asked for the law of friction to 1e-12.
`fast ellipse` is set beside the exact answer for mu g/(A_x w^2) = 0.05. Errors are shares of the
answer."""

AFTER = """\
The time is processor time, of one answer: the periods until the motion repeats, and {during}
more. vibrafeed is exact to rounding; its time is that of a cell among many. PyBullet, pymunk,
DART and Siconos find the same numbers: in the frame of the track each of their steps is Coulomb's
law on impulses, and only the time differs. Their error is of first order in the step, and
erratic: slip turns at the end of a step, never within it. Contacts of MuJoCo give way, which
counts where the load is near 0 for a while, as under the ellipse.

`python -m benchmarks.validation_engines` runs what is installed: the
[extra](install.md#extras) `engines` brings MuJoCo, PyBullet and pymunk, `pip install dartpy`
DART, Debian's package `python3-siconos` (4.4.0, which calls itself 4.5.0) Siconos, for Debian's
own Python (`--python siconos=/usr/bin/python3`). Times depend on the machine: these are of two
cores that others used too. Siconos was not at hand when the last of these problems came."""


def page() -> str:
    """Return the text of the validation page."""
    outcomes = run_cases(cases())
    lines = [HEAD, "", *_kinds(), "", "## Anchors", ""]
    families = list(FAMILIES)
    for form in sorted(forms().values(), key=lambda form: families.index(form.name[0])):
        mine = [one for one in outcomes if one.case.form == form.name]
        lines += [*_form(form, mine), ""]
    lines += [
        *_thrown(outcomes),
        "",
        *_measured(outcomes),
        "",
        *_worked(outcomes),
        "",
        *_thesis(),
        "",
        ENTER,
        "",
    ]
    lines += [*_engines(), "", *_not_claimed()]
    return "\n".join(lines) + "\n"


def _kinds() -> Iterator[str]:
    """Yield the table of kinds of truth."""
    yield "| kind of truth | |"
    yield "| --- | --- |"
    for name, words in EVIDENCE.items():
        yield f"| {name} | {words} |"


def _form(form: Form, outcomes: list[Outcome]) -> Iterator[str]:
    """Yield the section on a form: its description and listed problems."""
    yield f"### {form.title} ({form.name})"
    yield ""
    yield f"{form.words}"
    yield ""
    inputs = "; ".join(f"`{name}` [{meaning}]" for name, meaning in form.inputs.items())
    share = "of the answer" if form.relative else f"[{form.unit}]"
    yield f"- Inputs: {inputs.replace('; 1/T]', ']')}"
    yield f"- Answer: [{form.unit}], {form.truth}. Source: {form.source}."
    yield f"- Random members: within {form.tolerance:g} {share}; {form.why}."
    if outcomes:
        yield ""
        yield from markdown_table(
            ("problem", "inputs", "expected", "found", "may be off by", "is"),
            [_row(outcome) for outcome in outcomes],
        )


def _row(outcome: Outcome) -> tuple[str, ...]:
    """Return the table row of an outcome."""
    case = outcome.case
    given = ", ".join(f"{name} {value:.9g}" for name, value in case.inputs.items())
    nothing = abs(outcome.value) < 1e-3 * case.right.tolerance  # rounding, or how a limit is missed
    return (
        case.id,
        given,
        expected(case),
        "0" if nothing else number(outcome.value, case.right.tolerance, DIGITS),
        f"{case.right.tolerance:.1g}: {case.why}",
        "right" if outcome.passed else "**wrong**",
    )


def _thrown(outcomes: list[Outcome]) -> Iterator[str]:
    """Yield the section on measured throws of dice and coins."""
    found = {one.case.id: one for one in outcomes if one.case.family in "DC"}
    yield "## Measured: dice and coins"
    yield ""
    yield (
        "The share of cuboids x : y : y that came to rest on either square, and of coins that came "
        "to rest on their side, beside the shares of let-down and of thrown parts. Sources: "
        f"{throws.SOURCES['D']}; {throws.SOURCES['C']}."
    )
    yield ""
    yield (
        f"Of the cuboids {100 * found['D-scatter-1'].value:.1f} points are left by the shares of "
        "thrown parts, as a root of the mean square. Coins lie between both ends, at neither: no "
        "one law fits both, and the distance of both shares is the error of either."
    )
    yield ""
    rows = [
        (
            f"{kind} {one.ratio:g}", f"{one.throws:,}" if one.throws else "", f"{one.share:.3f}",
            *(f"{found[f'{letter}-{way}-{number}'].value:.3f}" for way in throws.WAYS),
        )
        for letter, kind, thrown in (("D", "cuboid", throws.DICE), ("C", "coin", throws.COINS))
        for number, one in enumerate(thrown, 1)
    ]  # fmt: skip
    columns = ("x/y, or height over diameter", "throws", "measured", "let down", "thrown")
    yield from markdown_table(columns, rows)


def _measured(outcomes: list[Outcome]) -> Iterator[str]:
    """Yield the section on measured values."""
    mine = [one for one in outcomes if one.case.family == "Y"]
    (scatter,) = (one for one in mine if one.judged)
    yield "## Measured: a rail of cast iron"
    yield ""
    yield f"{rail.WORDS} Source: {rail.SOURCE} (`configs/{rail.FILE.name}`)."
    yield ""
    yield (
        f"What is left is {scatter.value:.2f} mm/s as a root of the mean square, "
        f"{scatter.case.digits} being expected. The moving mass is not settled by these data: "
        "only mu_k/m counts, "
        "and with 0.358 kg and the printed mu_k of 0.34 three times as much is left. Below 38 N "
        "the authors lose contact of the plane; those runs are shown and not judged."
    )
    yield ""
    rows = [
        (
            f"{run['frequency']:g}", f"{run['a_s']:g}", f"{run['a_m']:g}", f"{run['force']:g}",
            f"{run['speed']:.2f}", f"{one.value:.2f}", f"{one.value - run['speed']:+.2f}",
            "" if run["force"] >= rail.CONTACT else "contact lost",
        )
        for run, one in zip(rail.runs(), mine, strict=False)
    ]  # fmt: skip
    columns = ("f [Hz]", "a_s [g]", "a_m [g]", "F [N]", "measured [mm/s]", "formula [mm/s]",
               "difference", "")  # fmt: skip
    yield from markdown_table(columns, rows)


def _worked(outcomes: list[Outcome]) -> Iterator[str]:
    """Yield the section on worked values, figures and hard cases."""
    yield "## Worked values"
    yield ""
    yield (
        "Numbers that were worked out without this program, by closed forms and by another method "
        "of events (`core/assurance/worked/values.toml`), and figures of the thesis that show "
        "one number."
    )
    yield ""
    rows = []
    for outcome in outcomes:
        case = outcome.case
        if case.family in "VF":
            unit = "" if case.unit == "1" else case.unit
            said = case.digits or number(case.right.value, case.right.tolerance, DIGITS)
            rows.append(
                (
                    case.id, case.title, RELATIONS[case.relation] + said,
                    number(outcome.value, case.right.tolerance, DIGITS), unit,
                    "right" if outcome.passed else "**wrong**",
                )
            )  # fmt: skip
    yield from markdown_table(("problem", "what", "expected", "found", "unit", "is"), rows)
    hard = [outcome for outcome in outcomes if outcome.case.family == "H"]
    right = sum(outcome.passed for outcome in hard)
    yield ""
    yield (
        "Of the hard cases in [generated/accuracy.md](generated/accuracy.md) those that a closed "
        "form answers are family H: "
        f"{right} of {len(hard)} are right."
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
        for steps in STEPS:
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
    yield AFTER.format(during=20)


def _seconds(seconds: float) -> str:
    """Return a time with its unit."""
    return f"{seconds:.2g} s" if seconds >= 1e-3 else f"{1e6 * seconds:.2g} µs"


def _not_claimed() -> Iterator[str]:
    """Yield the section on what the program does not claim."""
    yield "## What is known, and no claim of this program"
    yield ""
    for name, words in NOT_CLAIMED.items():
        yield f"- {name}: {words}"
    letters = ", ".join(f"{letter} {title.lower()}" for letter, title in FAMILIES.items())
    yield ""
    yield f"Families by their letters: {letters}."


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE.name}")
