"""Cells made by the workers of a Dask cluster; `crew.py` is what asks them, `station.py` what runs at theirs."""
