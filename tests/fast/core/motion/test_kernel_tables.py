"""What kernels and the library write stands where the other reads it."""

import numpy as np
import pytest

from vibrafeed.core.motion.kernels import constants, inputs, tumbling
from vibrafeed.core.motion.kernels.sine_sums import wave_columns
from vibrafeed.core.motion.kernels.tumbling import corners
from vibrafeed.core.motion.method import Groups, Motion, cells_of
from vibrafeed.core.motion.tumbling_scene import Tumble, TumblePath
from vibrafeed.core.motion.waves import ALONG, ENDS, NORMAL, Wave
from vibrafeed.core.quantities import MOTION_MODES


def test_columns_of_results_are_the_fields_of_results():
    assert (*constants.Columns._fields, "status") == Motion._fields
    assert (*tumbling.COLUMN._fields, "status") == Tumble._fields
    # A path holds time, the state and the lowest gap, and then the corners.
    assert len(TumblePath._fields) == tumbling.PATH.touching + 1


def test_shares_of_modes_stand_in_the_order_of_the_modes():
    for name in ("stick", "forward", "backward", "flight"):
        place = getattr(constants.COLUMN, name) - constants.COLUMN.stick
        assert place == MOTION_MODES[name].value


def test_a_cell_has_the_numbers_of_groups_and_the_settings_of_a_method():
    fields = (*Groups._fields[:-1], "tolerance", "max_periods")
    assert inputs.Cell._fields == fields
    rows, shape = cells_of(Groups(*np.arange(13.0)), tolerance=13.0, max_periods=14.0)
    assert shape == ()
    np.testing.assert_array_equal(rows, [np.arange(15.0)])


def test_a_cell_is_read_by_the_names_of_its_fields():
    for tables in (inputs, corners):
        row = np.arange(len(tables.Cell._fields)) + 0.5
        assert tables.cell_of(row) == tables.Cell(*row.tolist())


@pytest.mark.parametrize(("orders", "steps"), [(3, 0), (0, 4), (2, 3), (1, 1)])
def test_columns_of_a_wave(orders, steps):
    random = np.random.default_rng(orders + 10 * steps)
    wave = Wave(random.normal(size=(3, 2, orders, 2)), random.normal(size=(4, steps, 2)))
    before = np.full((2, 5), 7.0)
    row = np.concatenate([before, wave.columns((2,))], axis=1)[1]
    at = wave_columns.py_func(row, before.shape[1])
    assert (at.orders, at.steps) == (orders, steps)
    for first, axis in ((at.along, ALONG), (at.normal, NORMAL)):
        both = row[first : first + 2 * orders].reshape(2, orders)
        np.testing.assert_array_equal(both, wave.harmonics[axis, ..., 1])
    for first, axis in ((at.levels, ALONG), (at.normal_levels, NORMAL), (at.ends, ENDS)):
        np.testing.assert_array_equal(row[first : first + steps], wave.steps[axis, :, 1])


def test_a_row_without_a_wave_has_no_orders_and_no_steps():
    at = wave_columns.py_func(np.arange(5.0), 5)
    assert (at.orders, at.steps) == (0, 0)
