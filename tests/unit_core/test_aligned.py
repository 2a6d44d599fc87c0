"""Arrays that begin with a line of the cache."""

from __future__ import annotations

import numpy as np
import pytest

from vibrafeed.core.plan.lane_loop import LINE, aligned


@pytest.mark.parametrize("shape", [(), (0,), (1,), (1000,), (3, 1024)], ids=str)
@pytest.mark.parametrize("dtype", [np.float64, np.int8, np.bool_])
def test_arrays_begin_with_a_line_and_can_be_written(shape: tuple[int, ...], dtype: type) -> None:
    for _ in range(20):
        found = aligned(shape, dtype)
        assert (found.shape, found.dtype) == (shape, np.dtype(dtype))
        assert found.size == 0 or found.ctypes.data % LINE == 0
        assert found.flags.c_contiguous
        found[...] = 1
        assert (found == 1).all()
