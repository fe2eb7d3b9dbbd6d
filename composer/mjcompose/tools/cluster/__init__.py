"""Cells that are made by Dask's workers."""
