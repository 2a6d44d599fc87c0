"""Words of flags by their CF attributes."""

import numpy as np

from vibrafeed.core.dataset.table import flags_of


def test_each_value_of_a_flag_has_its_word():
    values = np.array([0, 2, 5], dtype=np.int8)
    attributes = {"flag_values": values, "flag_meanings": "none some all"}
    assert flags_of(attributes) == {0: "none", 2: "some", 5: "all"}
    assert flags_of({"flag_values": np.int8(3), "flag_meanings": "alone"}) == {3: "alone"}


def test_what_is_no_flag_has_no_words():
    assert flags_of({"units": "m"}) == {}
