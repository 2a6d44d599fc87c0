"""What an output is, its quantity says: flags, counts and errors are no values like others."""

from __future__ import annotations

import pytest

from vibrafeed.core.quantities import FLAGS, QUANTITIES

ERRORS = {
    "conveying_velocity_error", "conveying_velocity_spread", "yield_deviation",
    "transit_time_error", "bottleneck_velocity_error",
}  # fmt: skip
COUNTS = {
    "period_multiple", "impacts_per_period", "impact_count", "platoons", "friction_seed",
    "device_order", "spring_count", *(f"platoon_size_{n}" for n in range(1, 11)),
}  # fmt: skip


def test_flags_counts_and_errors_have_no_derivative():
    none = {name for name, quantity in QUANTITIES.items() if not quantity.is_derived}
    assert none == {*FLAGS, *ERRORS, *COUNTS, "design"}


@pytest.mark.parametrize("name", FLAGS)
def test_a_flag_takes_a_byte_and_its_values_fit(name):
    quantity = QUANTITIES[name]
    values = [flag.value for flag in FLAGS[name].values()]
    assert quantity.width == 1
    assert not quantity.compared
    assert len(set(values)) == len(values)
    assert 0 <= min(values) <= max(values) < 2 ** (8 * quantity.width - 1)


@pytest.mark.parametrize("name", sorted(ERRORS))
def test_an_error_names_the_quantity_that_it_is_of(name):
    assert QUANTITIES[name].error_of in QUANTITIES


def test_words_belong_to_whole_numbers_that_have_words_for_the_rest():
    for quantity in QUANTITIES.values():
        assert all(isinstance(number, int) for number in quantity.words)
        assert not quantity.words or quantity.other_words
