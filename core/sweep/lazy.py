"""A sweep of any size as a dataset that is evaluated where it is read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibrafeed.core.errors import VibrafeedError
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.sweep.zarr_view import ZarrView
from vibrafeed.core.system import installing

if TYPE_CHECKING:
    import xarray


def open_lazily(sweep: Prepared) -> xarray.Dataset:
    """Return a sweep's dataset whose values are computed when they are read; nothing is stored.

    Raises
    ------
    VibrafeedError
        If zarr, which reads the chunks, is not installed.
    StudyError
        If its cells cannot be evaluated one by one.
    """
    sweep.check_lazy("Leave it out, or carry out the study")
    try:
        from vibrafeed.core.sweep.zarr_store import ViewStore  # loads zarr, which few need
    except ModuleNotFoundError as error:
        raise VibrafeedError(
            f"Reading cells of a sweep without storing it needs {error.name}, which is missing: "
            f"{installing('zarr')}"
        ) from error
    import xarray

    store = ViewStore(ZarrView(sweep))
    return xarray.open_zarr(store, consolidated=True, zarr_format=3, chunks=None)
