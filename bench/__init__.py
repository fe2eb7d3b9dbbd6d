"""How fast mjcompose is: ratios to its peers, measured side by side in one run. `python -m bench`."""
