"""Labelled results: CF attributes, the xarray view, the NetCDF writer."""

from vibrafeed.core.dataset.table import Table, TableVariable

__all__ = ["Table", "TableVariable"]
