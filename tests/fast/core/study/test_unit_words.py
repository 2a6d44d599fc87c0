"""Our own table of units says what pint says, to the last digit, and spares its loading."""

from __future__ import annotations

import collections
import functools
import itertools
import random

import pytest

from night import spread
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study import units
from vibrafeed.core.study.shown import SI, SMALLER, TRADE
from vibrafeed.core.study.units import WORDS, _factor, factor_between

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
