"""Labelled results: CF attributes, the xarray view, the NetCDF writer."""

from core.dataset.table import Table, Variable

__all__ = ["Table", "Variable"]
