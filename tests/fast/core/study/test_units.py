"""Units that users write; the table of units says what pint says, and spares its loading."""

import collections
import functools
import itertools
import random

import pytest

from night import spread
from refusals import words_of
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import parse_study, read_json
from vibrafeed.core.intake.forms import read_toml
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study import units
from vibrafeed.core.study.shown import SI, SMALLER, TRADE
from vibrafeed.core.study.units import WORDS, UnitError, _factor, factor_between, read_number


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    "unit",
    [
        "mm**99999999",
        "mm^99999999",
        "mm**9**9**9",
        "(mm**9)**9",
        "mm**9e9",
        "mm**9_9",
        "mm**(9)**9",
        "mm²²²²²²²²²",
        "mm*9e999999999",
        "mm*1.e99999999",
        "mm**\N{ARABIC-INDIC DIGIT NINE}9999999",
    ],
)
def test_powers_that_would_take_hours_are_no_units(unit):
    with pytest.raises(UnitError):
        read_number("amplitude", QUANTITIES["amplitude"], f"1 {unit}")


LONG = "0.3" + "0" * 250 + " mm"  # cut to 200 characters it is 0.3 m
POINT = {"frequency": 50, "amplitude": "0.3 mm", "beta": 20}
TOO_LONG = "characters. A value has at most 200 characters"


def study(kind="sweep", scene="rectangle-on-plane", parameters=POINT, **more):
    outputs = {} if kind in ("optimise", "calibrate") else {"outputs": ["throw_number"]}
    return {"kind": kind, "scene": scene, **outputs, "parameters": parameters, **more}


def cut(name, text):
    """Return a share of cells below a text."""
    return {"reduce": {"over": ["beta"], "shares": {"low": [f"{name} < {text}"]}}}


MEASURED = {"amplitude": "0.3 mm", "conveying_velocity": "20 mm/s"}
RUNS = {"kind": "calibrate", "parameters": {"frequency": 50, "beta": 20}}
LOOKED_FOR = {"unknowns": {"friction": {"lower": 0.1, "upper": 0.6}}}
RANGE = {"start": "0.1 mm", "stop": "0.3 mm", "step": "0.1 mm"}
BEST = {"kind": "optimise", "variables": {"beta": {"lower": 10, "upper": 40}}}
UNSURE = {"kind": "sensitivity", "parameters": {"frequency": 50, "beta": 20}}
GOAL = {"criterion": {"kind": "maximise", "output": "acceleration_x"}}


@pytest.mark.parametrize(
    "content",
    [
        study(parameters={**POINT, "amplitude": LONG}),
        study(parameters={**POINT, "amplitude": ["0.1 mm", LONG]}),
        *(study(parameters={**POINT, "amplitude": {**RANGE, key: LONG}}) for key in RANGE),
        study(**BEST, **GOAL, constraints=[{"output": "acceleration_x", "lower": LONG}]),
        study(**{**BEST, "variables": {"amplitude": {"lower": LONG, "upper": 1}}}, **GOAL),
        study(**UNSURE, uncertain={"amplitude": {"lower": LONG, "upper": 1}}),
        study(**UNSURE, uncertain={"amplitude": {"mean": "0.3 mm", "deviation": LONG}}),
        study(**UNSURE, uncertain={"amplitude": {"mean": "0.3 mm", "deviation": f"{LONG[:-2]}%"}}),
        study(**RUNS, **LOOKED_FOR, observations=[{**MEASURED, "amplitude": LONG}]),
        study(**RUNS, **LOOKED_FOR, observations=[{**MEASURED, "conveying_velocity": LONG}]),
        study(**RUNS, **LOOKED_FOR, observations=[{**MEASURED, "error": LONG}]),
        study(**RUNS, **LOOKED_FOR, observations=[{**MEASURED, "error": f"{LONG[:-2]}%"}]),
        study(**RUNS, **LOOKED_FOR, offsets={"beta": {"lower": -1, "upper": LONG}}),
    ],
)
def test_a_text_that_is_longer_than_a_value_is_refused_and_never_cut(content):
    assert TOO_LONG in words_of(parse_study, content)


@pytest.mark.parametrize("content", [cut("drive_along", LONG), cut("regime", "x" * 250)])
def test_a_long_condition_is_refused(content):
    with pytest.raises(StudyError, match="is not a condition"):
        parse_study(study(**content))


