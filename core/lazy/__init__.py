"""A study of any size as a dataset of dask arrays: a block of cells is computed when it is read."""

from typing import TYPE_CHECKING

from vibrafeed.core.deferred import lazily

__all__ = ["dataset", "statistics", "store"]

if TYPE_CHECKING:
    from vibrafeed.core.lazy import dataset, statistics, store
else:  # they load dask
    __getattr__ = lazily(
        __name__, {}, {"dataset": "dataset", "statistics": "statistics", "store": "store"}
    )
