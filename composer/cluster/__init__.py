"""Make cells on the workers of a Dask cluster: `crew.py` is the client's side, `station.py` the workers' side."""