@pytest.mark.parametrize("text", ["17,220 mm/s", "1,500"])
def test_thousands_as_the_screen_writes_them_may_be_decimals(text):
    with pytest.raises(UnitError, match=r"may mean two numbers\. Remove the comma, or write a dec"):
        read_number("mean_velocity", QUANTITIES["mean_velocity"], text)
    longest = "0.3".ljust(197, "0") + " mm"
    assert read_number("amplitude", QUANTITIES["amplitude"], longest) == 3e-4
    with pytest.raises(UnitError, match="has 201 characters"):
        read_number("amplitude", QUANTITIES["amplitude"], f"{longest} ")


@pytest.mark.parametrize("read", [read_json, read_toml])
def test_an_integer_of_900_000_digits_is_refused_in_our_words(read):
    digits, words = "1" * 900_000, "the number is larger than 1.8e308. Write a smaller number."
    text = '{"frequency": DIGITS}' if read is read_json else "frequency = DIGITS\n"
    for given, place in ((digits, ""), (digits[:400], "frequency: ")):
        assert f"{place}{words}" in words_of(read, text.replace("DIGITS", given))
    with pytest.raises(StudyError, match="has 900,000 characters"):
        parse_study(study(parameters={**POINT, "frequency": digits}))


OWN = sorted({quantity.unit for quantity in QUANTITIES.values()})
POWERS = ("", "**2", "**-1", "**-2", "^3")


def by_pint(text, own, *, with_g):
    """Return what the reader of units says if it has no table."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(units, "factor_between", lambda *_: None)
        return _factor.__wrapped__(own, text, with_g=with_g)


def by_words(text, own, *, with_g):
    """Return what it says without pint; None where it asks pint."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(units, "_quantity", lambda _: pytest.fail("of pint"))
        try:
            return _factor.__wrapped__(own, text, with_g=with_g)
        except (pytest.fail.Exception, ValueError):
            return None


@functools.cache
def products():
    """Return the products and quotients of two words by their dimensions."""
    found = collections.defaultdict(list)
    for parts in itertools.product(WORDS, "*/ ", WORDS, POWERS):
        _, kind = units._read("".join(parts))
        found[kind].append("".join(parts))
    return found


def test_every_word_is_as_pint_has_it():
    registry = units._registry()
    for word, (size, (metre, kilogram, second, ampere, radian)) in WORDS.items():
        base = registry.Quantity(units.Fraction(1), word).to_root_units()
        powers = {"meter": metre, "gram": kilogram, "second": second, "ampere": ampere}
        powers |= {"radian": radian}
        found = {name: power for name, power in base.unit_items() if name != "count"}
        assert found == {name: power for name, power in powers.items() if power}, word
        assert base.magnitude == size * 1000**kilogram, word  # pint's root of masses is the gram


@pytest.mark.parametrize("own", spread(OWN, 12))
def test_every_unit_of_a_quantity_is_read_as_pint_reads_it(own):
    """Words, and products of two; elsewhere pint itself is asked."""
    texts = [*WORDS, *SI.values(), *(f"1/{word}" for word in WORDS), own, own.replace(" ", ".")]
    texts += [unit for _, unit in (*TRADE.values(), *SMALLER.values())]
    _, kind = units._read(units._in_pint(own))
    fits = products()[kind]
    texts += random.Random(own).sample(fits, min(12, len(fits)))
    read = 0
    for text, with_g in itertools.product(filter(None, texts), (True, False)):
        found = by_words(text, own, with_g=with_g)
        if found is not None:
            assert found == by_pint(text, own, with_g=with_g), text
            read += 1
    assert read >= 4


def test_the_examples_of_all_quantities_are_read_without_pint(monkeypatch):
    monkeypatch.setattr(units, "_quantity", lambda _: pytest.fail("of pint"))
    monkeypatch.setattr(units, "_factor", _factor.__wrapped__)
    for name, quantity in QUANTITIES.items():
        for text in quantity.examples:
            units.read_number(name, quantity, text)


@pytest.mark.parametrize(
    ("text", "own", "right"),
    [
        ("mm/s**2", "m s**-2", "1/1000"),
        ("kg m**2*s**-1", "kg m**2*s**-1", "1"),
        ("N s/m", "N s m**-1", "1"),
        ("m/s*s", "m", "1"),  # a slash divides by what follows it, no more
        ("1/min", "min**-1", "1"),
        ("1 / min", "Hz", "1/60"),
        ("count/min", "Hz", "1/60"),
        ("mm", "s", None),
        ("J/(kg m)", "J kg**-1 m**-1", None),
        ("2 mm", "m", None),
        ("mm2", "m**2", None),
    ],
)
def test_notation(text, own, right):
    assert factor_between(text, own) == (right and units.Fraction(right))
