"""Labelled results: CF attributes, the xarray view, the NetCDF writer."""
